#include "host/timeline.h"

#include <string.h>

typedef struct {
    trochia_timeline *line;
    const uint8_t *spans;
    int64_t bytes, done, capacity, made;
    trochia_pulse_at *pulses;
    int64_t tick;
    uint8_t backwards;
} reader;

/* Takes the next span up; returns 1, 0 at the end, -1 for bytes that are no span. */
static int take_up(reader *r) {
    trochia_span span;
    trochia_part part;
    trochia_timeline *line = r->line;
    uint32_t start = line->loaded ? line->left : 0;
    uint8_t back = line->backwards;
    if (r->done == r->bytes)
        return 0;
    if (r->done + (int64_t)sizeof span > r->bytes)
        return -1;
    memcpy(&span, r->spans + r->done, sizeof span);
    r->done += (int64_t)sizeof span;
    trochia_timeline_load(line, &span);
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++) {
        if (!(span.motors >> i & 1))
            continue;
        if (r->done + (int64_t)sizeof part > r->bytes)
            return -1;
        memcpy(&part, r->spans + r->done, sizeof part);
        r->done += (int64_t)sizeof part;
        trochia_timeline_part(line, i, &part, start);
        uint8_t bit = (uint8_t)(1u << i);
        back = part.steps.flags & TROCHIA_SEGMENT_BACKWARDS ? (uint8_t)(back | bit) : (uint8_t)(back & ~bit);
    }
    const uint8_t four[4] = {(uint8_t)(back ^ line->backwards), span.power, span.flags, span.outputs};
    trochia_timeline_special(line, (uint16_t)start, TROCHIA_ACT, four);
    line->backwards = back;
    return 1;
}

static void pulse(reader *r, uint8_t pins) {
    if (r->made < r->capacity)
        r->pulses[r->made] = (trochia_pulse_at){.tick = r->tick, .pins = pins, .backwards = r->backwards};
    r->made++;
}

/* What the interrupt does with the ring, until it is empty. */
static void empty(reader *r) {
    trochia_timeline *line = r->line;
    while (line->tail != line->head) {
        uint8_t entry[8];
        for (uint8_t i = 0; i < 8; i++)
            entry[i] = line->ring[(uint8_t)(line->tail + i)];
        r->tick += entry[0] | (int64_t)entry[1] << 8;
        line->tail = (uint8_t)(line->tail + (entry[3] == 1 ? 4 : 8));
        if (entry[3] == 0) {
            if (entry[2] == TROCHIA_ACT)
                r->backwards ^= entry[4];
            continue;
        }
        pulse(r, entry[2]);
        uint32_t fraction = entry[7];
        for (uint8_t i = 1; i < entry[3]; i++) {
            fraction = (fraction & 255) + entry[6];
            r->tick += (entry[4] | (int64_t)entry[5] << 8) + (fraction >> 8);
            pulse(r, entry[2]);
        }
    }
}

int64_t trochia_timeline_pulses(trochia_timeline *line, const uint8_t *spans, int64_t bytes, int64_t capacity,
                                trochia_pulse_at *pulses) {
    reader r = {.line = line, .spans = spans, .bytes = bytes, .capacity = capacity, .pulses = pulses};
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++)
        line->motors[i].pin = (uint8_t)(1u << i);
    trochia_timeline_begin(line);
    r.backwards = line->backwards;
    for (;;) {
        uint8_t told = trochia_timeline_fill(line);
        empty(&r);
        if (told == TROCHIA_NEED) {
            int took = take_up(&r);
            if (took < 0)
                return -1;
            if (took == 0)
                break;
        }
    }
    return r.made;
}
