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
static const double ARC_FINE =
    0.0175;                         /* rad: on wide arcs, where a piece is long enough to change speed in, 1 degree */
static const double ARC_LONG = 2.0; /* mm: that long */
static const double CUBIC_SAG = 0.02;

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
        double size = norm(direction, limits->linear);
        slowness = size * bounds->path_slowness;
        effort = size * bounds->path_effort;
    }
    for (uint32_t i = 0; i < limits->rows; i++) {
        double size = fabs(dot_row(limits, i, direction));
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
                                trochia_span *span) {
    double slowness = 0.0, held = 0.0, length = segment->length;
    for (int i = 0; i < 3; i++) {
        double k = 2.0 * c[6 + i], t0 = c[3 + i], t1 = t0 + k * length, effort = bounds->effort[i];
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

static void load_cap(const trochia_limits *limits, double x[2][27], double sag3, double sag4, trochia_span *span) {
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
        double around = (c[2] + c[5] * at) * (c[4] + twist * at), rise = norm(c + 6 + n, linear);
        stretch = sqrt(around * around + c[5] * c[5] + rise * rise);
    } else if (linear)
        stretch = fmax(norm(x[0] + n, linear), norm(x[1] + n, linear)) + sag;
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
    load_cap(limits, x, eighth * third[limits->rows], eighth * fourth[limits->rows], span);
    double speed = segment->speed_limit / stretch_of(segment, pool, limits, x, eighth * third[limits->rows]);
    double most = fmin(span->feed, speed * speed);
    span->inside = fmin(span->inside, most);
    span->ceiling[0] = fmin(span->ceiling[0], most);
    span->ceiling[1] = fmin(span->ceiling[1], most);
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
        load_plain_parabola(segment, c, bounds, span);
    else
        load_curve(segment, pool, bounds->limits, part, parts, span);
}

/* trochia_span_reach for a parabola in three axes. */
static double plain_reach(const trochia_span *span, int end, double w) {
    double sign = end ? -1.0 : 1.0, twice = 2.0 * span->length, over = 1.0, under = 0.0;
    for (int i = 0; i < 3; i++) {
        double p = span->k[0][i] * w, near = sign * span->t[end][i];
        double far = twice * span->k[0][i] + sign * span->t[1 - end][i];
        /* the row's limit is met upwards by the greater of q (if above 0), downwards by the lesser (if below) */
        double up = larger(near, far), down = -smaller(near, far);
        double room_up = larger(1.0 - p, 0.0), room_down = larger(1.0 + p, 0.0);
        if (up > 0.0 && room_up * under < over * up) {
            over = room_up;
            under = up;
        }
        if (down > 0.0 && room_down * under < over * down) {
            over = room_down;
            under = down;
        }
    }
    return over / under;
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
    if (span->even)
        return plain_reach(span, end, w);
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

/* The peak and its acceleration settled: staying at the greater end's speed counts too, unless nothing is left for it.
 */
static double settle_peak(const trochia_span *span, double w0, double w1, double peak, double acceleration) {
    double high = larger(w0, w1), low = smaller(w0, w1);
    if (!(peak >= high))
        return 0.0;
    if (peak > high * (1.0 + TROCHIA_WORTH))
        return peak;
    if (high - low < TROCHIA_WORTH * high)
        return 0.0;
    double stay = span->length - (high - low) / (2.0 * acceleration);
    return stay > TROCHIA_WORTH * span->length ? high : 0.0;
}

/* Of one row of a curve, the greatest |q'| and |q''| over the piece. */
static void greatest_of(const trochia_span *span, uint32_t row, double *t, double *k) {
    if (row == span->rows) {
        *t = third_sag(span->cap_a) + fmax(norm(span->along[0], 3), norm(span->along[1], 3));
        *k = span->cap_w + fmax(norm(span->bend[0], 3), norm(span->bend[1], 3));
        return;
    }
    *t = larger(fabs(span->t[0][row]), fabs(span->t[1][row]));
    if (span->even) {
        *k = fabs(span->k[0][row]);
        return;
    }
    *t += third_sag(span->sag_a[row]);
    *k = span->sag_w[row] + larger(fabs(span->k[0][row]), fabs(span->k[1][row]));
}

/* Without signs: |k| w + |t| a <= 1 with the greatest of both over the piece.  A triangle up to W needs
 * a = (2 W - w0 - w1) / 2 L, so W = ((w0 + w1) t + 2 L) / (2 t + 2 L k) by each row; below that there is room to stay.
 */
double trochia_span_peak(const trochia_span *span, double w0, double w1, double *acceleration) {
    double length = span->length, peak = span->inside, t[19], k[19];
    if (peak < larger(w0, w1))
        return 0.0;
    if (span->straight) {
        *acceleration = span->reach;
        return settle_peak(span, w0, w1, smaller(peak, 0.5 * (w0 + w1) + length * span->reach), span->reach);
    }
    uint32_t rows = span->rows + (span->capped ? 1 : 0);
    for (uint32_t i = 0; i < rows; i++) {
        greatest_of(span, i, &t[i], &k[i]);
        double den = 2.0 * t[i] + 2.0 * length * k[i], num = (w0 + w1) * t[i] + 2.0 * length;
        if (num < peak * den)
            peak = num / den;
    }
    if (peak < larger(w0, w1))
        return 0.0;
    double least = INFINITY;
    for (uint32_t i = 0; i < rows; i++)
        if (1.0 - k[i] * peak < least * t[i])
            least = (1.0 - k[i] * peak) / t[i];
    *acceleration = least;
    return settle_peak(span, w0, w1, peak, least);
}
