/*
 * What index.js needs besides the library itself: where members of its structures are, and why a
 * call was refused.
 *
 * SPDX-License-Identifier: MIT
 *
 * The layouts come from the header by the compiler, so that JavaScript has no offsets to keep in
 * step with it: as text, a line for each structure with its size, then one for each member with its
 * offset and kind: w a number of 32 bits or a pointer, l one of 64 bits, d a double.
 */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "starcontour.h"

const char *sc_layouts(void);
const sc_hooks *sc_refusal_hooks(void);
char *sc_refusal(void);

enum { NAME_ROOM = 32, REFUSAL_ROOM = 1000 };

typedef struct layout_entry {
    char name[NAME_ROOM];
    uint32_t at; /* of a structure its size */
    char kind;   /* s: a structure */
    char fits;   /* whether the member is as wide as its kind */
} layout_entry;

#define WIDTH(of, member) sizeof(((of *)0)->member)
#define STRUCTURE(of)                                                                              \
  {                                                                                                \
#    of, sizeof(of), 's', 1                                                                        \
  }
#define WORD(of, member)                                                                           \
  {                                                                                                \
#    member, offsetof(of, member), 'w', WIDTH(of, member) == 4                                     \
  }
#define LONG(of, member)                                                                           \
  {                                                                                                \
#    member, offsetof(of, member), 'l', WIDTH(of, member) == 8                                     \
  }
#define REAL(of, member)                                                                           \
  {                                                                                                \
#    member, offsetof(of, member), 'd', WIDTH(of, member) == 8                                     \
  }
/* An array, of which only the place is wanted. */
#define ARRAY(of, member)                                                                          \
  {                                                                                                \
#    member, offsetof(of, member), 'w', 1                                                          \
  }

