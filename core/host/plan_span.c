/* What the limits of one piece allow: how fast speed may change from either end, and how high it may rise inside.
 *
 * All constraints at the two ends of a piece are linear in w0 and w1 and hold for w0 = w1 = 0 and for w0 = w1 <=
 * ceiling: the set of pairs that keep them is convex and holds the diagonal, which is why one pass back and one forward
 * over the path find speeds that keep all of them. */
#include "host/plan_span.h"

#include <math.h>

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

static inline double smaller(double a, double b) {
    return a < b ? a : b;
}

static double norm3(const double *v) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
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
    double square = h * h + g * rest, most = d > 0.0 ? b / d : INFINITY, root = INFINITY;
    if (square >= 0.0 && h >= 0.0) /* each sign of h has the form that takes no difference of equals */
        root = h > 0.0 || square > 0.0 ? rest / (h + sqrt(square)) : INFINITY;
    else if (g > 0.0)
        root = (sqrt(square) - h) / g;
    return smaller(most, root);
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
        *t = third_sag(span->cap_a) + fmax(norm3(span->along[0]), norm3(span->along[1]));
        *k = span->cap_w + fmax(norm3(span->bend[0]), norm3(span->bend[1]));
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
