/* What a corner of two lines costs: stopped at, rounded by a triangle of x'', or passed as an overlap of its moves; and
 * whether a joint of an arc is worth its bridge.
 *
 * Of each the time from the middle of the one line to the middle of the other is found, as if all corners beside it
 * were alike: ramps of limited acceleration and jerk lead from the corner's speed to the greatest there is room for.
 * What is gained by passing is lost where the even speed inside is low: a triangle is entered with a = 0. */
#include <math.h>

#include "host/path_smooth.h"

/* Turning shares the limits with speeding up: what is left of jerk, as ramps turn out. */
static const double LEFT_ON_ARCS = 0.35, LEFT_ON_SPLINES = 0.6;

/* One line beside a corner: half its length, its greatest speed, and what its direction leaves of the limits. */
typedef struct {
    double way, pace, a, j;
} trochia_side;

/* Speeding up by `rise`, a being 0 at both ends [s]. */
static double ramp_time(const trochia_side *side, double rise) {
    double bend = side->a * side->a / side->j;
    return rise < bend ? 2.0 * sqrt(rise / side->j) : rise / side->a + side->a / side->j;
}

/* From a = 0 at speed v over `way`, to a = 0 again [s]. */
static double time_over(const trochia_side *side, double v, double way) {
    double top = side->pace, time = ramp_time(side, fmax(top - v, 0.0)), need = 0.5 * (v + top) * time;
    if (!(way > 0.0))
        return 0.0;
    if (need <= way)
        return time + (way - need) / fmax(top, v);
    double bend = side->a * side->a / side->j, half = 0.5 * bend;
    double reached = sqrt(fmax(half * half - bend * v + v * v + 2.0 * way * side->a, 0.0)) - half;
    if (reached - v >= bend)
        return ramp_time(side, reached - v);
    /* (2 v + j y^2) y = way, y half of the time; from the right Newton's method does not overshoot */
    double y = cbrt(way / side->j);
    for (int k = 0; k < 4; k++)
        y -= ((2.0 * v + side->j * y * y) * y - way) / (2.0 * v + 3.0 * side->j * y * y);
    return 2.0 * y;
}

/* 1 / greatest part of the limits that a vector asks for. */
static double left_by(const double *vector, const double *parts, uint32_t n) {
    double greatest = 0.0;
    for (uint32_t i = 0; i < n; i++)
        greatest = fmax(greatest, fabs(vector[i]) * parts[i]);
    return 1.0 / greatest;
}

static trochia_side side_of(const trochia_path_input *in, const trochia_curve *line, uint32_t n) {
    return (trochia_side){0.5 * line->length, fmin(line->speed, left_by(line->t0, in->slowness, n)),
                          left_by(line->t0, in->effort, n), left_by(line->t0, in->shake, n)};
}

/* A corner between two lines; twist: 1 / greatest part of jerk that T1 + T2 asks for. */
typedef struct {
    trochia_side side[2];
    double slow, twist;
} trochia_lone;

static double stop_time(const trochia_lone *corner) {
    return time_over(&corner->side[0], 0.0, corner->side[0].way) +
           time_over(&corner->side[1], 0.0, corner->side[1].way);
}

static double triangle_time(const trochia_path_input *in, const trochia_lone *corner, const trochia_turn *turn,
                            double leg, uint32_t n) {
    double v = sqrt(leg * left_by(turn->jump, in->effort, n)), time = 0.0;
    v = fmin(fmin(corner->slow, v), cbrt(leg * leg * left_by(turn->jump, in->shake, n)));
    for (int k = 0; k < 2; k++) {
        double inside = fmin(leg, corner->side[k].way);
        time += inside / v + time_over(&corner->side[k], v, corner->side[k].way - inside);
    }
    return time;
}

/* Both lines have begun to slow down before it, and to speed up in it: as if from a = 0 at a lower speed. */
static double overlap_time(const trochia_lone *corner, double length) {
    double v = fmin(corner->slow, cbrt(0.5 * length * length * corner->twist)), time = 0.0;
    for (int k = 0; k < 2; k++)
        v = fmin(v, sqrt(0.5 * length * corner->side[k].a));
    for (int k = 0; k < 2; k++) { /* what is faster beside it must not be faster than the feed */
        double part = 2.0 / (length * length * corner->side[k].j);
        for (int step = 0; step < 4; step++) {
            double cube = part * v * v * v;
            if (v + cube * v > corner->side[k].pace)
                v -= (v + cube * v - corner->side[k].pace) / (1.0 + 4.0 * cube);
        }
    }
    for (int k = 0; k < 2; k++) {
        const trochia_side *side = &corner->side[k];
        double a = 2.0 * v * v / length, early = a / side->j, slow = fmax(v - 0.5 * a * early, 0.0);
        double way = side->way - length / 3.0 + early * (slow + a * early / 6.0);
        time += time_over(side, slow, way) - early;
    }
    return time + length / v;
}

