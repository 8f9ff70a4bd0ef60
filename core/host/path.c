/* A path's points, derivatives and extents. */
#include "host/path.h"

#include <math.h>

static void line_at(const double *c, uint32_t n, double s, uint32_t orders, double *out) {
    for (uint32_t i = 0; i < n; i++) {
        out[i] = c[i] + c[n + i] * s;
        for (uint32_t order = 1; order < orders; order++)
            out[order * n + i] = order == 1 ? c[n + i] : 0.0;
    }
}

static void cubic_at(const double *c, uint32_t n, double s, uint32_t orders, double *out) {
    for (uint32_t i = 0; i < n; i++) {
        double c0 = c[i], c1 = c[n + i], c2 = c[2 * n + i], c3 = c[3 * n + i];
        out[i] = c0 + s * (c1 + s * (c2 + s * c3));
        if (orders > 1)
            out[n + i] = c1 + s * (2.0 * c2 + s * 3.0 * c3);
        if (orders > 2)
            out[2 * n + i] = 2.0 * c2 + 6.0 * c3 * s;
        if (orders > 3)
            out[3 * n + i] = 6.0 * c3;
    }
}

/* Derivatives of z = r exp(i phi): with g = r'/r + i phi' taken apart as below, each is (p + i q) exp(i phi). */
static void arc_at(const trochia_segment *g, const double *c, uint32_t n, double s, uint32_t orders, double *out) {
    double rate = c[5], twist = 2.0 * c[6 + 2 * n];
    double r = c[2] + rate * s, w = c[4] + twist * s;
    double phi = c[3] + s * (c[4] + c[6 + 2 * n] * s);
    double radial[4] = {r, rate, -r * w * w, -3.0 * rate * w * w - 3.0 * r * w * twist};
    double along[4] = {0.0, r * w, 2.0 * rate * w + r * twist, -r * w * w * w + 3.0 * rate * twist};
    double sine = sin(phi), cosine = cos(phi);

    for (uint32_t order = 0; order < orders; order++)
        for (uint32_t i = 0; i < n; i++) {
            double slope = c[6 + n + i];
            out[order * n + i] = order == 0 ? c[6 + i] + slope * s : order == 1 ? slope : 0.0;
        }
    for (uint32_t order = 0; order < orders; order++) {
        double centre0 = order == 0 ? c[0] : 0.0, centre1 = order == 0 ? c[1] : 0.0;
        out[order * n + g->first] = centre0 + radial[order] * cosine - along[order] * sine;
        out[order * n + g->second] = centre1 + radial[order] * sine + along[order] * cosine;
    }
}

void trochia_segment_at(const trochia_segment *segment, const double *pool, uint32_t n, double s, uint32_t orders,
                        double *out) {
    const double *c = pool + segment->data;
    if (segment->kind == TROCHIA_LINE)
        line_at(c, n, s, orders, out);
    else if (segment->kind == TROCHIA_CUBIC)
        cubic_at(c, n, s, orders, out);
    else
        arc_at(segment, c, n, s, orders, out);
}

int32_t trochia_path_check(const trochia_segment *segments, uint64_t count, uint64_t room, uint32_t n) {
    const uint64_t sizes[3] = {2 * n, 7 + 2 * n, 4 * n}; /* of a line, an arc, a cubic */
    for (uint64_t k = 0; k < count; k++) {
        const trochia_segment *g = &segments[k];
        if (g->kind > TROCHIA_CUBIC || (g->kind == TROCHIA_ARC_SEGMENT && (g->first >= n || g->second >= n)))
            return 2;
        if (sizes[g->kind] > room || g->data > room - sizes[g->kind])
            return 1;
    }
    return 0;
}

void trochia_path_append(const trochia_segment *segments, uint64_t count, uint64_t shift, uint32_t first,
                         const trochia_move *moves, trochia_segment *out, uint32_t *lines, float *power) {
    for (uint64_t k = 0; k < count; k++) {
        const trochia_move *move = &moves[segments[k].move];
        out[k] = segments[k];
        out[k].data += shift; /* modulo 2^64: also back */
        out[k].move += first;
        lines[k] = move->line;
        power[k] = move->power;
    }
}

uint64_t trochia_path_reach(const trochia_segment *segments, uint64_t count, double feed, double most,
                            double *seconds) {
    uint64_t k = 0;
    double left = *seconds;
    for (; k < count && left > 0.0; k++)
        left -= segments[k].length / fmin(segments[k].speed_limit * feed, most);
    *seconds = left;
    return k;
}

