/* The path as the planner sees it, and the trajectory over it.
 *
 * A segment is a curve x(s), s in [0, length], in n axes, with |x'| = 1 at both ends (so ds/dt is one continuous
 * speed from segment to segment).  Its coefficients stand in one pool of doubles, at `data`:
 *   LINE   start[n] direction[n]
 *   ARC    centre[2] radius angle angle_rate radius_rate start[n] slope[n]
 *          first plane axis  = centre[0] + r cos(phi), second = centre[1] + r sin(phi),
 *          phi = angle + angle_rate s [rad], r = radius + radius_rate s; every other axis = start + slope s
 *          (start and slope of the two plane axes are 0)
 *   CUBIC  c0[n] c1[n] c2[n] c3[n], x = c0 + c1 s + c2 s^2 + c3 s^3
 * A phase is a stretch of constant jerk along s; phases follow each other without a gap from t = 0. */
#ifndef TROCHIA_PATH_H
#define TROCHIA_PATH_H

#include <stdint.h>

enum trochia_segment_kind { TROCHIA_LINE = 0, TROCHIA_ARC_SEGMENT = 1, TROCHIA_CUBIC = 2 };

typedef struct {
    double length;      /* range of s: mm (degrees where only rotary axes move) */
    double speed_limit; /* programmed speed ds/dt; infinity for a rapid */
    uint64_t data;      /* index of the first coefficient in the pool */
    uint32_t move;      /* row of the program's move it belongs to (a blend: the move it enters) */
    uint8_t kind;
    uint8_t stop;     /* 1: at rest at its end */
    uint8_t first;    /* arc: column of the plane's first axis */
    uint8_t second;   /* arc: column of the plane's second axis */
} trochia_segment;

typedef struct {
    double t;         /* start, s from the program's start */
    double duration;  /* s */
    double s;         /* path parameter in its segment at the start */
    double v, a, j;   /* ds/dt, its derivative, and the derivative of that (constant) */
    uint32_t segment; /* row of the toolpath's segments */
    uint32_t flags;   /* bit 0: a rest (dwell, spin-up, tool change): v = a = j = 0 */
} trochia_phase;

#endif
