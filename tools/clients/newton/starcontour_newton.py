"""Self-contact for Newton's VBD solver (newton) on the processor, found by starcontour.

    import starcontour_newton
    starcontour_newton.install()          before a solver or a collision pipeline is made; uninstall() ends it

From then on SolverVBD and CollisionPipeline make a Detector where they would make newton's
TriMeshCollisionDetector. It writes the same arrays: for each vertex the triangles within the radius, for
each edge the other edges, how many, and the least distances. Three things differ:

- Rows are as long as they must be, one after the other. Newton's have a fixed length, and what does not
  fit is dropped. Where all rows together do not fit, the array is replaced by a larger one
  (Detector.enlarged counts how often), so nothing is dropped.
- What is within the radius is decided exactly, on the floats that the simulation has. Newton rounds, and
  takes edges for points whose squared length is at most particle_edge_parallel_epsilon.
- The least distances of vertices, edges and triangles are lower bounds, chosen so that the least of them
  round a vertex is the same (but for 3e-5 of the radius and the longest edge). With distances=True they are
  each row's own, as newton has them, which takes about three times as long.

SPDX-License-Identifier: MIT
"""

import logging
import warnings

import numpy as np
import warp as wp
from newton._src.geometry.tri_mesh_collision import TriMeshCollisionDetector
from newton._src.sim import collide
from newton._src.solvers.vbd import solver_vbd

import starcontour

_log = logging.getLogger(__name__)


