"""The operators: they read meshes, ask the library, and write down what it found.

SPDX-License-Identifier: MIT
"""

import bpy
import numpy as np

from . import checks, meshes, results
from .contours import Tracer, own_labels
from .thickness import thickness

WHAT = (("COLLISION", "Colliding", "Faces that a check found"),
        ("THIN", "Thin", "Faces that the search for thin walls found"))


def wanted(context):
    """The selected mesh objects, the overlay excepted; else the active one."""
    active = context.view_layer.objects.active
    for some in (context.selected_objects, [active] if active is not None else []):
        things = [thing for thing in some if thing.type == "MESH" and thing.name != results.OVERLAY]
        if things:
            return things
    return []


class Work:
    """Reads objects in object mode, with their faces numbered. Mode and frame are at the end what they
    were."""

    def __init__(self, context, things):
        self.context, self.things = context, things
        self.mode = None

    def __enter__(self):
        scene = self.context.scene
        self.frame = scene.frame_current, scene.frame_subframe
        if any(thing.mode != "OBJECT" for thing in self.things):
            self.mode = self.context.view_layer.objects.active.mode
            bpy.ops.object.mode_set(mode="OBJECT")
        self.names = meshes.number_faces(self.things)
        return self

    def __exit__(self, *exception):
        self.back()
        meshes.forget_numbers(self.names)
        if self.mode is not None:
            bpy.ops.object.mode_set(mode=self.mode)

    def back(self):
        """Goes back to the frame of before."""
        scene = self.context.scene
        if (scene.frame_current, scene.frame_subframe) != self.frame:
            scene.frame_set(self.frame[0], subframe=self.frame[1])

    def read(self):
        """A Snapshot of each object as it is now."""
        self.context.view_layer.update()
        depsgraph = self.context.evaluated_depsgraph_get()
        return [meshes.snapshot(thing, depsgraph, self.names) for thing in self.things]


class Tally:
    """In how many frames each face and each vertex of the objects' own meshes collides. Objects may
    share a mesh: a face of it collides if it does in one of them."""

    def __init__(self, things):
        self.things = things
        self.users = {}
        for number, thing in enumerate(things):
            self.users.setdefault(thing.data, []).append(number)
        self.faces = {mesh: np.zeros(len(mesh.polygons), np.int32) for mesh in self.users}
        self.vertices = {mesh: np.zeros(len(mesh.vertices), np.int32) for mesh in self.users}
        self.rows, self.unknown = [], 0  # (frame, pairs, faces of evaluated meshes); faces of no own face

    def add(self, frame, found, shots):
        masks = [checks.faces_of(found, shots, number) for number in range(len(shots))]
        for mesh, users in self.users.items():
            own = np.zeros(len(mesh.polygons), bool)
            for number in users:
                own |= checks.own_faces(shots[number], masks[number], len(own))
            self.faces[mesh] += own
            self.vertices[mesh] += meshes.vertices_of_faces(mesh, own)
        self.unknown += sum(int((shot.origins[mask] < 0).sum()) for shot, mask in zip(shots, masks))
        self.rows.append((frame, sum(len(one.pairs) for one in found), sum(int(mask.sum()) for mask in masks)))

    def write(self, settings):
        for mesh, users in self.users.items():
            results.write_attribute(mesh, results.FRAMES, "INT", self.faces[mesh])
            weights = self.vertices[mesh] / len(self.rows)
            if settings.weights == "UNION":
                weights = np.ceil(weights)
            for number in users:
                results.write_group(self.things[number], results.COLLISION, weights)
        settings.frames.clear()
        settings.checked.clear()
        for frame, pairs, faces in self.rows:
            row = settings.frames.add()
            row.frame, row.pairs, row.faces = frame, pairs, faces
        for thing in self.things:
            settings.checked.add().thing = thing
        settings.pairs = sum(row[1] for row in self.rows)
        settings.faces = sum(int((faces > 0).sum()) for faces in self.faces.values())
        settings.colliding_frames = sum(row[1] > 0 for row in self.rows)
        settings.state = "CHECKED"


