"""Which triangles of snapshots intersect, by the library; and how thick meshes are.

SPDX-License-Identifier: MIT
"""

import os
import shutil
import tempfile
from collections import namedtuple
from pathlib import Path

import numpy as np

from . import meshes


def _package():
    """The copy of the Python package that `make blender-addon` packs, else the one that is installed.

    The library is loaded from a copy that is deleted then: an add-on of the old kind that is installed
    again is written over where it lies, and a library that is in use does not survive that."""
    packed = sorted((Path(__file__).parent / "starcontour").glob("libstarcontour.*"))
    if not packed:
        import starcontour
        return starcontour
    name = "STARCONTOUR_LIBRARY"
    before = os.environ.get(name)
    with tempfile.TemporaryDirectory(prefix="starcontour_checks-", ignore_cleanup_errors=True) as folder:
        os.environ[name] = shutil.copy(packed[0], folder)
        try:
            from . import starcontour
        finally:
            del os.environ[name]
            if before is not None:
                os.environ[name] = before
    return starcontour


starcontour = _package()

THREADS_FROM = 20000  # triangles: with fewer, one thread is as fast

Meeting = namedtuple("Meeting", "a b pairs")
Meeting.__doc__ = """What two objects have with each other, or one with itself (a == b).

a, b   numbers of objects
pairs  uint32 of shape (n, 2), sorted: a triangle of a and one of b
"""


class Refused(Exception):
    """A mesh that cannot be checked, and why."""


def threads_for(shots):
    """How many threads pay for a query."""
    if sum(len(shot.triangles) for shot in shots) < THREADS_FROM:
        return 1
    return min(os.cpu_count() or 1, 16)


class Checker:
    """Checks the same objects in one frame or in many. Of each, what depends on its triangles alone is
    computed once, and again where they change.

    names     of the objects, for messages
    weld      vertices at equal positions in the first frame are one
    contact   "touching" or "proper"
    itself    whether pairs of an object with itself are wanted
    between   whether pairs of two objects are wanted
    once      True: for one frame, which is faster then
    """

    def __init__(self, names, weld=True, contact="touching", itself=True, between=True, once=False):
        self.names, self.weld, self.contact = names, weld, contact
        self.itself, self.between, self.once = itself, between and len(names) > 1, once
        self._models = [None] * len(names)  # (model, triangles, rest positions)

    def _model(self, number, shot):
        """The model of an object, None: it has no triangles. Triangles may change from frame to frame,
        as Blender's triangulation of bent faces does; the rest pose is the first that is known."""
        kept = self._models[number]
        rest = shot.positions
        if kept is not None and len(kept[2]) == len(rest):
            if np.array_equal(kept[1], shot.triangles):
                return kept[0]
            rest = kept[2]
        model = None
        if len(shot.triangles):
            model = self._try(number, starcontour.Model, rest, shot.triangles,
                              weld="rest" if self.weld else "none", boxes=self.once)
        self._models[number] = model, shot.triangles, rest
        return model

    def _try(self, number, function, *arguments, **options):
        try:
            return function(*arguments, **options)
        except starcontour.Error as error:
            raise Refused(f"{self.names[number]}: {error}") from None

    def check(self, shots):
        """The Meetings of a frame, those that have pairs; shots: a Snapshot for each object. Raises
        Refused."""
        threads = threads_for(shots)
        models = [self._model(number, shot) for number, shot in enumerate(shots)]
        found = []
        if self.itself:
            for number, (model, shot) in enumerate(zip(models, shots)):
                if model is not None:
                    pairs = self._try(number, model.query, shot.positions, contact=self.contact,
                                      threads=threads)
                    found.append(Meeting(number, number, pairs))
        if self.between:
            scene, numbers = starcontour.Scene(), []
            for number, (model, shot) in enumerate(zip(models, shots)):
                if model is not None:
                    self._try(number, scene.add, model, meshes.in_world(shot), itself=False)
                    numbers.append(number)
            try:
                meetings = scene.query(contact=self.contact, threads=threads)
            except starcontour.Error as error:
                raise Refused(f"{', '.join(self.names)}: {error}") from None
            found += [Meeting(numbers[one.a.number], numbers[one.b.number], one.pairs) for one in meetings]
        return sorted((one for one in found if len(one.pairs)), key=lambda one: (one.a, one.b))

    def contacts(self, shots, found):
        """Where pairs meet, in world coordinates: segments as float64 of shape (n, 2, 3). Of a point
        both ends are the same; of an area, where two triangles of a plane overlap, the ends are two of
        its corners that are far apart."""
        segments = [np.empty((0, 2, 3))]
        for one in found:
            a, b = shots[one.a], shots[one.b]
            if one.a == one.b:
                points = self._models[one.a][0].contacts(a.positions, one.pairs)["points"]
                segments.append(meshes.in_world(a, points.reshape(-1, 3)).reshape(-1, 2, 3))
            else:
                segments.append(_contacts_between(a, b, one.pairs))
        return np.concatenate(segments)


def _contacts_between(a, b, pairs):
    """The same for triangles of two objects: by a mesh of those triangles alone."""
    corners = np.concatenate([meshes.in_world(a)[a.triangles[pairs[:, 0]]],
                              meshes.in_world(b)[b.triangles[pairs[:, 1]]]]).reshape(-1, 3)
    numbers = np.arange(2 * len(pairs), dtype=np.uint32)
    triangles = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
    model = starcontour.Model(corners, triangles, weld="none", boxes=True)
    return model.contacts(corners, np.stack(np.split(numbers, 2), 1))["points"]


def faces_of(found, shots, number):
    """Which faces of the evaluated mesh of an object are of a pair: a mask."""
    mask = np.zeros(shots[number].polygon_count, bool)
    for one in found:
        for side, which in ((0, one.a), (1, one.b)):
            if which == number:
                mask[shots[number].polygons[one.pairs[:, side]]] = True
    return mask


def own_faces(shot, mask, count):
    """Of faces of the evaluated mesh those of the object's own mesh, which has count: a mask."""
    origins = shot.origins[mask]
    own = np.zeros(count, bool)
    own[origins[origins >= 0]] = True
    return own
