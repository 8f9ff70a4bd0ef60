/* One piece of a path where acceleration falls with speed.  Internal to plan_torque*.c, not part of the schema. */
#ifndef TROCHIA_PLAN_TORQUE_SPAN_H
#define TROCHIA_PLAN_TORQUE_SPAN_H

#include "host/plan_span.h"
#include "host/plan_torque.h"

enum { TROCHIA_TORQUE_BINS = 200, TROCHIA_TORQUE_ROOM = 2 * TROCHIA_TORQUE_BINS + 1 };

/* Reads pieces one after another; made once a pass. */
typedef struct {
    const trochia_torque_task *task;
    trochia_limits loose; /* the velocity limits with accelerations that bind nowhere */
    trochia_bounds bounds;
    trochia_span shape;
    double length, ceiling; /* of the piece last loaded; its greatest v */
    uint32_t rows;
    double along[19], bend[19]; /* greatest |q'|, |q''| of each row; then of the vector, where it is capped */
    int slowed;                 /* a velocity limit lies below the programmed feed */
} trochia_torque_span;

void trochia_torque_begin(const trochia_torque_task *task, trochia_torque_span *span);
void trochia_torque_load(const trochia_torque_piece *piece, trochia_torque_span *span);

/* Rising speed from `v` on: constant jerk in each phase (t, s from 0), until speed `most` or `way` is reached,
 * whichever comes first; out may be NULL.  Returns the number of phases; v and s where it ends in *end. */
uint32_t trochia_torque_climb(const trochia_torque_span *span, double v, double most, double way, trochia_phase *out,
                              trochia_phase *end);

/* The fastest way through the piece from speed v0 to v1, both of which can be kept: phases with t, s from its start. */
uint32_t trochia_torque_through(const trochia_torque_span *span, double v0, double v1, trochia_phase *out);

#endif
