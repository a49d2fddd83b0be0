/*
 * One mesh and pose, asked in all ways: pairs of triangles, vertices and edges, by every method and
 * any of the machine's instruction sets, against the oracle. For test_pairs.c and
 * test_flat_pairs.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_PAIR_TRIAL_H
#define TESTS_PAIR_TRIAL_H

#include <stdint.h>

#include "inputs.h"
#include "oracle.h"
#include "soups.h"
#include "starcontour.h"

/* Ways to search that must all give the same answer. */
typedef struct trial_way {
    const char *name;
    uint32_t method, contour, rest_cache;
} trial_way;

enum { TRIAL_WAYS = 7 };

extern const trial_way trial_ways[TRIAL_WAYS];

/* What is being compared, for messages. */
typedef struct trial {
    const char *name;
    const soup *mesh;
    const double *pose;
    uint64_t state; /* of the random numbers before the soup was made */
    const sc_model *model;
    sc_workspace *workspace;
    const sc_pose *input;
    const char *partition;
    uint32_t weld;
    const oracle_answer *answer;
} trial;

/* One query into an array of capacity pairs, which must come out as the head of the expected
   list. */
int trial_check_pairs(const trial *t, const trial_way *w, uint32_t kind, uint32_t contact,
                      uint64_t capacity);

/* Everything that can be asked of a model in a pose. */
void trial_check_pose(const trial *t);

/*
 * A mesh in its rest pose and in another, both in random types, strides and places of memory, built
 * as chosen (randomly by input_choose for a weld and a partition if own is NULL) and asked
 * everything.
 */
void trial_check_chosen(const char *name, uint64_t state, const soup *mesh, const double *pose,
                        uint32_t weld, uint32_t partition, const input_choices *own);

void trial_check(const char *name, uint64_t state, const soup *mesh, const double *pose,
                 uint32_t weld, uint32_t partition);

void trial_check_random_build(const char *name, uint64_t state, const soup *mesh,
                              const double *pose);

/* One model and one workspace through a whole motion: move gets the rest pose and makes a frame's
   of it. */
void trial_check_motion(const char *name, soup *s, uint32_t frames,
                        void (*move)(const soup *s, double *pose, uint32_t frame, uint32_t frames));

#endif
