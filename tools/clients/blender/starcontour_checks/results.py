"""What checks leave in a file: attributes, vertex groups, and objects that show contacts and contours.

SPDX-License-Identifier: MIT
"""

import bpy
import numpy as np

COLLISION = "self_collision"      # vertex group
FRAMES = "self_collision_frames"  # face attribute: in how many of the frames that were checked
THIN = "thin"                     # vertex group
THICKNESS = "thickness"           # face attribute; infinity: more than the distance
INTERSECTED = "intersected_side"  # vertex group
REGIONS = "intersected_regions"   # color attribute
OVERLAY = "Starcontour contacts"
CONTOURS = "Starcontour contours"

# Colours of regions, in turn, chosen so that neighbours in this list differ; light grey is what is in none.
_REGION_COLORS = np.array([[0.9, 0.3, 0.0], [0.0, 0.35, 0.8], [0.95, 0.75, 0.0], [0.0, 0.6, 0.35],
                           [0.7, 0.15, 0.6], [0.3, 0.7, 0.95], [0.6, 0.0, 0.1], [0.45, 0.75, 0.1]])
_NO_REGION = [0.8, 0.8, 0.8]


def write_attribute(mesh, name, kind, values):
    """Writes a face attribute, over an older one."""
    old = mesh.attributes.get(name)
    if old is not None and (old.domain != "FACE" or old.data_type != kind):
        mesh.attributes.remove(old)
        old = None
    attribute = old or mesh.attributes.new(name, kind, "FACE")
    attribute.data.foreach_set("value", values)
    mesh.update()


def read_attribute(mesh, name, dtype):
    """The values of a face attribute, or None."""
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.domain != "FACE":
        return None
    values = np.empty(len(mesh.polygons), dtype)
    attribute.data.foreach_get("value", values)
    return values


def write_group(thing, name, weights):
    """Writes a vertex group: vertices of weight 0 are not in it. Those of other groups stay."""
    group = thing.vertex_groups.get(name)
    if group is None:
        group = thing.vertex_groups.new(name=name)
    else:
        group.remove(list(range(len(thing.data.vertices))))
    for weight in np.unique(weights[weights > 0]):
        group.add(np.flatnonzero(weights == weight).tolist(), float(weight), "REPLACE")


def write_regions(mesh, labels):
    """Writes a colour for each vertex by the number of its region, -1: in none. In the 3D view it is what
    is seen with the shading's color "Attribute"."""
    _forget_regions(mesh)
    colors = np.ones((len(labels), 4), np.float32)
    colors[:, :3] = np.where(labels[:, None] < 0, _NO_REGION, _REGION_COLORS[labels % len(_REGION_COLORS)])
    attribute = mesh.color_attributes.new(REGIONS, "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", colors.ravel())
    mesh.attributes.active_color = attribute
    mesh.update()


def _forget_regions(mesh):
    attribute = mesh.color_attributes.get(REGIONS)
    if attribute is not None:
        mesh.color_attributes.remove(attribute)


def forget(thing):
    """Takes away groups and attributes of an object."""
    _forget_regions(thing.data)
    for name in (COLLISION, THIN, INTERSECTED):
        group = thing.vertex_groups.get(name)
        if group is not None:
            thing.vertex_groups.remove(group)
    for name in (FRAMES, THICKNESS):
        attribute = thing.data.attributes.get(name)
        if attribute is not None and attribute.domain == "FACE":
            thing.data.attributes.remove(attribute)


