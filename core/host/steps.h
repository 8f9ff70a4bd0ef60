/* Step times of one joint from a trajectory.
 *
 * In: phases and segments (path.h), the joint's row (steps per unit of each axis), a clock.
 * Out: the tick and direction of every step, in order.
 *
 * Legend: q position of the joint [steps], tau time since the phase's start [ticks], k a whole number.  The step that
 * brings the count to k falls where q = k, in either direction; so |q - count| < 1 always, and on a whole q they are
 * equal.  A boundary counts as reached within a millionth of a step, so that rounding never loses a job's last step. */
#ifndef TROCHIA_STEPS_H
#define TROCHIA_STEPS_H

#include <stdint.h>

#include "host/path.h"

/* What is worked: the first phase of a call is phases[state.phase]. */
typedef struct {
    const trochia_phase *phases;
    int64_t phase_count;
    const trochia_segment *segments;
    const double *pool;
    const double *row; /* steps per unit of each axis */
    int32_t axes;
    double clock; /* ticks a second */
    double until; /* tick at which to stop */
} trochia_step_job;

typedef struct {
    int64_t count;     /* steps made so far, signed: the last k */
    int64_t phase;     /* phase to go on with */
    double tau;        /* ticks of it already done */
    int32_t direction; /* of the last step: 1, -1, or 0 before the first */
    int32_t full;      /* 1: the space ran out, call again; 0: all done up to `until` */
} trochia_step_state;

/* Writes at most `capacity` steps, returns how many. */
int64_t trochia_steps(const trochia_step_job *job, trochia_step_state *state, int64_t capacity, int64_t *ticks,
                      int8_t *directions);

#endif
