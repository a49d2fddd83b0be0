"""The Python package on numpy arrays: pairs of two poses, strides, errors, one model in two threads.

    python3 ffi_python.py MESH GOLDEN LAYOUT

SPDX-License-Identifier: MIT
"""

import _thread
import ast
import ctypes
import inspect
import os
import pickle
import sys
import tempfile
import threading
import time

import numpy as np
import starcontour
from starcontour import _binding

passed = failed = 0


def check(what, condition):
    global passed, failed
    if condition:
        passed += 1
    else:
        failed += 1
        print("failed:", what)


def raised(status, call):
    """The text of the Error of this status that the call raises, else None."""
    try:
        call()
    except starcontour.Error as error:
        return str(error) if error.status == status else None
    return None


def refused(kind, call):
    """The text of the exception of this kind that the call raises, else None."""
    try:
        call()
    except kind as error:
        return str(error) or repr(error)
    return None


def says(what, wanted, text):
    check(f"{what}: says {text!r}, not {wanted!r}", text == wanted)


mesh_path, golden_path, layout_path = sys.argv[1:4]
with open(mesh_path) as file:
    lines = [line.split() for line in file]
rest = np.array([line[1:4] for line in lines if line[0] == "v"], dtype=np.float32)
triangles = np.array([[int(c.split("/")[0]) - 1 for c in line[1:4]] for line in lines if line[0] == "f"])
moved = rest.astype(np.float64)
later = len(rest) // 2
moved[later:, 2] += moved[later:, 0] / 4 - 0.25

golden = {}
golden_contours = []
with open(golden_path) as file:
    for line in file:
        if not line.startswith("#"):
            pose, a, b, *more = line.split()
            if pose == "contour":
                golden_contours.append((int(a), int(b), int(more[0]), float(more[1])))
            else:
                golden.setdefault(pose, []).append((int(a), int(b)))
golden = {pose: np.array(pairs, np.uint32) for pose, pairs in golden.items()}


def same(pairs, pose):
    return pairs.dtype == np.uint32 and np.array_equal(pairs, golden[pose])


# Structures and enumerators are those of the header.
layout = {"struct": {}, "member": {}, "value": {}}
with open(layout_path) as file:
    for line in file:
        kind, *rest_of_line = line.split()
        if kind in ("struct", "value"):
            layout[kind][rest_of_line[0]] = int(rest_of_line[1])
        else:
            name, member, offset, size = rest_of_line
            layout["member"].setdefault(name, []).append((member, int(offset), int(size)))
for structure in _binding.structures:
    name = structure.__name__
    mirrored = [(f, getattr(structure, f).offset, getattr(structure, f).size)
                for f, _ in structure._fields_]
    check(f"{name} is laid out as in the header",
          mirrored == layout["member"][name] and ctypes.sizeof(structure) == layout["struct"][name])
for name in ("sc_contact", "sc_near_stencil", "sc_step_stencil", "sc_trace_node", "sc_trace_contour"):
    dtype = np.dtype(getattr(_binding, name))
    check(f"{name} is laid out as in the header", dtype.itemsize == layout["struct"][name] and [
        (member, dtype.fields[member][1], dtype.fields[member][0].itemsize) for member in dtype.names
    ] == layout["member"][name])
enumerators = {name: value for name, value in vars(_binding).items() if name.startswith("SC_")}
for name, value in enumerators.items():
    check(f"{name} is as in the header", layout["value"].get(name) == value)

model = starcontour.Model(rest, triangles)
check("info", model.info.vertex_count == len(rest) and model.info.triangle_count == len(triangles))
check("pairs at rest", same(model.query(rest), "rest"))
check("pairs when moved", same(model.query(moved), "moved"))
at_rest, wanted = model.trace(rest), np.array(golden_contours)
check("contours at rest", len(wanted) == len(at_rest.contours) > 0 and np.array_equal(
    np.c_[at_rest.nodes["edge"], at_rest.nodes["triangle"]], golden["node"]) and all(
    np.array_equal(at_rest.contours[name], wanted[:, i]) for i, name in enumerate(("count", "begin", "end")))
    and np.allclose(at_rest.contours["length"], wanted[:, 3], rtol=1e-12, atol=0))
check("count and any", model.count(moved) == len(golden["moved"]) and model.collides(moved))
apart = rest.copy()
apart[later:, 2] += 9
check("none", model.query(apart).shape == (0, 2) and not model.collides(apart))
for method in ("sctt", "aabb_sctt", "aabb"):
    check(method, same(model.query(moved, method=method, rest_cache=False), "moved"))
many = model.query(moved, pairs="edge")
check("edges", len(many) == model.count(moved, pairs="edge") and many[:, 0].max() < 3 * len(triangles))
check("proper", model.count(rest, contact="proper") == len(golden["rest"]))

# What is read in place, what is copied, and what is refused.
interleaved = np.zeros(len(rest), [("position", np.float32, 3), ("normal", np.float32, 3)])
interleaved["position"] = rest
wide = np.full((len(rest), 5), np.nan)
wide[:, 1:4] = moved
check("vertex buffers in place", np.shares_memory(
    starcontour._positions(interleaved["position"]), interleaved) and np.shares_memory(
    starcontour._positions(wide[:, 1:4]), wide))
