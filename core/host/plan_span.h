/* One piece of a path with its limits, ready for the passes.  Internal to plan*.c, not part of the schema. */
#ifndef TROCHIA_PLAN_SPAN_H
#define TROCHIA_PLAN_SPAN_H

#include "host/plan.h"

/* A stay at the peak below this part of the piece is rounding, and left out. */
#define TROCHIA_STAY 1e-12
/* Nor is a change of w by less than this part worth phases of its own: their times would be differences of equals. */
#define TROCHIA_WORTH 1e-6

/* The limits with their reciprocals, made once a plan. */
typedef struct {
    const trochia_limits *limits;
    double slowness[18], effort[18]; /* 1 / velocity, 1 / acceleration of each row */
    double path_slowness, path_effort;
    int capped; /* either of the path's caps is there */
    int plain;  /* three axes, no other rows: the usual machine, worked with loops of known length */
} trochia_bounds;

trochia_bounds trochia_bounds_of(const trochia_limits *limits);

/* Everything is divided by its row's acceleration limit, so that every constraint reads |k w + t a| + ... <= 1. */
typedef struct {
    double length;
    double ceiling[2]; /* greatest w that may be held at the start and at the end */
    double inside;     /* and anywhere between */
    double feed;       /* greatest w by the velocity limits alone */
    double reach;      /* line: greatest acceleration */
    uint32_t rows;
    int straight;
    int even;                    /* a parabola: nothing sags, bend is the same at both ends */
    int capped;                  /* a path acceleration caps the vector */
    double t[2][18], k[2][18];   /* q' and q'' at both ends */
    double sag_w[18], sag_a[18]; /* how far |k w + t a| may rise between the ends, a unit of w and of |a| */
    double along[2][3], bend[2][3], cap_w, cap_a; /* the same of the vector X Y Z */
    const trochia_segment *arc; /* the arc last loaded, which part of it, and cosine and sine at that part's ends */
    uint32_t part;
    double circle[2][2];
} trochia_span;

void trochia_span_load(const trochia_segment *segment, const double *pool, const trochia_bounds *bounds, uint32_t part,
                       uint32_t parts, trochia_span *span);

/* Greatest |a| with which w may rise from w at one end towards the other (end 0: forward, end 1: back in time). */
double trochia_span_reach(const trochia_span *span, int end, double w);

/* Greatest w <= inside that may be reached inside, from w0 and back to w1, and the acceleration for it; 0: none. */
double trochia_span_peak(const trochia_span *span, double w0, double w1, double *acceleration);

uint32_t trochia_span_parts(const trochia_segment *segment, const double *pool, uint32_t n);

#endif
