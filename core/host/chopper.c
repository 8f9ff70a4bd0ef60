#include <math.h>

#include "host/drive.h"
#include "host/drive_levels.h"

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

static inline double dry(double torque, double omega, double creep2) {
    return torque > 0.0 ? torque * omega / sqrt(omega * omega + creep2) : 0.0;
}

/* Rotor, and the load behind its coupling, a step on under the currents. */
static inline void step_shaft(const trochia_stepper *m, const trochia_coupling *k, trochia_drive_state *y, double s,
                              double c, double dt) {
    const double creep2 = m->creep * m->creep;
    double torque = m->torque_constant * (y->current_b * c - y->current_a * s) -
                    4.0 * m->detent * s * c * (1.0 - 2.0 * s * s) - m->viscous * y->omega - m->load -
                    dry(m->friction, y->omega, creep2);
    if (k->stiffness > 0.0) {
        const double across = k->stiffness * (y->theta - y->load_theta) + k->damping * (y->omega - y->load_omega);
        torque -= across;
        y->load_omega +=
            dt / k->inertia * (across - k->viscous * y->load_omega - k->load - dry(k->friction, y->load_omega, creep2));
        y->load_theta += dt * y->load_omega;
    }
    y->omega += dt / m->inertia * torque;
    y->theta += dt * y->omega;
    if (!(k->stiffness > 0.0)) {
        y->load_theta = y->theta;
        y->load_omega = y->omega;
    }
}

int64_t trochia_chopper_run(const trochia_stepper *motor, const trochia_driver *driver,
                            const trochia_coupling *coupling, trochia_drive_state *state,
                            const trochia_drive_input *input, double h, int64_t sub, int64_t ticks, int64_t every,
                            double *samples, int64_t *positions) {
    const double dt = h / (double)sub;
    const clockwork t = {driver, dt, 0.5 * dt, (1.0 - driver->fast) * driver->off_time + 0.5 * dt};
    const double left = exp(-dt * motor->resistance / motor->inductance);
    const double gain = (1.0 - left) / motor->resistance;
    drive_levels levels = {0};
    int64_t row = 0, until = every;
    trochia_drive_state y = *state;
    drive_set(&levels, driver, input, y.position);
    for (int64_t i = 0; i < ticks; i++, y.tick++) {
        const double begin = (double)y.tick * h;
        drive_rest(&levels, driver, input, &y, begin);
        for (int64_t j = 0; j < sub; j++) {
            while (levels.taken < input->pulses && input->times[levels.taken] < begin + (double)(j + 1) * dt) {
                drive_pulse(&levels, driver, input, &y);
            }
            const double s = sin(motor->teeth * y.theta);
            const double c = cos(motor->teeth * y.theta);
            const double ke = motor->torque_constant * y.omega;
            const double va = switch_phase(&t, &y.switch_a, levels.a, y.current_a);
            const double vb = switch_phase(&t, &y.switch_b, levels.b, y.current_b);
            y.current_a = step_current(y.current_a, va, -ke * s, left, gain);
            y.current_b = step_current(y.current_b, vb, ke * c, left, gain);
            step_shaft(motor, coupling, &y, s, c, dt);
        }
        if (--until == 0) {
            until = every;
            drive_write(&y, samples + 5 * row);
            positions[row++] = y.position;
        }
    }
    *state = y;
    return levels.taken;
}
