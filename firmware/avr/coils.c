#include "coils.h"

#include <avr/io.h>
#include <util/atomic.h>

#include "board.h"

enum { TURN = 64, QUARTER = 16, MOTORS = BOARD_MOTORS };
enum { DATA = 1 << 0, LATCH = 1 << 4 }; /* of port B */
enum { CLOCK = 1 << 4, OFF = 1 << 7 };  /* of port D */
enum { PHASES_1 = 1 << COM2A1 | 1 << COM2B1, PHASES_2 = 1 << COM0A1 | 1 << COM0B1 };

extern volatile uint8_t directions;

/* The register's bits of each sector: A+, A+ B+, B+, B+ A-, A-, A- B-, B-, B- A+. */
static const uint8_t sectors[MOTORS][8] = {
    {0x04, 0x06, 0x02, 0x0a, 0x08, 0x18, 0x10, 0x14},
    {0x20, 0x21, 0x01, 0x81, 0x80, 0xc0, 0x40, 0x60},
};
static const uint8_t others[MOTORS] = {0xe1, 0x1e}; /* the other motor's bits */

/* 255 sin(k 90 degrees / 16), rounded. */
static const uint8_t duties[QUARTER + 1] = {0,   25,  50,  74,  98,  120, 142, 162, 180,
                                            197, 212, 225, 236, 244, 250, 254, 255};

/* Positions from one step to the next, less one; and the first of them in a turn. */
static const uint8_t grids[4] = {15, 15, 7, 0}, firsts[4] = {0, 8, 0, 0};

static uint8_t positions[MOTORS], styles[MOTORS], image, enabled, released;

/* One bit: clock low, data, clock high. */
static inline __attribute__((always_inline)) void shift_bit(uint8_t bit) {
    PORTD &= (uint8_t)~CLOCK;
    PORTB &= (uint8_t)~DATA;
    if (bit)
        PORTB |= DATA;
    PORTD |= CLOCK;
}

static void shift_out(uint8_t byte) {
    PORTB &= (uint8_t)~LATCH;
    shift_bit(byte & 0x80);
    shift_bit(byte & 0x40);
    shift_bit(byte & 0x20);
    shift_bit(byte & 0x10);
    shift_bit(byte & 0x08);
    shift_bit(byte & 0x04);
    shift_bit(byte & 0x02);
    shift_bit(byte & 0x01);
    PORTB |= LATCH;
}

/* Puts a motor's duties, and its bits into the image. */
static inline __attribute__((always_inline)) void place(uint8_t motor) {
    uint8_t at = positions[motor], a = 255, b = 255;
    uint8_t sector = at >> 3;
    if (styles[motor] == 3) {
        uint8_t part = at & (QUARTER - 1);
        a = duties[QUARTER - part];
        b = duties[part];
        if (at & QUARTER) {
            uint8_t swapped = a;
            a = b;
            b = swapped;
        }
        sector = (uint8_t)((at >> 4 << 1) + (part != 0));
    }
    if (motor == 0) {
        OCR2A = a;
        OCR2B = b;
    } else {
        OCR0A = a;
        OCR0B = b;
    }
    image = (uint8_t)((image & others[motor]) | sectors[motor][sector]);
}

void coils_setup(void) {
    TCCR2A = TCCR0A = 1 << WGM01 | 1 << WGM00; /* fast PWM, 62.5 kHz, not at the pins yet; alike in both timers */
    TCCR2B = TCCR0B = 1 << CS00;
    shift_out(0);
    PORTD &= (uint8_t)~OFF;
}

void coils_enable(uint8_t on) {
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        enabled = on;
        image = 0;
        if (on && !(released & 1))
            place(0);
        if (on && !(released & 2))
            place(1);
        shift_out(image);
        TCCR2A = (uint8_t)((on ? PHASES_1 : 0) | 1 << WGM21 | 1 << WGM20);
        TCCR0A = (uint8_t)((on ? PHASES_2 : 0) | 1 << WGM01 | 1 << WGM00);
    }
}

void coils_mode(uint8_t outputs) {
    uint8_t newly = (uint8_t)(outputs >> 6 & ~released), shown = image;
    released = outputs >> 6;
    styles[0] = outputs >> 2 & 3;
    styles[1] = outputs >> 4 & 3;
    for (uint8_t i = 0; i < MOTORS; i++) {
        if (newly & 1 << i)
            shown &= others[i];
    }
    if (newly && enabled) {
        image = shown;
        shift_out(image);
    }
}

/* Moves a motor on, and shows it unless it is released. */
static inline __attribute__((always_inline)) void step(uint8_t motor, uint8_t back) {
    uint8_t style = styles[motor], grid = grids[style], first = firsts[style];
    uint8_t from = (uint8_t)(positions[motor] - first);
    if (back)
        from = (uint8_t)(((from + grid) & ~grid) - grid - 1);
    else
        from = (uint8_t)((from & ~grid) + grid + 1);
    positions[motor] = (uint8_t)(from + first) & (TURN - 1);
    if (!(released & 1 << motor))
        place(motor);
}

void coils_step(uint8_t motors) {
    uint8_t back = directions;
    if (motors & 1)
        step(0, back & 1);
    if (motors & 2)
        step(1, back & 2);
    if (enabled)
        shift_out(image);
}
