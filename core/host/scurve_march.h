/* Motion along stretches, forward or back in time, within what each of them leaves.  Internal to scurve*.c.
 *
 * Both passes speed up (seen in their own direction) as hard as they can and may at any moment bring a to 0: an arrest.
 * Legend: rem way left in a stretch, a >= 0 always. */
#ifndef TROCHIA_SCURVE_MARCH_H
#define TROCHIA_SCURVE_MARCH_H

#include <math.h>
#include <stddef.h>

#include "host/scurve.h"

/* How far sums of lengths may be apart by rounding [mm]: a knot this near a joint stands on it, or a sliver of a phase
 * would have the jerk of one segment on the next. */
#define TROCHIA_SAME_PLACE(s) (2e-15 * (s) + 1e-14)

enum { TROCHIA_RUN_LEGS = 64 };

/* Stretches seen in the direction of a pass: +1 forward, -1 back in time. */
typedef struct {
    const trochia_stretch *stretches;
    int64_t count;
    int64_t by;
} trochia_track;

/* Where an arrest ends.  margin < 0: it would exceed what is there, by that part; or it meets a place it may not pass
 * with a > 0 (barrier). */
typedef struct {
    double margin, v, s;
    int64_t stretch;
    int barrier;
} trochia_arrest;

/* Motion through one stretch. */
typedef struct {
    double v, a, rem, time; /* where the legs have got to, and how long they take */
    int count, climbs;      /* legs in all, and those before a begins to fall to 0 */
    trochia_leg legs[TROCHIA_RUN_LEGS];
} trochia_run;

static inline double trochia_larger(double a, double b) {
    return a > b ? a : b;
}

static inline double trochia_smaller(double a, double b) {
    return a < b ? a : b;
}

static inline double trochia_speed_after(double v, double a, double j, double t) {
    return v + t * (a + 0.5 * t * j);
}

static inline double trochia_way_after(double v, double a, double j, double t) {
    return t * (v + t * (0.5 * a + t * j * (1.0 / 6.0)));
}

/* Of the value at the end of a bracket that stays, in Anderson and Bjorck's form of the false position, where that at
 * the other has become `now` and `was` before. */
static inline double trochia_lowered(double now, double was) {
    double part = was < INFINITY ? 1.0 - now / was : 0.5;
    return part > 0.0 ? part : 0.5;
}

/* Nearer to the ceiling than this part, an even speed is kept: so near that where motion came from is forgotten. */
static inline int trochia_is_still(const trochia_stretch *stretch, double v) {
    return v >= stretch->ceiling * (1.0 - 1e-11);
}

/* A stretch that is passed at an even speed. */
static inline int trochia_is_pinned(const trochia_stretch *stretch) {
    return stretch->kick_in > 0.0 || stretch->kick_out > 0.0;
}

/* The last of the stretches that are passed at one even speed from stretch p on: p or the next. */
static inline int64_t trochia_pinned_end(const trochia_stretch *stretches, int64_t p) {
    return stretches[p].kick_in > 0.0 && stretches[p].kick_out == 0.0 && stretches[p + 1].kick_in == 0.0 &&
                   stretches[p + 1].kick_out > 0.0 && !stretches[p].last
               ? p + 1
               : p;
}

/* Whether motion that leaves stretch i in the track's direction must do so at rest, or comes to one passed at an even
 * speed, or to the path's end. */
static inline int trochia_is_barrier(const trochia_track *track, int64_t i) {
    int64_t next = i + track->by;
    if (next < 0 || next >= track->count)
        return 1;
    return track->stretches[track->by > 0 ? i : next].last || trochia_is_pinned(&track->stretches[next]);
}

/* s where a stretch ends: where the next one begins, but for a stop, behind which s begins anew. */
static inline double trochia_end_of(const trochia_stretch *stretch) {
    return stretch->start + stretch->length;
}

