/*
 * A spatial hash for self-collision, to compare with: M. Teschner, B. Heidelberger, M. Mueller,
 * D. Pomeranets, M. Gross, "Optimized Spatial Hashing for Collision Detection of Deformable
 * Objects", Vision, Modeling, and Visualization 2003; with edges in place of vertices.
 *
 * SPDX-License-Identifier: MIT
 *
 * Space is cut into cubes as long as the mesh's average edge at rest. For each pose every edge is
 * put into the cells that its box meets, and every triangle looks at the edges in the cells that
 * its box meets. A pair that meets in several cells is tested in one of them only.
 *
 * Exact: pairs are those of starcontour.h, sorted. Double arithmetic with error bounds decides
 * nearly all; what it cannot decide is asked of the library, as a mesh of two triangles.
 *
 * Memory grows with the number of cells that edges meet: 24 bytes each. Not for meshes with a
 * triangle that names a vertex twice.
 */
#ifndef BENCH_SPATIAL_HASH_H
#define BENCH_SPATIAL_HASH_H

#include "starcontour.h"

#include <stdbool.h>

typedef struct spatial_hash spatial_hash;

/* What a query found. The pairs belong to the hash and live until its next query. */
typedef struct spatial_hash_answer {
    const sc_pair *pairs;
    uint64_t count;
    uint64_t box_tests;       /* pairs of an edge and a triangle whose boxes were compared */
    uint64_t primitive_tests; /* pairs that were then tested exactly */
    uint64_t undecided;       /* of these, how many double arithmetic could not decide */
} spatial_hash_answer;

/*
 * Prepares for a mesh in its rest pose: positions has 3 * vertex_count entries, indices
 * 3 * triangle_count. Both are copied as far as needed. Vertices with equal positions are joined,
 * as SC_WELD_REST does. On failure NULL, and *reason says why.
 */
spatial_hash *spatial_hash_create(const double *positions, uint32_t vertex_count,
                                  const uint32_t *indices, uint32_t triangle_count,
                                  const char **reason);

void spatial_hash_free(spatial_hash *hash);

/* Bytes in use, growth by queries included. */
uint64_t spatial_hash_bytes(const spatial_hash *hash);

/*
 * Finds the pairs of a pose: pairs is SC_PAIRS_..., contact SC_CONTACT_.... False if there is no
 * memory or an edge meets too many cells; the answer is then empty.
 */
bool spatial_hash_query(spatial_hash *hash, const double *positions, uint32_t pairs,
                        uint32_t contact, spatial_hash_answer *answer);

#endif /* BENCH_SPATIAL_HASH_H */
