/* A program's moves as curves, one at a time. */
#include <math.h>
#include <string.h>

#include "host/path_curve.h"

static const double NOTHING = 1e-9; /* mm or degree: shorter moves do not move */
static const double TURN = 6.28318530717958647693;

static double distance(const double *step, uint32_t from, uint32_t to) {
    double square = 0.0;
    for (uint32_t i = from; i < to; i++)
        square += step[i] * step[i];
    return sqrt(square);
}

/* Length by the rule of feeds: X Y Z, else U V W, else A B C; 0 when nothing moves. */
static double lead_length(const trochia_frame *frame, const double *step) {
    static const int ORDER[3] = {0, 2, 1};
    for (int k = 0; k < 3; k++) {
        double length = distance(step, frame->groups[ORDER[k]], frame->groups[ORDER[k] + 1]);
        if (length > NOTHING)
            return length;
    }
    return 0.0;
}

void trochia_read_line(const trochia_reader *r, const double *target, trochia_curve *curve) {
    uint32_t n = r->frame.n;
    double step[9];
    for (uint32_t i = 0; i < n; i++)
        step[i] = target[i] - r->position[i];
    curve->kind = TROCHIA_LINE;
    curve->kappa = 0.0;
    curve->length = lead_length(&r->frame, step);
    if (curve->length == 0.0)
        return;
    double scale = 1.0 / curve->length;
    for (uint32_t i = 0; i < n; i++) {
        curve->x0[i] = r->position[i];
        curve->x1[i] = target[i];
        curve->t0[i] = curve->t1[i] = step[i] * scale;
    }
}

static uint8_t column_of(const trochia_path_input *in, uint32_t letter) {
    for (uint32_t i = 0; i < in->axes; i++)
        if (in->columns[i] == letter)
            return (uint8_t)i;
    return 0;
}

/* Signed angle of the arc: `turns` counts the turns begun, so one whole turn is added for each beyond the first. */
static double sweep_of(double from, double to, int32_t turns) {
    double sign = turns < 0 ? -1.0 : 1.0, angle = fmod(sign * (to - from), TURN);
    if (angle < 0.0)
        angle += TURN;
    if (angle < 1e-10 || angle > TURN - 1e-10) /* the same point, but for rounding */
        angle = TURN;
    return sign * (angle + TURN * (fabs((double)turns) - 1.0));
}

/* With r even in s, |x'| = 1 at both ends asks phi' = q / r there, q^2 = 1 - (dr^2 + dz^2) / L^2; phi' even between
 * them turns by q L (1/r0 + 1/r1) / 2 = sweep, which gives L. */
