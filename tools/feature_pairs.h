/*
 * Pairs of features, as sc-query --step and --near find them: a vertex and a face, or two edges.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_FEATURE_PAIRS_H
#define TOOLS_FEATURE_PAIRS_H

#include "mesh_faces.h"

#include "starcontour.h"

#include <cjson/cJSON.h>
#include <stdio.h>

enum { VERTEX_FACE = 0, EDGE_EDGE = 1, KINDS = 2 };

/* "vertex-face", "edge-edge" */
extern const char *const feature_pairs_names[KINDS];

/* The object of one side of a pair, 0 or 1; *triangle: what is a part of it, or SC_NONE of a
   vertex. vertex_objects: see mesh_vertex_objects. */
uint32_t feature_pairs_object(const mesh_file *mesh, const uint32_t *vertex_objects, int kind,
                              sc_pair pair, int side, uint32_t *triangle);

/* Counts pairs by their objects; false if there is no memory. */
bool feature_pairs_tally(mesh_tally *tally, const mesh_file *mesh, const uint32_t *vertex_objects,
                         int kind, const sc_pair *pairs, uint64_t count);

/* Adds faces and objects of both sides; of a vertex no face. */
void feature_pairs_add_owners(cJSON *object, const mesh_file *mesh, const uint32_t *vertex_objects,
                              int kind, sc_pair pair);

/* Writes them as fields, each with a comma before it. */
void feature_pairs_write_owners(FILE *out, const mesh_file *mesh, const uint32_t *vertex_objects,
                                int kind, sc_pair pair);

#endif /* TOOLS_FEATURE_PAIRS_H */
