/*
 * Looks at the header of a PLY file; see ply_header.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "ply_header.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of a header at most, and characters of a line that are looked at: comments may be longer. */
enum { HEADER_MAX = 1 << 20, LINE_SEEN = 128 };

static const char never_ends[] =
    "the header does not end within a megabyte; is the file truncated?";

/* Reads a line, which ends in LF, CR or both, and keeps its beginning. False at the end of the file,
   or where the header is too long. */
static bool read_line(FILE *file, char line[LINE_SEEN], size_t *left)
{
    size_t length = 0;
    for (int c; (c = fgetc(file)) != '\n' && c != '\r'; (*left)--) {
        if (c == EOF || *left == 0) return false;
        if (length + 1 < LINE_SEEN) line[length++] = (char)c;
    }
    line[length] = 0;
    return true;
}

static bool is_type(const char *word)
{
    static const char *const types[] = {"char",  "uchar",  "short",   "ushort",  "int",   "uint",
                                        "float", "double", "int8",    "uint8",   "int16", "uint16",
                                        "int32", "uint32", "float32", "float64", "list"};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (strcmp(word, types[i]) == 0) return true;
    }
    return false;
}

/* An element takes a byte at least. */
static bool is_count(const char *word, uint64_t size)
{
    char *end;
    errno = 0;
    const unsigned long long count = strtoull(word, &end, 10);
    return *word >= '0' && *word <= '9' && *end == 0 && errno == 0 && count <= size;
}

const char *ply_header_check(FILE *file, uint64_t size)
{
    char line[LINE_SEEN], keyword[LINE_SEEN], first[LINE_SEEN], second[LINE_SEEN];
    size_t left = HEADER_MAX;
    int vertices = 0, faces = 0;
    if (!read_line(file, line, &left)) return never_ends;
    if (line[strspn(line, " \t")]) return "a PLY file begins with a line ply and nothing else";
    while (read_line(file, line, &left)) {
        *keyword = *first = *second = 0;
        sscanf(line, "%127s %127s %127s", keyword, first, second);
        if (strcmp(keyword, "end_header") == 0) return NULL;
        if (strcmp(keyword, "property") == 0 &&
            !(is_type(first) && (strcmp(first, "list") != 0 || is_type(second))))
            return "its header has a property of an unknown type";
        if (strcmp(keyword, "element") != 0) continue;
        if (!is_count(second, size))
            return "its header has an element without a number that the file can hold; is it "
                   "truncated?";
        vertices += strcmp(first, "vertex") == 0;
        faces += strcmp(first, "face") == 0;
        if (vertices > 1 || faces > 1) return "its header has vertices or faces twice";
    }
    return never_ends;
}