check("interleaved vertices", same(model.query(interleaved["position"]), "rest"))
check("columns of a wider array", same(model.query(wide[:, 1:4]), "moved"))
check("Fortran order", same(model.query(np.asfortranarray(moved)), "moved"))
check("backwards", same(model.query(rest[::-1].copy()[::-1]), "rest"))
check("other byte order", same(model.query(rest.astype(">f4")), "rest"))
check("lists", same(model.query(moved.tolist()), "moved"))
check("one vertex for all", model.count(np.broadcast_to(rest[0], rest.shape)) > 0)
check("integers that may not fit", refused(TypeError, lambda: model.query(rest.astype(np.int64))))
check("complex numbers", refused(TypeError, lambda: model.query(rest.astype(complex))))
check("flat array", refused(ValueError, lambda: model.query(rest.ravel())))
check("unknown option", refused(ValueError, lambda: model.query(rest, pairs="vertex")))
for type in (np.uint16, np.uint32, np.int32, np.int64, ">u4"):
    other = starcontour.Model(rest, triangles.astype(type))
    check(f"triangles as {type}", same(other.query(moved), "moved"))
check("strided triangles", same(starcontour.Model(
    rest, np.pad(triangles.astype(np.uint16), ((0, 0), (0, 1)))[:, :3]).query(moved), "moved"))
check("caller's order", same(starcontour.Model(
    rest, triangles, order=np.arange(len(triangles))[::-1], weld=np.arange(len(rest))).query(moved), "moved"))
check("no welding", same(starcontour.Model(rest, triangles, weld="none").query(rest), "rest"))

# Errors.
spoilt = rest.copy()
spoilt[7, 1] = np.nan
check("NaN", "NaN" in (raised(_binding.SC_ERROR_NOT_FINITE, lambda: model.query(spoilt)) or ""))
check("number of vertices", "vert" in (raised(_binding.SC_ERROR_VERTEX_COUNT, lambda: model.query(rest[:-1])) or ""))
check("negative vertex", raised(_binding.SC_ERROR_INDEX, lambda: starcontour.Model(rest, [[0, 1, -1]])))
check("vertex out of range", raised(_binding.SC_ERROR_INDEX, lambda: starcontour.Model(rest, [[0, 1, len(rest)]])))
check("no triangles", raised(_binding.SC_ERROR_EMPTY, lambda: starcontour.Model(rest, np.empty((0, 3), np.uint32))))
check("patches", len(model.patches(0)) == len(triangles) and raised(_binding.SC_ERROR_LEVEL, lambda: model.patches(99)))
check("usable after errors", same(model.query(rest), "rest"))

# They say which argument it is, and why; in a workspace of one's own, too.
for asked in (model, model.workspace()):
    says("NaN", "vertex 7 is NaN or infinite",
         raised(_binding.SC_ERROR_NOT_FINITE, lambda: asked.query(spoilt)))
    says("NaN at both ends", "vertex 7 is NaN or infinite at the start; vertex 7 is NaN or infinite at the end",
         raised(_binding.SC_ERROR_NOT_FINITE, lambda: asked.step(spoilt, spoilt)))
    says("rings", "ignore_rings is 99, but at most 32",
         raised(_binding.SC_ERROR_OPTION, lambda: asked.query(rest, ignore_rings=99)))
    says("separation", "separation is -1, but finite and at least 0",
         raised(_binding.SC_ERROR_OPTION, lambda: asked.step(rest, rest, separation=-1)))
    says("tolerance", "tolerance is nan, but finite and at least 0",
         raised(_binding.SC_ERROR_OPTION, lambda: asked.step_collides(rest, rest, tolerance=np.nan)))
    says("number of vertices", f"pose.vertex_count is {len(rest) - 1}, but the model has {len(rest)}",
         raised(_binding.SC_ERROR_VERTEX_COUNT, lambda: asked.count(rest[:-1])))
    check("the reason of one call is not told of the next", raised(_binding.SC_ERROR_NOT_FINITE, lambda: asked.query(
        spoilt)) == "vertex 7 is NaN or infinite" and same(asked.query(rest), "rest"))
    kind = asked.__class__.__name__
    for name in ("query", "count", "collides"):
        says("misspelt", f"{kind}.{name}() got an unexpected keyword argument 'ignore_ring'; did you mean "
             "'ignore_rings'?", refused(TypeError, lambda: getattr(asked, name)(rest, ignore_ring=1)))
    for name in ("step", "step_collides"):
        says("misspelt", f"{kind}.{name}() got an unexpected keyword argument 'seperation'; did you mean "
             "'separation'?", refused(TypeError, lambda: getattr(asked, name)(rest, rest, seperation=1)))
    says("unknown", f"{kind}.step() got an unexpected keyword argument 'contact'",
         refused(TypeError, lambda: asked.step(rest, rest, contact="proper")))
    check("poses by name", same(asked.query(pose=rest), "rest") and asked.step(start=rest, end=rest) is not None)
