/*
 * Several objects in one query.
 *
 * SPDX-License-Identifier: MIT
 *
 * The frames of all objects have one unit box, so that points of two can be compared. It stays what
 * it was in the last call as long as all objects are in it and fill an eighth of it: so what was made
 * of an object that does not move stays valid.
 *
 * Each object with itself, and each two whose boxes meet, is a query of its own, in the first one's
 * workspace (run/plan.h).
 */
#ifndef SC_RUN_OBJECTS_H
#define SC_RUN_OBJECTS_H

#include "run/question.h"

/* What is asked: objects and options, checked and complete. */
typedef struct sc_objects_question {
    sc_objects objects; /* with a stride */
    sc_query_options options;
    sc_tasks tasks;
    const sc_tasks *given; /* that, or NULL */
} sc_objects_question;

/* Checks and copies all of it but the objects' poses. The log is the first object's. */
sc_status sc_objects_read(const sc_objects *objects, const sc_query_options *options,
                          sc_objects_question *question);

/* Answers it; *result has the caller's arrays, and stats a structure of this library's size, or
   NULL. */
sc_status sc_objects_run(const sc_objects_question *question, sc_objects_result *result);

#endif
