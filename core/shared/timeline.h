/* The time line of a chip: spans of several motors in, one line of pulses out, in the order and at the ticks in which
 * they are due.  The interrupt that makes the pulses only waits and toggles pins; all else is decided here, a few
 * thousandths of a second ahead, and the same code on the host tells what a chip will do.
 *
 * Work goes by slices of 2^14 ticks.  In a slice the rate is constant: where it is full a step's tick is its stream
 * time, else it is stretched.  When the rate has to fall, by order or because the spans held would no longer do to
 * stop in, it falls by the slew that the present span allows, slice by slice, and the beam is dark.
 *
 * Entries of the ring, from which the interrupt lives: ticks since the entry before (16 bits), pins, count; if count
 * is 0, `pins` is a trochia_entry and four bytes follow; if it is above 1, as many pulses, and what follows is the
 * interval between them [ticks, 16 bits], its fraction and the fraction of the first [2^-8].
 *
 * Legend: due = a motor's next step, from the slice's start [2^-8 ticks]; hand = sum of slew times span over what is
 * held: the rate r can be brought to 0 within it as long as r^2 / 2 is not more. */
#ifndef TROCHIA_TIMELINE_H
#define TROCHIA_TIMELINE_H

#include <stdint.h>

#include "shared/protocol.h"

#ifndef TROCHIA_RING /* a chip says for itself where its ring is, and how many motors it has */
#define TROCHIA_RING(line, i) ((line)->ring[(uint8_t)(i)])
#define TROCHIA_TAIL(line) ((line)->tail)
#define TROCHIA_PUBLISH(line, i) ((line)->head = (uint8_t)(i))
#define TROCHIA_RING_INSIDE 1
enum trochia_timeline_size { TROCHIA_TIMELINE_MOTORS = 6 };
#endif

enum trochia_entry {
    TROCHIA_MARK = 0, /* a slice ends; what follows: nothing */
    TROCHIA_ACT = 1,  /* a span begins; what follows: motors that turn round, power, flags and outputs of the span */
    TROCHIA_END = 2   /* motion has ended */
};

enum trochia_fill {
    TROCHIA_FULL = 0,  /* no more to do for now */
    TROCHIA_NEED = 1,  /* the next span, by trochia_timeline_load; or trochia_timeline_end */
    TROCHIA_ENDED = 2, /* the rate is 0, or the stream has ended: END is on its way */
    TROCHIA_SLICED = 3 /* a slice was finished */
};

enum trochia_timeline_bounds { TROCHIA_LONGEST_RUN = 100, TROCHIA_AHEAD = 3, TROCHIA_TURNS = 16, TROCHIA_SOME = 4 };

typedef struct {
    uint32_t due;
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
    uint32_t stretch; /* real ticks a tick of stream time [2^-8]; 256 at full rate */
    uint16_t slew;    /* of the span */
    uint16_t rate;
    uint16_t length; /* stream time of the slice; 0: none is begun */
    uint16_t last;   /* real tick of the last entry in the slice */
    uint16_t number; /* of the span */
    uint8_t backwards, turned;
    uint16_t extra;      /* the same less one, where it is below two [2^-16]: then */
    uint8_t brisk;       /* says so, and costs less */
    uint8_t full;        /* the rate is */
    uint8_t brake, rest; /* being stopped; the last span held ends at rest */
    uint8_t marked;      /* slices whose end is in the ring, counted on */
    uint8_t loaded;
    uint8_t head;
#ifdef TROCHIA_RING_INSIDE
    uint8_t tail;
    uint8_t ring[256];
#endif
} trochia_timeline;

static inline uint8_t trochia_timeline_space(const trochia_timeline *line) {
    return (uint8_t)(TROCHIA_TAIL(line) - line->head - 1);
}

/* Slew times span [2^-15], as hand counts it. */
static inline uint32_t trochia_hand(uint16_t slew, uint32_t ticks) {
    return (uint32_t)slew * (ticks >> 8) >> 6;
}

/* Ticks from the last entry to a place in the slice, which counts as the last then. */
static inline uint16_t trochia_timeline_delta(trochia_timeline *line, uint16_t at) {
    uint16_t real = at;
    if (line->brisk)
        real = (uint16_t)(at + (uint16_t)((uint32_t)at * line->extra >> 16));
    else if (!line->full)
        real = (uint16_t)((uint32_t)at * line->stretch >> 8);
    uint16_t delta = (uint16_t)(real - line->last);
    line->last = real;
    return delta;
}

static inline void trochia_timeline_put(trochia_timeline *line, uint16_t at, uint8_t pins) {
    uint8_t head = line->head;
    uint16_t delta = trochia_timeline_delta(line, at);
    TROCHIA_RING(line, head++) = (uint8_t)delta;
    TROCHIA_RING(line, head++) = (uint8_t)(delta >> 8);
    TROCHIA_RING(line, head++) = pins;
    TROCHIA_RING(line, head++) = 1;
    TROCHIA_PUBLISH(line, head);
}

