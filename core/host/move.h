/* One canonical move, as the program holds a million of them: 128 bytes.
 *
 * The interpreter's fast path writes these in program coordinates and program units; the program builder turns them
 * into machine coordinates (mm, degrees, s), and from there on nothing else is ever in them. */
#ifndef TROCHIA_MOVE_H
#define TROCHIA_MOVE_H

#include <stdint.h>

enum { TROCHIA_AXES = 9 }; /* X Y Z A B C U V W, in this order everywhere */

enum trochia_move_kind {
    TROCHIA_RAPID = 0, /* straight, as fast as the axes go */
    TROCHIA_FEED = 1,  /* straight, at the feed */
    TROCHIA_ARC = 2,   /* arc or helix at the feed, about centre[] in plane, turns signed + = counter-clockwise */
    TROCHIA_SPLINE = 3 /* cubic Bezier curve of X Y Z at the feed, row turns of the program's splines */
};

enum trochia_plane { TROCHIA_XY = 0, TROCHIA_YZ = 1, TROCHIA_ZX = 2 }; /* first and second axis in this order */

enum trochia_time_law {
    TROCHIA_PER_SECOND = 0, /* rate in mm/s (degree/s when only rotary axes move) */
    TROCHIA_PER_REV = 1,    /* rate in mm per spindle revolution */
    TROCHIA_INVERSE = 2     /* rate in moves per second */
};

enum trochia_path_mode {
    TROCHIA_BLEND_DEFAULT = 0, /* G64 without P and at start-up: the machine's path tolerance */
    TROCHIA_BLEND = 1,         /* G64 P: tolerance[] holds P and Q */
    TROCHIA_EXACT_PATH = 2,    /* G61 */
    TROCHIA_EXACT_STOP = 3     /* G61.1 */
};

typedef struct {
    double target[9];    /* where the move ends */
    double centre[2];    /* arc: centre on the plane's first and second axis */
    double rate;         /* feed, by law; 0 for a rapid */
    double tolerance[2]; /* G64 P and Q */
    float power;         /* S of the spindle or beam that is on (1 where no S was given); 0 off */
    int32_t turns; /* arc: signed count of turns begun, as ARC_FEED prints it: 1 = up to one whole turn; spline: its
                      row of control points */
    uint32_t line; /* source line, from 1 */
    uint8_t kind, plane, law, path_mode;
} trochia_move;

#endif
