/* What the hardware and the firmware's assembler files do; each function names the one it stands for. */
#include "chip.h"

#include <stdlib.h>
#include <string.h>

#include "frames.h"
#include "link.h"
#include "motion_parts.h"

enum { TURN = 400, WIDTH = 24, SEND = 64, BITS = 10, DIVIDER = 8, PULLED_UP_B = 6, PULLED_UP_C = 0x27 };
enum { ACTS = 1, GRID = 2, BEAM_MODE_ADDRESS = 0xb0 };

volatile uint8_t PINB, PINC, PIND, PORTB, PORTC, PORTD, DDRB, DDRC, DDRD;
volatile uint8_t PCMSK0, PCMSK1, PCICR, TCCR1B, TCCR2A, TCCR2B, OCR2A, TIMSK1, TIFR1;
volatile uint8_t UCSR0A, UCSR0B, UDR0, GPIOR0, GPIOR1, GPIOR2, TCNT2;
volatile uint16_t TCNT1, OCR1A, OCR1B, UBRR0;
uint8_t isr_pins __asm__("r2"), isr_fraction __asm__("r3"), isr_add __asm__("r4"), isr_low __asm__("r5");
uint8_t isr_high __asm__("r6"), isr_count __asm__("r7"), isr_at_low __asm__("r8"), isr_at_high __asm__("r9");
uint8_t isr_tail __asm__("r11");

extern volatile uint8_t send_next, send_end;
extern uint8_t sending[SEND];
extern volatile uint16_t overflows;
extern volatile uint8_t beam_head;
void line_act(void);
void PCINT0_vect(void);
void slots_count(uint8_t place, uint8_t slots, uint8_t *counts);

uint64_t cycle;
static uint64_t turn, due, arrives, leaves; /* the main program's next turn, the next match, a byte in, a byte out */
static uint8_t armed, sends, inputs_b, levels_b, levels_c, levels_d;
static uint8_t *coming;
static uint32_t head, tail, room;

/* rows.S, grid.S, frame.S: the shared C does the same. */

uint8_t frame_run(trochia_frame_in *in, uint8_t most) {
    while (most-- && received_tail != received_head) {
        uint8_t event = trochia_frame_take(in, received[received_tail]);
        received_tail = (uint8_t)(received_tail + 1) & (RECEIVE - 1);
        if (event != TROCHIA_NOTHING)
            return event;
    }
    return TROCHIA_NOTHING;
}

uint8_t row_full(trochia_motor *motor, trochia_row *row) {
    (void)motor, (void)row;
    return 0;
}

uint8_t row_brisk(trochia_motor *motor, trochia_row *row) {
    return row_full(motor, row);
}

uint8_t row_place(trochia_row *row, uint8_t most) {
    return trochia_row_place(&line, row, most);
}

uint8_t slots_pack(uint8_t to, uint8_t from, uint8_t slots) {
    return trochia_slots_pack(&line, to, from, slots);
}

void run_bend(void *run) {
    trochia_segment_bend(run);
}

void row_clear(uint8_t from, uint8_t slots) {
    trochia_row_clear(&line, from, slots);
}

void slots_count(uint8_t place, uint8_t slots, uint8_t *counts) {
    memset(counts, 0, 7);
    for (uint8_t i = 0; i < slots; i++) {
        uint8_t pins = step_ring[(uint8_t)(place + i)];
        for (uint8_t bit = 1; bit < 8 && !(pins & 1); bit++)
            counts[bit - 1] = (uint8_t)(counts[bit - 1] + (pins >> bit & 1));
    }
}

/* Tells what has changed at a port's outputs. */
static void compare(uint8_t port, uint8_t *was, uint8_t is) {
    for (uint8_t pin = 0; pin < 8; pin++) {
        if ((*was ^ is) >> pin & 1)
            record(cycle, EVENT_PIN, port, pin, is >> pin & 1);
    }
    *was = is;
}

