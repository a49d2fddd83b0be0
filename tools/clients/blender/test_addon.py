"""The add-on in Blender without a window (bpy), installed from its zip into a fresh profile: what it finds
beside sc-query on the exported frames.

    python test_addon.py ZIP SC_QUERY [NAME...]      names of tests, default: all
    blender -b --python-exit-code 1 --python test_addon.py -- ZIP SC_QUERY [NAME...]

By the second line in the Blender that is installed, with BLENDER_USER_CONFIG, BLENDER_USER_SCRIPTS and
BLENDER_USER_RESOURCES set to an empty folder. Before 4.2 the zip is installed as an add-on of the old kind.

The character (character.py) is made of boxes, subdivided, with bones and weights; in some frames its arms go
through its body, and its legs through each other. Exit status 1 if anything differs.

SPDX-License-Identifier: MIT
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

ARGUMENTS = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
ZIP, SC_QUERY = (os.path.abspath(path) for path in ARGUMENTS[:2])
FOLDER = tempfile.TemporaryDirectory(prefix="starcontour-blender-")
if "bpy" not in sys.modules:
    os.environ["BLENDER_USER_RESOURCES"] = FOLDER.name  # a fresh profile; read when bpy is loaded
os.environ.pop("STARCONTOUR_LIBRARY", None)  # the library in the zip is what is tested

import bpy  # noqa: E402: reads the environment
import bmesh  # noqa: E402: is there after bpy
import numpy as np  # noqa: E402

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from character import LAST, make_character, new_object, only  # noqa: E402
sys.path = [path for path in sys.path if path != sys.path[0]]  # the add-on is there, too, unpacked

EXTENSIONS = bpy.app.version >= (4, 2, 0)
MODULE = ("bl_ext.user_default." if EXTENSIONS else "") + "starcontour_checks"
FRAMES = range(1, LAST + 1)


def addon(name=""):
    return sys.modules[MODULE + name]


def settings():
    return bpy.context.scene.starcontour


# ------------------------------------------------------------------------------------------------
# What Blender has


def evaluated(thing):
    """Positions, triangles and the face of each, as Blender has them in this frame."""
    bpy.context.view_layer.update()
    at = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = at.to_mesh()
    mesh.calc_loop_triangles()
    answer = ([tuple(vertex.co) for vertex in mesh.vertices],
              [tuple(triangle.vertices) for triangle in mesh.loop_triangles],
              [triangle.polygon_index for triangle in mesh.loop_triangles])
    at.to_mesh_clear()
    return answer


def world(thing, positions):
    """World coordinates in doubles, as the add-on says it makes them."""
    m = [list(row) for row in thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world]
    return [tuple(((m[i][3] + x * m[i][0]) + y * m[i][1]) + z * m[i][2] for i in range(3))
            for x, y, z in positions]


# ------------------------------------------------------------------------------------------------
# sc-query


def export(name, positions, triangles):
    """An OBJ file with decimals that stand for exactly these doubles."""
    path = Path(FOLDER.name) / (name + ".obj")
    lines = ["v %.17g %.17g %.17g" % tuple(one) for one in positions]
    lines += ["f %d %d %d" % tuple(corner + 1 for corner in one) for one in triangles]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def sc_query(*arguments):
    run = subprocess.run([SC_QUERY, *arguments], capture_output=True, text=True)
    if run.returncode not in (0, 1):
        raise AssertionError(f"sc-query {' '.join(arguments)}: {run.stderr}")
    return run.stdout


def pairs_by_sc_query(*arguments):
    """Pairs of triangles by file: a list of pairs for each path."""
    out = str(Path(FOLDER.name) / "pairs.csv")
    if os.path.exists(out):
        os.remove(out)
    sc_query(*arguments, "--only", "self-collisions", "--out", out)
    found = {}
    with open(out) as file:
        for row in csv.DictReader(file):
            found.setdefault(row["file"], []).append([int(row["triangle_a"]), int(row["triangle_b"])])
    return found


def pairs_by_addon(*things, **options):
    """The same by the add-on's own modules, as Meetings with lists of pairs."""
    operators, checks = addon(".operators"), addon(".checks")
    with operators.Work(bpy.context, things) as work:
        shots = work.read()
        found = checks.Checker([thing.name for thing in things], **options).check(shots)
    return [(one.a, one.b, one.pairs.tolist()) for one in found]


def attribute(thing, name):
    return [item.value for item in thing.data.attributes[name].data]


def group_weights(thing, name):
    number = thing.vertex_groups[name].index
    weights = [0.0] * len(thing.data.vertices)
    for vertex in thing.data.vertices:
        for entry in vertex.groups:
            if entry.group == number:
                weights[vertex.index] = entry.weight
    return weights


# ------------------------------------------------------------------------------------------------
# Contours


def contours_by_sc_query(positions, triangles):
    """Of each contour its points, and whether it is closed, in the order of their points."""
    answer = json.loads(sc_query("--trace", "--json", export("contours", positions, triangles)))
    return sorted(([tuple(node["point"]) for node in one["nodes"]], one["begin"] == "closed")
                  for one in answer["contours"])


def contours_shown():
    """The same of the curve that shows them."""
    splines = bpy.data.objects["Starcontour contours"].data.splines
    for spline in splines:
        assert spline.type == "POLY" and all(point.co[3] == 1 for point in spline.points)
    return sorted(([tuple(point.co[:3]) for point in spline.points], spline.use_cyclic_u) for spline in splines)


def rounded(lines):
    """As floats, which Blender stores."""
    return sorted(([tuple(float(np.float32(c)) for c in point) for point in points], closed)
                  for points, closed in lines)


def smaller_side(positions, triangles):
    """The vertices that the library's regions have on the smaller side of a contour."""
    model = addon(".starcontour").Model(np.array(positions, np.float32), np.array(triangles, np.uint32))
    regions = model.regions(np.array(positions, np.float32))
    small = set()
    for sides in regions.sides.reshape(-1, 2).tolist():
        areas = [regions.regions["area"][side] for side in sides]
        if areas[0] != areas[1]:
            small.add(sides[areas.index(min(areas))])
    return {vertex for vertex, region in enumerate(regions.vertex_regions.tolist()) if region in small}


