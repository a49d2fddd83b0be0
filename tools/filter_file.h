/*
 * Filters of sc-query, read from files: pairs to ignore, and groups of triangles or vertices.
 *
 * SPDX-License-Identifier: MIT
 *
 * Pairs: comma-separated values as sc-query --out writes them: the last two fields of a line are a
 * pair, in any order of lines. A first line whose last field is "triangle_b" or "triangle" says
 * which kind of pair they are. Repeats, as of several files, do no harm. Those of sc-query --step
 * --out have ten fields: the third is the kind, the eighth and ninth are the pair. Those of --near
 * --out have nine, or more: the second is the kind, the seventh and eighth are the pair.
 *
 * Groups: a line each,
 *
 *     triangle FIRST[-LAST] CATEGORY MASK
 *     vertex   FIRST[-LAST] CATEGORY MASK
 *
 * with numbers as the mesh has them, from 0, and CATEGORY and MASK of 32 bits, decimal or 0x...; a
 * later line overrides an earlier one. What no line names is in all categories and collides with
 * all. Empty lines and what follows a # are left out.
 */
#ifndef TOOLS_FILTER_FILE_H
#define TOOLS_FILTER_FILE_H

#include "mesh_file.h"

#include "starcontour.h"

typedef struct filter_file_line {
    uint32_t first, last;
    sc_group group;
    bool is_vertex;
} filter_file_line;

typedef struct filter_file {
    const char *groups_path; /* the caller's */
    sc_pair *pairs[2];       /* sorted; of steps those of a vertex and a face, and of two edges */
    uint64_t pair_count[2];
    filter_file_line *lines;
    size_t line_count;
    sc_group *groups[2]; /* of vertices, of triangles, for the mesh at hand */
} filter_file;

/* As a kind of pair: those of steps, and of what is near. */
enum { FILTER_FILE_STEP = 2 };

/* Reads the files that are named; either may be NULL. kind is SC_PAIRS_... or FILTER_FILE_STEP. On
   failure error says why, and *file is to be freed all the same. */
bool filter_file_read(filter_file *file, const char *pairs_path, const char *groups_path,
                      uint32_t kind, char error[MESH_FILE_ERROR_SIZE]);

/* Makes a filter for a mesh. Its arrays stay those of *file, until the next call. */
bool filter_file_apply(filter_file *file, uint32_t vertex_count, uint32_t triangle_count,
                       sc_filter *filter, char error[MESH_FILE_ERROR_SIZE]);

/* The same for both kinds of pairs of a step. */
bool filter_file_apply_step(filter_file *file, uint32_t vertex_count, uint32_t triangle_count,
                            sc_filter filters[2], char error[MESH_FILE_ERROR_SIZE]);

void filter_file_free(filter_file *file);

#endif /* TOOLS_FILTER_FILE_H */
