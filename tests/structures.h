/*
 * What is made of a mesh, step by step, held against slow and obvious rules: triangles, edges,
 * patches, the test tree, contours. For test_structures.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_STRUCTURES_H
#define TESTS_STRUCTURES_H

#include <stdint.h>

#include "base/memory.h"
#include "build/adjacency.h"
#include "build/csf.h"
#include "build/hierarchy.h"
#include "build/mesh.h"
#include "build/neighbors.h"
#include "build/sctt.h"
#include "build/xbvh.h"
#include "soups.h"
#include "starcontour.h"

/* The steps of sc_build. */
typedef struct structures {
    sc_scratch scratch;
    sc_points points;
    sc_adjacency adjacency;
    sc_hierarchy hierarchy;
    sc_xbvh xbvh;
    sc_neighbors neighbors;
    sc_sctt sctt;
    sc_csf csf;
    const char *name;
} structures;

/* Takes them; whatever it returns, structures_free ends it. */
sc_status structures_make(structures *s, const soup *mesh, const sc_build_options *options);

void structures_free(structures *s);

/* test_allocate, with zeros. */
void *structures_zeroed(size_t size);

/* Edges, their owners and opposite half-edges, by sorting all half-edges. */
void structures_check_edges(const structures *s);

/* Components that share points, by spreading the lowest triangle number. */
void structures_check_components(const structures *s);

/* patch[level * triangle_count + t]: the patch of triangle t, counted from 0 at each level. Leaf
   clusters reached early are repeated. */
typedef struct structures_patches {
    uint32_t levels, triangles;
    uint32_t *patch;
    uint32_t *count;   /* levels */
    uint8_t *finished; /* levels * triangles, by patch: a leaf cluster */
    uint32_t *parent;  /* levels * triangles, by patch */
} structures_patches;

/* By walking the hierarchy. */
structures_patches structures_find_patches(const structures *s);
void structures_free_patches(structures_patches *p);

/* Of leaf clusters cut from an order: none but the last could take one triangle more. */
void structures_check_full_leaves(const structures *s);

/* Levels, children and sizes of patches. */
void structures_check_xbvh(const structures *s, const structures_patches *p);

/* Every adjacent pair of a level is one node, every other pair of children of a tested pair one
   BVTT child, all of them below the right parents. */
void structures_check_sctt(const structures *s, const structures_patches *p);

/* Nodes of leaf clusters and everything below BVTT children: each pair of leaf clusters once. */
void structures_check_leaf_pairs(const structures *s);

/* Of a contour segment. */
uint32_t structures_count_edges(const sc_csf *csf, uint32_t segment);

/* Writes a segment's edges in order. */
sc_pair *structures_flatten(const sc_csf *csf, uint32_t segment, sc_pair *out);

/* For qsort: by a, then by b. */
int structures_compare_pairs(const void *x, const void *y);

/* Contours and their segments: the edges that exactly one side of a node has, in chains. */
void structures_check_contours(const structures *s, const structures_patches *p);

#endif
