/* Bezier curves by their own length.
 *
 * Knots stand at even steps of the curve's own parameter, h_k of its way apart.  With M = x'' at them, x'' even
 * between, a cubic spline through places x_k has h_{k-1} M_{k-1} + 2 (h_{k-1} + h_k) M_k + h_k M_{k+1} = 6 ((x_{k+1} -
 * x_k) / h_k - (x_k - x_{k-1}) / h_{k-1}). M_0 is the curve's own bend, which leaves no choice for x_1 = x_0 + h_0 T_0
 * + h_0^2 (2 M_0 + M_1) / 6.  Put into the equations of the first two inner knots, with q = h_0^2 / h_1, (3 h_0 + 2 h_1
 * + q) M_1 + h_1 M_2 = 6 ((x_2 - x_0 - h_0 T_0) / h_1 - T_0) - (3 h_0 + 2 q) M_0, (h_1 - q) M_1 + 2 (h_1 + h_2) M_2 +
 * h_2 M_3 = 6 ((x_3 - x_2) / h_2 - (x_2 - x_0 - h_0 T_0) / h_1) + 2 q M_0, and the same from the other end.  The error
 * falls with h^4; it is measured at knots and halfway between, and a curve for which few pieces are not enough is cut
 * in half: ends with the curve's own direction and bend join as the curve does. */
#include <math.h>
#include <string.h>

#include "host/spline.h"

enum { LEAST = 6, MOST = 12, DEPTH = 24 };
static const double NOTHING = 1e-9; /* mm: shorter curves do not move */

typedef struct {
    double t[2][3];             /* directions at the ends */
    double m[MOST + 1][3];      /* x'' */
    double x[MOST + 1][3];      /* places */
    double middle[MOST][3];     /* halfway between, by the curve's parameter */
    double h[MOST], half[MOST]; /* way from knot to knot, and to the middle */
} fit;

/* Place, or the first or second derivative by u. */
static void bezier_at(const double *p, double u, int order, double *out) {
    double v = 1.0 - u;
    double weights[3][4] = {{v * v * v, 3.0 * v * v * u, 3.0 * v * u * u, u * u * u},
                            {-3.0 * v * v, 3.0 * v * (v - 2.0 * u), 3.0 * u * (2.0 * v - u), 3.0 * u * u},
                            {6.0 * v, 6.0 * (u - 2.0 * v), 6.0 * (v - 2.0 * u), 6.0 * u}};
    const double *w = weights[order];
    for (int i = 0; i < 3; i++)
        out[i] = w[0] * p[i] + w[1] * p[3 + i] + w[2] * p[6 + i] + w[3] * p[9 + i];
}

