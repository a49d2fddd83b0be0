"""Renders the picture of the page: the character with what the add-on found in a frame.

    python picture.py ZIP PNG

Where faces collide they are orange, and the overlay is red; the rest is made translucent, as the overlay is
in front of all else only in the 3D view. By Cycles on the processor, some minutes.

SPDX-License-Identifier: MIT
"""

import os
import sys
import tempfile

ZIP, PNG = (os.path.abspath(path) for path in sys.argv[1:])
FOLDER = tempfile.TemporaryDirectory(prefix="starcontour-blender-")
os.environ["BLENDER_USER_RESOURCES"] = FOLDER.name  # a fresh profile; read when bpy is loaded

import bpy  # noqa: E402
from mathutils import Vector  # noqa: E402

from character import make_character  # noqa: E402


def material(name, color, alpha):
    made = bpy.data.materials.new(name)
    values = made.node_tree.nodes["Principled BSDF"].inputs
    values["Base Color"].default_value, values["Alpha"].default_value = (*color, 1), alpha
    values["Roughness"].default_value = 0.6
    return made


def main():
    bpy.ops.extensions.package_install_files(filepath=ZIP, repo="user_default", enable_on_install=True)
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene
    character = make_character(levels=2)
    rig = character.parent
    rig.location, rig.rotation_euler, rig.scale = (0, 0, 0), (0, 0, 0), (1, 1, 1)
    scene.frame_set(11)
    scene.starcontour.overlay_radius = 0.008
    bpy.ops.starcontour.check()

    character.data.materials.append(material("Body", (0.45, 0.55, 0.65), 0.45))
    character.data.materials.append(material("Colliding", (0.95, 0.5, 0.05), 0.7))
    for face, frames in zip(character.data.polygons, character.data.attributes["self_collision_frames"].data):
        face.material_index = int(frames.value > 0)

    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 24, True
    scene.cycles.transparent_max_bounces = 16
    scene.render.resolution_x, scene.render.resolution_y = 420, 500
    scene.render.image_settings.color_mode, scene.render.image_settings.compression = "RGB", 100
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("White")
    background = scene.world.node_tree.nodes["Background"].inputs
    background[0].default_value, background[1].default_value = (1, 1, 1, 1), 0.8
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 2, (0.7, 0.3, 0.2)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (1.5, -4.4, 1.2)
    camera.rotation_euler = (Vector((0, 0, 0.13)) - camera.location).to_track_quat("-Z", "Y").to_euler()
    camera.data.lens = 75
    for thing in (sun, camera):
        scene.collection.objects.link(thing)
    scene.camera, scene.render.filepath = camera, PNG
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
