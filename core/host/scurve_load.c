/* The limits of each stretch of a path: the greatest derivatives of every limited quantity along it. */
#include <math.h>

#include "host/limits.h"
#include "host/scurve_march.h"
#include "host/scurve_rows.h"

static const double ARC_PART = 0.2618; /* rad: 15 degrees; a row sees cosine and sine of its own part of the circle */
static const double ARC_FINE = 0.0524; /* rad: 3 degrees on wide arcs, so that ramps find places to begin and end */
static const double ARC_LONG = 4.0;    /* mm: that wide */
static const double SAME_BEND = 1e-6;  /* curvature agrees to this part: what rounding leaves of a blend's zero ends */
/* At the very ceiling nothing would be left for a, and it would be neared for ever. */
static const double RESERVE = 1.0 - 5e-4;
static const double STRAIGHT = 1e-9; /* 1/mm */
static const double ALONG = 1e-9;    /* a jump of curvature along x' leaves no more than this part across it */

typedef struct {
    double along, bend, twist; /* greatest |q'|, |q''|, |q'''| */
} trochia_sizes;

static uint32_t parts_of(const trochia_segment *segment, const double *pool, uint32_t n) {
    if (segment->kind != TROCHIA_ARC_SEGMENT)
        return 1;
    const double *c = pool + segment->data;
    double length = segment->length, sweep = fabs(length * (c[4] + c[6 + 2 * n] * length));
    double parts = fmax(ceil(sweep / ARC_PART), fmin(ceil(sweep / ARC_FINE), ceil(length / ARC_LONG)));
    return (uint32_t)fmin(fmax(parts, 1.0), 4e9);
}

uint64_t trochia_scurve_count(const trochia_segment *segments, const double *pool, uint32_t axes, uint64_t count) {
    uint64_t stretches = 0;
    for (uint64_t k = 0; k < count; k++)
        stretches += parts_of(&segments[k], pool, axes);
    return stretches;
}

/* Greatest |cos| over [from, to]. */
static double greatest_cosine(double from, double to) {
    const double half = 3.14159265358979323846;
    if (floor(fmax(from, to) / half) != floor(fmin(from, to) / half))
        return 1.0;
    return fmax(fabs(cos(from)), fabs(cos(to)));
}

/* One row over part of an arc: of weights m on the plane's axes, |m| cos(phi - psi) is what it sees of the radius. */
static trochia_sizes arc_row(const trochia_segment *segment, const double *c, uint32_t n, double m0, double m1,
                             double straight, double from, double to) {
    double weight = hypot(m0, m1), rate = c[5], twist = 2.0 * c[6 + 2 * n], length = segment->length;
    trochia_sizes sizes = {fabs(straight), 0.0, 0.0};
    if (weight == 0.0)
        return sizes;
    if (rate == 0.0 && twist == 0.0) {
        const double quarter = 1.57079632679489661923;
        double r = c[2], w = fabs(c[4]), psi = atan2(m1, m0);
        double phi0 = c[3] + c[4] * from - psi, phi1 = c[3] + c[4] * to - psi;
        double cosine = greatest_cosine(phi0, phi1), sine = greatest_cosine(phi0 - quarter, phi1 - quarter);
        sizes.along += weight * r * w * sine;
        sizes.bend = weight * r * w * w * cosine;
        sizes.twist = weight * r * w * w * w * sine;
        return sizes;
    }
    double r = fmax(c[2], c[2] + rate * length), w = fmax(fabs(c[4]), fabs(c[4] + twist * length));
    rate = fabs(rate);
    twist = fabs(twist);
    sizes.along += weight * (r * w + rate);
    sizes.bend = weight * (r * w * w + 2.0 * rate * w + r * twist);
    sizes.twist = weight * (r * w * w * w + 3.0 * rate * w * w + 3.0 * r * w * twist + 3.0 * rate * twist);
    return sizes;
}

static trochia_sizes cubic_row(double t0, double t1, double k0, double k1, double third) {
    double along = fmax(fabs(t0), fabs(t1));
    if (k0 * k1 < 0.0)
        along = fmax(along, fabs(t0 - 0.5 * k0 * k0 / third));
    trochia_sizes sizes = {along, fmax(fabs(k0), fabs(k1)), fabs(third)};
    return sizes;
}

