#include "host/stepper.h"

#include <math.h>

typedef struct {
    double ia, ib, theta, omega;
} vector;

/* The motor's constants as the derivative wants them, with the present voltages. */
typedef struct {
    double r, k, p, d, b, f, creep2, load, per_l, per_j;
    double va, vb;
} equations;

static equations prepare(const trochia_stepper *m) {
    const equations q = {.r = m->resistance,
                         .k = m->torque_constant,
                         .p = m->teeth,
                         .d = 4.0 * m->detent,
                         .b = m->viscous,
                         .f = m->friction,
                         .creep2 = m->creep * m->creep,
                         .load = m->load,
                         .per_l = 1.0 / m->inductance,
                         .per_j = 1.0 / m->inertia};
    return q;
}

static inline vector derivative(const equations *q, vector y) {
    const double s = sin(q->p * y.theta);
    const double c = cos(q->p * y.theta);
    const double ke = q->k * y.omega;
    /* 4 d s c (1 - 2 s^2) is d sin(4 p x) */
    double torque = q->k * (y.ib * c - y.ia * s) - q->d * s * c * (1.0 - 2.0 * s * s) - q->b * y.omega - q->load;
    if (q->f > 0.0) {
        torque -= q->f * y.omega / sqrt(y.omega * y.omega + q->creep2);
    }
    const vector out = {(q->va - q->r * y.ia + ke * s) * q->per_l, (q->vb - q->r * y.ib - ke * c) * q->per_l, y.omega,
                        torque * q->per_j};
    return out;
}

static inline vector along(vector y, vector d, double h) {
    const vector out = {y.ia + h * d.ia, y.ib + h * d.ib, y.theta + h * d.theta, y.omega + h * d.omega};
    return out;
}

static inline vector advance(const equations *q, vector y, double h) {
    const vector k1 = derivative(q, y);
    const vector k2 = derivative(q, along(y, k1, 0.5 * h));
    const vector k3 = derivative(q, along(y, k2, 0.5 * h));
    const vector k4 = derivative(q, along(y, k3, h));
    const double sixth = h / 6.0;
    const vector out = {y.ia + sixth * (k1.ia + 2.0 * (k2.ia + k3.ia) + k4.ia),
                        y.ib + sixth * (k1.ib + 2.0 * (k2.ib + k3.ib) + k4.ib),
                        y.theta + sixth * (k1.theta + 2.0 * (k2.theta + k3.theta) + k4.theta),
                        y.omega + sixth * (k1.omega + 2.0 * (k2.omega + k3.omega) + k4.omega)};
    return out;
}

static void apply(equations *q, const double *voltages, int64_t rows, int64_t position) {
    const int64_t row = ((position % rows) + rows) % rows;
    q->va = voltages[2 * row];
    q->vb = voltages[2 * row + 1];
}

static void write(const vector *y, double *sample) {
    sample[0] = y->ia;
    sample[1] = y->ib;
    sample[2] = y->theta;
    sample[3] = y->omega;
}

int64_t trochia_stepper_run(const trochia_stepper *motor, trochia_stepper_state *state, const double *voltages,
                            int64_t rows, const double *times, const int8_t *directions, int64_t pulses, double h,
                            int64_t ticks, int64_t every, double *samples, int64_t *positions) {
    equations q = prepare(motor);
    vector y = {state->current_a, state->current_b, state->theta, state->omega};
    int64_t position = state->position, taken = 0, row = 0, until = every;
    apply(&q, voltages, rows, position);
    for (int64_t i = 0; i < ticks; i++) {
        double left = h;
        if (taken < pulses && times[taken] < (double)(state->tick + i + 1) * h) {
            double now = (double)(state->tick + i) * h;
            const double end = (double)(state->tick + i + 1) * h;
            while (taken < pulses && times[taken] < end) {
                if (times[taken] > now) {
                    y = advance(&q, y, times[taken] - now);
                    now = times[taken];
                }
                position += directions[taken];
                apply(&q, voltages, rows, position);
                taken++;
            }
            left = end - now;
        }
        y = advance(&q, y, left);
        if (--until == 0) {
            until = every;
            write(&y, samples + 4 * row);
            positions[row++] = position;
        }
    }
    state->current_a = y.ia;
    state->current_b = y.ib;
    state->theta = y.theta;
    state->omega = y.omega;
    state->tick += ticks;
    state->position = position;
    return taken;
}
