/* Holds the sizes the wire and the memory budget rely on. */
#include "host/move.h"
#include "host/path.h"

_Static_assert(sizeof(trochia_move) == 128, "a move is 128 bytes");
_Static_assert(sizeof(trochia_segment) == 32, "a segment is 32 bytes");
_Static_assert(sizeof(trochia_phase) == 56, "a phase is 56 bytes");
