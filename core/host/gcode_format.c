/* Rows into canonical commands, four decimals.  Numbers are rounded as exact decimal arithmetic rounds them (half to
 * even) and a negative zero has its sign, so that the text is that of printf and Python. */
#include "host/gcode.h"

#include <math.h>
#include <string.h>

enum { ROOM = 512 }; /* bytes: more than the longest line, a comment of 250 bytes or 9 numbers of 18 */

static const double LARGEST = 1e11; /* below it 1e4 x is below 2^53 */
static const uint8_t FIRST[3] = {0, 1, 2}, SECOND[3] = {1, 2, 0}, NORMAL[3] = {2, 0, 1};
static const char PAIRS[] =
    "00010203040506070809101112131415161718192021222324252627282930313233343536373839404142434445"
    "46474849505152535455565758596061626364656667686970717273747576777879808182838485868788899091"
    "9293949596979899";

static uint8_t *put_text(uint8_t *out, const char *text, size_t length) {
    memcpy(out, text, length);
    return out + length;
}

static uint8_t *put_whole(uint8_t *out, uint64_t value) {
    uint8_t digits[20];
    unsigned at = sizeof digits;
    for (; value >= 100; value /= 100) {
        at -= 2;
        memcpy(digits + at, PAIRS + 2 * (value % 100), 2);
    }
    if (value >= 10) {
        at -= 2;
        memcpy(digits + at, PAIRS + 2 * value, 2);
    } else {
        digits[--at] = (uint8_t)('0' + value);
    }
    memcpy(out, digits + at, sizeof digits - at);
    return out + (sizeof digits - at);
}

/* 1e4 x to the nearest whole number.  Where the rounded product lies exactly between two, the error of the product
 * decides; elsewhere that error (half a unit of the last place) cannot. */
static int64_t scaled(double x) {
    const double product = x * 1e4;
    const int64_t nearest = llrint(product);
    if (fabs(product - (double)nearest) != 0.5) {
        return nearest;
    }
    const double error = fma(x, 1e4, -product);
    if (error == 0.0) {
        return nearest;
    }
    return (int64_t)(error > 0.0 ? ceil(product) : floor(product));
}

static uint8_t *put_number(uint8_t *out, double x) {
    const int64_t value = scaled(x);
    uint64_t size = value < 0 ? 0U - (uint64_t)value : (uint64_t)value;
    const unsigned decimals = (unsigned)(size % 10000);
    if (signbit(x)) {
        *out++ = '-';
    }
    out = put_whole(out, size / 10000);
    *out = '.';
    memcpy(out + 1, PAIRS + 2 * (decimals / 100), 2);
    memcpy(out + 3, PAIRS + 2 * (decimals % 100), 2);
    return out + 5;
}

static uint8_t *put_numbers(uint8_t *out, const double *values, unsigned count) {
    for (unsigned k = 0; k < count; k++) {
        out = put_number(out, values[k]);
        out[0] = ',';
        out[1] = ' ';
        out += 2;
    }
    return out;
}

/* The last two bytes written are a separator: close the command instead. */
static uint8_t *put_end(uint8_t *out) {
    out[-2] = ')';
    out[-1] = '\n';
    return out;
}

static uint8_t *put_arc(uint8_t *out, const trochia_move *row) {
    const double ends[4] = {row->target[FIRST[row->plane]], row->target[SECOND[row->plane]], row->centre[0],
                            row->centre[1]};
    out = put_numbers(put_text(out, "ARC_FEED(", 9), ends, 4);
    if (row->turns < 0) {
        *out++ = '-';
    }
    out = put_whole(out, row->turns < 0 ? 0U - (uint64_t)row->turns : (uint64_t)row->turns);
    out = put_text(out, ", ", 2);
    out = put_numbers(out, &row->target[NORMAL[row->plane]], 1);
    return put_end(put_numbers(out, &row->target[3], 3));
}

/* 1 where every number the row prints is below LARGEST (and a number). */
static int has_printable_numbers(const trochia_move *row) {
    if (row->kind == TROCHIA_FEED_ROW || row->kind == TROCHIA_SPEED_ROW) {
        return fabs(row->rate) < LARGEST;
    }
    int fits = row->plane < 3 && fabs(row->centre[0]) < LARGEST && fabs(row->centre[1]) < LARGEST;
    for (unsigned k = 0; k < 6; k++) {
        fits &= fabs(row->target[k]) < LARGEST;
    }
    return fits;
}

static int is_printable(const trochia_move *row, uint64_t text_size) {
    if (row->kind != TROCHIA_COMMENT_ROW) {
        const int is_word = row->kind == TROCHIA_FEED_ROW || row->kind == TROCHIA_SPEED_ROW;
        return (row->kind <= TROCHIA_ARC || is_word) && has_printable_numbers(row);
    }
    const double offset = row->target[0];
    return row->turns >= 0 && row->turns < ROOM / 2 && offset >= 0.0 && offset + row->turns <= (double)text_size;
}

static uint8_t *put_row(uint8_t *out, const trochia_move *row, const uint8_t *text) {
    switch (row->kind) {
    case TROCHIA_RAPID:
        return put_end(put_numbers(put_text(out, "STRAIGHT_TRAVERSE(", 18), row->target, 6));
    case TROCHIA_FEED:
        return put_end(put_numbers(put_text(out, "STRAIGHT_FEED(", 14), row->target, 6));
    case TROCHIA_ARC:
        return put_arc(out, row);
    case TROCHIA_FEED_ROW:
        return put_end(put_numbers(put_text(out, "SET_FEED_RATE(", 14), &row->rate, 1));
    case TROCHIA_SPEED_ROW:
        return put_end(put_numbers(put_text(out, "SET_SPINDLE_SPEED(0, ", 21), &row->rate, 1));
    default:
        out = put_text(out, "COMMENT(\"", 9);
        out = put_text(out, (const char *)text + (uint64_t)row->target[0], (size_t)row->turns);
        return put_text(out, "\")\n", 3);
    }
}

uint64_t trochia_canon_format(const trochia_move *rows, uint64_t count, const uint8_t *text, uint64_t text_size,
                              uint8_t *out, uint64_t capacity, uint64_t *done) {
    uint8_t *at = out;
    uint64_t k = 0;
    while (k < count && capacity - (uint64_t)(at - out) >= ROOM && is_printable(&rows[k], text_size)) {
        at = put_row(at, &rows[k++], text);
    }
    *done = k;
    return (uint64_t)(at - out);
}
