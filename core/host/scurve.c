/* The pass forward: as fast as it gets, always able to bring a to 0 below the ceiling and to join the pass back. */
#include "host/scurve_march.h"

static const double ALIKE = 1e-12;

typedef struct {
    trochia_course course;
    const uint64_t *rest_segments;
    const double *rest_seconds;
    uint64_t rests, rest;
    trochia_knot *knots;
    uint64_t made, room;
    double t;
    int64_t at;  /* stretch that motion has come to the start of */
    double base; /* way to the stop from which s is counted there */
    double v, a; /* there */
} trochia_writer;

/* Whether motion from a knot on, at a time since, is that of another. */
static int goes_on(const trochia_knot *last, const trochia_knot *next, double time) {
    double a = last->a + time * last->j, v = trochia_speed_after(last->v, last->a, last->j, time);
    double s = last->s + trochia_way_after(last->v, last->a, last->j, time);
    return !last->flags && !next->flags && next->v > 0.0 && fabs(next->j - last->j) <= ALIKE * fabs(last->j) &&
           fabs(next->a - a) <= ALIKE * (fabs(last->a) + fabs(a)) && fabs(next->v - v) <= ALIKE * v &&
           fabs(next->s - s) <= TROCHIA_SAME_PLACE(s);
}

static void put(trochia_writer *w, trochia_knot knot, double duration) {
    knot.t = w->t;
    knot.s += w->base;
    w->t += duration;
    if (w->made && w->made <= w->room && duration > 0.0) {
        const trochia_knot *last = &w->knots[w->made - 1];
        if (goes_on(last, &knot, knot.t - last->t))
            return;
    }
    if (w->made < w->room)
        w->knots[w->made] = knot;
    w->made++;
}

static void put_leg(trochia_writer *w, const trochia_leg *leg) {
    uint32_t segment = w->course.stretches[leg->stretch].segment;
    trochia_knot knot = {.s = leg->from, .v = leg->v, .a = leg->a, .j = leg->j, .segment = segment};
    if (leg->duration > 0.0)
        put(w, knot, leg->duration);
}

/* A leg of the pass back, forward in time, from `until` (since its start, seen back in time) on. */
static void put_back(trochia_writer *w, const trochia_leg *leg, double until) {
    uint32_t segment = w->course.stretches[leg->stretch].segment;
    int whole = until >= leg->duration;
    until = whole ? leg->duration : until;
    double v = trochia_speed_after(leg->v, leg->a, leg->j, until), a = leg->a + until * leg->j;
    double s = whole ? leg->to : leg->from - trochia_way_after(leg->v, leg->a, leg->j, until);
    trochia_knot knot = {.s = s, .v = v, .a = a > 0.0 ? -a : 0.0, .j = leg->j, .segment = segment};
    if (until > 0.0)
        put(w, knot, until);
}

/* Goes on at the start of a stretch. */
static void come_to(trochia_writer *w, int64_t at) {
    const trochia_stretch *stretches = w->course.stretches;
    w->at = at;
    if (stretches[at].start == 0.0)
        w->base += trochia_end_of(&stretches[at - 1]);
}

/* Rests before the stretch motion has come to. */
static void rest(trochia_writer *w) {
    const trochia_stretch *stretches = w->course.stretches;
    double seconds = 0.0;
    int end = w->at == w->course.count;
    for (; w->rest < w->rests && (end || w->rest_segments[w->rest] <= stretches[w->at].segment); w->rest++)
        seconds += w->rest_seconds[w->rest];
    if (!(seconds > 0.0))
        return;
    trochia_knot knot = {.s = stretches[w->at].start, .segment = w->at ? stretches[w->at - 1].segment : 0, .flags = 1};
    put(w, knot, seconds);
}

/* Writes an arrest; back in time its legs are written from the last. */
static void put_arrest(trochia_writer *w, int64_t by, int64_t i, double rem, double v, double a) {
    trochia_course *course = &w->course;
    trochia_track track = {course->stretches, course->count, by};
    uint64_t made = 0, room = course->room > course->made ? course->room - course->made : 0;
    trochia_leg *legs = course->legs + (room ? course->made : 0);
    trochia_arrest_from(&track, i, rem, v, a, legs, room, &made);
    if (made > room) {
        course->made = course->room + 1; /* asks for more */
        return;
    }
    for (uint64_t k = 0; k < made; k++)
        if (by > 0)
            put_leg(w, &legs[k]);
        else
            put_back(w, &legs[made - 1 - k], INFINITY);
}

static void put_even(trochia_writer *w, double from, double to, double v, int64_t i) {
    const trochia_stretch *stretches = w->course.stretches;
    if (to - from <= TROCHIA_SAME_PLACE(to))
        return;
    while (i + 1 < w->course.count && !stretches[i].last && stretches[i + 1].start <= from + TROCHIA_SAME_PLACE(from))
        i++;
    trochia_leg leg = {from, to, v, 0.0, 0.0, (to - from) / v, 0.0, 0.0, (uint64_t)i};
    put_leg(w, &leg);
}

