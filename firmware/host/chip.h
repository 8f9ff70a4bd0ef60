/* The firmware's C on this computer, for campaigns that are too long for a simulated processor.
 *
 * hardware.c does what the chip's hardware and the assembler files do: registers, the serial port, the step interrupt.
 * main.c obeys the same requests as the simulated chip (firmware/sim/main.c). */
#ifndef TROCHIA_HOST_CHIP_H
#define TROCHIA_HOST_CHIP_H

#include "../sim/requests.h"

extern uint64_t cycle; /* since reset */

void chip_reset(void);
void chip_run(uint64_t until);

/* Bytes to the serial port; how many have not arrived yet. */
void chip_feed(const uint8_t *bytes, uint32_t count);
uint32_t chip_unread(void);

void chip_set_pin(uint8_t port, uint8_t pin, uint8_t level);

/* A register by its address in data memory, where it is one that tests look at. */
uint8_t chip_register(uint16_t address);

#endif
