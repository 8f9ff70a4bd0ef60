/* Steps of several motors to one line of pulses.
 *
 * One motor alone gets its pulses at their ticks, as many as have one interval in one entry.  Several, and one whose
 * interval changes often, share a grid: a slot is 2^7 ticks, a byte of pins, and its pulses come in its middle, so
 * no more than half a slot from their tick; no step is merged with another, and what a step costs is an addition.
 * Slots without pulses are one byte together: their number times two, and one; bit 0 is nobody's pin.
 *
 * Entries of the ring, from which the interrupt lives, begin at multiples of four: ticks since the entry before (16
 * bits), pins, count.  If count is 0, `pins` is a trochia_entry, and four bytes follow, or the slots.  If it is above
 * 1, it is as many pulses, and what follows is the interval between them [ticks, 16 bits], its fraction and the
 * fraction of the first [2^-8].
 *
 * Legend: due = a motor's next step, from the slice's start [2^-8 ticks of stream time]; real = the same in the chip's
 * own time; slice, span, rate, hand: timeline.h. */
#ifndef TROCHIA_PULSES_H
#define TROCHIA_PULSES_H

#include <stdint.h>

#include "shared/protocol.h"

#ifndef TROCHIA_RING /* a chip says for itself where its ring is, and how many motors it has */
#define TROCHIA_RING(line, i) ((line)->ring[(uint8_t)(i)])
#define TROCHIA_TAIL(line) ((line)->tail)
#define TROCHIA_PUBLISH(line, i) ((line)->head = (uint8_t)(i))
#define TROCHIA_RING_INSIDE 1
#define TROCHIA_LIGHT(line, at, to) trochia_light_keep(line, at)
enum trochia_timeline_size { TROCHIA_TIMELINE_MOTORS = 6, TROCHIA_LIGHTS = 15 };
#endif

#ifndef TROCHIA_BEND /* a chip has them in its own instructions, or these */
#define TROCHIA_BEND trochia_segment_bend
#define TROCHIA_PLACE trochia_row_place
#define TROCHIA_CLEAR trochia_row_clear
#define TROCHIA_PACK trochia_slots_pack
#define TROCHIA_STEPS trochia_timeline_steps
#define TROCHIA_ROW(motor, row) 0       /* what it can do by itself of trochia_timeline_row at full rate: whether all */
#define TROCHIA_ROW_BRISK(motor, row) 0 /* and at more than half of it */
#endif

enum trochia_entry {
    TROCHIA_MARK = 0,  /* a slice ends; what follows: nothing */
    TROCHIA_ACT = 1,   /* a span begins; what follows: motors that turn round, flags and outputs of the span, nothing */
    TROCHIA_END = 2,   /* motion has ended */
    TROCHIA_FULLY = 3, /* what follows: whether the rate is full from here on */
    TROCHIA_GRID = 128 /* and as many bytes of slots as the lower bits say */
};

enum trochia_far { TROCHIA_LONG = 1L << 22 /* no two steps so far apart are in one slice [2^-8 ticks] */ };

enum trochia_timeline_bounds {
    TROCHIA_LONGEST_RUN = 100,
    TROCHIA_AHEAD = 3,
    TROCHIA_SLOT = 128,  /* ticks */
    TROCHIA_CHUNK = 64,  /* slots that are filled at once */
    TROCHIA_SPARE = 4,   /* more, for steps that found theirs taken where a span ends */
    TROCHIA_BEHIND = 16, /* slots by which steps may be late */
    TROCHIA_APART = 64,  /* ticks between pulses, at least, and from a change of direction to a pulse */
    TROCHIA_SPECIAL = 0  /* from or to other entries that are no pulses */
};

typedef struct trochia_motor {
    int32_t due;
    trochia_segment_run run;
    int32_t position; /* with the steps that are on their way to the pins */
    uint8_t pin;      /* bits of its step pins in an entry */
    uint8_t on;       /* whether a step is due in this span */
} trochia_motor;

