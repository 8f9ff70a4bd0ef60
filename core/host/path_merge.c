/* Q of G64: consecutive feeds so nearly in line that one line stands for them, before corners are looked at.
 *
 * A line from the first one's start to the last one's end replaces them while every point between, projected on it,
 * comes in order, and is no farther from it than q: then no point of either is farther than q from the other.  q is Q,
 * at most a quarter of P, and what was really taken of it is left out of the P that the joints of the line may still
 * use. */
#include <math.h>
#include <string.h>

#include "host/path_merge.h"

static const double PART = 0.25; /* of P: chords grow to 0.5 sqrt(8 R P), whose joints then need P / 3 */

double trochia_merge_within(const trochia_path_input *in, const trochia_move *move) {
    if (in->tolerance < 0.0 || move->kind != TROCHIA_FEED || move->law != TROCHIA_PER_SECOND)
        return 0.0;
    if (move->path_mode == TROCHIA_BLEND_DEFAULT)
        return PART * in->tolerance;
    return move->path_mode == TROCHIA_BLEND ? fmin(move->tolerance[1], PART * move->tolerance[0]) : 0.0;
}

int trochia_moves_alike(const trochia_move *a, const trochia_move *b) {
    return b->kind == TROCHIA_FEED && b->law == TROCHIA_PER_SECOND && a->rate == b->rate && a->power == b->power &&
           a->path_mode == b->path_mode && a->tolerance[0] == b->tolerance[0] && a->tolerance[1] == b->tolerance[1];
}

double trochia_run_distance(const trochia_frame *frame, const trochia_run *run, const double *end) {
    uint32_t n = frame->n;
    double step[9], apart[9], square = 0.0, before = 0.0, greatest = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        step[i] = end[i] - run->base[i];
        square += step[i] * step[i];
    }
    if (!(square > 0.0))
        return INFINITY;
    for (uint32_t k = 0; k < run->count; k++) {
        double along = 0.0;
        for (uint32_t i = 0; i < n; i++)
            along += (run->points[k][i] - run->base[i]) * step[i];
        along /= square;
        if (!(along > before && along < 1.0))
            return INFINITY;
        before = along;
        for (uint32_t i = 0; i < n; i++)
            apart[i] = run->points[k][i] - run->base[i] - along * step[i];
        greatest = fmax(greatest, trochia_group_norm(frame, apart));
    }
    return greatest;
}

/* Takes the rows from `row` on that join the line just read; returns the first that does not. */
static uint64_t extend(trochia_reader *r, uint64_t row, double q, trochia_run *run, trochia_curve *curve) {
    const trochia_path_input *in = r->in;
    uint32_t n = r->frame.n;
    double end[9], taken = 0.0;
    for (; row < in->count && run->count < TROCHIA_RUN && !in->rests[row]; row++) {
        const trochia_move *move = &in->moves[row];
        if (!trochia_moves_alike(&in->moves[row - 1], move) || trochia_moves_absent(in, move) ||
            trochia_even_begins(r, row))
            break;
        int still = 1;
        for (uint32_t i = 0; i < n; i++) {
            end[i] = move->target[in->columns[i]];
            still &= end[i] == r->position[i];
        }
        if (still)
            continue;
        memcpy(run->points[run->count++], r->position, n * sizeof *end);
        double greatest = trochia_run_distance(&r->frame, run, end);
        if (greatest > q)
            break;
        taken = greatest;
        memcpy(r->position, end, n * sizeof *end);
        r->out->merged_count++;
    }
    curve->tolerance -= taken;
    return row;
}

/* Takes the rows from `row` up to `until`, of which it is known that they join the line just read. */
static uint64_t join(trochia_reader *r, uint64_t row, uint64_t until, trochia_run *run, trochia_curve *curve) {
    const trochia_path_input *in = r->in;
    for (; row < until; row++) {
        memcpy(run->points[run->count++], r->position, r->frame.n * sizeof *r->position);
        for (uint32_t i = 0; i < r->frame.n; i++)
            r->position[i] = in->moves[row].target[in->columns[i]];
        r->out->merged_count++;
    }
    if (run->count)
        curve->tolerance -= trochia_run_distance(&r->frame, run, r->position);
    return row;
}

int32_t trochia_read_merged(trochia_reader *r, uint64_t *row, trochia_curve *curve) {
    trochia_run run = {.count = 0};
    memcpy(run.base, r->position, sizeof run.base);
    uint64_t first = *row, merged = r->out->merged_count;
    int32_t wrong = trochia_read_curve(r, first, curve);
    *row = trochia_next_row(r, first);
    double q = trochia_merge_within(r->in, &r->in->moves[first]);
    if (wrong || !(curve->length > 0.0 && q > 0.0))
        return wrong;
    uint32_t even = trochia_even_rows(r, first);
    *row = even ? join(r, *row, first + even, &run, curve) : extend(r, *row, q, &run, curve);
    if (r->out->merged_count > merged) {
        double end[9];
        memcpy(end, r->position, sizeof end);
        memcpy(r->position, run.base, sizeof end);
        trochia_read_line(r, end, curve);
        memcpy(r->position, end, sizeof end);
    }
    return 0;
}
