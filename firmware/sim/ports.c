/* Writes to the pin registers, which toggle outputs.  A set-bit instruction on one toggles that bit only; libsimavr 1.6
 * reads, sets and writes the whole register, and so toggles every pin that is high. */
#include "chip.h"

enum { SBI = 0x9a00, SBI_MASK = 0xff00, IO = 0x20 };

static struct {
    avr_io_write_t whole;
    void *param;
} pin_writes[256];

/* The bits that the instruction under way may touch in a register. */
static uint8_t touched(const avr_t *avr, avr_io_addr_t address) {
    uint16_t opcode = (uint16_t)(avr->flash[avr->pc] | avr->flash[avr->pc + 1] << 8);
    if ((opcode & SBI_MASK) != SBI || (opcode >> 3 & 31) + IO != address)
        return 0xff;
    return (uint8_t)(1u << (opcode & 7));
}

static void write_pins(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    pin_writes[address & 255].whole(avr, address, value & touched(avr, address), pin_writes[address & 255].param);
}

void ports_take(avr_t *avr, avr_ioport_t *port) {
    unsigned io = AVR_DATA_TO_IO(port->r_pin);
    if (port->r_pin > 0xff || !avr->io[io].w.c)
        return;
    pin_writes[port->r_pin].whole = avr->io[io].w.c;
    pin_writes[port->r_pin].param = avr->io[io].w.param;
    avr->io[io].w.c = write_pins;
}
