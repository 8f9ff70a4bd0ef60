/* The limits of one piece of a path, loaded from its segment.
 *
 * Inside a piece w = w0 + 2 a s, so f = q'' w + q' a has f'' = q'''' w + 5 q''' a: between the piece's ends |f| exceeds
 * the greater of their values by at most length^2 / 8 times the bound of that ("sag").  A line has no q'', and on a
 * parabola f is linear in s, so both are exact; arcs are cut into small pieces. */
#include "host/plan_span.h"
#include "host/limits.h"

#include <math.h>

static const double ARC_PART = 0.0873; /* rad: 5 degrees sag by half a per cent of the acceleration */
static const double ARC_FINE =
    0.0175;                         /* rad: on wide arcs, where a piece is long enough to change speed in, 1 degree */
static const double ARC_LONG = 2.0; /* mm: that long */
static const double CUBIC_SAG = 0.02;
/* rad: an even acceleration in a piece wastes about half of what turning takes more of at one end than at the other, in
 * a chain of chords a part of the time that goes with their angle; at sharp corners there is no time to change speed */
static const double CHORD_PART = 0.003;
static const double CHORD_SHARP = 0.3;
enum { CHORD_MOST = 8 };

/* In how many parts a blend of turning little is looked at. */
static double parts_of_bend(const double *c, uint32_t n, double length) {
    double square = 0.0;
    for (uint32_t i = 0; i < n; i++)
        square += c[2 * n + i] * c[2 * n + i];
    double turn = 2.0 * length * sqrt(square);
    return turn < CHORD_SHARP ? fmin(ceil(turn / CHORD_PART), CHORD_MOST) : 1.0;
}

uint32_t trochia_span_parts(const trochia_segment *segment, const double *pool, uint32_t n) {
    const double *c = pool + segment->data;
    double parts = 1.0, length = segment->length;
    if (segment->kind == TROCHIA_ARC_SEGMENT) {
        double sweep = fabs(length * (c[4] + c[6 + 2 * n] * length));
        parts = fmax(ceil(sweep / ARC_PART), fmin(ceil(sweep / ARC_FINE), ceil(length / ARC_LONG)));
    }
    if (segment->kind == TROCHIA_CUBIC) {
        double third = 0.0;
        for (uint32_t i = 0; i < n; i++)
            third = fmax(third, fabs(6.0 * c[3 * n + i]));
        parts = third > 0.0 ? fmin(16.0, ceil(length * sqrt(third * 5.0 / (8.0 * CUBIC_SAG))))
                            : parts_of_bend(c, n, length);
    }
    return (uint32_t)fmin(fmax(parts, 1.0), 4e9);
}

trochia_bounds trochia_bounds_of(const trochia_limits *limits) {
    trochia_bounds bounds = {
        .limits = limits, .path_slowness = 1.0 / limits->path_velocity, .path_effort = 1.0 / limits->path_acceleration};
    for (uint32_t i = 0; i < limits->rows; i++) {
        bounds.slowness[i] = 1.0 / limits->velocity[i];
        bounds.effort[i] = 1.0 / limits->acceleration[i];
    }
    bounds.capped = bounds.path_slowness > 0.0 || bounds.path_effort > 0.0;
    bounds.plain = limits->axes == 3 && limits->rows == 3 && !bounds.capped;
    return bounds;
}

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

static inline double smaller(double a, double b) {
    return a < b ? a : b;
}

static void settle_line(const trochia_segment *segment, double slowness, double effort, trochia_span *span) {
    span->straight = 1;
    span->length = segment->length;
    span->reach = 1.0 / effort;
    span->feed = 1.0 / (slowness * slowness);
    span->inside = span->ceiling[0] = span->ceiling[1] =
        smaller(span->feed, segment->speed_limit * segment->speed_limit);
}

static void load_line(const trochia_segment *segment, const double *direction, const trochia_bounds *bounds,
                      trochia_span *span) {
    const trochia_limits *limits = bounds->limits;
    double slowness = 0.0, effort = 0.0;
    if (bounds->capped) {
        double size = trochia_norm(direction, limits->linear);
        slowness = size * bounds->path_slowness;
        effort = size * bounds->path_effort;
    }
    for (uint32_t i = 0; i < limits->rows; i++) {
        double size = fabs(trochia_dot_row(limits, i, direction));
        slowness = larger(slowness, size * bounds->slowness[i]);
        effort = larger(effort, size * bounds->effort[i]);
    }
    settle_line(segment, slowness, effort, span);
}

