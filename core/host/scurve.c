/* The two passes.  Both grow a ramp from the last place of a = 0 over one stretch after another; where a ramp begun
 * later gets faster (the path bends, and speed leaves less for a), that place of a = 0 is taken in.  Backward says how
 * fast each joint may be passed, forward follows until it meets that, and joins both by the highest peak between. */
#include <math.h>

#include "host/scurve_ramp.h"

static const double SLACK = 1.0 + 1e-12;

/* A ramp that is being grown: where it began, and what it reaches. */
typedef struct {
    uint64_t at;    /* boundary where it began: that many stretches lie before it */
    double v;       /* speed there */
    double reached; /* where it has got to */
    double until;   /* and one stretch before */
    trochia_range range, before;
} trochia_front;

static trochia_front front_at(uint64_t at, double v) {
    trochia_front front = {
        .at = at, .v = v, .reached = v, .until = v, .range = TROCHIA_NO_RANGE, .before = TROCHIA_NO_RANGE};
    return front;
}

static double grow(trochia_front *front, const trochia_stretch *stretch, double cap) {
    front->before = front->range;
    front->until = front->reached;
    trochia_range_add(&front->range, stretch);
    front->reached = trochia_ramp_reach(&front->range, front->v, cap);
    return front->reached;
}

/* Greatest speed at the boundary before stretch b. */
static double cap_at(const trochia_stretch *stretches, uint64_t b) {
    if (b == 0 || stretches[b - 1].last)
        return 0.0;
    return trochia_smaller(stretches[b - 1].ceiling, stretches[b].ceiling);
}

static uint64_t apart(uint64_t a, uint64_t b) {
    return a > b ? a - b : b - a;
}

/* A second place to begin is weighed as long as it is nearer than the first was to it; 1 when it is time for a new. */
static int stale(const trochia_front *far, const trochia_front *near, uint64_t b) {
    return near->at == far->at || apart(near->at, b) > 2 + apart(far->at, near->at);
}

static void backward(trochia_stretch *stretches, uint64_t count) {
    trochia_front far = front_at(count, 0.0), near = far;
    for (uint64_t b = count; b-- > 0;) {
        trochia_stretch *here = &stretches[b];
        double cap = cap_at(stretches, b), v = grow(&far, here, cap);
        if (v < cap && near.at != far.at) {
            here->other = grow(&near, here, cap);
            if (here->other > v * SLACK) {
                for (uint64_t k = b + 1; k < near.at; k++)
                    stretches[k].back = stretches[k].other;
                stretches[near.at].node = 1;
                far = near;
                v = here->other;
            }
        }
        if (v < cap && far.at != b + 1) {
            trochia_front fresh = front_at(b + 1, stretches[b + 1].back);
            if (grow(&fresh, here, cap) > v * SLACK) {
                stretches[b + 1].node = 1;
                far = near = fresh;
                v = fresh.reached;
            }
        }
        here->back = v;
        if (v >= cap) {
            here->node = 1;
            far = near = front_at(b, v);
        } else if (stale(&far, &near, b))
            near = far.range.bend_a > 0.0 || v >= far.range.ceiling ? front_at(b, v) : far;
    }
}

typedef struct {
    trochia_stretch *stretches;
    uint64_t count;
    const uint64_t *rest_segments;
    const double *rest_seconds;
    uint64_t rests, rest;
    trochia_knot *knots;
    uint64_t made;
    double t, s, v;  /* where the knots end */
    uint64_t at;     /* which boundary that is */
    uint64_t walked; /* stretch of the last knot, and s at its end */
    double walked_to;
} trochia_writer;

static void push(trochia_writer *w, double s, double v, double a, double j, double duration) {
    if (!(duration > 0.0))
        return;
    while (s >= w->walked_to - TROCHIA_SAME_PLACE(s) && w->walked + 1 < w->count)
        w->walked_to += w->stretches[++w->walked].length;
    trochia_knot knot = {.t = w->t, .s = s, .v = v, .a = a, .j = j, .segment = w->stretches[w->walked].segment};
    w->t += duration;
    if (a == 0.0 && j == 0.0 && w->made) {
        const trochia_knot *last = &w->knots[w->made - 1];
        if (last->a == 0.0 && last->j == 0.0 && last->v == v && !last->flags)
            return;
    }
    w->knots[w->made++] = knot;
}

static void ramp(trochia_writer *w, double s, double u, double v, trochia_budget b) {
    double change = fabs(v - u), sign = v < u ? -1.0 : 1.0;
    if (change == 0.0)
        return;
    double first = change * b.j <= b.a * b.a ? sqrt(change / b.j) : b.a / b.j;
    double top = b.j * first, even = change * b.j <= b.a * b.a ? 0.0 : change / b.a - first;
    double j = sign * b.j, a = sign * top, step = 0.5 * a * first;
    push(w, s, u, 0.0, j, first);
    s += first * (u + j * first * first / 6.0);
    push(w, s, u + step, a, 0.0, even);
    s += even * (u + step + 0.5 * a * even);
    push(w, s, v - step, a, -j, first);
}

/* Rests before the boundary the knots end at. */
static void rest(trochia_writer *w) {
    double seconds = 0.0;
    for (; w->rest < w->rests && (w->at == w->count || w->rest_segments[w->rest] <= w->stretches[w->at].segment);
         w->rest++)
        seconds += w->rest_seconds[w->rest];
    if (!(seconds > 0.0))
        return;
    trochia_knot knot = {.t = w->t, .s = w->s, .segment = w->at ? w->stretches[w->at - 1].segment : 0, .flags = 1};
    w->knots[w->made++] = knot;
    w->t += seconds;
}