signature = inspect.signature(model.query)
check("help shows keywords", "ignore_rings" in signature.parameters and signature.parameters["budget"].default == 0)
check("help of steps", {"separation", "candidates"} <= set(inspect.signature(model.step).parameters))
says("NaN at rest", "vertex 7 is NaN or infinite",
     raised(_binding.SC_ERROR_NOT_FINITE, lambda: starcontour.Model(spoilt, triangles)))
says("vertex out of range", f"triangle 1 names vertex {len(rest)} of {len(rest)}", raised(
    _binding.SC_ERROR_INDEX, lambda: starcontour.Model(rest, [[0, 1, 2], [0, 1, len(rest)]])))
says("negative vertex", "no triangle or vertex has the number -1",
     raised(_binding.SC_ERROR_INDEX, lambda: starcontour.Model(rest, [[0, 1, -1]])))
says("order", "order[1] is 0, which came before", raised(_binding.SC_ERROR_TREE, lambda: starcontour.Model(
    rest, triangles, order=np.zeros(len(triangles), np.uint32))))
says("weld", "weld_map[0] is 1, which does not represent itself", raised(
    _binding.SC_ERROR_WELD_MAP, lambda: starcontour.Model(
        rest, triangles, weld=np.r_[1, 2, np.arange(2, len(rest))])))
says("ignore", "ignore[1] comes before the one before it", raised(
    _binding.SC_ERROR_PAIRS, lambda: model.query(rest, ignore=golden["moved"][1::-1])))
says("what is below 0", "ignore_rings must be from 0 to 2**32 - 1, not -1",
     refused(ValueError, lambda: model.query(rest, ignore_rings=-1)))
says("a budget below 0", "budget must be from 0 to 2**64 - 1, not -1",
     refused(ValueError, lambda: model.step(rest, rest, budget=-1)))
says("no whole number", "ignore_rings must be a whole number, not 1.5",
     refused(TypeError, lambda: model.query(rest, ignore_rings=1.5)))
says("no number", "separation must be a number, not '1'",
     refused(TypeError, lambda: model.step(rest, rest, separation="1")))
says("no flag", "cancel must be a uint32 array of shape (1,)",
     refused(ValueError, lambda: model.query(rest, cancel=True)))

# Doubles are taken as they are: far from the origin these two triangles meet, and as floats they do
# not.
far = np.array([[500000.155, 5400000.362, 100.080], [500000.208, 5400000.167, 100.355],
                [500000.397, 5400000.115, 100.197], [500000.358, 5400000.218, 100.086],
                [500000.304, 5400000.135, 100.194], [500000.003, 5400000.396, 100.263]])
two = np.arange(6).reshape(2, 3)
check("doubles far from the origin", starcontour.Model(far, two).count(far) == 1 and starcontour.Model(
    far, two).query(far.tolist()).tolist() == [[0, 1]])
check("which floats cannot tell", starcontour.Model(far, two).count(far.astype(np.float32)) == 0)

# Pairs that are not wanted, and queries that are ended.
def incomplete(call):
    """What an ended query found."""
    try:
        call()
    except starcontour.Incomplete as error:
        return error.found
    return None


check("known contacts", len(model.query(moved, ignore=golden["moved"])) == 0)
check("all but one", np.array_equal(model.query(moved, ignore=golden["moved"][1:]), golden["moved"][:1]))
check("list that is not sorted", raised(_binding.SC_ERROR_PAIRS, lambda: model.query(
    moved, ignore=golden["moved"][::-1])))
groups = np.zeros((len(rest), 2), np.uint32)
groups[:later], groups[later:] = (1, 2), (2, 1)
check("groups that collide", same(model.query(moved, vertex_groups=groups), "moved"))
groups[:, 1] = groups[:, 0]
check("groups that do not", model.count(moved, vertex_groups=groups) == 0)
groups = np.full((len(triangles), 2), (1, 0), np.uint32)
check("triangle groups", not model.collides(moved, triangle_groups=groups))
check("rings", len(model.query(np.zeros_like(rest), ignore_rings=2)) < model.count(np.zeros_like(rest)))
flag = np.ones(1, np.uint32)
check("cancelled", len(incomplete(lambda: model.query(moved, cancel=flag))) < len(golden["moved"]))
flag[0] = 0
check("not cancelled", same(model.query(moved, cancel=flag), "moved"))
check("budget", incomplete(lambda: model.count(np.zeros_like(rest), budget=1)) is not None)

# Steps: the second half of the vertices, high above at first, falls through the others.
above, below = rest.astype(np.float64), rest.astype(np.float64)
above[later:, 2] += 9
below[later:, 2] -= 9
step = model.step(above, below)
check("a step collides", len(step.vertex_faces) > 0 and len(step.edge_edges) > 0)
check("its lists are sorted", all(sorted(map(tuple, pairs)) == list(map(tuple, pairs))
                                  for pairs in (step.vertex_faces, step.edge_edges)))
times = np.concatenate([step.vertex_face_times, step.edge_edge_times])
check("each pair has a time", len(times) == len(step.vertex_faces) + len(step.edge_edges))
check("from the earliest on", step.earliest == times.min() and times.max() <= 1 and step.earliest > 0)
held = triangles[step.vertex_faces[:, 1]]
check("no vertex with a face of its own", not (held == step.vertex_faces[:, :1]).any())
for method in ("sctt", "two_boxes", "swept"):
    other = model.step(above, below, method=method)
    check(f"a step by {method}", all(np.array_equal(x, y) for x, y in zip(step, other)))
