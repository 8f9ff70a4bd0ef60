/* What both kernels of a stepper share besides its equations: the levels of the phases as pulses come and as the motor
 * rests. */
#ifndef TROCHIA_STEPPER_LEVELS_H
#define TROCHIA_STEPPER_LEVELS_H

#include "host/stepper.h"

typedef struct {
    double a, b;
    int64_t taken;
    int held; /* the current is reduced: the last pulse was long ago */
} stepper_levels;

static inline void stepper_set(stepper_levels *now, const trochia_driver *d, const trochia_stepper_input *in,
                               int64_t position) {
    const int64_t row = ((position % in->rows) + in->rows) % in->rows;
    const double scale = d->scale * (now->held ? d->hold : 1.0);
    now->a = scale * in->levels[2 * row];
    now->b = scale * in->levels[2 * row + 1];
}

static inline void stepper_pulse(stepper_levels *now, const trochia_driver *d, const trochia_stepper_input *in,
                                 trochia_stepper_state *state) {
    state->position += in->directions[now->taken];
    state->last_pulse = in->times[now->taken];
    now->held = 0;
    now->taken++;
    stepper_set(now, d, in, state->position);
}

/* Returns whether the levels changed. */
static inline int stepper_rest(stepper_levels *now, const trochia_driver *d, const trochia_stepper_input *in,
                               const trochia_stepper_state *state, double time) {
    if (!now->held && d->hold < 1.0 && time - state->last_pulse > d->hold_delay) {
        now->held = 1;
        stepper_set(now, d, in, state->position);
        return 1;
    }
    return 0;
}

static inline void stepper_write(const trochia_stepper_state *y, double *sample) {
    sample[0] = y->current_a;
    sample[1] = y->current_b;
    sample[2] = y->theta;
    sample[3] = y->omega;
    sample[4] = y->load_theta;
}

#endif
