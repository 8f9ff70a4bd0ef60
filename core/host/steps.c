/* Step times: closed form where the joint's acceleration is constant, else a polynomial and Newton's method. */
#include "host/steps.h"

#include "host/steps_series.h"

/* Loops without calls and without a reduction: wider registers give the same bits. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) &&                           \
    !defined(__SANITIZE_ADDRESS__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

static const double SLACK = 1e-6;   /* steps: a boundary this near counts as reached */
static const double SMALL = 8.0;    /* steps: about a turning point no polynomial fits, a stretch is cut down to this */
static const double INSTANT = 1e-6; /* ticks: a stretch no longer than this holds no step of its own */

typedef struct {
    trochia_step_state *state;
    int64_t *ticks;
    int8_t *directions;
    int64_t made, capacity;
} sink;

/* To the nearest whole tick; the sum's last bits are the integer, so it needs no conversion and goes four at a time. */
static inline int64_t whole(double x) {
    double shifted = x + 0x1.8p52;
    int64_t bits;
    memcpy(&bits, &shifted, sizeof bits);
    return bits - 0x4338000000000000;
}

/* Steps still to make on the way to q, when the joint moves in `direction`. */
static int64_t steps_to(int64_t count, double q, int direction) {
    int64_t steps = direction > 0 ? (int64_t)floor(q + SLACK) - count : count - (int64_t)ceil(q - SLACK);
    return steps > 0 ? steps : 0;
}

/* Takes room for `steps` or what there is of it; the caller fills out->ticks from the returned index on. */
static int64_t claim(sink *out, int64_t steps, int direction, int64_t *taken) {
    int64_t at = out->made, room = out->capacity - at;
    *taken = steps < room ? steps : room;
    if (steps > room)
        out->state->full = 1;
    if (*taken > 0) {
        memset(out->directions + at, direction, (size_t)*taken);
        out->state->count += direction * *taken;
        out->state->direction = direction;
        out->made += *taken;
    }
    return at;
}

/* Roots of v tau + a tau^2 / 2 = first + i, all positive numbers, by the form that cancels nowhere. */
WIDE static void quadratic_ticks(int32_t n, double first, double v, double a, double limit, double base,
                                 int64_t *restrict ticks) {
    double square = v * v, twice = 2.0 * a;
    for (int32_t i = 0; i < n; i++) {
        double way = first + (double)i;
        double under = square + twice * way;
        under = under > 0.0 ? under : 0.0;
        double tau = 2.0 * way / (v + sqrt(under));
        tau = tau > 0.0 ? tau : 0.0; /* also where 0/0: a step at the very start, from rest */
        tau = tau < limit ? tau : limit;
        ticks[i] = whole(base + tau);
    }
}

/* One monotone stretch [from, to] of q = q0 + v tau + a tau^2 / 2; returns 0 when the space ran out. */
static int quadratic_piece(sink *out, double base, double q0, double v, double a, double from, double to) {
    double start = q0 + from * (v + 0.5 * a * from), end = q0 + to * (v + 0.5 * a * to);
    int direction = end >= start ? 1 : -1;
    int64_t taken, count = out->state->count;
    int64_t at = claim(out, steps_to(count, end, direction), direction, &taken);
    double first = direction * ((double)count - start) + 1.0;
    quadratic_ticks((int32_t)taken, first, direction * (v + a * from), direction * a, to - from, base + from,
                    out->ticks + at);
    return !out->state->full;
}

/* A straight way at constant acceleration: at most one turning point. */
static void straight(sink *out, const joint_curve *curve, const phase_motion *m, double base, double end) {
    double q0 = curve->g[0] + curve->g[1] * m->s, v = curve->g[1] * m->v, a = curve->g[1] * m->a;
    double *tau = &out->state->tau;
    double turn = a != 0.0 ? -v / a : -1.0;
    if (turn > *tau && turn < end) {
        if (!quadratic_piece(out, base, q0, v, a, *tau, turn))
            return;
        *tau = turn;
    }
    if (quadratic_piece(out, base, q0, v, a, *tau, end))
        *tau = end;
}

