#include "host/stepper.h"

#include <math.h>

#include "host/stepper_equations.h"
#include "host/stepper_levels.h"

typedef struct {
    double ia, ib, theta, omega, y, u;
} vector;

/* The constants as the derivative wants them, with the present levels. */
typedef struct {
    const trochia_driver *driver;
    stepper_shaft shaft;
    double r, per_l;
    double per_lag; /* L/lag */
    double ripple;  /* half the off time over L */
    double drop, knee2;
    double va, vb; /* levels; in voltage mode volts */
} equations;

static equations prepare(const trochia_stepper *m, const trochia_driver *driver, const trochia_coupling *c) {
    const equations q = {.driver = driver,
                         .shaft = stepper_prepare(m, c),
                         .r = m->resistance,
                         .per_l = 1.0 / m->inductance,
                         .per_lag = m->inductance / driver->lag,
                         .ripple = 0.5 * driver->off_time / m->inductance,
                         .drop = driver->drop,
                         .knee2 = driver->knee * driver->knee};
    return q;
}

static inline double clamp(double x, double low, double high) {
    return x < low ? low : (x > high ? high : x);
}

/* Mean voltage of a chopper's phase; see `Chopper.mean_voltage`. */
static inline double mean_voltage(const equations *q, double level, double i, double e) {
    const trochia_driver *d = q->driver;
    if (level == 0.0) {
        return clamp(q->r * i + e - q->per_lag * i, -d->supply, d->supply);
    }
    const double sign = level < 0.0 ? -1.0 : 1.0;
    const double wanted = fabs(level) * d->current;
    const double falling = q->r * wanted + e * sign + d->fast * d->supply;
    const double below = falling > 0.0 ? fmin(q->ripple * falling, wanted) : 0.0;
    const double x = i * sign;
    const double free = q->r * x + e * sign + q->per_lag * (wanted - below - x);
    const double low = x > 0.0 ? fmin(d->lowest, d->supply) : 0.0;
    return sign * clamp(free, low, d->supply);
}

static inline vector derivative(const equations *q, int mode, int elastic, vector y) {
    const double s = sin(q->shaft.p * y.theta);
    const double c = cos(q->shaft.p * y.theta);
    const double ke = q->shaft.k * y.omega;
    double va = q->va, vb = q->vb;
    if (mode == TROCHIA_STEPPER_BRIDGE) {
        va -= stepper_dry(q->drop, y.ia, q->knee2);
        vb -= stepper_dry(q->drop, y.ib, q->knee2);
    } else if (mode != TROCHIA_STEPPER_VOLTAGE) {
        va = mean_voltage(q, mode == TROCHIA_STEPPER_OPEN ? 0.0 : va, y.ia, -ke * s);
        vb = mean_voltage(q, mode == TROCHIA_STEPPER_OPEN ? 0.0 : vb, y.ib, ke * c);
    }
    const double across = elastic ? stepper_coupling(&q->shaft, y.theta, y.omega, y.y, y.u) : 0.0;
    const double torque = stepper_torque(&q->shaft, y.ia, y.ib, s, c, y.omega) - across;
    const vector out = {(va - q->r * y.ia + ke * s) * q->per_l,
                        (vb - q->r * y.ib - ke * c) * q->per_l,
                        y.omega,
                        torque * q->shaft.per_j,
                        elastic ? y.u : 0.0,
                        elastic ? stepper_behind(&q->shaft, across, y.u) * q->shaft.per_jl : 0.0};
    return out;
}

static inline vector along(vector y, vector d, double h) {
    const vector out = {y.ia + h * d.ia,       y.ib + h * d.ib, y.theta + h * d.theta,
                        y.omega + h * d.omega, y.y + h * d.y,   y.u + h * d.u};
    return out;
}

