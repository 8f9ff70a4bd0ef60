/* Spans that wait, as the bytes they came in. */
#include "motion_parts.h"

#include <string.h>

static uint8_t bytes[BOARD_QUEUE];
static uint16_t head, used;
static uint16_t ahead; /* bytes of the span under way: those of its pixels that are still to come */

void queue_clear(void) {
    head = used = ahead = 0;
}

uint16_t queue_free(void) {
    return (uint16_t)(BOARD_QUEUE - used);
}

static uint16_t place(uint16_t offset) {
    uint16_t at = (uint16_t)(head + offset);
    return at >= BOARD_QUEUE ? (uint16_t)(at - BOARD_QUEUE) : at;
}

/* How many of some bytes lie before the memory's end. */
static uint8_t before_end(uint16_t at, uint8_t size) {
    uint16_t left = (uint16_t)(BOARD_QUEUE - at);
    if (left < size)
        size = (uint8_t)left;
    return size;
}

uint8_t queue_put(const uint8_t *payload, uint8_t size) {
    if (size > queue_free())
        return 0;
    uint16_t at = place(used);
    uint8_t first = before_end(at, size);
    memcpy(bytes + at, payload, first);
    memcpy(bytes, payload + first, (uint8_t)(size - first));
    used = (uint16_t)(used + size);
    return 1;
}

static void read(uint16_t offset, uint8_t *to, uint8_t size) {
    uint16_t at = place(offset);
    uint8_t first = before_end(at, size);
    memcpy(to, bytes + at, first);
    memcpy(to + first, bytes, (uint8_t)(size - first));
}

static void drop(uint16_t size) {
    head = place(size);
    used = (uint16_t)(used - size);
}

void queue_get(uint8_t *to, uint8_t size) {
    read(0, to, size);
    drop(size);
    ahead = (uint16_t)(ahead - size);
}

uint16_t queue_size(const trochia_span *span) {
    uint16_t size = (uint16_t)(sizeof *span + span->flags / TROCHIA_PIXEL * sizeof(trochia_pixel));
    for (uint8_t motors = span->motors; motors; motors &= (uint8_t)(motors - 1))
        size = (uint16_t)(size + sizeof(trochia_part));
    return size;
}

uint8_t queue_next(uint8_t *to, uint8_t size) {
    drop(ahead);
    ahead = 0;
    if (!used)
        return 0;
    read(0, to, size);
    drop(size);
    ahead = (uint16_t)(queue_size((const trochia_span *)to) - size);
    return 1;
}

/* Ends a span earlier, and drops those after it; all of them, where it is none of them. */
void queue_cut(uint16_t number, uint32_t duration, uint8_t *found) {
    trochia_span span;
    *found = 0;
    for (uint16_t offset = ahead; offset < used; offset = (uint16_t)(offset + queue_size(&span))) {
        read(offset, (uint8_t *)&span, sizeof span);
        if (span.number != number)
            continue;
        *found = 1;
        if (duration == 0 || duration > span.duration) {
            used = offset;
            return;
        }
        for (uint8_t i = 0; i < 4; i++)
            bytes[place((uint16_t)(offset + i))] = (uint8_t)(duration >> 8 * i);
        used = (uint16_t)(offset + queue_size(&span));
        return;
    }
    used = ahead;
}

uint32_t queue_hand(void) {
    trochia_span span;
    uint32_t hand = 0;
    for (uint16_t offset = ahead; offset < used; offset = (uint16_t)(offset + queue_size(&span))) {
        read(offset, (uint8_t *)&span, sizeof span);
        hand += trochia_hand(span.slew, span.duration);
    }
    return hand;
}