def _tubes(segments, radius):
    """Vertices and quads and triangles round segments: a square tube each, with a pyramid at both ends, so
    that of a point there is an octahedron."""
    p, q = segments[:, 0], segments[:, 1]
    along = q - p
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 0, along / np.where(length > 0, length, 1), [0.0, 0.0, 1.0])
    other = np.where(np.abs(along[:, :1]) < 0.6, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    u = np.cross(along, other)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(along, u)
    ring = [u, v, -u, -v]
    corners = [p - radius * along] + [p + radius * side for side in ring] + \
        [q + radius * side for side in ring] + [q + radius * along]
    vertices = np.stack(corners, 1).reshape(-1, 3)
    first = 10 * np.arange(len(segments))[:, None]
    triangles = [[0, 1 + (k + 1) % 4, 1 + k] for k in range(4)] + [[9, 5 + k, 5 + (k + 1) % 4] for k in range(4)]
    quads = [[1 + k, 1 + (k + 1) % 4, 5 + (k + 1) % 4, 5 + k] for k in range(4)]
    return (vertices, (first[:, :, None] + np.array(triangles)).reshape(-1, 3),
            (first[:, :, None] + np.array(quads)).reshape(-1, 4))


def _material(name, color):
    material = bpy.data.materials.get(name)
    if material is None:
        material = bpy.data.materials.new(name)
        material.diffuse_color = color
        if bpy.app.version < (5, 0, 0):
            material.use_nodes = True
        for node in material.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED":
                node.inputs["Base Color"].default_value = color
                emission = node.inputs.get("Emission Color") or node.inputs.get("Emission")
                emission.default_value = color
                node.inputs["Emission Strength"].default_value = 1.0
    return material


def show_contacts(scene, segments, radius):
    """Makes the overlay object, or makes it anew, of segments in world coordinates; it is in front of
    all else in the 3D view. Without segments it has an empty mesh."""
    vertices, triangles, quads = _tubes(segments, radius)
    mesh = bpy.data.meshes.new(OVERLAY)
    corners = np.concatenate([triangles.ravel(), quads.ravel()]).astype(np.int32)
    totals = np.concatenate([np.full(len(triangles), 3), np.full(len(quads), 4)]).astype(np.int32)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(len(totals))
    mesh.polygons.foreach_set("loop_start", np.cumsum(totals, dtype=np.int32) - totals)
    if bpy.app.version < (4, 1, 0):
        mesh.polygons.foreach_set("loop_total", totals)
    mesh.update(calc_edges=True)
    mesh.materials.append(_material(OVERLAY, (1.0, 0.05, 0.02, 1.0)))
    return _show(scene, OVERLAY, mesh, bpy.data.meshes)


def show_contours(scene, lines, radius):
    """Makes the object that shows contours, or makes it anew: a curve with a spline for each line, which
    are pairs of points in world coordinates and whether it is closed. In front of all else as contacts."""
    curve = bpy.data.curves.new(CONTOURS, "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth, curve.bevel_resolution, curve.use_fill_caps = radius, 1, True
    for points, closed in lines:
        spline = curve.splines.new("POLY")
        spline.points.add(len(points) - 1)  # it has one
        spline.points.foreach_set("co", np.hstack([points, np.ones((len(points), 1))]).astype(np.float32).ravel())
        spline.use_cyclic_u = closed
    curve.materials.append(_material(CONTOURS, (1.0, 0.8, 0.0, 1.0)))
    return _show(scene, CONTOURS, curve, bpy.data.curves)


def _show(scene, name, data, kind):
    """The overlay object of a name with this data, in place of what it had."""
    overlay = bpy.data.objects.get(name)
    if overlay is None:
        overlay = bpy.data.objects.new(name, data)
    else:
        old, overlay.data = overlay.data, data
        if old.users == 0:
            kind.remove(old)
        data.name = name
    if overlay.name not in scene.collection.all_objects:
        scene.collection.objects.link(overlay)
    overlay.show_in_front = True
    overlay.hide_select = True
    return overlay


def hide():
    """Takes the overlay objects away."""
    for name, kind, of_type in ((OVERLAY, bpy.data.meshes, "MESH"), (CONTOURS, bpy.data.curves, "CURVE")):
        overlay = bpy.data.objects.get(name)
        if overlay is not None and overlay.type == of_type:
            data = overlay.data
            bpy.data.objects.remove(overlay)
            if data.users == 0:
                kind.remove(data)
        material = bpy.data.materials.get(name)
        if material is not None and material.users == 0:
            bpy.data.materials.remove(material)
