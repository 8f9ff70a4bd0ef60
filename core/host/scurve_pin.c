/* Stretches that are passed at an even speed: whether they can be, and how fast. */
#include "host/scurve_march.h"

static const double SUMMED = 1.0 + 1e-12;
static const double EXACT = 1e-14;

/* Greatest speed of stretch p, passed at an even one, whose kick the line beside it can take up, or half of the line
 * where there is a kick at its other end too. */
static double kick_speed(const trochia_course *course, int64_t p, int64_t by) {
    trochia_track track = trochia_track_of(course, by);
    const trochia_stretch *stretches = course->stretches;
    double kick = by > 0 ? stretches[p].kick_out : stretches[p].kick_in;
    if (kick == 0.0)
        return stretches[p].ceiling;
    double other = by > 0 ? stretches[p + 2].kick_in : p > 1 ? stretches[p - 2].kick_out : 0.0;
    double room = other > 0.0 ? 0.5 * stretches[p + by].length * SUMMED : stretches[p + by].length;
    double low = 0.0, high = stretches[p].ceiling, from = trochia_exit(&track, p);
    for (int k = 0; k < 60 && high - low > EXACT * high; k++) {
        double v = k ? 0.5 * (low + high) : high;
        trochia_arrest found = trochia_kick_arrest(&track, p + by, kick, v);
        if (found.margin >= 0.0 && found.stretch == p + by && fabs(found.s - from) <= room)
            low = v;
        else
            high = v;
    }
    return low;
}

/* Whether stretches p to q can be passed at one even speed: there is motion on either side, and it may change. */
static int may_pin(const trochia_course *course, int64_t p, int64_t q) {
    const trochia_stretch *stretches = course->stretches;
    return p > 0 && q + 1 < course->count && !stretches[p - 1].last && !stretches[q].last &&
           !trochia_is_pinned(&stretches[p - 1]) && !trochia_is_pinned(&stretches[q + 1]);
}

/* What cannot be passed at an even speed gets stops instead; the others get a ceiling of which their sides allow. */
void trochia_pin(trochia_course *course) {
    trochia_stretch *stretches = course->stretches;
    stretches[course->count].kick_in = stretches[course->count].kick_out = 0.0;
    for (int64_t p = 0; p < course->count; p++) {
        if (!trochia_is_pinned(&stretches[p]))
            continue;
        int64_t q = trochia_pinned_end(stretches, p);
        int may = may_pin(course, p, q);
        for (int64_t k = p; k <= q && !may; k++) {
            if (stretches[k].kick_in > 0.0)
                stretches[k - 1].last = 1;
            if (stretches[k].kick_out > 0.0)
                stretches[k].last = 1;
            stretches[k].kick_in = stretches[k].kick_out = 0.0;
        }
        p = q;
    }
    for (int64_t p = 0; p < course->count; p++) {
        if (!trochia_is_pinned(&stretches[p]))
            continue;
        int64_t q = trochia_pinned_end(stretches, p);
        double least = trochia_smaller(kick_speed(course, p, -1), kick_speed(course, q, 1));
        stretches[p].ceiling = stretches[q].ceiling = least;
        p = q;
    }
}

/* Greatest speed at which what is passed at an even one, up to the end of stretch q, joins the pass back behind it. */
double trochia_node_speed(const trochia_course *course, int64_t q) {
    trochia_track ahead = trochia_track_of(course, 1);
    const trochia_stretch *pinned = &course->stretches[q];
    double low = 0.0, high = pinned->ceiling;
    for (int k = 0; k < 60 && high - low > EXACT * high; k++) {
        double v = k ? 0.5 * (low + high) : high;
        trochia_arrest found = trochia_kick_arrest(&ahead, q + 1, pinned->kick_out, v);
        if (found.margin >= 0.0 && trochia_leave_at(course, found.stretch, found.v).s >= found.s)
            low = v;
        else
            high = v;
    }
    return low;
}
