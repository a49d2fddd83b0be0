"""Settings, and the panel in the sidebar of the 3D view.

SPDX-License-Identifier: MIT
"""

import bpy
from bpy.props import (BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty,
                       PointerProperty)

from . import checks, operators


class STARCONTOUR_PG_frame(bpy.types.PropertyGroup):
    """What was found in a frame."""

    frame: IntProperty(name="Frame")
    pairs: IntProperty(name="Pairs", description="Pairs of triangles that intersect")
    faces: IntProperty(name="Faces", description="Faces of those pairs, as modifiers leave them")


class STARCONTOUR_PG_thing(bpy.types.PropertyGroup):
    """An object that was checked or traced."""

    thing: PointerProperty(type=bpy.types.Object)


def _jump(settings, context):
    """A click on a row of the list."""
    if 0 <= settings.active_frame < len(settings.frames):
        context.scene.frame_set(settings.frames[settings.active_frame].frame)
        try:
            operators.show_now(context, settings)
        except checks.Refused as refusal:
            print(f"Starcontour: {refusal}")


class STARCONTOUR_PG_settings(bpy.types.PropertyGroup):
    """What is wanted, and what was found last."""

    itself: BoolProperty(
        name="Themselves", default=True,
        description="Find where objects intersect themselves: in local coordinates, as they are stored")
    between: BoolProperty(
        name="Each Other", default=True,
        description="Find where several selected objects intersect: in world coordinates, in doubles")
    weld: BoolProperty(
        name="Join Vertices", default=True,
        description="Take vertices at equal positions (of a range: in its first frame) for one, so that "
                    "meshes that are split at seams do not touch themselves there")
    contact: EnumProperty(
        name="Contact", default="TOUCHING",
        items=(("TOUCHING", "Touching", "What touches or overlaps in a plane counts, too"),
               ("PROPER", "Crossing", "Only edges that pass through faces count")))
    own_range: BoolProperty(
        name="Own Range", description="Check other frames than those of the scene's range")
    first: IntProperty(name="First", default=1)
    last: IntProperty(name="Last", default=250)
    step: IntProperty(name="Step", default=1, min=1, description="Check each so many frames")
    weights: EnumProperty(
        name="Weights", default="UNION",
        description="Weights in the vertex group self_collision of vertices whose faces collide, and in "
                    "intersected_side",
        items=(("UNION", "Any Frame", "1 where a vertex is of a face that collides in any frame"),
               ("SHARE", "Share", "In how many of the frames its faces collide, from 0 to 1")))
    overlay: BoolProperty(
        name="Show Contacts", default=True,
        description="Make an object that shows where faces meet in the current frame")
    overlay_radius: FloatProperty(
        name="Radius", subtype="DISTANCE", unit="LENGTH", min=0.0, precision=4,
        description="Of lines that show contacts and contours; 0: a part of the objects' size")
    distance: FloatProperty(
        name="Distance", subtype="DISTANCE", unit="LENGTH", min=0.0, default=0.01, precision=4,
        description="Faces are thin that are as near as this to what is not near them on the surface, in "
                    "world coordinates. Edges should not be much longer")

    frames: CollectionProperty(type=STARCONTOUR_PG_frame)
    checked: CollectionProperty(type=STARCONTOUR_PG_thing)
    active_frame: IntProperty(name="Go to frame", update=_jump, options={"SKIP_SAVE"})
    only_colliding: BoolProperty(name="Only Colliding", default=True,
                                 description="List only frames in which something intersects")
    state: EnumProperty(items=(("NONE", "Not checked", ""), ("CHECKED", "Checked", "")), default="NONE")
    pairs: IntProperty(name="Pairs", description="Of all frames that were checked together")
    faces: IntProperty(name="Faces", description="Of the objects' own meshes, in any frame")
    colliding_frames: IntProperty(name="Frames", description="In which something intersects")
    traced: CollectionProperty(type=STARCONTOUR_PG_thing)
    contours: IntProperty(name="Contours", default=-1)
    closed: IntProperty(name="Closed", description="Contours that are closed")
    marked: IntProperty(name="Vertices", description="On the smaller side of a contour, in any frame")
    traced_frames: IntProperty(name="Frames", description="That were traced")
    contour_frames: IntProperty(name="Frames", description="In which there are contours")
    thin: IntProperty(name="Thin Faces", default=-1)
    least: FloatProperty(name="Least Thickness")


