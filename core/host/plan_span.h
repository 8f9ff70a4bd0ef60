/* One piece of a path with its limits, ready for the passes.  Internal to plan*.c, not part of the schema. */
#ifndef TROCHIA_PLAN_SPAN_H
#define TROCHIA_PLAN_SPAN_H

#include "host/plan.h"

/* Everything is divided by its row's acceleration limit, so that every constraint reads |k w + t a| + ... <= 1. */
typedef struct {
    double length;
    double ceiling[2]; /* greatest w that may be held at the start and at the end */
    double inside;     /* and anywhere between */
    double feed;       /* greatest w by the velocity limits alone */
    double reach;      /* line: greatest acceleration */
    uint32_t rows;
    int straight;
    int capped;                  /* a path acceleration caps the vector */
    double t[2][18], k[2][18];   /* q' and q'' at both ends */
    double sag_w[18], sag_a[18]; /* how far |k w + t a| may rise between the ends, a unit of w and of |a| */
    double along[2][3], bend[2][3], cap_w, cap_a; /* the same of the vector X Y Z */
} trochia_span;

void trochia_span_load(const trochia_segment *segment, const double *pool, const trochia_limits *limits, uint32_t part,
                       uint32_t parts, trochia_span *span);

/* Greatest |a| with which w may rise from w at one end towards the other (end 0: forward, end 1: back in time). */
double trochia_span_reach(const trochia_span *span, int end, double w);

/* Greatest w <= inside that may be reached inside, from w0 and back to w1, and the acceleration for it; 0: none. */
double trochia_span_peak(const trochia_span *span, double w0, double w1, double *acceleration);

uint32_t trochia_span_parts(const trochia_segment *segment, const double *pool, uint32_t n);

#endif
