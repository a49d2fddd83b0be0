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

static sc_pose pose_of(const void *positions, uint32_t vertex_count, uint32_t position_type)
{
    const sc_pose pose = {.struct_size = sizeof(pose), .vertex_count = vertex_count,
                          .position_type = position_type, .positions = positions};
    return pose;
}

static sc_status create(const sc_model *model, uint32_t flags, sc_workspace **workspace)
{
    const sc_workspace_options options = {.struct_size = sizeof(options), .flags = flags};
    return sc_workspace_create_for(model, &options, workspace);
}

// Of the arrays of pairs and times, *face_count and *edge_count are the lengths, then what was
// found.
static sc_status step(const sc_model *model, sc_workspace *workspace, const void *start,
                      const void *end, uint32_t vertex_count, uint32_t position_type,
                      double separation, sc_pair *faces, double *face_times, uint64_t *face_count,
                      sc_pair *edges, double *edge_times, uint64_t *edge_count, double *earliest)
{
    const sc_pose from = pose_of(start, vertex_count, position_type);
    const sc_pose to = pose_of(end, vertex_count, position_type);
    const sc_step_options options = {.struct_size = sizeof(options), .separation = separation,
                                     .times = SC_STEP_TIMES_EACH};
    sc_step_result result = {.struct_size = sizeof(result),
                             .vertex_faces = faces, .vertex_face_times = face_times,
                             .vertex_face_capacity = *face_count,
                             .edge_edges = edges, .edge_edge_times = edge_times,
                             .edge_edge_capacity = *edge_count};
    const sc_status status = sc_query_step(model, workspace, &from, &to, &options, &result);
    *face_count = result.vertex_face_count;
    *edge_count = result.edge_edge_count;
    *earliest = result.earliest;
    return status;
}

static sc_status near_pairs(const sc_model *model, sc_workspace *workspace, const void *positions,
                            uint32_t vertex_count, uint32_t position_type, double distance,
                            sc_pair *faces, uint64_t *face_count, sc_pair *edges,
                            uint64_t *edge_count)
{
    const sc_pose pose = pose_of(positions, vertex_count, position_type);
    const sc_near_options options = {.struct_size = sizeof(options), .distance = distance};
    sc_near_result result = {.struct_size = sizeof(result),
                             .vertex_faces = faces, .vertex_face_capacity = *face_count,
                             .edge_edges = edges, .edge_edge_capacity = *edge_count};
    const sc_status status = sc_query_near(model, workspace, &pose, &options, &result);
    *face_count = result.vertex_face_count;
    *edge_count = result.edge_edge_count;
    return status;
}

static sc_status edge_pairs(const sc_model *model, sc_workspace *workspace, const void *positions,
                            uint32_t vertex_count, uint32_t position_type, sc_pair *pairs,
                            uint64_t *count)
{
    const sc_pose pose = pose_of(positions, vertex_count, position_type);
    const sc_query_options options = {.struct_size = sizeof(options), .pairs = SC_PAIRS_EDGE};
    sc_result result = {.struct_size = sizeof(result), .capacity = *count, .pairs = pairs};
    const sc_status status = sc_query(model, workspace, &pose, &options, &result);
    *count = result.count;
    return status;
}

// Of the arrays of nodes and contours, *node_count and *contour_count are the lengths, then what
// was found.
static sc_status trace(const sc_model *model, const void *positions, uint32_t vertex_count,
                       uint32_t position_type, const sc_pair *pairs, uint64_t count,
                       sc_trace_node *nodes, uint64_t *node_count, sc_trace_contour *contours,
                       uint64_t *contour_count)
{
    const sc_pose pose = pose_of(positions, vertex_count, position_type);
    sc_trace_result result = {.struct_size = sizeof(result),
                              .nodes = nodes, .node_capacity = *node_count,
                              .contours = contours, .contour_capacity = *contour_count};
    const sc_status status = sc_trace(model, &pose, pairs, count, NULL, &result);
    *node_count = result.node_count;
    *contour_count = result.contour_count;
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
	ErrorNull        Error = C.SC_ERROR_NULL
	ErrorOption      Error = C.SC_ERROR_OPTION
	ErrorEmpty       Error = C.SC_ERROR_EMPTY
	ErrorIndex       Error = C.SC_ERROR_INDEX
	ErrorNotFinite   Error = C.SC_ERROR_NOT_FINITE
	ErrorVertexCount Error = C.SC_ERROR_VERTEX_COUNT
	ErrorWorkspace   Error = C.SC_ERROR_WORKSPACE
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
	model    *Model
	handle   *C.sc_workspace
	pairs    []Pair
	faces    []Pair
	edges    []Pair
	nodes    []ContourNode
	contours []Contour
}

