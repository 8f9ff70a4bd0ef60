/* Between a program's moves and its path: one move as a curve, and what is to happen where two of them meet.
 *
 * Internal to path_*.c, not part of the schema.
 * Legend: d length taken from a curve at a joint for the blend, P tolerance, kappa |x''| [1/mm]. */
#ifndef TROCHIA_PATH_CURVE_H
#define TROCHIA_PATH_CURVE_H

#include "host/path.h"

/* n columns; group k (X Y Z, then A B C, then U V W) is columns groups[k] up to groups[k + 1]. */
typedef struct {
    uint32_t n;
    uint32_t groups[4];
    const trochia_path_input *in;
} trochia_frame;

typedef struct {
    double length, speed, tolerance;   /* tolerance <= 0: no blend at either end */
    double x0[9], x1[9], t0[9], t1[9]; /* ends, and x' there */
    double c[36];                      /* arc: centre[2] radius angle angle_rate radius_rate angle_curve; cubic: c0.. */
    double kappa;                      /* greatest |x''|, 0 for a line */
    uint32_t move;
    uint8_t kind, first, second;
    uint8_t halt;   /* at rest before it */
    uint8_t settle; /* at rest after it (G61.1) */
    uint8_t rested; /* found to be at rest where it begins */
    uint8_t inner;  /* follows from the curve before without a joint: a later piece of the same spline */
} trochia_curve;

/* Part of a curve with rest at its other end that a joint may take: the rest of it brakes or speeds up by its own
 * direction alone. */
#define REST_SHARE 0.5

typedef struct {
    double before, after; /* length wanted (then: taken) of the curve before and after; 0 and 0: no blend */
    int stop;
} trochia_joint;

typedef struct {
    double c[36]; /* c0 c1 c2 c3 of n axes each */
    double length;
} trochia_blend;

/* Sixteen rows of the program, and what Q may do to them: see path_even.c. */
typedef struct {
    uint64_t number;
    double shortest, longest; /* chord */
    uint32_t level;
    uint8_t known, even;
} trochia_cell;

typedef struct {
    const trochia_path_input *in;
    trochia_path_output *out;
    trochia_frame frame;
    double position[9];
    uint8_t halt;
    uint64_t piece, piece_end; /* pieces of the spline being read that are still to come */
    double way, way_left;      /* of all of it, and of these */
    trochia_cell cells[8];     /* those near the row being read, by number */
} trochia_reader;

void trochia_start_reader(trochia_reader *r);

/* Returns the row to read after `row`: the same while pieces of its spline are to come. */
static inline uint64_t trochia_next_row(const trochia_reader *r, uint64_t row) {
    return r->piece < r->piece_end ? row : row + 1;
}

/* Reads the move of a row, of a spline the next piece; length 0 where it does not move.  Returns 0, or what is wrong (1
 * no feed, 2 spindle at rest, 3 no such spline, 4 an absent letter). */
int32_t trochia_read_curve(trochia_reader *r, uint64_t row, trochia_curve *curve);

/* Returns 1 where a move asks for a letter that must not move. */
static inline int trochia_moves_absent(const trochia_path_input *in, const trochia_move *move) {
    int moved = 0;
    for (uint32_t k = 0; k < in->absent_count; k++)
        moved |= move->target[in->absent[k]] != in->start[in->absent[k]];
    return moved;
}

/* Makes the line from the reader's position to `target`; length 0 where that is no way. */
void trochia_read_line(const trochia_reader *r, const double *target, trochia_curve *curve);

/* Reads the move of a row and, where Q allows, those after it as one; `row` becomes that of the next. */
int32_t trochia_read_merged(trochia_reader *r, uint64_t *row, trochia_curve *curve);

trochia_segment *trochia_append(trochia_reader *r, double length, double speed, uint32_t move, uint8_t kind);

/* Returns 1 where what is left of a curve is what rounding leaves when nothing is: blends that meet halfway. */
static inline int trochia_is_rounding(double left, double length) {
    double least = 1e-9 * length < 1e-10 ? 1e-9 * length : 1e-10;
    return left <= least || left <= 1e-12 * length;
}

/* Appends `length` of a curve from `cut` on; nothing at all where both blends meet. */
void trochia_emit_curve(trochia_reader *r, const trochia_curve *curve, double cut, double length);

/* The same cubic about s = u. */
void trochia_shift_cubic(uint32_t n, const double *c, double u, double *out);

void trochia_emit_cubic(trochia_reader *r, const double *c, double length, double speed, uint32_t move);

/* What the joint at a curve's start may take of it, when the joint at its end wants `other`: its wish, or half, or what
 * is left.  The joint at the end then gets its wish or all that is left. */
double trochia_share(double wish, double other, double length);

void trochia_curve_at(const trochia_curve *curve, uint32_t n, double s, uint32_t orders, double *out);

/* Greatest norm over the groups: mm and degrees count alike. */
double trochia_group_norm(const trochia_frame *frame, const double *vector);

/* Returns 1 where x' is the same before and after, for all that a machine can tell. */
int trochia_is_tangent(const trochia_frame *frame, const double *before, const double *jump);

/* Greatest length a joint's blend should take on either side: where one move is slower than the other, no more than its
 * speed needs twice over; infinity elsewhere. */
double trochia_pace_room(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const double *jump);

/* Returns 1 within 2 degrees of turning back. */
int trochia_is_reversal(uint32_t n, const double *before, const double *after);

/* What is wanted where `a` meets `b`, if both had all the length in the world. */
trochia_joint trochia_joint_wanted(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b);

/* Makes the blend inside the lengths the joint now gives, shrinking it until it is proven to stay inside the
 * tolerance; where none does, the joint becomes a stop. */
void trochia_joint_blend(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         trochia_joint *joint, trochia_blend *blend);

/* trochia_path_build with continuous curvature. */
int32_t trochia_path_smooth(const trochia_path_input *input, trochia_path_output *output);

#endif
