/* Contour error: how far each recorded point lies from the path that was commanded.
 *
 * The path is given by its samples, no two neighbours equal.  For each point the search starts at the sample commanded
 * at the same time and walks both ways along the path: as long as the path there comes nearer, and at least over four
 * times the point's distance (an arc longer than that would have to double back), but no more than `window` samples
 * without coming nearer.  So a lag along the path, however long, costs nothing, and another pass of the path nearby is
 * not taken for this one.  The nearest chord is then refined on the cubic through its four samples, since a chord cuts
 * an arc's corner by up to acceleration * period^2 / 8. */
#ifndef TROCHIA_CONTOUR_H
#define TROCHIA_CONTOUR_H

#include <stdint.h>

/* path: points rows of dims (1 to 9) columns; arc: length of the path up to each row; actual: n rows of dims;
 * at: for each of them the path's row commanded at the same time.  Out: distance, n values. */
void trochia_contour(const double *path, const double *arc, int64_t points, int64_t dims, const double *actual,
                     const int64_t *at, int64_t n, int64_t window, double *distance);

#endif
