/* The path as the planner sees it, and the trajectory over it.
 *
 * A segment is a curve x(s), s in [0, length], in n axes; x' is continuous from segment to segment wherever motion
 * does not stop, and |x'| = 1 at the ends of lines and arcs (so ds/dt is one continuous speed).  The norm is that of
 * X Y Z where these move, else of U V W, else of A B C.  Coefficients stand in one pool of doubles, at `data`:
 *   LINE   start[n] direction[n]
 *   ARC    centre[2] radius angle angle_rate radius_rate start[n] slope[n] angle_curve
 *          first plane axis  = centre[0] + r cos(phi), second = centre[1] + r sin(phi),
 *          phi = angle + angle_rate s + angle_curve s^2 [rad], r = radius + radius_rate s (both rates of change beyond
 *          angle_rate are 0 but for a spiral); every other axis = start + slope s (both 0 for the two plane axes)
 *   CUBIC  c0[n] c1[n] c2[n] c3[n], x = c0 + c1 s + c2 s^2 + c3 s^3
 * A phase is a stretch of constant jerk along s; phases follow each other without a gap from t = 0. */
#ifndef TROCHIA_PATH_H
#define TROCHIA_PATH_H

#include <stdint.h>

#include "host/move.h"
#include "host/spline.h"

enum trochia_segment_kind { TROCHIA_LINE = 0, TROCHIA_ARC_SEGMENT = 1, TROCHIA_CUBIC = 2 };

typedef struct {
    double length;      /* range of s: mm (degrees where only rotary axes move) */
    double speed_limit; /* programmed speed ds/dt; infinity for a rapid */
    uint64_t data;      /* index of the first coefficient in the pool */
    uint32_t move; /* row of the program's move it belongs to (a blend: the move it enters; cut in two where the feed
                      changes) */
    uint8_t kind;
    uint8_t stop;   /* 1: at rest at its end */
    uint8_t first;  /* arc: column of the plane's first axis */
    uint8_t second; /* arc: column of the plane's second axis */
} trochia_segment;

typedef struct {
    double t;         /* start, s from the program's start */
    double duration;  /* s */
    double s;         /* path parameter in its segment at the start */
    double v, a, j;   /* ds/dt, its derivative, and the derivative of that (constant) */
    uint32_t segment; /* row of the toolpath's segments */
    uint32_t flags;   /* bit 0: a rest (dwell, spin-up, tool change): v = a = j = 0 */
} trochia_phase;

/* x and its derivatives by s, all at `s` of one segment in n axes: out[order * n + axis] for order = 0..orders-1 (at
 * most 4). */
void trochia_segment_at(const trochia_segment *segment, const double *pool, uint32_t n, double s, uint32_t orders,
                        double *out);

/* The `order`-th time derivative of position (0..3) at each of `count` states (t and duration unread): out[count][n].
 */
void trochia_path_sample(const trochia_segment *segments, const double *pool, uint32_t n, const trochia_phase *states,
                         uint64_t count, uint32_t order, double *out);

/* Returns 0 where all coefficients of `count` segments in n axes lie in a pool of `room` doubles, 1 where some do not,
 * 2 where a segment is of no kind, or an arc in a plane that is not there. */
int32_t trochia_path_check(const trochia_segment *segments, uint64_t count, uint64_t room, uint32_t n);

/* Copies `count` segments behind others of a path: their coefficients have moved by `shift` in the pool, their moves
 * count from `first` now; lines and power are those of their moves, whose rows `moves` are. */
void trochia_path_append(const trochia_segment *segments, uint64_t count, uint64_t shift, uint32_t first,
                         const trochia_move *moves, trochia_segment *out, uint32_t *lines, float *power);

/* How many segments, from the first on, take `seconds` together at their own speeds times `feed`, none faster than
 * `most`: all of them where they take less.  Takes off `seconds` what they take. */
uint64_t trochia_path_reach(const trochia_segment *segments, uint64_t count, double feed, double most, double *seconds);

/* Copies `count` phases, `later` by so much, their segments by `rows` further on (modulo 2^32: also back); `out` may be
 * where they are. */
void trochia_phases_move(const trochia_phase *phases, uint64_t count, double later, uint32_t rows, trochia_phase *out);

/* Widens least[n], greatest[n] by the segments [first, last), exactly (arcs and cubics by the roots of x'). */
void trochia_path_extents(const trochia_segment *segments, const double *pool, uint32_t n, uint64_t first,
                          uint64_t last, double *least, double *greatest);

/* What the moves of a program are read with. */
typedef struct {
    const trochia_move *moves;
    const uint8_t *rests; /* per move: 1 = motion is at rest before it */
    uint64_t count;       /* moves */
    uint64_t first_row;   /* number of the first of them since the program's start */
    double start[9];      /* position before the first move */
    double tolerance;     /* of the machine, for G64 without P; blends are left out where tolerance < 0 */
    uint32_t axes;        /* columns of the path */
    uint32_t columns[9];  /* which of the nine letters each is */
    uint32_t absent_count;
    uint32_t absent[9];  /* letters that must not move */
    uint32_t overlap;    /* continuity 2: corners of lines may be overlaps, at whose ends x'' jumps along x' */
    uint32_t continuity; /* 1: x' is continuous between stops; 2: x'' too */
    uint32_t paced;      /* 1: the three below are given */
    const trochia_spline_piece *pieces; /* of the program's splines, none farther from its curve than spline_error */
    const uint64_t *first_piece;        /* per spline and once more; NULL where there are no splines */
    uint64_t spline_count;
    double spline_error; /* mm */
    double slowness[9];  /* 1 / velocity limit of each column, 1 / acceleration limit, 1 / jerk limit (0: none) */
    double effort[9];
    double shake[9];
} trochia_path_input;

/* What is made of them; room for 3 segments and (7 + 10 axes) coefficients a move and a piece of a spline is the
 * caller's; for continuous curvature for 6 segments and (7 + 22 axes) coefficients. */
typedef struct {
    trochia_segment *segments;
    double *pool;
    uint64_t segment_count, pool_count;
    uint64_t merged_count; /* moves that others stand for (Q; with continuous curvature) */
    uint64_t failed_move;  /* row of the move that has no speed (see the result) */
} trochia_path_output;

/* Returns 0, or 1 when a feed has no rate, 2 when a feed per revolution finds the spindle at rest, 3 when a spline is
 * not there or does not begin where the move before ended or end at its target, 4 when an absent letter moves. */
int32_t trochia_path_build(const trochia_path_input *input, trochia_path_output *output);

#endif
