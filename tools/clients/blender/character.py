"""Meshes that the test and the picture are made with: a character of boxes with bones that moves.

SPDX-License-Identifier: MIT
"""

import math

import bpy
from mathutils import Vector

LAST = 24  # frame of the animation; the first is 1


def new_object(name, vertices, faces, select=True):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    if select:
        only(thing)
    return thing


def only(*things):
    """Selects these objects alone; the first is active."""
    bpy.context.view_layer.update()  # knows new ones after that
    for other in bpy.context.view_layer.objects:
        other.select_set(other in things)
    bpy.context.view_layer.objects.active = things[0]


def boxes_surface(cells):
    """Vertices and quads of the surface of unit cells, given by their lower corners."""
    numbers, faces = {}, []
    for cell in sorted(cells):
        for axis in range(3):
            for side in (0, 1):
                beside = list(cell)
                beside[axis] += 2 * side - 1
                if tuple(beside) in cells:
                    continue
                u, v = (axis + 1) % 3, (axis + 2) % 3
                corners = []
                for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)) if side else ((0, 0), (0, 1), (1, 1), (1, 0)):
                    corner = list(cell)
                    corner[axis] += side
                    corner[u] += du
                    corner[v] += dv
                    corners.append(numbers.setdefault(tuple(corner), len(numbers)))
                faces.append(corners)
    return list(numbers), faces


# Bones: name, head, tail, parent; in cells.
BONES = (("body", (0, 0, 0), (0, 0, 10), None),
         ("arm.L", (3, 0, 8), (8, 0, 8), "body"), ("hand.L", (8, 0, 8), (14, 0, 8), "arm.L"),
         ("arm.R", (-3, 0, 8), (-8, 0, 8), "body"), ("hand.R", (-8, 0, 8), (-14, 0, 8), "arm.R"),
         ("leg.L", (2, 0, 0), (2, 0, -8), "body"), ("leg.R", (-2, 0, 0), (-2, 0, -8), "body"))


def weights_at(x, y, z):
    """Of a vertex of the character: a weight for each bone that moves it. Joints are soft."""
    side = "L" if x > 0 else "R"
    if abs(x) > 3:
        hand = min(max((abs(x) - 7) / 2, 0), 1)
        arm = min(max((abs(x) - 3) / 2, 0), 1)
        return {"hand." + side: hand, "arm." + side: arm * (1 - hand), "body": (1 - arm) * (1 - hand)}
    leg = min(max(-z / 2, 0), 1)
    return {"leg." + side: leg, "body": 1 - leg}


def make_character(levels=1):
    """A character of one closed mesh that moves from frame 1 to LAST, scaled, turned, and not at the origin."""
    cells = set()
    for x in range(-3, 3):
        for y in range(-2, 2):
            cells |= {(x, y, z) for z in range(0, 10)}
            if abs(x + 0.5) > 1:
                cells |= {(x, y, z) for z in range(-8, 0) if abs(y + 0.5) < 2}
    for x in list(range(-14, -3)) + list(range(3, 14)):
        cells |= {(x, y, z) for y in (-1, 0) for z in (7, 8)}
    vertices, faces = boxes_surface(cells)
    thing = new_object("Character", [(0.1 * x, 0.1 * y, 0.1 * z) for x, y, z in vertices], faces)

    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(armature)
    only(armature)
    bpy.ops.object.mode_set(mode="EDIT")
    for name, head, tail, parent in BONES:
        bone = armature.data.edit_bones.new(name)
        bone.head, bone.tail = [0.1 * c for c in head], [0.1 * c for c in tail]
        bone.parent = armature.data.edit_bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")

    groups = {name: thing.vertex_groups.new(name=name) for name, *_ in BONES}
    for number, corner in enumerate(vertices):
        for name, weight in weights_at(*corner).items():
            if weight:
                groups[name].add([number], weight, "REPLACE")
    modifier = thing.modifiers.new("Rig", "ARMATURE")
    modifier.object = armature
    if levels:
        thing.modifiers.new("Smooth", "SUBSURF").levels = levels
    thing.parent = armature
    armature.location, armature.rotation_euler, armature.scale = (3, -2, 0.5), (0.2, 0.1, 0.7), (1.5, 1.5, 1.5)

    def turn(name, axis, degrees):
        """Keys a bone that turns about an axis of the character."""
        bone = armature.pose.bones[name]
        bone.rotation_mode = "AXIS_ANGLE"
        local = bone.bone.matrix_local.to_3x3().inverted() @ Vector([float(axis == one) for one in "xyz"])
        for frame, part in ((1, 0.0), (12, 1.0), (LAST, 0.3)):
            bone.rotation_axis_angle = (math.radians(degrees) * part, *local)
            bone.keyframe_insert("rotation_axis_angle", frame=frame)

    turn("arm.L", "y", 75)
    turn("arm.R", "y", -75)
    turn("hand.L", "z", 60)
    turn("leg.L", "y", 20)
    turn("leg.R", "y", -20)
    only(thing)
    return thing
