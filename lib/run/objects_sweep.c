/*
 * Sweep and prune. See objects_sweep.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "run/objects_sweep.h"

#include <math.h>

#include "query/filter.h"
#include "run/objects_frame.h"
#include "run/workspace.h"

static sc_workspace *workspace_at(const sc_objects *objects, uint32_t i)
{
    return sc_objects_question_object(objects, i)->workspace;
}

/* ---- sorting ---- */

/* The longest side of the box of all objects. */
static int longest_axis(const sc_objects *objects)
{
    double length[3];
    uint32_t i;
    int k;
    for (k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (i = 0; i < objects->count; i++) {
            const sc_frame *frame = &workspace_at(objects, i)->frame;
            low = fmin(low, frame->low[k]);
            high = fmax(high, frame->high[k]);
        }
        length[k] = high - low;
    }
    k = length[1] > length[0];
    return length[2] > length[k] ? 2 : k;
}

/* Two sorted lists as one, of those with one lower end the first list's first. */
static sc_workspace *merge_sorted(sc_workspace *a, sc_workspace *b, int axis)
{
    sc_workspace *first = NULL, **end = &first;
    while (a && b) {
        sc_workspace **less = b->frame.low[axis] < a->frame.low[axis] ? &b : &a;
        *end = *less;
        end = &(*less)->scene.next;
        *less = *end;
    }
    *end = a ? a : b;
    return first;
}

/* All objects by their lower ends: list k, if there is one, is of 2^k of them. */
static sc_workspace *sort_by_ends(const sc_objects *objects, int axis)
{
    sc_workspace *lists[33] = {NULL}, *all = NULL;
    uint32_t i;
    int k;
    for (i = 0; i < objects->count; i++) {
        sc_workspace *list = workspace_at(objects, i);
        list->scene.next = NULL;
        for (k = 0; lists[k]; k++) {
            list = merge_sorted(lists[k], list, axis);
            lists[k] = NULL;
        }
        lists[k] = list;
    }
    for (k = 0; k < 33; k++) all = merge_sorted(lists[k], all, axis);
    return all;
}

/* ---- what comes near ---- */

static int groups_collide(const sc_object *a, const sc_object *b)
{
    const sc_group all = {0xffffffffu, 0xffffffffu};
    const sc_group x = a->group.category || a->group.mask ? a->group : all;
    const sc_group y = b->group.category || b->group.mask ? b->group : all;
    return sc_filter_groups_collide(x, y);
}

static int meet(const sc_objects *objects, uint32_t i, uint32_t j, double clearance)
{
    const sc_object *a = sc_objects_question_object(objects, i);
    const sc_object *b = sc_objects_question_object(objects, j);
    return sc_objects_frame_meet(&a->workspace->frame, &b->workspace->frame, clearance) &&
           groups_collide(a, b);
}

/* Takes down that an object comes near another one behind it. */
static void add_meeting(sc_in_scene *scene, uint32_t other)
{
    uint32_t at = scene->meet_count++;
    if (at >= SC_MEETS_MAX) return;
    for (; at > 0 && scene->meets[at - 1] > other; at--) scene->meets[at] = scene->meets[at - 1];
    scene->meets[at] = other;
}

void sc_objects_sweep_run(const sc_objects *objects, double clearance)
{
    const int axis = longest_axis(objects);
    sc_workspace *a, *b;
    uint32_t i;
    for (i = 0; i < objects->count; i++) workspace_at(objects, i)->scene.meet_count = 0;
    for (a = sort_by_ends(objects, axis); a; a = a->scene.next) {
        for (b = a->scene.next; b && !sc_objects_frame_apart(&a->frame, &b->frame, axis, clearance);
             b = b->scene.next) {
            sc_workspace *first = a->scene.number < b->scene.number ? a : b;
            const uint32_t other = (first == a ? b : a)->scene.number - 1;
            if (meet(objects, first->scene.number - 1, other, clearance))
                add_meeting(&first->scene, other);
        }
    }
}

uint32_t sc_objects_sweep_next(const sc_objects *objects, double clearance, uint32_t i, uint32_t j)
{
    const sc_in_scene *scene = &workspace_at(objects, i)->scene;
    uint32_t k;
    if (scene->meet_count > SC_MEETS_MAX) {
        for (j++; j < objects->count && !meet(objects, i, j, clearance);) j++;
        return j;
    }
    for (k = 0; k < scene->meet_count; k++)
        if (scene->meets[k] > j) return scene->meets[k];
    return objects->count;
}
