// Go: pairs of two poses, the structures' layout, errors, one model in two goroutines.
//
//	ffi_go MESH GOLDEN LAYOUT
//
// SPDX-License-Identifier: MIT

package main

import (
	"bufio"
	"errors"
	"fmt"
	"math"
	"os"
	"reflect"
	"sort"
	"strings"
)

var passed, failed int

func expect(what string, condition bool) {
	if condition {
		passed++
	} else {
		failed++
		fmt.Println("failed:", what)
	}
}

func refused(err error, wanted Error, text string) bool {
	return errors.Is(err, wanted) && strings.Contains(err.Error(), text)
}

func lines(path string) []string {
	file, err := os.Open(path)
	if err != nil {
		fmt.Println(err)
		os.Exit(2)
	}
	defer file.Close()
	var all []string
	for scanner := bufio.NewScanner(file); scanner.Scan(); {
		all = append(all, scanner.Text())
	}
	return all
}

func same(pairs []Pair, golden []Pair) bool {
	if len(pairs) != len(golden) {
		return false
	}
	for i := range pairs {
		if pairs[i] != golden[i] {
			return false
		}
	}
	return true
}

// goldenContour is a contour of the golden file.
type goldenContour struct {
	count      uint64
	begin, end uint32
	length     float64
}

func alike(a, b float64) bool { return math.Abs(a-b) <= 1e-12*b }

// sameContours tells whether these are the golden contours, with these nodes: edges and triangles.
func sameContours(found Contours, golden []goldenContour, nodes []Pair) bool {
	if len(found.Contours) != len(golden) || len(found.Nodes) != len(nodes) {
		return false
	}
	for i, node := range found.Nodes {
		if (Pair{node.Edge, node.Triangle}) != nodes[i] {
			return false
		}
	}
	for i, contour := range found.Contours {
		wanted := golden[i]
		if contour.Count != wanted.count || contour.Begin != wanted.begin ||
			contour.End != wanted.end || !alike(contour.Length, wanted.length) {
			return false
		}
	}
	return true
}

// lengthsFit tells whether nodes follow each other contour after contour, and so does the length of
// their segments.
func lengthsFit(found Contours) bool {
	var next uint64
	for _, contour := range found.Contours {
		if contour.First != next {
			return false
		}
		next += contour.Count
		nodes := found.Nodes[contour.First:next]
		length := 0.0
		for i, node := range nodes {
			if i+1 == len(nodes) && contour.Begin != ContourClosed {
				break
			}
			p, q := node.Point, nodes[(i+1)%len(nodes)].Point
			x, y, z := p[0]-q[0], p[1]-q[1], p[2]-q[2]
			length += math.Sqrt(x*x + y*y + z*z)
		}
		if !alike(length, contour.Length) {
			return false
		}
	}
	return next == uint64(len(found.Nodes))
}

// expectLayout compares members of a structure, their places and sizes with the header's.
func expectLayout(layout []string, name string, structure any) {
	kind := reflect.TypeOf(structure)
	own := []string{fmt.Sprintf("struct %s %d", name, kind.Size())}
	for i := 0; i < kind.NumField(); i++ {
		field := kind.Field(i)
		member := strings.ToLower(field.Name)
		if member == "_" {
			member = "reserved"
		}
		own = append(own, fmt.Sprintf("member %s %s %d %d", name, member, field.Offset, field.Type.Size()))
	}
	var header []string
	for _, line := range layout {
		if strings.Split(line, " ")[1] == name {
			header = append(header, line)
		}
	}
	expect(name+" is laid out as in the header", reflect.DeepEqual(own, header))
}

