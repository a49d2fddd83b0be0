/*
 * Bisection by METIS: a library of its own, so that the core needs none. See starcontour_metis.h.
 *
 * SPDX-License-Identifier: MIT
 */
#if !defined(_WIN32) && !defined(_XOPEN_SOURCE)
#  define _XOPEN_SOURCE 700 /* sigaction, initstate */
#endif
#include "starcontour_metis.h"

#if defined(SC_WITH_METIS)

#  include <metis.h>
#  include <signal.h>
#  include <stdlib.h>

#  include "base/assume.h"

/* Patches of two leaf clusters. METIS would take three microseconds a triangle for them, and
   queries are no faster for it. */
enum { SMALL = 32 };

/* Writes the nodes of a small graph to order: by their distance from the first. */
static void walk(const sc_dual_graph *graph, uint8_t first, uint8_t *order)
{
    uint8_t met[SMALL] = {0};
    uint32_t head, tail = 0, next = first;
    int32_t k;
    for (head = 0; head < graph->node_count; head++) {
        if (head == tail) { /* at the start, and where graphs are not connected */
            while (met[next]) next = (next + 1) % graph->node_count;
            met[next] = 1;
            order[tail++] = (uint8_t)next;
        }
        for (k = graph->offsets[order[head]]; k < graph->offsets[order[head] + 1]; k++) {
            uint8_t node = (uint8_t)graph->neighbors[k];
            if (met[node]) continue;
            met[node] = 1;
            order[tail++] = node;
        }
    }
}

/* One end of a small graph against the other. */
static void cut_small(const sc_dual_graph *graph, uint32_t left_target, uint8_t *side)
{
    uint8_t order[SMALL] = {0};
    uint32_t i;
    for (i = 0; i < 3; i++) walk(graph, order[i ? graph->node_count - 1 : 0], order);
    for (i = 0; i < graph->node_count; i++) side[order[i]] = i >= left_target;
}

/* METIS's integers may be wider than ours. Returns the place after the last. */
static idx_t *widen(const int32_t *from, uint64_t count, idx_t *to)
{
    uint64_t i;
    for (i = 0; i < count; i++) to[i] = from[i];
    return to + count;
}

#  if defined(_WIN32)
typedef void (*disposition)(int);
#    define SAVE(number, saved) (*(saved) = signal(number, SIG_DFL))
#    define RESTORE(number, saved) signal(number, *(saved))
#  else
typedef struct sigaction disposition;
#    define SAVE(number, saved) sigaction(number, NULL, saved)
#    define RESTORE(number, saved) sigaction(number, saved, NULL)
#  endif

/* What METIS changes in the process. The GNU C library's rand draws from the state of random, which
   can be put aside; that of other libraries' rand cannot. */
typedef struct process_state {
    disposition abort_action, terminate_action;
#  if defined(__GLIBC__)
    char *random_state;
    char scratch_state[128];
#  endif
} process_state;

static void save_process(process_state *state)
{
    SAVE(SIGABRT, &state->abort_action);
    SAVE(SIGTERM, &state->terminate_action);
#  if defined(__GLIBC__)
    state->random_state = initstate(1, state->scratch_state, sizeof state->scratch_state);
#  endif
}

static void restore_process(const process_state *state)
{
#  if defined(__GLIBC__)
    setstate(state->random_state);
#  endif
    RESTORE(SIGTERM, &state->terminate_action);
    RESTORE(SIGABRT, &state->abort_action);
}

static int bisect(const sc_dual_graph *graph, uint32_t left_target, idx_t *offsets,
                  idx_t *neighbors, idx_t *weights, idx_t *part)
{
    idx_t options[METIS_NOPTIONS], nodes = (idx_t)graph->node_count, constraints = 1, parts = 2,
                                   cut;
    real_t share[2];
    process_state process;
    int result;
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_SEED] = 1;
    options[METIS_OPTION_UFACTOR] = nodes > 200 ? 20 : 40; /* imbalance allowed, in thousandths */
    options[METIS_OPTION_NCUTS] = nodes < 2000 ? 2 : 1;
    share[0] = (real_t)left_target / (real_t)graph->node_count;
    share[1] = 1 - share[0];
    save_process(&process);
    result = METIS_PartGraphRecursive(&nodes, &constraints, offsets, neighbors, NULL, NULL, weights,
                                      &parts, share, NULL, options, &cut, part);
    restore_process(&process);
    return result;
}

sc_status sc_metis_bisect(void *user, const sc_dual_graph *graph, uint32_t left_target,
                          uint8_t *side)
{
    uint64_t nodes, arcs;
    idx_t *offsets, *neighbors, *weights, *part;
    uint32_t i, zeros = 0;
    int result;
    (void)user;
    if (!graph || !side) return SC_ERROR_NULL;
    nodes = graph->node_count;
    if (left_target == 0 || left_target >= nodes) return SC_ERROR_PARTITION; /* METIS would print */
    if (nodes <= SMALL) {
        cut_small(graph, left_target, side);
        return SC_OK;
    }
    arcs = (uint64_t)graph->offsets[nodes];
    offsets = (idx_t *)calloc((size_t)(2 * nodes + 1 + 2 * arcs), sizeof *offsets);
    if (!offsets) return SC_ERROR_MEMORY;
    neighbors = widen(graph->offsets, nodes + 1, offsets);
    weights = widen(graph->neighbors, arcs, neighbors);
    part = widen(graph->weights, arcs, weights);
    result = bisect(graph, left_target, offsets, neighbors, weights, part);
    for (i = 0; i < nodes; i++) {
        side[i] = part[i] != 0;
        zeros += side[i] == 0;
    }
    free(offsets);
    if (result == METIS_ERROR_MEMORY) return SC_ERROR_MEMORY;
    if (SC_HARDLY(result != METIS_OK))
        return SC_ERROR_PARTITION; /* what other versions may refuse */
    /* small graphs are at times put on one side: the first nodes then go to the other */
    if (zeros == 0 || zeros == nodes)
        for (i = 0; i < nodes; i++) side[i] = i >= left_target;
    return SC_OK;
}

#else

sc_status sc_metis_bisect(void *user, const sc_dual_graph *graph, uint32_t left_target,
                          uint8_t *side)
{
    (void)user;
    (void)graph;
    (void)left_target;
    (void)side;
    return SC_ERROR_UNSUPPORTED;
}

#endif
