#include "host/link.h"

uint32_t trochia_schema(void) {
    return TROCHIA_SCHEMA;
}

int32_t trochia_frame_make(uint8_t number, uint8_t type, const uint8_t *payload, int32_t size, uint8_t *line) {
    trochia_frame_out out;
    if (size < 0 || size > TROCHIA_PAYLOAD)
        return 0;
    trochia_frame_begin(&out, line, number, type);
    for (int32_t i = 0; i < size; i++)
        trochia_frame_put(&out, payload[i]);
    return trochia_frame_end(&out);
}

void trochia_frame_start(trochia_frame_in *in) {
    trochia_frame_reset(in);
}

int32_t trochia_frame_feed(trochia_frame_in *in, const uint8_t *bytes, int32_t count, int32_t *taken) {
    for (int32_t i = 0; i < count; i++) {
        uint8_t event = trochia_frame_take(in, bytes[i]);
        if (event != TROCHIA_NOTHING) {
            *taken = i + 1;
            return event;
        }
    }
    *taken = count;
    return TROCHIA_NOTHING;
}
