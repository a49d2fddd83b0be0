"""The Python package on numpy arrays: pairs of two poses, strides, errors, one model in two threads.

    python3 ffi_python.py MESH GOLDEN LAYOUT

SPDX-License-Identifier: MIT
"""

import ctypes
import inspect
import os
import pickle
import sys
import tempfile
import threading

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

golden = {"rest": [], "moved": []}
with open(golden_path) as file:
    for line in file:
        if not line.startswith("#"):
            pose, a, b = line.split()
            golden[pose].append((int(a), int(b)))
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
dtype = np.dtype(_binding.sc_contact)
check("sc_contact is laid out as in the header", dtype.itemsize == layout["struct"]["sc_contact"] and [
    (name, dtype.fields[name][1], dtype.fields[name][0].itemsize) for name in dtype.names
] == layout["member"]["sc_contact"])
enumerators = {name: value for name, value in vars(_binding).items() if name.startswith("SC_")}
for name, value in enumerators.items():
    check(f"{name} is as in the header", layout["value"].get(name) == value)

model = starcontour.Model(rest, triangles)
check("info", model.info.vertex_count == len(rest) and model.info.triangle_count == len(triangles))
check("pairs at rest", same(model.query(rest), "rest"))
check("pairs when moved", same(model.query(moved), "moved"))
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
says("three lists", "ignore must be a Step or two arrays",
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