check("nothing until then", model.step(above, above + (step.earliest * 0.99) * (below - above)).earliest == 1)
check("a step that is free", model.step(above, above + 1).earliest == 1 and not model.step_collides(above, above + 1))
check("a step that is not", model.step_collides(above.astype(np.float32), below))
check("as near as that", model.step(above, above, separation=20.0).earliest == 0)
check("candidates", len(model.step(above, below, candidates=True).vertex_faces) >= len(step.vertex_faces))
check("a workspace for steps", model.workspace().step(above, below).earliest == step.earliest)
check("a step but for itself", len(model.step(above, below, ignore=step).vertex_faces) == 0
      and len(model.step(above, below, ignore=step).edge_edges) == 0)
less = model.step(above, below, ignore=(step.vertex_faces[1:], step.edge_edges))
check("but for all but one", np.array_equal(less.vertex_faces, step.vertex_faces[:1]) and len(less.edge_edges) == 0
      and less.earliest == step.vertex_face_times[0])
groups = np.zeros((len(rest), 2), np.uint32)
groups[:later], groups[later:] = (1, 2), (2, 1)
kept = model.step(above, below, vertex_groups=groups)
check("groups that collide in a step", all(np.array_equal(x, y) for x, y in zip(step, kept)))
groups[:, 1] = groups[:, 0]
check("groups that do not", not model.step_collides(above, below, vertex_groups=groups))
groups = np.full((len(triangles), 2), (1, 0), np.uint32)
check("triangle groups of a step", model.step(above, below, triangle_groups=groups).earliest == 1)
thick = len(model.step(above, above, separation=2.0).vertex_faces)
check("rings of a step", 0 < thick > len(model.step(above, above, separation=2.0, ignore_rings=2).vertex_faces))
check("near at rest", model.step(above, above, separation=2.0, rest=above, rest_distance=2.001).earliest == 1)
check("at rest as floats", model.step_collides(
    above, below, separation=1.0, rest=above.astype(np.float32), rest_distance=1.001))
says("no rest", "rest is NULL",
     raised(_binding.SC_ERROR_NULL, lambda: model.step(above, below, rest_distance=1)))
says("rings of a step", "ignore_rings is 99, but at most 32",
     raised(_binding.SC_ERROR_OPTION, lambda: model.step(above, below, ignore_rings=99)))
says("three lists", "ignore must be a Step, a Near or two arrays",
     refused(ValueError, lambda: model.step(above, below, ignore=step.vertex_faces[:1])))
check("a budget of a step", incomplete(lambda: model.step(above, below, budget=1)) is not None)
spoilt = below.copy()
spoilt[3, 0] = np.inf
check("infinity at the end", raised(_binding.SC_ERROR_NOT_FINITE, lambda: model.step(above, spoilt)))
check("negative separation", raised(_binding.SC_ERROR_OPTION, lambda: model.step(above, below, separation=-1.0)))

# Where pairs meet: points by weights of a and of b are the points themselves.
contacts = model.contacts(moved, golden["moved"])
corners = moved[triangles]
for side, weights in ((0, "weights_a"), (1, "weights_b")):
    mixed = np.einsum("npk,nkx->npx", contacts[weights], corners[golden["moved"][:, side]])
    check(f"contacts by {weights}", np.allclose(mixed, contacts["points"], rtol=0, atol=1e-14))
check("kinds of contacts", set(contacts["kind"]) <= {1, 2, 3} and (contacts["kind"] == 2).any())
check("contacts of none", raised(_binding.SC_ERROR_PAIRS, lambda: model.contacts(moved, [[0, len(triangles)]])))

# Contours: the same from pairs that are given, by threads, and by points of edges and of triangles.
traced = model.trace(moved)
edges = model.query(moved, pairs="edge")
for name, other in (("pairs", model.trace(moved, edges)), ("threads", model.trace(moved, threads=2))):
    check(f"contours by {name}", all((a == b).all() for a, b in zip(traced, other)))
lines = traced.polylines()
check("contours", len(lines) == len(traced.contours) > 0 and (traced.contours["length"] > 0).any())
steps = [np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines]
check("lengths of contours", np.allclose(steps, traced.contours["length"], rtol=1e-12, atol=0))
crossings = traced.nodes[traced.nodes["edge"] != 0xFFFFFFFF]
mixed = np.einsum("nk,nkx->nx", crossings["weights"], corners[crossings["triangle"]])
check("contours by weights", np.allclose(mixed, crossings["point"], rtol=0, atol=1e-14))
three = starcontour.Model(np.eye(3).repeat(3, axis=0), np.arange(9).reshape(3, 3), weld="none")
squares = np.array([[[0, -4, -4], [0, 8, -4], [0, -4, 8]], [[-4, 1, -4], [8, 1, -4], [-4, 1, 8]],
                    [[-4, -4, 2], [8, -4, 2], [-4, 8, 2]]], float).reshape(9, 3)
