/*
 * Queries of steps by all methods and instruction sets against all pairs decided by the narrow
 * phase alone.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_STEP_CHECK_H
#define SC_TESTS_STEP_CHECK_H

#include "inputs.h"
#include "soups.h"
#include "starcontour.h"
#include "step/impact.h"

/* Vertex-face and edge-edge pairs. */
enum { STEP_KINDS = 2 };

/* A list of pairs with their times. */
typedef struct timed_list {
    sc_pair *pairs;
    double *times;
    uint64_t count, room;
} timed_list;

/* What the narrow phase says of all pairs of a step of a mesh, welded by its rest pose. */
void step_solve(const soup *s, const double *start, const double *end,
                const sc_impact_limits *limits, timed_list lists[STEP_KINDS]);
void step_free_lists(timed_list lists[STEP_KINDS]);

/* A model and a workspace for steps. */
typedef struct step_subject {
    sc_model *model;
    sc_workspace *workspace;
} step_subject;

int step_open(step_subject *s, const soup *mesh, const sc_build_options *options);
void step_close(step_subject *s);

sc_step_options step_plain_options(void);

/* A result with room for some pairs of each kind. */
typedef struct step_answer {
    sc_step_result result;
    sc_stats stats;
} step_answer;

step_answer step_make_answer(uint64_t capacity);
void step_free_answer(step_answer *a);

/* All methods and instruction sets on one step: the same collisions and times as the lists have,
   which are among the candidates; and these do not depend on the instruction set. */
int step_check_methods(const soup *mesh, step_subject *s, const double *start, const double *end,
                       const sc_impact_limits *limits, const timed_list lists[STEP_KINDS],
                       const char *what);

/* The same on a model of some partition against what the narrow phase says. */
void step_check(const soup *mesh, const double *start, const double *end,
                const sc_impact_limits *limits, const char *what);

#endif
