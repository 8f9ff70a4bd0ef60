/* The last moment at which a pass can still bring a to 0 before it would be too fast, or beyond the pass back. */
#include "host/scurve_march.h"

/* Exact enough, on lines and where the path bends: part of a run's time, and of a margin. */
static const double EXACT[2] = {1e-13, 1e-8};
static const double NEAR[2] = {1e-11, 1e-7};
enum { PARTS = 4 };

trochia_arrest trochia_probe(const trochia_track *track, const trochia_course *course, int64_t i,
                             const trochia_run *run, double time, int *joins) {
    trochia_run at;
    trochia_run_at(track, i, run, time, &at);
    trochia_arrest arrest = trochia_arrest_from(track, i, at.rem, at.v, at.a, NULL, 0, NULL);
    *joins = 0;
    if (arrest.margin >= 0.0 && course) {
        trochia_leave leave = trochia_leave_at(course, arrest.stretch, arrest.v);
        if (leave.s < arrest.s) {
            *joins = 1;
            arrest.margin = leave.s > -INFINITY ? (leave.s - arrest.s) / track->stretches[i].length : -1.0;
            arrest.margin = trochia_larger(arrest.margin, -1.0);
        } else
            arrest.margin = trochia_smaller(arrest.margin, (leave.s - arrest.s) / track->stretches[i].length);
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
    for (int k = 0; k < run->count; time += run->legs[k++].duration)
        for (int part = 1; part <= PARTS; part++) {
            double at = time + run->legs[k].duration * part / PARTS;
            if (trochia_probe(track, NULL, i, run, at, &unused).margin < 0.0)
                return at;
            *low = at;
        }
    return run->time;
}

double trochia_search(const trochia_track *track, const trochia_course *course, int64_t i, const trochia_run *run,
                      trochia_arrest *arrest, int *joins, int *barrier) {
    double low = 0.0, high = course ? run->time : first_failure(track, i, run, &low);
    *arrest = trochia_probe(track, course, i, run, high, joins);
    *barrier = 0;
    if (arrest->margin >= 0.0)
        return high;
    *barrier = arrest->barrier;
    int unused, stayed = 0, bends = track->stretches[i].free < INFINITY;
    double over = arrest->margin;
    *arrest = trochia_probe(track, course, i, run, low, &unused);
    double under = trochia_smaller(trochia_larger(arrest->margin, 0.0), 1.0);
    for (int k = 0; k < 80 && high - low > EXACT[bends] * run->time; k++) {
        double time = k % 5 < 4 ? low + under * (high - low) / (under - over) : 0.5 * (low + high);
        if (!(time > low) || !(time < high))
            time = 0.5 * (low + high);
        if (!(time > low) || !(time < high))
            break;
        int joining;
        trochia_arrest found = trochia_probe(track, course, i, run, time, &joining);
        if (found.margin >= 0.0) {
            over *= stayed == 1 ? 0.5 : 1.0;
            stayed = 1;
            low = time;
            *arrest = found;
            under = trochia_smaller(found.margin, 1.0);
            if (under <= NEAR[bends])
                break;
        } else {
            under *= stayed == -1 ? 0.5 : 1.0;
            stayed = -1;
            high = time;
            over = found.margin;
            *joins = joining;
            *barrier = found.barrier;
        }
    }
    return low;
}