/* From where the knots end to boundary `to`, there at v, by way of the peak. */
static void run(trochia_writer *w, uint64_t to, const trochia_range *range, double v, double peak) {
    trochia_budget b = trochia_budget_at(range, peak);
    double up = trochia_ramp_way(w->v, peak, b), down = trochia_ramp_way(v, peak, b);
    double even = range->length - up - down, end = w->s;
    for (uint64_t k = w->at; k < to; k++) /* one by one, as everywhere: then sums agree to the last bit */
        end += w->stretches[k].length;
    if (w->v == 0.0)
        rest(w);
    ramp(w, w->s, w->v, peak, b);
    if (even > 1e-13 * range->length)
        push(w, w->s + up, peak, 0.0, 0.0, even / peak);
    ramp(w, end - down, peak, v, b);
    w->s = end;
    w->v = v;
    w->at = to;
}

static trochia_range range_of(const trochia_stretch *stretches, uint64_t from, uint64_t to) {
    trochia_range range = TROCHIA_NO_RANGE;
    for (uint64_t k = from; k < to; k++)
        trochia_range_add(&range, &stretches[k]);
    return range;
}

/* A run by way of the highest peak, not yet written. */
typedef struct {
    trochia_range range;
    double v, peak, time; /* where it ends, its highest, how long it takes (infinite: not possible) */
} trochia_way;

static trochia_way way_over(const trochia_range *range, double u, double v) {
    double peak = trochia_ramp_peak(range, u, v);
    trochia_way way = {.range = *range, .v = v, .peak = peak, .time = INFINITY};
    if (peak < 0.0)
        return way;
    trochia_budget b = trochia_budget_at(range, peak);
    double even = range->length - trochia_ramp_way(u, peak, b) - trochia_ramp_way(v, peak, b);
    way.time = trochia_ramp_time(peak - u, b) + trochia_ramp_time(peak - v, b) + trochia_larger(even, 0.0) / peak;
    return way;
}

static void run_over(trochia_writer *w, uint64_t to, const trochia_range *range, double v) {
    trochia_way way = way_over(range, w->v, v);
    run(w, to, &way.range, v, way.peak);
}

/* Runs one after another, by way of places with a = 0. */
typedef struct {
    trochia_way ways[3];
    uint64_t to[3];
    int count;
    double time;
} trochia_route;

static void route_by(const trochia_writer *w, trochia_route *route, uint64_t to, double v) {
    int last = route->count - 1;
    uint64_t from = last < 0 ? w->at : route->to[last];
    trochia_range range = range_of(w->stretches, from, to);
    double u = last < 0 ? w->v : route->ways[last].v;
    trochia_way way = way_over(&range, u, v);
    route->ways[route->count] = way;
    route->to[route->count++] = to;
    route->time += way.time;
}

/* The ramp has met what the pass back allows, at boundary b: on to the next place where that has a = 0, at once, or by
 * way of a = 0 at b, one before, or both, whichever is quickest. */
static uint64_t join(trochia_writer *w, const trochia_front *far, uint64_t b) {
    uint64_t to = b;
    while (to < w->count && !w->stretches[to].node)
        to++;
    double met = b < w->count ? w->stretches[b].back : 0.0, v = to < w->count ? w->stretches[to].back : 0.0;
    trochia_route best = {.time = INFINITY};
    int before = far->at + 1 < b ? 2 : 1, at = to > b ? 2 : 1;
    for (int i = 0; i < before; i++)
        for (int k = 0; k < at; k++) {
            trochia_route route = {.time = 0.0};
            if (i)
                route_by(w, &route, b - 1, far->until);
            if (k)
                route_by(w, &route, b, met);
            route_by(w, &route, to, v);
            if (best.count == 0 || route.time < best.time)
                best = route;
        }
    for (int k = 0; k < best.count; k++)
        run(w, best.to[k], &best.ways[k].range, best.ways[k].v, best.ways[k].peak);
    return to;
}

static void forward(trochia_writer *w) {
    trochia_stretch *stretches = w->stretches;
    trochia_front far = front_at(0, 0.0), near = far;
    for (uint64_t b = 1; b <= w->count; b++) {
        const trochia_stretch *here = &stretches[b - 1];
        double cap = b < w->count ? stretches[b].back : 0.0, v = grow(&far, here, cap);
        if (v < cap && near.at != far.at && grow(&near, here, cap) > v * SLACK) {
            trochia_range before = range_of(stretches, far.at, near.at);
            run_over(w, near.at, &before, near.v);
            far = near;
            v = near.reached;
        }
        if (v < cap && far.at != b - 1) {
            trochia_front fresh = front_at(b - 1, far.until);
            if (grow(&fresh, here, cap) > v * SLACK) {
                run_over(w, b - 1, &far.before, far.until);
                far = near = fresh;
                v = fresh.reached;
            }
        }
        if (v >= cap) {
            b = join(w, &far, b);
            far = near = front_at(b, w->v);
        } else if (stale(&far, &near, b))
            near = far.range.bend_a > 0.0 || v >= far.range.ceiling ? front_at(b, v) : far;
    }
}

uint64_t trochia_scurve(trochia_stretch *stretches, uint64_t stretch_count, const uint64_t *rest_segments,
                        const double *rest_seconds, uint64_t rests, trochia_knot *knots) {
    trochia_writer w = {.stretches = stretches,
                        .count = stretch_count,
                        .rest_segments = rest_segments,
                        .rest_seconds = rest_seconds,
                        .rests = rests,
                        .knots = knots,
                        .walked_to = stretches[0].length};
    backward(stretches, stretch_count);
    forward(&w);
    rest(&w);
    trochia_knot end = {.t = w.t, .s = w.s, .segment = stretches[stretch_count - 1].segment};
    w.knots[w.made++] = end;
    return w.made;
}
