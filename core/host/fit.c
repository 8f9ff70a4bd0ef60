#include "host/fit.h"

#include <math.h>

enum { LONGEST = 65535, WIDEST = 255 };

static const double ONE = 256.0;       /* an interval's unit in a tick */
static const double FINE = 16777216.0; /* that of add and add2 */

/* What is to be fitted: ticks[0 … count - 1], from `now` [ticks]. */
typedef struct {
    const int64_t *ticks;
    int64_t count;
    int64_t origin; /* whole ticks taken off, so that doubles stay exact */
    double now, tolerance;
} stretch;

static double at(const stretch *s, int64_t step) {
    return step ? (double)(s->ticks[step - 1] - s->origin) : s->now;
}

/* Steps of one interval: where the chord's sag, stride^2 t'' / 8, is a quarter of the tolerance. */
static uint8_t stride_of(const stretch *s, int64_t n) {
    if (n < 8)
        return 1;
    double first = at(s, 2) - at(s, 1), last = at(s, n) - at(s, n - 1), middle = at(s, n / 2 + 1) - at(s, n / 2);
    double bend = fmax(fmax(fabs(middle - first), fabs(last - middle)) - 2.0, 0.0) * 2.0 / (double)n;
    double stride = fmin(sqrt(2.0 * s->tolerance / fmax(bend, 1e-9)), (double)(n / 4));
    return (uint8_t)fmax(1.0, fmin(stride, WIDEST));
}

/* Rounds add and add2 to the finest scale that holds them; returns whether one does. */
static int round_to_scale(double add, double add2, trochia_tick_segment *segment) {
    for (int scale = 0; scale <= TROCHIA_SEGMENT_COARSEST; scale++) {
        double unit = FINE / (double)(1 << 8 * scale);
        if (fabs(add * unit) < 2147483647.0 && fabs(add2 * unit) < 2147483647.0) {
            segment->add = (int32_t)nearbyint(add * unit);
            segment->add2 = (int32_t)nearbyint(add2 * unit);
            segment->flags = (uint8_t)(segment->flags | scale * TROCHIA_SEGMENT_SCALE);
            return 1;
        }
    }
    return 0;
}

/* Mean interval up to chunk J, without the first interval I: h = 2 (g(J) - I) / (J - 1) = add + (J - 2)/3 add2. */
static double rest(const stretch *s, int64_t chunk, int64_t stride, double interval) {
    double mean = (at(s, chunk * stride) - s->now) / (double)(chunk * stride);
    return 2.0 * (mean - interval) / (double)(chunk - 1);
}

/* A cubic through three ticks: g(J) = t(J)/(stride J) = I + (J - 1)/2 add + (J - 1)(J - 2)/6 add2, J whole strides. */
static int guess(const stretch *s, int64_t n, trochia_tick_segment *segment) {
    int64_t stride = segment->stride, chunks = n / stride;
    if (chunks < 3) {
        double mean = (at(s, n) - s->now) / (double)n, first = n > 1 ? at(s, 1) - s->now : mean;
        double interval = stride == 1 && n == 2 ? first : mean;
        segment->interval = (uint32_t)nearbyint(interval * ONE);
        return round_to_scale(stride == 1 && n == 2 ? at(s, 2) - at(s, 1) - first : 0.0, 0.0, segment);
    }
    int64_t third = chunks < 40 ? chunks : (int64_t)(0.9605 * (double)chunks);
    int64_t first = (int64_t)fmax(1.0, 0.2813 * (double)chunks), second = (int64_t)fmax(2.0, 0.6791 * (double)chunks);
    double a = (double)first, b = (double)second, c = (double)third, side = (double)stride;
    double ga = (at(s, first * stride) - s->now) / (side * a), gb = (at(s, second * stride) - s->now) / (side * b);
    double gc = (at(s, third * stride) - s->now) / (side * c);
    double slope = (gb - ga) / (b - a), square = ((gc - gb) / (c - b) - slope) / (c - a);
    double add2 = 6.0 * square, add = 2.0 * (slope - square * (a + b)) + add2;
    double interval = ga - slope * a + square * a * b + add / 2.0 - add2 / 3.0;
    if (!(interval > 0.5 && interval * ONE < 4294967295.0))
        return 0;
    segment->interval = (uint32_t)nearbyint(interval * ONE);
    /* what rounding the interval took is given back by the others; executed intervals are cut, half a unit in the mean
     */
    double held = (double)segment->interval / ONE - 0.5 / ONE;
    double hb = rest(s, second, stride, held), hc = rest(s, third, stride, held);
    add2 = 3.0 * (hc - hb) / (c - b);
    return round_to_scale(hc - (c - 2.0) / 3.0 * add2, add2, segment);
}

