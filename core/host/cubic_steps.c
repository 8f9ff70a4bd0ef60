#include "host/cubic_steps.h"

#include <math.h>

static double at(const double *c, double t) {
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
}

/* The end of the stretch from `t` on in which the joint goes one way: the next zero of the velocity, or h. */
static double one_way(const double *c, double t, double h) {
    double a = 3.0 * c[3], b = 2.0 * c[2], square = b * b - 4.0 * a * c[1], best = h;
    if (square < 0.0)
        return h;
    double q = -0.5 * (b + copysign(sqrt(square), b));
    double roots[2] = {q / a, c[1] / q}; /* of 0 / 0 nothing comes, and it is not taken */
    for (int i = 0; i < 2; i++) {
        if (roots[i] > t + 1e-6 && roots[i] < best)
            best = roots[i];
    }
    return best;
}

/* Where a monotone stretch [low, high] passes `target`: Newton's method, kept inside by halving. */
static double crossing(const double *c, double low, double high, double target) {
    double rising = at(c, high) - at(c, low) > 0.0 ? 1.0 : -1.0, t = 0.5 * (low + high);
    for (int i = 0; i < 60 && high - low > 0.01; i++) {
        double off = rising * (at(c, t) - target), slope = rising * (c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]));
        if (off > 0.0)
            high = t;
        else
            low = t;
        double next = t - off / slope;
        if (fabs(next - t) < 0.01 && next >= low - 0.01 && next <= high + 0.01)
            return next;
        t = next > low && next < high ? next : 0.5 * (low + high);
    }
    return t;
}

int64_t trochia_cubic_steps(const double *coefficients, const double *starts, int64_t rows, trochia_cubic_state *state,
                            int64_t capacity, int64_t *ticks, int8_t *directions) {
    int64_t made = 0;
    for (; state->row < rows; state->row++, state->tau = 0.0) {
        const double *c = coefficients + 4 * state->row;
        double h = starts[state->row + 1] - starts[state->row];
        while (state->tau < h) {
            double end = one_way(c, state->tau, h), off = at(c, end) - (double)state->count;
            while (fabs(off) > 0.5 + 1e-6) {
                int8_t way = off > 0.0 ? 1 : -1;
                if (made == capacity)
                    return made;
                state->tau =
                    fmin(fmax(crossing(c, state->tau, end, (double)state->count + 0.5 * way), state->tau), end);
                state->count += way;
                ticks[made] = (int64_t)nearbyint(starts[state->row] + state->tau);
                directions[made++] = way;
                off = at(c, end) - (double)state->count;
            }
            state->tau = end;
        }
    }
    return made;
}