def marked(thing):
    """The vertices that are marked: those of the group, which are those with a colour."""
    group = {vertex for vertex, weight in enumerate(group_weights(thing, "intersected_side")) if weight}
    colors = [tuple(item.color) for item in thing.data.color_attributes["intersected_regions"].data]
    assert len(colors) == len(thing.data.vertices)
    assert group == {vertex for vertex, color in enumerate(colors) if max(color[:3]) - min(color[:3]) > 0.2}
    return group


def rod_and_plate(through):
    """A square rod of closed rings, and a plate of quads that so many of them have gone through: vertices
    and faces of both."""
    rod, rod_faces = [], []
    for k in range(7):
        rod += [(x, y, 0.5 * k - 3.1 + 0.5 * through) for x, y in ((-.6, -.6), (.6, -.6), (.6, .6), (-.6, .6))]
    for k in range(6):
        rod_faces += [(4 * k + j, 4 * k + (j + 1) % 4, 4 * k + 4 + (j + 1) % 4, 4 * k + 4 + j) for j in range(4)]
    rod_faces += [(3, 2, 1, 0), (24, 25, 26, 27)]
    side = range(-8, 9)
    plate = [(0.25 * x, 0.25 * y, 0.003 * x) for y in side for x in side]
    plate_faces = [(17 * y + x, 17 * y + x + 1, 17 * y + x + 18, 17 * y + x + 17)
                   for y in range(16) for x in range(16)]
    return (rod, rod_faces), (plate, plate_faces)


# ------------------------------------------------------------------------------------------------


