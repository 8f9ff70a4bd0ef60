/* Arduino Uno (ATmega328P) with step/direction drivers, wired as the common three-axis shield is; the fourth driver's
 * step and direction are on D12 and D13.
 *
 *   step X Y Z    D2 D3 D4     direction X Y Z    D5 D6 D7      A: D12, D13     enable (low: on)    D8
 *   beam          D11, PWM     outputs 0, 1       A3 A4
 *   inputs 0 … 5  D9, D10, A0, A1, A2, A5, with pull-ups
 *
 * An entry's pin bits are those of port D; its bit 1, the serial port's own pin, stands for the fourth motor. */
#ifndef TROCHIA_BOARD_H
#define TROCHIA_BOARD_H

#define BOARD_MOTORS 4
#define BOARD_INPUTS 6
#define BOARD_OUTPUTS 2
#define BOARD_QUEUE 592
#define BOARD_STEPS PIND
#define BOARD_FOURTH 1 /* bit of an entry */
#define BEAM_DUTY OCR2A
#define BEAM_MODE TCCR2A
#define BEAM_COUNT TCNT2
#define BEAM_ON (1 << COM2A1 | 1 << WGM21 | 1 << WGM20)

#ifndef __ASSEMBLER__
#include <avr/io.h>

static const char board_name[12] = "uno-stepdir";
static const uint8_t board_pins[BOARD_MOTORS] = {1 << 2, 1 << 3, 1 << 4, 1 << BOARD_FOURTH};
static const uint8_t board_bits[BOARD_MOTORS] = {2, 3, 4, BOARD_FOURTH}; /* the same, counted */

static inline void board_setup(void) {
    PORTB = 1 << 0 | 1 << 1 | 1 << 2; /* drives off; pull-ups */
    DDRB = 1 << 0 | 1 << 3 | 1 << 4 | 1 << 5;
    PORTC = 1 << 0 | 1 << 1 | 1 << 2 | 1 << 5;
    DDRC = 1 << 3 | 1 << 4;
    PORTD = 1 << 0;
    DDRD = 0xfc;
    PCMSK0 = 1 << 1 | 1 << 2;
    PCMSK1 = 1 << 0 | 1 << 1 | 1 << 2 | 1 << 5;
    PCICR = 1 << PCIE0 | 1 << PCIE1;
    TCCR2B = 1 << CS20;
}

static inline void board_enable(uint8_t on) {
    if (on)
        PORTB &= (uint8_t)~(1 << 0);
    else
        PORTB |= 1 << 0;
}

/* Motors whose direction changes. */
static inline void board_turn(uint8_t motors) {
    PIND = (uint8_t)((motors & 7) << 5);
    if (motors & 8)
        PINB = 1 << 5;
}

static inline uint8_t board_inputs(void) {
    uint8_t b = PINB, c = PINC;
    return (uint8_t)((b >> 1 & 3) | (c & 7) << 2 | (c & 1 << 5));
}

static inline void board_outputs(uint8_t levels) {
    PORTC = (uint8_t)((PORTC & ~(3 << 3)) | (levels & 3) << 3);
}

/* The beam's power, 0 … 255, by fast PWM of timer 2 on D11; a period begins with it, so that it is there at once. */
static inline void board_beam(uint8_t power) {
    if (power) {
        OCR2A = power;
        TCCR2A = BEAM_ON;
        TCNT2 = 255;
    } else {
        TCCR2A = 0; /* the pin is the port's again, and that is low */
    }
}

static inline uint8_t board_beam_power(void) {
    return TCCR2A ? OCR2A : 0;
}
#endif

#endif
