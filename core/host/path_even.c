/* Even chains under Q: lines that stand for the same number of chords each.
 *
 * Dropping as many points as Q allows makes even chords uneven, two of them here and three there, and uneven chords
 * shake: x''' is that of the unevenness, not of the curve.  So rows are looked at in cells of 16, by their number since
 * the program's start (a path built piece by piece has the same ones).  A cell is even where its chords are alike and
 * of one length within EVEN; its level is the greatest j for which Q lets one line stand for each 2^j of its chords.
 * Where a cell and its neighbours, AROUND on either side, are even and of one length, lines stand for 2^j chords, j the
 * least level of them all: levels change rarely then.  Rounded points are not that even: there Q takes what it can. */
#include <math.h>

#include "host/path_merge.h"

static const double EVEN = 1e-3; /* of the longest chord; 4 decimals of 0.2 mm leave half of that */
enum { AROUND = 2, LEVELS = 4, ROWS = 1 << LEVELS };

static const double *place_of(const trochia_path_input *in, uint64_t row, uint32_t axis) {
    return row ? &in->moves[row - 1].target[in->columns[axis]] : &in->start[in->columns[axis]];
}

static double chord(const trochia_reader *r, uint64_t row) {
    double square = 0.0;
    for (uint32_t i = 0; i < r->frame.n; i++) {
        double step = *place_of(r->in, row + 1, i) - *place_of(r->in, row, i);
        square += step * step;
    }
    return sqrt(square);
}

/* Returns 1 where Q lets a line stand for `rows` chords from each of the cell's 1st, (rows + 1)th ... on. */
static int stands(const trochia_reader *r, uint64_t first, uint32_t rows, double q) {
    for (uint64_t from = first; from < first + ROWS; from += rows) {
        trochia_run run = {.count = 0};
        double end[9];
        for (uint32_t i = 0; i < r->frame.n; i++) {
            run.base[i] = *place_of(r->in, from, i);
            end[i] = *place_of(r->in, from + rows, i);
            for (uint32_t k = 1; k < rows; k++)
                run.points[k - 1][i] = *place_of(r->in, from + k, i);
        }
        run.count = rows - 1;
        if (!(trochia_run_distance(&r->frame, &run, end) <= q))
            return 0;
    }
    return 1;
}

static void look(const trochia_reader *r, uint64_t number, trochia_cell *cell) {
    const trochia_path_input *in = r->in;
    uint64_t from = number * ROWS;
    *cell = (trochia_cell){.number = number, .known = 1, .shortest = INFINITY};
    if (from < in->first_row + 1 || from + ROWS > in->first_row + in->count)
        return;
    uint64_t first = from - in->first_row;
    double q = trochia_merge_within(in, &in->moves[first]);
    if (!(q > 0.0))
        return;
    for (uint64_t row = first; row < first + ROWS; row++) {
        if (in->rests[row] || !trochia_moves_alike(&in->moves[row - 1], &in->moves[row]) ||
            trochia_moves_absent(in, &in->moves[row]))
            return;
        double length = chord(r, row);
        cell->shortest = fmin(cell->shortest, length);
        cell->longest = fmax(cell->longest, length);
        if (!(cell->longest - cell->shortest <= EVEN * cell->shortest))
            return;
    }
    cell->even = 1;
    while (cell->level < LEVELS && stands(r, first, 2u << cell->level, q))
        cell->level++;
}

static const trochia_cell *cell_of(trochia_reader *r, uint64_t number) {
    trochia_cell *cell = &r->cells[number & 7u];
    if (!cell->known || cell->number != number)
        look(r, number, cell);
    return cell;
}

uint32_t trochia_even_rows(trochia_reader *r, uint64_t row) {
    uint64_t at = r->in->first_row + row, number = at / ROWS;
    if (number < AROUND)
        return 0;
    uint32_t level = LEVELS;
    double shortest = INFINITY, longest = 0.0;
    for (uint64_t k = number - AROUND; k <= number + AROUND; k++) {
        const trochia_cell *cell = cell_of(r, k);
        if (!cell->even)
            return 0;
        shortest = fmin(shortest, cell->shortest);
        longest = fmax(longest, cell->longest);
        level = cell->level < level ? cell->level : level;
    }
    return longest - shortest <= EVEN * shortest ? (1u << level) - (uint32_t)(at & ((1u << level) - 1u)) : 0;
}

int trochia_even_begins(trochia_reader *r, uint64_t row) {
    return (r->in->first_row + row) % ROWS == 0 && trochia_even_rows(r, row);
}