class Addon(unittest.TestCase):
    def setUp(self):
        for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.curves, bpy.data.armatures,
                     bpy.data.materials):
            for one in list(kind):
                kind.remove(one)
        bpy.context.scene.frame_set(1)
        bpy.context.scene.frame_start, bpy.context.scene.frame_end = FRAMES[0], FRAMES[-1]
        for name in settings().bl_rna.properties.keys():
            if name not in ("rna_type", "name"):
                settings().property_unset(name)

    def refused(self, operator, text, **options):
        """The operator says that it cannot do it, and why, without a traceback."""
        with self.assertRaises(RuntimeError) as caught:
            operator(**options)
        self.assertIn(text, str(caught.exception))
        self.assertNotIn("Traceback", str(caught.exception))

    def test_library_of_the_zip(self):
        package = addon(".starcontour")
        profile = bpy.utils.user_resource("EXTENSIONS" if EXTENSIONS else "SCRIPTS")
        self.assertTrue(package.__file__.startswith(profile), f"{package.__file__} is not in {profile}")
        self.assertIn("starcontour_checks-", package.lib._name)  # a copy of the one beside it
        self.assertTrue(hasattr(bpy.types, "STARCONTOUR_PT_panel"))

    def test_character_frame_by_frame(self):
        """Each frame: pairs, faces of the evaluated mesh, and faces and vertices of the own mesh."""
        thing = make_character()
        counts = []
        for frame in FRAMES:
            bpy.context.scene.frame_set(frame)
            positions, triangles, polygons = evaluated(thing)
            path = export("frame", positions, triangles)
            wanted = pairs_by_sc_query(path).get(path, [])
            counts.append(len(wanted))
            found = pairs_by_addon(thing)
            self.assertEqual(found, [(0, 0, wanted)] if wanted else [])

            self.assertEqual(bpy.ops.starcontour.check(), {"FINISHED"})
            faces = {polygons[triangle] for pair in wanted for triangle in pair}
            self.assertEqual(settings().pairs, len(wanted))
            self.assertEqual([(row.frame, row.pairs, row.faces) for row in settings().frames],
                             [(frame, len(wanted), len(faces))])
            # The first level of Catmull-Clark makes four faces of each quad, in their order.
            own = {face // 4 for face in faces}
            self.assertEqual(settings().faces, len(own))
            self.assertEqual({face for face, value in
                              enumerate(attribute(thing, "self_collision_frames")) if value}, own)
            corners = {corner for face in own for corner in thing.data.polygons[face].vertices}
            self.assertEqual([corner for corner, weight in enumerate(group_weights(thing, "self_collision"))
                              if weight], sorted(corners))
            overlay = bpy.data.objects["Starcontour contacts"]
            self.assertEqual(len(overlay.data.vertices), 10 * len(wanted))
        self.assertIn(0, counts)
        self.assertGreater(max(counts), 100)
        self.assertFalse([name for name in thing.data.attributes.keys() if "starcontour" in name])

    def test_range_of_frames(self):
        """The list of frames; weights as union and share; the frame of before; a jump."""
        thing = make_character()
        bpy.context.scene.frame_set(5)
        wanted, paths, masks = [], [], []
        for frame in FRAMES:
            bpy.context.scene.frame_set(frame)
            positions, triangles, polygons = evaluated(thing)
            paths.append(export(f"frame{frame}", positions, triangles))
        found = pairs_by_sc_query("--rest", paths[0], *paths)
        for frame, path in zip(FRAMES, paths):
            pairs = found.get(path, [])
            wanted.append((frame, len(pairs), len({polygons[triangle] for pair in pairs for triangle in pair})))
            own = {polygons[triangle] // 4 for pair in pairs for triangle in pair}
            masks.append([number in own for number in range(len(thing.data.polygons))])
        bpy.context.scene.frame_set(5)
        self.assertEqual(bpy.ops.starcontour.check_frames(), {"FINISHED"})
        self.assertEqual(bpy.context.scene.frame_current, 5)
        self.assertEqual([(row.frame, row.pairs, row.faces) for row in settings().frames], wanted)
        self.assertEqual(settings().colliding_frames, sum(row[1] > 0 for row in wanted))
        self.assertEqual(attribute(thing, "self_collision_frames"), [sum(column) for column in zip(*masks)])
        union = group_weights(thing, "self_collision")
        self.assertEqual(set(union), {0.0, 1.0})

        settings().weights = "SHARE"
        bpy.ops.starcontour.check_frames()
        shares = [0] * len(thing.data.vertices)
        for mask in masks:
            for corner in {corner for face, hit in enumerate(mask) if hit
                           for corner in thing.data.polygons[face].vertices}:
                shares[corner] += 1
        for given, share, one in zip(group_weights(thing, "self_collision"), shares, union):
            self.assertAlmostEqual(given, share / len(FRAMES), 6)
            self.assertEqual(one, float(share > 0))

        worst = max(range(len(wanted)), key=lambda k: wanted[k][1])
        settings().active_frame = worst  # a click on a row
        self.assertEqual(bpy.context.scene.frame_current, wanted[worst][0])
        overlay = bpy.data.objects["Starcontour contacts"]
        self.assertEqual(len(overlay.data.vertices), 10 * wanted[worst][1])
        bpy.ops.starcontour.jump(frame=1)
        self.assertEqual((bpy.context.scene.frame_current, len(overlay.data.vertices)), (1, 0))

        settings().own_range, settings().first, settings().last, settings().step = True, 3, 20, 4
        bpy.ops.starcontour.check_frames()
        self.assertEqual([row.frame for row in settings().frames], [3, 7, 11, 15, 19])
        settings().last = 2
        self.refused(bpy.ops.starcontour.check_frames, "there is no frame from 3 to 2")

    def test_contacts_lie_on_the_surface(self):
        """The overlay is in world coordinates, where the two triangles of each pair are."""
        thing = make_character()
        bpy.context.scene.frame_set(12)
        settings().overlay_radius = 1e-4
        bpy.ops.starcontour.check()
        positions, triangles, _ = evaluated(thing)
        at = np.array(world(thing, positions))
        corners = np.array([tuple(vertex.co) for vertex in
                            bpy.data.objects["Starcontour contacts"].data.vertices]).reshape(-1, 10, 3)
        ends = np.stack([corners[:, 1:5].mean(1), corners[:, 5:9].mean(1)], 1)
        pairs = np.array(pairs_by_addon(thing)[0][2])
        for side in (0, 1):
            a, b, c = (at[np.array(triangles)[pairs[:, side], k]][:, None] for k in range(3))
            normal = np.cross(b - a, c - a)
            normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
            self.assertLess(np.abs(((ends - a) * normal).sum(-1)).max(), 1e-5)
            low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
            self.assertTrue(((ends > low - 1e-5) & (ends < high + 1e-5)).all())

    def test_contours_frame_by_frame(self):
        """Of the character: points, closed ones, and what is marked, by a modifier and without."""
        thing = make_character(levels=0)
        counts = []
        for frame in (1, 6, 12, 17):
            bpy.context.scene.frame_set(frame)
            positions, triangles, _ = evaluated(thing)
            wanted = contours_by_sc_query(positions, triangles)
            self.assertEqual(bpy.ops.starcontour.contours(), {"FINISHED"})
            self.assertEqual(contours_shown(), rounded((world(thing, points), closed) for points, closed in wanted))
            self.assertEqual((settings().contours, settings().closed), (len(wanted), sum(one[1] for one in wanted)))
            counts.append(settings().contours)
            self.assertEqual(marked(thing), smaller_side(positions, triangles))
            self.assertEqual(settings().marked, len(marked(thing)))
        self.assertEqual(counts[0], 0)
        self.assertGreater(max(counts), 2)
        self.assertGreater(settings().marked, 10)

        thing.modifiers.new("Smooth", "SUBSURF").levels = 1
        positions, triangles, polygons = evaluated(thing)
        bpy.ops.starcontour.contours()
        self.assertEqual(contours_shown(), rounded((world(thing, points), closed) for points, closed in
                                                   contours_by_sc_query(positions, triangles)))
        small = smaller_side(positions, triangles)
        faces = {polygons[number] // 4 for number, corners in enumerate(triangles) if small & set(corners)}
        self.assertEqual(marked(thing), {corner for face in faces for corner in thing.data.polygons[face].vertices})
        self.assertFalse([name for name in thing.data.attributes.keys() if "starcontour" in name])

    def test_contours_in_a_range_of_frames(self):
        """Weights as union and share; contours and colours of the frame of before."""
        thing = make_character(levels=0)
        small = {}
        for frame in FRAMES[::3]:
            bpy.context.scene.frame_set(frame)
            small[frame] = smaller_side(*evaluated(thing)[:2])
        bpy.context.scene.frame_set(11)
        positions, triangles, _ = evaluated(thing)
        settings().step = 3
        for weights in ("UNION", "SHARE"):
            settings().weights = weights
            self.assertEqual(bpy.ops.starcontour.contours_frames(), {"FINISHED"})
            self.assertEqual(bpy.context.scene.frame_current, 11)
            for vertex, weight in enumerate(group_weights(thing, "intersected_side")):
                share = sum(vertex in one for one in small.values()) / len(small)
                self.assertAlmostEqual(weight, float(share > 0) if weights == "UNION" else share, 6)
            self.assertEqual(contours_shown(), rounded((world(thing, points), closed) for points, closed in
                                                       contours_by_sc_query(positions, triangles)))
            self.assertEqual((settings().traced_frames, settings().contour_frames),
                             (8, sum(len(one) > 0 for one in small.values())))
            self.assertEqual(settings().marked, len(set().union(*small.values())))
        self.assertEqual({vertex for vertex, item in
                          enumerate(thing.data.color_attributes["intersected_regions"].data)
                          if max(item.color[:3]) - min(item.color[:3]) > 0.2}, smaller_side(positions, triangles))
        self.assertIn(set(), small.values())
        settings().own_range, settings().first, settings().last = True, 3, 2
        self.refused(bpy.ops.starcontour.contours_frames, "there is no frame from 3 to 2")
        new_object("Broken", [(0, 0, 0), (1, 0, 0), (0, 1, math.nan)], [range(3)])
        settings().last = 5
        self.refused(bpy.ops.starcontour.contours_frames, "frame 3: Broken: vertex 2 is NaN or infinite")
        self.assertEqual(bpy.context.scene.frame_current, 11)

    def test_contours_of_one_mesh_and_of_two(self):
        """A rod through a plate, whose ends above it and what of the plate is in the rod are known."""
        for through, ends in ((1, {24, 25, 26, 27}), (2, set(range(20, 28)))):
            (rod, rod_faces), (plate, plate_faces) = rod_and_plate(through)
            inside = {k for k, (x, y, _) in enumerate(plate) if abs(x) < 0.6 and abs(y) < 0.6}
            self.assertEqual({k for k, corner in enumerate(rod) if corner[2] > 0}, ends)
            both = new_object("Both", rod + plate, rod_faces + [[len(rod) + corner for corner in face]
                                                                for face in plate_faces])
            bpy.ops.starcontour.contours()
            self.assertEqual((settings().contours, settings().closed), (1, 1))
            self.assertEqual(marked(both), ends | {len(rod) + k for k in inside})
            colors = {tuple(item.color) for item in both.data.color_attributes["intersected_regions"].data}
            self.assertEqual(len(colors), 3)  # of two regions, and of what is in none
            self.assertEqual(both.data.attributes.active_color.name, "intersected_regions")

            things = [new_object("Rod", rod, rod_faces), new_object("Plate", plate, plate_faces)]
            for thing in things:
                thing.location, thing.rotation_euler = (3.1, -2.2, 0.7), (0.3, 0.2, 0.1)
            only(*things)
            settings().itself = False
            bpy.ops.starcontour.contours()
            self.assertEqual((settings().contours, settings().closed), (1, 1))
            self.assertEqual([marked(thing) for thing in things], [ends, inside])
            settings().itself, settings().between = True, False
            bpy.ops.starcontour.contours()
            self.assertEqual(settings().contours, 0)
            self.assertEqual([marked(thing) for thing in things], [set(), set()])
            settings().between = True

    def test_contours_at_seams(self):
        """Faces of a rod that have vertices of their own, and one between vertices at one position: joined,
        there is a closed contour. Not joined, there is one for each side of the rod."""
        (rod, rod_faces), (plate, plate_faces) = rod_and_plate(1)
        split = [rod[corner] for face in rod_faces for corner in face]
        faces = [range(4 * k, 4 * k + 4) for k in range(len(rod_faces))] + [(len(split), len(split) + 1, 0)]
        split += [split[0], split[1]]
        things = [new_object("Rod", split, faces), new_object("Plate", plate, plate_faces)]
        both = new_object("Both", split + plate, faces + [[len(split) + corner for corner in face]
                                                          for face in plate_faces])
        for some in ([both], things):
            only(*some)
            settings().weld = True
            bpy.ops.starcontour.contours()
            self.assertEqual((settings().contours, settings().closed), (1, 1))
            above = {k for k, corner in enumerate(split) if corner[2] > 0}
            self.assertEqual({k for k in marked(some[0]) if k < len(split)}, above)
            self.assertEqual(settings().marked, len(above) + 25)
        settings().weld, settings().itself = False, False
        bpy.ops.starcontour.contours()
        self.assertEqual((settings().contours, settings().closed), (4, 0))
        lower = {k for k in range(80, 96) if split[k][2] < 0}  # the smaller parts of the uppermost faces
        self.assertEqual((marked(things[0]), len(lower)), (lower, 8))

    def test_contours_of_objects_that_share_a_mesh(self):
        """Linked duplicates: a vertex is marked if it is in one of them."""
        (rod, rod_faces), (plate, plate_faces) = rod_and_plate(2)
        first = new_object("First", rod, rod_faces)
        second = bpy.data.objects.new("Second", first.data)
        bpy.context.collection.objects.link(second)
        second.location = (5, 0, -0.5)
        third = bpy.data.objects.new("Third", first.data)
        bpy.context.collection.objects.link(third)
        third.location = (-5, 0, 0)
        away = new_object("Away", [(x + 5, y, z) for x, y, z in plate], plate_faces)
        only(first, second, third, away)
        bpy.ops.starcontour.contours()
        self.assertEqual((settings().contours, settings().marked), (1, 4 + 25))
        for thing in (first, second, third):
            self.assertEqual(marked(thing), {24, 25, 26, 27})

    def test_contours_within_contours(self):
        """A plate that a rod of the same mesh goes through, and round it a rod of another object: each part
        has a colour of its own, that of the mesh's contours with itself where there are two."""
        (rod, rod_faces), (plate, plate_faces) = rod_and_plate(2)
        both = new_object("Both", rod + plate, rod_faces + [[len(rod) + corner for corner in face]
                                                            for face in plate_faces])
        paint = both.data.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
        both.data.attributes.active_color = paint
        wide = new_object("Wide", [(2 * x, 2 * y, 1.5 * z) for x, y, z in rod], rod_faces)
        only(both, wide)
        bpy.ops.starcontour.contours()
        self.assertEqual((settings().contours, settings().closed), (2, 2))
        colors = [tuple(item.color) for item in both.data.color_attributes["intersected_regions"].data]
        of_wide = [tuple(item.color) for item in wide.data.color_attributes["intersected_regions"].data]
        parts = {}
        for corner, color in zip(rod + plate, colors):
            reach = max(abs(corner[0]), abs(corner[1]))
            part = ("above" if corner[2] > 0 else "below") if reach == 0.6 else \
                "in" if reach < 0.6 else "between" if reach < 1.2 else "out"
            parts.setdefault(part, set()).add(color)
        self.assertEqual({part: len(some) for part, some in parts.items()},
                         {"above": 1, "below": 1, "in": 1, "between": 1, "out": 1})
        self.assertEqual(parts["below"], parts["out"])
        self.assertEqual(len(set(colors)), 4)
        self.assertEqual(len(set(colors) | set(of_wide)), 5)
        self.assertEqual(both.data.attributes.active_color.name, "intersected_regions")
        self.assertEqual(len(marked(both)), 8 + 81)
        bpy.ops.starcontour.clear()
        self.assertEqual(both.data.color_attributes.keys(), ["Paint"])

    def test_contours_and_modifiers(self):
        """Vertices in another order than those of the own mesh; and faces that come from no own face."""
        (rod, rod_faces), (plate, plate_faces) = rod_and_plate(1)
        thing, other = new_object("Rod", rod, rod_faces), new_object("Plate", plate, plate_faces)
        build = thing.modifiers.new("In some order", "BUILD")
        build.use_random_order, build.frame_start, build.frame_duration = True, -9, 1
        only(thing, other)
        bpy.ops.starcontour.contours()
        positions = evaluated(thing)[0]
        self.assertEqual(len(positions), len(rod))
        self.assertNotEqual(rounded([(positions, 0)]), rounded([(rod, 0)]))
        self.assertEqual(marked(thing), set(range(20, 28)))  # all vertices of faces that have one above
        thing.modifiers.clear()
        remesh = thing.modifiers.new("Other faces", "REMESH")
        remesh.mode, remesh.octree_depth = "BLOCKS", 4
        bpy.ops.starcontour.contours()
        self.assertGreater(settings().contours, 0)
        self.assertEqual(marked(thing), set())
        self.assertGreater(len(marked(other)), 0)

    def test_contours_of_several_objects(self):
        """The character, which goes through itself and through a plane, and an object without faces."""
        ball = make_character(levels=0)
        bpy.context.scene.frame_set(12)
        other = new_object("Plane", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [range(4)])
        other.location, other.rotation_euler, other.scale = (3.1, -2.2, 0.7), (0.3, 0.2, 0.1), (1, 2, 3)
        points = new_object("Points", [(0, 0, 0)], [])
        only(ball, points, other)
        bpy.context.view_layer.update()
        at, triangles, _ = evaluated(ball)
        own = rounded((world(ball, points), closed) for points, closed in contours_by_sc_query(at, triangles))
        joined, count = world(ball, at), len(triangles)
        positions, more, _ = evaluated(other)
        triangles += [tuple(corner + len(joined) for corner in one) for one in more]
        joined += world(other, positions)
        answer = json.loads(sc_query("--trace", "--json", export("joined", joined, triangles)))
        between = []
        for one in answer["contours"]:
            kinds = {(node["edge"] // 3 < count) != (node["triangle"] < count) for node in one["nodes"]}
            self.assertEqual(len(kinds), 1)
            if True in kinds:
                between.append(([tuple(node["point"]) for node in one["nodes"]], one["begin"] == "closed"))
        self.assertGreater(min(len(own), len(between)), 0)
        bpy.ops.starcontour.contours()
        self.assertEqual(contours_shown(), sorted(own + rounded(between)))
        settings().itself = False
        bpy.ops.starcontour.contours()
        self.assertEqual(contours_shown(), rounded(between))
        settings().weld = False
        bpy.ops.starcontour.contours()
        self.assertEqual(contours_shown(), rounded(between))

    def test_contours_that_are_not_closed(self):
        """They are not cyclic, and where they divide nothing, nothing is marked. A second click takes the
        first curve's place; so does a jump to a frame, and clearing takes all of it away."""
        thing = new_object("Two", [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1), (2, 1, 1), (1, 2, -1)],
                           [range(3), range(3, 6)])
        bpy.ops.starcontour.contours()
        curve = bpy.data.objects["Starcontour contours"]
        self.assertEqual(contours_shown(), [([(1.5, 1.5, 0), (1, 1.5, 0)], False)])
        self.assertEqual((settings().contours, settings().closed), (1, 0))
        self.assertIn(curve.name, bpy.context.scene.collection.all_objects)
        self.assertEqual(marked(thing), {5})
        with addon(".operators").Work(bpy.context, [thing]) as work:
            found = addon(".contours").Tracer(["Two"]).trace(work.read())
        self.assertEqual((len(found.lines), found.regions, found.undecided), (1, 1, 1))

        thing.shape_key_add(name="Basis")
        key = thing.shape_key_add(name="Away")
        for number in range(3):
            key.data[number].co.z = -9
        for frame, value in ((1, 0.0), (24, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
        bpy.ops.starcontour.jump(frame=24)
        self.assertEqual(contours_shown(), [])
        bpy.ops.starcontour.jump(frame=1)
        self.assertEqual(len(contours_shown()), 1)
        bpy.context.scene.frame_set(24)
        only(thing)
        bpy.ops.starcontour.contours()
        self.assertEqual(contours_shown(), [])
        self.assertEqual([one.name for one in bpy.data.objects if one.type == "CURVE"], ["Starcontour contours"])
        self.assertEqual([one.name for one in bpy.data.curves], ["Starcontour contours"])
        self.assertEqual([one.name for one in bpy.data.materials], ["Starcontour contours"])
        self.assertEqual((marked(thing), len(settings().traced)), (set(), 1))

        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.starcontour.contours()
        self.assertEqual(thing.mode, "EDIT")
        bpy.ops.starcontour.clear()
        self.assertEqual((len(bpy.data.curves), len(bpy.data.materials), len(bpy.data.objects)), (0, 0, 1))
        self.assertNotIn("intersected_regions", thing.data.attributes)
        self.assertNotIn("intersected_side", thing.vertex_groups)
        self.assertEqual((settings().contours, len(settings().traced)), (-1, 0))

    def test_contours_that_cannot_be_traced(self):
        """Nothing is left behind, and what was there stays."""
        good = new_object("Good", [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1), (2, 1, 1), (1, 2, -1)],
                          [range(3), range(3, 6)])
        broken = new_object("Broken", [(0, 0, 0), (1, 0, 0), (0, 1, math.nan), (0, 0, 1)], [range(3), (0, 1, 3)])
        for itself in (True, False):
            settings().itself = itself
            only(good, broken)
            self.refused(bpy.ops.starcontour.contours, "Broken: vertex 2 is NaN or infinite")
            self.assertEqual((len(bpy.data.curves), len(bpy.data.materials), len(bpy.data.objects)), (0, 0, 2))
            for thing in (good, broken):
                self.assertEqual(len(thing.vertex_groups), 0)
                self.assertEqual(len(thing.data.color_attributes), 0)
                self.assertFalse([name for name in thing.data.attributes.keys() if "starcontour" in name])
            self.assertEqual(settings().contours, -1)
        settings().itself = True
        only(good)
        bpy.ops.starcontour.contours()
        before = contours_shown()
        self.assertEqual(len(before), 1)
        only(broken)
        self.refused(bpy.ops.starcontour.contours, "vertex 2 is NaN or infinite")
        self.assertEqual((contours_shown(), len(bpy.data.curves)), (before, 1))
        good.location = (math.nan, 0, 0)
        only(good)
        self.refused(bpy.ops.starcontour.contours, "Good: its place in the world is NaN or infinite")
        self.assertEqual((contours_shown(), len(bpy.data.curves)), (before, 1))
        good.location = (0, 0, 0)
        bpy.ops.starcontour.clear()
        new_object("Starcontour contours", [(0, 0, 0)], [])
        only(good)
        self.refused(bpy.ops.starcontour.contours, "rename it")
        bpy.ops.starcontour.clear()
        self.assertIn("Starcontour contours", bpy.data.objects)
        new_object("Empty", [], [])
        self.assertEqual(bpy.ops.starcontour.check(), {"FINISHED"})
        bpy.data.objects["Starcontour contours"].name = "Other"
        self.assertEqual(bpy.ops.starcontour.contours(), {"FINISHED"})
        self.assertEqual(contours_shown(), [])

    def test_polygons(self):
        """A concave face of eight corners, and one through it."""
        star = [(math.cos(k * math.pi / 4) * (2 if k % 2 else 1), math.sin(k * math.pi / 4) * (2 if k % 2 else 1),
                 0.01 * k) for k in range(8)]
        thing = new_object("Polygons", star + [(0, 0, -1), (1, 1, -1), (1, 1, 1), (0, 0, 1)] +
                           [(5, 0, 0), (6, 0, 0), (6, 1, 0), (5, 1, 0)], [range(8), range(8, 12), range(12, 16)])
        positions, triangles, polygons = evaluated(thing)
        path = export("polygons", positions, triangles)
        wanted = pairs_by_sc_query(path)[path]
        self.assertEqual(pairs_by_addon(thing), [(0, 0, wanted)])
        self.assertEqual(polygons.count(0), 6)
        bpy.ops.starcontour.check()
        self.assertEqual((settings().pairs, settings().faces), (len(wanted), 2))
        self.assertEqual(attribute(thing, "self_collision_frames"), [1, 1, 0])
        self.assertEqual(bpy.ops.starcontour.select(), {"FINISHED"})
        self.assertEqual(thing.mode, "EDIT")
        edited = bmesh.from_edit_mesh(thing.data)
        for edge in edited.edges:
            self.assertEqual(edge.select, any(face.index < 2 for face in edge.link_faces))
        bpy.ops.object.mode_set(mode="OBJECT")
        self.assertEqual([face.select for face in thing.data.polygons], [True, True, False])
        self.assertEqual([vertex.select for vertex in thing.data.vertices], [True] * 12 + [False] * 4)

    def test_coplanar_and_touching_faces(self):
        """What overlaps in a plane, or touches in a point, collides, but does not cross."""
        quad = [(0, 0), (2, 0), (2, 2), (0, 2)]
        thing = new_object("Flat", [(x, y, 0) for x, y in quad] + [(x + 1, y + 1, 0) for x, y in quad] +
                           [(0, 0, 0.5), (-1, 0, 0.5), (0, 1, 0)] + [(9, 9, 9), (9, 8, 9), (8, 9, 9)],
                           [range(4), range(4, 8), range(8, 11), range(11, 14)])
        positions, triangles, _ = evaluated(thing)
        path = export("flat", positions, triangles)
        self.assertEqual(pairs_by_addon(thing), [(0, 0, pairs_by_sc_query(path)[path])])
        bpy.ops.starcontour.check()
        self.assertEqual(attribute(thing, "self_collision_frames"), [1, 1, 1, 0])
        settings().contact = "PROPER"
        bpy.ops.starcontour.check()
        self.assertEqual((settings().pairs, settings().faces), (0, 0))
        self.assertEqual(set(group_weights(thing, "self_collision")), {0.0})

    def test_seams(self):
        """Two quads with vertices of their own along a common side: joined, or touching."""
        thing = new_object("Seam", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (1, 0, 0), (2, 0, 1), (2, 1, 1),
                                    (1, 1, 0)], [range(4), range(4, 8)])
        bpy.ops.starcontour.check()
        self.assertEqual(settings().pairs, 0)
        settings().weld = False
        bpy.ops.starcontour.check()
        positions, triangles, _ = evaluated(thing)
        path = export("seam", positions, triangles)
        self.assertEqual(settings().pairs, len(pairs_by_sc_query("--weld", "none", path)[path]))
        self.assertEqual(settings().faces, 2)

    def test_several_objects(self):
        """Two objects that are turned and scaled and one apart, and one without faces: pairs with each
        other in world coordinates, with themselves in local ones."""
        ball = make_character(levels=0)
        bpy.context.scene.frame_set(12)
        other = new_object("Plane", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0), (0, 0, 1), (1, 0, -1),
                                     (0, 1, -1)], [range(4), range(4, 7)])
        other.location, other.rotation_euler, other.scale = (3.1, -2.2, 0.7), (0.3, 0.2, 0.1), (1, 2, 3)
        away = new_object("Away", [(50, 0, 0), (51, 0, 0), (50, 1, 0)], [range(3)])
        points = new_object("Points", [(0, 0, 0)], [])
        things = [points, ball, other, away]
        only(*things)
        bpy.context.view_layer.update()
        joined, faces, firsts, local = [], [], [], []
        for thing in things:
            positions, triangles, _ = evaluated(thing)
            firsts.append(len(faces))
            local.append((positions, triangles))
            faces += [tuple(corner + len(joined) for corner in triangle) for triangle in triangles]
            joined += world(thing, positions)
        path = export("joined", joined, faces)
        wanted = []
        for number, (positions, triangles) in enumerate(local):
            if triangles:
                own = export("own", positions, triangles)
                wanted += [(number, number, pairs_by_sc_query(own).get(own, []))]
        ends = firsts[1:] + [len(faces)]

        def owner(triangle):
            return next(k for k, end in enumerate(ends) if triangle < end)

        between = {}
        for a, b in pairs_by_sc_query(path)[path]:
            if owner(a) != owner(b):
                between.setdefault((owner(a), owner(b)), []).append([a - firsts[owner(a)], b - firsts[owner(b)]])
        wanted = sorted([one for one in wanted if one[2]] + [(*key, pairs) for key, pairs in between.items()])
        self.assertEqual([one[:2] for one in wanted], [(1, 1), (1, 2), (2, 2)])
        self.assertEqual(pairs_by_addon(*things), wanted)
        bpy.ops.starcontour.check()
        self.assertEqual(settings().pairs, sum(len(one[2]) for one in wanted))
        self.assertEqual(attribute(other, "self_collision_frames"), [1, 1])
        self.assertEqual(attribute(away, "self_collision_frames"), [0])
        self.assertEqual(len(bpy.data.objects["Starcontour contacts"].data.vertices), 10 * settings().pairs)
        settings().itself = False
        bpy.ops.starcontour.check()
        self.assertEqual(settings().pairs, len(wanted[1][2]))
        settings().itself, settings().between = True, False
        bpy.ops.starcontour.check()
        self.assertEqual(settings().pairs, len(wanted[0][2]) + len(wanted[2][2]))

    def test_objects_that_share_a_mesh(self):
        """Linked duplicates: a face collides if it does in one of them."""
        first = new_object("First", [(0, 0, 0), (2, 0, 0), (0, 2, 0), (5, 5, 5), (6, 5, 5), (5, 6, 5)],
                           [range(3), range(3, 6)])
        second = bpy.data.objects.new("Second", first.data)
        bpy.context.collection.objects.link(second)
        second.rotation_euler, second.location = (math.pi / 2, 0, 0), (0.2, 0.5, -0.5)
        only(first, second)
        bpy.ops.starcontour.check()
        self.assertEqual((settings().pairs, settings().faces), (1, 1))
        self.assertEqual(attribute(first, "self_collision_frames"), [1, 0])

    def test_thickness(self):
        """The least distances of faces, of the posed character and of one that was moved and scaled."""
        thing = make_character()
        bpy.context.scene.frame_set(10)
        for distance in (0.1, 0.22, 0.33):
            positions, triangles, polygons = evaluated(thing)
            at = world(thing, positions)
            path = export("thick", at, triangles)
            answer = json.loads(sc_query("--near", repr(float(np.float32(distance))), "--thickness", "--json", path))
            by_triangle = answer["thickness"]["faces"]
            own = [math.inf] * len(thing.data.polygons)
            for polygon, value in zip(polygons, by_triangle):
                if value is not None:
                    own[polygon // 4] = min(own[polygon // 4], value)
            settings().distance = distance
            self.assertEqual(bpy.ops.starcontour.thickness(), {"FINISHED"})
            found = attribute(thing, "thickness")
            self.assertEqual([math.isinf(value) for value in found], [math.isinf(value) for value in own])
            for value, right in zip(found, own):
                if not math.isinf(right):
                    self.assertAlmostEqual(value, right, delta=2e-7 * distance)
            thin = {face for face, value in enumerate(own) if not math.isinf(value)}
            self.assertEqual(settings().thin, len(thin))
            corners = {corner for face in thin for corner in thing.data.polygons[face].vertices}
            self.assertEqual([vertex for vertex, weight in enumerate(group_weights(thing, "thin")) if weight],
                             sorted(corners))
        self.assertGreater(len(thin), 50)
        self.assertLess(len(thin), len(own))
        bpy.ops.starcontour.select(what="THIN")
        bpy.ops.object.mode_set(mode="OBJECT")
        self.assertEqual({face.index for face in thing.data.polygons if face.select}, thin)
        settings().distance = 0
        self.refused(bpy.ops.starcontour.thickness, "must be more than 0")

    def test_meshes_that_cannot_be_checked(self):
        thing = new_object("Broken", [(0, 0, 0), (1, 0, 0), (0, 1, math.nan), (0, 0, 1)], [range(3), (0, 1, 3)])
        self.refused(bpy.ops.starcontour.check, "Broken: vertex 2 is NaN or infinite")
        self.refused(bpy.ops.starcontour.check_frames, "frame 1: Broken: vertex 2 is NaN or infinite")
        self.refused(bpy.ops.starcontour.thickness, "Broken: vertex 2 is NaN or infinite")
        self.assertFalse([name for name in thing.data.attributes.keys() if "starcontour" in name])
        new_object("Points", [(0, 0, 0), (1, 0, 0)], [])
        self.assertEqual(bpy.ops.starcontour.check(), {"FINISHED"})
        self.assertEqual(bpy.ops.starcontour.thickness(), {"FINISHED"})
        self.assertEqual((settings().pairs, settings().thin), (0, 0))
        new_object("Empty", [], [])
        self.assertEqual(bpy.ops.starcontour.check(), {"FINISHED"})
        flat = new_object("Flat", [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, 0)], [range(3), (0, 1, 3)])
        self.assertEqual(bpy.ops.starcontour.check(), {"FINISHED"})
        positions, triangles, _ = evaluated(flat)
        path = export("degenerate", positions, triangles)
        self.assertEqual(settings().pairs, len(pairs_by_sc_query(path).get(path, [])))
        for other in bpy.context.view_layer.objects:
            other.select_set(False)
        bpy.context.view_layer.objects.active = None
        self.refused(bpy.ops.starcontour.check, "no mesh object is selected")
        only(thing)
        self.refused(bpy.ops.starcontour.select, "nothing was searched for")

    def test_modifiers(self):
        """Faces that a modifier makes are of the face that they come from; those of another mesh, or made
        of the shape alone, are of none, and are counted nevertheless."""
        box = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        thing = new_object("Box", box, faces)
        array = thing.modifiers.new("Twice", "ARRAY")
        array.use_relative_offset, array.use_constant_offset = False, True
        array.constant_offset_displace = (0.5, 0.25, 0.125)
        bpy.ops.starcontour.check()
        positions, triangles, polygons = evaluated(thing)
        path = export("box", positions, triangles)
        wanted = pairs_by_sc_query(path)[path]
        own = {polygons[triangle] % 6 for pair in wanted for triangle in pair}
        self.assertEqual(settings().pairs, len(wanted))
        self.assertEqual({face for face, value in enumerate(attribute(thing, "self_collision_frames")) if value}, own)

        thing.modifiers.clear()
        remesh = thing.modifiers.new("Other faces", "REMESH")
        remesh.mode, remesh.octree_depth = "BLOCKS", 3
        array = thing.modifiers.new("Twice", "ARRAY")
        array.use_relative_offset, array.use_constant_offset = False, True
        array.constant_offset_displace = (0.51, 0.26, 0.127)
        bpy.ops.starcontour.check()
        positions, triangles, _ = evaluated(thing)
        path = export("remeshed", positions, triangles)
        self.assertEqual(settings().pairs, len(pairs_by_sc_query(path)[path]))
        self.assertEqual(attribute(thing, "self_collision_frames"), [0] * 6)

    def test_boolean(self):
        """Faces of another mesh that a modifier joins are of none of the own ones, also if that mesh is
        checked as well. Copies of the own box do not meet, those of the other do."""
        box = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        other = new_object("Other", box, faces)
        thing = new_object("Box", [[c / 10 - 3 for c in corner] for corner in box], faces)
        join = thing.modifiers.new("Join", "BOOLEAN")
        join.operation, join.object = "UNION", other
        array = thing.modifiers.new("Twice", "ARRAY")
        array.use_relative_offset, array.use_constant_offset = False, True
        array.constant_offset_displace = (0.5, 0.25, 0.125)
        settings().between = False
        only(other, thing)
        bpy.ops.starcontour.check()
        positions, triangles, _ = evaluated(thing)
        path = export("boolean", positions, triangles)
        self.assertEqual(settings().pairs, len(pairs_by_sc_query(path)[path]))
        for one in (other, thing):
            self.assertEqual(attribute(one, "self_collision_frames"), [0] * 6)

    def test_faces_that_bend(self):
        """A quad that Blender cuts along another diagonal when a shape key bends it: triangles change
        from frame to frame, and each frame is checked by its own."""
        thing = new_object("Bent", [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0.5, 0.7, -1), (0.7, 0.5, -1),
                                    (0.6, 0.6, 1)], [range(4), range(4, 7)])
        thing.shape_key_add(name="Basis")
        key = thing.shape_key_add(name="Dent")
        key.data[1].co = (0.5, 1.4, 0)
        for frame, value in ((1, 0.0), (24, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
        wanted, kinds = [], set()
        for frame in FRAMES:
            bpy.context.scene.frame_set(frame)
            positions, triangles, _ = evaluated(thing)
            kinds.add(tuple(triangles))
            path = export("bent", positions, triangles)
            wanted.append(len(pairs_by_sc_query(path).get(path, [])))
        self.assertEqual(len(kinds), 2)
        self.assertGreater(len(set(wanted)), 1)
        bpy.ops.starcontour.check_frames()
        self.assertEqual([row.pairs for row in settings().frames], wanted)

    def test_edit_mode(self):
        """A check from edit mode sees what was edited, and goes back."""
        thing = new_object("Edited", [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1), (2, 1, 1), (1, 2, 1)],
                           [range(3), range(3, 6)])
        bpy.ops.object.mode_set(mode="EDIT")
        mesh = bmesh.from_edit_mesh(thing.data)
        mesh.verts.ensure_lookup_table()
        mesh.verts[3].co.z = -1
        bmesh.update_edit_mesh(thing.data)
        bpy.ops.starcontour.check()
        self.assertEqual((thing.mode, settings().pairs), ("EDIT", 1))
        bpy.ops.starcontour.select()
        self.assertEqual(thing.mode, "EDIT")
        bpy.ops.starcontour.clear()
        self.assertEqual(settings().state, "NONE")
        self.assertNotIn("self_collision_frames", thing.data.attributes)
        self.assertNotIn("self_collision", thing.vertex_groups)
        self.assertNotIn("Starcontour contacts", bpy.data.objects)

    def test_zz_disable_and_enable(self):
        """After all others, as it takes the add-on away."""
        import addon_utils
        addon_utils.disable(MODULE)
        self.assertFalse(hasattr(bpy.types.Scene, "starcontour"))
        self.assertFalse(hasattr(bpy.types, "STARCONTOUR_PT_panel"))
        self.assertIsNotNone(addon_utils.enable(MODULE))
        self.assertTrue(hasattr(bpy.types, "STARCONTOUR_PT_panel"))
        new_object("One", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [range(3)])
        self.assertEqual(bpy.ops.starcontour.check(), {"FINISHED"})

    def test_zz_install_again(self):
        """While its library is loaded and in use."""
        thing = make_character()
        bpy.context.scene.frame_set(12)
        bpy.ops.starcontour.check()
        pairs, before = settings().pairs, addon(".checks")
        checker = before.Checker(["kept"])
        with addon(".operators").Work(bpy.context, [thing]) as work:
            shots = work.read()
        install()
        self.assertIsNot(addon(".checks"), before)
        bpy.ops.starcontour.check()
        self.assertEqual(settings().pairs, pairs)
        self.assertEqual([len(one.pairs) for one in checker.check(shots)], [pairs])


def install():
    if EXTENSIONS:
        bpy.ops.extensions.package_install_files(filepath=ZIP, repo="user_default", enable_on_install=True)
    else:
        bpy.ops.preferences.addon_install(filepath=ZIP)
        bpy.ops.preferences.addon_enable(module=MODULE)


def main():
    with zipfile.ZipFile(ZIP) as archive:
        assert archive.testzip() is None
    install()
    if MODULE not in sys.modules:
        sys.exit(f"{ZIP} could not be installed")
    names = [f"Addon.{name}" for name in ARGUMENTS[2:]] or None
    unittest.main(argv=sys.argv[:1], defaultTest=names)


if __name__ == "__main__":
    main()
