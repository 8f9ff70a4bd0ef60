/* A torque plan's pieces read as phases, and as states at given times: each piece's ramps are made again when asked
 * for. */
#include <math.h>

#include "host/plan_torque_span.h"

static uint32_t phases_of(trochia_torque_span *span, const trochia_torque_piece *pieces, uint64_t j,
                          trochia_phase *out) {
    const trochia_torque_piece *piece = &pieces[j];
    trochia_torque_load(piece, span);
    uint32_t made = trochia_torque_through(span, j ? pieces[j - 1].exit : 0.0, piece->exit, out);
    for (uint32_t k = 0; k < made; k++) {
        out[k].t += piece->time;
        out[k].s += span->length * piece->part;
        out[k].segment = piece->segment;
        out[k].flags = 0;
    }
    return made;
}

/* The rest before piece j, or after the last: when the piece before has ended. */
static trochia_phase rest_of(trochia_torque_span *span, const trochia_torque_piece *pieces, uint64_t j, double seconds,
                             double begin) {
    trochia_phase rest = {.t = begin, .duration = seconds, .flags = 1};
    if (j) {
        rest.segment = pieces[j - 1].segment;
        rest.s = span->task->segments[rest.segment].length;
    }
    return rest;
}

uint64_t trochia_torque_phases(const trochia_torque_task *task, const trochia_torque_piece *pieces,
                               uint64_t piece_count, trochia_phase_cursor *cursor, trochia_phase *out, uint64_t room) {
    trochia_torque_span span;
    uint64_t made = 0;
    trochia_torque_begin(task, &span);
    while (made + TROCHIA_TORQUE_ROOM + 1 <= room) {
        uint64_t j = cursor->piece;
        int more = j < piece_count;
        double seconds = 0.0, begin = 0.0;
        for (; cursor->rest < task->rests && (!more || task->rest_segments[cursor->rest] <= pieces[j].segment);
             cursor->rest++)
            seconds += task->rest_seconds[cursor->rest];
        if (seconds > 0.0) {
            if (more)
                begin = pieces[j].time - seconds;
            else if (j) {
                trochia_phase last[TROCHIA_TORQUE_ROOM];
                uint32_t n = phases_of(&span, pieces, j - 1, last);
                begin = last[n - 1].t + last[n - 1].duration;
            }
            out[made++] = rest_of(&span, pieces, j, seconds, begin);
        }
        if (!more)
            break;
        made += phases_of(&span, pieces, j, out + made);
        cursor->piece++;
    }
    return made;
}

/* The last piece that begins at or before t. */
static uint64_t piece_at(const trochia_torque_piece *pieces, uint64_t piece_count, double t) {
    uint64_t low = 0, high = piece_count;
    while (high - low > 1) {
        uint64_t middle = low + (high - low) / 2;
        if (pieces[middle].time <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static trochia_phase state_in(const trochia_phase *phases, uint32_t made, double length, double t) {
    uint32_t k = 0;
    while (k + 1 < made && t >= phases[k + 1].t)
        k++;
    trochia_phase state = phases[k];
    double tau = t - state.t;
    if (tau > state.duration) { /* after its end: in the rest that follows, or by rounding */
        uint32_t over = tau > state.duration * (1.0 + 1e-9) + 1e-12;
        tau = state.duration;
        state.flags = over;
    }
    state.s = fmin(state.s + tau * (state.v + tau * (0.5 * state.a + tau * state.j / 6.0)), length);
    state.v = state.flags ? 0.0 : fmax(0.0, state.v + tau * (state.a + 0.5 * tau * state.j));
    state.a = state.flags ? 0.0 : state.a + tau * state.j;
    if (state.flags)
        state.j = 0.0;
    state.t = t;
    return state;
}

void trochia_torque_states(const trochia_torque_task *task, const trochia_torque_piece *pieces, uint64_t piece_count,
                           const double *times, uint64_t count, trochia_phase *out) {
    trochia_torque_span span;
    trochia_phase phases[TROCHIA_TORQUE_ROOM];
    uint64_t known = piece_count;
    uint32_t made = 0;
    trochia_torque_begin(task, &span);
    for (uint64_t k = 0; k < count; k++) {
        if (times[k] < pieces[0].time) {
            trochia_phase before = {.t = times[k], .flags = 1};
            out[k] = before;
            continue;
        }
        uint64_t j = piece_at(pieces, piece_count, times[k]);
        if (j != known)
            made = phases_of(&span, pieces, j, phases);
        known = j;
        out[k] = state_in(phases, made, task->segments[pieces[j].segment].length, times[k]);
    }
}