def _each_frame(context, settings, work, look):
    """Goes through the frames that are wanted, and back to the frame of before. Gives for each its number,
    the Snapshots, and what look finds in them. Raises checks.Refused."""
    scene, windows = context.scene, context.window_manager
    first, last = scene.frame_start, scene.frame_end
    if settings.own_range:
        first, last = settings.first, settings.last
    numbers = range(first, last + 1, settings.step)
    if not numbers:
        raise checks.Refused(f"there is no frame from {first} to {last}")
    windows.progress_begin(0, len(numbers))
    try:
        for done, number in enumerate(numbers):
            scene.frame_set(number)
            shots = work.read()
            try:
                found = look(shots)
            except checks.Refused as refusal:
                raise checks.Refused(f"frame {number}: {refusal}") from None
            yield number, shots, found
            windows.progress_update(done + 1)
        work.back()
    finally:
        windows.progress_end()


def _checker(settings, things, once):
    return checks.Checker([thing.name for thing in things], settings.weld, settings.contact.lower(),
                          settings.itself, settings.between, once)


def _tracer(settings, things, once):
    return Tracer([thing.name for thing in things], settings.weld, itself=settings.itself,
                  between=settings.between, once=once)


def _radius(settings, shots):
    """Of lines that are shown."""
    if settings.overlay_radius:
        return settings.overlay_radius
    spans = [np.ptp(meshes.in_world(shot), axis=0).max() for shot in shots if len(shot.positions)]
    return 0.003 * max(spans, default=0.0)


def _show(context, settings, checker, shots, found):
    if settings.overlay:
        results.show_contacts(context.scene, checker.contacts(shots, found), _radius(settings, shots))


def _still_there(context, rows):
    """The objects of a list that are in the view layer."""
    return [one.thing for one in rows
            if one.thing is not None and one.thing.name in context.view_layer.objects]


def show_now(context, settings):
    """Shows where the objects that were checked meet in this frame, and contours of those that were
    traced. Raises checks.Refused."""
    things = _still_there(context, settings.checked)
    if things and settings.overlay:
        checker = _checker(settings, things, True)
        with Work(context, things) as work:
            shots = work.read()
            _show(context, settings, checker, shots, checker.check(shots))
    things = _still_there(context, settings.traced)
    shown = bpy.data.objects.get(results.CONTOURS)
    if things and shown is not None and shown.type == "CURVE":
        with Work(context, things) as work:
            shots = work.read()
            found = _tracer(settings, things, True).trace(shots)
            results.show_contours(context.scene, found.lines, _radius(settings, shots))


class _Asks:
    """What operators that ask about objects have in common: which, and how refusals are reported."""

    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        things = wanted(context)
        try:
            if not things:
                raise checks.Refused("no mesh object is selected")
            for thing in things:
                if thing.library is not None or thing.data.library is not None:
                    raise checks.Refused(f"{thing.name} is linked from another file, so that results cannot "
                                         "be written to it: make it local")
            self.run(context, context.scene.starcontour, things)
            return {"FINISHED"}
        except checks.Refused as refusal:
            self.report({"ERROR"}, str(refusal))
        except MemoryError:
            self.report({"ERROR"}, "there is not enough memory")
        return {"CANCELLED"}

    def tell(self, tally, settings):
        text = f"{settings.pairs} pairs of triangles, {settings.faces} faces"
        if len(tally.rows) > 1:
            text += f", in {settings.colliding_frames} of {len(tally.rows)} frames"
        if tally.unknown:
            text += f"; {tally.unknown} faces made by modifiers are of no face of the mesh, and only counted " \
                    "in the list"
        self.report({"WARNING" if settings.pairs else "INFO"}, text)


class STARCONTOUR_OT_check(_Asks, bpy.types.Operator):
    """Find what intersects in the selected objects, as modifiers leave them in this frame"""

    bl_idname = "starcontour.check"
    bl_label = "Check This Frame"

    def run(self, context, settings, things):
        checker, tally = _checker(settings, things, True), Tally(things)
        with Work(context, things) as work:
            shots = work.read()
            found = checker.check(shots)
            tally.add(context.scene.frame_current, found, shots)
            tally.write(settings)
            _show(context, settings, checker, shots, found)
        self.tell(tally, settings)


