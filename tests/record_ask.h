/*
 * Asking, recording and asking again: steps and searches for what is near, for
 * test_feature_records.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_RECORD_ASK_H
#define SC_TESTS_RECORD_ASK_H

#include "starcontour.h"

enum { VERTEX_FACE, EDGE_EDGE, KINDS };
enum { START, END, REST, POSES };

/* What is asked: of kind SC_RECORD_STEP or _NEAR. */
typedef struct record_question {
    uint32_t kind;
    const sc_model *model;
    const sc_pose *start, *end;
    const sc_step_options *step;
    const sc_near_options *near_options;
} record_question;

typedef struct record_answer {
    sc_status status;
    uint32_t found, verdict;
    uint64_t count[KINDS];
    double earliest;
    sc_pair *pairs[KINDS];
    double *times[KINDS];
} record_answer;

/* Asks twice: the first answer says how many pairs there are. */
record_answer record_ask(const record_question *q);
void record_answer_free(record_answer *a);

/* Whether both have the same status, verdict, lists and times. */
int record_answers_are_same(const record_answer *x, const record_answer *y);

/* The calls for a question of this kind. */
sc_status record_size_of(const record_question *q, uint64_t *size);
sc_status record_write_to(const record_question *q, void *memory, uint64_t size, uint64_t *written);

/* What a record of any kind is read to. */
typedef struct record_opened {
    sc_pose pose[POSES];
    sc_query_options query;
    sc_step_options step;
    sc_near_options near_options;
    sc_filter filter[KINDS];
    sc_record record;
} record_opened;

/* Room for everything that a record can have, not empty. */
void record_make_room(record_opened *o);

/* Reads with that room; fails a check if a record that is refused has changed anything. */
sc_status record_open(const void *data, uint64_t size, record_opened *o);

/* Loads the model of a record, makes the masks that it names, and asks. */
record_answer record_replay(const record_opened *o);

#endif /* SC_TESTS_RECORD_ASK_H */
