/* Step ticks to tick segments: as few as keep every step within a tolerance of its tick.
 *
 * A segment of n steps is a cubic through three of its ticks, nearly those of Chebyshev's polynomial, rounded to the
 * segment's integers, and then executed: only what the executor itself makes of it counts.  The longest n that holds
 * is found by doubling and halving.  Deviations do not add up: a segment begins where the executor really stands. */
#ifndef TROCHIA_FIT_H
#define TROCHIA_FIT_H

#include <stdint.h>

#include "shared/segment.h"

typedef struct {
    int64_t now;   /* where the executor stands [2^-8 ticks] */
    int64_t done;  /* ticks of the steps already fitted */
    double worst;  /* greatest deviation so far [ticks] */
    uint8_t flags; /* of the segments made: direction */
} trochia_fit_state;

/* Fits ticks[state->done] … ticks[count - 1], rising; tolerance [ticks], in any case half of either interval beside the
 * step.  Writes at most
 * `capacity` segments, returns how many; all is done when state->done is `count`. */
int64_t trochia_fit(const int64_t *ticks, int64_t count, double tolerance, trochia_fit_state *state, int64_t capacity,
                    trochia_tick_segment *segments);

#endif
