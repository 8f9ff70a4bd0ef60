/* Obeys the requests of firmware/sim/main.c, from the same caller: R, B, P and M (of the registers tests look at). */
#include "chip.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST = 1 << 20, RUNS = 1 };

typedef struct {
    uint64_t cycle, asleep;
    uint32_t state, interrupts, unread, events;
} status;

static event *events;
static uint32_t event_count, event_room;

void record(uint64_t at, uint8_t kind, uint8_t unit, uint8_t line, uint32_t value) {
    if (event_count == event_room) {
        event_room = event_room ? 2 * event_room : 4096;
        events = realloc(events, event_room * sizeof *events);
        if (!events)
            abort();
    }
    events[event_count++] = (event){.cycle = at, .kind = kind, .unit = unit, .line = line, .value = value};
}

static void answer(const void *bytes, uint32_t size) {
    fwrite(&size, sizeof size, 1, stdout);
    if (size)
        fwrite(bytes, 1, size, stdout);
    fflush(stdout);
}

static void run(const uint8_t *request) {
    uint64_t until;
    memcpy(&until, request, sizeof until);
    chip_run(until);
    status now = {.cycle = cycle, .state = RUNS, .unread = chip_unread(), .events = event_count};
    uint32_t size = (uint32_t)(sizeof now + event_count * sizeof *events);
    fwrite(&size, sizeof size, 1, stdout);
    fwrite(&now, sizeof now, 1, stdout);
    fwrite(events, sizeof *events, event_count, stdout);
    fflush(stdout);
    event_count = 0;
}

static void tell_registers(const uint8_t *request) {
    static uint8_t bytes[65536];
    uint16_t words[2];
    memcpy(words, request, sizeof words);
    for (uint16_t i = 0; i < words[1]; i++)
        bytes[i] = chip_register((uint16_t)(words[0] + i));
    answer(bytes, words[1]);
}

/* Returns whether to go on. */
static bool obey(uint8_t letter, const uint8_t *request, uint32_t size) {
    switch (letter) {
    case 'R':
        run(request);
        return true;
    case 'M':
        tell_registers(request);
        return true;
    case 'B':
        chip_feed(request + 8, size - 8);
        break;
    case 'P':
        chip_set_pin(request[0], request[1], request[2]);
        break;
    default:
        return false;
    }
    answer(NULL, 0);
    return true;
}

int main(void) {
    static uint8_t request[LONGEST + 8];
    uint8_t letter;
    uint32_t size;
    chip_reset();
    while (fread(&letter, 1, 1, stdin) == 1 && fread(&size, sizeof size, 1, stdin) == 1 && size <= LONGEST) {
        if ((size && fread(request, 1, size, stdin) != size) || !obey(letter, request, size))
            break;
    }
    return 0;
}
