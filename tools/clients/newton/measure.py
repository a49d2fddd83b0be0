"""What newton's detector of self-contacts loses, what that does to the cloth, and how long both detectors take.

    python measure.py twist|shirt DRIVER [--frames N] [--speed S] [--thickness T] [--save FILE.npz]
    python measure.py twist|shirt times --poses FILE.npz

DRIVER is whose contacts the solver gets: `ours`, or newton's with rows `default` or `short`, see below. The other
detector is asked about the same positions in the first substep of each frame, by turns before and after;
these substeps are the ones whose times are printed.

twist  newton.examples.cloth_twist as it is; --speed 3 turns the ends three times as fast,
       --thickness 3 makes margin and gap three times as large
shirt  the shirt of newton.examples.cloth_franka, with the parameters it has there, on a body of capsules

A line a frame: pairs of triangles that intersect (starcontour's count), pairs that were found, those that do
not fit into rows of either length, the longest rows, milliseconds of processor time of newton's
detector and of ours. Both run in one thread.

times  asks both about each pose that was saved, nine times by turns, and prints the least milliseconds of each,
       and of the search of the library in ours

SPDX-License-Identifier: MIT
"""

import argparse
import time

import newton
import newton.examples
import newton.usd
import numpy as np
import warp as wp
from newton._src.geometry.tri_mesh_collision import TriMeshCollisionDetector
from newton.examples.cloth import example_cloth_twist
from newton.viewer import ViewerNull
from pxr import Usd

import starcontour_newton

# How many pairs fit into the row of a vertex and of an edge: what SolverVBD takes if it is not told, and what
# newton's example cloth_franka asks for; cloth_twist asks for 64 and 128.
DEFAULT_ROWS, SHORT_ROWS = (32, 64), (16, 20)


class Both:
    """Both detectors. The one that drives is asked always, the other one while `timed` is True."""

    driver = "ours"
    made = None

    def __init__(self, model, **options):
        rows = SHORT_ROWS if self.driver == "short" else DEFAULT_ROWS
        options["vertex_collision_buffer_pre_alloc"], options["edge_collision_buffer_pre_alloc"] = rows
        self.stock = TriMeshCollisionDetector(model, **options)
        self.ours = starcontour_newton.Detector(model, **options)
        self.drives = self.ours if self.driver == "ours" else self.stock
        self.timed, self.turn, self.milliseconds = False, 0, {}
        Both.made = self

    @property
    def collision_info(self):
        return self.drives.collision_info

    def _ask(self, method, *arguments, **options):
        detectors = [self.stock, self.ours] if self.timed else [self.drives]
        if self.turn % 2:
            detectors.reverse()
        for detector in detectors:
            begin = time.process_time()
            getattr(detector, method)(*arguments, **options)
            if self.timed:
                name = "ours" if detector is self.ours else "stock"
                self.milliseconds[name] = self.milliseconds.get(name, 0) + 1e3 * (time.process_time() - begin)

    def rebuild(self, *arguments):
        for detector in (self.stock, self.ours):
            detector.rebuild(*arguments)

    def refit(self, *arguments):
        self.turn += 1
        self._ask("refit", *arguments)

    def vertex_triangle_collision_detection(self, *arguments, **options):
        self._ask("vertex_triangle_collision_detection", *arguments, **options)

    def edge_edge_collision_detection(self, *arguments, **options):
        self._ask("edge_edge_collision_detection", *arguments, **options)

    def lost(self, rows):
        """How many pairs of the last search do not fit into rows of such lengths."""
        info = self.stock.collision_info
        counts = info.vertex_colliding_triangles_count.numpy(), info.edge_colliding_edges_count.numpy()
        return sum(int(np.maximum(count - row, 0).sum()) for count, row in zip(counts, rows))


