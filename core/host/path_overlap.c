/* Corners of two lines as the overlap of their moves: while one still slows down by constant jerk, the next speeds up.
 *
 * Over a range L of s, with u = s / L,
 *   x = corner - T1 L (1 - u)^3 / 3 + T2 L u^3 / 3,   x' = T1 (1 - u)^2 + T2 u^2,   |x'| <= 1.
 * It leaves the corner's lines by d = L / 3 on either side, in their directions; x'' = -2 T1 / L at its start and
 * 2 T2 / L at its end lie along x', so that acceleration goes on without a jump where ds/dt slows down before it, at
 * 2 v^2 / L, and speeds up as much behind; inside, v is even, x''' = 2 (T1 + T2) / L^2, and the jerk of turning is that
 * of slowing down and speeding up, spent once.
 *
 * Deviation: in the first half take the programmed point L ((1 - u)^3 - u^3) / 3 before the corner.  It is (T2 - T1) L
 * u^3 / 3 away, and these points are all of them from d before to the corner; in the second half the same backwards.
 * So either path is no farther than |T2 - T1| L / 24 from the other: L = 24 P / |T2 - T1|.  path_worth.c says how much
 * of that is of use, and where a triangle, or a stop, is passed sooner. */
#include <math.h>

#include "host/path_smooth.h"

/* Speed falls and rises again within the lines: between two overlaps passed alike it needs 4 L of way. */
static const double ROOM = 0.25;
/* A triangle's legs that take less of the shorter line are no part of a chain. */
static const double LONE = 0.5;
/* Nor is a jump of x' that is more than turning: another axis begins to move, or ends. */
static const double CHORDS = 2.0;
/* Where lines leave less than this of the range that P allows, an overlap gives way to a chain beside it, whose hats
 * would have to leave out their last joints: turning by less than this. */
static const double PART = 0.6, SHALLOW = 0.35;

void trochia_overlap_want(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                          trochia_turn *turn) {
    double both[9], shorter = fmin(a->length, b->length);
    double most = 24.0 * turn->tolerance / turn->size, length = fmin(most, ROOM * shorter);
    double leg = fmin(turn->wish, shorter);
    length = fmin(length, 4.0 * trochia_pace_room(frame, a, b, turn->jump));
    for (uint32_t i = 0; i < frame->n; i++)
        both[i] = a->t1[i] + b->t0[i];
    /* the same jerk on both: v^3 = J / |x'''| */
    int faster = 2.0 * trochia_group_norm(frame, both) * leg * leg < turn->size * length * length;
    if (!faster && leg >= LONE * shorter && turn->size <= CHORDS)
        return;
    int kind = trochia_corner_worth(frame, a, b, turn, leg, &length);
    if (kind == TROCHIA_TURN_STOP) {
        turn->kind = TROCHIA_TURN_STOP;
        turn->wish = 0.0;
    }
    if (kind != TROCHIA_TURN_OVERLAP)
        return;
    turn->kind = TROCHIA_TURN_OVERLAP;
    turn->own = turn->wish;
    turn->lent = length / most;
    turn->wish = length / 3.0;
}

static void give_way(trochia_turn *turn, const trochia_turn *other) {
    if (turn->kind != TROCHIA_TURN_OVERLAP || turn->lent >= PART || other->kind != TROCHIA_TURN_CORNER ||
        other->size > SHALLOW)
        return;
    turn->kind = TROCHIA_TURN_CORNER;
    turn->wish = turn->own;
}

void trochia_overlap_yield(trochia_turn *turn, trochia_turn *next) {
    give_way(turn, next);
    give_way(next, turn);
}

void trochia_emit_overlap(trochia_reader *r, const trochia_curve *a, const trochia_curve *b, const trochia_turn *turn) {
    uint32_t n = r->frame.n;
    double c[36], rest[36], length = 3.0 * turn->after;
    for (uint32_t i = 0; i < n; i++) {
        double t1 = a->t1[i], t2 = b->t0[i];
        c[i] = b->x0[i] - t1 * turn->after;
        c[n + i] = t1;
        c[2 * n + i] = -t1 / length;
        c[3 * n + i] = (t1 + t2) / (3.0 * length * length);
    }
    if (a->speed == b->speed) {
        trochia_emit_cubic(r, c, length, b->speed, b->move);
        return;
    }
    trochia_shift_cubic(n, c, 0.5 * length, rest);
    trochia_emit_cubic(r, c, 0.5 * length, a->speed, a->move);
    trochia_emit_cubic(r, rest, 0.5 * length, b->speed, b->move);
}
