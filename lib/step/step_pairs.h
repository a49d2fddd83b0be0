/*
 * The caller's lists of a step: filled in any order, sorted at the end, each with the times of its
 * pairs.
 *
 * SPDX-License-Identifier: MIT
 *
 * A list that is too short keeps the first pairs, as query/pairs.h says.
 */
#ifndef SC_STEP_PAIRS_H
#define SC_STEP_PAIRS_H

#include "step/step_worker.h"

/* Takes a pair that was not taken before, in the caller's numbers. */
void sc_step_pairs_take(sc_worker *w, int kind, uint32_t a, uint32_t b, double time);

/* The same for some pairs, fewer than SC_FOUND_MAX, of a list without times: they are written where
   sc_step_pairs_place says, which is at the end of the list if it has room, or to other; then
   sc_step_pairs_take_all takes them from there. */
static inline sc_pair *sc_step_pairs_place(const sc_worker *w, int kind, uint32_t count,
                                           sc_pair *other)
{
    const sc_step_worker *step = w->step;
    const sc_step_list *list = &step->question->list[kind];
    if (step->question->options.output != SC_OUTPUT_PAIRS || !list->capacity) return other;
    if (!w->share && step->count[kind] + count <= list->capacity)
        return list->pairs + step->count[kind];
    if (w->share && step->found_count[kind] + count < SC_FOUND_MAX)
        return step->found[kind] + step->found_count[kind];
    return other;
}

static inline void sc_step_pairs_take_all(sc_worker *w, int kind, const sc_pair *pairs,
                                          uint32_t count, const sc_pair *other)
{
    sc_step_worker *step = w->step;
    uint32_t i;
    if (pairs == other) {
        for (i = 0; i < count; i++) sc_step_pairs_take(w, kind, pairs[i].a, pairs[i].b, 0);
        return;
    }
    if (kind == SC_STEP_VERTEX_FACE && pairs[0].a >= SC_STEP_TURNED) step->turned += count;
    step->count[kind] += count;
    if (w->share) step->found_count[kind] += count;
}

/* Gives what a worker has found to the lists that several share, as sc_pairs_deliver. */
void sc_step_pairs_deliver(const sc_worker *w);

/* Sorts the lists, of which each was given so many pairs; spare is room for some pairs. tasks share
   in it, unless NULL. */
void sc_step_pairs_finish(const sc_step_question *question, const uint64_t found[2], sc_pair *spare,
                          uint64_t room, const sc_tasks *tasks);

#endif