static inline void trochia_timeline_special(trochia_timeline *line, uint16_t at, uint8_t kind, const uint8_t *four) {
    uint8_t head = line->head;
    uint16_t delta = trochia_timeline_delta(line, at);
    TROCHIA_RING(line, head++) = (uint8_t)delta;
    TROCHIA_RING(line, head++) = (uint8_t)(delta >> 8);
    TROCHIA_RING(line, head++) = kind;
    TROCHIA_RING(line, head++) = 0;
    for (uint8_t i = 0; i < 4; i++)
        TROCHIA_RING(line, head++) = four[i];
    TROCHIA_PUBLISH(line, head);
}

/* The tick of a due time below 2^24. */
static inline uint16_t trochia_tick_of(const trochia_motor *motor) {
    return (uint16_t)(motor->due >> 8);
}

/* Moves a motor on to its next step. */
static inline void trochia_motor_on(trochia_motor *motor) {
    trochia_segment_run *run = &motor->run;
    if (run->phase == 0) {
        motor->on = 0;
        return;
    }
    motor->due += run->interval;
    if (--run->phase == 0)
        trochia_segment_bend(run);
}

/* One motor alone, up to a limit: a pulse, then as many as have one interval in one entry. */
static inline void trochia_timeline_alone(trochia_timeline *line, trochia_motor *motor, uint32_t limit) {
    int8_t step = line->backwards & (uint8_t)(1u << (motor - line->motors)) ? -1 : 1;
    while (motor->on && motor->due < limit && trochia_timeline_space(line) >= 12) {
        trochia_segment_run *run = &motor->run;
        uint32_t interval = run->interval;
        uint16_t at = trochia_tick_of(motor);
        uint8_t fraction = (uint8_t)motor->due, most = run->phase, count = 1;
        if (most > TROCHIA_LONGEST_RUN)
            most = TROCHIA_LONGEST_RUN;
        if (line->full && most > 1 && interval < 0x400000) {
            uint32_t due = motor->due;
            do { /* `most` further steps follow at this interval: those within the limit go along */
                due += interval;
                if (due >= limit)
                    break;
                count++;
            } while (--most);
            if (count > 1) { /* stand on the last of them */
                run->phase = (uint8_t)(run->phase - (count - 1));
                motor->due = most ? due - interval : due;
                if (run->phase == 0)
                    trochia_segment_bend(run);
            }
        }
        trochia_motor_on(motor);
        motor->position += step < 0 ? -(int32_t)count : (int32_t)count;
        uint8_t head = line->head;
        uint16_t delta = trochia_timeline_delta(line, at);
        TROCHIA_RING(line, head++) = (uint8_t)delta;
        TROCHIA_RING(line, head++) = (uint8_t)(delta >> 8);
        TROCHIA_RING(line, head++) = motor->pin;
        TROCHIA_RING(line, head++) = count;
        if (count > 1) {
            TROCHIA_RING(line, head++) = (uint8_t)(interval >> 8);
            TROCHIA_RING(line, head++) = (uint8_t)(interval >> 16);
            TROCHIA_RING(line, head++) = (uint8_t)interval;
            TROCHIA_RING(line, head++) = fraction;
            uint32_t ticks = (uint32_t)(count - 1) * interval + fraction;
            line->last = (uint16_t)(line->last + (uint16_t)(ticks >> 8));
        }
        TROCHIA_PUBLISH(line, head);
    }
}

/* The steps of one motor from `due` on up to a tick, at most `most` of them; returns where it stands then. */
static inline uint32_t trochia_timeline_some(trochia_timeline *line, trochia_motor *motor, uint16_t until,
                                             uint8_t most) {
    uint32_t due = motor->due, bound = (uint32_t)until << 8;
    uint8_t made = 0, pin = motor->pin;
    trochia_segment_run *run = &motor->run;
    do {
        trochia_timeline_put(line, (uint16_t)(due >> 8), pin);
        made++;
        if (run->phase == 0) {
            motor->on = 0;
            break;
        }
        due += run->interval;
        if (--run->phase == 0)
            trochia_segment_bend(run);
    } while (due < bound && made < most);
    motor->due = due;
    if (run->flags & TROCHIA_SEGMENT_BACKWARDS)
        motor->position -= made;
    else
        motor->position += made;
    return due;
}

/* Steps of several motors at one tick, as one pulse. */
static inline void trochia_timeline_together(trochia_timeline *line, trochia_motor **near, uint8_t count,
                                             uint16_t tick) {
    uint8_t pins = 0;
    for (uint8_t i = 0; i < count; i++) {
        trochia_motor *motor = near[i];
        if (trochia_tick_of(motor) != tick)
            continue;
        pins |= motor->pin;
        motor->position += motor->run.flags & TROCHIA_SEGMENT_BACKWARDS ? -1 : 1;
        trochia_motor_on(motor);
    }
    trochia_timeline_put(line, tick, pins);
}

