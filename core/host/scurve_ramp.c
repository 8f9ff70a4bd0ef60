/* How fast a ramp gets, given how long it may be. */
#include "host/scurve_ramp.h"

static const int HALVINGS = 44;
/* Lengths summed in another order may differ by this much. */
static const double SUMMED = 1.0 + 1e-10;
static const double ROUNDING = 1.0 - 1e-13;

/* Where nothing depends on v: both forms of the ramp solved for its end. */
static double straight_reach(double length, double u, trochia_budget b) {
    double rise = b.a * b.a / b.j;
    if ((2.0 * u + rise) * b.a / b.j >= length) { /* A is never reached: J x^3 + 2 u x = length, v = u + J x^2 */
        double x = trochia_smaller(cbrt(length / b.j), u > 0.0 ? 0.5 * length / u : INFINITY);
        for (int k = 0; k < 8; k++)
            x -= (x * (b.j * x * x + 2.0 * u) - length) / (3.0 * b.j * x * x + 2.0 * u);
        return u + b.j * x * x;
    }
    double half = 0.5 * rise;
    return -half + sqrt(half * half + u * u - rise * u + 2.0 * b.a * length);
}

double trochia_ramp_reach(const trochia_range *range, double u, double most) {
    double length = range->length * ROUNDING;
    most = trochia_smaller(most, range->ceiling);
    if (most <= u)
        return most;
    if (trochia_ramp_way(u, most, trochia_budget_at(range, most)) <= length)
        return most;
    double low = u, high = most;
    if (range->bend_a == 0.0) {
        trochia_budget b = trochia_budget_at(range, u);
        double v = trochia_smaller(u + (straight_reach(length, u, b) - u) * ROUNDING, most);
        if (v > u && trochia_ramp_way(u, v, b) <= length)
            return v;
        high = trochia_larger(v, u);
    }
    for (int k = 0; k < HALVINGS && high - low > 1e-13 * high; k++) {
        double middle = 0.5 * (low + high);
        if (trochia_ramp_way(u, middle, trochia_budget_at(range, middle)) <= length)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static double both_ways(const trochia_range *range, double u0, double u1, double v) {
    trochia_budget b = trochia_budget_at(range, v);
    return trochia_ramp_way(u0, v, b) + trochia_ramp_way(u1, v, b);
}

double trochia_ramp_peak(const trochia_range *range, double u0, double u1) {
    double low = trochia_larger(u0, u1), high = range->ceiling;
    if (low > high || both_ways(range, u0, u1, low) > range->length * SUMMED)
        return -1.0;
    double length = range->length * ROUNDING;
    if (both_ways(range, u0, u1, high) <= length)
        return high;
    for (int k = 0; k < HALVINGS && high - low > 1e-13 * high; k++) {
        double middle = 0.5 * (low + high);
        if (both_ways(range, u0, u1, middle) <= length)
            low = middle;
        else
            high = middle;
    }
    return low;
}
