/*
 * Meshes that pass through each other, their pairs and their contours, for tests of sc_trace and of
 * what is made of it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_TRACE_SCENE_H
#define SC_TESTS_TRACE_SCENE_H

#include "inputs.h"
#include "soups.h"
#include "starcontour.h"

/* A mesh in a pose and its pairs, the caller's arrays that the library gets. */
typedef struct trace_scene {
    soup mesh;
    sc_mesh input;
    sc_pose pose;
    sc_model *model;
    sc_pair *pairs;
    uint64_t count;
    sc_trace_result result;
} trace_scene;

sc_trace_result trace_scene_no_room(void);

/* The pairs of a pose, which the caller frees. */
sc_pair *trace_scene_find_pairs(const sc_model *model, const sc_pose *pose, uint64_t *count);

/* Asks for counts first, then for all. */
int trace_scene_trace(const sc_model *model, const sc_pose *pose, const sc_pair *pairs,
                      uint64_t count, const sc_trace_options *options, sc_trace_result *result);

void trace_scene_free_result(sc_trace_result *result);

/* Takes the mesh, which is posed as it is. */
int trace_scene_open(trace_scene *s, soup mesh, uint32_t content);

void trace_scene_close(trace_scene *s);

/* Crossing cloths with much noise: thousands of crossings. */
soup trace_scene_cloths(uint32_t across);

/* Two strips that cross along a ring, and turn as they go round it so often by a right angle: after
   an odd number each goes on as the other, and the two are one. */
soup trace_scene_strips(uint32_t stations, uint32_t turns);

/* An allocator that fails after so many times, or then cancels the call instead; and counts what is
   not given back. */
typedef struct scarce_memory {
    sc_allocator allocator; /* its user is this */
    uint32_t left;
    int cancels;
    volatile uint32_t cancelled; /* for sc_trace_options.cancel */
    uint64_t live;
} scarce_memory;

void scarce_memory_start(scarce_memory *memory, uint32_t left);

#endif
