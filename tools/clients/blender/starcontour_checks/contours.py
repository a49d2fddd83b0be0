"""Contours of intersections, where sheets pass through each other, and the regions into which they divide
meshes.

SPDX-License-Identifier: MIT
"""

from collections import namedtuple

import numpy as np

from . import meshes
from .checks import Checker, Refused, starcontour, threads_for
from .thickness import welds

Contours = namedtuple("Contours", "lines labels regions undecided")
Contours.__doc__ = """The contours of a frame, and the smaller of the two regions beside each, on both of its sheets.

lines      of each contour its points, float64 of shape (n, 3) in world coordinates, and whether it is closed
labels     for each object an int32 for each vertex of the evaluated mesh: which of those regions it is in,
           counted from 0; -1: none
regions    how many of those regions there are, also ones between vertices
undecided  how many contours have no smaller region on one of their sheets: they do not divide it, or
           into parts of one area
"""


def _smaller(regions):
    """The regions that are smaller than the other beside a contour; and for each contour on how many of its
    two sheets there is one. By their areas, as sc_region_hint."""
    areas = regions.regions["area"][regions.sides]
    differ = areas[:, :, 0] != areas[:, :, 1]
    second = (areas[:, :, 1] < areas[:, :, 0]).astype(int)
    small = np.take_along_axis(regions.sides, second[:, :, None], 2)[:, :, 0]
    return np.unique(small[differ]), differ.sum(1)


class Tracer(Checker):
    """Traces the same objects in one frame or in many. Arguments as of a Checker, but for contact: sheets
    that touch are as if they were moved by a little that is the same everywhere, see sc_trace."""

    def trace(self, shots):
        """The Contours of a frame; shots: a Snapshot for each object. Raises Refused. Of a vertex that is in
        regions of an object's contours with itself and with others, the first count."""
        for name, shot in zip(self.names, shots):
            if not np.isfinite(shot.matrix).all():
                raise Refused(f"{name}: its place in the world is NaN or infinite")
        threads = threads_for(shots)
        models = [self._model(number, shot) for number, shot in enumerate(shots)]
        found = Contours([], [np.full(len(shot.positions), -1, np.int32) for shot in shots], 0, 0)
        if self.itself:
            for number, (model, shot) in enumerate(zip(models, shots)):
                if model is not None:
                    pairs = self._try(number, model.query, shot.positions, pairs="edge", threads=threads)
                    traced = self._try(number, model.trace, shot.positions, pairs, threads=threads)
                    regions = self._try(number, model.regions, shot.positions, traced)
                    lines = [meshes.in_world(shot, line) for line in traced.polylines()]
                    found = _joined(found, traced, lines, regions,
                                    {number: self._of_all(number, regions.vertex_regions)})
        if self.between:
            try:
                found = self._trace_between(shots, [k for k, model in enumerate(models) if model is not None],
                                            found, threads)
            except starcontour.Error as error:
                raise Refused(f"{', '.join(self.names)}: {error}") from None
        return found

    def _trace_between(self, shots, numbers, found, threads):
        """Adds contours of two objects, by one mesh of all in world coordinates. Each of their nodes is an
        edge of one and a triangle of the other, so pairs of an object with itself are not needed."""
        corners, triangles, owners, parts, first = [], [], [], {}, 0
        for number in numbers:
            shot, rest = shots[number], self._models[number][2]
            joins = welds(rest) if self.weld else np.arange(len(rest))
            corners.append(meshes.in_world(shot))
            triangles.append(first + joins[shot.triangles.astype(np.int64)])
            owners.append(np.full(len(shot.triangles), number))
            parts[number] = slice(first, first + len(rest))
            first += len(rest)
        if len(numbers) < 2:
            return found
        corners, owners = np.concatenate(corners), np.concatenate(owners)
        model = starcontour.Model(corners, np.concatenate(triangles).astype(np.uint32), weld="none", boxes=True)
        pairs = model.query(corners, pairs="edge", threads=threads)
        pairs = pairs[owners[pairs[:, 0] // 3] != owners[pairs[:, 1]]]
        traced = model.trace(corners, pairs, threads=threads)
        regions = model.regions(corners, traced)
        return _joined(found, traced, traced.polylines(), regions,
                       {number: self._of_all(number, regions.vertex_regions[part])
                        for number, part in parts.items()})

    def _of_all(self, number, regions):
        """The regions of an object's vertices, from those of the ones that stand for what is joined to
        them; others have the highest number."""
        if not self.weld:
            return regions
        joins, known = welds(self._models[number][2]), regions.copy()
        np.minimum.at(known, joins, regions)
        return known[joins]


def _joined(found, traced, lines, regions, vertex_regions):
    """Contours with those of another trace, of which vertex_regions are given for the objects that it is of."""
    closed = traced.contours["begin"] == 0
    lines = [(line[:-1] if ring else line, bool(ring)) for line, ring in zip(lines, closed)]
    small, sheets = _smaller(regions)
    numbers = np.full(len(regions.regions) + 1, -1, np.int32)  # the last is for vertices in no triangle
    numbers[small] = found.regions + np.arange(len(small))
    labels = list(found.labels)
    for number, regions_of in vertex_regions.items():
        new = numbers[np.minimum(regions_of, len(regions.regions))]
        labels[number] = np.where(labels[number] < 0, new, labels[number])
    return Contours(found.lines + lines, labels, found.regions + len(small),
                    found.undecided + int((sheets < 2).sum()))


def own_labels(shot, labels, mesh):
    """Of labels of vertices of the evaluated mesh those of vertices of the object's own mesh. Where modifiers
    make vertices or change faces, all vertices of a face have the label (the lowest) that any vertex of what
    was made of it has: so nothing that has one is lost, and more have one."""
    vertices, starts = meshes.corners(mesh)
    count, faces = len(mesh.vertices), shot.origins[shot.polygons]
    corners = np.repeat(np.arange(len(mesh.polygons)), np.diff(starts))
    if len(labels) == count and (faces >= 0).all() and \
            np.isin(faces[:, None] * count + shot.triangles.astype(np.int64), corners * count + vertices).all():
        return labels  # the triangles of each face have the face's own corners
    none = np.iinfo(np.int32).max
    lowest = np.where(labels < 0, none, labels)[shot.triangles.astype(np.int64)].min(1, initial=none)
    of_faces = np.full(len(mesh.polygons), none, np.int32)
    np.minimum.at(of_faces, faces[faces >= 0], lowest[faces >= 0])
    own = np.full(count, none, np.int32)
    np.minimum.at(own, vertices, of_faces[corners])
    return np.where(own == none, -1, own)