/* The same two for three axes without caps: nearly all segments of nearly all programs come here. */
static void load_plain_line(const trochia_segment *segment, const double *direction, const trochia_bounds *bounds,
                            trochia_span *span) {
    double slowness = 0.0, effort = 0.0;
    for (int i = 0; i < 3; i++) {
        double size = fabs(direction[i]);
        slowness = larger(slowness, size * bounds->slowness[i]);
        effort = larger(effort, size * bounds->effort[i]);
    }
    settle_line(segment, slowness, effort, span);
}

static void load_plain_parabola(const trochia_segment *segment, const double *c, const trochia_bounds *bounds,
                                uint32_t part, uint32_t parts, trochia_span *span) {
    double slowness = 0.0, held = 0.0, length = segment->length / parts, from = length * part;
    for (int i = 0; i < 3; i++) {
        double k = 2.0 * c[6 + i], t0 = c[3 + i] + k * from, t1 = t0 + k * length, effort = bounds->effort[i];
        span->t[0][i] = t0 * effort;
        span->t[1][i] = t1 * effort;
        span->k[0][i] = k * effort;
        held = larger(held, fabs(k) * effort);
        slowness = larger(slowness, larger(fabs(t0), fabs(t1)) * bounds->slowness[i]);
    }
    span->straight = 0;
    span->even = 1;
    span->capped = 0;
    span->rows = 3;
    span->length = length;
    span->feed = 1.0 / (slowness * slowness);
    double most = smaller(span->feed, segment->speed_limit * segment->speed_limit);
    span->inside = span->ceiling[0] = span->ceiling[1] = held * most > 1.0 ? 1.0 / held : most;
}

/* Bounds of |x'''| and |x''''| in the plane of an arc (a spiral's own terms included). */
static void arc_bounds(const double *c, uint32_t n, double length, double *third, double *fourth) {
    double curve = c[6 + 2 * n], radial = fabs(c[5]), twist = fabs(2.0 * curve);
    double r = fmax(c[2], c[2] + c[5] * length), w = fmax(fabs(c[4]), fabs(c[4] + 2.0 * curve * length));
    *third = r * w * w * w + 3.0 * radial * w * w + 3.0 * r * w * twist + 3.0 * radial * twist;
    *fourth = r * w * w * w * w + 4.0 * radial * w * w * w + 6.0 * r * w * w * twist + 12.0 * radial * w * twist +
              3.0 * r * twist * twist;
}

/* third[] and fourth[] of each row, then of the vector X Y Z at index rows. */
static void bounds(const trochia_segment *segment, const double *pool, const trochia_limits *limits, double *third,
                   double *fourth) {
    const double *c = pool + segment->data;
    uint32_t n = limits->axes;
    double vector[9], flat3 = 0.0, flat4 = 0.0;
    if (segment->kind == TROCHIA_CUBIC) {
        for (uint32_t i = 0; i < n; i++)
            vector[i] = 6.0 * c[3 * n + i];
        for (uint32_t i = 0; i < limits->rows; i++) {
            third[i] = fabs(trochia_dot_row(limits, i, vector));
            fourth[i] = 0.0;
        }
        third[limits->rows] = trochia_norm(vector, limits->linear);
        fourth[limits->rows] = 0.0;
        return;
    }
    arc_bounds(c, n, segment->length, &flat3, &flat4);
    for (uint32_t i = 0; i < limits->rows; i++) {
        double part = i < n ? (double)(i == segment->first || i == segment->second)
                            : hypot(limits->matrix[i * n + segment->first], limits->matrix[i * n + segment->second]);
        third[i] = part * flat3;
        fourth[i] = part * flat4;
    }
    third[limits->rows] = flat3;
    fourth[limits->rows] = flat4;
}

