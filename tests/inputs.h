/*
 * From soups to the library's inputs: meshes and poses in every type and stride, random weld maps,
 * orders and trees, and meshes read from OBJ files.
 *
 * Arrays are allocated to the last byte that may be read, at odd addresses, with noise between
 * elements, so that reading too far or an alignment assumed shows under sanitizers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_INPUTS_H
#define SC_TESTS_INPUTS_H

#include <stdint.h>

#include "soups.h"
#include "starcontour.h"

/* An array as the library reads it. */
typedef struct input_array {
    unsigned char *memory;
    unsigned char *data; /* memory + 1: misaligned */
    uint32_t type, stride;
} input_array;

/* type is SC_FLOAT or SC_DOUBLE; gap: bytes between vertices, 0 for a packed array and stride 0. */
input_array input_positions(const double *positions, uint32_t count, uint32_t type, uint32_t gap);
/* type is SC_UINT32 or SC_UINT16. */
input_array input_indices(const uint32_t *triangles, uint32_t count, uint32_t type, uint32_t gap);
void input_free(input_array *array);

sc_mesh input_mesh(const soup *s, const input_array *positions, const input_array *indices);
sc_pose input_pose(uint32_t vertex_count, const input_array *positions);

/* A plain mesh or pose: double, uint32, packed, pointing into the soup. */
sc_mesh input_plain_mesh(const soup *s);
sc_pose input_plain_pose(const double *positions, uint32_t vertex_count);

/* Kind SC_PAIRS_..., contact SC_CONTACT_... and method SC_METHOD_...; all else by default. */
sc_query_options input_query(uint32_t kind, uint32_t contact, uint32_t method);

/* Choices of a build and the arrays that they point to. */
typedef struct input_choices {
    sc_build_options options;
    uint32_t *weld_map, *order;
    sc_tree_node *tree;
    const char *partition_name;
} input_choices;

/* A random weld (kind SC_WELD_...) and partition (kind SC_PARTITION_...) for a soup. */
input_choices input_choose(const soup *s, uint32_t weld, uint32_t partition);
void input_free_choices(input_choices *choices);

/* What choices weld, as a map: from the rest pose s for SC_WELD_REST. To be freed. */
uint32_t *input_weld_of(const input_choices *choices, const soup *s);

/* An sc_bisect that cuts at left_target, by node number or at random if user is not NULL. */
sc_status input_bisect(void *user, const sc_dual_graph *graph, uint32_t left_target, uint8_t *side);

/*
 * Reads an OBJ file (v and f lines; faces of more corners become fans). Returns 1, or 0 after
 * leaving *s empty when the file cannot be read or is no such file.
 */
int input_read_obj(const char *path, soup *s);

#endif /* SC_TESTS_INPUTS_H */
