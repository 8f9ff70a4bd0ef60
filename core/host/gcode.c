/* Plain lines into rows: the words of a line, then what they mean in the present modes. */
#include "host/gcode.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum {
    LONGEST_LINE = 252, /* bytes before the line end; longer ones are errors, which the interpreter reports */
    ROWS_PER_LINE = 4,  /* comment, feed, speed, move */
    AXIS_BITS = 0x1ff,
    CIRCLE_BITS = 0x1e00, /* I J K R */
    OFFSET_BITS = 0xe00,  /* I J K */
    FEED_SLOT = 13,
    CODE_SLOT = 14,
    SPEED_SLOT = 15,
    NO_MOTION = 255
};

static void clear_row(trochia_move *row, const trochia_modal *modal, uint8_t kind) {
    memset(row, 0, sizeof *row);
    row->line = modal->line;
    row->plane = modal->plane;
    row->kind = kind;
}

/* The motion this line commands: 0-3; NO_MOTION: none; -1: not plain. */
static int motion_of(const trochia_modal *modal, const trochia_plain_line *line) {
    if (line->seen >> CODE_SLOT & 1) {
        for (int code = 0; code < 4; code++) {
            if (line->word[CODE_SLOT] == code) {
                return code;
            }
        }
        return -1;
    }
    if ((line->seen & (AXIS_BITS | CIRCLE_BITS)) == 0) {
        return NO_MOTION;
    }
    /* I J K alone repeat an arc; R alone is an error */
    const int moves = (line->seen & AXIS_BITS) != 0 || (line->seen & OFFSET_BITS) != 0;
    return modal->motion < 4 && moves ? modal->motion : -1;
}

/* The row of a move.  Returns 1, or 0 where the line is not plain. */
static int make_move(const trochia_modal *modal, const trochia_plain_line *line, uint8_t motion, double feed,
                     trochia_move *row) {
    clear_row(row, modal, motion == 0 ? TROCHIA_RAPID : TROCHIA_FEED);
    memcpy(row->target, modal->position, sizeof row->target);
    for (unsigned k = 0; k < TROCHIA_AXES; k++) {
        if (line->seen >> k & 1) {
            row->target[k] = modal->incremental ? modal->position[k] + line->word[k] : line->word[k];
        }
    }
    if (motion == 0) {
        return (line->seen & CIRCLE_BITS) == 0;
    }
    row->rate = feed;
    if (!(feed > 0.0)) {
        return 0;
    }
    return motion == 1 ? (line->seen & CIRCLE_BITS) == 0 : trochia_gcode_arc(modal, line, motion, row);
}

/* Rows of one line, in the order of execution: comment, feed, speed, move.  Returns their number, or -1: not plain. */
static int make_rows(const uint8_t *text, const trochia_plain_line *line, trochia_modal *modal, trochia_move *rows) {
    const int motion = motion_of(modal, line), feeds = (int)(line->seen >> FEED_SLOT & 1);
    const double feed = feeds ? line->word[FEED_SLOT] : modal->feed;
    int count = 0;
    const int speeds = (int)(line->seen >> SPEED_SLOT & 1);
    const double speed = speeds ? line->word[SPEED_SLOT] : modal->speed;
    if (motion < 0 || !(feed >= 0.0) || !(speed >= 0.0)) {
        return -1;
    }
    if (line->comment != NULL) {
        clear_row(&rows[count], modal, TROCHIA_COMMENT_ROW);
        rows[count].target[0] = (double)(line->comment - text);
        rows[count++].turns = (int32_t)line->comment_length;
    }
    if (feeds) {
        clear_row(&rows[count], modal, TROCHIA_FEED_ROW);
        rows[count++].rate = feed;
    }
    if (speeds) {
        clear_row(&rows[count], modal, TROCHIA_SPEED_ROW);
        rows[count++].rate = speed;
    }
    if (motion != NO_MOTION) {
        if (!make_move(modal, line, (uint8_t)motion, feed, &rows[count])) {
            return -1;
        }
        memcpy(modal->position, rows[count++].target, sizeof modal->position);
        modal->motion = (uint8_t)motion;
    }
    modal->feed = feed;
    modal->speed = speed;
    return count;
}

/* The line at `offset` of the text, which may be the last one and lack its '\n'.  Comments of that one are not plain,
 * for its copy is gone when they are printed.  Returns the rows' number, or -1; *after: offset of the next line. */
static int read_line(const uint8_t *text, uint64_t size, trochia_modal *modal, trochia_move *rows, uint64_t *after) {
    uint8_t copy[LONGEST_LINE + 1];
    trochia_plain_line line;
    const uint8_t *start = text + modal->offset;
    const uint64_t left = size - modal->offset, most = left < LONGEST_LINE + 1 ? left : LONGEST_LINE + 1;
    const uint8_t *end = memchr(start, '\n', (size_t)most);
    if (end != NULL) {
        *after = (uint64_t)(end - text) + 1;
        return trochia_gcode_words(start, end, modal->axes, &line) ? make_rows(text, &line, modal, rows) : -1;
    }
    if (left > LONGEST_LINE) {
        return -1;
    }
    memcpy(copy, start, (size_t)left);
    copy[left] = '\n';
    *after = size;
    const int plain = trochia_gcode_words(copy, copy + left, modal->axes, &line) && line.comment == NULL;
    return plain ? make_rows(copy, &line, modal, rows) : -1;
}

uint64_t trochia_gcode_plain(const uint8_t *text, uint64_t size, trochia_modal *modal, trochia_move *rows,
                             uint64_t capacity) {
    uint64_t count = 0, after = 0;
    while (modal->offset < size) {
        if (capacity - count < ROWS_PER_LINE) {
            modal->stop = TROCHIA_STOP_FULL;
            return count;
        }
        const int made = read_line(text, size, modal, rows + count, &after);
        if (made < 0) {
            modal->stop = TROCHIA_STOP_LINE;
            return count;
        }
        count += (uint64_t)made;
        modal->offset = after;
        modal->line++;
    }
    modal->stop = TROCHIA_STOP_END;
    return count;
}
