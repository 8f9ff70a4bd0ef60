/* The serial port as the chip has it: ten bit times a byte, a receiver that holds two bytes, a transmitter with a shift
 * register and one byte behind it. */
#include "chip.h"

#include <stdlib.h>
#include <string.h>

enum { U2X = 1, BITS_KEPT = 3, TXC = 6, DOR = 3 }; /* of UCSRnA; bits 0 and 1 are the ones a program may set */

static uint64_t byte_time(const serial *unit) {
    const avr_uart_t *port = unit->port;
    const uint8_t *data = unit->avr->data;
    uint32_t divider = 1u + data[port->ubrrl.reg] + ((data[port->ubrrh.reg] & 0xfu) << 8);
    return 10ull * divider * (data[port->r_ucsra] >> U2X & 1 ? 8 : 16);
}

static avr_cycle_count_t arrive(avr_t *avr, avr_cycle_count_t when, void *param);

/* The next byte's start bit, where there is one and none is on the line. */
static void begin_next(serial *unit) {
    byte_queue *coming = &unit->coming;
    if (unit->arriving || coming->head == coming->tail)
        return;
    uint64_t now = unit->avr->cycle, start = coming->not_before[coming->head];
    start = start > now ? start : now;
    start = start > unit->arrives ? start : unit->arrives;
    unit->arriving = true;
    unit->arrives = start + byte_time(unit);
    avr_cycle_timer_register(unit->avr, unit->arrives - now, arrive, unit);
}

static avr_cycle_count_t arrive(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)when;
    serial *unit = param;
    uint8_t byte = unit->coming.bytes[unit->coming.head++];
    unit->arriving = false;
    if (!avr_regbit_get(avr, unit->port->rxen)) {
        record(unit->arrives, EVENT_LOST, (uint8_t)unit->port->name, 0, 1);
    } else if (unit->held == FIFO) {
        avr->data[unit->port->r_ucsra] |= 1 << DOR;
        record(unit->arrives, EVENT_LOST, (uint8_t)unit->port->name, 0, 0);
    } else {
        unit->fifo[unit->held++] = byte;
        avr_raise_interrupt(avr, &unit->port->rxc);
    }
    begin_next(unit);
    return 0;
}

static uint8_t read_data(avr_t *avr, avr_io_addr_t address, void *param) {
    serial *unit = param;
    uint8_t byte = unit->fifo[0];
    avr->data[unit->port->r_ucsra] &= (uint8_t)~(1 << DOR);
    if (unit->held) {
        unit->fifo[0] = unit->fifo[1];
        unit->held--;
    }
    avr_clear_interrupt(avr, &unit->port->rxc);
    avr_regbit_clear(avr, unit->port->rxc.raised);
    if (unit->held)
        avr_raise_interrupt(avr, &unit->port->rxc);
    avr->data[address] = byte;
    return byte;
}

static avr_cycle_count_t shifted(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)when;
    serial *unit = param;
    record(unit->shifting_until, EVENT_BYTE, (uint8_t)unit->port->name, 0, unit->shifting);
    unit->sends = unit->waits;
    if (unit->waits) {
        unit->waits = false;
        unit->shifting = unit->waiting;
        unit->shifting_until += byte_time(unit);
        avr_cycle_timer_register(avr, unit->shifting_until - avr->cycle, shifted, unit);
        avr_raise_interrupt(avr, &unit->port->udrc);
    } else {
        avr_raise_interrupt(avr, &unit->port->txc);
    }
    return 0;
}

static void write_data(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)address;
    serial *unit = param;
    if (!avr_regbit_get(avr, unit->port->txen) || unit->waits)
        return; /* as the chip: a byte written where there is no room is not sent */
    avr_clear_interrupt(avr, &unit->port->udrc);
    if (unit->sends) {
        unit->waits = true;
        unit->waiting = value;
        avr_regbit_clear(avr, unit->port->udrc.raised);
        return;
    }
    unit->sends = true;
    unit->shifting = value;
    unit->shifting_until = avr->cycle + byte_time(unit);
    avr_cycle_timer_register(avr, byte_time(unit), shifted, unit);
    avr_raise_interrupt(avr, &unit->port->udrc);
}

static uint8_t read_status(avr_t *avr, avr_io_addr_t address, void *param) {
    (void)param;
    return avr->data[address];
}

static void write_status(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    serial *unit = param;
    uint8_t kept = (uint8_t)(avr->data[address] & ~BITS_KEPT);
    if (value >> TXC & 1) {
        kept &= (uint8_t)~(1 << TXC);
        avr_clear_interrupt(avr, &unit->port->txc);
    }
    avr->data[address] = (uint8_t)(kept | (value & BITS_KEPT));
}

/* An interrupt switched on while its flag is up comes at once: these flags are levels. */
static void write_control(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    serial *unit = param;
    avr->data[address] = value;
    if (!avr_regbit_get(avr, unit->port->rxen))
        unit->held = 0;
    if (avr_regbit_get(avr, unit->port->rxc.enable) && unit->held)
        avr_raise_interrupt(avr, &unit->port->rxc);
    if (avr_regbit_get(avr, unit->port->udrc.enable) && avr_regbit_get(avr, unit->port->udrc.raised))
        avr_raise_interrupt(avr, &unit->port->udrc);
}

void serial_take(serial *unit, avr_t *avr, avr_uart_t *port) {
    memset(unit, 0, sizeof *unit);
    unit->avr = avr;
    unit->port = port;
    avr->io[AVR_DATA_TO_IO(port->r_udr)].r.c = read_data;
    avr->io[AVR_DATA_TO_IO(port->r_udr)].r.param = unit;
    avr->io[AVR_DATA_TO_IO(port->r_udr)].w.c = write_data;
    avr->io[AVR_DATA_TO_IO(port->r_udr)].w.param = unit;
    avr->io[AVR_DATA_TO_IO(port->r_ucsra)].r.c = read_status;
    avr->io[AVR_DATA_TO_IO(port->r_ucsra)].w.c = write_status;
    avr->io[AVR_DATA_TO_IO(port->r_ucsra)].w.param = unit;
    avr->io[AVR_DATA_TO_IO(port->r_ucsrb)].w.c = write_control;
    avr->io[AVR_DATA_TO_IO(port->r_ucsrb)].w.param = unit;
    avr_regbit_set(avr, port->udrc.raised);
}

void serial_feed(serial *unit, const uint8_t *bytes, uint32_t count, uint64_t not_before) {
    byte_queue *coming = &unit->coming;
    if (coming->head == coming->tail)
        coming->head = coming->tail = 0;
    if (coming->tail + count > coming->room) {
        coming->room = 2 * (coming->tail + count);
        coming->bytes = realloc(coming->bytes, coming->room);
        coming->not_before = realloc(coming->not_before, coming->room * sizeof *coming->not_before);
        if (!coming->bytes || !coming->not_before)
            abort();
    }
    for (uint32_t i = 0; i < count; i++) {
        coming->bytes[coming->tail] = bytes[i];
        coming->not_before[coming->tail++] = not_before;
    }
    begin_next(unit);
}

uint32_t serial_left(const serial *unit) {
    return unit->coming.tail - unit->coming.head;
}
