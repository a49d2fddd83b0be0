"""Starcontour for Blender: the intersections of meshes with themselves and with each other, exactly, in
a frame or in a range of frames, their contours, and thin walls. In the sidebar of the 3D view, and for scripts:

    settings = bpy.context.scene.starcontour      what is wanted, see Settings in panel.py
    bpy.ops.starcontour.check()                   the selected objects in this frame
    bpy.ops.starcontour.check_frames()            in each frame of a range
    bpy.ops.starcontour.contours()                contours in this frame, and what is beside them
    bpy.ops.starcontour.contours_frames()         what is beside them in each frame of a range
    bpy.ops.starcontour.thickness()               faces thinner than settings.distance
    bpy.ops.starcontour.select(what="COLLISION")  select what was found, in edit mode
    settings.pairs, settings.faces, settings.frames[i].frame, .pairs, .faces

SPDX-License-Identifier: MIT
"""

bl_info = {
    "name": "Starcontour",
    "description": "Exact self-intersections and thickness, over animations too",
    "author": "starcontour maintainers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Starcontour",
    "category": "Mesh",
}

import sys  # noqa: E402: Blender reads bl_info without running the rest

# Installed again, the add-on is loaded again, and so have to be its parts.
for name in [name for name in sys.modules if name.startswith(__name__ + ".")]:
    del sys.modules[name]
    globals().pop(name[len(__name__) + 1:], None)

from . import panel  # noqa: E402


def register():
    panel.register()


def unregister():
    panel.unregister()
