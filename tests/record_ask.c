/*
 * Asking, recording and asking again. See record_ask.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "record_ask.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"

static void ask_once(const record_question *q, sc_workspace *workspace, const uint64_t room[KINDS],
                     record_answer *a)
{
    if (q->kind == SC_RECORD_STEP) {
        sc_step_result r;
        memset(&r, 0, sizeof(r));
        r.struct_size = sizeof(r);
        r.vertex_faces = a->pairs[VERTEX_FACE];
        r.vertex_face_times = a->times[VERTEX_FACE];
        r.vertex_face_capacity = room[VERTEX_FACE];
        r.edge_edges = a->pairs[EDGE_EDGE];
        r.edge_edge_times = a->times[EDGE_EDGE];
        r.edge_edge_capacity = room[EDGE_EDGE];
        a->status = sc_query_step(q->model, workspace, q->start, q->end, q->step, &r);
        a->found = r.collides;
        a->verdict = r.verdict;
        a->count[VERTEX_FACE] = r.vertex_face_count;
        a->count[EDGE_EDGE] = r.edge_edge_count;
        a->earliest = r.earliest;
    } else {
        sc_near_result r;
        memset(&r, 0, sizeof(r));
        r.struct_size = sizeof(r);
        r.vertex_faces = a->pairs[VERTEX_FACE];
        r.vertex_face_capacity = room[VERTEX_FACE];
        r.edge_edges = a->pairs[EDGE_EDGE];
        r.edge_edge_capacity = room[EDGE_EDGE];
        a->status = sc_query_near(q->model, workspace, q->start, q->near_options, &r);
        a->found = r.found;
        a->verdict = r.verdict;
        a->count[VERTEX_FACE] = r.vertex_face_count;
        a->count[EDGE_EDGE] = r.edge_edge_count;
    }
}

void record_answer_free(record_answer *a)
{
    for (int k = 0; k < KINDS; ++k) {
        free(a->pairs[k]);
        free(a->times[k]);
    }
}

record_answer record_ask(const record_question *q)
{
    const sc_workspace_options how = {.struct_size = sizeof(how), .flags = SC_WORKSPACE_NEAR};
    sc_workspace *workspace = NULL;
    uint64_t room[KINDS] = {0, 0};
    record_answer a;
    memset(&a, 0, sizeof(a));
    a.status = SC_ERROR_MEMORY;
    if (!CHECK(sc_workspace_create_for(q->model, &how, &workspace) == SC_OK)) return a;
    ask_once(q, workspace, room, &a);
    for (int k = 0; k < KINDS; ++k) {
        room[k] = a.count[k];
        a.pairs[k] = (sc_pair *)test_allocate((size_t)(room[k] + 1) * sizeof(sc_pair));
        a.times[k] = (double *)test_allocate((size_t)(room[k] + 1) * sizeof(double));
        memset(a.pairs[k], 0, (size_t)(room[k] + 1) * sizeof(sc_pair));
        memset(a.times[k], 0, (size_t)(room[k] + 1) * sizeof(double));
    }
    ask_once(q, workspace, room, &a);
    sc_workspace_free(workspace);
    return a;
}

int record_answers_are_same(const record_answer *x, const record_answer *y)
{
    int same = x->status == y->status && x->found == y->found && x->verdict == y->verdict &&
               memcmp(&x->earliest, &y->earliest, sizeof(double)) == 0;
    for (int k = 0; k < KINDS && same; ++k) {
        same = x->count[k] == y->count[k] &&
               memcmp(x->pairs[k], y->pairs[k], (size_t)x->count[k] * sizeof(sc_pair)) == 0 &&
               memcmp(x->times[k], y->times[k], (size_t)x->count[k] * sizeof(double)) == 0;
    }
    return same;
}

sc_status record_size_of(const record_question *q, uint64_t *size)
{
    return q->kind == SC_RECORD_STEP
               ? sc_record_step_size(q->model, q->start, q->end, q->step, size)
               : sc_record_near_size(q->model, q->start, q->near_options, size);
}

sc_status record_write_to(const record_question *q, void *memory, uint64_t size, uint64_t *written)
{
    return q->kind == SC_RECORD_STEP
               ? sc_record_step_write(q->model, q->start, q->end, q->step, memory, size, written)
               : sc_record_near_write(q->model, q->start, q->near_options, memory, size, written);
}

void record_make_room(record_opened *o)
{
    memset(o, 0x55, sizeof(*o));
    for (int k = 0; k < POSES; ++k) o->pose[k].struct_size = sizeof(sc_pose);
    for (int k = 0; k < KINDS; ++k) o->filter[k].struct_size = sizeof(sc_filter);
    o->query.struct_size = sizeof(o->query);
    o->step.struct_size = sizeof(o->step);
    o->near_options.struct_size = sizeof(o->near_options);
    memset(&o->record, 0, sizeof(o->record));
    o->record.struct_size = sizeof(o->record);
    o->record.pose = &o->pose[START];
    o->record.end = &o->pose[END];
    o->record.rest = &o->pose[REST];
    o->record.options = &o->query;
    o->record.step_options = &o->step;
    o->record.near_options = &o->near_options;
    o->record.filter = &o->filter[VERTEX_FACE];
    o->record.edge_edge_filter = &o->filter[EDGE_EDGE];
}

sc_status record_open(const void *data, uint64_t size, record_opened *o)
{
    sc_status status;
    record_opened kept;
    record_make_room(o);
    kept = *o;
    status = sc_record_read(data, size, &o->record);
    if (status) CHECK(memcmp(o, &kept, sizeof(kept)) == 0);
    return status;
}

record_answer record_replay(const record_opened *o)
{
    sc_load_options load;
    sc_near_options near_options = o->near_options;
    sc_near_masks *masks = NULL;
    sc_model *model = NULL;
    record_question q = {o->record.kind, NULL,     &o->pose[START],
                         &o->pose[END],  &o->step, &near_options};
    record_answer a;
    memset(&a, 0, sizeof(a));
    memset(&load, 0, sizeof(load));
    load.struct_size = sizeof(load);
    load.mode = (uintptr_t)o->record.model % SC_ALIGNMENT ? SC_LOAD_COPY : SC_LOAD_IN_PLACE;
    a.status = sc_model_load(o->record.model, o->record.model_size, &load, &model);
    if (a.status) return a;
    q.model = model;
    if (o->record.mask_rings &&
        CHECK(sc_near_masks_create(model, o->record.mask_rings, NULL, &masks) == SC_OK))
        near_options.masks = masks;
    a = record_ask(&q);
    sc_near_masks_free(masks);
    sc_model_free(model);
    return a;
}
