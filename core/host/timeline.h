/* What a chip will do with spans: the time line of core/shared/timeline.h, run on the host. */
#ifndef TROCHIA_HOST_TIMELINE_H
#define TROCHIA_HOST_TIMELINE_H

#include <stdint.h>

#include "shared/timeline.h"

typedef struct {
    int64_t tick; /* since the first slice began */
    uint8_t pins; /* motors that step, a bit each */
    uint8_t backwards;
} trochia_pulse_at;

typedef struct {
    int64_t tick;
    uint8_t power; /* of the beam from then on, at full rate */
} trochia_light_at;

/* What was made: as many are written as there is room for, `made` and `lit` are how many there are. */
typedef struct {
    trochia_pulse_at *pulses;
    trochia_light_at *lights;
    int64_t pulse_room, light_room, made, lit;
} trochia_executed;

/* Runs through spans (bytes as they are sent, one after the other): at full rate where `brake` is below 0; else as a
 * chip that holds them all, and from slice `brake` on brakes where that is above 0.  Returns 0; -1 for bytes that are
 * no spans.  Where it stopped stands in `line`. */
int32_t trochia_timeline_run(trochia_timeline *line, const uint8_t *spans, int64_t bytes, int64_t brake,
                             trochia_executed *done);

#endif
