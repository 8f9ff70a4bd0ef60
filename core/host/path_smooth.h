/* Curvature-continuous paths: what is known of each move while its neighbours are settled.
 *
 * Internal to path_*.c, not part of the schema.  path_smooth.c explains the curve.
 * Legend: m jump of x' at a joint, h length of a line, d leg of a corner, P tolerance. */
#ifndef TROCHIA_PATH_SMOOTH_H
#define TROCHIA_PATH_SMOOTH_H

#include "host/path_curve.h"

enum trochia_turn_kind {
    TROCHIA_TURN_NONE = 0,   /* direction and curvature go on */
    TROCHIA_TURN_STOP = 1,   /* motion rests */
    TROCHIA_TURN_CORNER = 2, /* two lines: a triangle of x'' with two equal legs */
    TROCHIA_TURN_CHAIN = 3,  /* two lines of a chain: hats of x'' over whole lines */
    TROCHIA_TURN_ARC = 4,    /* an arc takes part: three cubics */
    TROCHIA_TURN_OVERLAP = 5 /* two lines: the end of one move over the start of the next, one cubic */
};

/* What happens where a curve begins. */
typedef struct {
    uint8_t kind;
    int8_t lean;      /* chain: whether part of the hat stands at the joint before (-1) or after (1) */
    double jump[9];   /* m */
    double size;      /* |m| by groups */
    double tolerance; /* P */
    double wish;      /* length wanted on either side */
    double before, after;
    double used;      /* part of P that kernels of this and the neighbouring joints have taken here */
    double own, lent; /* chain: x'' / m here and at the joint leant on; overlap: wish of a corner, part of P's range */
} trochia_turn;

/* x'' that chains put on a line, even between its ends: x = e0 + d0 s + ... on top of the line. */
typedef struct {
    int there;
    double e0[9], d0[9], y0[9], y1[9];
} trochia_bend;

typedef struct {
    trochia_curve curve;
    trochia_turn turn; /* at its start */
    trochia_bend bend;
} trochia_link;

/* Three cubics of equal length. */
typedef struct {
    double c[3][36];
    double length; /* of each */
} trochia_bridge;

/* Sets kind, m, P and wish of the joint from `a` to `b`. */
void trochia_turn_classify(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                           trochia_turn *turn);

/* Chooses the overlap for a corner of two lines where that is passed sooner, its range 3 wish; or a stop. */
void trochia_overlap_want(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                          trochia_turn *turn);

/* Returns which of stop, corner (a triangle with this leg) and overlap passes a lone corner of two lines soonest; an
 * overlap's range, at most `length`, is made no greater than it is of use. */
int trochia_corner_worth(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const trochia_turn *turn, double leg, double *length);

/* At both ends of one line: a small overlap becomes a corner again beside a chain. */
void trochia_overlap_yield(trochia_turn *turn, trochia_turn *next);

/* Appends the cubic of an overlap, cut in two where the feed changes. */
void trochia_emit_overlap(trochia_reader *r, const trochia_curve *a, const trochia_curve *b, const trochia_turn *turn);

/* Makes the three cubics from `before` the joint to `after` it, shrinking both until they are proven to stay inside
 * P; where none do, the turn becomes a stop. */
void trochia_bridge_settle(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                           trochia_turn *turn);

/* Returns 0 where a stop is passed sooner than a settled bridge. */
int trochia_bridge_worth(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const trochia_turn *turn);

void trochia_bridge_make(const trochia_frame *frame, const trochia_curve *a, const trochia_curve *b,
                         const trochia_turn *turn, trochia_bridge *bridge);

/* Appends a line with what corners at its ends and chains across it make of it; `next` is the turn at its end. */
void trochia_emit_bent(trochia_reader *r, const trochia_link *link, const trochia_turn *next);

/* Where settling a joint looks: links of its neighbourhood by number, `count` of them so far. */
typedef struct {
    trochia_link *ring; /* 8 of them */
    uint64_t count;
} trochia_chain;

static inline trochia_link *trochia_link_at(const trochia_chain *chain, uint64_t number) {
    return &chain->ring[number & 7u];
}

/* Returns 1 where a joint takes the path's place beside it, so that nothing else may bend it there. */
static inline int trochia_takes(const trochia_turn *turn) {
    return turn->kind == TROCHIA_TURN_ARC || turn->kind == TROCHIA_TURN_OVERLAP;
}

/* Settles the joint of two lines at the start of link `i`: a chain's hats where these stay inside P, else a corner. */
void trochia_turn_settle(const trochia_chain *chain, uint32_t n, uint64_t i);

#endif