class Shirt:
    """The shirt of cloth_franka falls onto a body of capsules. Centimetres."""

    def __init__(self):
        stage = Usd.Stage.Open(newton.examples.get_asset("unisex_shirt.usd"))
        mesh = newton.usd.get_mesh(stage.GetPrimAtPath("/root/shirt"))
        scene = newton.ModelBuilder(gravity=(0.0, 0.0, -981.0))
        scene.add_cloth_mesh(
            vertices=[wp.vec3(v) for v in mesh.vertices], indices=mesh.indices,
            rot=wp.quat_from_axis_angle(wp.vec3(0.0, 0.0, 1.0), np.pi), pos=wp.vec3(0.0, 120.0, 40.0),
            vel=wp.vec3(0.0, 0.0, 0.0), density=0.02, scale=1.0, tri_ke=1e4, tri_ka=1e4, tri_kd=1.5e-2, edge_ke=5,
            edge_kd=5e-1, particle_radius=0.8)
        scene.color()
        along_y = wp.quat_from_axis_angle(wp.vec3(1.0, 0.0, 0.0), np.pi / 2)
        along_x = wp.quat_from_axis_angle(wp.vec3(0.0, 1.0, 0.0), np.pi / 2)
        for where, turn, radius, half in (((0.0, 0.0, 9.0), along_y, 9.0, 25.0),
                                          ((0.0, -8.0, 9.0), along_x, 5.0, 32.0)):
            scene.add_shape_capsule(-1, xform=wp.transform(wp.vec3(*where), turn), radius=radius, half_height=half)
        scene.add_ground_plane()
        self.model = scene.finalize()
        self.model.soft_contact_ke, self.model.soft_contact_kd, self.model.soft_contact_mu = 1e4, 1e1, 0.25
        self.model.edge_rest_angle.zero_()
        slot, when = newton.solvers.SolverBase.CollisionSlot, newton.solvers.SolverBase.CollisionFrequencyType
        self.solver = newton.solvers.SolverVBD(
            self.model, iterations=5, particle_enable_self_contact=True, particle_self_contact_margin=0.2,
            particle_self_contact_gap=0.0, particle_topological_contact_filter_threshold=1,
            particle_rest_shape_contact_exclusion_radius=0.5, particle_vertex_contact_buffer_size=16,
            particle_edge_contact_buffer_size=20,
            collision_frequency_type={slot.SOFT_SELF_CONTACT: when.PRE_INIT})
        self.state_0, self.state_1, self.control = self.model.state(), self.model.state(), self.model.control()
        self.collision_pipeline = newton.CollisionPipeline(self.model, soft_contact_gap=0.8)
        self.contacts = self.collision_pipeline.contacts()

    def simulate(self):
        self.solver.rebuild_bvh(self.state_0)
        for _ in range(10):
            self.state_0.clear_forces()
            self.collision_pipeline.collide(self.state_0, self.contacts)
            self.solver.step(self.state_0, self.state_1, self.control, self.contacts, 1 / 600)
            self.state_0, self.state_1 = self.state_1, self.state_0


class Twist(example_cloth_twist.Example):
    def __init__(self, speed, thickness):
        make = newton.solvers.SolverVBD

        def make_thick(*arguments, particle_self_contact_margin, particle_self_contact_gap, **options):
            return make(*arguments, particle_self_contact_margin=thickness * particle_self_contact_margin,
                        particle_self_contact_gap=thickness * particle_self_contact_gap, **options)

        newton.solvers.SolverVBD = make_thick
        super().__init__(ViewerNull(), None)
        newton.solvers.SolverVBD = make
        self.rot_angular_velocity *= speed
        self.rot_end_time /= speed

    def capture(self):  # Python's part of a search would not be in a graph
        self.graph = None