typedef struct {
    trochia_motor motors[TROCHIA_TIMELINE_MOTORS];
    uint32_t left;    /* of the span, from the slice's start [ticks of stream time] */
    uint32_t stream;  /* stream time at the slice's start */
    uint32_t hand;    /* of the spans that wait; see legend */
    uint32_t pixel;   /* when the power changes next, from the slice's start [ticks of stream time] */
    uint32_t stretch; /* real ticks a tick of stream time [2^-8]; 256 at full rate */
    uint16_t slew;    /* of the span */
    uint16_t rate;
    uint16_t length; /* stream time of the slice; 0: none is begun */
    uint16_t last;   /* real tick of the last entry in the slice */
    uint8_t apart;   /* ticks from it to the next pulse, at least */
    uint16_t number; /* of the span */
    uint16_t extra;  /* the stretch less one, where it is below two [2^-16]: then */
    uint8_t brisk;   /* says so, and costs less */
    uint8_t full;    /* the rate is */
    uint8_t backwards;
    uint8_t pixels, power, lit; /* changes of power to come in the span, the next one's, what it is before that */
    uint8_t brake, rest;        /* being stopped; the last span held ends at rest */
    uint8_t crowded;
    uint8_t dense;  /* the slice's last chunk is still to come */
    uint8_t marked; /* slices whose end is in the ring, counted on */
    uint8_t loaded;
    uint8_t head;
#ifdef TROCHIA_RING_INSIDE
    uint16_t light_at;     /* when the power changes last, from the slice's start [ticks] */
    uint8_t lights, shown; /* changes of power so far, and those the pins have seen */
    uint8_t tail;
    uint8_t ring[256];
#endif
} trochia_timeline;

#ifdef TROCHIA_RING_INSIDE
/* Notes a change of power at a real tick of the slice, as long as no more than a chip's ring holds wait. */
static inline uint8_t trochia_light_keep(trochia_timeline *line, uint16_t at) {
    if ((uint8_t)(line->lights - line->shown) >= TROCHIA_LIGHTS)
        return 0;
    line->light_at = at;
    line->lights++;
    return 1;
}
#endif

static inline uint8_t trochia_timeline_space(const trochia_timeline *line) {
    return (uint8_t)(TROCHIA_TAIL(line) - line->head - 1);
}

/* Stream time from the slice's start to real time [ticks]. */
static inline uint16_t trochia_real(const trochia_timeline *line, uint16_t at) {
    if (line->full)
        return at;
    if (line->brisk)
        return (uint16_t)(at + (uint16_t)((uint32_t)at * line->extra >> 16));
    return (uint16_t)((uint32_t)at * line->stretch >> 8);
}

/* The same with a fraction [2^-8 ticks]; intervals above a slice stay above one. */
static inline uint32_t trochia_real_fine(const trochia_timeline *line, uint32_t at) {
    if (line->full || at >= (uint32_t)TROCHIA_LONG)
        return at;
    uint16_t ticks = (uint16_t)(at >> 8);
    if (line->brisk)
        return at + (((uint32_t)ticks * line->extra + ((uint32_t)(uint8_t)at * line->extra >> 8)) >> 8);
    uint32_t real = (uint32_t)ticks * line->stretch;
    return real < (uint32_t)TROCHIA_LONG ? real + ((uint8_t)at * line->stretch >> 8) : (uint32_t)TROCHIA_LONG;
}

/* Ticks from the last entry to a real time, or to `gap` after the last entry if that is later; that is the last then.
 */
static inline uint16_t trochia_timeline_delta(trochia_timeline *line, uint16_t real, uint8_t gap) {
    uint16_t delta = (uint16_t)(real - line->last);
    if ((int16_t)(delta - gap) < 0)
        delta = gap;
    line->last = (uint16_t)(line->last + delta);
    line->apart = (uint8_t)(delta < line->apart ? line->apart - delta : 0);
    return delta;
}

/* The four bytes every entry has; returns where those after it go. */
static inline uint8_t trochia_timeline_put(trochia_timeline *line, uint16_t delta, uint8_t pins, uint8_t count) {
    uint8_t head = line->head;
    TROCHIA_RING(line, head++) = (uint8_t)delta;
    TROCHIA_RING(line, head++) = (uint8_t)(delta >> 8);
    TROCHIA_RING(line, head++) = pins;
    TROCHIA_RING(line, head++) = count;
    if (count || pins & TROCHIA_GRID)
        line->apart = TROCHIA_APART;
    return head;
}

/* An entry that is no pulse, at a real time of the slice; what follows is whether the rate is full, and nothing. */
static inline void trochia_timeline_special(trochia_timeline *line, uint16_t real, uint8_t kind) {
    uint16_t delta = trochia_timeline_delta(line, real, TROCHIA_SPECIAL);
    uint8_t head = trochia_timeline_put(line, delta, kind, 0);
    TROCHIA_RING(line, head) = line->full;
    TROCHIA_PUBLISH(line, (uint8_t)(head + 4));
}