static double norm(const double *x) {
    return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

static double speed_at(const double *p, double u) {
    double slope[3];
    bezier_at(p, u, 1, slope);
    return norm(slope);
}

/* Way from u0 to u1 by five points of Gauss. */
static double way(const double *p, double u0, double u1) {
    static const double NODE[3] = {0.0, 0.53846931010568309, 0.90617984593866399};
    static const double WEIGHT[3] = {0.56888888888888889, 0.47862867049936647, 0.23692688505618909};
    double middle = 0.5 * (u0 + u1), half = 0.5 * (u1 - u0), sum = WEIGHT[0] * speed_at(p, middle);
    for (int k = 1; k < 3; k++)
        sum += WEIGHT[k] * (speed_at(p, middle - half * NODE[k]) + speed_at(p, middle + half * NODE[k]));
    return half * sum;
}

/* Unit direction and curvature at an end; where the control points there coincide the direction is that of the next,
 * and the curvature, which is not finite, is left out. */
static void end_at(const double *p, int end, double *direction, double *bend) {
    double slope[3], second[3], u = end, size = 0.0, along = 0.0;
    bezier_at(p, u, 1, slope);
    bezier_at(p, u, 2, second);
    int regular = norm(slope) > 1e-6 * norm(second);
    for (int k = 1; !regular && !(size > NOTHING) && k < 4; k++) {
        const double *from = end ? p + 9 - 3 * k : p, *to = end ? p + 9 : p + 3 * k;
        for (int i = 0; i < 3; i++)
            slope[i] = to[i] - from[i];
        size = norm(slope);
    }
    size = norm(slope);
    for (int i = 0; i < 3; i++) {
        direction[i] = size > 0.0 ? slope[i] / size : 0.0;
        along += direction[i] * second[i];
    }
    for (int i = 0; i < 3; i++)
        bend[i] = regular ? (second[i] - along * direction[i]) / (size * size) : 0.0;
}

/* Equations of x'' at the inner knots: lower[k] M_{k-1} + middle[k] M_k + upper[k] M_{k+1} = right[k][axis]. */
typedef struct {
    double lower[MOST + 1], middle[MOST + 1], upper[MOST + 1], right[MOST + 1][3];
} system_of_knots;

/* The two equations next to an end: `k` the first, `step` inwards. */
static void bind_end(const fit *fit, uint32_t k, int step, system_of_knots *all) {
    uint32_t end = (uint32_t)((int)k - step), inside = (uint32_t)((int)k + step);
    uint32_t beyond = (uint32_t)((int)inside + step), gap = step > 0 ? 0 : 1;
    double h0 = fit->h[end - gap], h1 = fit->h[k - gap], h2 = fit->h[inside - gap], q = h0 * h0 / h1;
    const double *bend = fit->m[end], *place = fit->x[end], *direction = fit->t[step > 0 ? 0 : 1];
    for (int i = 0; i < 3; i++) {
        double t = step * direction[i], rise = (fit->x[inside][i] - place[i] - h0 * t) / h1;
        all->right[k][i] = 6.0 * (rise - t) - (3.0 * h0 + 2.0 * q) * bend[i];
        all->right[inside][i] = 6.0 * ((fit->x[beyond][i] - fit->x[inside][i]) / h2 - rise) + 2.0 * q * bend[i];
    }
    all->middle[k] = 3.0 * h0 + 2.0 * h1 + q;
    all->middle[inside] = 2.0 * (h1 + h2);
    (step > 0 ? all->upper : all->lower)[k] = h1;
    (step > 0 ? all->lower : all->upper)[k] = 0.0;
    (step > 0 ? all->lower : all->upper)[inside] = h1 - q;
    (step > 0 ? all->upper : all->lower)[inside] = h2;
}

static void bend_inside(fit *fit, uint32_t n) {
    system_of_knots all;
    for (uint32_t k = 3; k + 3 <= n; k++) {
        all.lower[k] = fit->h[k - 1];
        all.upper[k] = fit->h[k];
        all.middle[k] = 2.0 * (fit->h[k - 1] + fit->h[k]);
        for (int i = 0; i < 3; i++)
            all.right[k][i] = 6.0 * ((fit->x[k + 1][i] - fit->x[k][i]) / fit->h[k] -
                                     (fit->x[k][i] - fit->x[k - 1][i]) / fit->h[k - 1]);
    }
    bind_end(fit, 1, 1, &all);
    bind_end(fit, n - 1, -1, &all);
    for (uint32_t k = 2; k < n; k++) {
        double factor = all.lower[k] / all.middle[k - 1];
        all.middle[k] -= factor * all.upper[k - 1];
        for (int i = 0; i < 3; i++)
            all.right[k][i] -= factor * all.right[k - 1][i];
    }
    for (uint32_t k = n - 1; k >= 1; k--)
        for (int i = 0; i < 3; i++)
            fit->m[k][i] = (all.right[k][i] - (k < n - 1 ? all.upper[k] * fit->m[k + 1][i] : 0.0)) / all.middle[k];
    double h0 = fit->h[0], h1 = fit->h[n - 1];
    for (int i = 0; i < 3; i++) {
        fit->x[1][i] = fit->x[0][i] + h0 * fit->t[0][i] + h0 * h0 / 6.0 * (2.0 * fit->m[0][i] + fit->m[1][i]);
        fit->x[n - 1][i] = fit->x[n][i] - h1 * fit->t[1][i] + h1 * h1 / 6.0 * (2.0 * fit->m[n][i] + fit->m[n - 1][i]);
    }
}

static void piece_of(const fit *fit, uint32_t k, trochia_spline_piece *piece) {
    double h = fit->h[k];
    piece->length = h;
    for (int i = 0; i < 3; i++) {
        double x0 = fit->x[k][i], x1 = fit->x[k + 1][i], m0 = fit->m[k][i], m1 = fit->m[k + 1][i];
        piece->c[i] = x0;
        piece->c[3 + i] = (x1 - x0) / h - h / 6.0 * (2.0 * m0 + m1);
        piece->c[6 + i] = 0.5 * m0;
        piece->c[9 + i] = (m1 - m0) / (6.0 * h);
    }
}

/* Lays the spline of n pieces; returns its greatest distance from the curve at the same way along it. */
static double lay(const double *points, uint32_t n, fit *fit) {
    double known[2][3], apart[3], greatest = 0.0, step = 1.0 / n;
    for (uint32_t k = 0; k < n; k++) {
        double u = step * k, after = k + 1 == n ? 1.0 : step * (k + 1), middle = 0.5 * (u + after);
        fit->half[k] = way(points, u, middle);
        fit->h[k] = fmax(fit->half[k] + way(points, middle, after), NOTHING * 1e-6);
        bezier_at(points, u, 0, fit->x[k]);
        bezier_at(points, middle, 0, fit->middle[k]);
    }
    memcpy(fit->x[n], points + 9, sizeof fit->x[n]);
    end_at(points, 0, fit->t[0], fit->m[0]);
    end_at(points, 1, fit->t[1], fit->m[n]);
    memcpy(known[0], fit->x[1], sizeof known[0]);
    memcpy(known[1], fit->x[n - 1], sizeof known[1]);
    bend_inside(fit, n);
    for (uint32_t k = 0; k < n; k++) {
        trochia_spline_piece piece;
        double s = fit->half[k];
        piece_of(fit, k, &piece);
        for (int i = 0; i < 3; i++)
            apart[i] =
                piece.c[i] + s * (piece.c[3 + i] + s * (piece.c[6 + i] + s * piece.c[9 + i])) - fit->middle[k][i];
        greatest = fmax(greatest, norm(apart));
    }
    for (uint32_t end = 0; end < 2; end++) {
        for (int i = 0; i < 3; i++)
            apart[i] = fit->x[end ? n - 1 : 1][i] - known[end][i];
        greatest = fmax(greatest, norm(apart));
    }
    return greatest;
}

/* Lays a curve, or what bisecting left of one, with few pieces; returns their number, 0 where few are not enough. */
static uint32_t lay_few(const double *points, double tolerance, fit *fit) {
    double apart = lay(points, LEAST, fit);
    if (apart <= tolerance)
        return LEAST;
    uint32_t n = (uint32_t)ceil(1.1 * LEAST * sqrt(sqrt(fmin(apart / tolerance, 1e6))));
    return n <= MOST && lay(points, n, fit) <= tolerance ? n : 0;
}

/* The first and the second half of a curve. */
static void bisect(const double *p, double *first, double *second) {
    for (int i = 0; i < 3; i++) {
        double q0 = 0.5 * (p[i] + p[3 + i]), q1 = 0.5 * (p[3 + i] + p[6 + i]), q2 = 0.5 * (p[6 + i] + p[9 + i]);
        double r0 = 0.5 * (q0 + q1), r1 = 0.5 * (q1 + q2), middle = 0.5 * (r0 + r1);
        double one[4] = {p[i], q0, r0, middle}, two[4] = {middle, r1, q2, p[9 + i]};
        for (int k = 0; k < 4; k++) {
            first[3 * k + i] = one[k];
            second[3 * k + i] = two[k];
        }
    }
}

/* Appends the pieces of one curve from `total` on; returns how many there are then. */
static uint64_t append(const double *points, double tolerance, trochia_spline_piece *pieces, uint64_t room,
                       uint64_t total) {
    double parts[DEPTH + 2][12];
    int depth[DEPTH + 2] = {0}, left = 1;
    memcpy(parts[0], points, sizeof parts[0]);
    while (left) {
        double here[12];
        int level = depth[--left];
        memcpy(here, parts[left], sizeof here);
        fit fit;
        if (!(way(here, 0.0, 1.0) > NOTHING))
            continue;
        uint32_t n = lay_few(here, level < DEPTH ? tolerance : INFINITY, &fit);
        if (!n) {
            bisect(here, parts[left + 1], parts[left]); /* the last one put there is the next one looked at */
            depth[left] = depth[left + 1] = level + 1;
            left += 2;
            continue;
        }
        for (uint32_t piece = 0; piece < n; piece++)
            if (total + piece < room)
                piece_of(&fit, piece, &pieces[total + piece]);
        total += n;
    }
    return total;
}

uint64_t trochia_spline_fit(const double *points, uint64_t count, double tolerance, uint64_t *first,
                            trochia_spline_piece *pieces, uint64_t room) {
    static const double SLACK =
        0.7; /* of the tolerance at the places looked at: between them it may be a little more */
    uint64_t total = 0;
    for (uint64_t k = 0; k < count; k++) {
        first[k] = total;
        total = append(points + 12 * k, SLACK * tolerance, pieces, room, total);
    }
    first[count] = total;
    return total;
}
