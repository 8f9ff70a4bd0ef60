/* The two passes of host/plan.c where acceleration falls with speed.  A pair of speeds that can be kept stays so when
 * both are lowered (there is more acceleration left, and less of it taken by the bend), so one pass back and one
 * forward find speeds that keep all limits. */
#include <math.h>
#include <stddef.h>

#include "host/plan_torque_span.h"

static void lay_out(const trochia_torque_task *task, trochia_torque_piece *pieces) {
    for (uint64_t k = 0; k < task->segment_count; k++) {
        uint32_t parts = trochia_span_parts(&task->segments[k], task->pool, task->limits->axes);
        for (uint32_t part = 0; part < parts; part++, pieces++) {
            pieces->segment = (uint32_t)k;
            pieces->part = part;
            pieces->parts = parts;
        }
    }
}

/* Leaves in `exit` the greatest v at each piece's end from which the rest of the path can be kept. */
static void backward(const trochia_torque_task *task, trochia_torque_piece *pieces, uint64_t piece_count) {
    trochia_torque_span span;
    trochia_phase end;
    double next = 0.0;
    trochia_torque_begin(task, &span);
    for (uint64_t j = piece_count; j-- > 0;) {
        trochia_torque_piece *piece = &pieces[j];
        trochia_torque_load(piece, &span);
        double exit = fmin(next, span.ceiling);
        if (task->segments[piece->segment].stop && piece->part + 1 == piece->parts)
            exit = 0.0;
        trochia_torque_climb(&span, exit, span.ceiling, span.length, NULL, &end);
        next = end.v;
        piece->exit = exit;
        piece->flags = (uint32_t)span.slowed;
    }
}

double trochia_torque_plan(const trochia_torque_task *task, trochia_torque_piece *pieces, uint64_t piece_count) {
    trochia_torque_span span;
    trochia_phase phases[TROCHIA_TORQUE_ROOM], end;
    double time = 0.0, v = 0.0;
    uint64_t rest = 0;
    lay_out(task, pieces);
    backward(task, pieces, piece_count);
    trochia_torque_begin(task, &span);
    for (uint64_t j = 0; j < piece_count; j++) {
        trochia_torque_piece *piece = &pieces[j];
        for (; rest < task->rests && task->rest_segments[rest] <= piece->segment; rest++)
            time += task->rest_seconds[rest];
        piece->time = time;
        trochia_torque_load(piece, &span);
        if (piece->exit > v) {
            trochia_torque_climb(&span, v, span.ceiling, span.length, NULL, &end);
            piece->exit = fmin(piece->exit, end.v);
        }
        uint32_t made = trochia_torque_through(&span, v, piece->exit, phases);
        time += phases[made - 1].t + phases[made - 1].duration;
        v = piece->exit;
    }
    for (; rest < task->rests; rest++)
        time += task->rest_seconds[rest];
    return time;
}