met, crossed = three.trace_triples(squares), three.trace(squares)
check("triples", met["triangles"].tolist() == [[0, 1, 2]] and np.allclose(met["point"], [[0, 1, 2]], rtol=0, atol=1e-14))
from_to = crossed.nodes["point"][met["nodes"][0]], crossed.nodes["point"][met["nodes"][0] + 1]
check("triples on segments", np.allclose(from_to[0] + met["along"][0][:, None] * (from_to[1] - from_to[0]), [0, 1, 2]))
check("triples of a trace", three.trace_triples(squares, crossed).tobytes() == met.tobytes())
regions, of_vertices, sides = model.regions(moved, traced, inside=True)
check("regions", len(regions) > 1 and regions["vertex_count"].sum() == (of_vertices < len(regions)).sum())
sheared = np.cross(*(corners[:, k].astype(float) - corners[:, 0] for k in (1, 2)))
check("areas of regions", np.isclose(regions["area"].sum(), np.linalg.norm(sheared, axis=1).sum() / 2, rtol=1e-6))
check("sides of contours", sides.shape == (len(lines), 2, 2) and (sides < len(regions)).all())
lack = raised(_binding.SC_ERROR_PAIRS, lambda: model.trace(moved, edges[1:]))
check(f"contours of pairs that lack one: {lack}", lack is not None and "lack an end" in lack)

# Their length, and its gradient: against differences where vertices move by so little that contours
# stay as they are, away from where sheets are in a plane; and it neither pushes nor turns the mesh.
shaken = moved + np.random.default_rng(1).normal(0, 1e-3, moved.shape)
length, gradient = model.trace_length(shaken)
stencils = model.trace_gradients(shaken, model.trace(shaken))
check("length of contours", length > 0 and gradient.shape == shaken.shape and not stencils["flags"].any())
check("weights of stencils", np.allclose(stencils["weights"][:, 2:].sum(1), 1, rtol=0, atol=1e-14))
for vertex in np.argsort(np.linalg.norm(gradient, axis=1))[-40::4]:
    for axis in range(3):
        lengths = []
        for by in (1e-7, -1e-7):
            shaken[vertex, axis] += by
            lengths.append(model.trace_length(shaken)[0])
            shaken[vertex, axis] -= by
        check(f"derivative by vertex {vertex}", abs((lengths[0] - lengths[1]) / 2e-7 - gradient[vertex, axis])
              <= 1e-5 * (1 + np.abs(gradient).max()))
check("no push, no turn", np.abs(gradient.sum(0)).max() < 1e-9 and np.abs(
    np.cross(shaken, gradient).sum(0)).max() < 1e-9)
check("no contours", model.trace_length(above)[0] == 0)
check("nodes of another pose", raised(_binding.SC_ERROR_PAIRS, lambda: model.trace_gradients(
    moved, traced._replace(nodes=traced.nodes[:1]))))
check("nodes alone", refused(TypeError, lambda: model.trace_gradients(moved, traced.nodes)))

# What is near: a list within a distance is what is that near of a list within twice of it.
wide, narrow = (model.near(moved, distance, stencils=True) for distance in (0.09, 0.045))
for pairs, closest, fewer in ((wide.vertex_faces, wide.vertex_face_stencils, narrow.vertex_faces),
                              (wide.edge_edges, wide.edge_edge_stencils, narrow.edge_edges)):
    check("near pairs by distance", 0 < len(fewer) < len(pairs) and closest["distance"].max() <= 0.09
          and np.array_equal(pairs[closest["distance"] <= 0.045], fewer))
    mixed = np.einsum("nk,nkx->nx", closest["weights"], moved[closest["vertices"]])
    check("vectors between closest points", np.allclose(mixed, closest["vector"], rtol=0, atol=1e-14)
          and np.allclose(np.linalg.norm(mixed, axis=1), closest["distance"], rtol=0, atol=1e-14))
check("vertices of stencils", np.array_equal(wide.vertex_face_stencils["vertices"], np.c_[
    wide.vertex_faces[:, 0], triangles[wide.vertex_faces[:, 1]]]))
check("vertices of edges", np.array_equal(
    starcontour.edge_vertices(triangles, wide.edge_edges).reshape(-1, 4),
    wide.edge_edge_stencils["vertices"]) and starcontour.edge_vertices(triangles, 5).tolist() == [
    triangles[1][2], triangles[1][0]])
check("pairs that are near", all(np.array_equal(x, golden[name]) for x, name in zip(
    narrow, ("nearfaces", "nearedges"))))
fall = model.step(rest, moved)
check("pairs of a step", all(np.array_equal(x, golden[name]) for x, name in zip(
    fall, ("stepfaces", "stepedges"))))
check("counts of near pairs", model.near_counts(moved, 0.09) == (len(wide.vertex_faces), len(wide.edge_edges)))
check("any", model.is_near(moved, 0.045) and not model.is_near(apart, 1e-5))
check("without stencils", model.near(moved, 0.09).vertex_face_stencils is None)
bound = model.near(moved, 0.09, vertex_bound=True).vertex_bound
least = np.full(len(rest), 0.09)
for closest in wide[2:4]:
    for corner in range(4):
        np.minimum.at(least, closest["vertices"][:, corner], closest["distance"])
