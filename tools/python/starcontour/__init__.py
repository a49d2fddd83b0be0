"""Every self-collision of a deforming triangle mesh, exactly and fast, on numpy arrays.

    model = starcontour.Model(rest, triangles)      once per topology
    pairs = model.query(pose)                       once per pose: array of shape (n, 2)
    step = model.step(start, end)                   what collides on the way from one pose to another
    near = model.near(pose, 0.01)                   what comes within a distance in a pose

starcontour.h is the manual of the library that does the work: it says what a pair is, what is
guaranteed, and what the options mean. Here they are keywords with the names of its enumerators:

    pairs       "triangle" (default) or "edge": an edge a = 3 t + k, from vertex k to vertex
                (k + 1) % 3 of triangle t, and a triangle b
    contact     "touching" (default) or "proper"
    method      "default", "sctt", "aabb_sctt" or "aabb": the answer is the same
    rest_cache  True (default) or False: the answer is the same

    ignore_rings      leave out pairs so near to each other on the mesh; 1: that share a vertex. The
                      model keeps what that is for near, 0.1 s and 4 MB for 65,000 triangles and 4
    ignore            leave out these pairs: an array of shape (k, 2) as a query returns them
    vertex_groups     a category and a mask for each vertex, shape (n, 2), see sc_group
    triangle_groups   the same for each triangle
    cancel            a uint32 array of one element: another thread ends the query by setting it
    budget            end the query after so many units of work; 0 (default): no limit

Steps take cancel and budget, too, and

    separation  how near is a collision: 0 (default), or a distance in units of the coordinates
    tolerance   how exactly distances are told, the same units; 0 (default): a millionth of the size
    method      "default", "sctt", "two_boxes" or "swept": the answer is the same
    candidates  True: what boxes and culling leave, in place of collisions; without times
    only_nearer  True: of pairs that begin within the separation only those that come nearer than they
                began, by more than two tolerances, or touch

What is near takes cancel and budget, too, and

    kinds     "both" (default), "vertex_face" or "edge_edge"
    method    "default", "sctt" or "boxes": the answer is the same
    stencils  True: the closest points of each pair as well; see Model.stencils
    vertex_bound  True: for each vertex, how far all that is at it is from all that is reported, at
              least, and at most the distance: if nothing is left out and nothing intersects, vertices
              may move by less than half of it

Steps and what is near take ignore_rings and both kinds of groups, too, and

    ignore    leave out these pairs: a Step, a Near, or two arrays of shape (k, 2) as their first two

    rest, rest_distance   leave out pairs that are within this distance of each other in this pose

All take

    threads  how many threads the query may use, 1 (default) to 256: the answer is the same

A query that cancel or budget ended raises Incomplete, which has what was found so far.

Positions are arrays of shape (n, 3). Rows of float32 or float64 whose three numbers are contiguous
are read in place, whatever lies between the rows; other arrays are copied, if that is exact, and
refused if it is not. Triangles are arrays of shape (m, 3) of integers; uint32 and uint16 are read in
place.

A Scene has several objects, each with a Model, and finds what they have with each other.

starcontour.batch asks about many poses at a time, by the processes of Ray, Dask or others.

A Model never changes and may be used by any number of threads at once. A Workspace belongs to one
call at a time: another call on it meanwhile raises an Error. Queries release the global lock. Both
give back their memory when they are no longer referred to, or at the end of a with statement.

SPDX-License-Identifier: MIT
"""

import ctypes
import difflib
import functools
import inspect
import operator
import re
import threading
import weakref
from collections import namedtuple

import numpy as np

from . import _binding, _threads
from ._binding import lib

__all__ = ["Error", "Incomplete", "Meeting", "Model", "ModelInfo", "Near", "Scene", "SceneNear",
           "SceneObject", "SceneStep", "Step", "Workspace", "edge_vertices", "merge_stencils", "version"]

version = lib.sc_version_string().decode()

_WELD = {"rest": _binding.SC_WELD_REST, "none": _binding.SC_WELD_NONE}
_PAIRS = {"triangle": _binding.SC_PAIRS_TRIANGLE, "edge": _binding.SC_PAIRS_EDGE}
_CONTACT = {"touching": _binding.SC_CONTACT_TOUCHING, "proper": _binding.SC_CONTACT_PROPER}
_METHOD = {
    "default": _binding.SC_METHOD_DEFAULT,
    "sctt": _binding.SC_METHOD_SCTT,
    "aabb_sctt": _binding.SC_METHOD_AABB_SCTT,
    "aabb": _binding.SC_METHOD_AABB,
}
_STEP_METHOD = {
    "default": _binding.SC_STEP_METHOD_DEFAULT,
    "sctt": _binding.SC_STEP_METHOD_SCTT,
    "two_boxes": _binding.SC_STEP_METHOD_TWO_BOXES,
    "swept": _binding.SC_STEP_METHOD_SWEPT,
}
_NEAR_KINDS = {
    "both": _binding.SC_NEAR_BOTH,
    "vertex_face": _binding.SC_NEAR_VERTEX_FACE,
    "edge_edge": _binding.SC_NEAR_EDGE_EDGE,
}
_NEAR_METHOD = {
    "default": _binding.SC_NEAR_METHOD_DEFAULT,
    "sctt": _binding.SC_NEAR_METHOD_SCTT,
    "boxes": _binding.SC_NEAR_METHOD_BOXES,
}
_IN_USE = "the workspace is in use by another call"

ModelInfo = namedtuple(
    "ModelInfo", [name for name, _ in _binding.sc_model_info._fields_ if name != "struct_size"]
)


class Step(namedtuple("Step", "vertex_faces edge_edges vertex_face_times edge_edge_times earliest")):
    """What collides in a step.

    vertex_faces, edge_edges            uint32 arrays of shape (n, 2), sorted; edges as in pairs "edge"
    vertex_face_times, edge_edge_times  when: a lower bound from 0 to 1 for each; None of candidates
    earliest                            nothing collides before this time; 1 if nothing does at all
    """

    __slots__ = ()

    def __repr__(self):
        return (f"<starcontour.Step: {len(self.vertex_faces)} vertex-face and {len(self.edge_edges)} "
                f"edge-edge pairs, earliest {self.earliest:.6g}>")


