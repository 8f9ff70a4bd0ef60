/* The last moment at which a pass can still bring a to 0 before it would be too fast, or beyond the pass back. */
#include "host/scurve_march.h"

/* Exact enough: part of a run's time, and of a margin.  What is coarser here makes a plan depend on where it began. */
static const double EXACT = 1e-14, NEAR = 1e-12;
/* What a probe is to leave of a margin: a moment between the two is exact enough. */
static const double AIM = 0.5 * 1e-12;
/* Motion that may only just be arrested is: there is no way over what rounding leaves of a margin. */
static const double STILL = 1e-9;
/* Places of a leg that has been cut, where arrests are tried. */
static const double PLACES[] = {0.5, 0.8, 0.95, 0.99};
enum { PROBED = 4, MOST = 60 };

trochia_arrest trochia_probe(const trochia_track *track, const trochia_course *course, int64_t i,
                             const trochia_run *run, double time, int *joins) {
    trochia_run at;
    trochia_run_at(track, i, run, time, &at);
    trochia_arrest arrest = trochia_arrest_from(track, i, at.rem, at.v, at.a, NULL, 0, NULL);
    *joins = 0;
    if (arrest.margin >= 0.0 && course) {
        double room = trochia_room_at(course, &arrest) / track->stretches[i].length;
        *joins = room < 0.0;
        arrest.margin = *joins ? trochia_larger(room, -1.0) : trochia_smaller(arrest.margin, room);
    }
    return arrest;
}

/* Between a moment that leaves an arrest and one that does not. */
typedef struct {
    double low, high;
    trochia_arrest arrest; /* from low */
    int known;             /* arrest is that */
    double over;           /* margin at high */
    int joins, barrier;    /* what forbids high */
} trochia_bracket;

/* Looks at the ends of a run's legs: 1 where no arrest is possible from one, the first of these then is high.  Where
 * budgets depend on speed, a run may be beyond an arrest for a while and back again. */
static int fails(const trochia_track *track, int64_t i, const trochia_run *run, trochia_bracket *b) {
    int unused;
    double time = 0.0;
    if (!run->count || run->legs[0].a > 0.0) {
        b->arrest = trochia_probe(track, NULL, i, run, 0.0, &unused);
        b->known = 1;
        if (run->count && b->arrest.margin <= STILL) {
            b->high = 0.0;
            return 0;
        }
    }
    for (int k = 0; k < run->count; k++) {
        time += run->legs[k].duration;
        trochia_arrest found = trochia_probe(track, NULL, i, run, time, &unused);
        if (found.margin < 0.0) {
            b->high = time;
            b->over = found.margin;
            b->barrier = found.barrier;
            return 1;
        }
        b->low = time;
        b->arrest = found;
        b->known = 1;
    }
    return 0;
}

static void narrow(const trochia_track *track, const trochia_course *course, int64_t i, const trochia_run *run,
                   trochia_bracket *b) {
    int unused, stayed = 0;
    if (!b->known)
        b->arrest = trochia_probe(track, course, i, run, b->low, &unused);
    double over = b->over;
    double under = trochia_smaller(trochia_larger(b->arrest.margin, 0.0), 1.0);
    if (b->low == 0.0 && under <= STILL && run->count && run->legs[0].a > 0.0)
        return;
    double nearest = INFINITY, before = INFINITY; /* margins: the least so far, and that three probes ago */
    for (int k = 0; k < MOST && b->high - b->low > EXACT * run->time; k++) {
        double time = b->low + (under - AIM) * (b->high - b->low) / (under - over);
        if ((k % 3 == 2 && nearest > 0.25 * before) || !(time > b->low) || !(time < b->high))
            time = 0.5 * (b->low + b->high);
        if (!(time > b->low) || !(time < b->high))
            break;
        int joining;
        trochia_arrest found = trochia_probe(track, course, i, run, time, &joining);
        before = k % 3 == 2 ? nearest : before;
        nearest = trochia_smaller(nearest, fabs(found.margin));
        if (found.margin >= 0.0) {
            double left = trochia_smaller(found.margin, 1.0);
            over *= stayed == 1 ? trochia_lowered(left, under) : 1.0;
            stayed = 1;
            b->low = time;
            b->arrest = found;
            under = left;
            if (under <= NEAR)
                break;
        } else {
            under *= stayed == -1 ? trochia_lowered(found.margin, over) : 1.0;
            stayed = -1;
            b->high = time;
            over = found.margin;
            b->joins = joining;
            b->barrier = found.barrier;
        }
    }
}

/* Where the leg that a moment cuts begins. */
static double begin_of(const trochia_run *run, double time) {
    double begin = 0.0;
    for (int k = 0; k < run->count && begin + run->legs[k].duration < time; k++)
        begin += run->legs[k].duration;
    return begin;
}

/* Looks before what a bracket has found, in the leg that it cuts, for a moment from which no arrest is possible: then
 * that is the new bracket's end. */
static int has_gap(const trochia_track *track, int64_t i, const trochia_run *run, trochia_bracket *b) {
    double begin = begin_of(run, b->low);
    int unused;
    for (int part = 0; part < PROBED; part++) {
        double at = begin + PLACES[part] * (b->low - begin);
        double margin = trochia_probe(track, NULL, i, run, at, &unused).margin;
        if (margin < 0.0) {
            *b = (trochia_bracket){.low = begin_of(run, at), .high = at, .over = margin};
            return 1;
        }
    }
    return 0;
}

double trochia_search(const trochia_track *track, const trochia_course *course, int64_t i, const trochia_run *run,
                      trochia_arrest *arrest, int *joins, int *barrier) {
    trochia_bracket b = {.high = run->time};
    int bends = !course && track->stretches[i].free < INFINITY;
    *joins = *barrier = 0;
    if (bends) {
        if (!fails(track, i, run, &b)) {
            *arrest = b.arrest;
            *barrier = b.high == 0.0 && b.arrest.margin < 0.0 && b.arrest.barrier;
            return b.high;
        }
    } else {
        *arrest = trochia_probe(track, course, i, run, b.high, joins);
        *barrier = b.high == 0.0 && arrest->margin < 0.0 && arrest->barrier;
        if (arrest->margin >= 0.0 || b.high == 0.0)
            return b.high;
        b.over = arrest->margin;
        b.joins = *joins;
        b.barrier = arrest->barrier;
    }
    narrow(track, course, i, run, &b);
    for (int k = 0; k < 3 && bends && b.low > 0.0 && has_gap(track, i, run, &b); k++)
        narrow(track, course, i, run, &b);
    *arrest = b.arrest;
    *joins = b.joins;
    *barrier = b.barrier;
    return b.low;
}