def number_edges(triangles, edges):
    """Of edge 3 t + k of the library the row of edges, shape (n, 2), or -1 where it is not there."""
    count = int(max(triangles.max(initial=0), edges.max(initial=0))) + 1

    def keys(pairs):
        pairs = np.sort(pairs.astype(np.int64), axis=1)
        return pairs[:, 0] * count + pairs[:, 1]

    given, sides = keys(edges), keys(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
    if len(np.unique(given)) != len(given):
        raise ValueError("starcontour_newton: two rows of edge_indices are the same edge")
    if not np.isin(given, sides).all():
        raise ValueError("starcontour_newton: an edge of edge_indices is none of a triangle")
    if not len(given):
        return np.full(len(sides), -1, np.int32)
    order = np.argsort(given)
    at = order[np.minimum(np.searchsorted(given, sides, sorter=order), len(given) - 1)]
    return np.where(given[at] == sides, at, -1).astype(np.int32)


def _round_down(distances):
    """The largest floats that are at most these doubles."""
    rounded = distances.astype(np.float32)
    return np.where(rounded > distances, np.nextafter(rounded, np.float32(-1)), rounded)


def _largest(values, vertices):
    """Of each column of vertices the largest value."""
    return np.maximum.reduce([values[row] for row in vertices])


def _order(rows, row_count):
    """Which order sorts rows, stably. numpy counts digits of short integers, which is faster."""
    return np.argsort(rows.astype(np.uint16) if row_count <= 1 << 16 else rows, kind="stable")


class Detector(TriMeshCollisionDetector):
    """Takes what TriMeshCollisionDetector takes, as keywords, and

    threads    how many threads may search
    distances  True: the least distances of each row, of the closest points of each pair; False: bounds

    enlarged  how often an array was replaced by a larger one
    searcher  the starcontour.Model of the triangles: its count(positions) says how many intersect
    """

    threads = 1
    distances = False

    def __init__(self, model, *, topological_contact_filter_threshold=0, threads=None, distances=None, **options):
        if not model.device.is_cpu:
            raise ValueError(f"starcontour_newton: the model is on {model.device}, not on the processor")
        given = [options.get(name) is not None for name in ("vertex_triangle_filtering_list", "edge_filtering_list")]
        # The library walks the mesh itself; lists are made only of what the caller names.
        super().__init__(model, **options)
        if threads is not None:
            self.threads = threads
        if distances is not None:
            self.distances = distances
        rings = max(0, topological_contact_filter_threshold)
        self._rings = [0 if one else rings for one in given]
        self.enlarged = 0
        triangles = model.tri_indices.numpy().reshape(-1, 3)
        edges = model.edge_indices.numpy()[:, 2:] if model.edge_count else np.empty((0, 2), np.int32)
        self._corners, self._ends = np.ascontiguousarray(triangles.T), np.ascontiguousarray(edges.T)
        self._numbers = number_edges(triangles, edges)
        self._unnumbered = bool((self._numbers < 0).any())
        self.searcher = starcontour.Model(model.particle_q.numpy(), triangles.astype(np.uint32), weld="none")
        used = np.zeros(model.particle_count, bool)
        used[triangles] = True
        if not used.all():
            warnings.warn(f"starcontour_newton: {np.count_nonzero(~used)} particles are of no triangle; "
                          "what is near them is not found", stacklevel=2)
        # Particles in different worlds pass through each other; -1 is in all worlds.
        world = model.particle_world.numpy()
        self._worlds = (world, world[edges[:, 0]]) if len(np.unique(world[world >= 0])) > 1 else None
        self._triangle_worlds = world[triangles[:, 0]]

    def _validate_collision_info(self, collision_info):
        # Arrays may have been enlarged, by this detector or another.
        for name, count in (("vertex", self.model.particle_count), ("edge", self.model.edge_count)):
            array = collision_info.vertex_colliding_triangles if name == "vertex" else \
                collision_info.edge_colliding_edges
            if array is not None and count:
                setattr(self, f"{name}_collision_buffer_pre_alloc", array.size // (2 * count))
        if self.record_triangle_contacting_vertices and self.model.tri_count:
            self.triangle_collision_buffer_pre_alloc = \
                collision_info.triangle_colliding_vertices.size // self.model.tri_count
        super()._validate_collision_info(collision_info)

    # There are no trees to keep: a search reads the positions. Those of newton are only needed for
    # intersections of triangles.

    def rebuild(self, new_pos=None):
        if new_pos is not None:
            self.vertex_positions = new_pos

    refit = rebuild

    def triangle_triangle_intersection_detection(self):
        self.refit_triangles()
        super().triangle_triangle_intersection_detection()

    def _near(self, kind, radius, rest_radius, rest):
        """What is nearer than the radius, but for what is nearer than rest_radius in rest."""
        if self.device.is_capturing:
            raise RuntimeError("starcontour_newton: a search cannot be part of a graph; call simulate() itself")
        pose = self.vertex_positions.numpy()
        options = {}
        # Floats as newton has them; the library finds what is at the distance, too, hence the next double below.
        radius, rest_radius = float(np.float32(radius)), float(np.float32(rest_radius))
        if rest_radius > 0:
            options = {"rest": pose if rest is None else rest.numpy(), "rest_distance": np.nextafter(rest_radius, 0.0)}
        return self.searcher.near(pose, np.nextafter(radius, 0.0), kinds=kind, stencils=self.distances,
                                  vertex_bound=not self.distances, ignore_rings=self._rings[kind == "edge_edge"],
                                  threads=self.threads, **options)

    def _enlarge(self, name, size, per_row):
        """Sees to it that an array of the result has room for size numbers, per_row for each row."""
        array = getattr(self.collision_info, name)
        if size <= array.size:
            return False
        size = -(-size * 5 // 4 // per_row) * per_row
        _log.info("%s: enlarged from %d to %d numbers", name, array.size, size)
        setattr(self.collision_info, name, wp.full(size, -1, dtype=wp.int32, device=self.device))
        self.enlarged += 1
        return True

    def _write_rows(self, name, rows, pairs, row_count, per_pair):
        """Writes pairs, which are sorted by rows; returns how many each row has, and where it begins."""
        counts = np.bincount(rows, minlength=row_count).astype(np.int32)
        if row_count:
            self._enlarge(name, pairs.size, per_pair * row_count)
        getattr(self.collision_info, name).numpy()[:pairs.size] = pairs.reshape(-1)
        offsets = getattr(self.collision_info, f"{name}_offsets").numpy()
        offsets[0] = 0
        np.cumsum(counts, out=offsets[1:])
        getattr(self.collision_info, f"{name}_buffer_sizes").numpy()[:] = counts
        getattr(self.collision_info, f"{name}_count").numpy()[:] = counts
        return counts, offsets

    @staticmethod
    def _write_least(array, radius, distances, counts, offsets):
        least = array.numpy()
        least[:] = radius
        if len(distances):
            least[counts > 0] = np.minimum.reduceat(distances, offsets[:-1][counts > 0])

    def _listed(self, values, offsets, pairs, count):
        """Which pairs are in a list of newton's filters, whose rows are sorted."""
        values, offsets = values.numpy().astype(np.int64), offsets.numpy()
        keys = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets)) * count + values
        return np.isin(pairs[:, 0].astype(np.int64) * count + pairs[:, 1], keys)

    def vertex_triangle_collision_detection(
        self, max_query_radius, min_query_radius=0.0, min_distance_filtering_ref_pos=None
    ):
        self._require_collision_info()
        found = self._near("vertex_face", max_query_radius, min_query_radius, min_distance_filtering_ref_pos)
        pairs, keep = found.vertex_faces, None
        if self.vertex_triangle_filtering_list is not None:
            keep = ~self._listed(self.vertex_triangle_filtering_list, self.vertex_triangle_filtering_list_offsets,
                                 pairs, self.model.tri_count)
        if self._worlds is not None:
            a, b = self._worlds[0][pairs[:, 0]], self._triangle_worlds[pairs[:, 1]]
            meet = (a == b) | (a < 0) | (b < 0)
            keep = meet if keep is None else keep & meet
        if keep is not None:
            pairs = pairs[keep]
        info, model = self.collision_info, self.model
        counts, offsets = self._write_rows("vertex_colliding_triangles", pairs[:, 0], pairs, model.particle_count, 2)
        of_triangles = info.triangle_colliding_vertices_min_dist.numpy()
        if self.distances:
            distances = _round_down(found.vertex_face_stencils["distance"])
            distances = distances if keep is None else distances[keep]
            self._write_least(info.vertex_colliding_triangles_min_dist, max_query_radius, distances, counts, offsets)
            of_triangles[:] = max_query_radius
            np.minimum.at(of_triangles, pairs[:, 1], distances)
        else:
            bound = _round_down(found.vertex_bound)
            info.vertex_colliding_triangles_min_dist.numpy()[:] = bound
            of_triangles[:] = _largest(bound, self._corners)
        if self.record_triangle_contacting_vertices:
            pairs = pairs[_order(pairs[:, 1], model.tri_count)]
            self._write_rows("triangle_colliding_vertices", pairs[:, 1], np.ascontiguousarray(pairs[:, 0]),
                             model.tri_count, 1)

    def edge_edge_collision_detection(
        self, max_query_radius, min_query_radius=0.0, min_distance_filtering_ref_pos=None
    ):
        self._require_collision_info()
        found = self._near("edge_edge", max_query_radius, min_query_radius, min_distance_filtering_ref_pos)
        # The library names each pair once; here each of its edges has the other in its row.
        half = self._numbers[found.edge_edges]
        pairs = np.concatenate([half, half[:, ::-1]])
        keep = None
        if self._unnumbered:
            keep = (pairs >= 0).all(axis=1)
        if self.edge_filtering_list is not None:
            allowed = ~self._listed(self.edge_filtering_list, self.edge_filtering_list_offsets, pairs,
                                    self.model.edge_count)
            keep = allowed if keep is None else keep & allowed
        if self._worlds is not None:
            a, b = self._worlds[1][pairs].T
            meet = (a == b) | (a < 0) | (b < 0)
            keep = meet if keep is None else keep & meet
        if keep is not None:
            pairs = pairs[keep]
        order = _order(pairs[:, 0], self.model.edge_count)
        pairs = pairs.take(order, axis=0)
        counts, offsets = self._write_rows("edge_colliding_edges", pairs[:, 0], pairs, self.model.edge_count, 2)
        least = self.collision_info.edge_colliding_edges_min_dist
        if self.distances:
            distances = np.tile(_round_down(found.edge_edge_stencils["distance"]), 2)
            distances = distances if keep is None else distances[keep]
            self._write_least(least, max_query_radius, distances[order], counts, offsets)
        else:
            least.numpy()[:] = _largest(_round_down(found.vertex_bound), self._ends)


def install(detector=Detector):
    """Solvers and collision pipelines that are made from now on have such a detector."""
    solver_vbd.TriMeshCollisionDetector = collide.TriMeshCollisionDetector = detector


def uninstall():
    install(TriMeshCollisionDetector)
