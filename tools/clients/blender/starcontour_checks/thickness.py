"""How thin a mesh is at each face: the least distance to what is not near it on the surface.

The same as `sc-query --near D --thickness`: a pair of a vertex and a face, or of two edges, that is
within D counts for all triangles at its two features, unless a path of edges that is shorter than 2 D
leads from a vertex of one to a vertex of the other. See tools/thickness.h for why, and for what is
not seen so.

SPDX-License-Identifier: MIT
"""

import numpy as np

from .checks import starcontour

SOURCES = 4096  # searched from at a time, which limits memory


def _welds(positions):
    """The first vertex at the same position as each."""
    _, first, which = np.unique(positions + 0.0, axis=0, return_index=True, return_inverse=True)
    return first[which.ravel()].astype(np.int64)


class _Lists:
    """For each of count keys the values that it has: starts and values."""

    def __init__(self, keys, values, count):
        order = np.argsort(keys, kind="stable")
        self.values = values[order]
        self.starts = np.searchsorted(keys[order], np.arange(count + 1))

    def expand(self, keys):
        """All values of each key; and for each value which of the keys it is of."""
        counts = self.starts[keys + 1] - self.starts[keys]
        which = np.repeat(np.arange(len(keys)), counts)
        offsets = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
        return self.values[self.starts[keys][which] + offsets], which


class _Paths:
    """Which vertices paths of edges shorter than a limit join."""

    def __init__(self, positions, triangles, limit):
        count = len(positions)
        sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        sides = np.concatenate([sides, sides[:, ::-1]])
        sides = np.unique(sides[sides[:, 0] != sides[:, 1]], axis=0)
        way = positions[sides[:, 0]] - positions[sides[:, 1]]
        lengths = np.sqrt(way[:, 0] * way[:, 0] + way[:, 1] * way[:, 1] + way[:, 2] * way[:, 2])
        self.count, self.limit = count, limit
        short = lengths < limit
        self.next = _Lists(sides[short, 0], np.arange(short.sum()), count)
        self.ends, self.lengths = sides[short, 1], lengths[short]

    def reached(self, sources):
        """Keys source * count + vertex, sorted, of all that paths from some sources reach: rounds in
        which each path that became shorter is led on by an edge (Bellman 1958)."""
        keys = sources * self.count + sources
        lengths = np.zeros(len(keys))
        order = np.argsort(keys)
        keys, lengths, fresh = keys[order], lengths[order], np.ones(len(keys), bool)
        while fresh.any():
            edges, which = self.next.expand(keys[fresh] % self.count)
            longer = lengths[fresh][which] + self.lengths[edges]
            new = (keys[fresh] // self.count)[which] * self.count + self.ends[edges]
            near = longer < self.limit
            all_keys = np.concatenate([keys, new[near]])
            all_lengths = np.concatenate([lengths, longer[near]])
            old = np.arange(len(all_keys)) < len(keys)
            order = np.lexsort((~old, all_lengths, all_keys))  # of one key the shortest, old ones first
            order = order[np.concatenate([[True], np.diff(all_keys[order]) > 0])]
            keys, lengths, fresh = all_keys[order], all_lengths[order], ~old[order]
        return keys

    def join(self, firsts, seconds):
        """Whether a path joins one of the vertices firsts[i] to one of seconds[i]: arrays of shapes
        (n, j) and (n, k)."""
        joined = np.zeros(len(firsts), bool)
        sources = np.unique(firsts)
        for part in np.array_split(sources, max(1, -(-len(sources) // SOURCES))):
            if not len(part):
                continue
            keys = self.reached(part)
            for j in range(firsts.shape[1]):
                some = np.flatnonzero((firsts[:, j] >= part[0]) & (firsts[:, j] <= part[-1]) & ~joined)
                for k in range(seconds.shape[1]):
                    wanted = firsts[some, j] * self.count + seconds[some, k]
                    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
                    joined[some] |= keys[at] == wanted
        return joined


def thickness(positions, triangles, distance, threads=1):
    """For each triangle its thickness, inf: more than the distance. positions: float64 of shape (n, 3);
    vertices at equal positions are one. Raises starcontour.Error."""
    thick = np.full(len(triangles), np.inf)
    model = starcontour.Model(positions, triangles, boxes=True)
    near = model.near(positions, distance, threads=threads)
    welded = _welds(positions)[triangles.astype(np.int64)]  # corners, as first vertices at their places
    count = len(positions)
    paths = _Paths(positions, welded, 2 * distance)
    at_vertex = _Lists(welded.ravel(), np.repeat(np.arange(len(welded)), 3), count)
    welds = _welds(positions)

    # A vertex and a face.
    firsts, faces = welds[near.vertex_faces[:, 0].astype(np.int64)], near.vertex_faces[:, 1].astype(np.int64)
    counts = ~paths.join(firsts[:, None], welded[faces])
    far = model.stencils(positions, near.vertex_faces[counts], kind="vertex_face")["distance"]
    np.minimum.at(thick, faces[counts], far)
    around, which = at_vertex.expand(firsts[counts])
    np.minimum.at(thick, around, far[which])

    # Two edges: each counts for the triangles that have it as a side.
    edges = near.edge_edges.astype(np.int64)
    corners = np.stack([welded[edges // 3, edges % 3], welded[edges // 3, (edges + 1) % 3]], -1)
    counts = ~paths.join(corners[:, 0], corners[:, 1])
    far = model.stencils(positions, near.edge_edges[counts], kind="edge_edge")["distance"]
    for side in (0, 1):
        ends = corners[counts, side]
        around, which = at_vertex.expand(ends[:, 0])
        has = (welded[around] == ends[which, 1:]).any(1)
        np.minimum.at(thick, around[has], far[which[has]])
    return thick
