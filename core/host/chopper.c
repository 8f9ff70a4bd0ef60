#include <math.h>

#include "host/stepper.h"
#include "host/stepper_equations.h"
#include "host/stepper_levels.h"

typedef struct {
    const trochia_driver *d;
    double dt, half; /* step, and half of it [s] */
    double fast_end; /* what is left of the off time when fast decay ends [s] */
} clockwork;

/* Voltage of a phase, and its switch a step on; see `switch_phase` in the package.  At level zero the bridge is off. */
static inline double switch_phase(const clockwork *t, trochia_switch *w, double level, double i) {
    const double supply = t->d->supply;
    if (level == 0.0) {
        w->off = 0.0;
        w->blank = 0.0;
        return i > 0.0 ? -supply : (i < 0.0 ? supply : NAN);
    }
    const double sign = level < 0.0 ? -1.0 : 1.0;
    const double x = i * sign;
    if (w->off > 0.0) {
        w->off -= t->dt;
        if (w->off <= t->half) {
            w->off = 0.0;
            w->blank = t->d->blanking;
        }
    } else if (w->blank > 0.0) {
        w->blank -= t->dt;
    }
    if (w->off == 0.0 && w->blank <= t->half && x >= fabs(level) * t->d->current) {
        w->off = t->d->off_time;
        w->blank = 0.0;
    }
    if (w->off == 0.0) {
        return sign * supply;
    }
    return w->off > t->fast_end && x > 0.0 ? -sign * supply : 0.0;
}

/* The current a step on, exact for a constant voltage; the diodes do not let a falling current turn round. */
static inline double step_current(double i, double v, double e, double left, double gain) {
    if (isnan(v)) {
        return 0.0;
    }
    const double next = i * left + (v - e) * gain;
    return v * i < 0.0 && next * i < 0.0 ? 0.0 : next;
}

/* Rotor, and the load behind its coupling, a step on under the currents. */
static inline void step_shaft(const stepper_shaft *q, trochia_stepper_state *y, double s, double c, double dt) {
    double torque = stepper_torque(q, y->current_a, y->current_b, s, c, y->omega);
    if (q->stiffness > 0.0) {
        const double across = stepper_coupling(q, y->theta, y->omega, y->load_theta, y->load_omega);
        torque -= across;
        y->load_omega += dt * q->per_jl * stepper_behind(q, across, y->load_omega);
        y->load_theta += dt * y->load_omega;
    }
    y->omega += dt * q->per_j * torque;
    y->theta += dt * y->omega;
    if (!(q->stiffness > 0.0)) {
        y->load_theta = y->theta;
        y->load_omega = y->omega;
    }
}

int64_t trochia_chopper_run(const trochia_stepper *motor, const trochia_driver *driver,
                            const trochia_coupling *coupling, trochia_stepper_state *state,
                            const trochia_stepper_input *input, double h, int64_t sub, int64_t ticks, int64_t every,
                            double *samples, int64_t *positions) {
    const double dt = h / (double)sub;
    const clockwork t = {driver, dt, 0.5 * dt, (1.0 - driver->fast) * driver->off_time + 0.5 * dt};
    const double left = exp(-dt * motor->resistance / motor->inductance);
    const double gain = (1.0 - left) / motor->resistance;
    const stepper_shaft shaft = stepper_prepare(motor, coupling);
    stepper_levels levels = {0};
    int64_t row = 0, until = every;
    trochia_stepper_state y = *state;
    stepper_set(&levels, driver, input, y.position);
    for (int64_t i = 0; i < ticks; i++, y.tick++) {
        const double begin = (double)y.tick * h;
        stepper_rest(&levels, driver, input, &y, begin);
        for (int64_t j = 0; j < sub; j++) {
            while (levels.taken < input->pulses && input->times[levels.taken] < begin + (double)(j + 1) * dt) {
                stepper_pulse(&levels, driver, input, &y);
            }
            const double s = sin(shaft.p * y.theta);
            const double c = cos(shaft.p * y.theta);
            const double ke = shaft.k * y.omega;
            const double va = switch_phase(&t, &y.switch_a, levels.a, y.current_a);
            const double vb = switch_phase(&t, &y.switch_b, levels.b, y.current_b);
            y.current_a = step_current(y.current_a, va, -ke * s, left, gain);
            y.current_b = step_current(y.current_b, vb, ke * c, left, gain);
            step_shaft(&shaft, &y, s, c, dt);
        }
        if (--until == 0) {
            until = every;
            stepper_write(&y, samples + 5 * row);
            positions[row++] = y.position;
        }
    }
    *state = y;
    return levels.taken;
}
