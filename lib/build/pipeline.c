/*
 * From a mesh to a model. See pipeline.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/pipeline.h"

#include <inttypes.h>
#include <string.h>

#include "base/hooks.h"
#include "build/assembly.h"
#include "build/locality.h"
#include "build/model_check.h"
#include "build/partition.h"

/* What building makes, in order. */
typedef struct steps {
    sc_points points;
    sc_adjacency adjacency;
    sc_hierarchy hierarchy;
    sc_xbvh xbvh;
    sc_sharing sharing;
    sc_neighbors neighbors;
    sc_sctt sctt;
    sc_csf csf;
    int has_tests; /* neighbors, sctt and csf were built */
} steps;

/* In builds with SC_VALIDATE (make config=debug or sanitize): everything is as its header says.
   Uses memory of its own, so that the caller's allocator may fail where it likes. */
static void validate(const steps *s, const sc_hooks *hooks)
{
#ifdef SC_VALIDATE
    sc_allocator standard = sc_memory_allocator(NULL);
    sc_scratch scratch;
    sc_scratch_init(&scratch, &standard);
    SC_HOOKS_ASSERT(hooks, sc_hierarchy_validate(&s->hierarchy, &scratch));
    SC_HOOKS_ASSERT(hooks, sc_xbvh_validate(&s->xbvh));
    SC_HOOKS_ASSERT(hooks, !s->has_tests || sc_sctt_validate(&s->xbvh, &s->neighbors, &s->sctt));
    SC_HOOKS_ASSERT(hooks, !s->has_tests || sc_csf_validate(&s->csf, &s->sctt, &scratch));
    SC_HOOKS_ASSERT(hooks,
                    s->points.triangle_count > 2000 || /* quadratic */
                        sc_sharing_validate(&s->points, s->hierarchy.order, &s->xbvh, &s->sharing));
    sc_scratch_clear(&scratch);
#else
    (void)s;
    (void)hooks;
#endif
}

/* The same of the model: what is built is also what would be taken if it had been saved. */
static void validate_model(const sc_model *model, const sc_hooks *hooks)
{
#ifdef SC_VALIDATE
    sc_allocator standard = sc_memory_allocator(NULL);
    const char *wrong;
    sc_scratch scratch;
    sc_scratch_init(&scratch, &standard);
    SC_HOOKS_ASSERT(hooks, sc_model_check(model, &scratch, &wrong) == SC_OK);
    sc_scratch_clear(&scratch);
#else
    (void)model;
    (void)hooks;
#endif
}

/* What culling needs: the self-collision test tree and its contours. */
static sc_status build_tests(steps *s, sc_scratch *scratch)
{
    const uint32_t *order = s->hierarchy.order;
    sc_status status = sc_neighbors_build(&s->points, &s->adjacency, order, &s->xbvh, &s->sharing,
                                          scratch, &s->neighbors);
    if (!status) status = sc_sctt_build(&s->xbvh, &s->neighbors, scratch, &s->sctt);
    if (!status)
        status =
            sc_csf_build(&s->points, &s->adjacency, order, &s->xbvh, &s->sctt, scratch, &s->csf);
    s->has_tests = !status;
    return status;
}

/* The same for SC_MODEL_BOXES: a test tree without nodes. */
static sc_status leave_out_tests(steps *s, sc_scratch *scratch)
{
    uint32_t *none = (uint32_t *)sc_scratch_take_filled(scratch, (uint64_t)s->xbvh.level_count + 1,
                                                        sizeof *none, 0);
    if (!none) return SC_ERROR_MEMORY;
    s->sctt.child = s->sctt.level_first = none;
    s->csf.child_first = s->csf.contour_first = s->csf.loop_first = s->csf.level_segments = none;
    return SC_OK;
}

sc_status sc_pipeline_run(const sc_mesh *mesh, const sc_build_options *options, sc_scratch *scratch,
                          sc_model **model)
{
    steps s;
    sc_status status;
    int curve = options->content == SC_MODEL_FULL ? SC_LOCALITY_Z : SC_LOCALITY_HILBERT;
    memset(&s, 0, sizeof s);
    if ((status = sc_mesh_read(mesh, options, scratch, &s.points))) return status;
    if (options->partition == SC_PARTITION_FAST || options->partition == SC_PARTITION_BISECT)
        if ((status = sc_locality_sort(&s.points, curve, scratch))) return status;
    if ((status = sc_adjacency_build(&s.points, scratch, &s.adjacency))) return status;
    if ((status = sc_partition_build(&s.points, &s.adjacency, options, scratch, &s.hierarchy)))
        return status;
    if ((status = sc_xbvh_build(&s.hierarchy, scratch, &s.xbvh))) return status;
    if ((status = sc_sharing_build(&s.points, &s.adjacency, s.hierarchy.order, &s.xbvh, scratch,
                                   &s.sharing)))
        return status;
    status =
        options->content == SC_MODEL_FULL ? build_tests(&s, scratch) : leave_out_tests(&s, scratch);
    if (status) return status;
    validate(&s, options->hooks);
    sc_neighbors_free(&s.neighbors, scratch);
    sc_scratch_give(scratch, s.sharing.touch);
    sc_scratch_give(scratch, s.points.rest);
    if ((status = sc_assembly_make(&s.points, &s.adjacency, &s.hierarchy, &s.xbvh, &s.sctt, &s.csf,
                                   &s.sharing, scratch, model)))
        return status;
    validate_model(*model, options->hooks);
    return SC_OK;
}

void sc_pipeline_log_facts(const sc_hooks *hooks, const sc_model *m)
{
    const uint8_t *use = sc_model_vertex_use(m);
    const sc_level *last = &sc_model_level_info(m)[m->level_count - 1];
    uint32_t v, unused = 0, welded = 0, scattered = last->patch_count - last->connected_patches;
    const char *less = sc_model_is_for_boxes(m) ? "" : ": what is round them is culled less";
    if (!hooks->log) return;
    for (v = 0; v < m->vertex_count; v++) {
        unused += use[v] == SC_VERTEX_UNUSED;
        welded += use[v] == SC_VERTEX_WELDED;
    }
    if (unused) sc_hooks_log(hooks, SC_LOG_NOTE, "%" PRIu32 " vertices are in no triangle", unused);
    if (welded)
        sc_hooks_log(hooks, SC_LOG_NOTE, "%" PRIu32 " vertices are welded to others", welded);
    if (m->component_count > 1)
        sc_hooks_log(hooks, SC_LOG_NOTE, "%" PRIu32 " components", m->component_count);
    if (m->irregular_edges)
        sc_hooks_log(hooks, SC_LOG_WARNING,
                     "%" PRIu32 " of %" PRIu32
                     " edges have three or more triangles, or two that run the same way%s",
                     m->irregular_edges, m->edge_count, less);
    if (scattered && !sc_model_is_for_boxes(m))
        sc_hooks_log(hooks, SC_LOG_NOTE,
                     "%" PRIu32 " of %" PRIu32
                     " leaf clusters are not connected through edges and culled less",
                     scattered, last->patch_count);
}
