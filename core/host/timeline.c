#include "host/timeline.h"

#include <string.h>

typedef struct {
    trochia_timeline *line;
    const uint8_t *spans;
    int64_t bytes, done, capacity, made, slices;
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
    trochia_timeline_act(line, (uint16_t)start, four);
    line->backwards = back;
    return 1;
}

static void pulse(reader *r, uint8_t pins) {
    if (r->made < r->capacity)
        r->pulses[r->made] = (trochia_pulse_at){.tick = r->tick, .pins = pins >> 1, .backwards = r->backwards};
    r->made++;
}

/* A grid's slots, the first of which is due now; returns its length. */
static uint8_t grid(reader *r, uint8_t bytes) {
    trochia_timeline *line = r->line;
    int64_t tick = r->tick;
    for (uint8_t i = 0; i < bytes; i++) {
        uint8_t pins = line->ring[(uint8_t)(line->tail + 4 + i)];
        if (!(pins & 1)) {
            r->tick = tick;
            pulse(r, pins);
        }
        tick += TROCHIA_SLOT * (pins & 1 ? pins >> 1 : 1);
    }
    return (uint8_t)(4 + ((bytes + 3) & ~3));
}

/* Pulses of one interval, the first of which is due now. */
static void row(reader *r, const uint8_t *entry) {
    uint32_t fraction = entry[7];
    pulse(r, entry[2]);
    for (uint8_t i = 1; i < entry[3]; i++) {
        fraction = (fraction & 255) + entry[6];
        r->tick += (entry[4] | (int64_t)entry[5] << 8) + (fraction >> 8);
        pulse(r, entry[2]);
    }
}

/* What the interrupt does with the ring, until it is empty. */
static void empty(reader *r) {
    trochia_timeline *line = r->line;
    while (line->tail != line->head) {
        uint8_t entry[8], size = 8;
        for (uint8_t i = 0; i < 8; i++)
            entry[i] = line->ring[(uint8_t)(line->tail + i)];
        r->tick += entry[0] | (int64_t)entry[1] << 8;
        if (entry[3] == 0 && entry[2] & TROCHIA_GRID) {
            size = grid(r, entry[2] & (uint8_t)~TROCHIA_GRID);
        } else if (entry[3] == 0) {
            r->backwards ^= entry[2] == TROCHIA_ACT ? entry[4] : 0;
        } else {
            size = entry[3] == 1 ? 4 : 8;
            row(r, entry);
        }
        line->tail = (uint8_t)(line->tail + size);
    }
}

/* Counts what is held, as a chip that has all spans before it begins. */
static void hold(reader *r) {
    trochia_span span;
    r->line->rest = 0;
    for (int64_t at = 0; at + (int64_t)sizeof span <= r->bytes; at += (int64_t)sizeof span) {
        memcpy(&span, r->spans + at, sizeof span);
        r->line->hand += trochia_hand(span.slew, span.duration);
        r->line->rest = span.flags & TROCHIA_AT_REST;
        for (uint8_t motors = span.motors; motors; motors &= (uint8_t)(motors - 1))
            at += (int64_t)sizeof(trochia_part);
    }
}

int64_t trochia_timeline_pulses(trochia_timeline *line, const uint8_t *spans, int64_t bytes, int64_t brake,
                                int64_t capacity, trochia_pulse_at *pulses) {
    reader r = {.line = line, .spans = spans, .bytes = bytes, .capacity = capacity, .pulses = pulses};
    uint8_t told = TROCHIA_FULL;
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++)
        line->motors[i].pin = (uint8_t)(2u << i);
    trochia_timeline_begin(line);
    r.backwards = line->backwards;
    if (brake >= 0)
        hold(&r);
    while (told != TROCHIA_ENDED && told != TROCHIA_CROWDED) {
        line->brake = brake > 0 && r.slices >= brake;
        uint8_t head = line->head;
        told = trochia_timeline_fill(line);
        if (told == TROCHIA_FULL && line->head != head)
            continue; /* it was not full yet: only a turn was over */
        r.slices += told == TROCHIA_SLICED;
        if (told == TROCHIA_SLICED)
            continue;
        int took = told == TROCHIA_NEED ? take_up(&r) : 1;
        if (took < 0)
            return -1;
        if (took == 0)
            break;
        empty(&r);
    }
    trochia_timeline_end(line);
    empty(&r);
    return r.made;
}
