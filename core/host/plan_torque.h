/* Speed along a path where acceleration falls with speed, as a motor's torque does.
 *
 * Row i of limits has |q'' v^2 + q' a| <= A_i(|q'| v), A_i straight between knots and never rising.  The path is worked
 * in the pieces of host/plan.h; in a piece dv/dt = a(v), the greatest that all rows leave, and a piece's phases have
 * constant jerk.  Legend: s path parameter, v = ds/dt, a its derivative; q a limited quantity, ' by s. */
#ifndef TROCHIA_PLAN_TORQUE_H
#define TROCHIA_PLAN_TORQUE_H

#include <stdint.h>

#include "host/plan.h"

/* How the acceleration of a row falls with its speed; 0 knots: it does not, and the limits' own holds. */
typedef struct {
    uint32_t count, reserved;
    double speed[32], acceleration[32];
} trochia_fall;

typedef struct {
    double time; /* when its motion begins */
    double exit; /* ds/dt at its end; at its start that of the piece before, 0 at the program's start */
    uint32_t segment;
    uint32_t part, parts; /* which of its segment's equal parts */
    uint32_t flags;       /* bit 0: a velocity limit lies below the programmed feed here */
} trochia_torque_piece;

/* What is planned, and with what; falls: one of each row. */
typedef struct {
    const trochia_segment *segments;
    const double *pool;
    const trochia_limits *limits;
    const trochia_fall *falls;
    const uint64_t *rest_segments; /* rests (in order) stand before their segment (`segment_count`: after all) */
    const double *rest_seconds;
    uint64_t segment_count, rests;
} trochia_torque_task;

/* Plans all pieces (trochia_plan_count of them); returns the total time. */
double trochia_torque_plan(const trochia_torque_task *task, trochia_torque_piece *pieces, uint64_t piece_count);

/* Writes up to `room` phases (at least 512) from the cursor on and moves it; returns how many, 0 at the end. */
uint64_t trochia_torque_phases(const trochia_torque_task *task, const trochia_torque_piece *pieces,
                               uint64_t piece_count, trochia_phase_cursor *cursor, trochia_phase *out, uint64_t room);

/* The state at each time, clamped to the program's ends: t, s, v, a, j, segment and flags of a phase. */
void trochia_torque_states(const trochia_torque_task *task, const trochia_torque_piece *pieces, uint64_t piece_count,
                           const double *times, uint64_t count, trochia_phase *out);

#endif
