/* Speed along a path: trapezoid profiles with look-ahead over the whole of it.
 *
 * A segment is worked in pieces (a line is one).  In a piece w = v^2 is linear in s, or rises, stays and falls
 * linearly. Legend: s path parameter, v = ds/dt, w = v^2, a = dv/dt; for a limited quantity q = C x: velocity q' v,
 * acceleration q'' w + q' a (' by s). */
#ifndef TROCHIA_PLAN_H
#define TROCHIA_PLAN_H

#include <stdint.h>

#include "host/path.h"

/* Rows of C: the axes first (the unit matrix), then the joints that have limits of their own. */
typedef struct {
    uint32_t axes, rows;
    uint32_t linear; /* leading columns that are X, Y or Z: the path's caps measure these */
    uint32_t reserved;
    double matrix[162];  /* rows x axes */
    double velocity[18]; /* of each row */
    double acceleration[18];
    double jerk[18];                                    /* read where jerk is limited */
    double path_velocity, path_acceleration, path_jerk; /* infinity: no cap */
} trochia_limits;

typedef struct {
    double time; /* when its motion begins */
    double exit; /* ds/dt at its end; at its start that of the piece before, 0 at the program's start */
    double peak; /* ds/dt reached inside with +-acceleration; 0: one acceleration from entry to exit */
    double acceleration;
    uint32_t segment;
    uint32_t part, parts; /* which of its segment's equal parts */
    uint32_t flags;       /* bit 0: a velocity limit lies below the programmed feed here */
} trochia_piece;

/* How many pieces the segments make. */
uint64_t trochia_plan_count(const trochia_segment *segments, const double *pool, uint32_t axes, uint64_t count);

/* Plans all pieces; rests (in order) stand before their segment (`count`: after all).  Returns the total time. */
double trochia_plan(const trochia_segment *segments, const double *pool, uint64_t count, const trochia_limits *limits,
                    const uint64_t *rest_segments, const double *rest_seconds, uint64_t rests, trochia_piece *pieces,
                    uint64_t piece_count);

/* Where a reader of phases has got to. */
typedef struct {
    uint64_t piece, rest;
} trochia_phase_cursor;

/* Writes up to `room` phases (at least 4) from the cursor on and moves it; returns how many, 0 at the end. */
uint64_t trochia_plan_phases(const trochia_segment *segments, const trochia_piece *pieces, uint64_t piece_count,
                             const uint64_t *rest_segments, const double *rest_seconds, uint64_t rests,
                             trochia_phase_cursor *cursor, trochia_phase *out, uint64_t room);

/* The state at each time, clamped to the program's ends: t, s, v, a, j, segment and flags of a phase. */
void trochia_plan_states(const trochia_segment *segments, const trochia_piece *pieces, uint64_t piece_count,
                         const double *times, uint64_t count, trochia_phase *out);

/* Adds each piece's time to out[move of its segment]. */
void trochia_plan_move_times(const trochia_segment *segments, const trochia_piece *pieces, uint64_t piece_count,
                             double *out);

/* Greatest |velocity| and |acceleration| of each row of C at the ends of all phases, at two points between
 * on curves of one piece and at seven on others. */
void trochia_plan_peaks(const trochia_segment *segments, const double *pool, const trochia_limits *limits,
                        const trochia_piece *pieces, uint64_t piece_count, double *velocity, double *acceleration);

#endif
