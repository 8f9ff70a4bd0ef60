/* The limits of one piece of a path.
 *
 * Inside a piece w = w0 + 2 a s, so f = q'' w + q' a has f'' = q'''' w + 5 q''' a: between the piece's ends |f| exceeds
 * the greater of their values by at most length^2 / 8 times the bound of that ("sag").  A line has no q'', and on a
 * parabola f is linear in s, so both are exact; arcs are cut into small pieces.  All constraints at the two ends are
 * linear in w0 and w1 and hold for w0 = w1 = 0 and for w0 = w1 <= ceiling: the set of pairs that keep them is convex
 * and holds the diagonal, which is why one pass back and one forward over the path find speeds that keep all of them.
 */
#include "host/plan_span.h"

#include <math.h>

static const double ARC_PART = 0.0873; /* rad: 5 degrees sag by half a per cent of the acceleration */
static const double CUBIC_SAG = 0.02;

uint32_t trochia_span_parts(const trochia_segment *segment, const double *pool, uint32_t n) {
    const double *c = pool + segment->data;
    double parts = 1.0, length = segment->length;
    if (segment->kind == TROCHIA_ARC_SEGMENT)
        parts = ceil(fabs(length * (c[4] + c[6 + 2 * n] * length)) / ARC_PART);
    if (segment->kind == TROCHIA_CUBIC) {
        double third = 0.0;
        for (uint32_t i = 0; i < n; i++)
            third = fmax(third, fabs(6.0 * c[3 * n + i]));
        parts = fmin(16.0, ceil(length * sqrt(third * 5.0 / (8.0 * CUBIC_SAG))));
    }
    return (uint32_t)fmin(fmax(parts, 1.0), 4e9);
}

static double dot_row(const trochia_limits *limits, uint32_t row, const double *vector) {
    if (row < limits->axes)
        return vector[row];
    double sum = 0.0;
    for (uint32_t i = 0; i < limits->axes; i++)
        sum += limits->matrix[row * limits->axes + i] * vector[i];
    return sum;
}

static double norm(const double *vector, uint32_t n) {
    double square = 0.0;
    for (uint32_t i = 0; i < n; i++)
        square += vector[i] * vector[i];
    return sqrt(square);
}

static void load_line(const trochia_segment *segment, const double *direction, const trochia_limits *limits,
                      trochia_span *span) {
    double slowness = norm(direction, limits->linear) / limits->path_velocity;
    double effort = norm(direction, limits->linear) / limits->path_acceleration;
    for (uint32_t i = 0; i < limits->rows; i++) {
        double size = fabs(dot_row(limits, i, direction));
        if (size > slowness * limits->velocity[i])
            slowness = size / limits->velocity[i];
        if (size > effort * limits->acceleration[i])
            effort = size / limits->acceleration[i];
    }
    span->straight = 1;
    span->length = segment->length;
    span->reach = 1.0 / effort;
    span->feed = 1.0 / (slowness * slowness);
    span->inside = span->ceiling[0] = span->ceiling[1] = fmin(span->feed, segment->speed_limit * segment->speed_limit);
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
            third[i] = fabs(dot_row(limits, i, vector));
            fourth[i] = 0.0;
        }
        third[limits->rows] = norm(vector, limits->linear);
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

static void load_cap(const trochia_limits *limits, const double x[2][27], double sag3, double sag4,
                     trochia_span *span) {
    double scale = 1.0 / limits->path_acceleration;
    double size[2];
    span->capped = scale > 0.0;
    for (int end = 0; end < 2; end++) {
        for (uint32_t i = 0; i < 3; i++) {
            span->along[end][i] = i < limits->linear ? x[end][limits->axes + i] * scale : 0.0;
            span->bend[end][i] = i < limits->linear ? x[end][2 * limits->axes + i] * scale : 0.0;
        }
        size[end] = norm(span->bend[end], 3);
    }
    span->cap_w = sag4 * scale;
    span->cap_a = 5.0 * sag3 * scale;
    for (int end = 0; end < 2 && span->capped; end++)
        span->ceiling[end] = fmin(span->ceiling[end], 1.0 / (size[end] + span->cap_w));
    if (span->capped)
        span->inside = fmin(span->inside, 1.0 / (fmax(size[0], size[1]) + span->cap_w));
    double along = fmax(norm(x[0] + limits->axes, limits->linear), norm(x[1] + limits->axes, limits->linear)) + sag3;
    double slowness = along / limits->path_velocity;
    span->feed = fmin(span->feed, 1.0 / (slowness * slowness));
}

