/*
 * The inner loops over a pose that are compiled for several instruction sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_POSE_KERNELS_H
#define SC_POSE_KERNELS_H

#include "base/isa.h"
#include "pose/workspace.h"

typedef struct sc_pose_kernels {
    /* The normal cone of 1 to SC_LEAF_MAX triangles given by their corners, see pose/dnc.h. */
    uint32_t (*cone)(const sc_workspace *workspace, const uint32_t *corner, uint32_t count);
    /* Boxes of the triangles of a leaf cluster and its own, see pose/refit.h. */
    void (*refit_leaf)(const sc_model *model, sc_workspace *workspace, uint32_t leaf);
    /* 1 if the fan of a ring of 3 to 16 points certainly projects one to one, see pose/fan.h. */
    int (*is_plain)(const sc_workspace *workspace, const uint32_t *ring, uint32_t count,
                    uint32_t point);
} sc_pose_kernels;

extern const sc_pose_kernels sc_pose_kernels_base;
#if SC_ISA_X86
extern const sc_pose_kernels sc_pose_kernels_avx2, sc_pose_kernels_avx512;
#endif

/* Those for the query at hand. */
static inline const sc_pose_kernels *sc_pose_kernels_of(const sc_workspace *workspace)
{
#if SC_ISA_X86
    if (workspace->isa == SC_ISA_AVX512) return &sc_pose_kernels_avx512;
    if (workspace->isa == SC_ISA_AVX2) return &sc_pose_kernels_avx2;
#endif
    (void)workspace;
    return &sc_pose_kernels_base;
}

#endif
