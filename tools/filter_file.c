/*
 * Filters of sc-query from files. See filter_file.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "filter_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 4096 };

/* What readers of lines are told. line ends without a line break. */
typedef bool (*line_reader)(filter_file *file, char *line, unsigned long number, uint32_t kind,
                            char reason[128]);

/* A number up to a most; *text moves behind it. */
static bool read_number(char **text, uint32_t most, uint32_t *number)
{
    char *end;
    errno = 0;
    if (**text < '0' || **text > '9') return false;
    const bool is_hexadecimal = (*text)[0] == '0' && ((*text)[1] == 'x' || (*text)[1] == 'X');
    const unsigned long value = strtoul(*text, &end, is_hexadecimal ? 16 : 10);
    if (errno || value > most) return false;
    *number = (uint32_t)value;
    *text = end;
    return true;
}

static bool grow(void **array, uint64_t count, size_t size)
{
    if (count && (count & (count - 1))) return true; /* room is a power of two */
    const uint64_t room = count ? 2 * count : 1;
    void *grown = room > SIZE_MAX / size ? NULL : realloc(*array, (size_t)room * size);
    if (!grown) return false;
    *array = grown;
    return true;
}

static bool add_pair(filter_file *file, int list, sc_pair pair, char reason[128])
{
    void *pairs = file->pairs[list];
    if (!grow(&pairs, file->pair_count[list], sizeof pair)) {
        snprintf(reason, 128, "out of memory");
        return false;
    }
    file->pairs[list] = (sc_pair *)pairs;
    file->pairs[list][file->pair_count[list]++] = pair;
    return true;
}

static bool read_pair(filter_file *file, char *line, unsigned long number, uint32_t kind,
                      char reason[128])
{
    char *last = strrchr(line, ','), *first;
    sc_pair pair;
    if (!*line) return true;
    if (number == 1 && last && strncmp(last, ",triangle", 9) == 0) {
        if ((strcmp(last, ",triangle") == 0) == (kind == SC_PAIRS_EDGE)) return true;
        snprintf(reason, 128, "pairs of another kind than --pairs asks for");
        return false;
    }
    first = line;
    if (last) {
        *last++ = '\0';
        first = strrchr(line, ',');
        first = first ? first + 1 : line;
    }
    if (!last || !read_number(&first, UINT32_MAX, &pair.a) || *first ||
        !read_number(&last, UINT32_MAX, &pair.b) || *last) {
        snprintf(reason, 128, "no two numbers, separated by a comma, at its end");
        return false;
    }
    return add_pair(file, 0, pair, reason);
}

/* Of comma-separated values the beginnings of fields, at most so many; returns how many there
   are. Commas become ends, but for those between quotation marks. */
static int split_fields(char *line, char **fields, int most)
{
    bool is_quoted = false;
    int count = 0;
    if (count < most) fields[count] = line;
    count++;
    for (; *line; line++) {
        is_quoted ^= *line == '"';
        if (*line != ',' || is_quoted) continue;
        *line = '\0';
        if (count < most) fields[count] = line + 1;
        count++;
    }
    return count;
}

/* Lines of --step have ten fields, those of --near nine, or more with closest points. */
static bool read_step_pair(filter_file *file, char *line, unsigned long number, uint32_t kind,
                           char reason[128])
{
    enum {
        FIELDS = 10,
        STEP_KIND = 2,
        STEP_FIRST = 7,
        NEAR_FIELDS = 9,
        NEAR_KIND = 1,
        NEAR_FIRST = 6
    };
    static const char *const kinds[] = {"vertex-face", "edge-edge"};
    char *fields[FIELDS];
    sc_pair pair;
    (void)kind;
    if (!*line) return true;
    const int count = split_fields(line, fields, FIELDS);
    const bool is_step = count == FIELDS, is_whole = count >= NEAR_FIELDS;
    const char *name = is_whole ? fields[is_step ? STEP_KIND : NEAR_KIND] : "";
    if (number == 1 && strcmp(name, "kind") == 0) return true;
    for (int list = 0; list < 2; list++) {
        if (strcmp(name, kinds[list]) != 0) continue;
        char **first = &fields[is_step ? STEP_FIRST : NEAR_FIRST];
        if (!read_number(&first[0], UINT32_MAX, &pair.a) || *first[0] ||
            !read_number(&first[1], UINT32_MAX, &pair.b) || *first[1])
            break;
        return add_pair(file, list, pair, reason);
    }
    snprintf(reason, 128, "not a pair as --step --out or --near --out writes it");
    return false;
}