class STARCONTOUR_UL_frames(bpy.types.UIList):
    """The frames that were checked."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0, flag=0):
        layout.label(text=f"{item.frame}:  {item.pairs} pairs, {item.faces} faces",
                     icon="ERROR" if item.pairs else "CHECKMARK")

    def filter_items(self, context, data, property_name):
        rows = getattr(data, property_name)
        if not data.only_colliding:
            return [], []
        return [self.bitflag_filter_item if row.pairs else 0 for row in rows], []


class STARCONTOUR_PT_panel(bpy.types.Panel):
    bl_label = "Starcontour"
    bl_idname = "STARCONTOUR_PT_panel"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Starcontour"

    def draw(self, context):
        layout, settings = self.layout, context.scene.starcontour
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(heading="Check With")
        column.prop(settings, "itself")
        column.prop(settings, "between")
        layout.prop(settings, "contact")
        layout.row(heading="Seams").prop(settings, "weld")
        layout.prop(settings, "weights")
        row = layout.row(heading="Overlay")
        row.prop(settings, "overlay", text="")
        part = row.row()
        part.active = settings.overlay
        part.prop(settings, "overlay_radius", text="")
        layout.operator("starcontour.check", icon="VIEWZOOM")
        row = layout.row(heading="Range")
        row.prop(settings, "own_range", text="")
        part = row.row(align=True)
        part.active = settings.own_range
        part.prop(settings, "first", text="")
        part.prop(settings, "last", text="")
        layout.prop(settings, "step")
        layout.operator("starcontour.check_frames", icon="RENDER_ANIMATION")
        if settings.state == "CHECKED":
            box = layout.box()
            box.label(text=f"{settings.pairs} pairs, {settings.faces} faces",
                      icon="ERROR" if settings.pairs else "CHECKMARK")
            if len(settings.frames) > 1:
                box.label(text=f"in {settings.colliding_frames} of {len(settings.frames)} frames")
                box.template_list("STARCONTOUR_UL_frames", "", settings, "frames", settings, "active_frame")
                box.use_property_split = False
                box.prop(settings, "only_colliding")
            box.operator("starcontour.select").what = "COLLISION"
        layout.separator()
        layout.operator("starcontour.contours", icon="CURVE_DATA")
        layout.operator("starcontour.contours_frames", icon="RENDER_ANIMATION")
        if settings.contours >= 0:
            box = layout.box()
            box.label(text=f"{settings.contours} contours, {settings.closed} closed",
                      icon="ERROR" if settings.contour_frames else "CHECKMARK")
            if settings.traced_frames > 1:
                box.label(text=f"in {settings.contour_frames} of {settings.traced_frames} frames")
            box.label(text=f"{settings.marked} vertices on a smaller side")
        layout.separator()
        layout.prop(settings, "distance")
        layout.operator("starcontour.thickness", icon="MOD_THICKNESS")
        if settings.thin >= 0:
            box = layout.box()
            text = f"{settings.thin} thin faces"
            if settings.thin:
                text += f", thinnest {settings.least:.6g}"
            box.label(text=text)
            box.operator("starcontour.select").what = "THIN"
        layout.separator()
        layout.operator("starcontour.clear", icon="TRASH")


classes = (STARCONTOUR_PG_frame, STARCONTOUR_PG_thing, STARCONTOUR_PG_settings, *operators.classes,
           STARCONTOUR_UL_frames, STARCONTOUR_PT_panel)


def register():
    for one in classes:
        bpy.utils.register_class(one)
    bpy.types.Scene.starcontour = PointerProperty(type=STARCONTOUR_PG_settings)


def unregister():
    del bpy.types.Scene.starcontour
    for one in reversed(classes):
        bpy.utils.unregister_class(one)