static void load_cap(const trochia_limits *limits, double x[2][27], double sag3, double sag4, trochia_span *span) {
    double scale = 1.0 / limits->path_acceleration;
    double size[2];
    span->capped = scale > 0.0;
    for (int end = 0; end < 2; end++) {
        for (uint32_t i = 0; i < 3; i++) {
            span->along[end][i] = i < limits->linear ? x[end][limits->axes + i] * scale : 0.0;
            span->bend[end][i] = i < limits->linear ? x[end][2 * limits->axes + i] * scale : 0.0;
        }
        size[end] = trochia_norm(span->bend[end], 3);
    }
    span->cap_w = sag4 * scale;
    span->cap_a = 5.0 * sag3 * scale;
    for (int end = 0; end < 2 && span->capped; end++)
        span->ceiling[end] = fmin(span->ceiling[end], 1.0 / (size[end] + span->cap_w));
    if (span->capped)
        span->inside = fmin(span->inside, 1.0 / (fmax(size[0], size[1]) + span->cap_w));
    double along =
        fmax(trochia_norm(x[0] + limits->axes, limits->linear), trochia_norm(x[1] + limits->axes, limits->linear)) +
        sag3;
    double slowness = along / limits->path_velocity;
    span->feed = fmin(span->feed, 1.0 / (slowness * slowness));
}

/* Greatest |x'| where it is not 1: a cubic or a spiral may be a little longer than its range of s, and the feed is that
 * along the path. */
static double stretch_of(const trochia_segment *segment, const double *pool, const trochia_limits *limits,
                         double x[2][27], double sag) {
    const double *c = pool + segment->data;
    uint32_t n = limits->axes, linear = limits->linear;
    double stretch = 1.0;
    if (segment->kind == TROCHIA_ARC_SEGMENT) {
        if (c[5] == 0.0 || c[6 + 2 * n] == 0.0)
            return 1.0;
        /* r phi' is a product of two lines in s, greatest halfway between their roots */
        double twist = 2.0 * c[6 + 2 * n], at = -0.5 * (c[2] / c[5] + c[4] / twist);
        at = fmin(fmax(at, 0.0), segment->length);
        double around = (c[2] + c[5] * at) * (c[4] + twist * at), rise = trochia_norm(c + 6 + n, linear);
        stretch = sqrt(around * around + c[5] * c[5] + rise * rise);
    } else if (linear)
        stretch = fmax(trochia_norm(x[0] + n, linear), trochia_norm(x[1] + n, linear)) + sag;
    return stretch > 1.0 + 1e-12 ? stretch : 1.0;
}

static void load_curve(const trochia_segment *segment, const double *pool, const trochia_limits *limits, uint32_t part,
                       uint32_t parts, trochia_span *span) {
    double x[2][27], third[19], fourth[19], slowness = 0.0, held[2] = {0.0, 0.0};
    double h = segment->length / parts, eighth = h * h / 8.0;
    for (uint32_t end = 0; end < 2; end++)
        trochia_segment_at(segment, pool, limits->axes, part + end == parts ? segment->length : h * (part + end), 3,
                           x[end]);
    bounds(segment, pool, limits, third, fourth);
    span->straight = 0;
    span->even = 0;
    span->length = h;
    span->rows = limits->rows;
    for (uint32_t i = 0; i < limits->rows; i++) {
        double scale = 1.0 / limits->acceleration[i], greatest = 0.0;
        span->sag_w[i] = eighth * fourth[i] * scale;
        span->sag_a[i] = 5.0 * eighth * third[i] * scale;
        for (int end = 0; end < 2; end++) {
            double t = trochia_dot_row(limits, i, x[end] + limits->axes),
                   k = trochia_dot_row(limits, i, x[end] + 2 * limits->axes);
            span->t[end][i] = t * scale;
            span->k[end][i] = k * scale;
            held[end] = fmax(held[end], fabs(k) * scale + span->sag_w[i]);
            greatest = fmax(greatest, fabs(t));
        }
        slowness = fmax(slowness, (greatest + eighth * third[i]) / limits->velocity[i]);
    }
    span->feed = 1.0 / (slowness * slowness);
    span->ceiling[0] = 1.0 / held[0];
    span->ceiling[1] = 1.0 / held[1];
    span->inside = fmin(span->ceiling[0], span->ceiling[1]);
    load_cap(limits, x, eighth * third[limits->rows], eighth * fourth[limits->rows], span);
    double speed = segment->speed_limit / stretch_of(segment, pool, limits, x, eighth * third[limits->rows]);
    double most = fmin(span->feed, speed * speed);
    span->inside = fmin(span->inside, most);
    span->ceiling[0] = fmin(span->ceiling[0], most);
    span->ceiling[1] = fmin(span->ceiling[1], most);
}