class STARCONTOUR_OT_check_frames(_Asks, bpy.types.Operator):
    """Find what intersects in the selected objects in each frame of a range"""

    bl_idname = "starcontour.check_frames"
    bl_label = "Check Frames"

    def run(self, context, settings, things):
        checker, tally = _checker(settings, things, False), Tally(things)
        with Work(context, things) as work:
            for number, shots, found in _each_frame(context, settings, work, checker.check):
                tally.add(number, found, shots)
            tally.write(settings)
            if settings.overlay:
                shots = work.read()
                _show(context, settings, checker, shots, checker.check(shots))
        self.tell(tally, settings)


class _Traces(_Asks):
    """What operators that trace contours have in common."""

    def run(self, context, settings, things):
        other = bpy.data.objects.get(results.CONTOURS)
        if other is not None and other.type != "CURVE":
            raise checks.Refused(f"{other.name} is not a curve, so contours cannot be drawn: rename it")
        tracer = _tracer(settings, things, not self.in_range)
        counts = {thing.data: np.zeros(len(thing.data.vertices)) for thing in things}
        frames = []  # whether there are contours in each
        with Work(context, things) as work:
            if self.in_range:
                for _, shots, found in _each_frame(context, settings, work, tracer.trace):
                    for mesh, labels in self.labels(things, shots, found).items():
                        counts[mesh] += labels >= 0
                    frames.append(bool(found.lines))
            shots = work.read()
            found = tracer.trace(shots)
            labels = self.labels(things, shots, found)
            if not self.in_range:
                counts = {mesh: (own >= 0).astype(float) for mesh, own in labels.items()}
                frames = [bool(found.lines)]
            results.show_contours(context.scene, found.lines, _radius(settings, shots))
            for mesh, own in labels.items():
                results.write_regions(mesh, own)
            for thing in things:
                weights = counts[thing.data] / len(frames)
                results.write_group(thing, results.INTERSECTED,
                                    np.ceil(weights) if settings.weights == "UNION" else weights)
        settings.traced.clear()
        for thing in things:
            settings.traced.add().thing = thing
        settings.contours = len(found.lines)
        settings.closed = sum(closed for _, closed in found.lines)
        settings.marked = sum(int((count > 0).sum()) for count in counts.values())
        settings.traced_frames, settings.contour_frames = len(frames), sum(frames)
        self.tell_contours(found, settings)

    def labels(self, things, shots, found):
        """The labels of vertices of the own meshes. Of objects that share one, those of the first that has
        one."""
        of_meshes = {}
        for thing, shot, labels in zip(things, shots, found.labels):
            own = own_labels(shot, labels, thing.data)
            before = of_meshes.get(thing.data, own)
            of_meshes[thing.data] = np.where(before < 0, own, before)
        return of_meshes

    def tell_contours(self, found, settings):
        text = f"{settings.contours} contours, {settings.closed} of them closed; {settings.marked} vertices " \
               "are on the smaller side of one"
        if found.undecided:
            text += f"; {found.undecided} have no smaller side on one of their sheets"
        if self.in_range:
            text = f"contours in {settings.contour_frames} of {settings.traced_frames} frames, in which " \
                   f"{settings.marked} vertices are on the smaller side of one; {settings.contours} contours " \
                   "in this frame"
        self.report({"WARNING" if settings.contour_frames else "INFO"}, text)


class STARCONTOUR_OT_contours(_Traces, bpy.types.Operator):
    """Draw the contours at which surfaces of the selected objects pass through each other in this frame, and
    mark the smaller part of the surface beside each: what has gone through, as a rule"""

    bl_idname = "starcontour.contours"
    bl_label = "Trace Contours"
    in_range = False


class STARCONTOUR_OT_contours_frames(_Traces, bpy.types.Operator):
    """Mark what is on the smaller side of a contour in the frames of a range, and draw the contours of this
    frame"""

    bl_idname = "starcontour.contours_frames"
    bl_label = "Trace Frames"
    in_range = True


