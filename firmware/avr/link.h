/* The line to the host: bytes in and out by interrupts, frames and orders in between. */
#ifndef TROCHIA_LINK_H
#define TROCHIA_LINK_H

#include <stdint.h>

void link_setup(uint8_t reset_flags);

/* Takes a few bytes that have come, and sends what is to be sent. */
void link_work(void);

#endif
