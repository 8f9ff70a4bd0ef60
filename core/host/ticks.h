/* Whole ramps, moves and runs of tick segments through the shared code, for the host. */
#ifndef TROCHIA_TICKS_H
#define TROCHIA_TICKS_H

#include <stdint.h>

#include "shared/ramp.h"
#include "shared/segment.h"
#include "shared/speed.h"

void trochia_begin_ramp(trochia_ramp *ramp, uint64_t per_step, uint64_t square);

/* `steps` intervals up, or down where `down` is 1. */
void trochia_ramp_intervals(trochia_ramp *ramp, int32_t down, int64_t steps, uint32_t *intervals);

void trochia_begin_speed(trochia_speed *move, uint64_t up_per_step, uint64_t down_per_step, uint32_t up, uint32_t level,
                         uint32_t down, uint32_t interval);

/* At most `capacity` intervals of a move and the state each was made in; returns how many. */
int64_t trochia_speed_intervals(trochia_speed *move, int64_t capacity, uint32_t *intervals, uint8_t *states);

/* The interval before every step of `count` segments, pauses included; `run` carries the fraction.  Returns how many.
 */
int64_t trochia_segment_intervals(trochia_segment_run *run, const trochia_tick_segment *segments, int64_t count,
                                  int64_t capacity, uint32_t *intervals);

#endif