class STARCONTOUR_OT_thickness(_Asks, bpy.types.Operator):
    """Find faces of the selected objects that are nearer than a distance to what is not near them on the
    surface: thin walls and narrow gaps"""

    bl_idname = "starcontour.thickness"
    bl_label = "Find Thin Faces"

    def run(self, context, settings, things):
        distance = settings.distance
        if not distance > 0:
            raise checks.Refused("the distance must be more than 0")
        least, count = {}, 0
        with Work(context, things) as work:
            for thing, shot in zip(things, work.read()):
                thick = np.full(len(thing.data.polygons), np.inf)
                if len(shot.triangles):
                    threads = checks.threads_for([shot])
                    try:
                        values = thickness(meshes.in_world(shot), shot.triangles, distance, threads)
                    except checks.starcontour.Error as error:
                        raise checks.Refused(f"{thing.name}: {error}") from None
                    origins = shot.origins[shot.polygons]
                    np.minimum.at(thick, origins[origins >= 0], values[origins >= 0])
                of_mesh = least.setdefault(thing.data, thick)
                np.minimum(of_mesh, thick, out=of_mesh)
            for mesh, thick in least.items():
                thin = np.isfinite(thick)
                count += int(thin.sum())
                results.write_attribute(mesh, results.THICKNESS, "FLOAT", thick.astype(np.float32))
                weights = meshes.vertices_of_faces(mesh, thin).astype(float)
                for thing in things:
                    if thing.data == mesh:
                        results.write_group(thing, results.THIN, weights)
        settings.thin = count
        settings.least = min((float(thick.min()) for thick in least.values() if len(thick)), default=np.inf)
        text = f"{count} faces are at most {distance:g} thick"
        if count:
            text += f", the thinnest {settings.least:.6g}"
        self.report({"WARNING" if count else "INFO"}, text)


class STARCONTOUR_OT_select(bpy.types.Operator):
    """Go to edit mode and select the faces that were found"""

    bl_idname = "starcontour.select"
    bl_label = "Select Faces"
    bl_options = {"REGISTER", "UNDO"}

    what: bpy.props.EnumProperty(name="What", items=WHAT, default="COLLISION")

    def execute(self, context):
        things = wanted(context)
        masks = {}
        if things and any(thing.mode != "OBJECT" for thing in things):
            bpy.ops.object.mode_set(mode="OBJECT")
        for thing in things:
            if self.what == "COLLISION":
                counts = results.read_attribute(thing.data, results.FRAMES, np.int32)
                mask = None if counts is None else counts > 0
            else:
                thick = results.read_attribute(thing.data, results.THICKNESS, np.float32)
                mask = None if thick is None else np.isfinite(thick)
            if mask is not None:
                masks[thing] = mask
        if not masks:
            self.report({"ERROR"}, "nothing was searched for in the selected objects")
            return {"CANCELLED"}
        active = context.view_layer.objects.active
        if active not in masks:
            context.view_layer.objects.active = next(iter(masks))
        context.tool_settings.mesh_select_mode = (False, False, True)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="DESELECT")
        for thing, mask in masks.items():
            meshes.select_faces(thing.data, mask)
        self.report({"INFO"}, f"{sum(int(mask.sum()) for mask in masks.values())} faces are selected")
        return {"FINISHED"}


class STARCONTOUR_OT_jump(bpy.types.Operator):
    """Go to a frame, and show where the objects that were checked meet in it"""

    bl_idname = "starcontour.jump"
    bl_label = "Go to Frame"

    frame: bpy.props.IntProperty(name="Frame")

    def execute(self, context):
        context.scene.frame_set(self.frame)
        try:
            show_now(context, context.scene.starcontour)
        except checks.Refused as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        return {"FINISHED"}


class STARCONTOUR_OT_clear(bpy.types.Operator):
    """Take away what checks left: vertex groups and attributes of the selected objects, the list of frames,
    contacts and contours"""

    bl_idname = "starcontour.clear"
    bl_label = "Clear"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        settings, things = context.scene.starcontour, wanted(context)
        if any(thing.mode != "OBJECT" for thing in things):
            bpy.ops.object.mode_set(mode="OBJECT")
        for thing in things:
            results.forget(thing)
        results.hide()
        for name in ("frames", "checked", "traced"):
            getattr(settings, name).clear()
        for name in ("pairs", "faces", "colliding_frames", "thin", "least", "state", "contours", "closed", "marked",
                     "traced_frames", "contour_frames"):
            settings.property_unset(name)
        return {"FINISHED"}


classes = (STARCONTOUR_OT_check, STARCONTOUR_OT_check_frames, STARCONTOUR_OT_contours,
           STARCONTOUR_OT_contours_frames, STARCONTOUR_OT_thickness, STARCONTOUR_OT_select, STARCONTOUR_OT_jump, STARCONTOUR_OT_clear)
