// Several objects in one query, by cgo. A scene is C's memory, which may hold pointers: positions
// are copied there when they are set, and what was found is copied from there.
//
// SPDX-License-Identifier: MIT

package main

/*
#include <starcontour.h>
#include <stdlib.h>
#include <string.h>

// An object of a scene, and its positions, which are its own. lender: of the first object of a
// model that others have as well, the workspace whose room those use.
typedef struct placed {
    sc_object object;
    sc_pose pose, end;
    sc_workspace *lender;
} placed;

typedef struct scene {
    placed *objects;
    uint32_t count;
    sc_objects_lists lists; // arrays are the scene's; those of a query are vertex_faces'
} scene;

enum { ASK_QUERY, ASK_NEAR, ASK_STEP };

// Whose room one more object of a model uses: NULL for the first, which has its own.
static sc_status scene_lender(scene *all, const sc_model *model, uint32_t flags,
                              sc_workspace **lender)
{
    const sc_workspace_options options = {.struct_size = sizeof(options),
                                          .flags = flags | SC_WORKSPACE_ROOM};
    *lender = NULL;
    for (uint32_t i = 0; i < all->count; ++i) {
        placed *one = &all->objects[i];
        if (one->object.model != model) continue;
        if (!one->lender) {
            const sc_status status = sc_workspace_create_for(model, &options, &one->lender);
            if (status != SC_OK) return status;
        }
        *lender = one->lender;
        return SC_OK;
    }
    return SC_OK;
}

static sc_status scene_add(scene *all, const sc_model *model, uint32_t flags)
{
    sc_workspace_options options = {.struct_size = sizeof(options), .flags = flags};
    sc_status status = scene_lender(all, model, flags, &options.room);
    if (status != SC_OK) return status;
    placed *objects = realloc(all->objects, (all->count + (size_t)1) * sizeof *objects);
    if (!objects) return SC_ERROR_MEMORY;
    all->objects = objects;
    objects += all->count;
    memset(objects, 0, sizeof *objects);
    objects->object.model = model;
    objects->object.itself = 1;
    status = sc_workspace_create_for(model, &options, &objects->object.workspace);
    if (status == SC_OK) all->count++;
    return status;
}

// at_end: of a step where it is at its end. No vertices: none.
static sc_status scene_place(scene *all, uint32_t number, int at_end, const void *positions,
                             uint32_t vertex_count, uint32_t position_type)
{
    placed *one = &all->objects[number];
    sc_pose *pose = at_end ? &one->end : &one->pose;
    const size_t size = (size_t)vertex_count * 3 * (position_type == SC_DOUBLE ? 8 : 4);
    void *own = vertex_count ? malloc(size) : NULL;
    if (vertex_count && !own) return SC_ERROR_MEMORY;
    if (vertex_count) memcpy(own, positions, size);
    free((void *)pose->positions);
    *pose = (sc_pose){.struct_size = sizeof(*pose), .vertex_count = vertex_count,
                      .position_type = position_type, .positions = own};
    one->object.pose_version++;
    return SC_OK;
}

// Makes a list's arrays as long as it said that they have to be.
static int scene_grow(sc_object_list *list)
{
    if (list->count > list->capacity) {
        free(list->pairs);
        free(list->times);
        list->pairs = malloc(list->count * sizeof *list->pairs);
        list->times = malloc(list->count * sizeof *list->times);
        list->capacity = list->pairs && list->times ? list->count : 0;
        if (!list->capacity) return 0;
    }
    if (list->range_count > list->range_capacity) {
        free(list->ranges);
        list->ranges = malloc(list->range_count * sizeof *list->ranges);
        list->range_capacity = list->ranges ? list->range_count : 0;
        if (!list->range_capacity) return 0;
    }
    return 1;
}

// distance: of what is near, or the separation of a step.
static sc_status scene_ask(scene *all, int about, double distance)
{
    const sc_near_options near_options = {.struct_size = sizeof(near_options), .distance = distance};
    const sc_step_options step_options = {.struct_size = sizeof(step_options),
                                          .separation = distance, .times = SC_STEP_TIMES_EACH};
    const sc_objects objects = {.struct_size = sizeof(objects), .count = all->count,
                                .objects = all->count ? &all->objects->object : NULL,
                                .stride = sizeof(placed)};
    sc_object_list *list = &all->lists.vertex_faces;
    sc_status status;
    for (uint32_t i = 0; i < all->count; ++i) {
        placed *one = &all->objects[i];
        one->object.pose = one->pose.positions ? &one->pose : NULL;
        one->object.end = about == ASK_STEP && one->end.positions ? &one->end : NULL;
    }
    all->lists.struct_size = sizeof(all->lists);
    do {
        if (about == ASK_QUERY) {
            sc_objects_result result = {.struct_size = sizeof(result), .capacity = list->capacity,
                                        .pairs = list->pairs, .ranges = list->ranges,
                                        .range_capacity = list->range_capacity};
            status = sc_query_objects(&objects, NULL, &result);
            list->count = result.count;
            list->range_count = result.range_count;
        } else if (about == ASK_NEAR) {
            status = sc_query_objects_near(&objects, &near_options, &all->lists);
        } else {
            status = sc_query_objects_step(&objects, &step_options, &all->lists);
        }
        if (status != SC_ERROR_SHORT_BUFFER) return status;
    } while (scene_grow(list) && scene_grow(&all->lists.edge_edges));
    return SC_ERROR_MEMORY;
}

static void scene_free(scene *all)
{
    for (uint32_t i = 0; i < all->count; ++i) {
        sc_workspace_free(all->objects[i].object.workspace);
        sc_workspace_free(all->objects[i].lender);
        free((void *)all->objects[i].pose.positions);
        free((void *)all->objects[i].end.positions);
    }
    for (int i = 0; i < 2; ++i) {
        sc_object_list *list = i ? &all->lists.edge_edges : &all->lists.vertex_faces;
        free(list->pairs);
        free(list->times);
        free(list->ranges);
    }
    free(all->objects);
    free(all);
}
*/
import "C"

