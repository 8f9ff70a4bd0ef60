/* A program's moves as curves, one at a time, and curves as segments. */
#include <math.h>
#include <string.h>

#include "host/path_curve.h"

static const double NOTHING = 1e-9; /* mm or degree: shorter moves do not move */
static const double TURN = 6.28318530717958647693;

void trochia_curve_at(const trochia_curve *curve, uint32_t n, double s, uint32_t orders, double *out) {
    if (curve->kind == TROCHIA_LINE) {
        for (uint32_t i = 0; i < n; i++) {
            out[i] = s < 0.5 * curve->length ? curve->x0[i] + curve->t0[i] * s
                                             : curve->x1[i] - curve->t0[i] * (curve->length - s);
            if (orders > 1)
                out[n + i] = curve->t0[i];
        }
        return;
    }
    double pool[7 + 18];
    trochia_segment segment = {.kind = TROCHIA_ARC_SEGMENT, .first = curve->first, .second = curve->second};
    memcpy(pool, curve->arc, 6 * sizeof *pool);
    for (uint32_t i = 0; i < n; i++) {
        int in_plane = i == curve->first || i == curve->second;
        pool[6 + i] = in_plane ? 0.0 : curve->x0[i];
        pool[6 + n + i] = in_plane ? 0.0 : curve->t0[i];
    }
    pool[6 + 2 * n] = curve->arc[6];
    trochia_segment_at(&segment, pool, n, s, orders, out);
}

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
    memcpy(curve->arc, arc, sizeof arc);
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

/* Returns 0, or what is wrong (1 no feed, 2 spindle at rest). */
static int32_t set_speed(const trochia_reader *r, const trochia_move *move, uint64_t row, trochia_curve *curve) {
    if (move->kind == TROCHIA_RAPID) {
        curve->speed = INFINITY;
        return 0;
    }
    if (!(move->rate > 0.0))
        return 1;
    curve->speed = move->rate;
    if (move->law == TROCHIA_INVERSE)
        curve->speed *= curve->length;
    if (move->law == TROCHIA_PER_REV)
        curve->speed *= r->in->rpm[row] / 60.0;
    return curve->speed > 0.0 ? 0 : 2;
}

int32_t trochia_read_curve(trochia_reader *r, uint64_t row, trochia_curve *curve) {
    const trochia_move *move = &r->in->moves[row];
    double target[9];
    for (uint32_t i = 0; i < r->frame.n; i++)
        target[i] = move->target[r->in->columns[i]];
    r->halt |= r->in->rests[row];
    curve->length = 0.0;
    if (move->kind == TROCHIA_ARC)
        read_arc(r, move, target, curve);
    else
        trochia_read_line(r, target, curve);
    if (curve->length == 0.0)
        return 0;
    curve->move = (uint32_t)row;
    curve->halt = r->halt;
    curve->settle = move->path_mode == TROCHIA_EXACT_STOP;
    curve->tolerance = move->path_mode == TROCHIA_BLEND_DEFAULT ? r->in->tolerance
                       : move->path_mode == TROCHIA_BLEND       ? move->tolerance[0]
                                                                : 0.0;
    if (r->in->tolerance < 0.0)
        curve->tolerance = 0.0;
    r->halt = 0;
    memcpy(r->position, target, sizeof target);
    return set_speed(r, move, row, curve);
}

trochia_segment *trochia_append(trochia_reader *r, double length, double speed, uint32_t move, uint8_t kind) {
    trochia_segment *segment = &r->out->segments[r->out->segment_count++];
    *segment = (trochia_segment){
        .length = length, .speed_limit = speed, .data = r->out->pool_count, .move = move, .kind = kind};
    return segment;
}

/* What the joints have left of a curve; nothing at all where both blends meet. */
void trochia_emit_curve(trochia_reader *r, const trochia_curve *curve, double cut, double length) {
    uint32_t n = r->frame.n;
    if (length <= 1e-12 * curve->length)
        return;
    trochia_segment *segment = trochia_append(r, length, curve->speed, curve->move, curve->kind);
    double *c = r->out->pool + r->out->pool_count;
    if (curve->kind == TROCHIA_LINE) {
        for (uint32_t i = 0; i < n; i++) {
            c[i] = curve->x0[i] + curve->t0[i] * cut;
            c[n + i] = curve->t0[i];
        }
        r->out->pool_count += 2 * n;
        return;
    }
    const double *arc = curve->arc;
    segment->first = curve->first;
    segment->second = curve->second;
    memcpy(c, arc, 6 * sizeof *c);
    c[2] += arc[5] * cut;
    c[3] += cut * (arc[4] + arc[6] * cut);
    c[4] += 2.0 * arc[6] * cut;
    for (uint32_t i = 0; i < n; i++) {
        int in_plane = i == curve->first || i == curve->second;
        c[6 + i] = in_plane ? 0.0 : curve->x0[i] + curve->t0[i] * cut;
        c[6 + n + i] = in_plane ? 0.0 : curve->t0[i];
    }
    c[6 + 2 * n] = arc[6];
    r->out->pool_count += 7 + 2 * n;
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
    r->out->segment_count = r->out->pool_count = r->out->failed_move = r->out->merged_count = 0;
}

/* What the joint at a curve's start may take of it, when the joint at its end wants `other`: its wish, or half, or what
 * is left.  The joint at the end then gets its wish or all that is left. */
double trochia_share(double wish, double other, double length) {
    return fmin(wish, other < 0.5 * length ? length - other : 0.5 * length);
}

void trochia_emit_cubic(trochia_reader *r, const double *c, double length, double speed, uint32_t move) {
    trochia_append(r, length, speed, move, TROCHIA_CUBIC);
    memcpy(r->out->pool + r->out->pool_count, c, 4 * r->frame.n * sizeof *c);
    r->out->pool_count += 4 * r->frame.n;
}
