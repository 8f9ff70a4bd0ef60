/* Step times of one joint from cubics over short times, as a live backend is given its motion.
 *
 * A step to k falls where the joint's position passes half way to it, so the count is always the whole number nearest
 * to the position, and a joint at rest on a whole number is there for certain. */
#ifndef TROCHIA_CUBIC_STEPS_H
#define TROCHIA_CUBIC_STEPS_H

#include <stdint.h>

typedef struct {
    int64_t count; /* where the joint stands, signed [steps] */
    int64_t row;   /* to go on with */
    double tau;    /* of it already done [ticks] */
} trochia_cubic_state;

/* Rows of four coefficients by rising powers of ticks since the row's start [steps]; starts[rows + 1] [ticks].  Writes
 * at most `capacity` steps and returns how many; all is done when state->row is `rows`. */
int64_t trochia_cubic_steps(const double *coefficients, const double *starts, int64_t rows, trochia_cubic_state *state,
                            int64_t capacity, int64_t *ticks, int8_t *directions);

#endif
