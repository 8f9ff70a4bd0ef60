/* Joints: where motion may pass, where it must stop, and the cubic that takes a corner inside its tolerance.
 *
 * Two lines.  From d before the corner to d after, x' turns evenly from T1 to T2 over a range 2d of s: a parabola.
 *   x'' = (T2 - T1) / 2d, deviation at the corner (the greatest) = d |T2 - T1| / 4.
 * Its points at s lie that near the programmed points at s, so the bound holds both ways (Hausdorff).  It beats the arc
 * of a circle because axis limits are a box and the corner's acceleration points one way.
 *
 * Where one of the two is slower, braking (or speeding up) in the faster move's half has to share the acceleration with
 * turning.  Passed at the slower speed v, a blend needs d = v^2 max |m| / 2A; it gets no more than four times that, a
 * quarter of the acceleration, or rounding the corner would cost more time than stopping there.
 *
 * A line and an arc, or two arcs.  Either the same from both sides (cubic by Hermite: ends and tangents), or, where
 * directions differ little, on one arc alone: with an error e of direction at one end of d the cubic needs 4 e / d more
 * curvature and leaves the programmed path by 4 e d / 27, while the jump of curvature at the joint stays the one the
 * program has.  Deviation is proven from samples: between two of them, delta apart, the difference of the two curves
 * cannot exceed its ends by more than delta^2 / 8 times the bound of its second derivative. */
#include <math.h>

#include "host/path_curve.h"

static const double TANGENT = 1e-6;     /* rad: directions closer than this are the same */
static const double REVERSAL = -0.9994; /* cosine: within 2 degrees of turning back, stop */
static const double ARC_SHARE = 0.2;    /* rad: how much of an arc a one-sided blend replaces at most */
static const double ARC_BOTH = 0.35;    /* rad: and a two-sided one */
static const double ALONE = 0.1;        /* rad: beyond this a one-sided blend would swing out noticeably */
static const double PACE = 0.999;       /* part of the faster move's speed from which the slower counts as as fast */
enum { SAMPLES = 16 };

static double norm_between(const double *vector, uint32_t from, uint32_t to) {
    double square = 0.0;
    for (uint32_t i = from; i < to; i++)
        square += vector[i] * vector[i];
    return sqrt(square);
}

double trochia_group_norm(const trochia_frame *frame, const double *vector) {
    double greatest = 0.0;
    for (int k = 0; k < 3; k++)
        if (frame->groups[k + 1] > frame->groups[k])
            greatest = fmax(greatest, norm_between(vector, frame->groups[k], frame->groups[k + 1]));
    return greatest;
}

int trochia_is_tangent(const trochia_frame *frame, const double *before, const double *jump) {
    for (int k = 0; k < 3; k++) {
        uint32_t from = frame->groups[k], to = frame->groups[k + 1];
        if (from < to && norm_between(jump, from, to) > TANGENT * fmax(1.0, norm_between(before, from, to)))
            return 0;
    }
    return 1;
}

int trochia_is_reversal(uint32_t n, const double *before, const double *after) {
    double dot = 0.0, one = 0.0, two = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        dot += before[i] * after[i];
        one += before[i] * before[i];
        two += after[i] * after[i];
    }
    return dot < 0.0 && dot * dot > REVERSAL * REVERSAL * one * two;
}

/* Speed of a move by its feed and the axes' velocities. */
static double pace_of(const trochia_frame *frame, double speed, const double *direction) {
    double slowness = 1.0 / speed;
    for (uint32_t i = 0; i < frame->n; i++)
        slowness = fmax(slowness, fabs(direction[i]) * frame->in->slowness[i]);
    return 1.0 / slowness;
}

double trochia_pace_room(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const double *jump) {
    const trochia_path_input *in = frame->in;
    if (!in->paced)
        return INFINITY;
    double before = pace_of(frame, a->speed, a->t1), after = pace_of(frame, b->speed, b->t0);
    double slow = fmin(before, after), effort = 0.0, shake = 0.0;
    if (slow > PACE * fmax(before, after))
        return INFINITY;
    for (uint32_t i = 0; i < frame->n; i++) {
        effort = fmax(effort, fabs(jump[i]) * in->effort[i]);
        shake = fmax(shake, fabs(jump[i]) * in->shake[i]);
    }
    double bend = slow * slow * effort;
    return in->continuity > 1 ? fmax(4.0 * bend, sqrt(8.0 * slow * slow * slow * shake)) : 2.0 * bend;
}

/* The ways to take a joint where an arc takes part, the least curved of them. */
static void want_at_arc(const trochia_curve *a, const trochia_curve *b, double jump, double tolerance,
                        trochia_joint *joint) {
    double both = fmin(4.0 * tolerance / jump, 0.5 * fmin(a->length, b->length));
    both = fmin(both, ARC_BOTH / fmax(a->kappa, b->kappa));
    double cost = fmax(a->kappa, b->kappa) + 0.25 * fabs(a->kappa - b->kappa) + 0.5 * jump / both;
    joint->before = joint->after = fmin(4.0 * tolerance / jump, ARC_BOTH / fmax(a->kappa, b->kappa));
    for (int side = 0; side < 2; side++) {
        const trochia_curve *curve = side ? b : a;
        if (curve->kappa == 0.0 || jump > ALONE)
            continue;
        double alone = fmin(ARC_SHARE / curve->kappa, 6.5 * tolerance / jump);
        double curved = curve->kappa + 4.0 * jump / fmin(alone, 0.5 * curve->length);
        if (curved < cost) {
            cost = curved;
            joint->before = side ? 0.0 : alone;
            joint->after = side ? alone : 0.0;
        }
    }
}

