/*
 * The frames of several objects, which have one unit box, so that points of two can be compared.
 *
 * SPDX-License-Identifier: MIT
 *
 * It stays what it was in the last call as long as all objects are in it and fill an eighth of it:
 * so what was made of an object that does not move stays valid.
 */
#ifndef SC_RUN_OBJECTS_FRAME_H
#define SC_RUN_OBJECTS_FRAME_H

#include "run/objects_question.h"

/* Reads the poses of all objects, but of those that stay. Of what is near and of steps fills in the
   default tolerance of the question, and *clearance: what is farther apart is not reported; of
   intersections it is 0. */
sc_status sc_objects_frame_read(sc_objects_question *question, double *clearance);

/* Whether the box of an object ends, along an axis, farther than that before another one begins. */
int sc_objects_frame_apart(const sc_frame *a, const sc_frame *b, int axis, double clearance);

/* Whether the boxes of two objects come as near as that. */
int sc_objects_frame_meet(const sc_frame *a, const sc_frame *b, double clearance);

/* Makes the boxes of an object's patches, unless there are any, and counts that, if stats is not
   NULL. */
void sc_objects_frame_make_boxes(const sc_object *object, const sc_tasks *tasks, uint32_t about,
                                 sc_stats *stats);

#endif
