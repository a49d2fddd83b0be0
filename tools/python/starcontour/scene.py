"""Several objects in one query: what they have with each other, and with themselves.

    scene = starcontour.Scene()
    cloth = scene.add(cloth_model)
    body = scene.add(body_model, body_pose, itself=False)      what does not move is read once
    while ...:
        cloth.pose = positions                                 assign again what was changed in place
        for meeting in scene.query():
            meeting.a, meeting.b, meeting.pairs                two objects, an array of shape (n, 2)

SPDX-License-Identifier: MIT
"""

import ctypes
import threading
from collections import Counter, namedtuple

import numpy as np

from . import _binding
from . import (_CONTACT, _IN_USE, _METHOD, _NEAR_KINDS, _NEAR_METHOD, _PAIRS, _STEP_METHOD, Error,
               Incomplete, _cancel, _check_threads, _choice, _filter, _length, _pose, _Scratch, _step_list,
               _whole)
from ._binding import lib

Meeting = namedtuple("Meeting", "a b pairs times")
Meeting.__doc__ = """What two objects have with each other, or one with itself (a is b).

a, b    SceneObjects
pairs   a uint32 array of shape (n, 2), sorted: the first numbers are of a, the second of b
times   of a step, when: a lower bound from 0 to 1 for each; else None
"""

SceneNear = namedtuple("SceneNear", "vertex_faces edge_edges")
SceneNear.__doc__ = """What is within a distance: two lists of Meetings, by the lower number of their objects.

vertex_faces  vertices of a and triangles of b; two objects may meet twice, either being a
edge_edges    edges of a and of b, as in pairs "edge"; a is not behind b
"""

SceneStep = namedtuple("SceneStep", "vertex_faces edge_edges earliest")
SceneStep.__doc__ = """What collides in a step: two lists as in SceneNear, with times.

earliest  nothing collides before this time; 1 if nothing does at all
"""


class SceneObject:
    """An object of a Scene, made by Scene.add: a model in a pose.

    number  its place in the scene
    model   a Model, which objects may share
    pose    positions, shape (n, 3), of a step those at its start. They are read where they are, once
            after each assignment: assign again what was changed in place
    end     of a step: those at its end, or None: it stays where it is
    itself  whether its pairs with itself are wanted
    group   None: it collides with all; or two numbers, a category and a mask, see sc_group
    """

    def __init__(self, scene, number, model, itself, group, ignore_rings, rest, rest_distance):
        self.scene, self.number, self.model = scene, number, model
        self.itself, self.group = bool(itself), group
        self._scratch = _Scratch()
        self._filter, self._kept = _filter(model, ignore_rings, None, None, None)
        self._rest = None if rest is None else _pose(rest)
        self._rest_distance = _length("rest_distance", rest_distance)
        self._version, self._pose, self._end = 0, None, None

    def __repr__(self):
        return f"<starcontour.SceneObject {self.number}: {self.model!r}>"

    @property
    def pose(self):
        return self._pose and self._pose[1]

    @pose.setter
    def pose(self, positions):
        self._pose = _pose(positions)
        self._version += 1

    @property
    def end(self):
        return self._end and self._end[1]

    @end.setter
    def end(self, positions):
        self._end = None if positions is None else _pose(positions)
        self._version += 1

    def _fill(self, structure, flags, threads, lender):
        """Fills an sc_object. lender: None, or the _Scratch whose room its workspace uses."""
        if self._pose is None:
            raise ValueError(f"object {self.number} has no pose")
        self._scratch.fit(self.model._handle, flags, threads, lender)
        structure.model, structure.workspace = self.model._handle.value, self._scratch.handle.value
        structure.pose = ctypes.addressof(self._pose[0])
        structure.pose_version = self._version
        structure.itself = self.itself
        if self.group is not None:
            category, mask = self.group
            structure.group.category = _whole("group", category, 32)
            structure.group.mask = _whole("group", mask, 32)
        if not flags:
            structure.filter = ctypes.addressof(self._filter)
            return
        structure.vertex_face_filter = structure.edge_edge_filter = ctypes.addressof(self._filter)
        if self._rest:
            structure.rest = ctypes.addressof(self._rest[0])
            structure.rest_distance = self._rest_distance