check("bounds of vertices", np.all(bound <= least) and np.all(bound >= least - 1e-4) and bound.min() < 0.09)
check("no bounds", wide.vertex_bound is None)
check("of one kind", len(model.near(moved, 0.09, kinds="vertex_face").edge_edges) == 0 and np.array_equal(
    model.near(moved, 0.09, kinds="edge_edge").edge_edges, wide.edge_edges))
for method in ("sctt", "boxes"):
    other = model.near(moved, 0.09, method=method)
    check(f"near by {method}", all(np.array_equal(x, y) for x, y in zip(other[:2], wide)))
check("near in a workspace", np.array_equal(model.workspace().near(moved, 0.09).edge_edges, wide.edge_edges))
check("a budget", incomplete(lambda: model.near(moved, 0.09, budget=1)) is not None)
says("a distance below 0", "distance is -1, but finite and at least 0",
     raised(_binding.SC_ERROR_OPTION, lambda: model.near(moved, -1)))
says("no distance", "distance must be a number, not None", refused(TypeError, lambda: model.near(moved, None)))
says("no kind", "kinds must be one of both, vertex_face, edge_edge, not 'edge'",
     refused(ValueError, lambda: model.near(moved, 1, kinds="edge")))
says("misspelt", "Model.near() got an unexpected keyword argument 'stencil'; did you mean 'stencils'?",
     refused(TypeError, lambda: model.near(moved, 1, stencil=True)))
check("a vertex with a face of its own", raised(_binding.SC_ERROR_PAIRS, lambda: model.stencils(
    moved, [[triangles[0][0], 0]], kind="vertex_face")))
merged, stand_for = starcontour.merge_stencils(wide.vertex_face_stencils, wide.edge_edge_stencils)
check("merged stencils", stand_for.sum() == len(wide.vertex_faces) + len(wide.edge_edges)
      and len(merged) == len(stand_for) < stand_for.sum() and stand_for.min() == 1)
keys = [frozenset((frozenset(v[w < 0]), frozenset(v[w > 0]))) for v, w, feature in zip(
    merged["vertices"], merged["weights"], merged["feature"]) if feature <= 2]
check("each vertex and edge once", len(keys) == len(set(keys)) > 0)
check("no stencils", refused(TypeError, lambda: starcontour.merge_stencils(moved)))

# What is near, but not what is not wanted.
check("all that is known", model.near_counts(moved, 0.09, ignore=wide) == (0, 0))
hits = model.step_stencils(rest, moved, fall.vertex_faces, fall.vertex_face_times, kind="vertex_face")
check("pairs of a step", len(hits) and np.array_equal(hits["time"], fall.vertex_face_times) and np.array_equal(
    hits["start"], model.stencils(rest, fall.vertex_faces, kind="vertex_face")))
check("normals", np.allclose(np.linalg.norm(hits["normal"], axis=1), 1) and np.all(abs(hits["side"]) == 1))
check("what comes no nearer", model.step(moved, moved, separation=0.09).earliest == 0 and not len(
    model.step(np.asarray(moved) + 0, np.asarray(moved) + 1, separation=0.05, only_nearer=True).edge_edges))
check("what is known of a step", model.near_counts(moved, 0.09, ignore=fall) != (0, 0) and model.near_counts(
    moved, 0.09, ignore=(wide.vertex_faces[1:], wide.edge_edges)) == (1, 0))
at_rest = [model.stencils(rest, pairs, kind=kind)["distance"] for pairs, kind in zip(
    wide, ("vertex_face", "edge_edge"))]
check("what was far at rest", all(np.array_equal(x, pairs[far > 0.05]) and 0 < len(x) < len(pairs) for x, pairs, far
      in zip(model.near(moved, 0.09, rest=rest, rest_distance=0.05), wide, at_rest)))
check("rings", sum(model.near_counts(moved, 0.3, ignore_rings=4)) < sum(model.near_counts(moved, 0.3)))
check("groups", model.near_counts(moved, 0.09, vertex_groups=np.zeros((len(rest), 2), np.uint32)) == (0, 0))
says("no rest pose", "rest is NULL", (raised(
    _binding.SC_ERROR_NULL, lambda: model.near(moved, 1, rest_distance=1)) or ""))

# Several threads: the same answer.
big = np.concatenate([rest + (0, 0, 3 * k) for k in range(24)]).astype(np.float64)
many_triangles = np.concatenate([triangles + k * len(rest) for k in range(24)])
crowd = starcontour.Model(big, many_triangles)
lower = big.copy()
lower[later:, 2] -= 1
alone = crowd.query(lower), crowd.step(big, lower), crowd.near(lower, 0.1)
for threads in (2, 3, 8):
    check(f"pairs by {threads} threads", np.array_equal(crowd.query(lower, threads=threads), alone[0]))
    check(f"a step by {threads} threads", all(
        np.array_equal(x, y) for x, y in zip(crowd.step(big, lower, threads=threads), alone[1])))
    check(f"what is near by {threads} threads", all(
        np.array_equal(x, y) for x, y in zip(crowd.near(lower, 0.1, threads=threads)[:2], alone[2])))