def times(detectors, solver, poses):
    """Both detectors on saved poses."""
    searcher, near, inside = detectors.ours.searcher, detectors.ours.searcher.near, []

    def timed_near(*arguments, **options):
        begin = time.process_time()
        found = near(*arguments, **options)
        inside[-1] += 1e3 * (time.process_time() - begin)
        return found

    searcher.near = timed_near
    print("pose intersections pairs lost_short lost_default stock_ms ours_ms of_that_near_ms")
    for k, pose in enumerate(poses):
        least, inside = {}, []
        state = wp.array(pose, dtype=wp.vec3)
        detectors.rebuild(state)
        for _ in range(9):
            detectors.timed, detectors.milliseconds = True, {}
            inside.append(0)
            detectors.refit(state)
            for method in ("vertex_triangle_collision_detection", "edge_edge_collision_detection"):
                getattr(detectors, method)(solver._self_contact_query_radius,
                                           min_query_radius=solver.particle_rest_shape_contact_exclusion_radius,
                                           min_distance_filtering_ref_pos=solver.particle_q_rest)
            for name, value in detectors.milliseconds.items():
                least[name] = min(least.get(name, np.inf), value)
        info = detectors.ours.collision_info
        pairs = info.vertex_colliding_triangles_count.numpy().sum() + info.edge_colliding_edges_count.numpy().sum()
        print("%d %d %d %d %d %.2f %.2f %.2f" % (
            k, searcher.count(pose), pairs, detectors.lost(SHORT_ROWS), detectors.lost(DEFAULT_ROWS),
            least["stock"], least["ours"], min(inside)), flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", choices=("twist", "shirt"))
    parser.add_argument("driver", choices=("ours", "default", "short", "times"))
    parser.add_argument("--poses", help="what --save left")
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--thickness", type=float, default=1.0)
    parser.add_argument("--save", help="positions of every tenth frame and the table go there")
    options = parser.parse_args()
    wp.set_device("cpu")
    Both.driver = options.driver
    starcontour_newton.install(Both)
    example = Twist(options.speed, options.thickness) if options.scene == "twist" else Shirt()
    detectors, solver = Both.made, example.solver
    if options.driver == "times":
        return times(detectors, solver, np.load(options.poses)["poses"])
    step = solver.step

    def timed_step(*arguments):
        step(*arguments)
        detectors.timed = False

    solver.step = timed_step
    searcher = detectors.ours.searcher
    print(f"{options.scene}, {options.driver}: radius {solver._self_contact_query_radius:g}, "
          f"{example.model.tri_count} triangles, {example.model.particle_count} vertices; "
          f"short rows {SHORT_ROWS}, by default {DEFAULT_ROWS}")
    print("frame intersections pairs lost_short lost_default longest_vt longest_ee stock_ms ours_ms frame_s")
    table, poses = [], []
    for frame in range(options.frames):
        detectors.timed, detectors.milliseconds = True, {}
        begin = time.process_time()
        example.simulate()
        seconds = time.process_time() - begin
        position = example.state_0.particle_q.numpy().copy()
        # The pairs of the substep that was timed are still in newton's arrays if ours drives; else of the last one.
        info = detectors.stock.collision_info
        pairs = int(info.vertex_colliding_triangles_count.numpy().sum() + info.edge_colliding_edges_count.numpy().sum())
        longest = [int(array.numpy().max()) for array in
                   (info.vertex_colliding_triangles_count, info.edge_colliding_edges_count)]
        row = (frame, searcher.count(position), pairs, detectors.lost(SHORT_ROWS),
               detectors.lost(DEFAULT_ROWS), *longest, detectors.milliseconds["stock"], detectors.milliseconds["ours"],
               seconds)
        table.append(row)
        print("%d %d %d %d %d %d %d %.2f %.2f %.2f" % row, flush=True)
        if frame % 10 == 9:
            poses.append(position)
            if options.save:
                np.savez_compressed(options.save, table=np.array(table), poses=np.array(poses),
                                    triangles=example.model.tri_indices.numpy())
    table = np.array(table)
    print("in all: %d intersections, %d frames with some; dropped by short rows %d, by default %d; "
          "medians %.2f ms newton's, %.2f ours; enlarged %d times" % (
              table[:, 1].sum(), np.count_nonzero(table[:, 1]), table[:, 3].sum(), table[:, 4].sum(),
              np.median(table[:, 7]), np.median(table[:, 8]), detectors.ours.enlarged))


if __name__ == "__main__":
    main()