/* A bound of |x'| on a cubic: x' lies between its ends and the middle control point of x'(s); or no farther from the
 * line between its ends than its bend takes it. */
static double longest_along(const double (*x)[36], uint32_t n, uint32_t linear, double length) {
    double middle[9], ends = fmax(trochia_norm(x[0] + n, linear), trochia_norm(x[1] + n, linear));
    for (uint32_t i = 0; i < linear; i++)
        middle[i] = x[0][n + i] + 0.5 * length * x[0][2 * n + i];
    return fmin(fmax(ends, trochia_norm(middle, linear)),
                ends + length * length / 8.0 * trochia_norm(x[0] + 3 * n, linear));
}

/* Raises a stretch by one row. */
static void bind(trochia_stretch *stretch, trochia_rows *rows, trochia_sizes size, double velocity, double acceleration,
                 double jerk) {
    stretch->ceiling = trochia_smaller(stretch->ceiling, velocity / size.along);
    stretch->along_a = trochia_larger(stretch->along_a, size.along / acceleration);
    stretch->bend_a = trochia_larger(stretch->bend_a, size.bend / acceleration);
    stretch->along_j = trochia_larger(stretch->along_j, size.along / jerk);
    stretch->bend_j = trochia_larger(stretch->bend_j, 3.0 * size.bend / jerk);
    stretch->twist_j = trochia_larger(stretch->twist_j, size.twist / jerk);
    uint32_t i = rows->count++;
    if (i >= TROCHIA_ROWS_KEPT)
        return;
    rows->along_a[i] = size.along / acceleration;
    rows->bend_a[i] = size.bend / acceleration;
    rows->along_j[i] = size.along / jerk;
    rows->bend_j[i] = 3.0 * size.bend / jerk;
    rows->twist_j[i] = size.twist / jerk;
}

