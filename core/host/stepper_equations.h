/* The equations of a stepper's shaft and of a load behind a coupling, stated once for both of its kernels.  Legend: see
 * stepper.h; s and c are sine and cosine of p x. */
#ifndef TROCHIA_STEPPER_EQUATIONS_H
#define TROCHIA_STEPPER_EQUATIONS_H

#include <math.h>

#include "host/stepper.h"

typedef struct {
    double k, p, d, b, f, load, per_j, creep2;
    double stiffness, damping, b_l, f_l, load_l, per_jl;
} stepper_shaft;

static inline stepper_shaft stepper_prepare(const trochia_stepper *m, const trochia_coupling *c) {
    const stepper_shaft q = {.k = m->torque_constant,
                             .p = m->teeth,
                             .d = 4.0 * m->detent,
                             .b = m->viscous,
                             .f = m->friction,
                             .load = m->load,
                             .per_j = 1.0 / m->inertia,
                             .creep2 = m->creep * m->creep,
                             .stiffness = c->stiffness,
                             .damping = c->damping,
                             .b_l = c->viscous,
                             .f_l = c->friction,
                             .load_l = c->load,
                             .per_jl = c->stiffness > 0.0 ? 1.0 / c->inertia : 0.0};
    return q;
}

/* What is of one size against a motion or a current, smoothed where that turns round. */
static inline double stepper_dry(double size, double x, double knee2) {
    return size > 0.0 ? size * x / sqrt(x * x + knee2) : 0.0;
}

/* On the rotor, all but the coupling; 4 d s c (1 - 2 s^2) is d sin(4 p x). */
static inline double stepper_torque(const stepper_shaft *q, double ia, double ib, double s, double c, double omega) {
    return q->k * (ib * c - ia * s) - q->d * s * c * (1.0 - 2.0 * s * s) - q->b * omega - q->load -
           stepper_dry(q->f, omega, q->creep2);
}

/* Torque that the coupling takes from the rotor, which is at x with speed w; the load is at y with speed u. */
static inline double stepper_coupling(const stepper_shaft *q, double x, double w, double y, double u) {
    return q->stiffness * (x - y) + q->damping * (w - u);
}

/* On the load, which is given `across` by the coupling. */
static inline double stepper_behind(const stepper_shaft *q, double across, double u) {
    return across - q->b_l * u - q->load_l - stepper_dry(q->f_l, u, q->creep2);
}

#endif