/* s where the track leaves stretch i. */
static inline double trochia_exit(const trochia_track *track, int64_t i) {
    return track->by > 0 ? trochia_end_of(&track->stretches[i]) : track->stretches[i].start;
}

static inline double trochia_acceleration_left(const trochia_stretch *stretch, double v) {
    return (1.0 - stretch->bend_a * v * v) * stretch->most_a;
}

static inline double trochia_jerk_left(const trochia_stretch *stretch, double v, double a) {
    return (1.0 - stretch->twist_j * v * v * v - stretch->bend_j * v * a) * stretch->most_j;
}

/* Time to go `rem` under constant jerk with a >= 0 all the time, when by `most` that is reached. */
double trochia_time_over(double v, double a, double j, double rem, double most);

/* Brings a to 0 from a state in stretch i with `rem` left of it; legs (or none) are written as it goes, up to `room`;
 * `made` counts them. */
trochia_arrest trochia_arrest_from(const trochia_track *track, int64_t i, double rem, double v, double a,
                                   trochia_leg *legs, uint64_t room, uint64_t *made);

/* Speeds up through stretch i as hard as it allows by itself. */
void trochia_climb(const trochia_track *track, int64_t i, double v, double a, trochia_run *run);

/* The state at a time of a run: its v, a and rem. */
void trochia_run_at(const trochia_track *track, int64_t i, const trochia_run *run, double time, trochia_run *out);

/* Cuts a run at a time, and goes on to the stretch's end by bringing a to 0. */
void trochia_run_out(const trochia_track *track, int64_t i, trochia_run *run, double time);

/* The part of a pass back by which it is joined from a = 0 at speed v. */
typedef struct {
    double s;        /* where that is; infinite: a pass back need not be joined at v */
    double v_node;   /* speed at the node it leads to */
    double tau;      /* time on the legs of `stretch` at which a begins to fall to 0 (seen back in time) */
    int64_t stretch; /* the node itself: where it is */
} trochia_leave;

/* The passes' data. */
typedef struct {
    trochia_stretch *stretches;
    int64_t count;
    trochia_leg *legs; /* of the pass back */
    uint64_t made, room;
} trochia_course;

/* How the pass back over stretch i may be joined at speed v. */
trochia_leave trochia_leave_at(const trochia_course *course, int64_t i, double v);

/* How far before the place where the pass back is joined an arrest ends: exactly where both lie in one stretch, else
 * its sign, and nearly. */
double trochia_room_at(const trochia_course *course, const trochia_arrest *arrest);

/* The arrest from a time of a run.  Where a pass back is given: `joins` is set where it would end beyond it. */
trochia_arrest trochia_probe(const trochia_track *track, const trochia_course *course, int64_t i,
                             const trochia_run *run, double time, int *joins);

/* Greatest time of a run up to its end from which an arrest is possible; `joins`, `barrier`: what forbids more. */
double trochia_search(const trochia_track *track, const trochia_course *course, int64_t i, const trochia_run *run,
                      trochia_arrest *arrest, int *joins, int *barrier);

/* The course seen in a direction. */
static inline trochia_track trochia_track_of(const trochia_course *course, int64_t by) {
    return (trochia_track){course->stretches, course->count, by};
}

/* From a stretch passed at an even speed v, whose kick the next one takes up. */
static inline trochia_arrest trochia_kick_arrest(const trochia_track *track, int64_t i, double kick, double v) {
    return trochia_arrest_from(track, i, track->stretches[i].length, v, kick * v * v, NULL, 0, NULL);
}

/* What cannot be passed at an even speed gets stops instead; the others get a ceiling of which their sides allow. */
void trochia_pin(trochia_course *course);

/* Greatest speed at which what is passed at an even one, up to the end of stretch q, joins the pass back behind it. */
double trochia_node_speed(const trochia_course *course, int64_t q);

/* The pass back over all stretches. */
void trochia_scurve_back(trochia_course *course);

static const uint64_t TROCHIA_NO_BIRTH = UINT64_MAX;

#endif
