/* The board this image is for: one header each, chosen by BOARD_... on the compiler's command line. */
#if defined(BOARD_MEGA_STEPDIR)
#include "board_mega_stepdir.h"
#else
#include "board_uno_stepdir.h"
#endif