/* The start of a span: motors that turn round, flags, outputs; nothing. */
static inline void trochia_timeline_act(trochia_timeline *line, uint16_t at, const uint8_t *four) {
    uint16_t delta = trochia_timeline_delta(line, trochia_real(line, at), TROCHIA_SPECIAL);
    uint8_t head = trochia_timeline_put(line, delta, TROCHIA_ACT, 0);
    for (uint8_t i = 0; i < 4; i++)
        TROCHIA_RING(line, head++) = four[i];
    if (four[0])
        line->apart = TROCHIA_APART;
    TROCHIA_PUBLISH(line, head);
}

/* Ticks ahead as they are counted here: what is longer than any span is all the same. */
static inline int32_t trochia_ahead(uint32_t ticks) {
    const uint32_t never = (uint32_t)1 << 30;
    return (int32_t)(ticks < never ? ticks : never);
}

/* From a motor's next step to the one after `steps` [2^-8 ticks]. */
static inline int32_t trochia_steps_ahead(const trochia_segment_run *run, uint8_t steps) {
    return steps == 1 ? trochia_ahead(run->interval) : (int32_t)(run->interval * steps);
}

/* Moves a motor on by steps of its present interval, at most as many as there are; `due` is the next one then. */
static inline void trochia_motor_on(trochia_motor *motor, uint8_t steps, int32_t due) {
    trochia_segment_run *run = &motor->run;
    if (run->flags & TROCHIA_SEGMENT_BACKWARDS)
        motor->position -= steps;
    else
        motor->position += steps;
    if (run->phase == 0) {
        motor->on = 0;
        return;
    }
    motor->due = due;
    run->phase = (uint8_t)(run->phase - steps);
    if (run->phase == 0)
        TROCHIA_BEND(run);
}

/* Whether a motor alone is cheaper in runs than on the grid; closer than slots it must be. */
static inline uint8_t trochia_motor_runs(const trochia_timeline *line, const trochia_motor *motor) {
    enum { LONG_STRIDE = 8, SLOW = 2048L << 8, CLOSE = (TROCHIA_SLOT + 32L) << 8 };
    const trochia_segment_run *run = &motor->run;
    if (run->stride >= LONG_STRIDE || run->interval >= SLOW)
        return 1;
    return run->interval < CLOSE && trochia_real_fine(line, run->interval) < CLOSE;
}

/* How many steps, the first of them due now, are due within some ticks, at most 128 [2^-8 ticks]. */
static inline uint8_t trochia_steps_within(uint32_t interval, uint32_t ticks) {
    uint8_t more = 0;
    interval <<= 6;
    for (uint8_t steps = 64; steps; steps >>= 1) {
        if (interval < ticks) {
            ticks -= interval;
            more = (uint8_t)(more + steps);
        }
        interval >>= 1;
    }
    return (uint8_t)(more + 1);
}

/* One motor alone, up to a limit, as long as there is room. */
static inline void trochia_timeline_alone(trochia_timeline *line, trochia_motor *motor, int32_t limit) {
    while (motor->on && motor->due < limit && trochia_timeline_space(line) >= 12) {
        trochia_segment_run *run = &motor->run;
        uint32_t due = (uint32_t)motor->due, real = trochia_real_fine(line, due);
        uint32_t interval = run->interval;
        uint8_t count = run->phase < TROCHIA_LONGEST_RUN ? run->phase : TROCHIA_LONGEST_RUN;
        if (interval >= (uint32_t)TROCHIA_LONG)
            count = 1;
        if (count > 1 && (int32_t)(due + (uint8_t)(count - 1) * interval) >= limit)
            count = trochia_steps_within(interval, (uint32_t)limit - due);
        if (!count)
            count = 1; /* the last step of its segment */
        uint16_t delta = trochia_timeline_delta(line, (uint16_t)(real >> 8), line->apart);
        uint8_t head = trochia_timeline_put(line, delta, motor->pin, count);
        if (count > 1) {
            interval = trochia_real_fine(line, interval);
            TROCHIA_RING(line, head++) = (uint8_t)(interval >> 8);
            TROCHIA_RING(line, head++) = (uint8_t)(interval >> 16);
            TROCHIA_RING(line, head++) = (uint8_t)interval;
            TROCHIA_RING(line, head++) = (uint8_t)real;
            uint32_t ticks = (uint8_t)(count - 1) * interval + (uint8_t)real;
            line->last = (uint16_t)(line->last + (uint16_t)(ticks >> 8));
        }
        trochia_motor_on(motor, count, motor->due + trochia_steps_ahead(run, count));
        TROCHIA_PUBLISH(line, head);
    }
}

#endif
