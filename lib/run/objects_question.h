/*
 * What is asked of several objects: objects and options as the caller passed them, checked and
 * copied.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_RUN_OBJECTS_QUESTION_H
#define SC_RUN_OBJECTS_QUESTION_H

#include "run/question.h"

/* What is asked, complete but for what depends on an object's model. */
typedef struct sc_objects_question {
    uint32_t about;           /* SC_QUESTION_... */
    sc_objects objects;       /* with a stride */
    sc_query_options options; /* of intersections */
    sc_near_question near;    /* of what is near its options; of a step those of its step */
    uint32_t simd;            /* the instruction set to use, of all of them */
    uint32_t output;          /* SC_OUTPUT_... */
    int ends_early;           /* the first pair may end it */
    sc_tasks tasks;
    const sc_tasks *given; /* that, or NULL */
} sc_objects_question;

/* Check and copy all of it but the objects' poses. The log is the first object's that is wrong. */
sc_status sc_objects_question_read(const sc_objects *objects, const sc_query_options *options,
                                   sc_objects_question *question);
sc_status sc_objects_question_read_near(const sc_objects *objects, const sc_near_options *options,
                                        sc_objects_question *question);
sc_status sc_objects_question_read_step(const sc_objects *objects, const sc_step_options *options,
                                        sc_objects_question *question);

/* The object of a number. */
const sc_object *sc_objects_question_object(const sc_objects *objects, uint32_t i);

#endif