static const layout_entry entries[] = {
    STRUCTURE(sc_mesh),
    WORD(sc_mesh, struct_size),
    WORD(sc_mesh, vertex_count),
    WORD(sc_mesh, triangle_count),
    WORD(sc_mesh, position_type),
    WORD(sc_mesh, index_type),
    WORD(sc_mesh, positions),
    WORD(sc_mesh, indices),
    STRUCTURE(sc_pose),
    WORD(sc_pose, struct_size),
    WORD(sc_pose, vertex_count),
    WORD(sc_pose, position_type),
    WORD(sc_pose, positions),
    STRUCTURE(sc_build_options),
    WORD(sc_build_options, struct_size),
    WORD(sc_build_options, weld),
    WORD(sc_build_options, partition),
    WORD(sc_build_options, weld_map),
    WORD(sc_build_options, order),
    WORD(sc_build_options, hooks),
    WORD(sc_build_options, content),
    STRUCTURE(sc_load_options),
    WORD(sc_load_options, struct_size),
    WORD(sc_load_options, hooks),
    STRUCTURE(sc_model_info),
    WORD(sc_model_info, struct_size),
    WORD(sc_model_info, vertex_count),
    WORD(sc_model_info, point_count),
    WORD(sc_model_info, triangle_count),
    WORD(sc_model_info, edge_count),
    WORD(sc_model_info, component_count),
    WORD(sc_model_info, boundary_edges),
    WORD(sc_model_info, irregular_edges),
    WORD(sc_model_info, leaf_count),
    WORD(sc_model_info, level_count),
    LONG(sc_model_info, model_bytes),
    LONG(sc_model_info, workspace_bytes),
    STRUCTURE(sc_workspace_options),
    WORD(sc_workspace_options, struct_size),
    WORD(sc_workspace_options, flags),
    STRUCTURE(sc_filter),
    WORD(sc_filter, struct_size),
    WORD(sc_filter, ignore_rings),
    WORD(sc_filter, vertex_groups),
    WORD(sc_filter, triangle_groups),
    WORD(sc_filter, ignore),
    LONG(sc_filter, ignore_count),
    STRUCTURE(sc_query_options),
    WORD(sc_query_options, struct_size),
    WORD(sc_query_options, output),
    WORD(sc_query_options, pairs),
    WORD(sc_query_options, contact),
    WORD(sc_query_options, method),
    WORD(sc_query_options, filter),
    LONG(sc_query_options, budget),
    STRUCTURE(sc_result),
    WORD(sc_result, struct_size),
    WORD(sc_result, collides),
    LONG(sc_result, count),
    LONG(sc_result, capacity),
    WORD(sc_result, pairs),
    STRUCTURE(sc_step_options),
    WORD(sc_step_options, struct_size),
    WORD(sc_step_options, output),
    WORD(sc_step_options, pairs),
    WORD(sc_step_options, times),
    WORD(sc_step_options, method),
    REAL(sc_step_options, separation),
    REAL(sc_step_options, tolerance),
    LONG(sc_step_options, budget),
    WORD(sc_step_options, vertex_face_filter),
    WORD(sc_step_options, edge_edge_filter),
    WORD(sc_step_options, rest),
    REAL(sc_step_options, rest_distance),
    WORD(sc_step_options, begun),
    STRUCTURE(sc_step_result),
    WORD(sc_step_result, struct_size),
    WORD(sc_step_result, collides),
    LONG(sc_step_result, vertex_face_count),
    LONG(sc_step_result, vertex_face_capacity),
    WORD(sc_step_result, vertex_faces),
    WORD(sc_step_result, vertex_face_times),
    LONG(sc_step_result, edge_edge_count),
    LONG(sc_step_result, edge_edge_capacity),
    WORD(sc_step_result, edge_edges),
    WORD(sc_step_result, edge_edge_times),
    REAL(sc_step_result, earliest),
    STRUCTURE(sc_near_options),
    WORD(sc_near_options, struct_size),
    WORD(sc_near_options, output),
    WORD(sc_near_options, kinds),
    WORD(sc_near_options, method),
    REAL(sc_near_options, distance),
    WORD(sc_near_options, vertex_face_filter),
    WORD(sc_near_options, edge_edge_filter),
    WORD(sc_near_options, rest),
    REAL(sc_near_options, rest_distance),
    LONG(sc_near_options, budget),
    STRUCTURE(sc_near_result),
    WORD(sc_near_result, struct_size),
    WORD(sc_near_result, found),
    LONG(sc_near_result, vertex_face_count),
    LONG(sc_near_result, vertex_face_capacity),
    WORD(sc_near_result, vertex_faces),
    LONG(sc_near_result, edge_edge_count),
    LONG(sc_near_result, edge_edge_capacity),
    WORD(sc_near_result, edge_edges),
    WORD(sc_near_result, vertex_bounds),
    STRUCTURE(sc_contact),
    WORD(sc_contact, kind),
    ARRAY(sc_contact, points),
    ARRAY(sc_contact, weights_a),
    ARRAY(sc_contact, weights_b),
    STRUCTURE(sc_near_stencil),
    WORD(sc_near_stencil, feature),
    WORD(sc_near_stencil, flags),
    ARRAY(sc_near_stencil, vertices),
    ARRAY(sc_near_stencil, weights),
    ARRAY(sc_near_stencil, vector),
    REAL(sc_near_stencil, distance),
    STRUCTURE(sc_step_stencil),
    ARRAY(sc_step_stencil, start),
    ARRAY(sc_step_stencil, impact),
    REAL(sc_step_stencil, time),
    ARRAY(sc_step_stencil, normal),
    WORD(sc_step_stencil, side),
    WORD(sc_step_stencil, flags),
    STRUCTURE(sc_trace_options),
    WORD(sc_trace_options, struct_size),
    WORD(sc_trace_options, hooks),
    STRUCTURE(sc_trace_node),
    WORD(sc_trace_node, edge),
    WORD(sc_trace_node, triangle),
    WORD(sc_trace_node, sheet),
    ARRAY(sc_trace_node, sheets),
    REAL(sc_trace_node, along),
    ARRAY(sc_trace_node, weights),
    ARRAY(sc_trace_node, point),
    STRUCTURE(sc_trace_contour),
    LONG(sc_trace_contour, first),
    LONG(sc_trace_contour, count),
    WORD(sc_trace_contour, begin),
    WORD(sc_trace_contour, end),
    WORD(sc_trace_contour, flags),
    REAL(sc_trace_contour, length),
    STRUCTURE(sc_trace_result),
    WORD(sc_trace_result, struct_size),
    LONG(sc_trace_result, node_count),
    LONG(sc_trace_result, node_capacity),
    WORD(sc_trace_result, nodes),
    LONG(sc_trace_result, contour_count),
    LONG(sc_trace_result, contour_capacity),
    WORD(sc_trace_result, contours),
    STRUCTURE(sc_trace_triple),
    ARRAY(sc_trace_triple, triangles),
    ARRAY(sc_trace_triple, nodes),
    ARRAY(sc_trace_triple, along),
    ARRAY(sc_trace_triple, point),
    STRUCTURE(sc_triples_result),
    WORD(sc_triples_result, struct_size),
    LONG(sc_triples_result, count),
    LONG(sc_triples_result, capacity),
    WORD(sc_triples_result, triples),
    STRUCTURE(sc_region),
    WORD(sc_region, component),
    WORD(sc_region, vertex_count),
    REAL(sc_region, area),
    WORD(sc_region, inside),
    STRUCTURE(sc_regions_result),
    WORD(sc_regions_result, struct_size),
    WORD(sc_regions_result, flags),
    LONG(sc_regions_result, region_count),
    LONG(sc_regions_result, region_capacity),
    WORD(sc_regions_result, regions),
    WORD(sc_regions_result, vertex_regions),
    WORD(sc_regions_result, sides),
    STRUCTURE(sc_trace_gradient),
    ARRAY(sc_trace_gradient, vertices),
    WORD(sc_trace_gradient, flags),
    ARRAY(sc_trace_gradient, weights),
    ARRAY(sc_trace_gradient, vectors),
};

enum { ENTRIES = sizeof entries / sizeof *entries };

/* NULL if a member is not of the width said above. */
const char *sc_layouts(void)
{
    static char text[ENTRIES * (NAME_ROOM + 16)];
    char *end = text;
    for (int i = 0; i < ENTRIES; ++i) {
        if (!entries[i].fits) return NULL;
        end +=
            sprintf(end, "%c %s %u\n", entries[i].kind, entries[i].name, (unsigned)entries[i].at);
    }
    return text;
}

static char refusal[REFUSAL_ROOM];

static void hear(void *user, uint32_t level, const char *message)
{
    (void)user;
    if (level != SC_LOG_ERROR) return;
    strncpy(refusal, message, REFUSAL_ROOM - 1);
}

/* Hooks that keep the last reason why something was refused. */
const sc_hooks *sc_refusal_hooks(void)
{
    static const sc_hooks hooks = {sizeof(hooks), 0, hear, NULL, NULL};
    return &hooks;
}

/* That reason; whoever has read it makes it empty. */
char *sc_refusal(void)
{
    return refusal;
}
