/* Lines that stand for several moves under Q of G64; internal to path_merge.c and path_even.c, not part of the schema.
 */
#ifndef TROCHIA_PATH_MERGE_H
#define TROCHIA_PATH_MERGE_H

#include "host/path_curve.h"

enum { TROCHIA_RUN = 16 }; /* points between: a run of n lines costs n of these at most */

/* Points between the start of a line and its end. */
typedef struct {
    double base[9], points[TROCHIA_RUN][9];
    uint32_t count;
} trochia_run;

/* Greatest distance of the run's points from the line to `end`; infinity where they do not come in order. */
double trochia_run_distance(const trochia_frame *frame, const trochia_run *run, const double *end);

/* How far from a line the points that it stands for may lie; 0: it stands for its own move only. */
double trochia_merge_within(const trochia_path_input *in, const trochia_move *move);

/* Returns 1 where one line may stand for both moves. */
int trochia_moves_alike(const trochia_move *a, const trochia_move *b);

/* Returns for how many rows from `row` on one line stands in an even chain; 0 where there is none. */
uint32_t trochia_even_rows(trochia_reader *r, uint64_t row);

/* Returns 1 where an even chain begins before this row, or goes on in a further cell. */
int trochia_even_begins(trochia_reader *r, uint64_t row);

#endif
