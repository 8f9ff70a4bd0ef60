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

/* Runs through spans (bytes as they are sent, one after the other): at full rate where `brake` is below 0; else as a
 * chip that holds them all, and from slice `brake` on brakes where that is above 0.  Writes at most `capacity` pulses
 * and returns how many there are; -1 for bytes that are no spans.  Where it stopped stands in `line`. */
int64_t trochia_timeline_pulses(trochia_timeline *line, const uint8_t *spans, int64_t bytes, int64_t brake,
                                int64_t capacity, trochia_pulse_at *pulses);

#endif
