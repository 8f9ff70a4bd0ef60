/* A joint's position over a stretch of a phase as a polynomial of degree 9, for steps.c alone.
 *
 * Along a segment the joint is q(s): a cubic, or an arc g0 + g1 s + r (x cos phi + y sin phi).  With u = (tau - mid) /
 * half in [-1, 1] and s(tau) a cubic, the first is a polynomial of degree 9 exactly; of the second we take the Taylor
 * polynomial.  What is cut off: cos and sin of phi(mid) + p(u) have series whose terms are no larger than those of
 * exp(P(u)), P the polynomial of |coefficients| of p; all terms of that are positive, so those beyond u^9 sum at u = 1
 * to at most R^-10 exp(P(R)) for any R >= 1.  Asking P(R) <= 10 with R = e (amplitude / tolerance)^(1/10) makes the
 * rest no larger than the tolerance. */
#ifndef TROCHIA_STEPS_SERIES_H
#define TROCHIA_STEPS_SERIES_H

#include <math.h>
#include <string.h>

#include "host/steps.h"

enum { TERMS = 10 };
static const double TRUNCATION = 1e-9; /* steps */

typedef struct {
    int arc;
    double g[4]; /* q = g0 + g1 s + g2 s^2 + g3 s^3, and on arcs the turning part on top */
    double x, y; /* steps per unit of the plane's axes */
    double radius, radius_rate, angle, angle_rate, angle_curve;
    double length, reach; /* of the segment; R of the bound above */
} joint_curve;

/* Motion along s with time in ticks. */
typedef struct {
    double s, v, a, j;
} phase_motion;

