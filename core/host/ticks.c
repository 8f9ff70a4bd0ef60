#include "host/ticks.h"

void trochia_begin_ramp(trochia_ramp *ramp, uint64_t per_step, uint64_t square) {
    trochia_ramp_begin(ramp, per_step, square);
}

void trochia_ramp_intervals(trochia_ramp *ramp, int32_t down, int64_t steps, uint32_t *intervals) {
    for (int64_t i = 0; i < steps; i++)
        intervals[i] = down ? trochia_ramp_down(ramp) : trochia_ramp_up(ramp);
}

void trochia_begin_speed(trochia_speed *move, uint64_t up_per_step, uint64_t down_per_step, uint32_t up, uint32_t level,
                         uint32_t down, uint32_t interval) {
    trochia_speed_begin(move, up_per_step, down_per_step, up, level, down, interval);
}

int64_t trochia_speed_intervals(trochia_speed *move, int64_t capacity, uint32_t *intervals, uint8_t *states) {
    int64_t made = 0;
    while (made < capacity && (intervals[made] = trochia_speed_step(move)) != 0)
        states[made++] = move->state;
    return made;
}

int64_t trochia_segment_intervals(trochia_segment_run *run, const trochia_tick_segment *segments, int64_t count,
                                  int64_t capacity, uint32_t *intervals) {
    int64_t made = 0;
    for (int64_t i = 0; i < count; i++) {
        trochia_segment_load(run, &segments[i]);
        while (run->phase && made < capacity)
            intervals[made++] = trochia_segment_step(run);
    }
    return made;
}
