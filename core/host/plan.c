/* The two passes: backward, how fast may each joint be passed so that all that follows still can be kept; forward, how
 * fast it is reached.  Neither looks at more than one piece, so the whole is linear in the program's length. */
#include <math.h>
#include <stddef.h>

#include "host/plan_span.h"

uint64_t trochia_plan_count(const trochia_segment *segments, const double *pool, uint32_t axes, uint64_t count) {
    uint64_t pieces = 0;
    for (uint64_t k = 0; k < count; k++)
        pieces += segments[k].kind == TROCHIA_LINE ? 1 : trochia_span_parts(&segments[k], pool, axes);
    return pieces;
}

static void lay_out(const trochia_segment *segments, const double *pool, uint64_t count, uint32_t axes,
                    trochia_piece *pieces) {
    for (uint64_t k = 0; k < count; k++) {
        uint32_t parts = trochia_span_parts(&segments[k], pool, axes);
        for (uint32_t part = 0; part < parts; part++, pieces++) {
            pieces->segment = (uint32_t)k;
            pieces->part = part;
            pieces->parts = parts;
        }
    }
}

/* Leaves in `exit` the greatest w at each piece's end from which the rest of the path can be kept, in `peak` the
 * greatest inside, and in `acceleration` a line's own. */
static void backward(const trochia_segment *segments, const double *pool, const trochia_bounds *bounds,
                     trochia_piece *pieces, uint64_t piece_count) {
    trochia_span span = {.arc = NULL};
    double next = 0.0;
    for (uint64_t j = piece_count; j-- > 0;) {
        trochia_piece *piece = &pieces[j];
        const trochia_segment *segment = &segments[piece->segment];
        trochia_span_load(segment, pool, bounds, piece->part, piece->parts, &span);
        double ceiling = span.ceiling[0];
        double exit = next < span.ceiling[1] ? next : span.ceiling[1];
        if (segment->stop && piece->part + 1 == piece->parts)
            exit = 0.0;
        next = ceiling;
        if (exit < ceiling) {
            double most = (exit + 2.0 * span.length * trochia_span_reach(&span, 1, exit)) * (1.0 - 4e-16);
            next = most > ceiling ? ceiling : most > exit ? most : exit;
        }
        piece->exit = exit;
        piece->peak = span.inside;
        piece->acceleration = span.straight ? span.reach : 0.0;
        piece->flags =
            segment->speed_limit < INFINITY && span.feed < segment->speed_limit * segment->speed_limit * (1.0 - 1e-9);
    }
}

/* One piece in its turn: the fastest way through it. */
typedef struct {
    const trochia_segment *segments;
    const double *pool;
    const trochia_bounds *bounds;
    double w, v; /* where the piece begins */
    trochia_span span;
} trochia_runner;

/* Restores what the pass back knew of a piece; a line needs no more than that. */
static void recall(trochia_runner *r, const trochia_piece *piece) {
    trochia_span *span = &r->span;
    if (piece->acceleration > 0.0) {
        span->straight = 1;
        span->length = r->segments[piece->segment].length;
        span->inside = piece->peak;
        span->reach = piece->acceleration;
        return;
    }
    trochia_span_load(&r->segments[piece->segment], r->pool, r->bounds, piece->part, piece->parts, span);
}

/* Sets a piece's speeds and returns its time. */
static double go_through(trochia_runner *r, trochia_piece *piece) {
    double w0 = r->w, w1 = piece->exit, v0 = r->v, peak = 0.0, acceleration = 0.0;
    double length = r->segments[piece->segment].length / piece->parts, high = w0 > w1 ? w0 : w1;
    if (w1 != w0 || piece->peak > high * (1.0 + TROCHIA_WORTH)) {
        recall(r, piece);
        if (w1 > w0) {
            double most = (w0 + 2.0 * length * trochia_span_reach(&r->span, 0, w0)) * (1.0 - 4e-16);
            w1 = most > w1 ? w1 : most > w0 ? most : w0;
        }
        peak = trochia_span_peak(&r->span, w0, w1, &acceleration);
    }
    double v1 = w1 == w0 ? v0 : sqrt(w1);
    piece->exit = r->v = v1;
    r->w = w1;
    if (peak == 0.0) {
        piece->peak = 0.0;
        piece->acceleration = 0.5 * (w1 - w0) / length;
        return 2.0 * length / (v0 + v1);
    }
    double top = sqrt(peak), stay = length - (2.0 * peak - w0 - w1) / (2.0 * acceleration);
    piece->peak = top;
    piece->acceleration = acceleration;
    return (2.0 * top - v0 - v1) / acceleration + (stay > TROCHIA_STAY * length ? stay / top : 0.0);
}

