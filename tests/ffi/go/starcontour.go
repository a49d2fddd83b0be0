// starcontour for Go, by cgo. Slices are read and written in place: a C helper puts their addresses
// into the library's structures, so that no Go memory ever holds a pointer that C reads.
//
// CGO_CFLAGS and CGO_LDFLAGS say where header and library are.
//
// SPDX-License-Identifier: MIT

package main

/*
#cgo LDFLAGS: -lstarcontour
#include <starcontour.h>

static sc_status build(const float *positions, uint32_t vertex_count, const uint32_t *triangles,
                       uint32_t triangle_count, sc_model **model)
{
    const sc_mesh mesh = {.struct_size = sizeof(mesh), .vertex_count = vertex_count,
                          .triangle_count = triangle_count, .positions = positions,
                          .indices = triangles};
    return sc_build(&mesh, NULL, model);
}

static sc_status query(const sc_model *model, sc_workspace *workspace, const void *positions,
                       uint32_t vertex_count, uint32_t position_type, sc_pair *pairs,
                       uint64_t capacity, uint64_t *count)
{
    const sc_pose pose = {.struct_size = sizeof(pose), .vertex_count = vertex_count,
                          .position_type = position_type, .positions = positions};
    sc_result result = {.struct_size = sizeof(result), .capacity = capacity, .pairs = pairs};
    const sc_status status = sc_query(model, workspace, &pose, NULL, &result);
    *count = result.count;
    return status;
}
*/
import "C"

import (
	"runtime"
	"unsafe"
)

// Pair is two triangles that meet, A < B.
type Pair struct{ A, B uint32 }

// Error is an SC_ERROR_... of the header.
type Error int32

const (
	ErrorEmpty       Error = C.SC_ERROR_EMPTY
	ErrorIndex       Error = C.SC_ERROR_INDEX
	ErrorNotFinite   Error = C.SC_ERROR_NOT_FINITE
	ErrorVertexCount Error = C.SC_ERROR_VERTEX_COUNT
)

func (e Error) Error() string {
	return C.GoString(C.sc_status_string(C.sc_status(e)))
}

func check(status C.sc_status) error {
	if status == C.SC_OK {
		return nil
	}
	return Error(status)
}

// Model is a mesh made ready for queries. It is immutable: goroutines may share it.
type Model struct{ handle *C.sc_model }

// first is the address of a slice's elements, nil if it has none.
func first[T any](slice []T) unsafe.Pointer {
	if len(slice) == 0 {
		return nil
	}
	return unsafe.Pointer(&slice[0])
}

// Build makes a model of a mesh in its rest pose.
func Build(positions [][3]float32, triangles [][3]uint32) (*Model, error) {
	model := new(Model)
	var handle *C.sc_model
	status := C.build((*C.float)(first(positions)), C.uint32_t(len(positions)),
		(*C.uint32_t)(first(triangles)), C.uint32_t(len(triangles)), &handle)
	if err := check(status); err != nil {
		return nil, err
	}
	model.handle = handle
	runtime.SetFinalizer(model, func(m *Model) { C.sc_model_free(m.handle) })
	return model, nil
}

// Workspace is what queries write to. It belongs to one call at a time.
type Workspace struct {
	model  *Model
	handle *C.sc_workspace
	pairs  []Pair
}

// Workspace makes a workspace for the model.
func (m *Model) Workspace() (*Workspace, error) {
	w := &Workspace{model: m, pairs: make([]Pair, 16)}
	var handle *C.sc_workspace
	err := check(C.sc_workspace_create(m.handle, nil, &handle))
	runtime.KeepAlive(m)
	if err != nil {
		return nil, err
	}
	w.handle = handle
	runtime.SetFinalizer(w, func(w *Workspace) { C.sc_workspace_free(w.handle) })
	return w, nil
}

// Scalar is the type of a coordinate.
type Scalar interface{ float32 | float64 }

// Query finds all pairs in a pose, sorted. They stay as they are until the workspace's next query.
func Query[T Scalar](w *Workspace, pose [][3]T) ([]Pair, error) {
	var scalar T
	positionType := C.uint32_t(C.SC_FLOAT)
	if unsafe.Sizeof(scalar) == 8 {
		positionType = C.SC_DOUBLE
	}
	for {
		var count C.uint64_t
		status := C.query(w.model.handle, w.handle, first(pose), C.uint32_t(len(pose)),
			positionType, (*C.sc_pair)(first(w.pairs)), C.uint64_t(len(w.pairs)), &count)
		runtime.KeepAlive(w)
		if status == C.SC_ERROR_SHORT_BUFFER {
			w.pairs = make([]Pair, count+count/4)
			continue
		}
		return w.pairs[:count], check(status)
	}
}

// pairSize is the size of a pair in C, which that in Go has to be.
const pairSize = C.sizeof_sc_pair
