/* The last moment at which a pass can still bring a to 0 before it would be too fast, or beyond the pass back. */
#include "host/scurve_march.h"

/* Exact enough: part of a run's time, and of a margin.  What is coarser here makes a plan depend on where it began. */
static const double EXACT = 1e-13, NEAR = 1e-10;
/* Motion that may only just be arrested is: there is no way over what rounding leaves of a margin. */
static const double STILL = 1e-9;
/* Places of a leg that has been cut, where arrests are tried. */
static const double PLACES[] = {0.5, 0.8, 0.95, 0.99};
enum { PARTS = 1, PROBED = 4, MOST = 60 };

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

/* The first of some moments of a run from which no arrest is possible, and the last before it; its end where there is
 * none.  Where budgets depend on speed, a run may be beyond an arrest for a while and back again. */
static double first_failure(const trochia_track *track, int64_t i, const trochia_run *run, double *low) {
    const trochia_stretch *stretch = &track->stretches[i];
    double time = 0.0;
    int unused;
    *low = 0.0;
    if (stretch->bend_a == 0.0 && stretch->twist_j == 0.0)
        return run->time;
    if (run->count && run->legs[0].a > 0.0 && trochia_probe(track, NULL, i, run, 0.0, &unused).margin <= STILL)
        return 0.0;
    for (int k = 0; k < run->count; time += run->legs[k++].duration)
        for (int part = 1; part <= PARTS; part++) {
            double at = time + run->legs[k].duration * part / PARTS;
            if (trochia_probe(track, NULL, i, run, at, &unused).margin < 0.0)
                return at;
            *low = at;
        }
    return run->time;
}

/* Nears the last moment between one that leaves an arrest and one that does not. */
typedef struct {
    double low, high;
    trochia_arrest arrest; /* from low */
    int joins, barrier;    /* what forbids high */
} trochia_bracket;

static void narrow(const trochia_track *track, const trochia_course *course, int64_t i, const trochia_run *run,
                   double over, trochia_bracket *b) {
    int unused, stayed = 0;
    b->arrest = trochia_probe(track, course, i, run, b->low, &unused);
    double under = trochia_smaller(trochia_larger(b->arrest.margin, 0.0), 1.0);
    if (b->low == 0.0 && under <= STILL && run->count && run->legs[0].a > 0.0)
        return;
    for (int k = 0; k < MOST && b->high - b->low > EXACT * run->time; k++) {
        double time = b->low + under * (b->high - b->low) / (under - over);
        if (k % 6 == 5 || !(time > b->low) || !(time < b->high))
            time = 0.5 * (b->low + b->high);
        if (!(time > b->low) || !(time < b->high))
            break;
        int joining;
        trochia_arrest found = trochia_probe(track, course, i, run, time, &joining);
        if (found.margin >= 0.0) { /* Anderson and Bjorck's form of the false position */
            double part = 1.0 - trochia_smaller(found.margin, 1.0) / under;
            over *= stayed == 1 ? (part > 0.0 ? part : 0.5) : 1.0;
            stayed = 1;
            b->low = time;
            b->arrest = found;
            under = trochia_smaller(found.margin, 1.0);
            if (under <= NEAR)
                break;
        } else {
            double part = 1.0 - found.margin / over;
            under *= stayed == -1 ? (part > 0.0 ? part : 0.5) : 1.0;
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

/* A moment of the leg that a bracket has cut, before that, from which no arrest is possible; negative: there is none.
 */
static double gap_before(const trochia_track *track, int64_t i, const trochia_run *run, const trochia_bracket *b,
                         double *over) {
    double begin = begin_of(run, b->low);
    int unused;
    for (int part = 0; part < PROBED; part++) {
        double at = begin + PLACES[part] * (b->low - begin);
        *over = trochia_probe(track, NULL, i, run, at, &unused).margin;
        if (*over < 0.0)
            return at;
    }
    return -1.0;
}

double trochia_search(const trochia_track *track, const trochia_course *course, int64_t i, const trochia_run *run,
                      trochia_arrest *arrest, int *joins, int *barrier) {
    double low = 0.0, high = course ? run->time : first_failure(track, i, run, &low);
    *arrest = trochia_probe(track, course, i, run, high, joins);
    *barrier = high == 0.0 && arrest->margin < 0.0 && arrest->barrier;
    if (arrest->margin >= 0.0 || high == 0.0)
        return high;
    trochia_bracket b = {.low = low, .high = high, .joins = *joins, .barrier = arrest->barrier};
    narrow(track, course, i, run, arrest->margin, &b);
    for (int k = 0; k < 3 && !course && track->stretches[i].free < INFINITY && b.low > 0.0; k++) {
        double over, at = gap_before(track, i, run, &b, &over);
        if (at < 0.0)
            break;
        b = (trochia_bracket){.low = begin_of(run, at), .high = at};
        narrow(track, course, i, run, over, &b);
    }
    *arrest = b.arrest;
    *joins = b.joins;
    *barrier = b.barrier;
    return b.low;
}