static void load_curve(const trochia_segment *segment, const double *pool, const trochia_limits *limits, uint32_t part,
                       uint32_t parts, trochia_span *span) {
    double x[2][27], third[19], fourth[19], slowness = 0.0, held[2] = {0.0, 0.0}, stretch = 1.0;
    double h = segment->length / parts, eighth = h * h / 8.0;
    for (uint32_t end = 0; end < 2; end++)
        trochia_segment_at(segment, pool, limits->axes, part + end == parts ? segment->length : h * (part + end), 3,
                           x[end]);
    bounds(segment, pool, limits, third, fourth);
    span->straight = 0;
    span->length = h;
    span->rows = limits->rows;
    for (uint32_t i = 0; i < limits->rows; i++) {
        double scale = 1.0 / limits->acceleration[i], greatest = 0.0;
        span->sag_w[i] = eighth * fourth[i] * scale;
        span->sag_a[i] = 5.0 * eighth * third[i] * scale;
        for (int end = 0; end < 2; end++) {
            double t = dot_row(limits, i, x[end] + limits->axes), k = dot_row(limits, i, x[end] + 2 * limits->axes);
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
    uint32_t linear = limits->linear;
    load_cap(limits, x, eighth * third[limits->rows], eighth * fourth[limits->rows], span);
    if (linear) /* a cubic may be a little longer than its range of s: the feed is that along the path */
        stretch = fmax(1.0, fmax(norm(x[0] + limits->axes, linear), norm(x[1] + limits->axes, linear)) +
                                eighth * third[limits->rows]);
    double speed = segment->speed_limit / (segment->kind == TROCHIA_CUBIC && stretch > 1.0 + 1e-9 ? stretch : 1.0);
    double most = fmin(span->feed, speed * speed);
    span->inside = fmin(span->inside, most);
    span->ceiling[0] = fmin(span->ceiling[0], most);
    span->ceiling[1] = fmin(span->ceiling[1], most);
}

void trochia_span_load(const trochia_segment *segment, const double *pool, const trochia_limits *limits, uint32_t part,
                       uint32_t parts, trochia_span *span) {
    if (segment->kind == TROCHIA_LINE)
        load_line(segment, pool + segment->data + limits->axes, limits, span);
    else
        load_curve(segment, pool, limits, part, parts, span);
}

/* alpha >= 0 with |p + q alpha| <= b - d alpha, kept as a quotient so that a row costs no division. */
static void tighten(double p, double q, double b, double d, double *over, double *under) {
    for (int sign = 0; sign < 2; sign++) {
        double den = d + q, num = fmax(b - p, 0.0);
        if (den > 0.0 && num * *under < *over * den) {
            *over = num;
            *under = den;
        }
        p = -p;
        q = -q;
    }
}

/* The same for the vector: |p + q alpha|^2 <= (b - d alpha)^2, a quadratic in alpha. */
static double tighten_cap(const trochia_span *span, int at, double sign, double bend, double w) {
    double b = 1.0 - span->cap_w * w, d = 2.0 * span->length * span->cap_w + span->cap_a;
    double pp = 0.0, pq = 0.0, qq = 0.0;
    for (int i = 0; i < 3; i++) {
        double p = span->bend[at][i] * w, q = bend * span->bend[at][i] + sign * span->along[at][i];
        pp += p * p;
        pq += p * q;
        qq += q * q;
    }
    double rest = fmax(b * b - pp, 0.0), g = qq - d * d, h = pq + b * d;
    double square = h * h + g * rest, root = square > 0.0 ? h + sqrt(square) : 0.0;
    double most = d > 0.0 ? b / d : INFINITY;
    return root > 0.0 ? fmin(most, rest / root) : rest > 0.0 ? most : 0.0;
}

double trochia_span_reach(const trochia_span *span, int end, double w) {
    if (span->straight)
        return span->reach;
    double over = 1.0, under = 0.0, sign = end ? -1.0 : 1.0, twice = 2.0 * span->length;
    int far = 1 - end;
    for (uint32_t i = 0; i < span->rows; i++) {
        double b = 1.0 - span->sag_w[i] * w, d = twice * span->sag_w[i] + span->sag_a[i];
        tighten(span->k[end][i] * w, sign * span->t[end][i], b, d, &over, &under);
        tighten(span->k[far][i] * w, twice * span->k[far][i] + sign * span->t[far][i], b, d, &over, &under);
    }
    double alpha = over / under;
    if (span->capped) {
        alpha = fmin(alpha, tighten_cap(span, end, sign, 0.0, w));
        alpha = fmin(alpha, tighten_cap(span, far, sign, twice, w));
    }
    return alpha;
}

static double third_sag(double sag_a) {
    return sag_a / 5.0;
}

/* Without signs: |k| w + |t| a <= 1 with the greatest of both over the piece.  A triangle up to W needs
 * a = (2 W - w0 - w1) / 2 L, so W = ((w0 + w1) t + 2 L) / (2 t + 2 L k) by each row; below that there is room to stay.
 */
double trochia_span_peak(const trochia_span *span, double w0, double w1, double *acceleration) {
    double length = span->length, high = fmax(w0, w1) * (1.0 + 1e-9), peak = span->inside;
    if (!(peak > high))
        return 0.0;
    if (span->straight) {
        peak = fmin(peak, 0.5 * (w0 + w1) + length * span->reach);
        *acceleration = span->reach;
        return peak > high ? peak : 0.0;
    }
    double t[19], k[19];
    uint32_t rows = span->rows + (span->capped ? 1 : 0);
    for (uint32_t i = 0; i < rows; i++) {
        int vector = i == span->rows;
        double sag_w = vector ? span->cap_w : span->sag_w[i], sag_a = vector ? span->cap_a : span->sag_a[i];
        t[i] = third_sag(sag_a) + (vector ? fmax(norm(span->along[0], 3), norm(span->along[1], 3))
                                          : fmax(fabs(span->t[0][i]), fabs(span->t[1][i])));
        k[i] = sag_w + (vector ? fmax(norm(span->bend[0], 3), norm(span->bend[1], 3))
                               : fmax(fabs(span->k[0][i]), fabs(span->k[1][i])));
        if (t[i] + length * k[i] > 0.0)
            peak = fmin(peak, ((w0 + w1) * t[i] + 2.0 * length) / (2.0 * t[i] + 2.0 * length * k[i]));
    }
    if (!(peak > high))
        return 0.0;
    *acceleration = INFINITY;
    for (uint32_t i = 0; i < rows; i++)
        if (t[i] > 0.0)
            *acceleration = fmin(*acceleration, (1.0 - k[i] * peak) / t[i]);
    return peak;
}