class Trace(namedtuple("Trace", "nodes contours")):
    """Contours of intersections, two structured arrays; see sc_trace_node and sc_trace_contour.

    nodes      fields edge, triangle, sheet, sheets (two), along, weights (three) and point (three)
    contours   fields first and count (which nodes), begin and end (0 closed, 1 border, 2 branch,
               3 vertex), flags (1: its two sheets are one) and length
    """

    __slots__ = ()

    def polylines(self):
        """The points of each contour, (count, 3); of closed ones the first again at the end."""
        lines = []
        for contour in self.contours:
            points = self.nodes["point"][contour["first"] : contour["first"] + contour["count"]]
            lines.append(np.vstack([points, points[:1]]) if contour["begin"] == 0 else points.copy())
        return lines


class Regions(namedtuple("Regions", "regions vertex_regions sides")):
    """The parts into which contours divide a surface; see sc_region and sc_contour_sides.

    regions          structured array: component, vertex_count, area, inside
    vertex_regions   of each vertex the region it is in; 0xffffffff of those in no triangle, and of
                     those that are welded to another one, which has their region
    sides            (contours, 2, 2): of each contour, on both sheets, the regions on both sides
    """

    __slots__ = ()


class Near(namedtuple("Near", "vertex_faces edge_edges vertex_face_stencils edge_edge_stencils vertex_bound")):
    """What is within a distance.

    vertex_faces, edge_edges                  uint32 arrays of shape (n, 2), sorted: a vertex and a
                                              triangle; two edges as in pairs "edge"
    vertex_face_stencils, edge_edge_stencils  closest points, an entry for each; None if not wanted
    vertex_bound                              a float64 for each vertex, at most its distance from what
                                              is near; None if not wanted
    """

    __slots__ = ()

    def __repr__(self):
        return (f"<starcontour.Near: {len(self.vertex_faces)} vertex-face and {len(self.edge_edges)} "
                "edge-edge pairs>")


class Error(Exception):
    """What the library refused: which argument it is and why, as far as the library says that, and its
    number in `status` (SC_ERROR_... in the header)."""

    def __init__(self, status, text=None):
        super().__init__(text or lib.sc_status_string(status).decode())
        self.status = status

    def __reduce__(self):
        return Error, (self.status, str(self))


class Incomplete(Error):
    """A query that was ended early. `found`: what it would have returned, as far as it is known.

    Of many pairs those that fitted are there: at least as many as the largest answer before had.
    """

    def __init__(self, found):
        super().__init__(_binding.SC_ERROR_INCOMPLETE)
        self.found = found

    def __reduce__(self):
        return Incomplete, (self.found,)


def _check(status):
    if status:
        raise Error(status)


class _Log:
    """Listens to what the library logs about an argument that it refuses. One call at a time."""

    def __init__(self):
        reasons = []

        def log(user, level, message):
            if level == _binding.SC_LOG_ERROR:
                reasons.append(message.decode())

        self._reasons = reasons
        self.hooks = _binding.sc_hooks(
            struct_size=ctypes.sizeof(_binding.sc_hooks), log=_binding.sc_hooks_log(log))

    def check(self, status):
        """Raises an Error if status is one. Members of options are named as the keywords here are."""
        reasons = self.take()
        if status:
            raise Error(status, "; ".join(reasons))

    def take(self):
        """What was logged since the last time."""
        reasons = [re.sub(r"^(options|object)\.(\w*filter\.)?", "", reason) for reason in self._reasons]
        self._reasons.clear()
        return reasons


def _keywords_of(source):
    """Decorates public methods that hand **options on to the function source: the keywords of that
    are theirs, in help() and in what is said about a keyword that does not exist."""
    keywords = [parameter for parameter in inspect.signature(source).parameters.values()
                if parameter.kind == parameter.KEYWORD_ONLY]

    def decorate(method):
        signature = inspect.signature(method)
        own = list(signature.parameters.values())[:-1]
        known = {parameter.name for parameter in own + keywords}

        @functools.wraps(method)
        def checked(*arguments, **options):
            for name in options:
                if name not in known:
                    near = difflib.get_close_matches(name, known, 1)
                    raise TypeError(
                        f"{type(arguments[0]).__name__}.{method.__name__}() got an unexpected keyword argument {name!r}"
                        + (f"; did you mean {near[0]!r}?" if near else ""))
            return method(*arguments, **options)

        checked.__signature__ = signature.replace(parameters=own + keywords)
        return checked

    return decorate


def _choice(name, value, choices):
    if value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(choices)}, not {value!r}")
    return choices[value]