static void look_at_ports(void) {
    PORTD = (uint8_t)(PORTD ^ PIND);
    if (PINB == 1 << 5) /* the fourth motor turns: all else that is there is inputs */
        PORTB = (uint8_t)(PORTB ^ 1 << 5);
    PIND = 0;
    PINB = inputs_b;
    compare('B', &levels_b, PORTB);
    compare('C', &levels_c, PORTC);
    compare('D', &levels_d, PORTD);
}

/* line_isr.S */

static void raise(uint8_t pins) {
    for (uint8_t i = 0; i < BOARD_MOTORS; i++) {
        uint8_t fourth = board_bits[i] == BOARD_FOURTH;
        if (!(pins & board_pins[i]))
            continue;
        record(cycle, EVENT_PIN, fourth ? 'B' : 'D', fourth ? 4 : board_bits[i], 1);
        record(cycle + WIDTH, EVENT_PIN, fourth ? 'B' : 'D', fourth ? 4 : board_bits[i], 0);
    }
}

static void go_to(uint32_t ticks) {
    uint16_t at = (uint16_t)((uint16_t)(isr_at_low | isr_at_high << 8) + ticks);
    isr_at_low = (uint8_t)at;
    isr_at_high = (uint8_t)(at >> 8);
    due += ticks;
}

static void load(void) {
    uint8_t entry[8];
    if (step_head == isr_tail) {
        TIMSK1 &= (uint8_t)~(1 << OCIE1A | 1 << OCIE1B);
        step_on = 0;
        return;
    }
    for (uint8_t i = 0; i < 8; i++)
        entry[i] = step_ring[(uint8_t)(isr_tail + i)];
    go_to((uint32_t)(entry[0] | entry[1] << 8));
    isr_pins = entry[2];
    isr_count = entry[3];
    if (isr_count == 0 && isr_pins & TROCHIA_GRID) {
        GPIOR0 |= GRID;
        isr_count = isr_pins & 0x7f;
        isr_tail = (uint8_t)(isr_tail + 4);
    } else if (isr_count == 0) {
        GPIOR0 |= ACTS; /* it stays in the ring until it is done */
        isr_pins = 0;
        isr_count = 1;
    } else if (isr_count == 1) {
        isr_tail = (uint8_t)(isr_tail + 4);
    } else {
        isr_low = entry[4], isr_high = entry[5], isr_add = entry[6], isr_fraction = entry[7];
        isr_tail = (uint8_t)(isr_tail + 8);
    }
}

static void grid(void) {
    raise(step_ring[isr_tail++]);
    if (--isr_count == 0) {
        GPIOR0 &= (uint8_t)~GRID;
        isr_tail = (uint8_t)((isr_tail + 3) & ~3);
        load();
        return;
    }
    uint8_t next = step_ring[isr_tail];
    if (next & 1) {
        isr_tail++;
        isr_count--;
    }
    go_to(TROCHIA_SLOT * (1u + (next & 1 ? next >> 1 : 0)));
}

static void act(void) {
    uint8_t kind = step_ring[(uint8_t)(isr_tail + 2)], full = step_ring[(uint8_t)(isr_tail + 4)];
    GPIOR0 &= (uint8_t)~ACTS;
    if (kind == TROCHIA_MARK) {
        slice_since = (uint16_t)(isr_at_low | isr_at_high << 8);
        slice_done++;
        isr_tail = (uint8_t)(isr_tail + 8);
    } else if (kind == TROCHIA_FULLY && !full) {
        GPIOR0 &= (uint8_t)~(1 << MAY_SHINE);
        board_beam(0);
        isr_tail = (uint8_t)(isr_tail + 8);
    } else {
        PINB = 0; /* what is written to it toggles outputs; nobody reads inputs here */
        line_act();
        look_at_ports();
    }
    load();
}

static void match(void) {
    if (GPIOR0 & GRID) {
        grid();
        return;
    }
    raise(isr_pins);
    if (--isr_count) {
        uint32_t fraction = (uint32_t)isr_fraction + isr_add;
        isr_fraction = (uint8_t)fraction;
        go_to((uint32_t)(isr_low | isr_high << 8) + (fraction >> 8));
    } else if (GPIOR0 & ACTS) {
        act();
    } else {
        load();
    }
}

