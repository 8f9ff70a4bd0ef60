/* Nothing interrupts here: chip.c calls one thing after the other. */
#ifndef TROCHIA_HOST_UTIL_ATOMIC_H
#define TROCHIA_HOST_UTIL_ATOMIC_H

#define ATOMIC_RESTORESTATE 1
#define ATOMIC_BLOCK(kind) for (int once_##kind = 1; once_##kind; once_##kind = 0)

#endif
