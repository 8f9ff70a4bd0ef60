#include "host/drive.h"

#include <math.h>

#include "host/drive_levels.h"

typedef struct {
    double ia, ib, theta, omega, y, u;
} vector;

/* The constants as the derivative wants them, with the present levels. */
typedef struct {
    const trochia_driver *driver;
    double r, l, k, p, d, b, f, creep2, load, per_l, per_j;
    double stiffness, damping, b_l, f_l, load_l, per_jl;
    double per_lag; /* L/lag */
    double ripple;  /* half the off time over L */
    double va, vb;  /* levels; in voltage mode volts */
} equations;

static equations prepare(const trochia_stepper *m, const trochia_driver *driver, const trochia_coupling *c) {
    const equations q = {.driver = driver,
                         .r = m->resistance,
                         .l = m->inductance,
                         .k = m->torque_constant,
                         .p = m->teeth,
                         .d = 4.0 * m->detent,
                         .b = m->viscous,
                         .f = m->friction,
                         .creep2 = m->creep * m->creep,
                         .load = m->load,
                         .per_l = 1.0 / m->inductance,
                         .per_j = 1.0 / m->inertia,
                         .stiffness = c->stiffness,
                         .damping = c->damping,
                         .b_l = c->viscous,
                         .f_l = c->friction,
                         .load_l = c->load,
                         .per_jl = c->stiffness > 0.0 ? 1.0 / c->inertia : 0.0,
                         .per_lag = m->inductance / driver->lag,
                         .ripple = 0.5 * driver->off_time / m->inductance};
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

static inline double dry(double torque, double omega, double creep2) {
    return torque > 0.0 ? torque * omega / sqrt(omega * omega + creep2) : 0.0;
}

static inline vector derivative(const equations *q, int mode, vector y) {
    const double s = sin(q->p * y.theta);
    const double c = cos(q->p * y.theta);
    const double ke = q->k * y.omega;
    double va = q->va, vb = q->vb;
    if (mode != TROCHIA_DRIVE_VOLTAGE) {
        va = mean_voltage(q, mode == TROCHIA_DRIVE_OPEN ? 0.0 : va, y.ia, -ke * s);
        vb = mean_voltage(q, mode == TROCHIA_DRIVE_OPEN ? 0.0 : vb, y.ib, ke * c);
    }
    /* 4 d s c (1 - 2 s^2) is d sin(4 p x) */
    double torque = q->k * (y.ib * c - y.ia * s) - q->d * s * c * (1.0 - 2.0 * s * s) - q->b * y.omega - q->load -
                    dry(q->f, y.omega, q->creep2);
    double across = 0.0;
    if (q->stiffness > 0.0) {
        across = q->stiffness * (y.theta - y.y) + q->damping * (y.omega - y.u);
        torque -= across;
    }
    const double behind = across - q->b_l * y.u - q->load_l - dry(q->f_l, y.u, q->creep2);
    const vector out = {(va - q->r * y.ia + ke * s) * q->per_l,
                        (vb - q->r * y.ib - ke * c) * q->per_l,
                        y.omega,
                        torque * q->per_j,
                        y.u,
                        behind * q->per_jl};
    return out;
}

static inline vector along(vector y, vector d, double h) {
    const vector out = {y.ia + h * d.ia,       y.ib + h * d.ib, y.theta + h * d.theta,
                        y.omega + h * d.omega, y.y + h * d.y,   y.u + h * d.u};
    return out;
}

static inline vector advance(const equations *q, int mode, vector y, double h) {
    const vector a = derivative(q, mode, y);
    const vector b = derivative(q, mode, along(y, a, 0.5 * h));
    const vector c = derivative(q, mode, along(y, b, 0.5 * h));
    const vector d = derivative(q, mode, along(y, c, h));
    const double w = h / 6.0;
    const vector out = {y.ia + w * (a.ia + 2.0 * (b.ia + c.ia) + d.ia),
                        y.ib + w * (a.ib + 2.0 * (b.ib + c.ib) + d.ib),
                        y.theta + w * (a.theta + 2.0 * (b.theta + c.theta) + d.theta),
                        y.omega + w * (a.omega + 2.0 * (b.omega + c.omega) + d.omega),
                        y.y + w * (a.y + 2.0 * (b.y + c.y) + d.y),
                        y.u + w * (a.u + 2.0 * (b.u + c.u) + d.u)};
    return out;
}

static void feed(equations *q, const drive_levels *levels, int mode) {
    const double volts = mode == TROCHIA_DRIVE_VOLTAGE ? q->driver->supply : 1.0;
    q->va = volts * levels->a;
    q->vb = volts * levels->b;
}

static void keep(trochia_drive_state *state, vector y, int rigid) {
    state->current_a = y.ia;
    state->current_b = y.ib;
    state->theta = y.theta;
    state->omega = y.omega;
    state->load_theta = rigid ? y.theta : y.y;
    state->load_omega = rigid ? y.omega : y.u;
}

int64_t trochia_drive_run(const trochia_stepper *motor, const trochia_driver *driver, const trochia_coupling *coupling,
                          int32_t mode, trochia_drive_state *state, const trochia_drive_input *input, double h,
                          int64_t ticks, int64_t every, double *samples, int64_t *positions) {
    equations q = prepare(motor, driver, coupling);
    drive_levels levels = {0};
    const int rigid = !(coupling->stiffness > 0.0);
    vector y = {state->current_a, state->current_b, state->theta, state->omega, state->load_theta, state->load_omega};
    int64_t row = 0, until = every;
    drive_set(&levels, driver, input, state->position);
    feed(&q, &levels, mode);
    for (int64_t i = 0; i < ticks; i++, state->tick++) {
        double now = (double)state->tick * h;
        const double end = (double)(state->tick + 1) * h;
        drive_rest(&levels, driver, input, state, now);
        feed(&q, &levels, mode);
        while (levels.taken < input->pulses && input->times[levels.taken] < end) {
            const double at = input->times[levels.taken];
            if (at > now) {
                y = advance(&q, mode, y, at - now);
                now = at;
            }
            drive_pulse(&levels, driver, input, state);
            feed(&q, &levels, mode);
        }
        y = advance(&q, mode, y, end - now);
        if (--until == 0) {
            until = every;
            keep(state, y, rigid);
            drive_write(state, samples + 5 * row);
            positions[row++] = state->position;
        }
    }
    keep(state, y, rigid);
    return levels.taken;
}
