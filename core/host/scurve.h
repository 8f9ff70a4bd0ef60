/* Speed along a path with limited jerk: look-ahead over the whole path in states of speed and acceleration.
 *
 * The path is cut into stretches (a line is one).  For every row i of limits |q'| v <= V, |q''| v^2 + |q'| |a| <= A,
 * |q'''| v^3 + 3 |q''| v |a| + |q'| |j| <= J; a stretch keeps, of all rows, the greatest quotients.
 * Legend: s path parameter, v = ds/dt, a and j its derivatives; q a limited quantity, ' by s. */
#ifndef TROCHIA_SCURVE_H
#define TROCHIA_SCURVE_H

#include "host/plan.h"

typedef struct {
    double length, start;            /* start: s summed over the stretches since a stop, or the beginning */
    double ceiling;                  /* greatest v that may be held all along it */
    double free;                     /* v from which on turning may leave nothing; infinite on lines */
    double along_a, bend_a;          /* greatest |q'| / A; what turning takes of a, at most |q''| / A */
    double along_j, bend_j, twist_j; /* the same of jerk: |q'| / J, 3 |q''| / J, |q'''| / J */
    double most_a, most_j;           /* 1 / along_a and 1 / along_j: on a line, and where nothing turns */
    /* what -x'' along x' is more than the line's at its start and its end: a is 0 inside, and that times v^2 (negative
     * before, positive after) on the lines beside it */
    double kick_in, kick_out;
    /* the pass back: where a leaves 0 for its start, and how fast; how long it speeds up in here */
    double peak_v, peak_s, climb;
    double node_v, birth_v, birth_s; /* where a pass back begins at its start: v there, and as above */
    uint64_t leg;                    /* first leg of the pass back */
    uint64_t birth, death; /* the pass back it lies in began at that stretch's start, and ended at this one's */
    uint16_t legs, climbs; /* of the pass back, and of these those before a begins to fall to 0 */
    uint32_t segment;
    uint8_t last; /* 1: at rest at its end */
    uint8_t over; /* 1: a velocity limit lies below the programmed feed */
    uint8_t reserved[2];
} trochia_stretch;

/* Constant jerk within one stretch, forward or back in time. */
typedef struct {
    double from, to; /* s, as of the stretch */
    double v, a, j, duration;
    double end_v, end_s; /* of the pass back: how fast, and where, an arrest from its end would end */
    uint64_t stretch;
} trochia_leg;

/* Where jerk changes: the motion from here to the next knot. */
typedef struct {
    double t, s; /* since the program's start, s summed over the segments */
    double v, a, j;
    uint32_t segment; /* in which it begins */
    uint32_t flags;   /* bit 0: a rest */
} trochia_knot;

/* Where a reader of phases has got to. */
typedef struct {
    uint64_t knot, segment;
    double tau; /* time since that knot */
} trochia_knot_cursor;

/* How many stretches the segments make. */
uint64_t trochia_scurve_count(const trochia_segment *segments, const double *pool, uint32_t axes, uint64_t count);

/* Fills the stretches' limits, and stops where curvature jumps; there is room for one stretch more. */
void trochia_scurve_load(const trochia_segment *segments, const double *pool, uint64_t count,
                         const trochia_limits *limits, trochia_stretch *stretches);

/* Plans all stretches (one more behind them is scratch) into knots; rests (in order) stand before their segment
 * (`count`: after all).  Returns the number of knots, the last of which only says when and where it ends; 0 where the
 * room for legs or knots is too small. */
uint64_t trochia_scurve(trochia_stretch *stretches, uint64_t stretch_count, const uint64_t *rest_segments,
                        const double *rest_seconds, uint64_t rests, trochia_leg *legs, uint64_t leg_room,
                        trochia_knot *knots, uint64_t knot_room);

/* s where each segment begins, and after the last where it ends: starts[segments + 1], summed as the knots' s is. */
void trochia_scurve_starts(const trochia_stretch *stretches, uint64_t stretch_count, double *starts);

/* Writes up to `room` phases from the cursor on and moves it; returns how many, 0 at the end.  starts[k] is s where
 * segment k begins (count + 1 of them). */
uint64_t trochia_scurve_phases(const double *starts, uint64_t count, const trochia_knot *knots, uint64_t knot_count,
                               trochia_knot_cursor *cursor, trochia_phase *out, uint64_t room);

/* The state at each time, clamped to the program's ends: t, s, v, a, j, segment and flags of a phase. */
void trochia_scurve_states(const double *starts, uint64_t count, const trochia_knot *knots, uint64_t knot_count,
                           const double *times, uint64_t time_count, trochia_phase *out);

/* Raises velocity, acceleration and jerk of each row of C to the greatest at nine instants of each phase. */
void trochia_scurve_peaks(const trochia_segment *segments, const double *pool, const trochia_limits *limits,
                          const trochia_phase *phases, uint64_t phase_count, double *velocity, double *acceleration,
                          double *jerk);

#endif
