/* Constant acceleration, exact to the tick: the square of the time since rest grows by the same amount with every step.
 *
 *   T(k) = sqrt(N0 + k C) to the nearest tick,   C = 2 f^2 / a [ticks^2]
 *
 * f ticks a second, a steps a second squared; N0 = (f v / a)^2 for a start at speed v, 0 from rest.  Every T belongs to
 * the step's number, not to the interval before, so nothing drifts over millions of steps; braking runs the same
 * numbers backwards, so a ramp down is the mirror of the ramp up, tick for tick.  Nothing is divided: the root is
 * foretold from the last two intervals and put right, which once intervals change slowly takes one or two comparisons.
 *
 * Legend: N square [ticks^2] below 2^62, so a ramp lasts up to 2^31 ticks; C at most 2^60. */
#ifndef TROCHIA_RAMP_H
#define TROCHIA_RAMP_H

#include <stdint.h>

typedef struct {
    uint64_t per_step; /* C */
    int64_t rest;      /* N - root^2, above -root and at most root */
    uint32_t root;     /* T: ticks since rest */
    uint32_t interval; /* of the step before [ticks] */
    int32_t change;    /* from the interval before that to it [ticks] */
} trochia_ramp;

/* Whether a root smaller by 2^bits is still large enough: the nearest root is the least r with N <= r^2 + r. */
static inline uint8_t trochia_ramp_less(const trochia_ramp *ramp, uint8_t bits) {
    uint32_t by = (uint32_t)1 << bits;
    if (by > ramp->root)
        return 0;
    return ramp->rest + (((int64_t)2 * ramp->root - by) << bits) <= (int64_t)(ramp->root - by);
}

static inline void trochia_ramp_forth(trochia_ramp *ramp, uint32_t by) {
    ramp->rest -= (int64_t)(2 * ((uint64_t)ramp->root * by) + (uint64_t)by * by);
    ramp->root += by;
}

static inline void trochia_ramp_back(trochia_ramp *ramp, uint32_t by) {
    ramp->root -= by;
    ramp->rest += (int64_t)(2 * ((uint64_t)ramp->root * by) + (uint64_t)by * by);
}

/* Brings the root to the nearest one: past it in growing strides, then between the last two in shrinking ones. */
static inline void trochia_ramp_settle(trochia_ramp *ramp) {
    uint8_t bits = 0;
    if (ramp->rest > (int64_t)ramp->root) {
        do
            trochia_ramp_forth(ramp, (uint32_t)1 << bits++);
        while (ramp->rest > (int64_t)ramp->root);
        bits--;
    } else {
        while (trochia_ramp_less(ramp, bits))
            trochia_ramp_back(ramp, (uint32_t)1 << bits++);
    }
    while (bits--) {
        if (trochia_ramp_less(ramp, bits))
            trochia_ramp_back(ramp, (uint32_t)1 << bits);
    }
}

/* Stands where the square is `square`, with C `per_step`. */
static inline void trochia_ramp_begin(trochia_ramp *ramp, uint64_t per_step, uint64_t square) {
    ramp->per_step = per_step;
    ramp->rest = (int64_t)square;
    ramp->root = ramp->interval = 0;
    ramp->change = 0;
    trochia_ramp_settle(ramp);
}

/* What the next interval is likely to be. */
static inline uint32_t trochia_ramp_guess(const trochia_ramp *ramp) {
    int32_t guess = (int32_t)ramp->interval + ramp->change;
    return guess < 0 ? 0 : (uint32_t)guess;
}

static inline void trochia_ramp_note(trochia_ramp *ramp, uint32_t interval) {
    ramp->change = (int32_t)(interval - ramp->interval);
    ramp->interval = interval;
}

/* One step faster: returns the ticks from the step before to it. */
static inline uint32_t trochia_ramp_up(trochia_ramp *ramp) {
    uint32_t before = ramp->root;
    ramp->rest += (int64_t)ramp->per_step;
    trochia_ramp_forth(ramp, trochia_ramp_guess(ramp));
    trochia_ramp_settle(ramp);
    trochia_ramp_note(ramp, ramp->root - before);
    return ramp->interval;
}

/* One step slower, down to rest: N must be at least C. */
static inline uint32_t trochia_ramp_down(trochia_ramp *ramp) {
    uint32_t before = ramp->root, guess = trochia_ramp_guess(ramp);
    ramp->rest -= (int64_t)ramp->per_step;
    trochia_ramp_back(ramp, guess < before ? guess : before);
    trochia_ramp_settle(ramp);
    trochia_ramp_note(ramp, before - ramp->root);
    return ramp->interval;
}

#endif
