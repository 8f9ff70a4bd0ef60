#include "requests.h"

#include <stdio.h>
#include <stdlib.h>

enum { LONGEST = 1 << 24, BEHIND = 8 };

static event *events;
static uint32_t event_count, event_room;

void record(uint64_t cycle, uint8_t kind, uint8_t unit, uint8_t line, uint32_t value) {
    if (event_count == event_room) {
        event_room = event_room ? 2 * event_room : 4096;
        events = realloc(events, event_room * sizeof *events);
        if (!events)
            abort();
    }
    events[event_count++] = (event){.cycle = cycle, .kind = kind, .unit = unit, .line = line, .value = value};
}

void answer(const void *bytes, uint32_t size) {
    fwrite(&size, sizeof size, 1, stdout);
    if (size)
        fwrite(bytes, 1, size, stdout);
    fflush(stdout);
}

void answer_status(status now) {
    now.events = event_count;
    uint32_t size = (uint32_t)(sizeof now + event_count * sizeof *events);
    fwrite(&size, sizeof size, 1, stdout);
    fwrite(&now, sizeof now, 1, stdout);
    fwrite(events, sizeof *events, event_count, stdout);
    fflush(stdout);
    event_count = 0;
}

void obey_requests(bool (*obey)(uint8_t letter, const uint8_t *request, uint32_t size)) {
    static uint8_t request[LONGEST + BEHIND];
    uint8_t letter;
    uint32_t size;
    while (fread(&letter, 1, 1, stdin) == 1 && fread(&size, sizeof size, 1, stdin) == 1 && size <= LONGEST) {
        if ((size && fread(request, 1, size, stdin) != size) || !obey(letter, request, size))
            break;
    }
}