static double dot_of(const double *a, const double *b, uint32_t n) {
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* A bound of |x' . x''| on a cubic: the second derivative of that is 3 x'' . x'''. */
static double slant_of(const double (*x)[36], uint32_t n, uint32_t linear, double length) {
    double slant = 0.0, change = 0.0;
    for (int end = 0; end < 2; end++) {
        const double *bend = x[end] + 2 * n;
        slant = fmax(slant, fabs(dot_of(x[end] + n, bend, linear)));
        change = fmax(change, fabs(dot_of(bend, bend + n, linear)));
    }
    return slant + 3.0 / 8.0 * length * length * change;
}

/* The same by the caps on the vector: what lies across adds up by its square. */
static void bind_vector(trochia_stretch *stretch, trochia_rows *rows, trochia_sizes size, double slant,
                        const trochia_limits *limits) {
    double a = limits->path_acceleration, j = limits->path_jerk;
    uint32_t at = rows->count;
    bind(stretch, rows, size, limits->path_velocity, a, j);
    if (at >= TROCHIA_ROWS_KEPT)
        return;
    rows->count = at;
    slant = fmin(slant, size.along * size.bend);
    if (a < INFINITY)
        rows->vector_a = (trochia_vector){size.along / a, size.bend / a, slant / (a * a), 0.0};
    if (j < INFINITY)
        rows->vector_j = (trochia_vector){size.along / j, 3.0 * size.bend / j, 3.0 * slant / (j * j), size.twist / j};
}

static void load_line(const double *direction, const trochia_limits *limits, trochia_stretch *stretch,
                      trochia_rows *rows) {
    for (uint32_t i = 0; i < limits->rows; i++) {
        trochia_sizes size = {fabs(trochia_dot_row(limits, i, direction)), 0.0, 0.0};
        bind(stretch, rows, size, limits->velocity[i], limits->acceleration[i], limits->jerk[i]);
    }
    trochia_sizes size = {trochia_norm(direction, limits->linear), 0.0, 0.0};
    bind(stretch, rows, size, limits->path_velocity, limits->path_acceleration, limits->path_jerk);
}

/* Returns the greatest |x'| where that exceeds 1: the feed is that along the path. */
static double load_arc(const trochia_segment *segment, const double *c, double from, double to,
                       const trochia_limits *limits, trochia_stretch *stretch, trochia_rows *rows) {
    uint32_t n = limits->axes;
    const double *slope = c + 6 + n;
    for (uint32_t i = 0; i < limits->rows; i++) {
        double m0 = limits->matrix[i * n + segment->first], m1 = limits->matrix[i * n + segment->second];
        trochia_sizes size = arc_row(segment, c, n, m0, m1, trochia_dot_row(limits, i, slope), from, to);
        bind(stretch, rows, size, limits->velocity[i], limits->acceleration[i], limits->jerk[i]);
    }
    double rise = trochia_norm(slope, limits->linear), r = fmax(c[2], c[2] + c[5] * segment->length);
    double w = fmax(fabs(c[4]), fabs(c[4] + 2.0 * c[6 + 2 * n] * segment->length)), rate = fabs(c[5]);
    double twist = fabs(2.0 * c[6 + 2 * n]), stretched = sqrt(r * w * r * w + rate * rate + rise * rise);
    trochia_sizes size = {stretched, r * (w * w + twist) + 2.0 * rate * w,
                          r * w * w * w + 3.0 * rate * w * w + 3.0 * r * w * twist + 3.0 * rate * twist};
    bind_vector(stretch, rows, size, twist == 0.0 && rate == 0.0 ? 0.0 : INFINITY, limits);
    return stretched;
}

static double load_cubic(const trochia_segment *segment, const double *pool, const trochia_limits *limits,
                         trochia_stretch *stretch, trochia_rows *rows) {
    double x[2][36], length = segment->length;
    uint32_t n = limits->axes, linear = limits->linear;
    trochia_segment_at(segment, pool, n, 0.0, 4, x[0]);
    trochia_segment_at(segment, pool, n, length, 4, x[1]);
    for (uint32_t i = 0; i < limits->rows; i++) {
        trochia_sizes size =
            cubic_row(trochia_dot_row(limits, i, x[0] + n), trochia_dot_row(limits, i, x[1] + n),
                      trochia_dot_row(limits, i, x[0] + 2 * n), trochia_dot_row(limits, i, x[1] + 2 * n),
                      trochia_dot_row(limits, i, x[0] + 3 * n));
        bind(stretch, rows, size, limits->velocity[i], limits->acceleration[i], limits->jerk[i]);
    }
    trochia_sizes size = {longest_along(x, n, linear, length),
                          fmax(trochia_norm(x[0] + 2 * n, linear), trochia_norm(x[1] + 2 * n, linear)),
                          trochia_norm(x[0] + 3 * n, linear)};
    bind_vector(stretch, rows, size, slant_of(x, n, linear, length), limits);
    return size.along;
}

static double greatest_of(const double *vector, uint32_t n) {
    double size = 0.0;
    for (uint32_t i = 0; i < n; i++)
        size = fmax(size, fabs(vector[i]));
    return size;
}

/* What x'' at the start of a segment is more than at the end of the one before: nothing (0); or only along x', where
 * one of them does not bend and the other, a cubic, turns back less than it (then minus that part; `in`: that is the
 * one behind); or anything else (infinite). */
static double kick_of(const trochia_segment *segment, const double *pool, uint32_t n, int *in) {
    double x[2][27], jump[9], along = 0.0, square = 0.0, size;
    *in = 0;
    if (segment[0].kind == TROCHIA_LINE && segment[1].kind == TROCHIA_LINE)
        return 0.0;
    trochia_segment_at(&segment[0], pool, n, segment[0].length, 3, x[0]);
    trochia_segment_at(&segment[1], pool, n, 0.0, 3, x[1]);
    double before = greatest_of(x[0] + 2 * n, n), after = greatest_of(x[1] + 2 * n, n);
    size = fmax(before, after);
    for (uint32_t i = 0; i < n; i++) {
        jump[i] = x[1][2 * n + i] - x[0][2 * n + i];
        along += jump[i] * x[1][n + i];
        square += x[1][n + i] * x[1][n + i];
    }
    if (greatest_of(jump, n) <= SAME_BEND * size + STRAIGHT)
        return 0.0;
    double across[9], kick = along / square;
    for (uint32_t i = 0; i < n; i++)
        across[i] = jump[i] - kick * x[1][n + i];
    trochia_segment_at(&segment[1], pool, n, segment[1].length, 3, x[1]);
    trochia_segment_at(&segment[0], pool, n, 0.0, 3, x[0]);
    size = fmax(size, fmax(greatest_of(x[0] + 2 * n, n), greatest_of(x[1] + 2 * n, n)));
    if (greatest_of(jump, n) <= SAME_BEND * size + STRAIGHT)
        return 0.0;
    *in = before < after;
    int flat = fmin(before, after) <= ALONG * size + STRAIGHT;
    if (flat && segment[*in].kind == TROCHIA_CUBIC && kick < 0.0 && greatest_of(across, n) <= ALONG * size + STRAIGHT)
        return -kick;
    return INFINITY;
}

/* What motion does at the joint after a segment. */
static void load_joint(const trochia_segment *segment, const double *pool, uint32_t n, trochia_stretch *before,
                       trochia_stretch *after) {
    int in;
    double kick = kick_of(segment, pool, n, &in);
    if (kick == INFINITY)
        before->last = 1;
    else if (in)
        after->kick_in = kick;
    else
        before->kick_out = kick;
}

static void load(const trochia_segment *segment, const double *pool, const trochia_limits *limits, uint32_t part,
                 uint32_t parts, trochia_stretch *stretch) {
    const double *c = pool + segment->data;
    double step = segment->length / parts, stretched = 1.0;
    *stretch = (trochia_stretch){.length = step, .ceiling = INFINITY};
    trochia_rows rows;
    rows.count = 0;
    rows.vector_a.along = rows.vector_j.along = 0.0;
    if (segment->kind == TROCHIA_LINE)
        load_line(c + limits->axes, limits, stretch, &rows);
    else if (segment->kind == TROCHIA_ARC_SEGMENT)
        stretched = load_arc(segment, c, step * part, step * (part + 1), limits, stretch, &rows);
    else
        stretched = load_cubic(segment, pool, limits, stretch, &rows);
    double feed = segment->speed_limit / (stretched > 1.0 + 1e-12 ? stretched : 1.0);
    stretch->over = segment->speed_limit < INFINITY && stretch->ceiling < segment->speed_limit * (1.0 - 1e-9);
    stretch->ceiling = trochia_smaller(stretch->ceiling, feed);
    stretch->most_a = 1.0 / stretch->along_a;
    stretch->most_j = 1.0 / stretch->along_j;
    stretch->free = INFINITY;
    if (stretch->bend_a > 0.0)
        stretch->free = 1.0 / sqrt(stretch->bend_a);
    if (stretch->twist_j > 0.0)
        stretch->free = trochia_smaller(stretch->free, 1.0 / cbrt(stretch->twist_j));
    stretch->ceiling = trochia_smaller(stretch->ceiling, RESERVE * stretch->free);
    trochia_relax(&rows, stretch);
}

void trochia_scurve_load(const trochia_segment *segments, const double *pool, uint64_t count,
                         const trochia_limits *limits, trochia_stretch *stretches) {
    double s = 0.0, kick_in = 0.0;
    for (uint64_t k = 0; k < count; k++) {
        uint32_t parts = parts_of(&segments[k], pool, limits->axes);
        for (uint32_t part = 0; part < parts; part++, stretches++) {
            load(&segments[k], pool, limits, part, parts, stretches);
            stretches->segment = (uint32_t)k;
            stretches->start = s;
            s += stretches->length;
        }
        stretches[-1].kick_in = kick_in;
        trochia_stretch after = {.kick_in = 0.0};
        if (k + 1 == count || segments[k].stop)
            stretches[-1].last = 1;
        else
            load_joint(&segments[k], pool, limits->axes, &stretches[-1], &after);
        kick_in = after.kick_in;
        if (stretches[-1].last)
            s = 0.0;
    }
    *stretches = (trochia_stretch){.start = s};
}
