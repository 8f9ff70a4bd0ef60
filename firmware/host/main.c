/* Obeys the requests of firmware/sim/main.c, from the same caller: R, B, P and M (of the registers tests look at). */
#include "chip.h"

#include <string.h>

static void run(const uint8_t *request) {
    uint64_t until;
    memcpy(&until, request, sizeof until);
    chip_run(until);
    answer_status((status){.cycle = cycle, .state = RUNS, .unread = chip_unread()});
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
    chip_reset();
    obey_requests(obey);
    return 0;
}
