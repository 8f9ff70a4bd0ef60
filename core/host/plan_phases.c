/* A plan's pieces read as phases, and as states at given times. */
#include <math.h>

#include "host/plan_span.h"

/* Writes the 1 to 3 phases of a piece; returns how many. */
static uint64_t phases_of(const trochia_segment *segments, const trochia_piece *pieces, uint64_t j,
                          trochia_phase *out) {
    const trochia_piece *piece = &pieces[j];
    double part = segments[piece->segment].length / piece->parts;
    double v0 = j ? pieces[j - 1].exit : 0.0, v1 = piece->exit, top = piece->peak, a = piece->acceleration;
    double s = part * piece->part;
    trochia_phase phase = {.t = piece->time, .s = s, .v = v0, .a = a, .segment = piece->segment};
    if (top == 0.0) {
        phase.duration = 2.0 * part / (v0 + v1);
        out[0] = phase;
        return 1;
    }
    double rise = (top - v0) * (top + v0) / (2.0 * a), fall = (top - v1) * (top + v1) / (2.0 * a);
    double stay = part - rise - fall;
    double widths[3] = {(top - v0) / a, stay > TROCHIA_STAY * part ? stay / top : 0.0, (top - v1) / a};
    double speeds[3] = {v0, top, top}, starts[3] = {s, s + rise, s + part - fall};
    uint64_t made = 0;
    for (int k = 0; k < 3; k++) {
        if (!(widths[k] > 0.0))
            continue;
        phase.duration = widths[k];
        phase.s = starts[k];
        phase.v = speeds[k];
        phase.a = k == 0 ? a : k == 1 ? 0.0 : -a;
        out[made++] = phase;
        phase.t += widths[k];
    }
    return made;
}

static trochia_phase rest_at(double t, double duration, uint32_t segment, double s) {
    trochia_phase phase = {.t = t, .duration = duration, .s = s, .segment = segment, .flags = 1};
    return phase;
}

uint64_t trochia_plan_phases(const trochia_segment *segments, const trochia_piece *pieces, uint64_t piece_count,
                             const uint64_t *rest_segments, const double *rest_seconds, uint64_t rests,
                             trochia_phase_cursor *cursor, trochia_phase *out, uint64_t room) {
    uint64_t made = 0;
    while (made + 4 <= room) {
        uint64_t j = cursor->piece;
        int more = j < piece_count;
        if (cursor->rest < rests && (!more || rest_segments[cursor->rest] <= pieces[j].segment)) {
            double t = 0.0, seconds = 0.0;
            for (; cursor->rest < rests && (!more || rest_segments[cursor->rest] <= pieces[j].segment); cursor->rest++)
                seconds += rest_seconds[cursor->rest];
            if (more)
                t = pieces[j].time - seconds;
            else if (j) {
                trochia_phase last[3];
                uint64_t n = phases_of(segments, pieces, j - 1, last);
                t = last[n - 1].t + last[n - 1].duration;
            }
            uint32_t before = j ? pieces[j - 1].segment : 0;
            out[made++] = rest_at(t, seconds, before, j ? segments[before].length : 0.0);
            continue;
        }
        if (!more)
            break;
        made += phases_of(segments, pieces, j, out + made);
        cursor->piece++;
    }
    return made;
}

/* The last piece that begins at or before t, searched from `near`. */
static uint64_t piece_at(const trochia_piece *pieces, uint64_t piece_count, double t, uint64_t near) {
    uint64_t low = 0, high = piece_count;
    if (near < piece_count && pieces[near].time <= t) {
        low = near;
        for (uint64_t step = 1; low + step < piece_count; step *= 2) {
            if (pieces[low + step].time > t) {
                high = low + step;
                break;
            }
            low += step;
        }
    }
    while (high - low > 1) {
        uint64_t middle = low + (high - low) / 2;
        if (pieces[middle].time <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static trochia_phase state_in(const trochia_segment *segments, const trochia_piece *pieces, uint64_t j, double t) {
    trochia_phase phases[3];
    uint64_t made = phases_of(segments, pieces, j, phases);
    uint64_t k = 0;
    while (k + 1 < made && t >= phases[k + 1].t)
        k++;
    trochia_phase state = phases[k];
    double length = segments[state.segment].length, tau = t - state.t;
    if (k + 1 == made && tau > state.duration) { /* after its end: in the rest that follows, or by rounding */
        double part = length / pieces[j].parts;
        state.s = pieces[j].part + 1 == pieces[j].parts ? length : part * (pieces[j].part + 1);
        state.v = pieces[j].exit;
        if (state.v == 0.0)
            state.a = 0.0;
        state.flags = state.v == 0.0;
        state.t = t;
        return state;
    }
    state.s = fmin(state.s + tau * (state.v + 0.5 * state.a * tau), length);
    state.v = fmax(0.0, state.v + state.a * tau);
    state.t = t;
    return state;
}

void trochia_plan_states(const trochia_segment *segments, const trochia_piece *pieces, uint64_t piece_count,
                         const double *times, uint64_t count, trochia_phase *out) {
    uint64_t j = 0;
    for (uint64_t k = 0; k < count; k++) {
        j = piece_at(pieces, piece_count, times[k], j);
        if (times[k] < pieces[0].time)
            out[k] = rest_at(times[k], 0.0, 0, 0.0);
        else
            out[k] = state_in(segments, pieces, j, times[k]);
    }
}
