/* A run of errors through the shared integer PID, for the host. */
#ifndef TROCHIA_INTEGER_PID_H
#define TROCHIA_INTEGER_PID_H

#include <stdint.h>

#include "shared/pid.h"

/* out[count][5]: proportional, integral and derivative terms, their sum in whole units, output. */
void trochia_pid16_run(trochia_pid16 *state, const int16_t *errors, int64_t count, int32_t *out);

#endif