class _List:
    """Room for one of the library's lists."""

    def __init__(self):
        self.pairs, self.times = _step_list(64)
        self.ranges = np.empty(16, _binding.sc_object_pairs)

    def give(self, structure):
        structure.capacity, structure.pairs = len(self.pairs), self.pairs.ctypes.data
        structure.range_capacity, structure.ranges = len(self.ranges), self.ranges.ctypes.data

    def grow(self, structure):
        if structure.count > len(self.pairs):
            self.pairs, self.times = _step_list(structure.count + structure.count // 4)
        if structure.range_count > len(self.ranges):
            self.ranges = np.empty(2 * structure.range_count, _binding.sc_object_pairs)

    def meetings(self, structure, objects, timed=False):
        """What is there, as far as it fitted, if it is all."""
        found = []
        for a, b, first, count in self.ranges[: min(structure.range_count, len(self.ranges))].tolist():
            if first + count > len(self.pairs):
                break
            times = self.times[first:first + count].copy() if timed else None
            found.append(Meeting(objects[a], objects[b], self.pairs[first:first + count].copy(), times))
        return found


class Scene:
    """Several objects: cloth and a body, layers of clothes, characters that share a model, a level.

    One call at a time; another one meanwhile raises an Error. What did not change since the last call
    of the same kind is not read again.
    """

    def __init__(self):
        self.objects = []
        self._lists = [_List(), _List()]
        self._scratch = _Scratch()  # threads
        self._lenders = {}  # of models that several objects have: a _Scratch whose room they use
        self._lock = threading.Lock()

    def __repr__(self):
        return f"<starcontour.Scene of {len(self.objects)} objects>"

    def __len__(self):
        return len(self.objects)

    def __iter__(self):
        return iter(self.objects)

    def add(self, model, pose=None, *, itself=True, group=None, ignore_rings=0, rest=None,
            rest_distance=0.0):
        """A new SceneObject. ignore_rings, and of what is near and of steps rest and rest_distance, are
        for its pairs with itself, and mean what they mean in queries of a Model."""
        one = SceneObject(self, len(self.objects), model, itself, group, ignore_rings, rest, rest_distance)
        if pose is not None:
            one.pose = pose
        self.objects.append(one)
        return one

    def query(self, *, pairs="triangle", contact="touching", method="default", cancel=None, threads=1):
        """What intersects: a list of Meetings, by objects in their order. Options: see the module."""
        options = _binding.sc_query_options(
            struct_size=ctypes.sizeof(_binding.sc_query_options),
            output=_binding.SC_OUTPUT_PAIRS,
            pairs=_choice("pairs", pairs, _PAIRS),
            contact=_choice("contact", contact, _CONTACT),
            method=_choice("method", method, _METHOD),
            cancel=_cancel(cancel),
        )
        result = _binding.sc_objects_result(struct_size=ctypes.sizeof(_binding.sc_objects_result))

        def answer():
            return self._lists[0].meetings(result, self.objects)

        return self._ask(lib.sc_query_objects, options, result, [result], 0, threads, answer)

    def near(self, distance, *, kinds="both", method="default", cancel=None, threads=1):
        """What is within a distance, in units of the coordinates, compared exactly: a SceneNear."""
        options = _binding.sc_near_options(
            struct_size=ctypes.sizeof(_binding.sc_near_options),
            output=_binding.SC_OUTPUT_PAIRS,
            kinds=_choice("kinds", kinds, _NEAR_KINDS),
            method=_choice("method", method, _NEAR_METHOD),
            distance=_length("distance", distance),
            cancel=_cancel(cancel),
        )
        result = _binding.sc_objects_lists(struct_size=ctypes.sizeof(_binding.sc_objects_lists))
        lists = [result.vertex_faces, result.edge_edges]

        def answer():
            return SceneNear(*(room.meetings(one, self.objects)
                               for room, one in zip(self._lists, lists)))

        return self._ask(lib.sc_query_objects_near, options, result, lists,
                         _binding.SC_WORKSPACE_NEAR, threads, answer)

    def step(self, *, separation=0.0, tolerance=0.0, method="default", only_nearer=False, cancel=None,
             threads=1):
        """What collides while objects move from pose to end, those that have one: a SceneStep."""
        options = _binding.sc_step_options(
            struct_size=ctypes.sizeof(_binding.sc_step_options),
            output=_binding.SC_OUTPUT_PAIRS,
            times=_binding.SC_STEP_TIMES_EACH,
            method=_choice("method", method, _STEP_METHOD),
            separation=_length("separation", separation),
            tolerance=_length("tolerance", tolerance),
            begun=_binding.SC_STEP_BEGUN_NEARER if only_nearer else _binding.SC_STEP_BEGUN_ALL,
            cancel=_cancel(cancel),
        )
        result = _binding.sc_objects_lists(struct_size=ctypes.sizeof(_binding.sc_objects_lists))
        lists = [result.vertex_faces, result.edge_edges]

        def answer():
            return SceneStep(*(room.meetings(one, self.objects, True)
                               for room, one in zip(self._lists, lists)), result.earliest)

        return self._ask(lib.sc_query_objects_step, options, result, lists,
                         _binding.SC_WORKSPACE_NEAR, threads, answer, moves=True)

    def _fit_lenders(self, flags, threads):
        """Makes those of models that several objects have fit."""
        counts = Counter(one.model for one in self.objects)
        self._lenders = {model: self._lenders.get(model) or _Scratch()
                         for model, count in counts.items() if count > 1}
        for model, lender in self._lenders.items():
            lender.fit(model._handle, flags | _binding.SC_WORKSPACE_ROOM, threads)
        return self._lenders

    def _ask(self, function, options, result, lists, flags, threads, answer, moves=False):
        _check_threads(threads)
        if not self._lock.acquire(blocking=False):
            raise Error(_binding.SC_ERROR_WORKSPACE, _IN_USE)
        try:
            array = (_binding.sc_object * max(1, len(self.objects)))()
            lenders = self._fit_lenders(flags, threads)
            for one, structure in zip(self.objects, array):
                one._fill(structure, flags, threads, lenders.get(one.model))
                if moves and one._end:
                    structure.end = ctypes.addressof(one._end[0])
            objects = _binding.sc_objects(struct_size=ctypes.sizeof(_binding.sc_objects),
                                          count=len(self.objects), objects=ctypes.addressof(array))
            options.tasks = self._scratch.tasks_for(threads)
            while True:
                for room, one in zip(self._lists, lists):
                    room.give(one)
                    if moves:
                        one.times = room.times.ctypes.data
                status = self._scratch.call(function, options, ctypes.byref(objects),
                                            ctypes.byref(options), ctypes.byref(result))
                if status == _binding.SC_ERROR_INCOMPLETE:
                    raise Incomplete(answer())
                if status != _binding.SC_ERROR_SHORT_BUFFER:
                    break
                for room, one in zip(self._lists, lists):
                    room.grow(one)
            reasons = [reason for one in self.objects for reason in one._scratch.log.take()]
            if status:
                raise Error(status, "; ".join(reasons))
            return answer()
        finally:
            self._lock.release()
