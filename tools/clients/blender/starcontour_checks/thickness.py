"""How thin a mesh is at each face: the least distance to what is not near it on the surface.

The same as `sc-query --near D --thickness`: a pair of a vertex and a face, or of two edges, that is
within D counts for all triangles at its two features, unless a path of edges that is shorter than 2 D
leads from a vertex of one to a vertex of the other. See tools/thickness.h for why, and for what is
not seen so.

SPDX-License-Identifier: MIT
"""

import numpy as np

from .checks import starcontour

ENTRIES = 1 << 22  # of the tables that paths are sought with
RINGS_MAX = 8      # more of them take longer to find than they save


def welds(positions):
    """The first vertex at the same position as each."""
    order = np.lexsort((np.arange(len(positions)), *positions.T))
    at = positions[order]
    starts = np.concatenate([[True], (at[1:] != at[:-1]).any(1)])
    welds = np.empty(len(positions), np.int64)
    welds[order] = order[starts][np.cumsum(starts) - 1]
    return welds


class _Lists:
    """For each of count keys the values that it has."""

    def __init__(self, keys, values, count):
        order = np.argsort(keys, kind="stable")
        self.values = values[order]
        self.starts = np.searchsorted(keys[order], np.arange(count + 1))

    def expand(self, keys):
        """All values of each key; and for each value which of the keys it is of."""
        first = self.starts[keys]
        counts = self.starts[keys + 1] - first
        which = np.repeat(np.arange(len(keys)), counts)
        offsets = np.arange(len(which)) - (np.cumsum(counts) - counts)[which]
        return self.values[first[which] + offsets], which


class _Paths:
    """Which vertices paths of edges shorter than a limit join."""

    def __init__(self, positions, triangles, limit):
        count = len(positions)
        a = triangles.ravel()
        b = triangles[:, [1, 2, 0]].ravel()
        sides = np.unique(np.concatenate([a * count + b, b * count + a]))
        a, b = sides // count, sides % count
        way = positions[a] - positions[b]
        lengths = np.sqrt(way[:, 0] * way[:, 0] + way[:, 1] * way[:, 1] + way[:, 2] * way[:, 2])
        short = (lengths < limit) & (a != b)
        self.count, self.limit = count, limit
        self.longest = lengths.max(initial=0.0)
        self.edges = _Lists(a[short], np.arange(short.sum()), count)
        self.ends, self.lengths = b[short], lengths[short]

    def rings(self):
        """So many rings that what is in them is joined: one edge less than that is a path that is short
        enough, whichever edges it has."""
        if not self.longest > 0:
            return 1
        return int(min(np.ceil(self.limit / (self.longest * (1 + 1e-9))), RINGS_MAX))

    def reach(self, sources, table, owners):
        """Writes into table[k * count + v] the shortest path from sources[k] to each vertex v that one
        reaches, and returns which entries were written. All paths go on by an edge at a time, where they
        became shorter (Bellman 1958). Entries of the table are infinite before."""
        grown = np.arange(len(sources)) * self.count + sources
        table[grown] = 0
        written = [grown]
        while len(grown):
            edges, which = self.edges.expand(grown % self.count)
            longer = table[grown][which] + self.lengths[edges]
            to = (grown - grown % self.count)[which] + self.ends[edges]
            better = (longer < self.limit) & (longer < table[to])
            to, longer = to[better], longer[better]
            np.minimum.at(table, to, longer)
            owners[to] = np.arange(len(to))  # of those to one vertex, one goes on
            grown = to[owners[to] == np.arange(len(to))]
            written.append(grown)
        return np.concatenate(written)

    def join(self, firsts, seconds):
        """Whether a path joins one of the vertices firsts[i] to one of seconds[i]: arrays of shapes
        (n, j) and (n, k)."""
        joined = np.zeros(len(firsts), bool)
        sources = np.unique(firsts)
        at_once = max(1, min(len(sources), ENTRIES // self.count))
        table = np.full(at_once * self.count, np.inf)
        owners = np.zeros(len(table), np.int64)
        pairs = _Lists(firsts.ravel(), np.repeat(np.arange(len(firsts)), firsts.shape[1]), self.count)
        for begin in range(0, len(sources), at_once):
            some = sources[begin:begin + at_once]
            written = self.reach(some, table, owners)
            found, which = pairs.expand(some)
            for k in range(seconds.shape[1]):
                joined[found[table[which * self.count + seconds[found, k]] < np.inf]] = True
            table[written] = np.inf
        return joined


def thickness(positions, triangles, distance, threads=1):
    """For each triangle its thickness, inf: more than the distance. positions: float64 of shape (n, 3);
    vertices at equal positions are one. Raises starcontour.Error."""
    thick = np.full(len(triangles), np.inf)
    model = starcontour.Model(positions, triangles)
    count, joined = len(positions), welds(positions)
    welded = joined[triangles.astype(np.int64)]
    paths = _Paths(positions, welded, 2 * distance)
    near = model.near(positions, distance, ignore_rings=paths.rings(), threads=threads)
    at_vertex = _Lists(welded.ravel(), np.repeat(np.arange(len(welded)), 3), count)

    # A vertex and a face.
    vertices, faces = joined[near.vertex_faces[:, 0].astype(np.int64)], near.vertex_faces[:, 1].astype(np.int64)
    counts = ~paths.join(vertices[:, None], welded[faces])
    far = model.stencils(positions, near.vertex_faces[counts], kind="vertex_face")["distance"]
    np.minimum.at(thick, faces[counts], far)
    around, which = at_vertex.expand(vertices[counts])
    np.minimum.at(thick, around, far[which])

    # Two edges: each counts for the triangles that have it as a side.
    edges = near.edge_edges.astype(np.int64)
    ends = np.stack([welded[edges // 3, edges % 3], welded[edges // 3, (edges + 1) % 3]], -1)
    counts = ~paths.join(ends[:, 0], ends[:, 1])
    far = model.stencils(positions, near.edge_edges[counts], kind="edge_edge")["distance"]
    for side in ends[counts].transpose(1, 0, 2):
        around, which = at_vertex.expand(side[:, 0])
        has = (welded[around] == side[which, 1:]).any(1)
        np.minimum.at(thick, around[has], far[which[has]])
    return thick
