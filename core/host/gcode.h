/* The plain-line fast path of the G-code reader, and the printer of its rows.
 *
 * A line is plain when it holds nothing but blanks, comments, a line number and the words G0-G3, axes, I J K R, F, S
 * in a combination that is certainly no error.  Everything else is the Python interpreter's. */
#ifndef TROCHIA_GCODE_H
#define TROCHIA_GCODE_H

#include "host/move.h"

#include <stdint.h>

/* Rows that are no move stand among the moves, in the order of execution. */
enum trochia_row_kind {
    TROCHIA_SPEED_ROW = 253,   /* rate: the S word */
    TROCHIA_COMMENT_ROW = 254, /* target[0]: offset of the comment's first byte in the text, turns: its length */
    TROCHIA_FEED_ROW = 255     /* rate: the F word */
};

enum trochia_stop {
    TROCHIA_STOP_END = 0,  /* the whole text is read */
    TROCHIA_STOP_LINE = 1, /* the next line is not plain */
    TROCHIA_STOP_FULL = 2  /* no room for the rows of another line */
};

/* What the plain lines depend on and change.  Program units and coordinates. */
typedef struct {
    double position[9];      /* current point */
    double feed;             /* F word in force; 0: none */
    double speed;            /* S word in force; 0: none */
    double least_radius;     /* an arc of a smaller radius is an error */
    double spiral;           /* start and end radius of an arc may differ by this, whatever the radius */
    double spiral_share;     /* or by this share of the greater radius */
    double spiral_most;      /* but never by more than this */
    uint64_t offset;         /* first unread byte of the text */
    uint32_t line;           /* number of the line there, from 1 */
    uint16_t axes;           /* bit k: words of axis k are allowed */
    uint8_t motion;          /* 0-3: G0-G3; else a mode in which axis words without G0-G3 are not plain */
    uint8_t plane;           /* trochia_plane */
    uint8_t incremental;     /* G91 */
    uint8_t centre_absolute; /* G90.1 */
    uint8_t stop;            /* out: trochia_stop */
    uint8_t reserved[5];
} trochia_modal;

/* Words of one line: slots 0-8 axes in the order of trochia_move, 9-11 I J K, 12 R, 13 F, 14 G, 15 S. */
typedef struct {
    double word[16];
    uint32_t seen; /* bit per slot */
    uint32_t comment_length;
    const uint8_t *comment; /* text between the brackets, leading blanks left out; NULL: none */
} trochia_plain_line;

/* Reads plain lines from modal->offset on, at most `capacity` rows (needs at least 4).  Returns the number of rows. */
uint64_t trochia_gcode_plain(const uint8_t *text, uint64_t size, trochia_modal *modal, trochia_move *rows,
                             uint64_t capacity);

/* Splits one line, which ends with '\n' at `end`, into words.  Returns 1, or 0 where it is not plain. */
int32_t trochia_gcode_words(const uint8_t *text, const uint8_t *end, uint16_t axes, trochia_plain_line *line);

/* Completes the row of an arc (centre, turns) whose target is set.  Returns 1, or 0 where it is not plain. */
int32_t trochia_gcode_arc(const trochia_modal *modal, const trochia_plain_line *line, uint8_t motion,
                          trochia_move *row);

/* Prints rows as canonical commands, one per line.  Stops before a row that Python must print (a number of 1e11 or
 * more, a comment outside the text) and when fewer than 512 bytes are left.  Sets *done to the rows printed; returns
 * the bytes written. */
uint64_t trochia_canon_format(const trochia_move *rows, uint64_t count, const uint8_t *text, uint64_t text_size,
                              uint8_t *out, uint64_t capacity, uint64_t *done);

#endif
