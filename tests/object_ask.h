/*
 * Any of the three questions about several objects, asked in one way, and whether two answers are
 * the same bit for bit.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_OBJECT_ASK_H
#define TESTS_OBJECT_ASK_H

#include <stdint.h>

#include "starcontour.h"

enum { OBJECTS_QUERY, OBJECTS_NEAR, OBJECTS_STEP };

typedef struct object_question {
    int about;
    void *asks; /* what functions between objects are called with, or NULL: there are none */
    sc_query_options query;
    sc_near_options near;
    sc_step_options step;
} object_question;

/* Intersections have one list. */
typedef struct object_answer {
    sc_status status;
    uint32_t collides, verdict;
    double earliest;
    sc_object_list list[2]; /* with arrays of the caller */
    sc_stats stats;
} object_answer;

/* One of the three, by any method that there is. */
object_question object_question_any(void);
void object_question_set_output(object_question *q, uint32_t output);

/* Asks, with so many entries of either list and as many ranges. */
void object_ask(const sc_objects *objects, const object_question *q, const sc_tasks *tasks,
                const uint64_t capacity[2], object_answer *a);
void object_answer_forget(object_answer *a);

/* Whether two answers to a question are the same, as far as ranges fit; and what was counted. */
int object_answers_are_same(const object_question *q, const object_answer *x,
                            const object_answer *y);
int object_counts_are_same(const sc_stats *x, const sc_stats *y);

#endif
