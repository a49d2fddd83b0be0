"""A broad phase for ipc-toolkit (ipctk) on starcontour: contacts within a distance, and those of a step.

    broad_phase = starcontour_ipctk.BroadPhase(rest, faces)              once per topology
    collisions.build(mesh, vertices, dhat, broad_phase=broad_phase)      NormalCollisions
    candidates.build(mesh, start, end, broad_phase=broad_phase)          Candidates, for step sizes

Where ipc-toolkit looks for boxes that overlap, this asks what is within the distance (sc_query_near), or
what may come together on the way from one pose to another (sc_query_step, candidates): so there are
fewer candidates, and the same collisions and step sizes.

Only triangle meshes: each edge is one of a face, and each vertex of one. Who may collide with whom
(CollisionMesh.can_collide) is not asked here.

SPDX-License-Identifier: MIT
"""

import ipctk
import numpy as np

import starcontour

# ipc-toolkit's distances and its test for collisions on the way are rounded; what is this much farther, of
# the size of the mesh, is a candidate as well.
SLACK = 1e-5


class BroadPhase(ipctk.BroadPhase):
    """rest, faces: rest positions, shape (n, 3), and faces, shape (m, 3), of the collision mesh. threads:
    how many threads may search."""

    def __init__(self, rest, faces, threads=1):
        super().__init__()
        self.faces = np.ascontiguousarray(faces, np.uint32)
        self.model = starcontour.Model(np.asarray(rest, float), self.faces, weld="none")
        self.threads = threads
        self._edges = self._numbers = None
        self.clear()

    def name(self):
        return "starcontour"

    def clear(self):
        self._face_vertices, self._edge_edges = [], []

    def _number_edges(self, edges):
        """Of edge 3 t + k of the library the row of ipc-toolkit's edges."""
        if self._edges is not None and np.array_equal(edges, self._edges):
            return self._numbers
        count = int(self.faces.max()) + 1

        def keys(pairs):
            pairs = np.sort(np.asarray(pairs, np.int64), axis=1)
            return pairs[:, 0] * count + pairs[:, 1]

        given, sides = keys(edges), keys(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
        order = np.argsort(given)
        at = np.searchsorted(given, sides, sorter=order)
        if not len(given) or np.any(given[order[np.minimum(at, len(given) - 1)]] != sides) or \
                len(np.unique(sides)) != len(given):
            raise ValueError("starcontour_ipctk.BroadPhase: each edge must be one of a face, and only once there")
        self._edges, self._numbers = np.array(edges), order[at]
        return self._numbers

    def build(self, *arguments):
        """Called by ipc-toolkit: one array of vertices or two, then edges, faces and the radius by which it
        would enlarge boxes."""
        *poses, edges, faces, radius = arguments
        if not np.array_equal(faces, self.faces):
            raise ValueError("starcontour_ipctk.BroadPhase was made for other faces")
        numbers = self._number_edges(edges)
        poses = [np.ascontiguousarray(pose) for pose in poses]
        distance = 2 * radius + SLACK * max(float(np.ptp(pose, axis=0).max()) for pose in poses)
        if len(poses) == 1:
            found = self.model.near(poses[0], distance, threads=self.threads)
        else:
            found = self.model.step(*poses, separation=distance, candidates=True, threads=self.threads)
        self._face_vertices = [ipctk.FaceVertexCandidate(face, vertex)
                               for vertex, face in found.vertex_faces.tolist()]
        self._edge_edges = [ipctk.EdgeEdgeCandidate(a, b) for a, b in numbers[found.edge_edges].tolist()]

    def detect_face_vertex_candidates(self):
        return self._face_vertices

    def detect_edge_edge_candidates(self):
        return self._edge_edges

    def detect_vertex_vertex_candidates(self):
        raise NotImplementedError("starcontour_ipctk.BroadPhase is for triangle meshes")

    detect_edge_vertex_candidates = detect_vertex_vertex_candidates
    detect_edge_face_candidates = detect_vertex_vertex_candidates
    detect_face_face_candidates = detect_vertex_vertex_candidates
