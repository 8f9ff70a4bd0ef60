/* Windings of two motors on the shield.
 *
 * In: steps; how the windings are excited.  Out: the register's byte, and the duty of the bridges.  A motor's position
 * counts sixty-fourths of an electrical turn, eight to a sector: one phase is on in even sectors, both in odd ones, so
 * a step in another way of excitation first falls in with its own sectors.
 *
 * Of a board's outputs, bits 2 and 3 are motor 1's excitation, 4 and 5 motor 2's: 0 one phase, 1 both phases, 2 half
 * steps, 3 sixteenths of a step.  Bit 6, 7: motor 1, 2 is released: both ends of its windings low.  A motor that is
 * released no longer is energised by its next step. */
#ifndef TROCHIA_COILS_H
#define TROCHIA_COILS_H

#include <stdint.h>

/* Bridges off, register empty. */
void coils_setup(void);

/* Bridges on, at the motors' places; or off: the windings are open and the register is empty. */
void coils_enable(uint8_t on);

/* Takes up bits 2 … 7. */
void coils_mode(uint8_t outputs);

/* A step of each motor in `motors`, in its direction; with interrupts off. */
void coils_step(uint8_t motors);

#endif