def _whole(name, value, bits):
    """A whole number that an unsigned integer of so many bits holds; ctypes would wrap others round."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not 0 <= number < 1 << bits:
        raise ValueError(f"{name} must be from 0 to 2**{bits} - 1, not {number}")
    return number


def _length(name, value):
    try:
        return ctypes.c_double(value).value
    except TypeError:
        raise TypeError(f"{name} must be a number, not {value!r}") from None


def _cancel(cancel):
    """The address of what another thread sets to end a query."""
    if cancel is None:
        return None
    if not isinstance(cancel, np.ndarray) or cancel.dtype != np.uint32 or cancel.shape != (1,):
        raise ValueError("cancel must be a uint32 array of shape (1,)")
    return cancel.ctypes.data


def _rows(array):
    """Whether the library can step over the rows of this array of shape (n, 3) as it lies in memory."""
    step, inner = array.strides
    return (
        inner == array.itemsize
        and 3 * array.itemsize <= step <= 0xFFFFFFFF
        and array.dtype.isnative
    )


def _shaped(array, what):
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{what} must have the shape (n, 3), not {array.shape}")
    if len(array) > 0xFFFFFFFF:
        raise ValueError(f"{what}: more rows than 32 bits can number")
    return array


def _positions(positions):
    """The same positions as an array that the library can read in place: itself if possible."""
    if not isinstance(positions, np.ndarray):
        positions = np.asarray(positions, np.float64)
    array = _shaped(positions, "positions")
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind == "f" and size <= 8:
        wanted = np.float64 if size == 8 else np.float32
    elif kind in "iub" and size <= 4:
        wanted = np.float64
    else:
        raise TypeError(f"positions of type {array.dtype} have no exact float32 or float64 values")
    if array.dtype == wanted and _rows(array):
        return array
    return np.ascontiguousarray(array, wanted)


def _position_type(positions):
    return _binding.SC_DOUBLE if positions.dtype == np.float64 else _binding.SC_FLOAT


def _indices(values):
    """The same whole numbers as an array of uint32 or uint16, itself if possible."""
    array = np.asarray(values)
    if array.dtype.kind not in "iu":
        raise TypeError(f"triangles and vertices are numbered by integers, not {array.dtype}")
    if array.dtype in (np.uint32, np.uint16):
        return array
    for number in (array.min(), array.max()) if array.size else ():
        if not 0 <= number <= 0xFFFFFFFF:
            raise Error(_binding.SC_ERROR_INDEX, f"no triangle or vertex has the number {number}")
    return array.astype(np.uint32)


def _triangles(triangles):
    array = _shaped(_indices(triangles), "triangles")
    return array if _rows(array) else np.ascontiguousarray(array, array.dtype.newbyteorder("="))


def _numbers(values, length, what):
    """A packed array of uint32, as weld maps and orders are."""
    array = np.ascontiguousarray(_indices(values), np.uint32)
    if array.shape != (length,):
        raise ValueError(f"{what} must have the shape ({length},), not {array.shape}")
    return array


def _table(values, rows, what):
    """A packed array of uint32 of shape (rows, 2), rows None: any number; and its address."""
    array = np.ascontiguousarray(_indices(values), np.uint32)
    if array.ndim != 2 or array.shape[1] != 2 or rows not in (None, len(array)):
        raise ValueError(f"{what} must have the shape ({'k' if rows is None else rows}, 2)")
    return array, array.ctypes.data


def _traced(nodes, contours):
    """An sc_trace_result of contours that were found, and the arrays that it refers to."""
    nodes = np.ascontiguousarray(nodes, _binding.sc_trace_node)
    contours = np.ascontiguousarray(contours, _binding.sc_trace_contour)
    structure = _binding.sc_trace_result(
        struct_size=ctypes.sizeof(_binding.sc_trace_result),
        node_count=len(nodes),
        node_capacity=len(nodes),
        nodes=nodes.ctypes.data,
        contour_count=len(contours),
        contour_capacity=len(contours),
        contours=contours.ctypes.data,
    )
    return structure, (nodes, contours)


def _pose(pose):
    """An sc_pose, and the array that it refers to."""
    positions = _positions(pose)
    structure = _binding.sc_pose(
        struct_size=ctypes.sizeof(_binding.sc_pose),
        vertex_count=len(positions),
        position_type=_position_type(positions),
        position_stride=positions.strides[0],
        positions=positions.ctypes.data,
    )
    return structure, positions


def _step_list(count):
    """Arrays for pairs of a step and their times."""
    return np.empty((count, 2), np.uint32), np.empty(count, np.float64)


class _Owned(ctypes.c_void_p):
    """What the library made, freed when nothing refers to it any more."""

    def __init__(self, handle, free):
        super().__init__(handle.value)
        weakref.finalize(self, free, ctypes.c_void_p(handle.value))


def _check_threads(threads):
    if not 1 <= _whole("threads", threads, 32) <= _binding.SC_WORKERS_MAX:
        raise ValueError(f"threads must be from 1 to {_binding.SC_WORKERS_MAX}, not {threads}")


class _Scratch:
    """A workspace of the library, made when it is needed, arrays for its pairs and times, and who may
    use them now."""

    def __init__(self):
        self.log = _Log()
        self.handle, self.flags, self.workers, self.tasks = None, 0, 0, None
        self.room = None  # the workspace whose room this one uses
        self.pairs = np.empty((64, 2), np.uint32)
        self.lists = [_step_list(64), _step_list(64)]
        self.lock = threading.Lock()
        self.closed = False

    def fit(self, model, flags, threads, lender=None):
        """Makes the workspace fit for a query of that kind by so many threads; with the room of
        lender, another _Scratch of the model that fits already. By the one who has the lock."""
        if self.closed:
            raise ValueError("the workspace is closed")
        room = lender.handle if lender else None
        if flags & ~self.flags or threads > self.workers or room is not self.room:
            flags, workers = flags | self.flags, max(threads, self.workers)
            if lender:
                flags, workers = lender.flags & ~_binding.SC_WORKSPACE_ROOM, lender.workers
            options = _binding.sc_workspace_options(
                struct_size=ctypes.sizeof(_binding.sc_workspace_options), flags=flags, workers=workers,
                room=room.value if room else None)
            handle = ctypes.c_void_p()
            _check(lib.sc_workspace_create_for(model, ctypes.byref(options), ctypes.byref(handle)))
            self.handle = _Owned(handle, lib.sc_workspace_free)
            self.flags, self.workers, self.room = flags, workers, room
            _check(lib.sc_workspace_set_hooks(self.handle, ctypes.byref(self.log.hooks)))

    def prepare(self, model, flags, threads):
        """The same, and returns the address of sc_tasks for them."""
        _check_threads(threads)
        self.fit(model, flags, threads)
        return self.tasks_for(threads)

    def tasks_for(self, threads):
        """The address of sc_tasks for so many threads."""
        if threads == 1:
            return None
        if not self.tasks or self.tasks.structure.workers != threads:
            self.tasks = _threads.Tasks(threads)
        return ctypes.addressof(self.tasks.structure)

    def call(self, function, options, *arguments):
        """Calls a query with these options."""
        return self.tasks.call(function, *arguments) if options.tasks else function(*arguments)

    def close(self):
        if not self.lock.acquire(blocking=False):
            raise Error(_binding.SC_ERROR_WORKSPACE, _IN_USE)
        self.handle, self.closed = None, True
        self.lock.release()


def _query(model, scratch, pose, **options):
    def pairs(result):
        return scratch.pairs[: result.count].copy()

    return _ask(model, scratch, pose, _binding.SC_OUTPUT_PAIRS, pairs, **options)


def _count(model, scratch, pose, **options):
    return _ask(model, scratch, pose, _binding.SC_OUTPUT_COUNT, lambda result: result.count, **options)


def _collides(model, scratch, pose, **options):
    return _ask(model, scratch, pose, _binding.SC_OUTPUT_ANY, lambda result: bool(result.collides), **options)


def _filter(model, ignore_rings, ignore, vertex_groups, triangle_groups):
    """An sc_filter, and the arrays that it refers to."""
    structure = _binding.sc_filter(
        struct_size=ctypes.sizeof(_binding.sc_filter),
        ignore_rings=_whole("ignore_rings", ignore_rings, 32))
    arrays = []
    if ignore is not None:
        array, structure.ignore = _table(ignore, None, "ignore")
        structure.ignore_count = len(array)
        arrays.append(array)
    if vertex_groups is not None:
        array, structure.vertex_groups = _table(
            vertex_groups, model.info.vertex_count, "vertex_groups")
        arrays.append(array)
    if triangle_groups is not None:
        array, structure.triangle_groups = _table(
            triangle_groups, model.info.triangle_count, "triangle_groups")
        arrays.append(array)
    return structure, arrays


def _feature_filters(model, ignore_rings, ignore, vertex_groups, triangle_groups):
    """An sc_filter for each of the two kinds of pairs, and the arrays that they refer to."""
    ignored = (None, None) if ignore is None else tuple(ignore)[:2]
    if len(ignored) != 2:
        raise ValueError("ignore must be a Step, a Near or two arrays")
    both = [_filter(model, ignore_rings, pairs, vertex_groups, triangle_groups) for pairs in ignored]
    return [structure for structure, _ in both], [arrays for _, arrays in both]


def _ask(model, scratch, pose, output, answer, *, pairs="triangle", contact="touching",
         method="default", rest_cache=True, ignore_rings=0, ignore=None, vertex_groups=None,
         triangle_groups=None, cancel=None, budget=0, threads=1):
    given, positions = _pose(pose)
    filter, arrays = _filter(model, ignore_rings, ignore, vertex_groups, triangle_groups)
    options = _binding.sc_query_options(
        struct_size=ctypes.sizeof(_binding.sc_query_options),
        output=output,
        pairs=_choice("pairs", pairs, _PAIRS),
        contact=_choice("contact", contact, _CONTACT),
        method=_choice("method", method, _METHOD),
        rest_cache=_binding.SC_REST_CACHE_ON if rest_cache else _binding.SC_REST_CACHE_OFF,
        filter=ctypes.addressof(filter),
        cancel=_cancel(cancel),
        budget=_whole("budget", budget, 64),
    )
    result = _binding.sc_result(struct_size=ctypes.sizeof(_binding.sc_result))
    if not scratch.lock.acquire(blocking=False):
        raise Error(_binding.SC_ERROR_WORKSPACE, _IN_USE)
    try:
        handle = model._handle
        options.tasks = scratch.prepare(handle, 0, threads)
        while True:
            result.capacity, result.pairs = len(scratch.pairs), scratch.pairs.ctypes.data
            status = scratch.call(lib.sc_query, options, handle, scratch.handle, ctypes.byref(given),
                                  ctypes.byref(options), ctypes.byref(result))
            if status == _binding.SC_ERROR_INCOMPLETE:
                raise Incomplete(answer(result))
            if status != _binding.SC_ERROR_SHORT_BUFFER:
                break
            scratch.pairs = np.empty((result.count + result.count // 4, 2), np.uint32)
        scratch.log.check(status)
        return answer(result)
    finally:
        scratch.lock.release()


def _step(model, scratch, start, end, *, candidates=False, **options):
    def found(result):
        counts = result.vertex_face_count, result.edge_edge_count
        pairs = [array[:count].copy() for (array, _), count in zip(scratch.lists, counts)]
        times = [None if candidates else array[:count].copy()
                 for (_, array), count in zip(scratch.lists, counts)]
        return Step(*pairs, *times, result.earliest)

    return _ask_step(model, scratch, start, end, _binding.SC_OUTPUT_PAIRS, found,
                     candidates=candidates, **options)


def _step_collides(model, scratch, start, end, **options):
    return _ask_step(model, scratch, start, end, _binding.SC_OUTPUT_ANY,
                     lambda result: bool(result.collides), **options)


def _ask_step(model, scratch, start, end, output, answer, *, separation=0.0, tolerance=0.0,
              method="default", candidates=False, only_nearer=False, ignore_rings=0, ignore=None,
              vertex_groups=None, triangle_groups=None, rest=None, rest_distance=0.0, cancel=None,
              budget=0, threads=1):
    (given, positions), (goal, positions_then) = _pose(start), _pose(end)
    filters, kept = _feature_filters(model, ignore_rings, ignore, vertex_groups, triangle_groups)
    pose_at_rest, positions_at_rest = (None, None) if rest is None else _pose(rest)
    timed = output == _binding.SC_OUTPUT_PAIRS and not candidates
    options = _binding.sc_step_options(
        struct_size=ctypes.sizeof(_binding.sc_step_options),
        output=output,
        pairs=_binding.SC_STEP_CANDIDATES if candidates else _binding.SC_STEP_COLLISIONS,
        times=_binding.SC_STEP_TIMES_EACH if timed else _binding.SC_STEP_TIMES_NONE,
        method=_choice("method", method, _STEP_METHOD),
        separation=_length("separation", separation),
        tolerance=_length("tolerance", tolerance),
        cancel=_cancel(cancel),
        budget=_whole("budget", budget, 64),
        vertex_face_filter=ctypes.addressof(filters[0]),
        edge_edge_filter=ctypes.addressof(filters[1]),
        rest=None if rest is None else ctypes.addressof(pose_at_rest),
        rest_distance=_length("rest_distance", rest_distance),
        begun=_binding.SC_STEP_BEGUN_NEARER if only_nearer else _binding.SC_STEP_BEGUN_ALL,
    )
    result = _binding.sc_step_result(struct_size=ctypes.sizeof(_binding.sc_step_result))
    if not scratch.lock.acquire(blocking=False):
        raise Error(_binding.SC_ERROR_WORKSPACE, _IN_USE)
    try:
        handle = model._handle
        options.tasks = scratch.prepare(handle, _binding.SC_WORKSPACE_STEP, threads)
        while True:
            (faces, face_times), (edges, edge_times) = scratch.lists
            result.vertex_face_capacity, result.vertex_faces = len(faces), faces.ctypes.data
            result.edge_edge_capacity, result.edge_edges = len(edges), edges.ctypes.data
            if timed:
                result.vertex_face_times = face_times.ctypes.data
                result.edge_edge_times = edge_times.ctypes.data
            status = scratch.call(lib.sc_query_step, options, handle, scratch.handle,
                                  ctypes.byref(given), ctypes.byref(goal), ctypes.byref(options),
                                  ctypes.byref(result))
            if status == _binding.SC_ERROR_INCOMPLETE:
                raise Incomplete(answer(result))
            if status != _binding.SC_ERROR_SHORT_BUFFER:
                break
            scratch.lists = [_step_list(count + count // 4) for count in
                             (result.vertex_face_count, result.edge_edge_count)]
        scratch.log.check(status)
        return answer(result)
    finally:
        scratch.lock.release()


def _near(model, scratch, pose, distance, *, stencils=False, vertex_bound=False, **options):
    bounds = np.empty(model.info.vertex_count) if vertex_bound else None

    def found(result):
        counts = result.vertex_face_count, result.edge_edge_count
        pairs = [array[:count].copy() for (array, _), count in zip(scratch.lists, counts)]
        closest = [_stencils(model, pose, array, kind) if stencils else None
                   for array, kind in zip(pairs, ("vertex_face", "edge_edge"))]
        return Near(*pairs, *closest, bounds)

    return _ask_near(model, scratch, pose, distance, _binding.SC_OUTPUT_PAIRS, found, bounds, **options)


def _near_counts(model, scratch, pose, distance, **options):
    return _ask_near(model, scratch, pose, distance, _binding.SC_OUTPUT_COUNT,
                     lambda result: (result.vertex_face_count, result.edge_edge_count), **options)


def _is_near(model, scratch, pose, distance, **options):
    return _ask_near(model, scratch, pose, distance, _binding.SC_OUTPUT_ANY,
                     lambda result: bool(result.found), **options)


def _ask_near(model, scratch, pose, distance, output, answer, bounds=None, *, kinds="both", method="default",
              ignore_rings=0, ignore=None, vertex_groups=None, triangle_groups=None, rest=None,
              rest_distance=0.0, cancel=None, budget=0, threads=1):
    given, positions = _pose(pose)
    masks = model._near_masks(ignore_rings)
    filters, kept = _feature_filters(model, 0 if masks else ignore_rings, ignore, vertex_groups,
                                     triangle_groups)
    pose_at_rest, positions_at_rest = (None, None) if rest is None else _pose(rest)
    options = _binding.sc_near_options(
        struct_size=ctypes.sizeof(_binding.sc_near_options),
        output=output,
        kinds=_choice("kinds", kinds, _NEAR_KINDS),
        method=_choice("method", method, _NEAR_METHOD),
        distance=_length("distance", distance),
        vertex_face_filter=ctypes.addressof(filters[0]),
        edge_edge_filter=ctypes.addressof(filters[1]),
        rest=None if rest is None else ctypes.addressof(pose_at_rest),
        rest_distance=_length("rest_distance", rest_distance),
        cancel=_cancel(cancel),
        budget=_whole("budget", budget, 64),
        masks=masks,
    )
    result = _binding.sc_near_result(
        struct_size=ctypes.sizeof(_binding.sc_near_result),
        vertex_bounds=None if bounds is None else bounds.ctypes.data)
    if not scratch.lock.acquire(blocking=False):
        raise Error(_binding.SC_ERROR_WORKSPACE, _IN_USE)
    try:
        handle = model._handle
        options.tasks = scratch.prepare(handle, _binding.SC_WORKSPACE_NEAR, threads)
        while True:
            (faces, _), (edges, _) = scratch.lists
            result.vertex_face_capacity, result.vertex_faces = len(faces), faces.ctypes.data
            result.edge_edge_capacity, result.edge_edges = len(edges), edges.ctypes.data
            status = scratch.call(lib.sc_query_near, options, handle, scratch.handle,
                                  ctypes.byref(given), ctypes.byref(options), ctypes.byref(result))
            if status == _binding.SC_ERROR_INCOMPLETE:
                raise Incomplete(answer(result))
            if status != _binding.SC_ERROR_SHORT_BUFFER:
                break
            scratch.lists = [_step_list(count + count // 4) for count in
                             (result.vertex_face_count, result.edge_edge_count)]
        scratch.log.check(status)
        return answer(result)
    finally:
        scratch.lock.release()


def _stencils(model, pose, found, kind):
    found, address = _table(found, None, "found")
    stencils = np.zeros(len(found), _binding.sc_near_stencil)
    given, positions = _pose(pose)
    kind = _choice("kind", kind, {name: _NEAR_KINDS[name] for name in ("vertex_face", "edge_edge")})
    _check(lib.sc_near_stencils(model._handle, ctypes.byref(given), kind, address, len(found),
                                stencils.ctypes.data))
    return stencils


def _step_stencils(model, start, end, found, times, kind):
    found, address = _table(found, None, "found")
    stencils = np.zeros(len(found), _binding.sc_step_stencil)
    if times is not None:
        times = np.ascontiguousarray(times, np.float64)
        if times.shape != (len(found),):
            raise ValueError(f"times must have the shape ({len(found)},), not {times.shape}")
    (given, positions), (goal, positions_then) = _pose(start), _pose(end)
    kind = _choice("kind", kind, {name: _NEAR_KINDS[name] for name in ("vertex_face", "edge_edge")})
    _check(lib.sc_step_stencils(model._handle, ctypes.byref(given), ctypes.byref(goal), kind, address,
                                None if times is None else times.ctypes.data, len(found),
                                stencils.ctypes.data))
    return stencils


def merge_stencils(*stencils):
    """One stencil for each two vertices, and each vertex and edge, of arrays of stencils; and how many
    each stands for: two arrays. See sc_near_merge."""
    for array in stencils:
        if not isinstance(array, np.ndarray) or array.dtype != np.dtype(_binding.sc_near_stencil) \
                or array.ndim != 1:
            raise TypeError("stencils must be arrays as Model.stencils returns them")
    merged = np.concatenate(stencils) if stencils else np.empty(0, _binding.sc_near_stencil)
    multiplicities, count = np.empty(len(merged), np.uint32), ctypes.c_uint64()
    _check(lib.sc_near_merge(merged.ctypes.data, len(merged), ctypes.byref(count),
                             multiplicities.ctypes.data))
    return merged[: count.value].copy(), multiplicities[: count.value].copy()


def edge_vertices(triangles, edges):
    """The two vertices of each edge: of edges 3 t + k, an array of any shape, those from corner k to
    corner (k + 1) % 3 of triangle t. The result has one axis more, of length 2."""
    triangles, edges = _triangles(triangles), _indices(edges).astype(np.int64)
    return np.stack([triangles[edges // 3, edges % 3], triangles[edges // 3, (edges + 1) % 3]], -1)


class _Queries:
    """The queries of a Model, which uses a workspace of each thread's own, and of a Workspace."""

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    @_keywords_of(_ask)
    def query(self, pose, **options):
        """All pairs in a pose, sorted: a new uint32 array of shape (n, 2). Options: see the module."""
        return _query(*self._asked(), pose, **options)

    @_keywords_of(_ask)
    def count(self, pose, **options):
        """The number of pairs in a pose."""
        return _count(*self._asked(), pose, **options)

    @_keywords_of(_ask)
    def collides(self, pose, **options):
        """Whether there is any pair in a pose. Stops at the first."""
        return _collides(*self._asked(), pose, **options)

    @_keywords_of(_ask_step)
    def step(self, start, end, **options):
        """What collides while each vertex moves on a straight line from one pose to another: a Step.

        Options: see the module. vertex_faces: a vertex and a triangle that it is no corner of;
        edge_edges: two edges without a common vertex.
        """
        return _step(*self._asked(), start, end, **options)

    @_keywords_of(_ask_step)
    def step_collides(self, start, end, **options):
        """Whether anything collides in a step. Stops at the first pair."""
        return _step_collides(*self._asked(), start, end, **options)

    @_keywords_of(_ask_near)
    def near(self, pose, distance, *, stencils=False, vertex_bound=False, **options):
        """What is within a distance in a pose, in units of the coordinates: a Near. Compared exactly.

        Options: see the module. vertex_faces: a vertex and a triangle that it is no corner of;
        edge_edges: two edges without a common vertex.
        """
        return _near(*self._asked(), pose, distance, stencils=stencils, vertex_bound=vertex_bound,
                     **options)

    @_keywords_of(_ask_near)
    def near_counts(self, pose, distance, **options):
        """The numbers of vertex-face and of edge-edge pairs within a distance."""
        return _near_counts(*self._asked(), pose, distance, **options)

    @_keywords_of(_ask_near)
    def is_near(self, pose, distance, **options):
        """Whether any pair is within a distance. Stops at the first."""
        return _is_near(*self._asked(), pose, distance, **options)


