/* The row that bends most is often not the row that goes fastest: on a line along X that turns to Y, Y's acceleration
 * is taken by turning while X's is free.
 *
 * With w = v^2 row i leaves a <= (1 - k_i w) / t_i; all together a concave function of w, so what is straight between
 * w = 0 and the ceiling's lies below it.  Of jerk row i leaves (1 - p_i u - q_i x) / t_i with u = v^3 and x = v a: a
 * concave function of (u, x), so a linear one that is below it at the corners of a polygon is below it inside.
 * Legend: a stretch's a <= (1 - bend_a w) / along_a, j <= (1 - twist_j u - bend_j x) / along_j. */
#include <math.h>

#include "host/scurve_rows.h"

static const double OVER = 1.0 + 1e-9; /* beyond the ceiling by what searches leave */
/* A row that hardly goes along is taken to go along by this part of the greatest. */
static const double LEAST_ALONG = 1e-3;
static const double FAR = 10.0; /* times the ceiling: where turning leaves nothing, if it always leaves something */

/* Greatest y with |x' y + x'' z| <= left, of |x'| <= t, |x''| <= k, |x' . x''| <= d <= t k; with d = t k a straight
 * one. */
static double along_vector(double t, double k, double d, double z, double left) {
    if (d >= t * k)
        return (left - k * z) / t;
    return (sqrt(d * d * z * z + t * t * fmax(left * left - k * k * z * z, 0.0)) - d * z) / (t * t);
}

static double acceleration_of(const trochia_rows *rows, double w) {
    double least = INFINITY;
    if (rows->vector_a.along > 0.0)
        least = along_vector(rows->vector_a.along, rows->vector_a.bend, rows->vector_a.slant, w, 1.0);
    for (uint32_t i = 0; i < rows->count; i++)
        if (rows->along_a[i] > 0.0)
            least = fmin(least, (1.0 - rows->bend_a[i] * w) / rows->along_a[i]);
    return least;
}

/* What part of along_j's jerk is taken at (u, x). */
static double jerk_taken(const trochia_rows *rows, double along, double u, double x) {
    double least = INFINITY;
    const trochia_vector *all = &rows->vector_j;
    if (all->along > 0.0)
        least = along_vector(all->along, all->bend, all->slant, x, 1.0 - all->twist * u);
    for (uint32_t i = 0; i < rows->count; i++) {
        double own = fmax(rows->along_j[i], LEAST_ALONG * along);
        least = fmin(least, (1.0 - rows->twist_j[i] * u - rows->bend_j[i] * x) / own);
    }
    return 1.0 - along * least;
}

/* Corners (u, x) of a polygon around all motions with a <= (1 - k w) / t up to speed c.  x is greatest at v^2 = 1 / 3k;
 * from there on three straight lines lie above it: one at the greatest, and those that touch it at the ceiling and, in
 * between, where these two meet.  Returns how many. */
static int corners(const trochia_stretch *stretch, double c, double (*at)[2]) {
    double k = stretch->bend_a, t = stretch->along_a, w = c * c, last = w * c, end = c * (1.0 - k * w) / t;
    at[0][0] = 0.0;
    at[0][1] = end;
    at[1][0] = last;
    at[1][1] = end;
    if (!(3.0 * k * w > 1.0))
        return 2;
    double v = 1.0 / sqrt(3.0 * k), top = v * (1.0 - k * v * v) / t, steep = (k - 1.0 / (3.0 * w)) / t;
    double turn = last - (top - end) / steep, half = cbrt(turn), x = half * (1.0 - k * half * half) / t;
    double slope = (k - 1.0 / (3.0 * half * half)) / t;
    at[0][1] = at[1][1] = top;
    at[1][0] = turn;
    at[2][0] = last;
    at[2][1] = end;
    if (!(slope > 0.0) || !(steep > slope))
        return 3;
    at[1][0] = turn - (top - x) / slope;
    at[2][0] = turn + (top - x) / (steep - slope);
    at[2][1] = x - slope * (at[2][0] - turn);
    at[3][0] = last;
    at[3][1] = end;
    return 4;
}

static void relax_jerk(trochia_rows *rows, trochia_stretch *stretch, double c) {
    double at[4][2], last = c * c * c, bend = 0.0;
    int count = corners(stretch, c, at);
    trochia_vector *all = &rows->vector_j;
    for (int i = 0; i < count; i++)
        if (all->twist * at[i][0] + all->bend * at[i][1] > 1.0)
            all->slant = INFINITY; /* a corner is beyond it, where only what is straight is known */
    double twist = fmax(jerk_taken(rows, stretch->along_j, last, 0.0) / last, 0.0);
    for (int i = 0; i < count; i++)
        if (at[i][1] > 0.0)
            bend = fmax(bend, (jerk_taken(rows, stretch->along_j, at[i][0], at[i][1]) - twist * at[i][0]) / at[i][1]);
    if (bend <= stretch->bend_j && twist <= stretch->twist_j) {
        stretch->bend_j = bend;
        stretch->twist_j = twist;
    }
}

void trochia_relax(trochia_rows *rows, trochia_stretch *stretch) {
    double c = stretch->ceiling * OVER;
    if (rows->count > TROCHIA_ROWS_KEPT || !(stretch->free < INFINITY))
        return;
    double k = (1.0 - acceleration_of(rows, c * c) * stretch->along_a) / (c * c);
    stretch->bend_a = fmin(stretch->bend_a, fmax(k, 0.0));
    relax_jerk(rows, stretch, c);
    stretch->free = FAR * stretch->ceiling;
    if (stretch->bend_a > 0.0)
        stretch->free = fmin(stretch->free, 1.0 / sqrt(stretch->bend_a));
    if (stretch->twist_j > 0.0)
        stretch->free = fmin(stretch->free, 1.0 / cbrt(stretch->twist_j));
}