for threads in (0, 257):
    says("threads", f"threads must be from 1 to 256, not {threads}",
         refused(ValueError, lambda: crowd.query(big, threads=threads)))
says("what is wrong, by threads", f"vertex {len(big) - 1} is NaN or infinite", raised(
    _binding.SC_ERROR_NOT_FINITE, lambda: crowd.query(np.r_[big[:-1], [[0, 0, np.nan]]], threads=2)))


def interrupt():
    for _ in range(20):
        time.sleep(0.01)
        if interrupted:
            return
        _thread.interrupt_main()


interrupted = False
alarm = threading.Thread(target=interrupt)
try:
    alarm.start()
    for _ in range(10**6):
        crowd.near(lower, 0.2, threads=2)
except KeyboardInterrupt:
    interrupted = True
while alarm.is_alive():
    try:
        alarm.join()
    except KeyboardInterrupt:
        pass
check("an interrupted query", interrupted)
check("and one after it", np.array_equal(crowd.query(lower, threads=2), alone[0]))

# What is given back early, and what is shown.
with starcontour.Model(rest, triangles) as closed, closed.workspace() as workspace:
    check("a model and a workspace, shown", repr(workspace) == "<starcontour.Workspace of <starcontour.Model of "
          f"{len(triangles)} triangles and {len(rest)} vertices>>")
    check("in a with statement", same(workspace.query(rest), "rest") and same(closed.query(rest), "rest"))
with model.workspace() as workspace:
    pass
says("a closed workspace", "the workspace is closed", refused(ValueError, lambda: workspace.query(rest)))
says("a closed model", "the model is closed", refused(ValueError, lambda: closed.query(rest)))
says("its workspace", "the model is closed", refused(ValueError, lambda: closed.workspace().query(rest)))
check("a closed model, shown", repr(closed) == "<starcontour.Model, closed>")
check("a step, shown", repr(step) == f"<starcontour.Step: {len(step.vertex_faces)} vertex-face and "
      f"{len(step.edge_edges)} edge-edge pairs, earliest {step.earliest:.6g}>")
check("what is near, shown", "vertex-face and" in repr(wide))

# Several objects: the same pairs as one mesh of all of them.
scene = starcontour.Scene()
offset = np.array([0.05, 0.02, 0.1])
poses = [moved, moved + offset, rest + [0, 0, 0.3]]
for number, pose in enumerate(poses):
    scene.add(model, pose, itself=number < 2)
whole_rest = np.concatenate([rest + [0, 0, 100.0 * k] for k in range(3)])
whole_triangles = np.concatenate([triangles + k * len(rest) for k in range(3)])
whole = starcontour.Model(whole_rest, whole_triangles)


def joined(meetings, kind, timed=False):
    """Meetings in numbers of the whole, sorted; those of the last object with itself are not there."""
    def first(one, vertices):
        return one.number * (len(rest) if vertices else len(triangles) * (3 if kind == "edge" else 1))

    rows = [row for m in meetings for row in zip(
        (m.pairs[:, 0].astype(int) + first(m.a, kind == "vertex_face")).tolist(),
        (m.pairs[:, 1].astype(int) + first(m.b, False)).tolist(), m.times.tolist() if timed else m.pairs[:, 0] * 0)]
    return sorted(rows)


