#include "host/interpolate.h"

int64_t trochia_interpolate(trochia_interpolator *ip, int64_t capacity, uint8_t *pulses) {
    int64_t made = 0;
    while (made < capacity && trochia_moving(ip))
        pulses[made++] = trochia_interpolate_tick(ip);
    return made;
}

int64_t trochia_interpolate_over(const trochia_interpolator *begun, int64_t times) {
    int64_t sum = 0;
    for (int64_t i = 0; i < times; i++) {
        trochia_interpolator ip = *begun;
        while (trochia_moving(&ip))
            sum += trochia_interpolate_tick(&ip);
    }
    return sum;
}

void trochia_begin_line(trochia_interpolator *ip, uint8_t method, int32_t x, int32_t y) {
    trochia_line_begin(ip, method, x, y);
}

void trochia_begin_arc(trochia_interpolator *ip, uint8_t method, uint8_t clockwise, int64_t radius2, int32_t x0,
                       int32_t y0, int32_t x1, int32_t y1) {
    trochia_arc_begin(ip, method, clockwise, radius2, x0, y0, x1, y1);
}
