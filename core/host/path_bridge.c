/* Joints where an arc takes part, with continuous curvature: three cubics of equal length k over [-d, d] about the
 * joint, with place, direction and bend of the programmed path at both ends.
 *
 * x'' is even between its values K0 y1 y2 K1 at the knots.  Direction and place at the far end give
 *   y1 + y2 = (T1 - T0) / k - (K0 + K1) / 2,   4/3 K0 + 2 y1 + y2 + K1 / 6 = (X1 - X0 - 3 k T0) / k^2.
 * A jump m of direction alone leaves the programmed path by 0.1806 d |m|, a jump q of bend alone by 0.0045 d^2 |q|.
 * Deviation is proven from samples: between two of them, delta apart, the difference of the two curves cannot exceed
 * its ends by more than delta^2 / 8 times the bound of its second derivative. */
#include <math.h>
#include <string.h>

#include "host/path_smooth.h"

static const double TANGENT = 1e-6; /* rad: directions closer than this are the same; the same part of the bend */
static const double STRAIGHT = 1e-9;
static const double ARC_BOTH = 0.6; /* rad: how much of an arc is replaced at most */
static const double SHORT = 1e-5;   /* mm: below this, differences of places tell no direction any more */
enum { SAMPLES = 16 };

static void bend_at(const trochia_curve *curve, uint32_t n, double s, double *x) {
    if (curve->kind == TROCHIA_LINE)
        memset(x + 2 * n, 0, n * sizeof *x);
    trochia_curve_at(curve, n, s, curve->kind == TROCHIA_LINE ? 2 : 3, x);
}

static void classify_arc(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         trochia_turn *turn) {
    double before[27], after[27], apart[9], kappa = fmax(a->kappa, b->kappa);
    uint32_t n = frame->n;
    bend_at(a, n, a->length, before);
    bend_at(b, n, 0.0, after);
    for (uint32_t i = 0; i < n; i++)
        apart[i] = after[2 * n + i] - before[2 * n + i];
    double jump = trochia_group_norm(frame, apart);
    if (trochia_is_tangent(frame, a->t1, turn->jump) && jump <= TANGENT * kappa)
        return;
    turn->kind = turn->tolerance > 0.0 ? TROCHIA_TURN_ARC : TROCHIA_TURN_STOP;
    double even = 0.1806 * turn->size, square = 0.0045 * jump;
    double most = 2.0 * turn->tolerance / (even + sqrt(even * even + 4.0 * square * turn->tolerance));
    turn->wish = fmin(fmin(most, ARC_BOTH / kappa), trochia_pace_room(frame, a, b, turn->jump));
}

void trochia_turn_classify(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                           trochia_turn *turn) {
    memset(turn, 0, sizeof *turn);
    if (b->inner)
        return;
    if (a->settle || b->halt) {
        turn->kind = TROCHIA_TURN_STOP;
        return;
    }
    for (uint32_t i = 0; i < frame->n; i++)
        turn->jump[i] = b->t0[i] - a->t1[i];
    turn->size = trochia_group_norm(frame, turn->jump);
    turn->tolerance = fmax(fmin(a->tolerance, b->tolerance), 0.0);
    if (trochia_is_reversal(frame->n, a->t1, b->t0)) {
        turn->kind = TROCHIA_TURN_STOP;
        return;
    }
    if (a->kind != TROCHIA_LINE || b->kind != TROCHIA_LINE) {
        classify_arc(frame, a, b, turn);
        return;
    }
    if (turn->size <= STRAIGHT || (turn->tolerance == 0.0 && trochia_is_tangent(frame, a->t1, turn->jump)))
        return;
    turn->kind = turn->tolerance > 0.0 ? TROCHIA_TURN_CORNER : TROCHIA_TURN_STOP;
    turn->wish = fmin(6.0 * turn->tolerance / turn->size, trochia_pace_room(frame, a, b, turn->jump));
    if (frame->in->overlap && turn->kind == TROCHIA_TURN_CORNER)
        trochia_overlap_want(frame, a, b, turn);
}

static void next_piece(uint32_t n, const double *c, double k, double *d) {
    for (uint32_t i = 0; i < n; i++) {
        d[i] = c[i] + k * (c[n + i] + k * (c[2 * n + i] + k * c[3 * n + i]));
        d[n + i] = c[n + i] + k * (2.0 * c[2 * n + i] + k * 3.0 * c[3 * n + i]);
    }
}