func main() {
	var rest [][3]float32
	var triangles [][3]uint32
	for _, line := range lines(os.Args[1]) {
		var p [3]float32
		var t [3]uint32
		if n, _ := fmt.Sscanf(line, "v %g %g %g", &p[0], &p[1], &p[2]); n == 3 {
			rest = append(rest, p)
		} else if n, _ := fmt.Sscanf(line, "f %d %d %d", &t[0], &t[1], &t[2]); n == 3 {
			triangles = append(triangles, [3]uint32{t[0] - 1, t[1] - 1, t[2] - 1})
		}
	}
	moved := make([][3]float64, len(rest))
	for i, p := range rest {
		moved[i] = [3]float64{float64(p[0]), float64(p[1]), float64(p[2])}
		if i >= len(rest)/2 {
			moved[i][2] += moved[i][0]/4 - 0.25
		}
	}
	golden := map[string][]Pair{}
	var contours []goldenContour
	for _, line := range lines(os.Args[2]) {
		var pose string
		var pair Pair
		var contour goldenContour
		if n, _ := fmt.Sscanf(line, "contour %d %d %d %g", &contour.count, &contour.begin,
			&contour.end, &contour.length); n == 4 {
			contours = append(contours, contour)
		} else if n, _ := fmt.Sscan(line, &pose, &pair.A, &pair.B); n == 3 {
			golden[pose] = append(golden[pose], pair)
		}
	}
	expect("there is something to compare", len(golden["rest"]) > 0 && len(golden["moved"]) > 0)
	layout := lines(os.Args[3])
	expectLayout(layout, "sc_pair", Pair{})
	expectLayout(layout, "sc_trace_node", ContourNode{})
	expectLayout(layout, "sc_trace_contour", Contour{})

	model, err := Build(rest, triangles)
	if err != nil {
		fmt.Println(err)
		os.Exit(1)
	}
	workspace, err := model.Workspace()
	if err != nil {
		fmt.Println(err)
		os.Exit(1)
	}
	pairs, err := Query(workspace, rest)
	expect("pairs at rest", err == nil && same(pairs, golden["rest"]))
	pairs, err = Query(workspace, moved)
	expect("pairs when moved", err == nil && same(pairs, golden["moved"]))

	traced, err := Trace(workspace, rest)
	expect("contours at rest", err == nil && len(contours) > 0 &&
		sameContours(traced, contours, golden["node"]))
	expect("lengths of contours", lengthsFit(traced))
	traced, err = Trace(workspace, moved)
	expect("contours when moved", err == nil && lengthsFit(traced) &&
		!sameContours(traced, contours, golden["node"]))

	answers := make(chan bool, 2)
	go func() { answers <- repeat(model, rest, golden["rest"]) }()
	go func() { answers <- repeat(model, moved, golden["moved"]) }()
	one, two := <-answers, <-answers
	expect("two goroutines, one model", one && two)

	larger, err := model.WorkspaceFor(ForNear)
	if err != nil {
		fmt.Println(err)
		os.Exit(1)
	}
	near, err := Near(larger, moved, 0.045)
	expect("pairs that are near", err == nil && same(near.VertexFaces, golden["nearfaces"]) &&
		same(near.EdgeEdges, golden["nearedges"]))
	wide := make([][3]float64, len(rest))
	for i, p := range rest {
		wide[i] = [3]float64{float64(p[0]), float64(p[1]), float64(p[2])}
	}
	step, err := Step(larger, wide, moved, 0)
	expect("pairs of a step", err == nil && same(step.VertexFaces, golden["stepfaces"]) &&
		same(step.EdgeEdges, golden["stepedges"]))
	later := step.Earliest > 0 && len(step.EdgeEdgeTimes) == len(step.EdgeEdges)
	for _, time := range step.EdgeEdgeTimes {
		later = later && time >= step.Earliest
	}
	expect("at their times", later)
	step, err = Step(larger, moved, moved, 0)
	expect("a step that is free", err == nil && step.Earliest == 1 && len(step.VertexFaces) == 0)
	_, err = Near(larger, moved, -1)
	expect("a distance below 0", refused(err, ErrorOption, "option"))
	_, err = Step(workspace, moved, moved, 0)
	expect("no room for steps", refused(err, ErrorWorkspace, "workspace"))

	_, err = Query(workspace, moved[1:])
	expect("number of vertices", refused(err, ErrorVertexCount, "vert"))
	moved[3][2] = math.NaN()
	_, err = Query(workspace, moved)
	expect("NaN", refused(err, ErrorNotFinite, "NaN"))
	_, err = Trace(workspace, moved)
	expect("contours of NaN", refused(err, ErrorNotFinite, "NaN"))
	_, err = Build(rest, nil)
	expect("no triangles", refused(err, ErrorEmpty, "triangle"))
	_, err = Build(rest, [][3]uint32{{0, 1, uint32(len(rest))}})
	expect("vertex out of range", refused(err, ErrorIndex, "vertex"))
	pairs, err = Query(workspace, rest)
	expect("usable after errors", err == nil && same(pairs, golden["rest"]))

	expectScene(rest, triangles, golden)

	fmt.Printf("go: %d passed, %d failed\n", passed, failed)
	if failed > 0 {
		os.Exit(1)
	}
}

func repeat[T Scalar](model *Model, pose [][3]T, golden []Pair) bool {
	workspace, err := model.Workspace()
	for i := 0; err == nil && i < 200; i++ {
		var pairs []Pair
		pairs, err = Query(workspace, pose)
		if err == nil && !same(pairs, golden) {
			return false
		}
	}
	return err == nil
}

