/* Registers that belong to the step interrupt (line_isr.S); all C is compiled so that it leaves them alone.  GPIOR0's
 * bit 0 says that an entry which is no pulse is due next, bit 1 that a slot of the grid is, bit 2 that the beam may
 * shine; GPIOR1 is the pulses' width beyond the least, in three cycles, and one; GPIOR2 is the tail of the beam's
 * ring. */
#ifndef TROCHIA_REGISTERS_H
#define TROCHIA_REGISTERS_H

#include <stdint.h>

register uint8_t isr_pins __asm__("r2");     /* of the entry under way */
register uint8_t isr_fraction __asm__("r3"); /* of a tick, carried */
register uint8_t isr_add __asm__("r4");      /* interval: fraction, ticks */
register uint8_t isr_low __asm__("r5");
register uint8_t isr_high __asm__("r6");
register uint8_t isr_count __asm__("r7");   /* pulses or slots to come, the armed one included */
register uint8_t isr_at_low __asm__("r8");  /* compare value */
register uint8_t isr_at_high __asm__("r9"); /* r10: SREG; r12 to r15: for the interrupt's sums */
register uint8_t isr_tail __asm__("r11");   /* of the ring; of the slot, on the grid */

enum { MAY_SHINE = 2 };

#endif
