#include "host/reluctance.h"

#include <math.h>

enum { MOST = 16 };

typedef struct {
    double i[MOST], theta, omega;
} vector;

/* The constants, with which phases are on now. */
typedef struct {
    const trochia_reluctance *motor;
    double cosine[MOST], sine[MOST]; /* of a phase's own angle: one sine and cosine of N x then serve all */
    uint32_t on;
} equations;

static void prepare(equations *q, const trochia_reluctance *motor) {
    q->motor = motor;
    for (int64_t k = 0; k < motor->phases; k++) {
        q->cosine[k] = cos((double)k * motor->shift);
        q->sine[k] = sin((double)k * motor->shift);
    }
}

static void derivative(const equations *q, const vector *y, vector *out) {
    const trochia_reluctance *m = q->motor;
    const double c = cos(m->teeth * y->theta);
    const double s = sin(m->teeth * y->theta);
    double torque = -m->viscous * y->omega - m->load;
    for (int64_t k = 0; k < m->phases; k++) {
        const double i = y->i[k] > 0.0 ? y->i[k] : 0.0;
        const int on = (int)(q->on >> k & 1u);
        const double inductance = m->mean + m->swing * (c * q->cosine[k] + s * q->sine[k]);
        const double slope = -m->swing * m->teeth * (s * q->cosine[k] - c * q->sine[k]);
        const double volts = on ? m->supply : -m->against - m->series * i;
        const double rate = (volts - m->resistance * i - i * y->omega * slope) / inductance;
        out->i[k] = i > 0.0 || rate > 0.0 ? rate : 0.0; /* without current the diode blocks */
        torque += 0.5 * i * i * slope;
    }
    if (m->friction > 0.0) {
        torque -= m->friction * y->omega / sqrt(y->omega * y->omega + m->creep * m->creep);
    }
    out->theta = y->omega;
    out->omega = torque / m->inertia;
}

static void along(const equations *q, const vector *y, const vector *d, double h, vector *out) {
    for (int64_t k = 0; k < q->motor->phases; k++) {
        out->i[k] = y->i[k] + h * d->i[k];
    }
    out->theta = y->theta + h * d->theta;
    out->omega = y->omega + h * d->omega;
}

static void advance(const equations *q, vector *y, double h) {
    vector k1, k2, k3, k4, at;
    derivative(q, y, &k1);
    along(q, y, &k1, 0.5 * h, &at);
    derivative(q, &at, &k2);
    along(q, y, &k2, 0.5 * h, &at);
    derivative(q, &at, &k3);
    along(q, y, &k3, h, &at);
    derivative(q, &at, &k4);
    const double sixth = h / 6.0;
    for (int64_t k = 0; k < q->motor->phases; k++) {
        y->i[k] += sixth * (k1.i[k] + 2.0 * (k2.i[k] + k3.i[k]) + k4.i[k]);
        y->i[k] = y->i[k] > 0.0 ? y->i[k] : 0.0;
    }
    y->theta += sixth * (k1.theta + 2.0 * (k2.theta + k3.theta) + k4.theta);
    y->omega += sixth * (k1.omega + 2.0 * (k2.omega + k3.omega) + k4.omega);
}

static uint32_t word(const uint32_t *table, int64_t rows, int64_t position) {
    return table[((position % rows) + rows) % rows];
}

static void write(const equations *q, const vector *y, double *sample) {
    const int64_t phases = q->motor->phases;
    for (int64_t k = 0; k < phases; k++) {
        sample[k] = y->i[k];
    }
    sample[phases] = y->theta;
    sample[phases + 1] = y->omega;
}

static void load(const trochia_reluctance_state *state, int64_t phases, vector *y) {
    for (int64_t k = 0; k < phases; k++) {
        y->i[k] = state->current[k];
    }
    y->theta = state->theta;
    y->omega = state->omega;
}

static void store(const vector *y, int64_t phases, trochia_reluctance_state *state) {
    for (int64_t k = 0; k < phases; k++) {
        state->current[k] = y->i[k];
    }
    state->theta = y->theta;
    state->omega = y->omega;
}

int64_t trochia_reluctance_run(const trochia_reluctance *motor, trochia_reluctance_state *state, const uint32_t *table,
                               int64_t rows, const double *times, const int8_t *directions, int64_t pulses, double h,
                               int64_t ticks, int64_t every, double *samples, int64_t *positions) {
    equations q;
    vector y;
    int64_t position = state->position, taken = 0, row = 0, until = every;
    prepare(&q, motor);
    load(state, motor->phases, &y);
    q.on = word(table, rows, position);
    for (int64_t tick = 0; tick < ticks; tick++) {
        const double end = (double)(state->tick + tick + 1) * h;
        double left = h;
        if (taken < pulses && times[taken] < end) {
            double now = (double)(state->tick + tick) * h;
            while (taken < pulses && times[taken] < end) {
                if (times[taken] > now) {
                    advance(&q, &y, times[taken] - now);
                    now = times[taken];
                }
                position += directions[taken++];
                q.on = word(table, rows, position);
            }
            left = end - now;
        }
        advance(&q, &y, left);
        if (--until == 0) {
            until = every;
            write(&q, &y, samples + (motor->phases + 2) * row);
            positions[row++] = position;
        }
    }
    store(&y, motor->phases, state);
    state->tick += ticks;
    state->position = position;
    return taken;
}
