/*
 * Kernels: inner loops that are compiled for each instruction set, in files named ..._kernel.h.
 *
 * SPDX-License-Identifier: MIT
 *
 * A workspace has the table of those for the query at hand. What a folder's part of it holds is
 * declared in that folder, so that only those who call kernels see what these take.
 */
#ifndef SC_SIMD_KERNELS_H
#define SC_SIMD_KERNELS_H

#include "simd/isa.h"

struct sc_pose_kernels;  /* pose/pose_kernels.h */
struct sc_query_kernels; /* query/query_kernels.h */
struct sc_step_kernels;  /* step/step_kernels.h */
struct sc_trace_kernels; /* trace/trace_kernels.h */
struct sc_worker;        /* query/worker.h */

/* A stage: takes `most` items of its list or fewer, see run/stages.h. */
typedef void sc_stage(struct sc_worker *w, uint32_t most);

/* What is asked: for intersections, in a step, or for what is near. */
enum { SC_QUESTION_QUERY, SC_QUESTION_STEP, SC_QUESTION_NEAR, SC_QUESTIONS };

typedef struct sc_kernels {
    const struct sc_pose_kernels *pose;
    const struct sc_query_kernels *query;
    const struct sc_step_kernels *step;
    const struct sc_trace_kernels *trace;
    sc_stage *const *stages[SC_QUESTIONS][2]; /* by lists: of one object, and between two */
} sc_kernels;

extern const sc_kernels sc_kernels_base;
#if SC_ISA_X86
extern const sc_kernels sc_kernels_avx2, sc_kernels_avx512;
#endif

/* Those for an instruction set that this machine has. */
static inline const sc_kernels *sc_kernels_for(uint32_t isa)
{
#if SC_ISA_X86
    if (isa == SC_ISA_AVX512) return &sc_kernels_avx512;
    if (isa == SC_ISA_AVX2) return &sc_kernels_avx2;
#endif
    (void)isa;
    return &sc_kernels_base;
}

#endif
