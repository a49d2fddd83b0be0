/*
 * Pairs of features; see feature_pairs.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "feature_pairs.h"

#include "query_text.h"

const char *const feature_pairs_names[KINDS] = {"vertex-face", "edge-edge"};

uint32_t feature_pairs_object(const mesh_file *mesh, const uint32_t *vertex_objects, int kind,
                              sc_pair pair, int side, uint32_t *triangle)
{
    const uint32_t number = side ? pair.b : pair.a;
    *triangle = kind == EDGE_EDGE ? number / 3 : side ? number : SC_NONE;
    if (*triangle != SC_NONE) return mesh_object_of(mesh, *triangle);
    return vertex_objects[number];
}

bool feature_pairs_tally(mesh_tally *tally, const mesh_file *mesh, const uint32_t *vertex_objects,
                         int kind, const sc_pair *pairs, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        uint32_t of[2], triangle;
        for (int side = 0; side < 2; side++)
            of[side] = feature_pairs_object(mesh, vertex_objects, kind, pairs[i], side, &triangle);
        if (!mesh_tally_add(tally, of[0], of[1])) return false;
    }
    return true;
}

void feature_pairs_add_owners(cJSON *object, const mesh_file *mesh, const uint32_t *vertex_objects,
                              int kind, sc_pair pair)
{
    for (int side = 0; side < 2; side++) {
        uint32_t triangle;
        const uint32_t of = feature_pairs_object(mesh, vertex_objects, kind, pair, side, &triangle);
        query_text_add_owner(object, side ? 'b' : 'a', mesh, triangle, of);
    }
}

void feature_pairs_write_owners(FILE *out, const mesh_file *mesh, const uint32_t *vertex_objects,
                                int kind, sc_pair pair)
{
    for (int side = 0; side < 2; side++) {
        uint32_t triangle;
        const uint32_t of = feature_pairs_object(mesh, vertex_objects, kind, pair, side, &triangle);
        fputc(',', out);
        query_text_owner(out, mesh, triangle, of);
    }
}
