/* Tick segments: what a chip executes.  A segment is a run of steps of one motor whose intervals follow a polynomial:
 *
 *   after every `stride` steps   interval += add,  add += add2
 *
 * so that a step's time is a cubic of its number, or straight from stride to stride where steps are fast.  A step is
 * one addition: nothing is multiplied or divided, and what a step costs does not depend on the figures.
 *
 * Fixed point: a tick's 8 bits are carried from step to step, and from segment to segment, so nothing is lost at a
 * seam; an interval keeps 16 bits more behind them, which only `add` and `add2` touch.  The tick of every step is
 * therefore the same number on the chip, on the host and on paper: floor of the sum of the intervals' 24.8 parts.
 *
 * Legend: interval [2^-8 ticks], at most 2^24 ticks; add, add2 [2^-24 ticks, times 2^(8 scale)]. */
#ifndef TROCHIA_SEGMENT_H
#define TROCHIA_SEGMENT_H

#include <stdint.h>

enum trochia_segment_flag {
    TROCHIA_SEGMENT_BACKWARDS = 1, /* the direction of its steps */
    TROCHIA_SEGMENT_PAUSE = 2,     /* time passes, no step is made */
    TROCHIA_SEGMENT_SCALE = 4      /* add and add2 are 2^8 times, twice this flag 2^16 times greater */
};

enum trochia_segment_scale { TROCHIA_SEGMENT_SCALE_MASK = 12, TROCHIA_SEGMENT_COARSEST = 2 };

/* As it is planned and sent. */
typedef struct {
    uint32_t interval; /* from the step before to its first */
    int32_t add;
    int32_t add2;
    uint16_t count; /* steps, at least 1 */
    uint8_t stride; /* steps of one interval, at least 1 */
    uint8_t flags;
} trochia_tick_segment;

/* As it is executed: every figure with its 24 fraction bits, the upper 32 apart from the lower 16.  A step touches the
 * first six bytes only, and the others after every stride. */
typedef struct {
    uint32_t interval;
    uint8_t fraction; /* of a tick, carried [2^-8] */
    uint8_t phase;    /* steps still to make at this interval; 0: the segment is done */
    uint8_t stride;
    uint8_t flags;
    uint16_t left; /* steps to make after those */
    uint16_t interval_low;
    uint32_t add;
    uint32_t add2;
    uint16_t add_low;
    uint16_t add2_low;
} trochia_segment_run;

/* v times 2^(8 scale) in 24 fraction bits, upper 32 bits. */
static inline uint32_t trochia_segment_high(int32_t v, uint8_t scale) {
    if (scale == 0)
        return (uint32_t)(v >> 16);
    return scale == 1 ? (uint32_t)(v >> 8) : (uint32_t)v;
}

/* The same, lower 16 bits. */
static inline uint16_t trochia_segment_low(int32_t v, uint8_t scale) {
    if (scale == 0)
        return (uint16_t)v;
    return scale == 1 ? (uint16_t)((uint32_t)v << 8) : 0;
}

/* The steps of the next interval, out of those left. */
static inline void trochia_segment_share(trochia_segment_run *run) {
    run->phase = run->stride;
    if (run->left < run->stride)
        run->phase = (uint8_t)run->left;
    run->left = (uint16_t)(run->left - run->phase);
}

/* Takes up a segment; the fraction of a tick stays. */
static inline void trochia_segment_load(trochia_segment_run *run, const trochia_tick_segment *segment) {
    uint8_t scale = (uint8_t)((segment->flags & TROCHIA_SEGMENT_SCALE_MASK) / TROCHIA_SEGMENT_SCALE);
    run->interval = segment->interval;
    run->interval_low = 0;
    run->add = trochia_segment_high(segment->add, scale);
    run->add_low = trochia_segment_low(segment->add, scale);
    run->add2 = trochia_segment_high(segment->add2, scale);
    run->add2_low = trochia_segment_low(segment->add2, scale);
    run->left = segment->count;
    run->stride = segment->stride;
    run->flags = segment->flags;
    trochia_segment_share(run);
}

/* After a stride: the next interval and the next `add`. */
static inline void trochia_segment_bend(trochia_segment_run *run) {
    uint16_t low = (uint16_t)(run->interval_low + run->add_low);
    run->interval += run->add + (low < run->add_low);
    run->interval_low = low;
    low = (uint16_t)(run->add_low + run->add2_low);
    run->add += run->add2 + (low < run->add2_low);
    run->add_low = low;
    trochia_segment_share(run);
}

/* Ticks from the step before to the next one, which counts as made; only while `phase` is not 0. */
static inline uint32_t trochia_segment_step(trochia_segment_run *run) {
    uint16_t fraction = (uint16_t)(run->fraction + (uint8_t)run->interval);
    uint32_t ticks = (run->interval >> 8) + (fraction >> 8);
    run->fraction = (uint8_t)fraction;
    if (--run->phase == 0)
        trochia_segment_bend(run);
    return ticks;
}

#endif
