/*
 * Laying a model out, and whose memory it is. See model.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/model.h"

#include <string.h>

/* A compiler stops here if the owner does not fit before the model. */
typedef char owner_fits_one_unit[sizeof(sc_model_owner) <= SC_ALIGNMENT ? 1 : -1];

/* How many bytes each array has. */
static void measure_arrays(const sc_model *m, uint64_t bytes[SC_ARRAY_COUNT])
{
    uint32_t vertex_count = m->vertex_count, triangle_count = m->triangle_count;
    uint32_t leaf_count = m->leaf_count, level_count = m->level_count;
    uint32_t patch_end = m->patch_end, around_total = m->around_total, node_count = m->node_count;
    uint32_t contour_total = m->contour_total, loop_total = m->loop_total;
    uint32_t segment_count = m->segment_count, leaf_segment_count = m->leaf_segment_count;
    uint32_t segment_point_total = m->segment_point_total, share_count = m->share_count;
    uint32_t share_total = m->share_total;
    uint32_t segment_child_total = m->segment_child_total;
#define MEASURE(name, type, count) bytes[SC_ARRAY_##name] = (uint64_t)(count) * sizeof(type);
    SC_MODEL_ARRAYS(MEASURE)
#undef MEASURE
}

static uint64_t padded(uint64_t bytes)
{
    return (bytes + SC_ALIGNMENT - 1) / SC_ALIGNMENT * SC_ALIGNMENT;
}

void sc_model_lay_out(sc_model *m)
{
    uint64_t bytes[SC_ARRAY_COUNT];
    int array;
    measure_arrays(m, bytes);
    m->bytes = padded(sizeof *m);
    for (array = 0; array < SC_ARRAY_COUNT; array++) {
        m->offset[array] = m->bytes;
        m->bytes += padded(bytes[array]);
    }
}

void sc_model_clear_gaps(sc_model *m)
{
    uint64_t bytes[SC_ARRAY_COUNT], begin = sizeof *m;
    int array;
    measure_arrays(m, bytes);
    bytes[SC_ARRAY_level_info] = 0;
    for (array = 0; array <= SC_ARRAY_COUNT; array++) {
        uint64_t end = array < SC_ARRAY_COUNT ? m->offset[array] : m->bytes;
        memset((unsigned char *)m + begin, 0, (size_t)(end - begin));
        if (array < SC_ARRAY_COUNT) begin = end + bytes[array];
    }
}

sc_model *sc_model_allocate(uint64_t bytes, sc_scratch *scratch)
{
    sc_model_owner *owner;
    bytes += SC_ALIGNMENT;
    owner = (sc_model_owner *)sc_scratch_allocate(scratch, bytes);
    if (!owner) return NULL;
    memset(owner, 0, SC_ALIGNMENT);
    owner->kind = SC_MODEL_OWNED;
    owner->allocator = scratch->allocator;
    owner->bytes = bytes;
    return (sc_model *)(void *)((unsigned char *)owner + SC_ALIGNMENT);
}

const sc_model_owner *sc_model_owner_of(const sc_model *model)
{
    const sc_model_owner *owner =
        (const sc_model_owner *)(const void *)((const unsigned char *)model - SC_ALIGNMENT);
    return owner->kind == SC_MODEL_OWNED ? owner : NULL;
}

void sc_model_note_memory(sc_model *model, const sc_scratch *scratch)
{
    sc_model_owner *owner = (sc_model_owner *)(void *)((unsigned char *)model - SC_ALIGNMENT);
    owner->peak_bytes = scratch->peak_bytes;
    owner->allocations = scratch->allocations;
}

void sc_model_release(sc_model *model)
{
    sc_model_owner *owner = (sc_model_owner *)(void *)((unsigned char *)model - SC_ALIGNMENT);
    sc_allocator allocator;
    if (owner->kind != SC_MODEL_OWNED) return;
    allocator = owner->allocator;
    allocator.release(allocator.user, owner, owner->bytes);
}
