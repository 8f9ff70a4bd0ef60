#include "host/integer_pid.h"

void trochia_pid16_run(trochia_pid16 *state, const int16_t *errors, int64_t count, int32_t *out) {
    for (int64_t k = 0; k < count; k++, out += 5) {
        out[4] = trochia_pid16_step(state, errors[k]);
        out[0] = state->p_term;
        out[1] = state->i_term;
        out[2] = state->d_term;
        out[3] = state->raw;
    }
}