/* Beyond this range an overlap is passed no faster: half of the way of a stop's last ramp. */
static double useful(const trochia_lone *corner) {
    double w = corner->slow, j = fmin(corner->side[0].j, corner->side[1].j);
    for (int k = 0; k < 2; k++)
        w = fmin(w, corner->side[k].a * corner->side[k].a / corner->side[k].j);
    return 0.5 * w * sqrt(w * fmax(1.0 / j, 1.0 / corner->twist));
}

int trochia_corner_worth(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const trochia_turn *turn, double leg, double *length) {
    const trochia_path_input *in = frame->in;
    uint32_t n = frame->n;
    double both[9];
    for (uint32_t i = 0; i < n; i++)
        both[i] = a->t1[i] + b->t0[i];
    trochia_lone corner = {{side_of(in, a, n), side_of(in, b, n)}, 0.0, left_by(both, in->shake, n)};
    corner.slow = fmin(corner.side[0].pace, corner.side[1].pace);
    if (!in->paced || !(corner.side[0].j < INFINITY) || !(corner.side[1].j < INFINITY))
        return TROCHIA_TURN_OVERLAP;
    *length = fmin(*length, useful(&corner));
    double stop = stop_time(&corner), triangle = triangle_time(in, &corner, turn, leg, n);
    double overlap = overlap_time(&corner, *length);
    if (overlap <= triangle)
        return overlap <= stop ? TROCHIA_TURN_OVERLAP : TROCHIA_TURN_STOP;
    return triangle <= stop ? TROCHIA_TURN_CORNER : TROCHIA_TURN_STOP;
}

/* Greatest of what the axes that a curve bends ask of their limits. */
static double greatest_bent(const trochia_curve *curve, const double *parts, uint32_t n) {
    if (curve->kind == TROCHIA_ARC_SEGMENT)
        return fmax(parts[curve->first], parts[curve->second]);
    double greatest = 0.0;
    for (uint32_t i = 0; i < n; i++)
        if (curve->c[2 * n + i] != 0.0 || curve->c[3 * n + i] != 0.0)
            greatest = fmax(greatest, parts[i]);
    return greatest;
}

/* A curve beside a joint, `direction` there: its own bend binds its pace; a piece of a spline goes on as far as speed
 * needs. */
static trochia_side side_at(const trochia_frame *frame, const trochia_curve *curve, const double *direction) {
    const trochia_path_input *in = frame->in;
    uint32_t n = frame->n;
    trochia_side side = {0.5 * curve->length, fmin(curve->speed, left_by(direction, in->slowness, n)),
                         left_by(direction, in->effort, n), left_by(direction, in->shake, n)};
    if (curve->kind == TROCHIA_LINE)
        return side;
    side.pace = fmin(side.pace, 1.0 / sqrt(curve->kappa * greatest_bent(curve, in->effort, n)));
    side.pace = fmin(side.pace, 1.0 / cbrt(curve->kappa * curve->kappa * greatest_bent(curve, in->shake, n)));
    double part = curve->kind == TROCHIA_ARC_SEGMENT ? LEFT_ON_ARCS : LEFT_ON_SPLINES;
    side.j *= part;
    side.a *= sqrt(part);
    if (curve->kind == TROCHIA_CUBIC)
        side.way = fmax(side.way, 0.5 * side.pace * ramp_time(&side, side.pace));
    return side;
}

/* Greatest even speed over a bridge. */
static double bridge_speed(const trochia_path_input *in, const trochia_bridge *bridge, uint32_t n) {
    double v = INFINITY;
    for (int piece = 0; piece < 3; piece++) {
        const double *c = bridge->c[piece];
        double bend[9];
        for (uint32_t i = 0; i < n; i++)
            bend[i] = fmax(fabs(2.0 * c[2 * n + i]), fabs(2.0 * c[2 * n + i] + 6.0 * bridge->length * c[3 * n + i]));
        v = fmin(v, fmin(sqrt(left_by(bend, in->effort, n)), cbrt(left_by(c + 3 * n, in->shake, n) / 6.0)));
    }
    return v;
}

int trochia_bridge_worth(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const trochia_turn *turn) {
    const trochia_path_input *in = frame->in;
    trochia_side before = side_at(frame, a, a->t1), after = side_at(frame, b, b->t0);
    if (!in->paced || !(before.j < INFINITY) || !(after.j < INFINITY))
        return 1;
    trochia_bridge bridge;
    trochia_bridge_make(frame, a, b, turn, &bridge);
    double v = fmin(fmin(before.pace, after.pace), bridge_speed(in, &bridge, frame->n));
    double stop = time_over(&before, 0.0, before.way) + time_over(&after, 0.0, after.way);
    double pass = time_over(&before, v, before.way - turn->before) + time_over(&after, v, after.way - turn->after);
    return pass + (fmin(turn->before, before.way) + fmin(turn->after, after.way)) / v <= stop;
}
