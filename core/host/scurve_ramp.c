/* How fast a ramp gets, given how long it may be. */
#include "host/scurve_ramp.h"

static const int STEPS = 60;
static const double CLOSE = 1e-12;
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

/* Way of a ramp from u0 to v and, unless u1 < 0, of one back to u1. */
static double way_by(const trochia_range *range, double u0, double u1, double v) {
    trochia_budget b = trochia_budget_at(range, v);
    return trochia_ramp_way(u0, v, b) + (u1 < 0.0 ? 0.0 : trochia_ramp_way(u1, v, b));
}

/* Greatest v in [low, high] whose way is no longer than `length`; low's is, high's is not.  The false position's rule,
 * with the weight of an end that stays halved, and halving where a way is infinite. */
static double search(const trochia_range *range, double u0, double u1, double low, double high, double length) {
    double under = way_by(range, u0, u1, low) - length, over = way_by(range, u0, u1, high) - length;
    int stayed = 0;
    for (int k = 0; k < STEPS && high - low > CLOSE * high; k++) {
        double v = over < INFINITY && k % 4 < 3 ? low - under * (high - low) / (over - under) : 0.5 * (low + high);
        if (!(v > low) || !(v < high))
            v = 0.5 * (low + high);
        double off = way_by(range, u0, u1, v) - length;
        if (off <= 0.0) {
            over *= stayed == 1 ? 0.5 : 1.0;
            stayed = 1;
            low = v;
            under = off;
            if (off >= -CLOSE * length)
                break;
        } else {
            under *= stayed == -1 ? 0.5 : 1.0;
            stayed = -1;
            high = v;
            over = off;
        }
    }
    return low;
}

double trochia_ramp_reach(const trochia_range *range, double u, double most) {
    double length = range->length * ROUNDING;
    most = trochia_smaller(most, range->ceiling);
    if (most <= u)
        return most;
    if (way_by(range, u, -1.0, most) <= length)
        return most;
    if (range->bend_a == 0.0) {
        trochia_budget b = trochia_budget_at(range, u);
        double v = trochia_smaller(u + (straight_reach(length, u, b) - u) * ROUNDING, most);
        if (v > u && trochia_ramp_way(u, v, b) <= length)
            return v;
    }
    return search(range, u, -1.0, u, most, length);
}

double trochia_ramp_peak(const trochia_range *range, double u0, double u1) {
    double low = trochia_larger(u0, u1), high = range->ceiling, length = range->length * ROUNDING;
    if (low > high)
        return -1.0;
    double least = way_by(range, u0, u1, low);
    if (least > length)
        return least > range->length * SUMMED ? -1.0 : low;
    if (way_by(range, u0, u1, high) <= length)
        return high;
    return search(range, u0, u1, low, high, length);
}
