/* Knots read as phases (cut where segments meet), and as states at given times. */
#include <math.h>

#include "host/scurve_march.h"

static double way(const trochia_knot *knot, double tau) {
    return tau * (knot->v + tau * (0.5 * knot->a + tau * knot->j / 6.0));
}

static double speed(const trochia_knot *knot, double tau) {
    return knot->v + tau * (knot->a + 0.5 * tau * knot->j);
}

/* When the way from a knot is `target`, between two times: Newton, kept in by halving. */
static double time_of(const trochia_knot *knot, double target, double low, double high) {
    double v = speed(knot, low), tau = v > 0.0 ? low + (target - way(knot, low)) / v : 0.5 * (low + high);
    for (int k = 0; k < 100; k++) {
        if (!(tau > low) || !(tau < high))
            tau = 0.5 * (low + high);
        double off = way(knot, tau) - target;
        if (off > 0.0)
            high = tau;
        else
            low = tau;
        v = speed(knot, tau);
        double next = v > 0.0 ? tau - off / v : 0.5 * (low + high);
        if (fabs(next - tau) <= 1e-15 * high || high - low <= 1e-15 * high)
            break;
        tau = next;
    }
    return fmin(fmax(tau, low), high);
}

void trochia_scurve_starts(const trochia_stretch *stretches, uint64_t stretch_count, double *starts) {
    double base = 0.0;
    for (uint64_t k = 0; k < stretch_count; k++) {
        if (k > 0 && stretches[k].start == 0.0)
            base += trochia_end_of(&stretches[k - 1]);
        if (k == 0 || stretches[k].segment != stretches[k - 1].segment)
            starts[stretches[k].segment] = base + stretches[k].start;
    }
    if (stretch_count) {
        const trochia_stretch *last = &stretches[stretch_count - 1];
        starts[last->segment + 1] = base + trochia_end_of(last);
    }
}

static trochia_phase phase_at(const trochia_knot *knot, const double *starts, uint64_t segment, double tau) {
    double s = knot->s + way(knot, tau) - starts[segment];
    trochia_phase phase = {.t = knot->t + tau,
                           .s = fmin(fmax(s, 0.0), starts[segment + 1] - starts[segment]),
                           .v = fmax(speed(knot, tau), 0.0),
                           .a = knot->a + tau * knot->j,
                           .j = knot->j,
                           .segment = (uint32_t)segment,
                           .flags = knot->flags};
    return phase;
}

uint64_t trochia_scurve_phases(const double *starts, uint64_t count, const trochia_knot *knots, uint64_t knot_count,
                               trochia_knot_cursor *cursor, trochia_phase *out, uint64_t room) {
    uint64_t made = 0;
    while (made < room && cursor->knot + 1 < knot_count) {
        const trochia_knot *knot = &knots[cursor->knot];
        double end = knot[1].t - knot->t, tau = cursor->tau;
        if (tau == 0.0 && knot->segment > cursor->segment)
            cursor->segment = knot->segment;
        uint64_t segment = knot->flags ? knot->segment : cursor->segment;
        /* places in a segment are counted from its end too: a long one has more rounding than s before it */
        int crosses = !knot->flags && segment + 1 < count &&
                      starts[segment + 1] < knot[1].s - TROCHIA_SAME_PLACE(starts[segment + 2]);
        double until = crosses ? time_of(knot, starts[segment + 1] - knot->s, tau, end) : end;
        if (until > tau) {
            trochia_phase phase = phase_at(knot, starts, segment, tau);
            phase.duration = until - tau;
            out[made++] = phase;
        }
        if (crosses) {
            cursor->tau = until;
            cursor->segment++;
        } else {
            cursor->tau = 0.0;
            cursor->knot++;
        }
    }
    return made;
}

static uint64_t knot_at(const trochia_knot *knots, uint64_t count, double t, uint64_t near) {
    uint64_t low = knots[near].t <= t ? near : 0, high = count;
    for (uint64_t step = 1; low + step < count; step *= 2) {
        if (knots[low + step].t > t) {
            high = low + step;
            break;
        }
        low += step;
    }
    while (high - low > 1) {
        uint64_t middle = low + (high - low) / 2;
        if (knots[middle].t <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The segment in which s lies, not before `low`. */
static uint64_t segment_at(const double *starts, uint64_t count, double s, uint64_t low) {
    uint64_t high = low + 1;
    for (uint64_t step = 1; high < count && starts[high] <= s; step *= 2) {
        low = high;
        high += step;
    }
    high = high < count ? high : count;
    while (high - low > 1) {
        uint64_t middle = low + (high - low) / 2;
        if (starts[middle] <= s)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void trochia_scurve_states(const double *starts, uint64_t count, const trochia_knot *knots, uint64_t knot_count,
                           const double *times, uint64_t time_count, trochia_phase *out) {
    uint64_t k = 0;
    for (uint64_t i = 0; i < time_count; i++) {
        k = knot_at(knots, knot_count, times[i], k);
        double end = k + 1 < knot_count ? knots[k + 1].t - knots[k].t : 0.0;
        double tau = fmin(fmax(times[i] - knots[k].t, 0.0), end);
        uint64_t segment = knots[k].segment;
        if (!knots[k].flags)
            segment = segment_at(starts, count, knots[k].s + way(&knots[k], tau), segment);
        out[i] = phase_at(&knots[k], starts, segment, tau);
        out[i].t = times[i];
        out[i].duration = 0.0;
    }
}

static double row_of(const trochia_limits *limits, uint32_t row, const double *vector) {
    double sum = 0.0;
    for (uint32_t i = 0; i < limits->axes; i++)
        sum += limits->matrix[row * limits->axes + i] * vector[i];
    return sum;
}

void trochia_scurve_peaks(const trochia_segment *segments, const double *pool, const trochia_limits *limits,
                          const trochia_phase *phases, uint64_t phase_count, double *velocity, double *acceleration,
                          double *jerk) {
    enum { POINTS = 8 };
    uint32_t n = limits->axes;
    double x[36];
    for (uint64_t k = 0; k < phase_count; k++) {
        const trochia_phase *phase = &phases[k];
        const trochia_segment *segment = &segments[phase->segment];
        for (int at = 0; at <= POINTS; at++) {
            double tau = phase->duration * at / POINTS, a = phase->a + tau * phase->j, j = phase->j;
            double v = phase->v + tau * (phase->a + 0.5 * tau * phase->j);
            double s = phase->s + tau * (phase->v + tau * (0.5 * phase->a + tau * phase->j / 6.0));
            trochia_segment_at(segment, pool, n, fmin(s, segment->length), 4, x);
            for (uint32_t row = 0; row < limits->rows; row++) {
                double t = row_of(limits, row, x + n), bend = row_of(limits, row, x + 2 * n);
                double third = row_of(limits, row, x + 3 * n);
                velocity[row] = fmax(velocity[row], fabs(t * v));
                acceleration[row] = fmax(acceleration[row], fabs(bend * v * v + t * a));
                jerk[row] = fmax(jerk[row], fabs(third * v * v * v + 3.0 * bend * v * a + t * j));
            }
        }
    }
}
