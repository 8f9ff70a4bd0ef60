/* What all rows of limits together leave in a stretch: straight bounds below what each row by itself leaves. */
#ifndef TROCHIA_SCURVE_ROWS_H
#define TROCHIA_SCURVE_ROWS_H

#include <stdint.h>

#include "host/scurve.h"

enum { TROCHIA_ROWS_KEPT = 32 };

/* Of a cap on the vector: greatest |x'|, |x''|, |x' . x''| and |x'''|, over its limit; along 0: there is none. */
typedef struct {
    double along, bend, slant, twist;
} trochia_vector;

/* Of each row in a stretch |q'| / A, |q''| / A, |q'| / J, 3 |q''| / J, |q'''| / J, each the greatest along it. */
typedef struct {
    uint32_t count;
    trochia_vector vector_a, vector_j; /* with 3 x'' */
    double along_a[TROCHIA_ROWS_KEPT], bend_a[TROCHIA_ROWS_KEPT];
    double along_j[TROCHIA_ROWS_KEPT], bend_j[TROCHIA_ROWS_KEPT], twist_j[TROCHIA_ROWS_KEPT];
} trochia_rows;

/* Lowers what turning takes of a stretch (its ceiling given) from the greatest of any row's to what no row forbids. */
void trochia_relax(trochia_rows *rows, trochia_stretch *stretch);

#endif
