/* What both profiles do with the rows of limits: see trochia_limits in host/plan.h. */
#ifndef TROCHIA_LIMITS_H
#define TROCHIA_LIMITS_H

#include <math.h>

#include "host/plan.h"

/* What a row of limits sees of a vector over the axes; the first rows are the axes themselves. */
static inline double trochia_dot_row(const trochia_limits *limits, uint32_t row, const double *vector) {
    if (row < limits->axes)
        return vector[row];
    double sum = 0.0;
    for (uint32_t i = 0; i < limits->axes; i++)
        sum += limits->matrix[row * limits->axes + i] * vector[i];
    return sum;
}

/* Length of the first n entries of a vector. */
static inline double trochia_norm(const double *vector, uint32_t n) {
    double square = 0.0;
    for (uint32_t i = 0; i < n; i++)
        square += vector[i] * vector[i];
    return sqrt(square);
}

#endif
