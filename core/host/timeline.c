#include "host/timeline.h"

#include <string.h>

typedef struct {
    trochia_timeline *line;
    const uint8_t *spans;
    int64_t bytes, done, slices;
    trochia_executed *out;
    int64_t tick;
    uint8_t backwards;
} reader;

/* Reads bytes of a span; returns whether they are there. */
static int get(reader *r, void *to, size_t size) {
    if (r->done + (int64_t)size > r->bytes)
        return 0;
    memcpy(to, r->spans + r->done, size);
    r->done += (int64_t)size;
    return 1;
}

static void next_pixel(reader *r) {
    trochia_pixel pixel;
    if (r->line->pixels && get(r, &pixel, sizeof pixel))
        trochia_timeline_pixel(r->line, &pixel);
}

/* Takes the next span up; returns 1, 0 at the end, -1 for bytes that are no span. */
static int take_up(reader *r) {
    trochia_span span;
    trochia_part part;
    trochia_timeline *line = r->line;
    uint32_t start = line->loaded ? line->left : 0;
    uint8_t back = line->backwards;
    r->done += (int64_t)sizeof(trochia_pixel) * (line->pixels ? line->pixels - 1 : 0); /* cut off */
    if (r->done == r->bytes)
        return 0;
    if (!get(r, &span, sizeof span))
        return -1;
    trochia_timeline_load(line, &span);
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++) {
        if (!(span.motors >> i & 1))
            continue;
        if (!get(r, &part, sizeof part))
            return -1;
        trochia_timeline_part(line, i, &part, start);
        uint8_t bit = (uint8_t)(1u << i);
        back = part.steps.flags & TROCHIA_SEGMENT_BACKWARDS ? (uint8_t)(back | bit) : (uint8_t)(back & ~bit);
    }
    const uint8_t four[4] = {(uint8_t)(back ^ line->backwards), span.flags, span.outputs, 0};
    trochia_timeline_act(line, (uint16_t)start, four);
    line->backwards = back;
    return r->done + (int64_t)sizeof(trochia_pixel) * (line->pixels - 1) > r->bytes ? -1 : 1;
}

static void pulse(reader *r, uint8_t pins) {
    trochia_executed *out = r->out;
    if (out->made < out->pulse_room)
        out->pulses[out->made] = (trochia_pulse_at){.tick = r->tick, .pins = pins >> 1, .backwards = r->backwards};
    out->made++;
}

static void light(reader *r) {
    trochia_executed *out = r->out;
    int64_t tick = r->slices * TROCHIA_SLICE + r->line->light_at;
    if (out->lit < out->light_room)
        out->lights[out->lit] = (trochia_light_at){.tick = tick, .power = r->line->lit};
    out->lit++;
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
    line->shown = line->lights;
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
        at += (int64_t)sizeof(trochia_pixel) * (span.flags / TROCHIA_PIXEL);
    }
}

int32_t trochia_timeline_run(trochia_timeline *line, const uint8_t *spans, int64_t bytes, int64_t brake,
                             trochia_executed *done) {
    reader r = {.line = line, .spans = spans, .bytes = bytes, .out = done};
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
        uint8_t lights = line->lights;
        told = trochia_timeline_fill(line);
        if (told == TROCHIA_LIT) {
            if (lights != line->lights)
                light(&r);
            next_pixel(&r);
            continue;
        }
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
    return 0;
}