// joined makes pairs of the one mesh of two objects of meetings, sorted; firstA and firstB are the
// numbers there of what is the second object's first.
func joined(meetings []Meeting, firstA, firstB int) []Pair {
	var pairs []Pair
	for _, m := range meetings {
		for _, p := range m.Pairs {
			pairs = append(pairs, Pair{p.A + uint32(m.A*firstA), p.B + uint32(m.B*firstB)})
		}
	}
	sort.Slice(pairs, func(i, j int) bool {
		a, b := pairs[i], pairs[j]
		return a.A < b.A || a.A == b.A && a.B < b.B
	})
	return pairs
}

// expectScene asks about the mesh's two cloths as two objects, which have the pairs of the mesh.
func expectScene(rest [][3]float32, triangles [][3]uint32, golden map[string][]Pair) {
	vertices, half := len(rest)/2, len(triangles)/2
	second := make([][3]uint32, half)
	for i, t := range triangles[half:] {
		for k, v := range t {
			second[i][k] = v - uint32(vertices)
		}
	}
	ends := append([][3]float32{}, rest...)
	for i := vertices; i < len(ends); i++ {
		ends[i][2] += ends[i][0]/4 - 0.25
	}
	one, err1 := Build(rest[:vertices], triangles[:half])
	other, err2 := Build(rest[vertices:], second)
	scene, err3 := NewScene(ForNear)
	if err1 != nil || err2 != nil || err3 != nil {
		expect("a scene", false)
		return
	}
	a, err1 := scene.Add(one)
	b, err2 := scene.Add(other)
	_, err := scene.Query()
	expect("objects without a pose", err1 == nil && err2 == nil && refused(err, ErrorNull, "NULL"))
	err1, err2 = SetPose(a, rest[:vertices]), SetPose(b, rest[vertices:])
	found, err := scene.Query()
	expect("pairs of two objects", err1 == nil && err2 == nil && err == nil &&
		same(joined(found, half, half), golden["rest"]))
	err1, err2 = SetEnd(a, ends[:vertices]), SetEnd(b, ends[vertices:])
	step, err := scene.Step(0)
	expect("a step of two objects", err1 == nil && err2 == nil && err == nil &&
		same(joined(step.VertexFaces, vertices, half), golden["stepfaces"]) &&
		same(joined(step.EdgeEdges, 3*half, 3*half), golden["stepedges"]))
	earliest := 1.0
	for _, m := range append(step.VertexFaces, step.EdgeEdges...) {
		for _, time := range m.Times {
			earliest = math.Min(earliest, time)
		}
	}
	expect("at their times", step.Earliest > 0 && step.Earliest == earliest)
	err1, err2 = SetPose(a, ends[:vertices]), SetPose(b, ends[vertices:])
	near, err := scene.Near(0.045)
	expect("near of two objects", err1 == nil && err2 == nil && err == nil &&
		same(joined(near.VertexFaces, vertices, half), golden["nearfaces"]) &&
		same(joined(near.EdgeEdges, 3*half, 3*half), golden["nearedges"]))
	found, err = scene.Query()
	expect("pairs when they moved", err == nil && same(joined(found, half, half), golden["moved"]))

	a.SetGroup(1, 1)
	b.SetGroup(2, 2)
	found, err = scene.Query()
	expect("groups of objects", err == nil && len(found) == 0)
	flat := make([][3]float64, vertices)
	err1 = SetPose(a, flat)
	found, err = scene.Query()
	workspace, err2 := one.Workspace()
	if err2 == nil {
		alone, err2 := Query(workspace, flat)
		expect("an object and itself", err == nil && err1 == nil && err2 == nil &&
			len(found) == 1 && same(found[0].Pairs, alone))
	}
	a.SetItself(false)
	found, err = scene.Query()
	expect("an object without itself", err == nil && len(found) == 0)

	copies, err := NewScene(ForNear)
	if err != nil {
		expect("a scene of copies", false)
		return
	}
	away := make([][3]float32, vertices)
	for i, p := range rest[:vertices] {
		away[i] = [3]float32{p[0] + 100, p[1], p[2]}
	}
	for _, pose := range [][][3]float32{rest[:vertices], rest[vertices:], away} {
		var c Object
		if c, err = copies.Add(one); err == nil {
			err = SetPose(c, pose)
		}
		expect("a copy", err == nil)
	}
	found, err = copies.Query()
	expect("objects of one model, which have one room", err == nil &&
		same(joined(found, half, half), golden["rest"]) && copies.lends(0))
}