/* One step of Newton's method for u + b2 u^2 + ... + b9 u^9 = y. */
static inline double newton(double u, double y, double b2, double b3, double b4, double b5, double b6, double b7,
                            double b8, double b9) {
    double p = b9, d = b9;
    p = p * u + b8, d = d * u + p;
    p = p * u + b7, d = d * u + p;
    p = p * u + b6, d = d * u + p;
    p = p * u + b5, d = d * u + p;
    p = p * u + b4, d = d * u + p;
    p = p * u + b3, d = d * u + p;
    p = p * u + b2, d = d * u + p;
    p = p * u + 1.0, d = d * u + p;
    return u - (p * u - y) / d;
}

/* Roots of c1 (u + b2 u^2 + ... + b9 u^9) = first + sign i, where the derivative stays within an eighth of c1: the
 * inverse series to its third term is within 0.02, and two steps of Newton's method bring that to 4e-11. */
WIDE static void newton_ticks(int32_t n, double first, double sign, const double *restrict c, double mid, double half,
                              double base, int64_t *restrict ticks) {
    double per = 1.0 / c[1], b2 = c[2] * per, b3 = c[3] * per, b4 = c[4] * per, b5 = c[5] * per, b6 = c[6] * per;
    double b7 = c[7] * per, b8 = c[8] * per, b9 = c[9] * per, third = 2.0 * b2 * b2 - b3, centre = base + mid;
    for (int32_t i = 0; i < n; i++) {
        double y = (first + sign * (double)i) * per;
        double u = y * (1.0 - y * (b2 - y * third));
        u = newton(u, y, b2, b3, b4, b5, b6, b7, b8, b9);
        u = newton(u, y, b2, b3, b4, b5, b6, b7, b8, b9);
        u = 0.5 * (fabs(u + 1.0) - fabs(u - 1.0)); /* kept to [-1, 1], and without a branch the loop goes four wide */
        ticks[i] = whole(centre + half * u);
    }
}

/* One step for u^2 (1 + b3 u + ... + b9 u^7) = y. */
static inline double turning_newton(double u, double y, double b3, double b4, double b5, double b6, double b7,
                                    double b8, double b9) {
    double p = b9, d = b9;
    p = p * u + b8, d = d * u + p;
    p = p * u + b7, d = d * u + p;
    p = p * u + b6, d = d * u + p;
    p = p * u + b5, d = d * u + p;
    p = p * u + b4, d = d * u + p;
    p = p * u + b3, d = d * u + p;
    p = p * u + 1.0, d = d * u + p;
    return u - (u * u * p - y) / (u * (p + d));
}

/* The same from a turning point: roots of c2 (u^2 + b3 u^3 + ... + b9 u^9) = first + sign i on the side given.  The
 * root of what is left of the way begins, right to a fiftieth; three steps of Newton's method square that to nothing.
 */
WIDE static void turning_ticks(int32_t n, double first, double sign, double side, const double *restrict c, double mid,
                               double half, double base, int64_t *restrict ticks) {
    double per = 1.0 / c[2], b3 = c[3] * per, b4 = c[4] * per, b5 = c[5] * per, b6 = c[6] * per, b7 = c[7] * per;
    double b8 = c[8] * per, b9 = c[9] * per, centre = base + mid;
    for (int32_t i = 0; i < n; i++) {
        double y = (first + sign * (double)i) * per;
        y = y > 1e-200 ? y : 1e-200; /* at the turning point itself, or a rounding beyond */
        double u = side * sqrt(y);
        u = u * (1.0 - u * (0.5 * b3 - u * (0.625 * b3 * b3 - 0.5 * b4)));
        u = turning_newton(u, y, b3, b4, b5, b6, b7, b8, b9);
        u = turning_newton(u, y, b3, b4, b5, b6, b7, b8, b9);
        u = turning_newton(u, y, b3, b4, b5, b6, b7, b8, b9);
        u = 0.5 * (fabs(u + 1.0) - fabs(u - 1.0));
        ticks[i] = whole(centre + half * u);
    }
}

static double value(const double *c, double u) {
    double p = c[TERMS - 1];
    for (int i = TERMS - 2; i >= 0; i--)
        p = p * u + c[i];
    return p;
}

static void derivative(const double *c, double *d) {
    for (int i = 1; i < TERMS; i++)
        d[i - 1] = i * c[i];
    d[TERMS - 1] = 0.0;
}

