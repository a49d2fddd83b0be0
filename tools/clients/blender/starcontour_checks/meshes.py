"""Meshes of Blender as arrays: evaluated ones of a frame, and which faces of the object's own mesh they
come from.

SPDX-License-Identifier: MIT
"""

from collections import namedtuple

import bmesh
import numpy as np

# How the face attribute is called that is there while a check runs, with a number for each mesh: the
# number of each face, counted from 1, which modifiers copy to the faces that they make of it. Faces of
# other meshes that they join get 0.
ORIGIN = "starcontour_origin_"

Snapshot = namedtuple("Snapshot", "positions triangles polygons polygon_count matrix origins")
Snapshot.__doc__ = """An object in a frame, as modifiers, armatures and shape keys leave it.

positions      float32 of shape (n, 3): local coordinates, as Blender has them
triangles      uint32 of shape (m, 3): Blender's own triangulation (loop triangles)
polygons       int32 of shape (m,): the face of the evaluated mesh that each triangle is of
polygon_count  how many faces the evaluated mesh has
matrix         float64 of shape (4, 4): from local coordinates to the world's
origins        int32 of shape (polygon_count,): the face of the object's own mesh that each comes from;
               -1: of none that is known
"""


def _read(items, name, shape, dtype):
    array = np.empty(shape, dtype)
    items.foreach_get(name, array.ravel())
    return array


def _origins(mesh, own, name):
    """The own mesh's face of each face of the evaluated one, which has the attribute of that name."""
    attribute = mesh.attributes.get(name)
    count = len(mesh.polygons)
    if attribute is not None and attribute.domain == "FACE" and len(attribute.data) == count:
        origins = _read(attribute.data, "value", count, np.int32) - 1
        origins[(origins < 0) | (origins >= len(own.polygons))] = -1
        return origins
    if count == len(own.polygons):
        return np.arange(count, dtype=np.int32)
    return np.full(count, -1, np.int32)


def snapshot(thing, depsgraph, names):
    """A Snapshot of a mesh object. In object mode, between number_faces, which gave names, and
    forget_numbers."""
    evaluated = thing.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        return Snapshot(
            _read(mesh.vertices, "co", (len(mesh.vertices), 3), np.float32),
            _read(mesh.loop_triangles, "vertices", (count, 3), np.int32).astype(np.uint32),
            _read(mesh.loop_triangles, "polygon_index", count, np.int32),
            len(mesh.polygons),
            np.array(evaluated.matrix_world, np.float64),
            _origins(mesh, thing.data, names[thing.data]))
    finally:
        evaluated.to_mesh_clear()


def number_faces(things):
    """Gives each face of the objects' own meshes its number as an attribute. Returns its name for each
    mesh."""
    names = {}
    for mesh in (thing.data for thing in things):
        if mesh not in names:
            attribute = mesh.attributes.new(f"{ORIGIN}{len(names)}", "INT", "FACE")
            names[mesh] = attribute.name
            attribute.data.foreach_set("value", np.arange(1, len(mesh.polygons) + 1, dtype=np.int32))
            mesh.update()
    return names


def forget_numbers(names):
    """Takes away what number_faces gave."""
    for mesh, name in names.items():
        attribute = mesh.attributes.get(name)
        if attribute is not None:
            mesh.attributes.remove(attribute)
            mesh.update()


def in_world(shot, positions=None):
    """Positions, float64 of shape (n, 3): local ones (those of the snapshot) to the world's."""
    given = np.asarray(shot.positions if positions is None else positions, np.float64)
    world = np.tile(shot.matrix[:3, 3], (len(given), 1))
    for k in range(3):  # no product of matrices: its sums may be rounded in another way by machine
        world += given[:, k:k + 1] * shot.matrix[:3, k]
    return world


def corners(mesh):
    """Of an object's own mesh the vertices of its faces, those of face f from starts[f] to starts[f + 1]."""
    totals = _read(mesh.polygons, "loop_total", len(mesh.polygons), np.int32)
    return (_read(mesh.loops, "vertex_index", len(mesh.loops), np.int32).astype(np.int64),
            np.concatenate([[0], np.cumsum(totals)]))


def vertices_of_faces(mesh, faces):
    """Of an object's own mesh the vertices, as a mask, of the faces of a mask."""
    vertices, starts = corners(mesh)
    mask = np.zeros(len(mesh.vertices), bool)
    mask[vertices[np.repeat(faces, np.diff(starts))]] = True
    return mask


def select_faces(mesh, faces):
    """Selects these faces of an object's own mesh, with their edges and vertices; hidden ones are not. In
    edit mode, with nothing selected."""
    edited = bmesh.from_edit_mesh(mesh)
    edited.faces.ensure_lookup_table()
    for number in np.flatnonzero(faces).tolist():
        edited.faces[number].select_set(True)
    bmesh.update_edit_mesh(mesh, loop_triangles=False, destructive=False)