/* From a = 0 along the pass back to its node. */
static void follow(trochia_writer *w, const trochia_leave *leave, int64_t node) {
    const trochia_course *course = &w->course;
    const trochia_stretch *stretches = course->stretches;
    if (leave->stretch == node) {
        double v = leave->v_node, a = node < course->count ? stretches[node].kick_in * v * v : 0.0;
        put_arrest(w, -1, node - 1, stretches[node - 1].length, v, a);
        return;
    }
    const trochia_stretch *stretch = &stretches[leave->stretch];
    uint64_t n = 0;
    double tau = leave->tau;
    const trochia_leg *legs = course->legs + stretch->leg;
    while (n + 1 < stretch->legs && tau > legs[n].duration)
        tau -= legs[n++].duration;
    double v = trochia_speed_after(legs[n].v, legs[n].a, legs[n].j, tau), a = legs[n].a + tau * legs[n].j;
    double rem = (legs[n].from - stretch->start) - trochia_way_after(legs[n].v, legs[n].a, legs[n].j, tau);
    put_arrest(w, -1, leave->stretch, trochia_larger(rem, 0.0), v, trochia_larger(a, 0.0));
    put_back(w, &legs[n], tau);
    while (n-- > 0)
        put_back(w, &legs[n], INFINITY);
    for (int64_t k = leave->stretch + 1; k < node; k++)
        for (uint64_t m = stretches[k].legs; m-- > 0;)
            put_back(w, &course->legs[stretches[k].leg + m], INFINITY);
}

/* Goes on from a = 0 at `arrest` to the node and through what is passed at an even speed. */
static void join(trochia_writer *w, const trochia_arrest *arrest, const trochia_leave *leave) {
    const trochia_stretch *stretches = w->course.stretches;
    int64_t node = (int64_t)stretches[arrest->stretch].birth;
    put_even(w, arrest->s, leave->s, arrest->v, arrest->stretch);
    follow(w, leave, node);
    come_to(w, node);
    w->v = leave->v_node;
    w->a = 0.0;
    if (node == w->course.count || !trochia_is_pinned(&stretches[node]))
        return;
    int64_t end = trochia_pinned_end(stretches, node);
    put_even(w, stretches[node].start, trochia_end_of(&stretches[end]), w->v, node);
    w->a = stretches[end].kick_out * w->v * w->v;
    come_to(w, end + 1);
}

/* Through the stretch motion has come to, or on to the next node. */
static void advance(trochia_writer *w) {
    const trochia_course *course = &w->course;
    trochia_track ahead = {course->stretches, course->count, 1};
    const trochia_stretch *here = &course->stretches[w->at];
    trochia_run run;
    trochia_arrest arrest;
    int joins, barrier;
    if (w->a == 0.0 && trochia_is_still(here, w->v))
        run = (trochia_run){.v = w->v, .rem = here->length};
    else
        trochia_climb(&ahead, w->at, w->v, w->a, &run);
    double time = trochia_search(&ahead, course, w->at, &run, &arrest, &joins, &barrier);
    trochia_leave leave = trochia_leave_at(course, arrest.stretch, arrest.v);
    trochia_run at = run;
    trochia_run_out(&ahead, w->at, &run, time);
    joins = joins && leave.s < INFINITY;
    if (!joins && arrest.stretch == w->at)
        joins = leave.s < trochia_exit(&ahead, w->at) || (run.a == 0.0 && trochia_is_barrier(&ahead, w->at));
    if (!joins) {
        for (int k = 0; k < run.count; k++)
            put_leg(w, &run.legs[k]);
        w->a = run.a;
        w->v = run.v;
        come_to(w, w->at + 1);
        return;
    }
    trochia_run_at(&ahead, w->at, &at, time, &at);
    for (int k = 0; k < run.climbs; k++)
        put_leg(w, &run.legs[k]);
    put_arrest(w, 1, w->at, at.rem, at.v, at.a);
    join(w, &arrest, &leave);
}

uint64_t trochia_scurve(trochia_stretch *stretches, uint64_t stretch_count, const uint64_t *rest_segments,
                        const double *rest_seconds, uint64_t rests, trochia_leg *legs, uint64_t leg_room,
                        trochia_knot *knots, uint64_t knot_room) {
    trochia_writer w = {
        .course = {.stretches = stretches, .count = (int64_t)stretch_count, .legs = legs, .room = leg_room},
        .rest_segments = rest_segments,
        .rest_seconds = rest_seconds,
        .rests = rests,
        .knots = knots,
        .room = knot_room};
    trochia_scurve_back(&w.course);
    if (w.course.made > leg_room)
        return 0;
    while (w.at < w.course.count && w.course.made <= leg_room) {
        if (w.v == 0.0)
            rest(&w);
        advance(&w);
    }
    rest(&w);
    trochia_knot end = {.t = w.t, .s = stretches[stretch_count].start, .segment = stretches[stretch_count - 1].segment};
    put(&w, end, 0.0);
    return w.made > w.room || w.course.made > leg_room ? 0 : w.made;
}
