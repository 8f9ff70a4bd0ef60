/* The time line of a chip: spans of several motors in, one line of pulses out, in the order and at the ticks in which
 * they are due.  The interrupt that makes the pulses only waits and toggles pins; all else is decided here, a few
 * thousandths of a second ahead, and the same code on the host tells what a chip will do.
 *
 * Work goes by slices of 2^14 ticks.  In a slice the rate is constant: where it is full a step's tick is its stream
 * time, else it is stretched.  When the rate has to fall, by order or because the spans held would no longer do to
 * stop in, it falls by the slew that the present span allows, slice by slice, and the beam is dark.
 *
 * Legend: hand = sum of slew times span over what is held: the rate r can be brought to 0 within it as long as
 * r^2 / 2 is not more. */
#ifndef TROCHIA_TIMELINE_H
#define TROCHIA_TIMELINE_H

#include "shared/slots.h"

enum trochia_fill {
    TROCHIA_FULL = 0,    /* no more to do for now */
    TROCHIA_NEED = 1,    /* the next span, by trochia_timeline_load; or trochia_timeline_end */
    TROCHIA_ENDED = 2,   /* the rate is 0, or the stream has ended: END is on its way */
    TROCHIA_SLICED = 3,  /* a slice was finished */
    TROCHIA_CROWDED = 4, /* steps of a motor are closer than slots: what is on its way is the last */
    TROCHIA_LIT = 5      /* the power has been changed; if `pixels` is not 0, the next by trochia_timeline_pixel */
};

/* Slew times span [2^-15], as hand counts it. */
static inline uint32_t trochia_hand(uint16_t slew, uint32_t ticks) {
    uint32_t hand = (uint32_t)slew * (uint16_t)(ticks >> 8); /* a span has less than 2^23 ticks */
    return hand >> 6;
}

/* Whether, after a slice at this rate, what is held will still do to stop in. */
static inline uint8_t trochia_timeline_stops(const trochia_timeline *line, uint16_t rate, uint32_t hand) {
    uint32_t square = (uint32_t)rate * rate, spent = (uint32_t)rate * line->slew;
    return (square >> 16) + (spent >> 15) + 2 < hand;
}

/* Begins a slice: decides the rate.  Returns whether there is any. */
static inline uint8_t trochia_timeline_slice(trochia_timeline *line) {
    uint16_t rate = line->rate, slew = line->slew, more = TROCHIA_FULL_RATE;
    if (rate < TROCHIA_FULL_RATE && slew < TROCHIA_FULL_RATE - rate)
        more = (uint16_t)(rate + slew);
    uint32_t hand = line->hand + trochia_hand(slew, line->left);
    if (!line->brake && (line->rest || trochia_timeline_stops(line, more, hand)))
        rate = more;
    else if (line->brake || !trochia_timeline_stops(line, rate, hand))
        rate = rate > slew ? (uint16_t)(rate - slew) : 0;
    line->rate = rate;
    line->length = rate >> 1;
    if (line->length == 0)
        return 0;
    uint8_t full = rate == TROCHIA_FULL_RATE;
    uint8_t was = line->full;
    line->full = full;
    if (full != was)
        trochia_timeline_special(line, 0, TROCHIA_FULLY);
    line->brisk = !line->full && rate > TROCHIA_FULL_RATE / 2;
    if (line->brisk)
        line->extra = (uint16_t)((((uint32_t)TROCHIA_SLICE << 16) - 1) / line->length - 65536u);
    else
        line->stretch = line->full ? 256 : ((uint32_t)TROCHIA_SLICE << 8) / line->length;
    return 1;
}

/* Takes a span up, at the place where the one before ended; `parts` one for each bit of span->motors. */
static inline void trochia_timeline_load(trochia_timeline *line, const trochia_span *span) {
    uint32_t start = line->loaded ? line->left : 0;
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++)
        line->motors[i].on = 0;
    line->left = start + span->duration;
    line->slew = span->slew;
    line->number = span->number;
    line->pixels = (uint8_t)(span->flags / TROCHIA_PIXEL + 1); /* its own power is the first */
    line->pixel = start;
    line->power = span->power;
    line->hand -= trochia_hand(span->slew, span->duration);
    line->loaded = 1;
}

/* The next of the span's pixels. */
static inline void trochia_timeline_pixel(trochia_timeline *line, const trochia_pixel *pixel) {
    line->pixel += (uint32_t)(pixel->after * TROCHIA_SLOT);
    line->power = pixel->power;
}

/* Begins at rest at stream time 0, with nothing held. */
static inline void trochia_timeline_begin(trochia_timeline *line) {
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++)
        line->motors[i].on = 0;
    line->left = line->stream = line->hand = 0;
    line->rate = TROCHIA_FULL_RATE;
    line->stretch = 256;
    line->full = 1;
    line->brisk = 0;
    line->length = line->last = line->slew = 0;
    line->apart = TROCHIA_SPECIAL;
    line->brake = line->loaded = line->crowded = line->dense = line->pixels = line->lit = 0;
    line->rest = 1;
}

/* Ends motion where the present span ends, or where it is if the rate is 0. */
static inline void trochia_timeline_end(trochia_timeline *line) {
    uint16_t at = line->length && line->loaded ? (uint16_t)line->left : 0;
    trochia_timeline_special(line, trochia_real(line, at), TROCHIA_END);
    line->stream += at;
    line->length = 0;
    line->loaded = 0;
}

/* One motor's part of the span just taken up, which began at `start`. */
static inline void trochia_timeline_part(trochia_timeline *line, uint8_t motor, const trochia_part *part,
                                         uint32_t start) {
    trochia_motor *m = &line->motors[motor];
    trochia_segment_load(&m->run, &part->steps);
    m->due = (int32_t)(start << 8) + trochia_ahead(part->first);
    m->on = 1;
}

/* Goes on until the ring is full, a slice is done, or a span is needed. */
static inline uint8_t trochia_timeline_fill(trochia_timeline *line) {
    if (!line->loaded)
        return TROCHIA_NEED;
    if (line->length == 0 && !trochia_timeline_slice(line))
        return TROCHIA_ENDED;
    uint16_t limit = line->left < line->length ? (uint16_t)line->left : line->length;
    uint8_t lights = line->pixels && line->pixel < limit;
    if (lights &&
        (line->power == line->lit || TROCHIA_LIGHT(line, trochia_real(line, (uint16_t)line->pixel), line->power))) {
        line->lit = line->power;
        line->pixels--;
        return TROCHIA_LIT;
    }
    if (!TROCHIA_STEPS(line, limit) || trochia_timeline_space(line) < 20)
        return line->crowded ? TROCHIA_CROWDED : TROCHIA_FULL;
    if (lights)
        return TROCHIA_FULL; /* what remembers changes of power is */
    if (line->left <= line->length)
        return TROCHIA_NEED;
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++)
        line->motors[i].due -= (int32_t)line->length << 8;
    line->left -= line->length;
    line->pixel -= line->length;
    line->stream += line->length;
    trochia_timeline_special(line, TROCHIA_SLICE, TROCHIA_MARK);
    line->last = (uint16_t)(line->last - TROCHIA_SLICE);
    line->length = 0;
    line->marked++;
    return TROCHIA_SLICED;
}

#endif
