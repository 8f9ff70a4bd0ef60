/* Ramps of limited jerk between two speeds, both with a = 0.  Internal to scurve*.c, not part of the schema.
 *
 * From u to v: jerk +J, constant A, jerk -J; symmetric in time, so its mean speed is (u + v) / 2 and its way that times
 * its duration. */
#ifndef TROCHIA_SCURVE_RAMP_H
#define TROCHIA_SCURVE_RAMP_H

#include <math.h>

#include "host/scurve.h"

/* How far sums of lengths may be apart by rounding [mm]: a knot this near a joint stands on it, or a sliver of a phase
 * would have the jerk of one segment on the next. */
#define TROCHIA_SAME_PLACE(s) (2e-15 * (s) + 1e-14)

/* Neighbouring stretches taken together, each quotient the greatest of them. */
typedef struct {
    double length, ceiling, along_a, bend_a, along_j, bend_j, twist_j;
} trochia_range;

static const trochia_range TROCHIA_NO_RANGE = {0.0, INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0};

static inline double trochia_larger(double a, double b) {
    return a > b ? a : b;
}

static inline double trochia_smaller(double a, double b) {
    return a < b ? a : b;
}

static inline void trochia_range_add(trochia_range *range, const trochia_stretch *stretch) {
    range->length += stretch->length;
    range->ceiling = trochia_smaller(range->ceiling, stretch->ceiling);
    range->along_a = trochia_larger(range->along_a, stretch->along_a);
    range->bend_a = trochia_larger(range->bend_a, stretch->bend_a);
    range->along_j = trochia_larger(range->along_j, stretch->along_j);
    range->bend_j = trochia_larger(range->bend_j, stretch->bend_j);
    range->twist_j = trochia_larger(range->twist_j, stretch->twist_j);
}

typedef struct {
    double a, j; /* both 0: nothing is left for a change of speed */
} trochia_budget;

/* What a range leaves for a and j at speeds up to v.  Where the path bends, at most half of the jerk goes to 3 q'' v a.
 */
static inline trochia_budget trochia_budget_at(const trochia_range *range, double v) {
    double rest_a = 1.0 - range->bend_a * v * v, rest_j = 1.0 - range->twist_j * v * v * v;
    if (!(rest_a > 0.0) || !(rest_j > 0.0))
        return (trochia_budget){0.0, 0.0};
    double a = rest_a / range->along_a, cross = range->bend_j * v;
    if (cross * a > 0.5 * rest_j)
        a = 0.5 * rest_j / cross;
    return (trochia_budget){a, (rest_j - cross * a) / range->along_j};
}

/* Duration of a ramp that changes speed by `change`. */
static inline double trochia_ramp_time(double change, trochia_budget b) {
    if (change == 0.0)
        return 0.0;
    if (!(b.j > 0.0))
        return INFINITY;
    return change * b.j <= b.a * b.a ? 2.0 * sqrt(change / b.j) : change / b.a + b.a / b.j;
}

static inline double trochia_ramp_way(double u, double v, trochia_budget b) {
    return u == v ? 0.0 : 0.5 * (u + v) * trochia_ramp_time(fabs(v - u), b);
}

/* Greatest v in [u, most] that a ramp over the whole range reaches from u. */
double trochia_ramp_reach(const trochia_range *range, double u, double most);

/* Greatest v up to the range's ceiling that a ramp from u0 and one back to u1 allow; negative: none. */
double trochia_ramp_peak(const trochia_range *range, double u0, double u1);

#endif
