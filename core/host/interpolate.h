/* Whole figures through the shared interpolators, for the host. */
#ifndef TROCHIA_HOST_INTERPOLATE_H
#define TROCHIA_HOST_INTERPOLATE_H

#include <stdint.h>

#include "shared/interpolate.h"

/* Writes the pulse byte of each tick until the figure ends or `capacity` is full; returns how many. */
int64_t trochia_interpolate(trochia_interpolator *ip, int64_t capacity, uint8_t *pulses);

/* Runs a figure that has begun `times` times over, keeping no pulse; returns the sum of their bytes.  For timing. */
int64_t trochia_interpolate_over(const trochia_interpolator *begun, int64_t times);

void trochia_begin_line(trochia_interpolator *ip, uint8_t method, int32_t x, int32_t y);

void trochia_begin_arc(trochia_interpolator *ip, uint8_t method, uint8_t clockwise, int64_t radius2, int32_t x0,
                       int32_t y0, int32_t x1, int32_t y1);

#endif