double trochia_plan(const trochia_segment *segments, const double *pool, uint64_t count, const trochia_limits *limits,
                    const uint64_t *rest_segments, const double *rest_seconds, uint64_t rests, trochia_piece *pieces,
                    uint64_t piece_count) {
    trochia_bounds bounds = trochia_bounds_of(limits);
    trochia_runner runner = {.segments = segments, .pool = pool, .bounds = &bounds, .w = 0.0, .v = 0.0};
    double time = 0.0;
    uint64_t rest = 0;
    lay_out(segments, pool, count, limits->axes, pieces);
    backward(segments, pool, &bounds, pieces, piece_count);
    for (uint64_t j = 0; j < piece_count; j++) {
        for (; rest < rests && rest_segments[rest] <= pieces[j].segment; rest++)
            time += rest_seconds[rest];
        pieces[j].time = time;
        time += go_through(&runner, &pieces[j]);
    }
    for (; rest < rests; rest++)
        time += rest_seconds[rest];
    return time;
}

void trochia_plan_move_times(const trochia_segment *segments, const trochia_piece *pieces, uint64_t piece_count,
                             double *out) {
    trochia_phase phases[4];
    trochia_phase_cursor cursor = {0, 0};
    while (cursor.piece < piece_count) {
        uint32_t move = segments[pieces[cursor.piece].segment].move;
        uint64_t made = trochia_plan_phases(segments, pieces, cursor.piece + 1, (const uint64_t *)0, (const double *)0,
                                            0, &cursor, phases, 4);
        for (uint64_t k = 0; k < made; k++)
            out[move] += phases[k].duration;
    }
}

static double row_of(const trochia_limits *limits, uint32_t row, const double *vector) {
    double sum = 0.0;
    for (uint32_t i = 0; i < limits->axes; i++)
        sum += limits->matrix[row * limits->axes + i] * vector[i];
    return sum;
}

static void raise_peaks(const trochia_limits *limits, const double *x, double v, double a, double *velocity,
                        double *acceleration) {
    uint32_t n = limits->axes;
    for (uint32_t row = 0; row < limits->rows; row++) {
        double along = row_of(limits, row, x + n), bend = row_of(limits, row, x + 2 * n);
        velocity[row] = fmax(velocity[row], fabs(along * v));
        acceleration[row] = fmax(acceleration[row], fabs(bend * v * v + along * a));
    }
}

void trochia_plan_peaks(const trochia_segment *segments, const double *pool, const trochia_limits *limits,
                        const trochia_piece *pieces, uint64_t piece_count, double *velocity, double *acceleration) {
    trochia_phase phases[4];
    trochia_phase_cursor cursor = {0, 0};
    double x[27];
    while (cursor.piece < piece_count) {
        const trochia_segment *segment = &segments[pieces[cursor.piece].segment];
        uint64_t made = trochia_plan_phases(segments, pieces, cursor.piece + 1, (const uint64_t *)0, (const double *)0,
                                            0, &cursor, phases, 4);
        int points = segment->kind == TROCHIA_LINE ? 1 : pieces[cursor.piece - 1].parts == 1 ? 3 : 8;
        for (uint64_t k = 0; k < made; k++)
            for (int at = 0; at <= points; at++) {
                double t = phases[k].duration * at / points;
                double s = phases[k].s + t * (phases[k].v + 0.5 * phases[k].a * t);
                trochia_segment_at(segment, pool, limits->axes, fmin(s, segment->length), 3, x);
                raise_peaks(limits, x, phases[k].v + phases[k].a * t, phases[k].a, velocity, acceleration);
            }
    }
}