import (
	"runtime"
	"unsafe"
)

// Scene is several objects, which may share models. It belongs to one call at a time.
type Scene struct {
	handle *C.scene
	flags  C.uint32_t
	models []*Model
}

// NewScene makes a scene for queries (0), or for more: ForSteps or ForNear.
func NewScene(flags uint32) (*Scene, error) {
	s := &Scene{handle: (*C.scene)(C.calloc(1, C.sizeof_scene)), flags: C.uint32_t(flags)}
	if s.handle == nil {
		return nil, Error(C.SC_ERROR_MEMORY)
	}
	runtime.SetFinalizer(s, func(s *Scene) { C.scene_free(s.handle) })
	return s, nil
}

// lends tells whether others use the room that belongs to an object's model.
func (s *Scene) lends(number int) bool {
	return unsafe.Slice(s.handle.objects, len(s.models))[number].lender != nil
}

// Object is an object of a scene. Number is that of the objects before it.
type Object struct {
	scene  *Scene
	Number int
}

// Add makes an object, which needs a pose before anything is asked.
func (s *Scene) Add(m *Model) (Object, error) {
	if err := check(C.scene_add(s.handle, m.handle, s.flags)); err != nil {
		return Object{}, err
	}
	s.models = append(s.models, m)
	return Object{s, len(s.models) - 1}, nil
}

func (o Object) get() *C.sc_object {
	return &unsafe.Slice(o.scene.handle.objects, len(o.scene.models))[o.Number].object
}

// SetItself says whether pairs of the object with itself are wanted; at first they are.
func (o Object) SetItself(wanted bool) {
	o.get().itself = 0
	if wanted {
		o.get().itself = 1
	}
}

// SetGroup says what the object collides with, see sc_group; 0 and 0, as at first: with everything.
func (o Object) SetGroup(category, mask uint32) {
	o.get().group = C.sc_group{category: C.uint32_t(category), mask: C.uint32_t(mask)}
}

func place[T Scalar](o Object, atEnd C.int, positions [][3]T) error {
	status := C.scene_place(o.scene.handle, C.uint32_t(o.Number), atEnd, first(positions),
		C.uint32_t(len(positions)), positionType[T]())
	runtime.KeepAlive(o.scene)
	return check(status)
}

// SetPose says where an object is, of a step at its start. What is not set again is not read again.
func SetPose[T Scalar](o Object, positions [][3]T) error { return place(o, 0, positions) }

// SetEnd says where an object is at the end of a step; nil, as at first: where it began.
func SetEnd[T Scalar](o Object, positions [][3]T) error { return place(o, 1, positions) }

// Meeting is what two objects have with each other, or one with itself: their numbers, pairs of
// what belongs to A and what belongs to B, and of a step when each collides.
type Meeting struct {
	A, B  int
	Pairs []Pair
	Times []float64
}

// FeatureMeetings are those of a vertex and a triangle, and of two edges 3 t + k.
type FeatureMeetings struct {
	VertexFaces, EdgeEdges []Meeting
	Earliest               float64 // of a step: nothing collides before
}

// Query finds what intersects.
func (s *Scene) Query() ([]Meeting, error) {
	found, err := s.ask(C.ASK_QUERY, 0)
	return found.VertexFaces, err
}

// Near finds what is within a distance, in units of the coordinates.
func (s *Scene) Near(distance float64) (FeatureMeetings, error) {
	return s.ask(C.ASK_NEAR, distance)
}

// Step finds what comes as near as separation while objects move from their pose to their end.
func (s *Scene) Step(separation float64) (FeatureMeetings, error) {
	return s.ask(C.ASK_STEP, separation)
}

func (s *Scene) ask(about C.int, distance float64) (FeatureMeetings, error) {
	if err := check(C.scene_ask(s.handle, about, C.double(distance))); err != nil {
		return FeatureMeetings{}, err
	}
	lists := &s.handle.lists
	found := FeatureMeetings{meetings(&lists.vertex_faces, about), nil, float64(lists.earliest)}
	if about != C.ASK_QUERY {
		found.EdgeEdges = meetings(&lists.edge_edges, about)
	}
	runtime.KeepAlive(s)
	return found, nil
}

func meetings(list *C.sc_object_list, about C.int) []Meeting {
	var found []Meeting
	pairs := unsafe.Slice((*Pair)(unsafe.Pointer(list.pairs)), list.count)
	times := unsafe.Slice((*float64)(list.times), list.count)
	for _, r := range unsafe.Slice(list.ranges, list.range_count) {
		m := Meeting{A: int(r.object_a), B: int(r.object_b)}
		m.Pairs = append(m.Pairs, pairs[r.first:r.first+r.count]...)
		if about == C.ASK_STEP {
			m.Times = append(m.Times, times[r.first:r.first+r.count]...)
		}
		found = append(found, m)
	}
	return found
}