void trochia_phases_move(const trochia_phase *phases, uint64_t count, double later, uint32_t rows, trochia_phase *out) {
    for (uint64_t k = 0; k < count; k++) {
        out[k] = phases[k];
        out[k].t += later;
        out[k].segment += rows;
    }
}

/* Chain rule: of x(s(t)) with ds/dt = v, its derivative a, and the derivative of that j. */
void trochia_path_sample(const trochia_segment *segments, const double *pool, uint32_t n, const trochia_phase *states,
                         uint64_t count, uint32_t order, double *out) {
    double x[36];
    for (uint64_t k = 0; k < count; k++) {
        const trochia_phase *at = &states[k];
        double v = at->v, a = at->a, j = at->j;
        trochia_segment_at(&segments[at->segment], pool, n, at->s, order + 1, x);
        for (uint32_t i = 0; i < n; i++) {
            double value = x[i];
            if (order == 1)
                value = x[n + i] * v;
            else if (order == 2)
                value = x[2 * n + i] * v * v + x[n + i] * a;
            else if (order == 3)
                value = x[3 * n + i] * v * v * v + 3.0 * x[2 * n + i] * v * a + x[n + i] * j;
            out[k * n + i] = value;
        }
    }
}

static void widen(double value, double *least, double *greatest) {
    *least = fmin(*least, value);
    *greatest = fmax(*greatest, value);
}

/* The roots of the derivative of each axis' cubic that lie inside. */
static void cubic_extents(const double *c, uint32_t n, double length, double *least, double *greatest) {
    for (uint32_t i = 0; i < n; i++) {
        double a = 3.0 * c[3 * n + i], half = c[2 * n + i], b = c[n + i];
        double square = half * half - a * b;
        if (square < 0.0)
            continue;
        double q = -(half + copysign(sqrt(square), half));
        double roots[2] = {a != 0.0 ? q / a : -1.0, q != 0.0 ? b / q : -1.0};
        for (int k = 0; k < 2; k++) {
            double s = roots[k];
            if (s > 0.0 && s < length)
                widen(c[i] + s * (b + s * (half + s * c[3 * n + i])), &least[i], &greatest[i]);
        }
    }
}

/* Where one plane axis turns: near each quarter of a turn; a spiral's roots are refined by Newton's method. */
static void arc_axis_extents(const trochia_segment *g, const double *pool, uint32_t n, uint32_t axis, double *least,
                             double *greatest) {
    const double *c = pool + g->data;
    const double turn = 3.14159265358979323846;
    double offset = axis == g->second ? 0.5 * turn : 0.0;
    double curve = c[6 + 2 * n], end = c[3] + g->length * (c[4] + curve * g->length);
    double low = ceil((fmin(c[3], end) - offset) / turn - 0.01), high = floor((fmax(c[3], end) - offset) / turn + 0.01);
    double x[36];
    if (high - low > 4.0 && c[5] == 0.0)
        low = high - 3.0; /* two whole turns show all there is */
    for (double k = low; k <= high; k += 1.0) {
        double s = (k * turn + offset - c[3]) / (c[4] + 0.5 * curve * g->length);
        if (c[5] != 0.0)
            for (int step = 0; step < 8; step++) {
                trochia_segment_at(g, pool, n, s, 3, x);
                if (x[2 * n + axis] == 0.0)
                    break;
                s -= x[n + axis] / x[2 * n + axis];
            }
        if (s > 0.0 && s < g->length) {
            trochia_segment_at(g, pool, n, s, 1, x);
            widen(x[axis], &least[axis], &greatest[axis]);
        }
    }
}

void trochia_path_extents(const trochia_segment *segments, const double *pool, uint32_t n, uint64_t first,
                          uint64_t last, double *least, double *greatest) {
    double x[36];
    for (uint64_t k = first; k < last; k++) {
        const trochia_segment *g = &segments[k];
        for (int end = 0; end < 2; end++) {
            trochia_segment_at(g, pool, n, end ? g->length : 0.0, 1, x);
            for (uint32_t i = 0; i < n; i++)
                widen(x[i], &least[i], &greatest[i]);
        }
        if (g->kind == TROCHIA_CUBIC)
            cubic_extents(pool + g->data, n, g->length, least, greatest);
        else if (g->kind == TROCHIA_ARC_SEGMENT) {
            arc_axis_extents(g, pool, n, g->first, least, greatest);
            arc_axis_extents(g, pool, n, g->second, least, greatest);
        }
    }
}