static inline double dot(int32_t n, const double *a, const double *b) {
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static inline void arc_curve(const trochia_step_job *job, const trochia_segment *segment, joint_curve *curve) {
    const double *data = job->pool + segment->data;
    curve->x = job->row[segment->first];
    curve->y = job->row[segment->second];
    curve->arc = curve->x != 0.0 || curve->y != 0.0;
    curve->g[0] = curve->x * data[0] + curve->y * data[1] + dot(job->axes, job->row, data + 6);
    curve->g[1] = dot(job->axes, job->row, data + 6 + job->axes);
    curve->length = segment->length;
    curve->radius = data[2];
    curve->angle = data[3];
    curve->angle_rate = data[4];
    curve->radius_rate = data[5];
    curve->angle_curve = data[6 + 2 * job->axes];
    if (curve->arc) {
        double amplitude = hypot(curve->x, curve->y) * (fabs(data[2]) + 2.0 * fabs(data[5]) * segment->length);
        curve->reach = 2.718281828459045 * pow(fmax(amplitude / TRUNCATION, 1.0), 1.0 / TERMS);
    }
}

static inline void curve_of(const trochia_step_job *job, const trochia_segment *segment, joint_curve *curve) {
    const double *data = job->pool + segment->data;
    memset(curve, 0, sizeof *curve);
    if (segment->kind == TROCHIA_ARC_SEGMENT) {
        arc_curve(job, segment, curve);
        return;
    }
    int terms = segment->kind == TROCHIA_LINE ? 2 : 4;
    for (int i = 0; i < terms; i++)
        curve->g[i] = dot(job->axes, job->row, data + i * job->axes);
}

/* c = g(s + p), p = p1 u + p2 u^2 + p3 u^3. */
static inline void cubic_series(const double *g, double s, const double *p, double *c) {
    double first = g[1] + s * (2.0 * g[2] + s * 3.0 * g[3]);
    double second = g[2] + s * 3.0 * g[3];
    double square[7] = {
        0.0, 0.0, p[1] * p[1], 2.0 * p[1] * p[2], p[2] * p[2] + 2.0 * p[1] * p[3], 2.0 * p[2] * p[3], p[3] * p[3]};
    memset(c, 0, TERMS * sizeof *c);
    c[0] = g[0] + s * (g[1] + s * (g[2] + s * g[3]));
    for (int i = 1; i <= 3; i++)
        c[i] = first * p[i];
    for (int i = 2; i <= 6; i++) {
        c[i] += second * square[i];
        for (int k = 1; k <= 3; k++)
            c[i + k] += g[3] * square[i] * p[k];
    }
}

/* phi(s + p) - phi(s) = t1 u + ... + t6 u^6; returns the last power there is (6 on a spiral, 1 at one speed). */
static inline int turn_series(const joint_curve *curve, double s, const double *p, double *t) {
    double rate = curve->angle_rate + 2.0 * s * curve->angle_curve, bend = curve->angle_curve;
    for (int i = 1; i <= 3; i++)
        t[i] = rate * p[i];
    if (bend == 0.0)
        return p[2] == 0.0 && p[3] == 0.0 ? 1 : 3;
    t[2] += bend * p[1] * p[1];
    t[3] += bend * 2.0 * p[1] * p[2];
    t[4] = bend * (p[2] * p[2] + 2.0 * p[1] * p[3]);
    t[5] = bend * 2.0 * p[2] * p[3];
    t[6] = bend * p[3] * p[3];
    return 6;
}

/* How much of the length the bound above allows is used, on the turn and on the radius; beyond 1 it is too long. */
static inline double used_of(const joint_curve *curve, const double *p, const double *t, int powers) {
    double r = curve->reach, bound = 0.0;
    for (int i = powers; i > 0; i--)
        bound = r * (bound + fabs(t[i]));
    double way = curve->radius_rate != 0.0 ? r * (fabs(p[1]) + r * (fabs(p[2]) + r * fabs(p[3]))) / curve->length : 0.0;
    return fmax(0.1 * bound, way);
}

/* Adds r(s + p) (x cos phi + y sin phi): e is that bracket, f its derivative to phi; e' = f phi', f' = -e phi'. */
static inline void add_arc_series(const joint_curve *curve, double s, const double *p, const double *t, int powers,
                                  double *c) {
    double phi = curve->angle + s * (curve->angle_rate + s * curve->angle_curve), cosine = cos(phi), sine = sin(phi);
    double e[TERMS] = {curve->x * cosine + curve->y * sine}, f[TERMS] = {curve->y * cosine - curve->x * sine};
    for (int n = 1; n < TERMS; n++) {
        double sum_e = 0.0, sum_f = 0.0;
        for (int i = 1; i <= powers && i <= n; i++) {
            sum_e += i * t[i] * f[n - i];
            sum_f -= i * t[i] * e[n - i];
        }
        e[n] = sum_e / n;
        f[n] = sum_f / n;
    }
    double r = curve->radius + curve->radius_rate * s;
    for (int n = 0; n < TERMS; n++) {
        c[n] += r * e[n];
        for (int i = 1; i <= 3 && i <= n; i++)
            c[n] += curve->radius_rate * p[i] * e[n - i];
    }
}

/* Fills c for the stretch mid +- half; returns how much of the allowed length that uses, more than 1: not filled. */
static inline double series_of(const joint_curve *curve, const phase_motion *m, double mid, double half, double *c) {
    double s = m->s + mid * (m->v + mid * (0.5 * m->a + mid * m->j / 6.0)), t[7], used = 0.0;
    double p[4] = {0.0, (m->v + mid * (m->a + mid * 0.5 * m->j)) * half, 0.5 * (m->a + mid * m->j) * half * half,
                   m->j * half * half * half / 6.0};
    int powers = curve->arc ? turn_series(curve, s, p, t) : 0;
    if (curve->arc)
        used = used_of(curve, p, t, powers);
    if (used > 1.0)
        return used;
    cubic_series(curve->g, s, p, c);
    if (curve->arc && powers == 1)
        add_arc_series(curve, s, p, t, 1, c);
    else if (curve->arc && powers == 3)
        add_arc_series(curve, s, p, t, 3, c);
    else if (curve->arc)
        add_arc_series(curve, s, p, t, 6, c);
    return used;
}

#endif
