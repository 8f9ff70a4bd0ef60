#include "link.h"

#include <avr/interrupt.h>
#include <string.h>

#include "frames.h"
#include "motion.h"
#include "registers.h"

#ifndef BAUD
#define BAUD 115200
#endif

enum { BYTES_A_TURN = 24, SEND = 64 };

_Static_assert(__builtin_offsetof(trochia_frame_in, bytes) == 6, "frame.S relies on it");
_Static_assert(LARGEST == sizeof(trochia_span) + (LARGEST - 12) / 20 * sizeof(trochia_part), "so does frames.h");
_Static_assert(TROCHIA_CRC_WHOLE == 0xf0b8, "and this");
enum { SEND_ACK = 1, SEND_STATUS = 2, SEND_ANSWER = 4, SEND_ROOM = 8 };

extern uint16_t silent_slices;

volatile uint8_t received[RECEIVE], received_head;
uint8_t received_tail;
uint8_t sending[SEND];
volatile uint8_t send_next, send_end;
static trochia_frame_in in;
static uint8_t expected, greeted, session, wanted, reset_by, cramped; /* the host thinks that there is no room */

void link_setup(uint8_t reset_flags) {
    reset_by = reset_flags;
    UBRR0 = (F_CPU + BAUD * 4UL) / (8UL * BAUD) - 1;
    UCSR0A = 1 << U2X0;
    UCSR0B = 1 << RXEN0 | 1 << TXEN0 | 1 << RXCIE0;
    trochia_frame_reset(&in);
}

/* Bytes of memory that nothing has written since reset (main.c paints it). */
extern uint8_t _end;
static uint16_t never_used(void) {
    const uint8_t *at = &_end;
    while (at < (uint8_t *)RAMEND && *at == 0xa5)
        at++;
    return (uint16_t)(at - &_end);
}

/* Where a payload is made: it is stuffed where it stands, because no byte of a frame goes further back. */
#define MADE (sending + 3)

/* Makes a frame of the payload that stands there, and begins to send it. */
static void put(uint8_t type, uint8_t size) {
    trochia_frame_out out;
    trochia_frame_begin(&out, sending, 0, type);
    for (uint8_t i = 0; i < size; i++) {
        trochia_frame_put(&out, MADE[i]);
        if (i % 16 == 15)
            motion_fill(); /* it may not wait that long */
    }
    send_end = trochia_frame_end(&out);
    send_next = 1;
    UCSR0A = 1 << U2X0 | 1 << TXC0; /* clears the flag */
    UCSR0B |= 1 << TXCIE0;
    UDR0 = sending[0];
}

static void answer(void) {
    trochia_answer *told = (trochia_answer *)MADE;
    told->schema = SCHEMA;
    told->clock = F_CPU;
    told->room = BOARD_QUEUE;
    told->free = never_used();
    told->motors = BOARD_MOTORS;
    told->inputs = BOARD_INPUTS;
    told->outputs = BOARD_OUTPUTS;
    told->reset = reset_by;
    told->session = session;
    told->expected = expected;
    told->payload = LARGEST;
    told->reserved = 0;
    memcpy(told->board, board_name, sizeof told->board);
}

static void send(void) {
    if (wanted & SEND_ANSWER) {
        wanted &= (uint8_t)~SEND_ANSWER;
        answer();
        put(TROCHIA_ANSWER, sizeof(trochia_answer));
    } else if (wanted & SEND_STATUS) {
        trochia_status *status = (trochia_status *)MADE;
        wanted = 0;
        motion_tell(status);
        status->expected = expected;
        cramped = status->room < LARGEST;
        motion_fill();
        put(TROCHIA_STATUS, sizeof *status);
    } else {
        trochia_ack *ack = (trochia_ack *)MADE;
        uint8_t type = wanted & SEND_ACK ? TROCHIA_ACK : TROCHIA_ROOM;
        wanted = 0;
        ack->expected = expected;
        ack->epoch = motion_epoch();
        ack->room = motion_room();
        cramped = ack->room < LARGEST;
        put(type, sizeof *ack);
    }
}

static void hello(const uint8_t *payload) {
    trochia_hello order;
    memcpy(&order, payload, sizeof order);
    wanted |= SEND_ANSWER;
    if (order.schema != SCHEMA)
        return; /* its answer tells the host why */
    if (greeted && order.session == session)
        return;
    session = order.session;
    greeted = 1;
    expected = 0;
    motion_greet(&order);
}

/* An order that came when it was its turn. */
static void obey(uint8_t type, const uint8_t *payload, uint8_t size) {
    switch (type) {
    case TROCHIA_SPAN:
        motion_span(payload, size);
        break;
    case TROCHIA_BEGIN:
        motion_begin((const trochia_begin *)payload);
        break;
    case TROCHIA_GO:
        motion_go();
        break;
    case TROCHIA_CUT:
        motion_cut((const trochia_cut *)payload);
        break;
    case TROCHIA_SWITCH:
        motion_switch((const trochia_put *)payload);
        break;
    case TROCHIA_WATCH:
        motion_watch((const trochia_look *)payload);
        break;
    case TROCHIA_BRAKE:
        motion_brake(TROCHIA_ORDERED);
        break;
    default:
        break;
    }
}

static void loose(uint8_t type, const uint8_t *payload, uint8_t size) {
    if (type == TROCHIA_HELLO && size == sizeof(trochia_hello))
        hello(payload);
    if (!greeted)
        return;
    if (type == TROCHIA_HALT && size == 1) {
        motion_stop(TROCHIA_ORDERED);
        if (payload[0])
            motion_switch(&(const trochia_put){.enable = 0, .lit = 0, .mask = 255, .outputs = 0});
    }
    if (type == TROCHIA_HALT || type == TROCHIA_ASK)
        wanted |= SEND_STATUS;
}

static void take(void) {
    uint8_t type = in.bytes[1], size = (uint8_t)(in.length - 2);
    if (type >= TROCHIA_LOOSE) {
        loose(type, in.bytes + 2, size);
    } else if (greeted) {
        wanted |= SEND_ACK;
        if (in.bytes[0] == expected) {
            expected++;
            obey(type, in.bytes + 2, size);
        }
    }
    silent_slices = 0;
}

void link_work(void) {
    uint8_t event = received_tail == received_head ? TROCHIA_NOTHING : frame_run(&in, BYTES_A_TURN);
    if (event == TROCHIA_WHOLE)
        take();
    else if (event == TROCHIA_BROKEN && greeted)
        wanted |= SEND_ACK;
    if (event != TROCHIA_NOTHING)
        trochia_frame_reset(&in);
    if (cramped && motion_room() >= LARGEST)
        wanted |= SEND_ROOM;
    if (wanted && !(UCSR0B & 1 << TXCIE0))
        send();
}