void trochia_bridge_make(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const trochia_turn *turn, trochia_bridge *bridge) {
    uint32_t n = frame->n;
    double from[27], to[27], y[4][9], k = (turn->before + turn->after) / 3.0;
    bend_at(a, n, a->length - turn->before, from);
    bend_at(b, n, turn->after, to);
    for (uint32_t i = 0; i < n; i++) {
        double k0 = from[2 * n + i], k1 = to[2 * n + i];
        double sum = (to[n + i] - from[n + i]) / k - 0.5 * (k0 + k1);
        double moment = (to[i] - from[i] - 3.0 * k * from[n + i]) / (k * k);
        y[0][i] = k0;
        y[1][i] = moment - 4.0 / 3.0 * k0 - k1 / 6.0 - sum;
        y[2][i] = sum - y[1][i];
        y[3][i] = k1;
    }
    for (int piece = 0; piece < 3; piece++) {
        double *c = bridge->c[piece];
        if (piece == 0)
            memcpy(c, from, 2 * n * sizeof *c);
        else
            next_piece(n, bridge->c[piece - 1], k, c);
        for (uint32_t i = 0; i < n; i++) {
            c[2 * n + i] = 0.5 * y[piece][i];
            c[3 * n + i] = (y[piece + 1][i] - y[piece][i]) / (6.0 * k);
        }
    }
    bridge->length = k;
}

static void bridge_at(const trochia_bridge *bridge, uint32_t n, double s, double *x) {
    int piece = (int)fmin(fmax(s / bridge->length, 0.0), 2.0);
    const double *c = bridge->c[piece];
    s -= piece * bridge->length;
    for (uint32_t i = 0; i < n; i++)
        x[i] = c[i] + s * (c[n + i] + s * (c[2 * n + i] + s * c[3 * n + i]));
}

static double side_deviation(const trochia_frame *frame, const trochia_curve *curve, double from, double width,
                             double offset, const trochia_bridge *bridge) {
    double programmed[9], apart[9], greatest = 0.0, delta = width / SAMPLES;
    for (int k = 0; k <= SAMPLES; k++) {
        trochia_curve_at(curve, frame->n, from + delta * k, 1, programmed);
        bridge_at(bridge, frame->n, offset + delta * k, apart);
        for (uint32_t i = 0; i < frame->n; i++)
            apart[i] -= programmed[i];
        greatest = fmax(greatest, trochia_group_norm(frame, apart));
    }
    return greatest;
}

/* Upper bound of the distance between the bridge and the programmed path, point by point of s. */
static double deviation(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                        const trochia_turn *turn, const trochia_bridge *bridge) {
    uint32_t n = frame->n;
    double bend[9], bent = 0.0, delta = fmax(turn->before, turn->after) / SAMPLES;
    double one = side_deviation(frame, a, a->length - turn->before, turn->before, 0.0, bridge);
    double two = side_deviation(frame, b, 0.0, turn->after, turn->before, bridge);
    for (int knot = 0; knot <= 3; knot++) {
        const double *c = bridge->c[knot == 3 ? 2 : knot];
        for (uint32_t i = 0; i < n; i++)
            bend[i] = 2.0 * c[2 * n + i] + (knot == 3 ? 6.0 * bridge->length * c[3 * n + i] : 0.0);
        bent = fmax(bent, trochia_group_norm(frame, bend));
    }
    return fmax(one, two) + delta * delta / 8.0 * (bent + fmax(a->kappa, b->kappa));
}

void trochia_bridge_settle(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                           trochia_turn *turn) {
    trochia_bridge bridge;
    for (int attempt = 0; attempt < 40 && turn->before > SHORT; attempt++) {
        trochia_bridge_make(frame, a, b, turn, &bridge);
        double greatest = deviation(frame, a, b, turn, &bridge);
        if (greatest <= turn->tolerance)
            return;
        turn->before *= fmin(0.95, fmax(0.3, 0.95 * sqrt(turn->tolerance / greatest)));
        turn->after = turn->before;
    }
    turn->before = turn->after = 0.0;
    turn->kind = TROCHIA_TURN_STOP;
}