/* Changes of the beam's power that are due. */
static void shine(void) {
    while (TIMSK1 >> OCIE1B & 1 && (uint16_t)(TCNT1 - OCR1B) < TROCHIA_SLICE / 2) {
        const uint8_t *entry = step_ring + 256 + GPIOR2;
        span_power = entry[2 * BEAMS];
        board_beam(GPIOR0 >> MAY_SHINE & 1 ? span_power : 0);
        GPIOR2 = (GPIOR2 + 1) & (BEAMS - 1);
        entry = step_ring + 256 + GPIOR2;
        OCR1B = (uint16_t)(entry[0] | entry[BEAMS] << 8);
        if (GPIOR2 == beam_head)
            TIMSK1 &= (uint8_t)~(1 << OCIE1B);
    }
}

/* line_io.S */

static uint64_t byte_time(void) {
    return (uint64_t)BITS * DIVIDER * (UBRR0 + 1u);
}

static void arrive(void) {
    uint8_t byte = coming[head++];
    received[received_head] = byte;
    received_head = (uint8_t)((received_head + 1) & (RECEIVE - 1));
    if (byte == 0) {
        noted_at = TCNT1;
        noted_since = slice_since;
        noted_slice = slice_done;
    }
    arrives = cycle + byte_time();
}

static void leave(void) {
    record(cycle, EVENT_BYTE, '0', 0, UDR0);
    sends = send_next != send_end;
    if (sends) {
        UDR0 = sending[send_next++];
        leaves = cycle + byte_time();
    } else {
        UCSR0B &= (uint8_t)~(1 << TXCIE0);
    }
}

/* What begins by what the main program has written to registers. */
static void look_at_registers(void) {
    uint8_t is = TIMSK1 >> OCIE1A & 1;
    if (is && !armed)
        due = cycle + (uint16_t)(OCR1A - TCNT1);
    armed = is;
    if (!sends && UCSR0B >> TXCIE0 & 1) {
        sends = 1;
        leaves = cycle + byte_time();
    }
    TIFR1 = 0;
    look_at_ports();
}

static uint64_t least(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

void chip_run(uint64_t until) {
    while (cycle < until) {
        uint64_t next = least(until, turn);
        if (armed)
            next = least(next, due);
        if (sends)
            next = least(next, leaves);
        if (head != tail)
            next = least(next, arrives > cycle ? arrives : cycle);
        cycle = next;
        TCNT1 = (uint16_t)cycle;
        overflows = (uint16_t)(cycle >> 16);
        if (armed && cycle == due)
            match();
        shine();
        if (head != tail && cycle >= arrives)
            arrive();
        if (sends && cycle == leaves)
            leave();
        if (cycle == turn) {
            turn += TURN;
            link_work();
            motion_work();
        }
        look_at_registers();
    }
}

void chip_reset(void) {
    PINB = inputs_b = PULLED_UP_B;
    PINC = PULLED_UP_C;
    turn = TURN;
    board_setup();
    levels_b = levels_c = levels_d = 0;
    look_at_ports();
    motion_setup();
    link_setup(0);
}

void chip_feed(const uint8_t *bytes, uint32_t count) {
    if (head == tail) {
        head = tail = 0;
        arrives = (arrives > cycle ? arrives : cycle) + byte_time();
    }
    if (tail + count > room) {
        room = 2 * (tail + count);
        coming = realloc(coming, room);
        if (!coming)
            abort();
    }
    memcpy(coming + tail, bytes, count);
    tail += count;
}

uint32_t chip_unread(void) {
    return tail - head;
}

void chip_set_pin(uint8_t port, uint8_t pin, uint8_t level) {
    if (port == 'B')
        PINB = inputs_b = (uint8_t)((inputs_b & ~(1 << pin)) | level << pin);
    if (port == 'C')
        PINC = (uint8_t)((PINC & ~(1 << pin)) | level << pin);
    PCINT0_vect();
    look_at_registers();
}

uint8_t chip_register(uint16_t address) {
    return address == BEAM_MODE_ADDRESS ? TCCR2A : 0;
}