/* The end of an arc's piece that the piece before left is not worked again: pieces come in order, one way or the other.
 */
static void turn_to(const trochia_segment *segment, const double *c, uint32_t part, uint32_t parts,
                    trochia_span *span) {
    double known[2][2] = {{span->circle[0][0], span->circle[0][1]}, {span->circle[1][0], span->circle[1][1]}};
    for (uint32_t end = 0; end < 2; end++) {
        uint32_t other = 1 - end;
        if (span->arc == segment && span->part + other == part + end) {
            span->circle[end][0] = known[other][0];
            span->circle[end][1] = known[other][1];
            continue;
        }
        double phi = c[3] + c[4] * (part + end == parts ? segment->length : segment->length / parts * (part + end));
        span->circle[end][0] = cos(phi);
        span->circle[end][1] = sin(phi);
    }
    span->arc = segment;
    span->part = part;
}

/* A circle's arc or helix in three axes. */
static void load_plain_arc(const trochia_segment *segment, const double *c, const trochia_bounds *bounds, uint32_t part,
                           uint32_t parts, trochia_span *span) {
    double length = segment->length / parts, rate = c[4], r = c[2], eighth = length * length / 8.0;
    double third = fabs(r * rate * rate * rate), slowness = 0.0, held[2] = {0.0, 0.0};
    turn_to(segment, c, part, parts, span);
    for (uint32_t i = 0; i < 3; i++) {
        int first = i == segment->first, flat = first || i == segment->second;
        double effort = bounds->effort[i], greatest = 0.0, sag = flat ? eighth * third : 0.0;
        span->sag_w[i] = sag * fabs(rate) * effort;
        span->sag_a[i] = 5.0 * sag * effort;
        for (int end = 0; end < 2; end++) {
            double cosine = span->circle[end][0], sine = span->circle[end][1];
            double t = first ? -r * rate * sine : flat ? r * rate * cosine : c[9 + i];
            double k = flat ? -r * rate * rate * (first ? cosine : sine) : 0.0;
            span->t[end][i] = t * effort;
            span->k[end][i] = k * effort;
            held[end] = larger(held[end], fabs(k) * effort + span->sag_w[i]);
            greatest = larger(greatest, fabs(t));
        }
        slowness = larger(slowness, (greatest + sag) * bounds->slowness[i]);
    }
    span->straight = span->even = span->capped = 0;
    span->rows = 3;
    span->length = length;
    span->feed = 1.0 / (slowness * slowness);
    double most = smaller(span->feed, segment->speed_limit * segment->speed_limit);
    for (int end = 0; end < 2; end++)
        span->ceiling[end] = held[end] * most > 1.0 ? 1.0 / held[end] : most;
    span->inside = smaller(span->ceiling[0], span->ceiling[1]);
}

void trochia_span_load(const trochia_segment *segment, const double *pool, const trochia_bounds *bounds, uint32_t part,
                       uint32_t parts, trochia_span *span) {
    const double *c = pool + segment->data;
    if (segment->kind == TROCHIA_LINE) {
        if (bounds->plain)
            load_plain_line(segment, c + 3, bounds, span);
        else
            load_line(segment, c + bounds->limits->axes, bounds, span);
    } else if (bounds->plain && segment->kind == TROCHIA_CUBIC && c[9] == 0.0 && c[10] == 0.0 && c[11] == 0.0)
        load_plain_parabola(segment, c, bounds, part, parts, span);
    else if (bounds->plain && segment->kind == TROCHIA_ARC_SEGMENT && c[5] == 0.0 && c[12] == 0.0)
        load_plain_arc(segment, c, bounds, part, parts, span);
    else
        load_curve(segment, pool, bounds->limits, part, parts, span);
}
