/* Arduino Uno (ATmega328P) under the motor shield with two L293D bridges behind one 74HCT595 shift register: two
 * stepping motors, whose windings the chip drives itself (coils.h).
 *
 *   register     data D8, clock D4, latch D12, outputs on when low D7
 *   bridges      motor 1: phase A D11, phase B D3      motor 2: phase A D6, phase B D5
 *   beam         D10, on or off (on from half power)   outputs 0, 1   D9 D2
 *   inputs 0 … 5 A0 … A5, with pull-ups
 *
 * Bits 2 … 7 of the outputs say how the windings are driven, see coils.h.  An entry's pin bits are motors, from bit 1
 * on. */
#ifndef TROCHIA_BOARD_H
#define TROCHIA_BOARD_H

#define BOARD_MOTORS 2
#define BOARD_INPUTS 6
#define BOARD_OUTPUTS 2
#define BOARD_QUEUE 512
#define BEAM_PORT PORTB
#define BEAM_PIN 2
#define BOARD_COILS 1 /* a pulse is a call of coils_step */

#ifndef __ASSEMBLER__
#include <avr/io.h>

#include "coils.h"

static const char board_name[12] = "uno-l293d";
static const uint8_t board_pins[BOARD_MOTORS] = {1 << 1, 1 << 2};
static const uint8_t board_bits[BOARD_MOTORS] = {1, 2}; /* the same, counted */

static inline void board_setup(void) {
    PORTD = 1 << 0 | 1 << 7; /* the register's outputs off, the bridges off */
    DDRD = 1 << 2 | 1 << 3 | 1 << 4 | 1 << 5 | 1 << 6 | 1 << 7;
    PORTB = 0;
    DDRB = 1 << 0 | 1 << 1 | 1 << 2 | 1 << 3 | 1 << 4;
    PORTC = 0x3f; /* pull-ups */
    PCMSK1 = 0x3f;
    PCICR = 1 << PCIE1;
    coils_setup();
}

static inline void board_enable(uint8_t on) {
    coils_enable(on);
}

/* Motors whose direction changes: a step asks which it is. */
static inline void board_turn(uint8_t motors) {
    (void)motors;
}

static inline uint8_t board_inputs(void) {
    return PINC & 0x3f;
}

static inline void board_outputs(uint8_t levels) {
    coils_mode(levels);
    if (levels & 1)
        PORTB |= 1 << 1;
    else
        PORTB &= (uint8_t)~(1 << 1);
    if (levels & 2)
        PORTD |= 1 << 2;
    else
        PORTD &= (uint8_t)~(1 << 2);
}

/* The beam: both timers that could dim it drive the bridges. */
static inline void board_beam(uint8_t power) {
    if (power >= 128)
        PORTB |= 1 << 2;
    else
        PORTB &= (uint8_t)~(1 << 2);
}

static inline uint8_t board_beam_power(void) {
    return PORTB & 1 << 2 ? 255 : 0;
}
#endif

#endif
