/* The board this image is for: one header each, chosen by BOARD_... on the compiler's command line. */
#if defined(BOARD_MEGA_STEPDIR)
#include "board_mega_stepdir.h"
#elif defined(BOARD_UNO_L293D)
#include "board_uno_l293d.h"
#else
#include "board_uno_stepdir.h"
#endif
