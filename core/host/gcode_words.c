/* One plain line into words.  Every line ends with '\n', which no scan here steps over: no other bound is needed. */
#include "host/gcode.h"

#include <stddef.h>

enum { NOT_PLAIN = 255, LINE_NUMBER = 16, MOST_DIGITS = 18, FIRST_PRINTABLE = 0x20, FIRST_BEYOND_ASCII = 0x7f };

static const uint8_t SLOT[26] = {
    /* a b c d e f */ 3,         4,           5,         NOT_PLAIN, NOT_PLAIN, 13,
    /* g h i j k l */ 14,        NOT_PLAIN,   9,         10,        11,        NOT_PLAIN,
    /* m n o p q r */ NOT_PLAIN, LINE_NUMBER, NOT_PLAIN, NOT_PLAIN, NOT_PLAIN, 12,
    /* s t u v w   */ 15,        NOT_PLAIN,   6,         7,         8,
    /* x y z       */ 0,         1,           2};

static const double POWER_OF_TEN[MOST_DIGITS + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8, 1e9,
                                                     1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18};

static const uint8_t *skip_blanks(const uint8_t *p) {
    while (*p == ' ' || *p == '\t') {
        p++;
    }
    return p;
}

/* Sign, digits, at most one point.  A whole number below 2^53 divided by an exact power of ten is rounded once, so
 * correctly.  NULL where that cannot be promised or there is no number. */
static const uint8_t *read_number(const uint8_t *p, double *value) {
    const int negative = *p == '-';
    p += negative || *p == '+';
    uint64_t mantissa = 0;
    const uint8_t *first = p;
    for (; (unsigned)(*p - '0') < 10; p++) {
        mantissa = mantissa * 10 + (uint64_t)(*p - '0');
    }
    ptrdiff_t digits = p - first, decimals = 0;
    if (*p == '.') {
        first = ++p;
        for (; (unsigned)(*p - '0') < 10; p++) {
            mantissa = mantissa * 10 + (uint64_t)(*p - '0');
        }
        decimals = p - first;
        digits += decimals;
    }
    if (digits == 0 || digits > MOST_DIGITS || mantissa >> 53 != 0) {
        return NULL;
    }
    const double size = (double)mantissa / POWER_OF_TEN[decimals];
    *value = negative ? -size : size;
    return p;
}

static int starts_with(const uint8_t *p, const char *word) {
    for (; *word != 0; p++, word++) {
        if ((*p | 0x20) != (uint8_t)*word) {
            return 0;
        }
    }
    return 1;
}

/* A comment in brackets that is certainly only text: not a command to the interpreter ("msg,", "logclose"), ASCII,
 * the only one of its line.  Returns the byte after ')', or NULL. */
static const uint8_t *read_comment(const uint8_t *p, trochia_plain_line *line) {
    p = skip_blanks(p);
    line->comment = p;
    for (; *p != ')'; p++) {
        if (*p < FIRST_PRINTABLE || *p >= FIRST_BEYOND_ASCII || *p == ',' || *p == '(') {
            return NULL;
        }
    }
    line->comment_length = (uint32_t)(p - line->comment);
    if (line->comment_length == 0 || starts_with(line->comment, "log") || starts_with(line->comment, "probe") ||
        starts_with(line->comment, "py")) {
        return NULL;
    }
    return p + 1;
}

/* The rest of a line after ';' must hold no control character (a file with them is not text). */
static int rest_is_text(const uint8_t *p, const uint8_t *end) {
    for (; p < end; p++) {
        if (*p < FIRST_PRINTABLE && *p != '\t' && !(*p == '\r' && p + 1 == end)) {
            return 0;
        }
    }
    return 1;
}

/* N and its digits; other forms of it are not plain. */
static const uint8_t *read_line_number(const uint8_t *p) {
    p = skip_blanks(p);
    const uint8_t *first = p;
    while ((unsigned)(*p - '0') < 10) {
        p++;
    }
    return p == first || p - first > 9 ? NULL : p;
}

/* One word, from its letter on. */
static const uint8_t *read_word(const uint8_t *p, uint32_t allowed, trochia_plain_line *line) {
    const unsigned letter = (unsigned)(*p | 0x20) - 'a';
    const unsigned slot = letter < 26 && *p >= 'A' ? SLOT[letter] : NOT_PLAIN;
    if (slot >= LINE_NUMBER || !(allowed >> slot & 1) || line->seen >> slot & 1) {
        return NULL;
    }
    line->seen |= 1U << slot;
    return read_number(skip_blanks(p + 1), &line->word[slot]);
}

int32_t trochia_gcode_words(const uint8_t *text, const uint8_t *end, uint16_t axes, trochia_plain_line *line) {
    const uint32_t allowed = (axes & 0x1ffU) | 0xfe00U;
    const uint8_t *p = skip_blanks(text);
    line->seen = 0;
    line->comment = NULL;
    if (*p == 'N' || *p == 'n') {
        p = read_line_number(p + 1);
    }
    while (p != NULL) {
        p = skip_blanks(p);
        if (p == end || (*p == '\r' && p + 1 == end)) {
            return 1;
        }
        if (*p == ';') {
            return rest_is_text(p, end);
        }
        if (*p == '(') {
            p = line->comment == NULL ? read_comment(p + 1, line) : NULL;
        } else {
            p = read_word(p, allowed, line);
        }
    }
    return 0;
}