def of_whole(pairs, kind, times=None):
    of = [len(rest) if kind == "vertex_face" else len(triangles) * (3 if kind == "edge" else 1),
          len(triangles) * (3 if kind == "edge" else 1)]
    rows = zip(pairs[:, 0].tolist(), pairs[:, 1].tolist(), [0] * len(pairs) if times is None else times.tolist())
    return sorted(row for row in rows if not row[0] // of[0] == row[1] // of[1] == 2)


ends = [pose + [0, 0, 0.05 * number] for number, pose in enumerate(poses)]
for threads in (1, 2):
    together = np.concatenate(poses)
    check("a scene's pairs", joined(scene.query(threads=threads), "triangle") == of_whole(whole.query(together), "triangle"))
    near_scene, near_whole = scene.near(0.2, threads=threads), whole.near(together, 0.2)
    check("near in a scene", joined(near_scene.vertex_faces, "vertex_face") == of_whole(near_whole.vertex_faces, "vertex_face")
          and joined(near_scene.edge_edges, "edge") == of_whole(near_whole.edge_edges, "edge")
          and len(near_scene.edge_edges) > 2)
    for one, end in zip(scene, ends):
        one.end = end
    step_scene, step_whole = scene.step(separation=0.05, threads=threads), whole.step(together, np.concatenate(ends), separation=0.05)
    check("a step of a scene", joined(step_scene.vertex_faces, "vertex_face", True) == of_whole(
        step_whole.vertex_faces, "vertex_face", step_whole.vertex_face_times) and joined(
        step_scene.edge_edges, "edge", True) == of_whole(step_whole.edge_edges, "edge", step_whole.edge_edge_times))
    scene.objects[1].pose = poses[1] = poses[1] + [0.01, 0, 0]
    scene.objects[1].end = ends[1] = poses[1]
check("a pose of a scene", np.array_equal(scene.objects[1].pose, poses[1]) and len(scene) == 3)
scene.objects[0].group = (1, 2)
scene.objects[1].group = (4, 4)
check("groups of objects", not any(m.a is not m.b and m.a.number + m.b.number == 1 for m in scene.query()))
says("an object without a pose", "object 3 has no pose", refused(ValueError, lambda: (scene.add(model), scene.query())))
scene.objects[3].pose = np.full_like(rest, np.nan)
says("an object that is not finite", "object 3 has a vertex that is not finite; vertex 0 is NaN or infinite",
     raised(_binding.SC_ERROR_NOT_FINITE, scene.query))
scene.objects[3].pose = rest[:-1]
check("an object of another mesh", "vertex_count" in (raised(_binding.SC_ERROR_VERTEX_COUNT, scene.query) or ""))
says("threads of a scene", "threads must be from 1 to 256, not 0", refused(ValueError, lambda: scene.query(threads=0)))
check("an empty scene", starcontour.Scene().query() == [] and starcontour.Scene().step().earliest == 1)
scene.objects.pop()
found = incomplete(lambda: scene.near(0.2, cancel=np.ones(1, np.uint32)))
check("a scene that was cancelled", found is not None)

# The types of the package say of each method what it takes.
folder = os.path.dirname(starcontour.__file__)
check("the package has types", os.path.exists(os.path.join(folder, "py.typed")))
stub = ast.Module(body=[], type_ignores=[])
for name in ("__init__.pyi", "scene.pyi"):
    with open(os.path.join(folder, name)) as file:
        stub.body += ast.parse(file.read()).body


def typed(definition):
    arguments = definition.args
    return [a.arg for a in arguments.args], sorted(a.arg for a in arguments.kwonlyargs), \
        arguments.vararg.arg if arguments.vararg else None


def taken(function):
    parameters = inspect.signature(inspect.unwrap(function, stop=lambda f: hasattr(f, "__signature__"))).parameters
    of = {kind: [p.name for p in parameters.values() if p.kind == kind] for kind in
          (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.VAR_POSITIONAL)}
    plain, keywords, rest_of_them = of.values()
    return plain, sorted(keywords), rest_of_them[0] if rest_of_them else None


compared = 0
for entry in stub.body:
    if isinstance(entry, ast.FunctionDef):
        check(f"types of {entry.name}", typed(entry) == taken(getattr(starcontour, entry.name)))
    if isinstance(entry, ast.ClassDef) and any(getattr(b, "id", "") == "NamedTuple" for b in entry.bases):
        check(f"types of {entry.name}", getattr(starcontour, entry.name)._fields == tuple(
            line.target.id for line in entry.body if isinstance(line, ast.AnnAssign)))
    elif isinstance(entry, ast.ClassDef):
        source = vars(getattr(starcontour, entry.name))
        for method in entry.body:
            if isinstance(method, ast.FunctionDef) and not method.name.startswith("__") and \
                    not isinstance(source[method.name], property):
                function = getattr(source[method.name], "__func__", source[method.name])
                check(f"types of {entry.name}.{method.name}", typed(method) == taken(function))
                compared += 1
        public = {name for name in source if not name.startswith("_")} - {"model"}
        check(f"types of all of {entry.name}", public <= {getattr(line, "name", None) for line in entry.body})
check("types of all queries", compared >= 16)

# Saved models.
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "cloths.scm")
    model.save(path)
    for in_place in (False, True):
        loaded = starcontour.Model.load(path, in_place=in_place)
        check(f"loaded model, in place: {in_place}", same(loaded.query(moved), "moved"))
    check("saved again", loaded.tobytes() == model.tobytes())
    check("another mesh's model", raised(_binding.SC_ERROR_TOPOLOGY, lambda: starcontour.Model.load(
        path, topology_hash=model.info.topology_hash ^ 1)))
    del loaded
data = model.tobytes()
check("no model", raised(_binding.SC_ERROR_NOT_SAVED, lambda: starcontour.Model.frombytes(bytes(len(data)))))
check("model cut off", raised(_binding.SC_ERROR_TRUNCATED, lambda: starcontour.Model.frombytes(data[:-1])))
check("model changed", raised(_binding.SC_ERROR_CHECKSUM, lambda: starcontour.Model.frombytes(
    data[:-1] + bytes([data[-1] ^ 1]))))
check("pickled model", same(pickle.loads(pickle.dumps(model)).query(rest), "rest"))

# One model, two threads, each with a workspace of its own.
wrong = []


def work(pose, positions):
    workspace = model.workspace()
    for _ in range(100):
        if not same(workspace.query(positions), pose) or not same(model.query(positions), pose):
            wrong.append(pose)


threads = [threading.Thread(target=work, args=arguments) for arguments in (("rest", rest), ("moved", moved))]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
check("two threads, one model", not wrong)

busy = model.workspace()
with busy._scratch.lock:
    check("workspace in use", raised(_binding.SC_ERROR_WORKSPACE, lambda: busy.query(rest)))
check("and free again", same(busy.query(rest), "rest"))

# A workspace keeps its model.
alone = starcontour.Model(rest, triangles).workspace()
check("workspace outlives the last name of its model", same(alone.query(rest), "rest"))

print(f"python: {passed} passed, {failed} failed")
sys.exit(failed > 0)
