/*
 * Asking what is near, and what is near in truth: each pair by itself in exact arithmetic. For
 * test_near.c and its neighbours.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_NEAR_ASK_H
#define SC_TESTS_NEAR_ASK_H

#include "oracle.h"
#include "starcontour.h"
#include "step_truth.h"

/* ---- asking ---- */

/* One way to an answer, which is always the same. */
typedef struct near_way {
    const char *name;
    uint32_t method, simd;
} near_way;

enum { NEAR_WAYS = 7 };

extern const near_way near_ways[NEAR_WAYS];

/* Whether this machine has its instruction set. */
int near_way_is_there(const near_way *w, const sc_model *model, sc_workspace *workspace,
                      const sc_pose *pose);

/* An answer with arrays of exactly the size asked for, and a guard behind each. */
typedef struct near_answer {
    sc_status status;
    sc_near_result result;
    sc_stats stats;
    sc_pair *pairs[STEP_KINDS];
    uint64_t count[STEP_KINDS], capacity[STEP_KINDS];
} near_answer;

/* What is asked, and of what. */
typedef struct near_question {
    const char *name;
    const sc_model *model;
    sc_workspace *workspace;
    const sc_pose *pose;
    uint64_t state; /* of the random numbers before it was made, to be printed */
} near_question;

sc_near_options near_options_for(const near_way *w, double distance);

/* A workspace for so many workers. */
sc_workspace *near_workspace(const sc_model *model, uint32_t workers);

/* Arrays have room for so many pairs. Fails a check if something was written behind them. */
near_answer near_ask(const near_question *q, const sc_near_options *options, uint64_t faces,
                     uint64_t edges);

/* All pairs, in two queries: the first says how many there are. */
near_answer near_ask_all(const near_question *q, const sc_near_options *options);

void near_answer_free(near_answer *a);

/* Whether both have the same status, counts, verdict and lists. */
int near_answers_are_same(const near_answer *a, const near_answer *b);

/* Whether all pairs of the first are in the second. */
int near_answer_is_in(const near_answer *a, const near_answer *b);

/* ---- the truth ---- */

/* All pairs of a kind in the first pose of a motion that are within the distance, sorted. */
oracle_list near_truth_find(const step_motion *m, int kind, double distance);

/* The exact oracle on one pair; and its distance, rounded down. */
int near_truth_is_within(const step_motion *m, int kind, sc_pair pair, double distance);
double near_truth_distance(const step_motion *m, int kind, sc_pair pair);

/* A pair without a common vertex, drawn at random; 0 if none was found. */
int near_truth_draw(const step_motion *m, int kind, sc_pair *pair);

/* Whether what was found is the truth: fails a check for the first pair that is lost or too
   many. */
void near_truth_check(const near_question *q, const step_motion *m, const near_answer *a,
                      double distance, const char *what);

#endif /* SC_TESTS_NEAR_ASK_H */
