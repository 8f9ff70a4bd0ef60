/* Rows of the G-code reader into moves of the machine.
 *
 *     machine = (turn(program + shift) + origin) * scale
 *
 * turn: about Z, of X and Y; scale: length of a program unit [mm], which leaves the rotary axes alone. */
#ifndef TROCHIA_PLACEMENT_H
#define TROCHIA_PLACEMENT_H

#include "host/gcode.h"
#include "host/move.h"

#include <stdint.h>

/* What a row does not say itself. */
typedef struct {
    double origin[9];    /* program units, degree */
    double shift[9];     /* program units, degree */
    double scale;        /* mm */
    double cosine, sine; /* of the turn */
    double feed;         /* F word in force, kept up to date */
    double feed_scale;   /* length of the unit it counts in [mm] */
    double speed;        /* S word in force, kept up to date */
    double tolerance[2]; /* of the path mode [mm] */
    double position[9];  /* machine position before the next row [mm, degree] */
    uint8_t plane, law, path_mode;
    uint8_t fills;     /* moves get their power here: speed, or 0 where not lit */
    uint8_t lit;       /* beam or spindle is on */
    uint8_t new_speed; /* out: an S word came by */
    uint8_t reserved[2];
} trochia_placement;

/* Converts `count` rows, whose rate is the F word; leaves rows out that are no move.  `out` may
 * be `rows`.  Returns the number of moves. */
uint64_t trochia_place(const trochia_move *rows, uint64_t count, trochia_placement *placement, trochia_move *out);

#endif
