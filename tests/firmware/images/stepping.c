/* The step interrupt on a table of segments in memory.  D2 step, D3 direction, B0 rises when a step is late by its own
 * interval.  The test fills the table, then sets `go`; the first interval begins 1,000 cycles later, at B1's edge. */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "shared/segment.h"

enum { ROWS = 64, STEP = 1 << 2, DIRECTION = 1 << 3 };

_Static_assert(__builtin_offsetof(trochia_segment_run, fraction) == 4, "step_isr.S relies on it");
_Static_assert(__builtin_offsetof(trochia_segment_run, left) == 8, "step_isr.S relies on it");
_Static_assert(__builtin_offsetof(trochia_segment_run, add) == 12, "step_isr.S relies on it");
_Static_assert(__builtin_offsetof(trochia_segment_run, add2_low) == 22, "step_isr.S relies on it");

volatile uint8_t go;
trochia_tick_segment rows[ROWS];
uint8_t row_count;

trochia_segment_run step_run, step_next;
uint8_t step_pulse;
volatile uint8_t step_ready;
static volatile uint8_t row;
static uint8_t turns, flags, ending;

uint8_t step_load(void);
uint8_t step_whole(void);

static inline uint8_t gone_by(void) {
    if (turns || (int16_t)(OCR1A - TCNT1) >= 0)
        return 0;
    PORTB |= 1;
    return 1;
}

/* The next segment, while the last step of the one before is still to come with its own direction. */
static inline void load(void) {
    if (step_ready) {
        uint8_t fraction = step_run.fraction;
        step_run = step_next;
        step_run.fraction = fraction;
        step_ready = 0;
    } else if (row == row_count) {
        ending = 1;
        GPIOR0 = 1;
        return;
    } else {
        trochia_segment_load(&step_run, &rows[row++]);
    }
    GPIOR0 = step_run.interval >> 24 || step_run.flags != flags;
}

uint8_t step_load(void) {
    load();
    return gone_by();
}

uint8_t step_whole(void) {
    if (turns) {
        turns--;
        return 0;
    }
    PIND = step_pulse;
    if (ending) {
        TIMSK1 = 0;
        PIND = step_pulse;
        return 0;
    }
    uint32_t ticks = trochia_segment_step(&step_run);
    OCR1A += (uint16_t)ticks;
    turns = (uint8_t)(ticks >> 16);
    PIND = step_pulse;
    flags = step_run.flags;
    step_pulse = flags & TROCHIA_SEGMENT_PAUSE ? 0 : STEP;
    if (flags & TROCHIA_SEGMENT_BACKWARDS)
        PORTD |= DIRECTION;
    else
        PORTD &= (uint8_t)~DIRECTION;
    GPIOR0 = turns || step_run.interval >> 24;
    if (!step_run.phase)
        load();
    if (turns)
        GPIOR0 = 1;
    return gone_by();
}

int main(void) {
    DDRB = DDRD = 0xff;
    while (!go)
        ;
    load();
    GPIOR0 = 1; /* the first interrupt begins the first interval, without a pulse */
    TCCR1B = 1 << CS10;
    OCR1A = (uint16_t)(TCNT1 + 1000);
    TIFR1 = 1 << OCF1A;
    TIMSK1 = 1 << OCIE1A;
    PORTB |= 2;
    sei();
    for (;;) { /* lays the next segment ready, unless the interrupt was quicker */
        uint8_t next = row;
        if (step_ready || next == row_count)
            continue;
        trochia_segment_load(&step_next, &rows[next]);
        cli();
        if (row == next) {
            row++;
            step_ready = 1;
        }
        sei();
    }
}