static void read_arc(const trochia_reader *r, const trochia_move *move, const double *target, trochia_curve *curve) {
    static const uint32_t PLANES[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    uint32_t n = r->frame.n;
    uint8_t first = column_of(r->in, PLANES[move->plane][0]), second = column_of(r->in, PLANES[move->plane][1]);
    double from0 = r->position[first] - move->centre[0], from1 = r->position[second] - move->centre[1];
    double to0 = target[first] - move->centre[0], to1 = target[second] - move->centre[1];
    double r0 = hypot(from0, from1), r1 = hypot(to0, to1), rise = 0.0;
    if (fmin(r0, r1) < NOTHING) { /* no circle: the way to its end is a line */
        trochia_read_line(r, target, curve);
        return;
    }
    double angle = atan2(from1, from0), sweep = sweep_of(angle, atan2(to1, to0), move->turns);
    if (fabs(r1 - r0) < 1e-12 * r0)
        r1 = r0;
    curve->kind = TROCHIA_ARC_SEGMENT;
    curve->first = first;
    curve->second = second;
    for (uint32_t i = r->frame.groups[0]; i < r->frame.groups[1]; i++)
        if (i != first && i != second)
            rise = target[i] - r->position[i];
    double mean = 0.5 * (1.0 / r0 + 1.0 / r1), flat = sweep / mean, radial = r1 - r0;
    double length = sqrt(flat * flat + rise * rise + radial * radial);
    double q = copysign(fabs(flat) / length, sweep);
    double arc[7] = {
        move->centre[0], move->centre[1], r0, angle, q / r0, radial / length, 0.5 * q * (1.0 / r1 - 1.0 / r0) / length};
    memcpy(curve->c, arc, sizeof arc);
    curve->length = length;
    double rate = fabs(q) / fmin(r0, r1), twist = fabs(2.0 * arc[6]);
    curve->kappa = fmax(r0, r1) * (rate * rate + twist) + 2.0 * fabs(arc[5]) * rate;
    double x[18];
    for (uint32_t i = 0; i < n; i++) {
        curve->x0[i] = r->position[i];
        curve->x1[i] = target[i];
        curve->t0[i] = (target[i] - r->position[i]) / length;
    }
    trochia_curve_at(curve, n, length, 2, x);
    memcpy(curve->t1, x + n, n * sizeof *x);
    trochia_curve_at(curve, n, 0.0, 2, x);
    memcpy(curve->t0, x + n, n * sizeof *x);
}

static int is_near(double a, double b) {
    static const double NEAR = 1e-6; /* mm */
    return fabs(a - b) <= NEAR;
}

/* Looks up the pieces of a spline; returns 3 where it is not there or does not join up. */
static int32_t find_spline(trochia_reader *r, const trochia_move *move, const double *target) {
    const trochia_path_input *in = r->in;
    if (move->turns < 0 || (uint64_t)move->turns >= in->spline_count)
        return 3;
    r->piece = in->first_piece[move->turns];
    r->piece_end = in->first_piece[move->turns + 1];
    for (uint32_t i = 0; i < r->frame.n && r->piece < r->piece_end && in->columns[i] < 3; i++) {
        const trochia_spline_piece *first = &in->pieces[r->piece], *last = &in->pieces[r->piece_end - 1];
        const double *c = last->c + in->columns[i], s = last->length;
        if (!is_near(first->c[in->columns[i]], r->position[i]) ||
            !is_near(c[0] + s * (c[3] + s * (c[6] + s * c[9])), target[i]))
            return 3;
    }
    r->way = 0.0;
    for (uint64_t k = r->piece; k < r->piece_end; k++)
        r->way += in->pieces[k].length;
    r->way_left = r->way;
    return 0;
}

/* The next piece of a spline; other axes than X Y Z go evenly to their target. */
static void read_piece(trochia_reader *r, double *target, trochia_curve *curve) {
    const trochia_spline_piece *piece = &r->in->pieces[r->piece];
    uint32_t n = r->frame.n;
    double s = piece->length, share = s / r->way_left, k0[9], k1[9];
    int last = r->piece + 1 == r->piece_end;
    for (uint32_t i = 0; i < n; i++) {
        double *c = curve->c;
        if (r->in->columns[i] < 3) {
            for (uint32_t power = 0; power < 4; power++)
                c[power * n + i] = piece->c[3 * power + r->in->columns[i]];
            if (!last)
                target[i] = c[i] + s * (c[n + i] + s * (c[2 * n + i] + s * c[3 * n + i]));
        } else {
            if (!last)
                target[i] = r->position[i] + (target[i] - r->position[i]) * share;
            c[i] = r->position[i];
            c[n + i] = (target[i] - c[i]) / s;
            c[2 * n + i] = c[3 * n + i] = 0.0;
        }
        curve->x0[i] = c[i];
        curve->x1[i] = target[i];
        curve->t0[i] = c[n + i];
        curve->t1[i] = c[n + i] + s * (2.0 * c[2 * n + i] + s * 3.0 * c[3 * n + i]);
        k0[i] = 2.0 * c[2 * n + i];
        k1[i] = k0[i] + 6.0 * s * c[3 * n + i];
    }
    curve->kind = TROCHIA_CUBIC;
    curve->length = s;
    curve->kappa = fmax(trochia_group_norm(&r->frame, k0), trochia_group_norm(&r->frame, k1));
    r->way_left -= s;
    r->piece++;
}

/* Returns 0, or what is wrong; `target` becomes the end of the piece. */
static int32_t read_spline(trochia_reader *r, const trochia_move *move, double *target, trochia_curve *curve) {
    curve->inner = r->piece < r->piece_end;
    if (!curve->inner) {
        int32_t wrong = find_spline(r, move, target);
        if (wrong)
            return wrong;
    }
    if (r->piece < r->piece_end)
        read_piece(r, target, curve);
    else
        trochia_read_line(r, target, curve);
    return 0;
}

/* Returns 0, or what is wrong (1 no feed, 2 spindle at rest); `whole` is the length of all of the move. */
static int32_t set_speed(const trochia_move *move, double whole, trochia_curve *curve) {
    if (move->kind == TROCHIA_RAPID) {
        curve->speed = INFINITY;
        return 0;
    }
    if (!(move->rate > 0.0))
        return 1;
    curve->speed = move->rate;
    if (move->law == TROCHIA_INVERSE)
        curve->speed *= whole;
    if (move->law == TROCHIA_PER_REV)
        curve->speed *= (double)move->power / 60.0; /* S of the spindle [rev/min] */
    return curve->speed > 0.0 ? 0 : 2;
}

int32_t trochia_read_curve(trochia_reader *r, uint64_t row, trochia_curve *curve) {
    const trochia_move *move = &r->in->moves[row];
    double target[9];
    if (trochia_moves_absent(r->in, move))
        return 4;
    for (uint32_t i = 0; i < r->frame.n; i++)
        target[i] = move->target[r->in->columns[i]];
    r->halt |= r->in->rests[row];
    curve->length = 0.0;
    curve->inner = 0;
    int32_t wrong = 0;
    if (move->kind == TROCHIA_ARC)
        read_arc(r, move, target, curve);
    else if (move->kind == TROCHIA_SPLINE)
        wrong = read_spline(r, move, target, curve);
    else
        trochia_read_line(r, target, curve);
    if (wrong || curve->length == 0.0)
        return wrong;
    curve->move = (uint32_t)row;
    curve->halt = r->halt;
    curve->settle = move->path_mode == TROCHIA_EXACT_STOP;
    curve->tolerance = move->path_mode == TROCHIA_BLEND_DEFAULT ? r->in->tolerance
                       : move->path_mode == TROCHIA_BLEND       ? move->tolerance[0]
                                                                : 0.0;
    if (r->in->tolerance < 0.0)
        curve->tolerance = 0.0;
    if (curve->kind == TROCHIA_CUBIC)
        curve->tolerance -= r->in->spline_error;
    r->halt = 0;
    memcpy(r->position, target, sizeof target);
    return set_speed(move, curve->kind == TROCHIA_CUBIC ? r->way : curve->length, curve);
}

void trochia_start_reader(trochia_reader *r) {
    const trochia_path_input *in = r->in;
    r->frame.n = in->axes;
    r->frame.in = in;
    for (uint32_t group = 0; group < 4; group++) {
        uint32_t below = 0;
        for (uint32_t i = 0; i < in->axes; i++)
            below += in->columns[i] < 3 * group;
        r->frame.groups[group] = below;
    }
    for (uint32_t i = 0; i < in->axes; i++)
        r->position[i] = in->start[in->columns[i]];
    r->piece = r->piece_end = 0;
    r->out->segment_count = r->out->pool_count = r->out->failed_move = r->out->merged_count = 0;
}

/* What the joint at a curve's start may take of it, when the joint at its end wants `other`: its wish, or half, or what
 * is left.  The joint at the end then gets its wish or all that is left. */
double trochia_share(double wish, double other, double length) {
    return fmin(wish, other < 0.5 * length ? length - other : 0.5 * length);
}