trochia_joint trochia_joint_wanted(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b) {
    trochia_joint joint = {0.0, 0.0, 0};
    double jump[9] = {0.0};
    if (b->inner)
        return joint;
    if (a->settle || b->halt) {
        joint.stop = 1;
        return joint;
    }
    for (uint32_t i = 0; i < frame->n; i++)
        jump[i] = b->t0[i] - a->t1[i];
    if (trochia_is_tangent(frame, a->t1, jump))
        return joint;
    double tolerance = fmin(a->tolerance, b->tolerance);
    if (!(tolerance > 0.0) || trochia_is_reversal(frame->n, a->t1, b->t0)) {
        joint.stop = 1;
        return joint;
    }
    double size = trochia_group_norm(frame, jump), room = trochia_pace_room(frame, a, b, jump);
    if (a->kappa > 0.0 || b->kappa > 0.0) {
        want_at_arc(a, b, size, tolerance, &joint);
        joint.before = fmin(joint.before, room);
        joint.after = fmin(joint.after, room);
    } else
        joint.before = joint.after = fmin(4.0 * tolerance / size, room);
    return joint;
}

/* The cubic over [0, h] with these ends and tangents. */
static void hermite(uint32_t n, const double *from, const double *to, double h, trochia_blend *blend) {
    double *c = blend->c;
    for (uint32_t i = 0; i < n; i++) {
        double mean = (to[i] - from[i]) / h;
        c[i] = from[i];
        c[n + i] = from[n + i];
        c[2 * n + i] = (3.0 * mean - 2.0 * from[n + i] - to[n + i]) / h;
        c[3 * n + i] = (from[n + i] + to[n + i] - 2.0 * mean) / (h * h);
    }
    blend->length = h;
}

static void parabola(uint32_t n, const trochia_curve *a, const trochia_curve *b, double d, trochia_blend *blend) {
    double *c = blend->c;
    for (uint32_t i = 0; i < n; i++) {
        c[i] = a->x1[i] - d * a->t1[i];
        c[n + i] = a->t1[i];
        c[2 * n + i] = (b->t0[i] - a->t1[i]) / (4.0 * d);
        c[3 * n + i] = 0.0;
    }
    blend->length = 2.0 * d;
}

/* Upper bound of the distance between blend and programmed path over one side, point by point of s. */
static double side_deviation(const trochia_frame *frame, const trochia_curve *curve, double from, double width,
                             double offset, const trochia_blend *blend) {
    uint32_t n = frame->n;
    double programmed[9], apart[9], bend[9], greatest = 0.0, delta = width / SAMPLES;
    for (int k = 0; k <= SAMPLES; k++) {
        double s = offset + delta * k;
        trochia_curve_at(curve, n, from + delta * k, 1, programmed);
        for (uint32_t i = 0; i < n; i++) {
            const double *c = blend->c + i;
            apart[i] = c[0] + s * (c[n] + s * (c[2 * n] + s * c[3 * n])) - programmed[i];
        }
        greatest = fmax(greatest, trochia_group_norm(frame, apart));
    }
    double bent = 0.0;
    for (int end = 0; end < 2; end++) {
        for (uint32_t i = 0; i < n; i++)
            bend[i] = 2.0 * blend->c[2 * n + i] + 6.0 * blend->c[3 * n + i] * (offset + width * end);
        bent = fmax(bent, trochia_group_norm(frame, bend));
    }
    return greatest + delta * delta / 8.0 * (bent + curve->kappa);
}

static double deviation(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                        const trochia_joint *joint, const trochia_blend *blend) {
    double greatest = 0.0;
    if (joint->before > 0.0)
        greatest = side_deviation(frame, a, a->length - joint->before, joint->before, 0.0, blend);
    if (joint->after > 0.0)
        greatest = fmax(greatest, side_deviation(frame, b, 0.0, joint->after, joint->before, blend));
    return greatest;
}

void trochia_joint_blend(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         trochia_joint *joint, trochia_blend *blend) {
    double tolerance = fmin(a->tolerance, b->tolerance), from[18], to[18];
    if (a->kappa == 0.0 && b->kappa == 0.0) {
        parabola(frame->n, a, b, joint->before, blend);
        return;
    }
    for (int attempt = 0; attempt < 40; attempt++) {
        trochia_curve_at(a, frame->n, a->length - joint->before, 2, from);
        trochia_curve_at(b, frame->n, joint->after, 2, to);
        hermite(frame->n, from, to, joint->before + joint->after, blend);
        double greatest = deviation(frame, a, b, joint, blend);
        if (greatest <= tolerance)
            return;
        double shrink = fmin(0.95, fmax(0.3, 0.95 * sqrt(tolerance / greatest)));
        joint->before *= shrink;
        joint->after *= shrink;
    }
    joint->before = joint->after = 0.0;
    joint->stop = 1;
}
