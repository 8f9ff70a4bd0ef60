/* Runs the shared core on request: the test writes arguments into memory, sets `request`, and reads `answers`.
 * B0 is up while the core works, so that cycles can be counted; every call rises B1. */
#include <avr/io.h>

#include "shared/interpolate.h"
#include "shared/ramp.h"
#include "shared/segment.h"
#include "shared/speed.h"

enum { ANSWERS = 160, ROWS = 6 };

volatile uint8_t request; /* 1 ramp, 2 move, 3 segments, 4 line, 5 arc; 0: done */
uint64_t squares[2];      /* C up, N0 or C down */
uint32_t counts[4];       /* steps up, at speed, down; interval at speed */
int32_t figure[6];        /* method and direction, then the ends */
trochia_tick_segment rows[ROWS];
uint8_t row_count;
uint16_t answered;
union {
    uint32_t interval[ANSWERS];
    uint8_t pulse[4 * ANSWERS];
} answers;

static trochia_ramp ramp;
static trochia_speed move;
static trochia_segment_run run;
static trochia_interpolator figure_run;

static inline void up(void) {
    PORTB |= 1;
}

static inline void down(void) {
    PORTB &= (uint8_t)~1;
}

static void run_ramp(void) {
    trochia_ramp_begin(&ramp, squares[0], squares[1]);
    for (uint32_t i = 0; i < counts[0] + counts[2]; i++) {
        up();
        uint32_t interval = i < counts[0] ? trochia_ramp_up(&ramp) : trochia_ramp_down(&ramp);
        down();
        answers.interval[answered++] = interval;
    }
}

static void run_move(void) {
    trochia_speed_begin(&move, squares[0], squares[1], counts[0], counts[1], counts[2], counts[3]);
    for (;;) {
        uint32_t interval = trochia_speed_step(&move);
        if (!interval)
            return;
        answers.interval[answered++] = interval;
    }
}

static void run_segments(void) {
    run = (trochia_segment_run){0};
    for (uint8_t i = 0; i < row_count; i++) {
        trochia_segment_load(&run, &rows[i]);
        while (run.phase) {
            up();
            uint32_t interval = trochia_segment_step(&run);
            down();
            answers.interval[answered++] = interval;
        }
    }
}

static void run_figure(void) {
    if (request == 4)
        trochia_line_begin(&figure_run, (uint8_t)figure[0], figure[2], figure[3]);
    else
        trochia_arc_begin(&figure_run, (uint8_t)figure[0], (uint8_t)figure[1], (int64_t)squares[0], figure[2],
                          figure[3], figure[4], figure[5]);
    while (trochia_moving(&figure_run) && answered < sizeof answers.pulse)
        answers.pulse[answered++] = trochia_interpolate_tick(&figure_run);
}

int main(void) {
    DDRB = 0xff;
    for (;;) {
        if (!request)
            continue;
        answered = 0;
        if (request == 1)
            run_ramp();
        else if (request == 2)
            run_move();
        else if (request == 3)
            run_segments();
        else
            run_figure();
        request = 0;
    }
}
