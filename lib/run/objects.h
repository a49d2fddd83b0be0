/*
 * Several objects in one query.
 *
 * SPDX-License-Identifier: MIT
 *
 * Each object with itself, and each two whose boxes come near, is a query of its own, in the first
 * one's workspace (run/plan.h). Edges with triangles are two queries, since either object may be
 * that of the edges; vertices with faces are one, which marks those of the second object with the
 * first's faces (SC_STEP_TURNED).
 */
#ifndef SC_RUN_OBJECTS_H
#define SC_RUN_OBJECTS_H

#include "run/objects_question.h"

/* The answer: lists with the caller's arrays; of intersections the first alone. */
typedef struct sc_objects_answer {
    sc_object_list list[2]; /* SC_STEP_VERTEX_FACE, SC_STEP_EDGE_EDGE */
    double earliest;
    sc_stats *stats; /* a structure of this library's size, or NULL */
} sc_objects_answer;

/* Answers a question that was read; fills in what all objects together decide of it. */
sc_status sc_objects_run(sc_objects_question *question, sc_objects_answer *answer);

#endif