class Workspace(_Queries):
    """What one query writes to. Made by Model.workspace(); its queries are those of Model."""

    def __init__(self, model):
        self.model = model
        self._scratch = _Scratch()

    def __repr__(self):
        return f"<starcontour.Workspace of {self.model!r}>"

    def close(self):
        """Gives back its memory; another query raises a ValueError."""
        self._scratch.close()

    def _asked(self):
        return self.model, self._scratch


class Model(_Queries):
    """A triangle mesh in its rest pose, made ready for queries.

    vertices   rest positions, shape (n, 3)
    triangles  vertex numbers, shape (m, 3)
    weld       "rest": vertices at equal rest positions are one (default); "none"; or an array of n
               representatives
    order      None: the library's partition; or a permutation of the triangles, consecutive ones of
               which form patches
    boxes      True: for few poses; what only culling needs is left out, which makes this four times
               faster and a query slower. Methods are "aabb" then, of steps "two_boxes" and "swept"
    threads    how many threads may build, 1 (default) to 256: the model is the same
    """

    def __init__(self, vertices, triangles, *, weld="rest", order=None, boxes=False, threads=1):
        _check_threads(threads)
        vertices, triangles = _positions(vertices), _triangles(triangles)
        mesh = _binding.sc_mesh(
            struct_size=ctypes.sizeof(_binding.sc_mesh),
            vertex_count=len(vertices),
            triangle_count=len(triangles),
            position_type=_position_type(vertices),
            position_stride=vertices.strides[0],
            index_type=_binding.SC_UINT16 if triangles.dtype == np.uint16 else _binding.SC_UINT32,
            index_stride=triangles.strides[0],
            positions=vertices.ctypes.data,
            indices=triangles.ctypes.data,
        )
        options = _binding.sc_build_options(struct_size=ctypes.sizeof(_binding.sc_build_options))
        if isinstance(weld, str):
            options.weld = _choice("weld", weld, _WELD)
        else:
            weld = _numbers(weld, len(vertices), "weld")
            options.weld, options.weld_map = _binding.SC_WELD_MAP, weld.ctypes.data
        if order is not None:
            order = _numbers(order, len(triangles), "order")
            options.partition, options.order = _binding.SC_PARTITION_ORDER, order.ctypes.data
        options.content = _binding.SC_MODEL_BOXES if boxes else _binding.SC_MODEL_FULL
        log, handle = _Log(), ctypes.c_void_p()
        options.hooks = ctypes.addressof(log.hooks)
        built = ctypes.byref(mesh), ctypes.byref(options), ctypes.byref(handle)
        if threads == 1:
            status = lib.sc_build(*built)
        else:
            tasks = _threads.Tasks(threads)
            options.tasks = ctypes.addressof(tasks.structure)
            status = tasks.call(lib.sc_build, *built)
        log.check(status)
        self._adopt(handle)

    def _adopt(self, handle):
        self._owned = _Owned(handle, lib.sc_model_free)
        self._local = threading.local()
        self._masks, self._masks_lock = {}, threading.Lock()

    @property
    def _handle(self):
        if self._owned is None:
            raise ValueError("the model is closed")
        return self._owned

    def __repr__(self):
        if self._owned is None:
            return "<starcontour.Model, closed>"
        info = self.info
        return f"<starcontour.Model of {info.triangle_count} triangles and {info.vertex_count} vertices>"

    def close(self):
        """Gives back its memory, once queries of other threads that are under way have ended; another
        query raises a ValueError."""
        self._owned, self._masks = None, {}
        self._local = threading.local()

    @classmethod
    def frombytes(cls, data, *, topology_hash=0, in_place=False):
        """The model that tobytes made `data` of: any bytes-like object. Other data raise an Error.

        topology_hash   0, or refuse a model with any other info.topology_hash
        in_place        keep the data and use them where they are, aligned to 64 bytes; they must not
                        change as long as the model lives
        """
        data = np.frombuffer(data, np.uint8)
        log, handle = _Log(), ctypes.c_void_p()
        options = _binding.sc_load_options(
            struct_size=ctypes.sizeof(_binding.sc_load_options),
            mode=_binding.SC_LOAD_IN_PLACE if in_place else _binding.SC_LOAD_COPY,
            topology_hash=_whole("topology_hash", topology_hash, 64),
            hooks=ctypes.addressof(log.hooks),
        )
        log.check(lib.sc_model_load(data.ctypes.data, data.nbytes, ctypes.byref(options),
                                    ctypes.byref(handle)))
        model = cls.__new__(cls)
        model._adopt(handle)
        model._data = data if in_place else None
        return model

    @classmethod
    def load(cls, path, *, topology_hash=0, in_place=False):
        """The model that save wrote to a file. in_place maps the file, which processes then share."""
        data = np.memmap(path, np.uint8, "r") if in_place else np.fromfile(path, np.uint8)
        return cls.frombytes(data, topology_hash=topology_hash, in_place=in_place)

    def tobytes(self):
        """The model as bytes, for frombytes of the same minor version of the library."""
        size = ctypes.c_uint64()
        _check(lib.sc_model_save_size(self._handle, ctypes.byref(size)))
        data = np.empty(size.value, np.uint8)
        _check(lib.sc_model_save(self._handle, data.ctypes.data, data.nbytes, None))
        return data.tobytes()

    def save(self, path):
        """Writes the model to a file, for load and for `sc-query --model`."""
        with open(path, "wb") as file:
            file.write(self.tobytes())

    def __reduce__(self):
        return Model.frombytes, (self.tobytes(),)

    @property
    def info(self):
        """A ModelInfo: counts, topology hash, and sizes in bytes; see sc_model_info."""
        info = _binding.sc_model_info(struct_size=ctypes.sizeof(_binding.sc_model_info))
        _check(lib.sc_model_get_info(self._handle, ctypes.byref(info)))
        return ModelInfo(*(getattr(info, name) for name in ModelInfo._fields))

    def patches(self, level):
        """The number of each triangle's patch at a level from 0 to info.level_count - 1."""
        patches = np.empty(self.info.triangle_count, np.uint32)
        level = _whole("level", level, 32)
        _check(lib.sc_model_get_patches(self._handle, level, patches.ctypes.data, len(patches)))
        return patches

    def contacts(self, pose, found, *, pairs="triangle"):
        """Where pairs that a query found meet: a structured array, an entry for each.

        Fields: kind (0 nothing, 1 a point, 2 a segment, 3 an area), points (two, three coordinates
        each), and weights_a and weights_b, their barycentric coordinates. See sc_contact.
        """
        found, address = _table(found, None, "found")
        contacts = np.zeros(len(found), _binding.sc_contact)
        given, positions = _pose(pose)
        _check(lib.sc_contacts(self._handle, ctypes.byref(given), _choice("pairs", pairs, _PAIRS),
                               address, len(found), contacts.ctypes.data))
        return contacts

    def trace(self, pose, found=None, *, threads=1):
        """Contours of intersections in a pose: a Trace. See sc_trace.

        found: the edge pairs of the pose, all of them, as query(pose, pairs="edge") finds them; None:
        they are found. threads: how many may work; the answer is the same.
        """
        _check_threads(threads)
        if found is None:
            found = self.query(pose, pairs="edge", threads=threads)
        found, address = _table(found, None, "found")
        given, positions = _pose(pose)
        options = _binding.sc_trace_options(struct_size=ctypes.sizeof(_binding.sc_trace_options))
        log = _Log()
        options.hooks = ctypes.addressof(log.hooks)
        call = lib.sc_trace
        if threads > 1:
            tasks = _threads.Tasks(threads)
            options.tasks = ctypes.addressof(tasks.structure)
            call = functools.partial(tasks.call, lib.sc_trace)
        result = _binding.sc_trace_result(struct_size=ctypes.sizeof(_binding.sc_trace_result))
        while True:
            nodes = np.zeros(result.node_count, _binding.sc_trace_node)
            contours = np.zeros(result.contour_count, _binding.sc_trace_contour)
            result.nodes, result.node_capacity = nodes.ctypes.data, len(nodes)
            result.contours, result.contour_capacity = contours.ctypes.data, len(contours)
            status = call(self._handle, ctypes.byref(given), address, len(found), ctypes.byref(options),
                          ctypes.byref(result))
            if status != _binding.SC_ERROR_SHORT_BUFFER:
                log.check(status)
                return Trace(nodes, contours)

    def trace_triples(self, pose, traced=None):
        """Points where three sheets meet, in which contours cross: a structured array. See
        sc_trace_triples.

        Fields: triangles (three, ascending), point (three coordinates), nodes (three: behind nodes[i]
        of the trace is what the two triangles other than triangles[i] have in common) and along
        (three: so far on it, from 0 to 1). traced: what trace(pose) gave; None: it is found.
        """
        nodes, contours = self.trace(pose) if traced is None else traced
        trace, arrays = _traced(nodes, contours)
        given, positions = _pose(pose)
        options = _binding.sc_trace_options(struct_size=ctypes.sizeof(_binding.sc_trace_options))
        log = _Log()
        options.hooks = ctypes.addressof(log.hooks)
        result = _binding.sc_triples_result(struct_size=ctypes.sizeof(_binding.sc_triples_result))
        while True:
            triples = np.zeros(result.count, _binding.sc_trace_triple)
            result.triples, result.capacity = triples.ctypes.data, len(triples)
            status = lib.sc_trace_triples(self._handle, ctypes.byref(given), ctypes.byref(trace),
                                          ctypes.byref(options), ctypes.byref(result))
            if status != _binding.SC_ERROR_SHORT_BUFFER:
                log.check(status)
                return triples

    def regions(self, pose, traced=None, *, inside=False):
        """The regions into which contours divide the surface in a pose: Regions. See sc_trace_regions.

        traced: what trace(pose) gave; None: it is found. inside: whether to find how often closed
        components go round each region (-2147483648 where that is not known).
        """
        nodes, contours = self.trace(pose) if traced is None else traced
        trace, arrays = _traced(nodes, contours)
        given, positions = _pose(pose)
        options = _binding.sc_trace_options(struct_size=ctypes.sizeof(_binding.sc_trace_options))
        log = _Log()
        options.hooks = ctypes.addressof(log.hooks)
        vertex_regions = np.empty(given.vertex_count, np.uint32)
        sides = np.empty((len(contours), 2, 2), np.uint32)
        result = _binding.sc_regions_result(
            struct_size=ctypes.sizeof(_binding.sc_regions_result),
            vertex_regions=vertex_regions.ctypes.data,
            sides=sides.ctypes.data,
        )
        while True:
            regions = np.zeros(result.region_count, _binding.sc_region)
            result.regions, result.region_capacity = regions.ctypes.data, len(regions)
            result.flags = _binding.SC_REGIONS_INSIDE if inside and len(regions) else 0
            status = lib.sc_trace_regions(self._handle, ctypes.byref(given), ctypes.byref(trace),
                                          ctypes.byref(options), ctypes.byref(result))
            if status != _binding.SC_ERROR_SHORT_BUFFER:
                log.check(status)
                return Regions(regions, vertex_regions, sides)

    def trace_gradients(self, pose, traced):
        """How lengths of contours change as vertices move: a structured array, an entry for each node
        of `traced`, the Trace of this pose.

        Fields: vertices (five: the ends of an edge and the corners of a triangle), weights (five),
        vectors (two, three coordinates each), of which the first, times its weight, is the derivative
        by the position of each end, and the second by that of each corner; flags (1: the edge is
        parallel to the triangle, and vectors are 0; 2: a segment has no length). See
        sc_trace_gradient.
        """
        if not isinstance(traced, Trace):
            raise TypeError("traced must be a Trace as Model.trace returns it")
        result, arrays = _traced(*traced)
        gradients = np.zeros(len(traced.nodes), _binding.sc_trace_gradient)
        given, positions = _pose(pose)
        _check(lib.sc_trace_gradients(self._handle, ctypes.byref(given), ctypes.byref(result),
                                      gradients.ctypes.data))
        return gradients

    def trace_length(self, pose, found=None, *, threads=1):
        """The length of all contours in a pose, 0 where nothing intersects, and its gradient: how it
        changes as each vertex moves, a float64 array of shape (n, 3). found and threads as in trace.

        Of vertices that were welded to one, this one has the gradient of all. Nodes at edges that are
        parallel to triangles add nothing; see sc_trace_gradients for what else has no derivative.
        """
        traced = self.trace(pose, found, threads=threads)
        stencils = self.trace_gradients(pose, traced)
        gradient = np.zeros((len(pose), 3))
        vectors = np.repeat(stencils["vectors"], [2, 3], axis=1)  # one for each of the five
        np.add.at(gradient, stencils["vertices"], stencils["weights"][:, :, None] * vectors)
        return float(traced.contours["length"].sum()), gradient

    def workspace(self):
        """A new Workspace, for queries that run at the same time as others in this thread's name."""
        return Workspace(self)

    def stencils(self, pose, found, *, kind):
        """The closest points of pairs, near or not: a structured array, an entry for each.

        kind is "vertex_face" or "edge_edge". Fields: feature (1 two vertices, 2 a vertex and an edge,
        3 two edges, 4 a vertex and a face), vertices and their weights, by which the sum of positions
        is vector, from a to b, and distance. See sc_near_stencil.
        """
        return _stencils(self, pose, found, kind)

    def step_stencils(self, start, end, found, times=None, *, kind):
        """The closest points of pairs of a step, at its start and at a time of each: a structured
        array, an entry for each.

        Fields: start and impact, each as stencils has them; time; normal, a unit vector from a to b;
        side on which the vertex began; flags (1: the two approach at the start). See sc_step_stencil.
        """
        return _step_stencils(self, start, end, found, times, kind)

    def _near_masks(self, rings):
        """What is within so many rings, made once; None where a filter does as well."""
        if not 1 < _whole("ignore_rings", rings, 32) <= _binding.SC_RINGS_MAX:
            return None
        with self._masks_lock:
            if rings not in self._masks:
                handle = ctypes.c_void_p()
                _check(lib.sc_near_masks_create(self._handle, rings, None, ctypes.byref(handle)))
                self._masks[rings] = _Owned(handle, lib.sc_near_masks_free)
            return self._masks[rings]

    def _asked(self):
        """This thread's workspace."""
        if not hasattr(self._local, "scratch"):
            self._local.scratch = _Scratch()
        return self, self._local.scratch


from .scene import Meeting, Scene, SceneNear, SceneObject, SceneStep  # noqa: E402: needs what is above