// What a workspace is for, besides queries: steps; or steps and what is near.
const (
	ForSteps = C.SC_WORKSPACE_STEP
	ForNear  = C.SC_WORKSPACE_NEAR
)

// Workspace makes a workspace for queries.
func (m *Model) Workspace() (*Workspace, error) { return m.WorkspaceFor(0) }

// WorkspaceFor makes a workspace for more than queries: ForSteps or ForNear.
func (m *Model) WorkspaceFor(flags uint32) (*Workspace, error) {
	w := &Workspace{model: m, pairs: make([]Pair, 16)}
	var handle *C.sc_workspace
	err := check(C.create(m.handle, C.uint32_t(flags), &handle))
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

func positionType[T Scalar]() C.uint32_t {
	var scalar T
	if unsafe.Sizeof(scalar) == 8 {
		return C.SC_DOUBLE
	}
	return C.SC_FLOAT
}

// Query finds all pairs in a pose, sorted. They stay as they are until the workspace's next query.
func Query[T Scalar](w *Workspace, pose [][3]T) ([]Pair, error) {
	for {
		var count C.uint64_t
		status := C.query(w.model.handle, w.handle, first(pose), C.uint32_t(len(pose)),
			positionType[T](), (*C.sc_pair)(first(w.pairs)), C.uint64_t(len(w.pairs)), &count)
		runtime.KeepAlive(w)
		if status == C.SC_ERROR_SHORT_BUFFER {
			w.pairs = make([]Pair, count+count/4)
			continue
		}
		return w.pairs[:count], check(status)
	}
}

// Features are pairs of a vertex and a triangle, and of two edges 3 t + k. They stay as they are
// until the workspace's next step or query of what is near.
type Features struct {
	VertexFaces, EdgeEdges         []Pair
	VertexFaceTimes, EdgeEdgeTimes []float64 // of a step: when each collides
	Earliest                       float64   // of a step: nothing collides before
}

// find asks until both lists are long enough.
func (w *Workspace) find(ask func(faces, edges *C.uint64_t) C.sc_status) error {
	w.faces, w.edges = w.faces[:cap(w.faces)], w.edges[:cap(w.edges)]
	for {
		faces, edges := C.uint64_t(len(w.faces)), C.uint64_t(len(w.edges))
		status := ask(&faces, &edges)
		runtime.KeepAlive(w)
		if status != C.SC_ERROR_SHORT_BUFFER {
			w.faces, w.edges = w.faces[:faces], w.edges[:edges]
			return check(status)
		}
		w.faces, w.edges = make([]Pair, faces), make([]Pair, edges)
	}
}

// Step finds what comes as near as separation while vertices move from one pose to another.
func Step[T Scalar](w *Workspace, start, end [][3]T, separation float64) (Features, error) {
	if len(start) != len(end) {
		return Features{}, ErrorVertexCount
	}
	var faceTimes, edgeTimes []float64
	var earliest C.double
	err := w.find(func(faces, edges *C.uint64_t) C.sc_status {
		faceTimes, edgeTimes = make([]float64, *faces), make([]float64, *edges)
		return C.step(w.model.handle, w.handle, first(start), first(end), C.uint32_t(len(start)),
			positionType[T](), C.double(separation),
			(*C.sc_pair)(first(w.faces)), (*C.double)(first(faceTimes)), faces,
			(*C.sc_pair)(first(w.edges)), (*C.double)(first(edgeTimes)), edges, &earliest)
	})
	return Features{w.faces, w.edges, faceTimes[:len(w.faces)], edgeTimes[:len(w.edges)],
		float64(earliest)}, err
}

// Near finds what is within a distance in a pose, in units of the coordinates.
func Near[T Scalar](w *Workspace, pose [][3]T, distance float64) (Features, error) {
	err := w.find(func(faces, edges *C.uint64_t) C.sc_status {
		return C.near_pairs(w.model.handle, w.handle, first(pose), C.uint32_t(len(pose)),
			positionType[T](), C.double(distance), (*C.sc_pair)(first(w.faces)), faces,
			(*C.sc_pair)(first(w.edges)), edges)
	})
	return Features{VertexFaces: w.faces, EdgeEdges: w.edges}, err
}

// ContourNode is where an edge passes through a triangle: a sc_trace_node of the header.
type ContourNode struct {
	Edge, Triangle uint32 // NoEdge, and a vertex, where the node is one
	Sheet          uint32
	Sheets         [2]uint32 // the triangles of the segment to the next node; NoEdge at an end
	_              uint32
	Along          float64
	Weights, Point [3]float64
}

// Contour is a contour's nodes, First to First+Count-1: a sc_trace_contour of the header.
type Contour struct {
	First, Count uint64
	Begin, End   uint32 // ContourClosed and so on
	Flags        uint32 // ContourOneSheet or 0
	_            uint32
	Length       float64
}

// Where a contour begins and ends; in its flags, that its two sheets are one; and what is in place
// of an edge or of sheets.
const (
	ContourClosed   = C.SC_TRACE_CLOSED
	ContourBorder   = C.SC_TRACE_BORDER
	ContourBranch   = C.SC_TRACE_BRANCH
	ContourVertex   = C.SC_TRACE_VERTEX
	ContourOneSheet = C.SC_TRACE_ONE_SHEET
	NoEdge          = C.SC_TRACE_NO_EDGE
)

// Contours are those of a pose; each names its first node and how many it has. They stay as they
// are until the workspace's next Trace.
type Contours struct {
	Nodes    []ContourNode
	Contours []Contour
}

// Trace finds the contours of the intersections in a pose. Its pairs of edges and triangles are
// found first, in place of those of the last query.
func Trace[T Scalar](w *Workspace, pose [][3]T) (Contours, error) {
	var count C.uint64_t
	for {
		count = C.uint64_t(len(w.pairs))
		status := C.edge_pairs(w.model.handle, w.handle, first(pose), C.uint32_t(len(pose)),
			positionType[T](), (*C.sc_pair)(first(w.pairs)), &count)
		runtime.KeepAlive(w)
		if status == C.SC_OK {
			break
		}
		if status != C.SC_ERROR_SHORT_BUFFER {
			return Contours{}, check(status)
		}
		w.pairs = make([]Pair, count+count/4)
	}
	for {
		nodes, contours := C.uint64_t(len(w.nodes)), C.uint64_t(len(w.contours))
		status := C.trace(w.model.handle, first(pose), C.uint32_t(len(pose)), positionType[T](),
			(*C.sc_pair)(first(w.pairs)), count,
			(*C.sc_trace_node)(first(w.nodes)), &nodes,
			(*C.sc_trace_contour)(first(w.contours)), &contours)
		runtime.KeepAlive(w)
		if status == C.SC_OK {
			return Contours{w.nodes[:nodes], w.contours[:contours]}, nil
		}
		if status != C.SC_ERROR_SHORT_BUFFER {
			return Contours{}, check(status)
		}
		if int(nodes) > len(w.nodes) {
			w.nodes = make([]ContourNode, nodes)
		}
		if int(contours) > len(w.contours) {
			w.contours = make([]Contour, contours)
		}
	}
}