static inline vector advance(const equations *q, int mode, int elastic, vector y, double h) {
    const vector a = derivative(q, mode, elastic, y);
    const vector b = derivative(q, mode, elastic, along(y, a, 0.5 * h));
    const vector c = derivative(q, mode, elastic, along(y, b, 0.5 * h));
    const vector d = derivative(q, mode, elastic, along(y, c, h));
    const double w = h / 6.0;
    const vector out = {y.ia + w * (a.ia + 2.0 * (b.ia + c.ia) + d.ia),
                        y.ib + w * (a.ib + 2.0 * (b.ib + c.ib) + d.ib),
                        y.theta + w * (a.theta + 2.0 * (b.theta + c.theta) + d.theta),
                        y.omega + w * (a.omega + 2.0 * (b.omega + c.omega) + d.omega),
                        y.y + w * (a.y + 2.0 * (b.y + c.y) + d.y),
                        y.u + w * (a.u + 2.0 * (b.u + c.u) + d.u)};
    return out;
}

static void feed(equations *q, const stepper_levels *levels, int mode) {
    const int bridge = mode == TROCHIA_STEPPER_VOLTAGE || mode == TROCHIA_STEPPER_BRIDGE;
    const double volts = bridge ? q->driver->supply : 1.0;
    q->va = volts * levels->a;
    q->vb = volts * levels->b;
}

static inline void keep(trochia_stepper_state *state, vector y, int elastic) {
    state->current_a = y.ia;
    state->current_b = y.ib;
    state->theta = y.theta;
    state->omega = y.omega;
    state->load_theta = elastic ? y.y : y.theta;
    state->load_omega = elastic ? y.u : y.omega;
}

/* What a run writes, and how often. */
typedef struct {
    int64_t ticks, every;
    double *samples;
    int64_t *positions;
} record;

/* Called with a constant mode and `elastic`, so that each kind of drive becomes a loop of its own. */
static inline int64_t march(equations *q, int mode, int elastic, trochia_stepper_state *state,
                            const trochia_stepper_input *input, double h, const record *out) {
    stepper_levels levels = {0};
    vector y = {state->current_a, state->current_b, state->theta, state->omega, state->load_theta, state->load_omega};
    double *sample = out->samples;
    int64_t *position = out->positions;
    int64_t until = out->every;
    stepper_set(&levels, q->driver, input, state->position);
    feed(q, &levels, mode);
    for (int64_t i = 0; i < out->ticks; i++, state->tick++) {
        double now = (double)state->tick * h, left = h;
        const double end = (double)(state->tick + 1) * h;
        if (stepper_rest(&levels, q->driver, input, state, now)) {
            feed(q, &levels, mode);
        }
        while (levels.taken < input->pulses && input->times[levels.taken] < end) {
            const double at = input->times[levels.taken];
            if (at > now) {
                y = advance(q, mode, elastic, y, at - now);
                now = at;
            }
            stepper_pulse(&levels, q->driver, input, state);
            feed(q, &levels, mode);
            left = end - now;
        }
        y = advance(q, mode, elastic, y, left);
        if (--until == 0) {
            until = out->every;
            keep(state, y, elastic);
            stepper_write(state, sample);
            sample += 5;
            *position++ = state->position;
        }
    }
    keep(state, y, elastic);
    return levels.taken;
}

int64_t trochia_stepper_run(const trochia_stepper *motor, const trochia_driver *driver,
                            const trochia_coupling *coupling, int32_t mode, trochia_stepper_state *state,
                            const trochia_stepper_input *input, double h, int64_t ticks, int64_t every, double *samples,
                            int64_t *positions) {
    equations q = prepare(motor, driver, coupling);
    const record out = {ticks, every, samples, positions};
    if (coupling->stiffness > 0.0) {
        return march(&q, mode, 1, state, input, h, &out);
    }
    switch (mode) {
    case TROCHIA_STEPPER_VOLTAGE:
        return march(&q, TROCHIA_STEPPER_VOLTAGE, 0, state, input, h, &out);
    case TROCHIA_STEPPER_BRIDGE:
        return march(&q, TROCHIA_STEPPER_BRIDGE, 0, state, input, h, &out);
    case TROCHIA_STEPPER_MEAN:
        return march(&q, TROCHIA_STEPPER_MEAN, 0, state, input, h, &out);
    default:
        return march(&q, TROCHIA_STEPPER_OPEN, 0, state, input, h, &out);
    }
}