static bool read_group(filter_file *file, char *line, unsigned long number, uint32_t kind,
                       char reason[128])
{
    static const char blanks[] = " \t";
    filter_file_line entry;
    (void)number;
    (void)kind;
    line[strcspn(line, "#")] = '\0';
    line += strspn(line, blanks);
    if (!*line) return true;
    const size_t length = strcspn(line, blanks);
    entry.is_vertex = length == 6 && strncmp(line, "vertex", length) == 0;
    bool good = entry.is_vertex || (length == 8 && strncmp(line, "triangle", length) == 0);
    line += length;
    line += strspn(line, blanks);
    good = good && read_number(&line, UINT32_MAX, &entry.first);
    entry.last = entry.first;
    if (good && *line == '-') {
        line++;
        good = read_number(&line, UINT32_MAX, &entry.last) && entry.last >= entry.first;
    }
    uint32_t *const numbers[2] = {&entry.group.category, &entry.group.mask};
    for (int i = 0; i < 2 && good; i++) {
        const size_t gap = strspn(line, blanks);
        line += gap;
        good = gap > 0 && read_number(&line, UINT32_MAX, numbers[i]);
    }
    if (!good || line[strspn(line, blanks)]) {
        snprintf(reason, 128, "not of the form: triangle|vertex FIRST[-LAST] CATEGORY MASK");
        return false;
    }
    void *lines = file->lines;
    if (!grow(&lines, file->line_count, sizeof entry)) {
        snprintf(reason, 128, "out of memory");
        return false;
    }
    file->lines = (filter_file_line *)lines;
    file->lines[file->line_count++] = entry;
    return true;
}

static bool read_lines(filter_file *file, const char *path, uint32_t kind, line_reader reader,
                       char error[MESH_FILE_ERROR_SIZE])
{
    char line[LINE_SIZE], reason[128] = "";
    unsigned long number = 0;
    errno = 0;
    FILE *in = fopen(path, "r");
    bool good = in != NULL;
    if (!good) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, strerror(errno));
    while (good && fgets(line, sizeof line, in)) {
        number++;
        if (strlen(line) + 1 == sizeof line) {
            snprintf(reason, sizeof reason, "too long");
            good = false;
        } else {
            line[strcspn(line, "\r\n")] = '\0';
            good = reader(file, line, number, kind, reason);
        }
        if (!good) snprintf(error, MESH_FILE_ERROR_SIZE, "%s: line %lu: %s", path, number, reason);
    }
    if (good && ferror(in)) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: %s", path, strerror(errno));
        good = false;
    }
    if (in) fclose(in);
    return good;
}

static int compare_pairs(const void *left, const void *right)
{
    const sc_pair *x = (const sc_pair *)left, *y = (const sc_pair *)right;
    if (x->a != y->a) return x->a < y->a ? -1 : 1;
    return x->b < y->b ? -1 : x->b > y->b;
}

bool filter_file_read(filter_file *file, const char *pairs_path, const char *groups_path,
                      uint32_t kind, char error[MESH_FILE_ERROR_SIZE])
{
    memset(file, 0, sizeof *file);
    file->groups_path = groups_path;
    if (pairs_path && !read_lines(file, pairs_path, kind,
                                  kind == FILTER_FILE_STEP ? read_step_pair : read_pair, error))
        return false;
    if (groups_path && !read_lines(file, groups_path, kind, read_group, error)) return false;
    for (int i = 0; i < 2; i++) {
        if (file->pair_count[i])
            qsort(file->pairs[i], (size_t)file->pair_count[i], sizeof(sc_pair), compare_pairs);
    }
    return true;
}

static bool fill_groups(filter_file *file, bool is_vertex, uint32_t count,
                        char error[MESH_FILE_ERROR_SIZE])
{
    sc_group **groups = &file->groups[is_vertex ? 0 : 1];
    bool any = false;
    free(*groups);
    *groups = NULL;
    for (size_t i = 0; i < file->line_count; i++) any |= file->lines[i].is_vertex == is_vertex;
    if (!any) return true;
    *groups = (sc_group *)malloc((size_t)count * sizeof **groups);
    if (!*groups) {
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: out of memory", file->groups_path);
        return false;
    }
    memset(*groups, 0xff, (size_t)count * sizeof **groups);
    for (size_t i = 0; i < file->line_count; i++) {
        const filter_file_line *line = &file->lines[i];
        if (line->is_vertex != is_vertex) continue;
        if (line->last >= count) {
            snprintf(error, MESH_FILE_ERROR_SIZE, "%s: there is no %s %lu in a mesh of %lu",
                     file->groups_path, is_vertex ? "vertex" : "triangle",
                     (unsigned long)line->last, (unsigned long)count);
            return false;
        }
        for (uint32_t k = line->first; k <= line->last; k++) (*groups)[k] = line->group;
    }
    return true;
}

bool filter_file_apply(filter_file *file, uint32_t vertex_count, uint32_t triangle_count,
                       sc_filter *filter, char error[MESH_FILE_ERROR_SIZE])
{
    memset(filter, 0, sizeof *filter);
    filter->struct_size = sizeof *filter;
    if (!fill_groups(file, true, vertex_count, error) ||
        !fill_groups(file, false, triangle_count, error))
        return false;
    filter->vertex_groups = file->groups[0];
    filter->triangle_groups = file->groups[1];
    filter->ignore = file->pairs[0];
    filter->ignore_count = file->pair_count[0];
    return true;
}

bool filter_file_apply_step(filter_file *file, uint32_t vertex_count, uint32_t triangle_count,
                            sc_filter filters[2], char error[MESH_FILE_ERROR_SIZE])
{
    if (!filter_file_apply(file, vertex_count, triangle_count, &filters[0], error)) return false;
    filters[1] = filters[0];
    filters[1].ignore = file->pairs[1];
    filters[1].ignore_count = file->pair_count[1];
    return true;
}

void filter_file_free(filter_file *file)
{
    free(file->pairs[0]);
    free(file->pairs[1]);
    free(file->lines);
    free(file->groups[0]);
    free(file->groups[1]);
    memset(file, 0, sizeof *file);
}