/* Every step due before `limit` [ticks]; returns whether all found room, and time: it takes turns with others. */
static inline uint8_t trochia_timeline_steps(trochia_timeline *line, uint16_t limit) {
    trochia_motor *near[TROCHIA_TIMELINE_MOTORS];
    uint32_t bound = (uint32_t)limit << 8;
    uint8_t count = 0;
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++) {
        trochia_motor *motor = &line->motors[i];
        if (motor->on && motor->due < bound)
            near[count++] = motor;
    }
    for (uint8_t turns = TROCHIA_TURNS; count > 1; turns--) {
        if (turns == 0 || trochia_timeline_space(line) < 28)
            return 0;
        uint16_t first = trochia_tick_of(near[0]), second = limit;
        uint8_t which = 0;
        for (uint8_t i = 1; i < count; i++) {
            uint16_t at = trochia_tick_of(near[i]);
            if (at < first) {
                second = first;
                first = at;
                which = i;
            } else if (at < second) {
                second = at;
            }
        }
        if (first == second)
            trochia_timeline_together(line, near, count, first);
        else if (trochia_timeline_some(line, near[which], second, TROCHIA_SOME) < bound && near[which]->on)
            continue;
        for (uint8_t i = 0; i < count;) {
            if (near[i]->on && near[i]->due < bound)
                i++;
            else
                near[i] = near[--count];
        }
    }
    if (count) {
        trochia_timeline_alone(line, near[0], bound);
        return !(near[0]->on && near[0]->due < bound);
    }
    return 1;
}

/* Begins a slice: decides the rate.  Returns whether there is any. */
static inline uint8_t trochia_timeline_slice(trochia_timeline *line) {
    uint32_t rate = line->rate;
    uint8_t low = 0;
    line->last = 0;
    if (!line->rest) { /* after this slice, what is left must do to stop in from this rate */
        uint32_t hand = line->hand + trochia_hand(line->slew, line->left);
        uint32_t spent = rate * line->slew >> 15;
        low = (rate * rate >> 16) + spent + 2 >= hand;
    }
    if (line->brake || low)
        rate = rate > line->slew ? rate - line->slew : 0;
    else if (rate < TROCHIA_FULL_RATE)
        rate = rate + line->slew < TROCHIA_FULL_RATE ? rate + line->slew : TROCHIA_FULL_RATE;
    line->rate = (uint16_t)rate;
    line->length = (uint16_t)(rate >> 1);
    if (line->length == 0)
        return 0;
    line->full = rate == TROCHIA_FULL_RATE;
    line->brisk = !line->full && rate > TROCHIA_FULL_RATE / 2;
    if (line->brisk)
        line->extra = (uint16_t)((((uint32_t)TROCHIA_SLICE << 16) - 1) / line->length - 65536u);
    line->stretch = rate == TROCHIA_FULL_RATE ? 256 : ((uint32_t)TROCHIA_SLICE << 8) / line->length;
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
    line->hand -= trochia_hand(span->slew, span->duration);
    line->loaded = 1;
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
    line->brake = line->loaded = 0;
    line->rest = 1;
}

/* Ends motion where the present span ends, or where it is if the rate is 0. */
static inline void trochia_timeline_end(trochia_timeline *line) {
    uint16_t at = line->length && line->loaded ? (uint16_t)line->left : 0;
    const uint8_t nothing[4] = {0, 0, 0, 0};
    trochia_timeline_special(line, at, TROCHIA_END, nothing);
    line->stream += at;
    line->length = 0;
    line->loaded = 0;
}

/* One motor's part of the span just taken up, which began at `start`. */
static inline void trochia_timeline_part(trochia_timeline *line, uint8_t motor, const trochia_part *part,
                                         uint32_t start) {
    trochia_motor *m = &line->motors[motor];
    trochia_segment_load(&m->run, &part->steps);
    m->due = (start << 8) + part->first;
    m->on = 1;
}

/* Goes on until the ring is full, a slice is done, or a span is needed. */
static inline uint8_t trochia_timeline_fill(trochia_timeline *line) {
    if (!line->loaded)
        return TROCHIA_NEED;
    if (line->length == 0 && !trochia_timeline_slice(line))
        return TROCHIA_ENDED;
    uint16_t limit = line->left < line->length ? (uint16_t)line->left : line->length;
    if (!trochia_timeline_steps(line, limit) || trochia_timeline_space(line) < 20)
        return TROCHIA_FULL;
    if (line->left <= line->length)
        return TROCHIA_NEED;
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++)
        line->motors[i].due -= (uint32_t)line->length << 8;
    line->left -= line->length;
    line->stream += line->length;
    uint8_t head = line->head;
    uint16_t delta = (uint16_t)(TROCHIA_SLICE - line->last);
    TROCHIA_RING(line, head++) = (uint8_t)delta;
    TROCHIA_RING(line, head++) = (uint8_t)(delta >> 8);
    TROCHIA_RING(line, head++) = TROCHIA_MARK;
    TROCHIA_RING(line, head) = 0;
    TROCHIA_PUBLISH(line, (uint8_t)(head + 5));
    line->length = 0;
    line->marked++;
    return TROCHIA_SLICED;
}

#endif