/* Executes a segment; returns the greatest deviation [ticks], below 0 where a step is out of tolerance. */
static double deviation(const stretch *s, const trochia_tick_segment *segment, int64_t now, int64_t *end) {
    trochia_segment_run run = {.fraction = 0};
    double worst = 0.0;
    trochia_segment_load(&run, segment);
    for (int64_t step = 1; run.phase; step++) {
        now += run.interval;
        trochia_segment_step(&run);
        double off = fabs((double)(now - s->origin * 256) / ONE - at(s, step));
        double gap = at(s, step) - (step > 1 ? at(s, step - 1) : s->now);
        gap = step < s->count ? fmin(gap, at(s, step + 1) - at(s, step)) : gap;
        if (!(off <= fmin(s->tolerance, fmax(0.5 * gap, 1.0))))
            return -1.0;
        worst = fmax(worst, off);
    }
    *end = now;
    return worst;
}

/* Tries n steps; returns the deviation, below 0 where they do not fit one segment. */
static double attempt(const stretch *s, int64_t n, int64_t now, uint8_t flags, trochia_tick_segment *made,
                      int64_t *end) {
    *made = (trochia_tick_segment){.count = (uint16_t)n, .stride = stride_of(s, n), .flags = flags};
    return guess(s, n, made) ? deviation(s, made, now, end) : -1.0;
}

/* The longest segment that fits, by doubling and halving. */
static trochia_tick_segment longest(const stretch *s, trochia_fit_state *state) {
    trochia_tick_segment best, made;
    int64_t most = s->count < LONGEST ? s->count : LONGEST, end = 0, best_end = 0, low = 1, high = 2;
    double worst = attempt(s, 1, state->now, state->flags, &best, &best_end), off;
    for (; high <= most; high *= 2) {
        if ((off = attempt(s, high, state->now, state->flags, &made, &end)) < 0.0)
            break;
        best = made, best_end = end, worst = off, low = high;
    }
    high = high <= most ? high : most + 1;
    while (high - low > 1 + low / 64) { /* within a few hundredths of the longest */
        int64_t middle = (low + high) / 2;
        if ((off = attempt(s, middle, state->now, state->flags, &made, &end)) < 0.0)
            high = middle;
        else
            best = made, best_end = end, worst = off, low = middle;
    }
    state->now = best_end;
    state->done += low;
    state->worst = fmax(state->worst, fabs(worst));
    return best;
}

int64_t trochia_fit(const int64_t *ticks, int64_t count, double tolerance, trochia_fit_state *state, int64_t capacity,
                    trochia_tick_segment *segments) {
    int64_t made = 0;
    while (state->done < count && made < capacity) {
        stretch s = {.ticks = ticks + state->done,
                     .count = count - state->done,
                     .origin = state->now >> 8,
                     .now = (double)(state->now & 255) / ONE,
                     .tolerance = tolerance};
        double gap = at(&s, 1) - s.now;
        if (gap >= 16777215.0) { /* longer than an interval can be: a pause of whole millions of ticks before */
            int64_t turns = (int64_t)fmin((gap - 1.0) / 16000000.0, LONGEST);
            segments[made++] = (trochia_tick_segment){.interval = 16000000u * 256u,
                                                      .count = (uint16_t)turns,
                                                      .stride = 1,
                                                      .flags = TROCHIA_SEGMENT_PAUSE | state->flags};
            state->now += turns * 16000000 * 256;
            continue;
        }
        segments[made++] = longest(&s, state);
    }
    return made;
}