/* Where the polynomial, monotone on [low, high], takes the value q; an end when it does not. */
static double crossing(const double *c, const double *d, double q, double low, double high) {
    double sign = value(c, high) >= value(c, low) ? 1.0 : -1.0;
    if (sign * (value(c, low) - q) >= 0.0)
        return low;
    if (sign * (value(c, high) - q) <= 0.0)
        return high;
    double u = 0.5 * (low + high);
    for (int i = 0; i < 100 && high - low > 1e-15; i++) {
        double error = value(c, u) - q, slope = value(d, u);
        if (sign * error >= 0.0)
            high = u;
        else
            low = u;
        double next = u - error / slope;
        if (fabs(next - u) <= 1e-15)
            break;
        u = next > low && next < high ? next : 0.5 * (low + high);
    }
    return u;
}

/* One phase of one joint: what the stretches below are cut from. */
typedef struct {
    sink *out;
    const joint_curve *curve;
    const phase_motion *motion;
    double base, end;
} course;

/* What came of a stretch: DONE, its end reached; TURNED, tau set beyond a turning point; CUT, take a shorter one. */
enum verdict { DONE, TURNED, CUT, FULL };

/* The few steps of a monotone piece where nothing better holds; returns 0 when the space ran out. */
static int scalar_piece(const course *way, const double *c, const double *d, double low, double high, double mid,
                        double half) {
    double end = value(c, high);
    int direction = end >= value(c, low) ? 1 : -1;
    int64_t taken, k = way->out->state->count;
    int64_t at = claim(way->out, steps_to(k, end, direction), direction, &taken);
    for (int64_t i = 0; i < taken; i++) {
        k += direction;
        low = crossing(c, d, (double)k, low, high);
        way->out->ticks[at + i] = whole(way->base + (mid + half * low));
    }
    return !way->out->state->full;
}

/* A short stretch in which the velocity changes its sign at most once, step by step. */
static enum verdict slow(const course *way, const double *c, double mid, double half) {
    double d[TERMS], second[TERMS], low = -1.0;
    derivative(c, d);
    if (value(d, -1.0) * value(d, 1.0) < 0.0) {
        derivative(d, second);
        double turn = crossing(d, second, 0.0, -1.0, 1.0);
        if (!scalar_piece(way, c, d, -1.0, turn, mid, half))
            return FULL;
        low = turn;
        way->out->state->tau = mid + half * turn;
    }
    return scalar_piece(way, c, d, low, 1.0, mid, half) ? DONE : FULL;
}

/* A stretch whose velocity hardly changes. */
static enum verdict steady(const course *way, const double *c, double mid, double half) {
    int direction = c[1] > 0.0 ? 1 : -1;
    int64_t taken, count = way->out->state->count;
    int64_t at = claim(way->out, steps_to(count, value(c, 1.0), direction), direction, &taken);
    double first = (double)(count + direction) - c[0];
    newton_ticks((int32_t)taken, first, direction, c, mid, half, way->base, way->out->ticks + at);
    return way->out->state->full ? FULL : DONE;
}

/* One side of a turning point, as far as u; returns 0 when the space ran out. */
static int side_of(const course *way, const double *c, double side, double u, double mid, double half) {
    int direction = c[2] * side > 0.0 ? 1 : -1;
    int64_t taken, count = way->out->state->count;
    int64_t at = claim(way->out, steps_to(count, value(c, u), direction), direction, &taken);
    double first = (double)(count + direction) - c[0];
    turning_ticks((int32_t)taken, first, direction, side, c, mid, half, way->base, way->out->ticks + at);
    return !way->out->state->full;
}

static double higher_of(const double *c) {
    double sum = 0.0;
    for (int i = 3; i < TERMS; i++)
        sum += i * (i - 1) * fabs(c[i]);
    return sum;
}

/* A stretch about the turning point near `where`, as far beyond it as it lies ahead, or half of `half`. */
static enum verdict turning(const course *way, double where, double half) {
    double *tau = &way->out->state->tau, c[TERMS], reach;
    for (int round = 0;; round++) {
        reach = fmax(fabs(where - *tau), 0.5 * half);
        if (!(series_of(way->curve, way->motion, where, reach, c) <= 1.0))
            return CUT;
        if (fabs(c[1]) <= 1e-10 * fabs(c[2]))
            break;
        double shift = -0.5 * c[1] / c[2];
        if (round == 4 || !(fabs(shift) < 0.5))
            return CUT;
        where += reach * shift;
    }
    double low = (*tau - where) / reach, high = fmin(1.0, (way->end - where) / reach);
    if (higher_of(c) > 0.5 * fabs(c[2]) || high <= low || low > 0.5)
        return CUT;
    if (low < 0.0) {
        double stop = fmin(high, 0.0);
        if (!side_of(way, c, -1.0, stop, where, reach))
            return FULL;
        *tau = where + reach * stop;
    }
    if (high > 0.0 && !side_of(way, c, 1.0, high, where, reach))
        return FULL;
    *tau = high < 1.0 ? way->end : where + reach;
    return TURNED;
}

