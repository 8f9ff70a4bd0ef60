/* Bezier curves by their own length: cubics whose parameter is the way along the curve.
 *
 * A cubic Bezier curve b(u) has no polynomial by its length, so a spline is laid through it: x'' continuous
 * and even between knots, and at both ends the curve's own place, direction and curvature, so that curves
 * that join smoothly still do. */
#ifndef TROCHIA_SPLINE_H
#define TROCHIA_SPLINE_H

#include <stdint.h>

typedef struct {
    double length; /* mm */
    double c[12];  /* c0 c1 c2 c3 of X Y Z each: x = c0 + c1 s + c2 s^2 + c3 s^3 */
} trochia_spline_piece;

/* Pieces of `count` curves of four control points points[count][4][3], none farther than `tolerance` from its curve
 * (but for the last 2^-24 of one that turns on the spot); curve k has those from first[k] up to first[k + 1], none
 * where it goes nowhere.  Writes no more than `room` of them, and returns how many there are. */
uint64_t trochia_spline_fit(const double *points, uint64_t count, double tolerance, uint64_t *first,
                            trochia_spline_piece *pieces, uint64_t room);

#endif