/* Works a stretch by what its polynomial allows; `scale` becomes the next stretch's length in this one's. */
static enum verdict stretch(const course *way, const double *c, double mid, double half, double used, double *scale) {
    double span = 0.0, higher = higher_of(c), bend = higher + 2.0 * fabs(c[2]), count = (double)way->out->state->count;
    for (int i = 1; i < TERMS; i++)
        span += fabs(c[i]);
    if (c[0] + span < count + 1.0 - SLACK && c[0] - span > count - 1.0 + SLACK)
        return DONE;                        /* no boundary within reach */
    double ahead = 1.0 - 0.5 * c[1] / c[2]; /* from the stretch's start to the turning point, were it a parabola */
    if (bend > 0.08 * fabs(c[1]) && ahead > -0.01 && ahead < 14.0 && ahead * used < 1.0 && higher < fabs(c[2])) {
        enum verdict verdict = turning(way, mid + half * (ahead - 1.0), half);
        *scale = 0.25 * fmin(ahead, 1.0);
        if (verdict != CUT)
            return verdict;
    }
    *scale = 0.9 * 0.125 * fabs(c[1]) / bend;
    if (bend <= 0.125 * fabs(c[1]))
        return steady(way, c, mid, half);
    if ((higher <= 1.8 * fabs(c[2]) && span <= SMALL) || span <= SLACK || half <= INSTANT)
        return slow(way, c, mid, half);
    return CUT;
}

/* Any curve and jerk: stretches as long as their polynomial allows. */
static void bent(const course *way) {
    double *tau = &way->out->state->tau, half = 0.5 * (way->end - *tau), c[TERMS];
    while (*tau < way->end) {
        int last = half >= 0.5 * (way->end - *tau);
        half = last ? 0.5 * (way->end - *tau) : half;
        double mid = *tau + half, next = last ? way->end : mid + half, scale = 2.0;
        double used = series_of(way->curve, way->motion, mid, half, c);
        enum verdict verdict = used > 1.0 ? CUT : stretch(way, c, mid, half, used, &scale);
        if (verdict == FULL)
            return;
        if (verdict == DONE)
            *tau = next > *tau ? next : way->end;
        scale = fmin(scale, fmin(2.0, 0.95 / used));
        half *= fmax(0.1, verdict == CUT ? fmin(scale, 0.7) : scale);
    }
}

static phase_motion motion_of(const trochia_phase *phase, double clock) {
    double tick = 1.0 / clock;
    return (phase_motion){phase->s, phase->v * tick, phase->a * tick * tick, phase->j * tick * tick * tick};
}

int64_t trochia_steps(const trochia_step_job *job, trochia_step_state *state, int64_t capacity, int64_t *ticks,
                      int8_t *directions) {
    sink out = {state, ticks, directions, 0, capacity};
    joint_curve curve;
    int64_t known = -1; /* segment the curve belongs to */
    state->full = 0;
    for (; state->phase < job->phase_count; state->phase++, state->tau = 0.0) {
        const trochia_phase *phase = job->phases + state->phase;
        double base = phase->t * job->clock, duration = phase->duration * job->clock;
        double end = fmin(duration, job->until - base);
        if (!(phase->flags & 1u) && end > state->tau) {
            if (known != (int64_t)phase->segment)
                curve_of(job, job->segments + phase->segment, &curve);
            known = (int64_t)phase->segment;
            phase_motion motion = motion_of(phase, job->clock);
            if (!curve.arc && curve.g[2] == 0.0 && curve.g[3] == 0.0 && phase->j == 0.0)
                straight(&out, &curve, &motion, base, end);
            else
                bent(&(course){&out, &curve, &motion, base, end});
            if (state->full)
                break;
        }
        if (end < duration)
            break;
    }
    return out.made;
}
