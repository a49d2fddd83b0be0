"""newton's detector of self-contacts beside the one on starcontour: the same contacts, and none dropped.

    python test_newton.py

Crumpled cloths of random shape are given to both. Pairs are compared with distances computed here in doubles:
ours must be right but for rounding at the radius; newton's must be ours where its rows are long enough and edges
are longer than what it takes for points. Then rows are made too short, filters, worlds and bounds are compared,
and a small cloth is twisted by SolverVBD with either. Exit status 1 if anything is wrong.

SPDX-License-Identifier: MIT
"""

import sys

import numpy as np
import warp as wp

import newton
import starcontour_newton
from newton._src.geometry.tri_mesh_collision import TriMeshCollisionDetector
from newton._src.solvers.vbd.particle_vbd_kernels import compute_particle_conservative_bound

failures = 0


def check(good, text):
    global failures
    if not good:
        failures += 1
        print("wrong:", text)


def make_builder(cells, cell):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    builder.add_cloth_grid(
        pos=wp.vec3(0.0, 0.0, 0.0), rot=wp.quat_identity(), vel=wp.vec3(0.0, 0.0, 0.0), dim_x=cells, dim_y=cells,
        cell_x=cell, cell_y=cell, mass=0.01, tri_ke=1e3, tri_ka=1e3, tri_kd=2e-4, edge_ke=1e-3, edge_kd=1e-2,
        particle_radius=0.002)
    return builder


def finish(builder):
    builder.color()
    return builder.finalize(device="cpu")


def crumple(model, generator, size):
    """Positions: the cloth rolled to the size, with random folds and noise."""
    at = model.particle_q.numpy().astype(float)
    x, y = (at[:, :2] / np.ptp(at[:, :2], axis=0)).T
    turn = x * generator.uniform(6, 14)
    radius = size * (0.3 + 0.5 * x)
    out = np.stack([radius * np.cos(turn), radius * np.sin(turn), size * y + 0.1 * size * np.sin(9 * x)], axis=1)
    return (out + generator.normal(size=out.shape) * 0.02 * size).astype(np.float32)


def rows_of(info, name):
    """The pairs of an array of rows, as (row, number), sorted."""
    offsets = getattr(info, f"{name}_offsets").numpy()
    stored = np.minimum(getattr(info, f"{name}_count").numpy(), getattr(info, f"{name}_buffer_sizes").numpy())
    numbers = getattr(info, name).numpy()
    rows = np.repeat(np.arange(len(stored)), stored)
    places = np.repeat(offsets[:-1] - np.cumsum(stored) + stored, stored) + np.arange(stored.sum())
    if name.startswith("triangle"):
        return {(int(a), int(b)) for a, b in zip(rows, numbers[places])}
    pairs = numbers.reshape(-1, 2)[places]
    check(np.array_equal(pairs[:, 0], rows), f"{name}: the first of a pair is its row")
    return {(int(a), int(b)) for a, b in pairs}


def segment_distance(p, q, r, s):
    """Of segments p q and r s, by rows: the least of the distances of ends to the other one, and of the two
    lines where their closest points are inside."""
    def to_segment(a, b, c):
        along = np.clip(((a - b) * (c - b)).sum(1) / np.maximum(((c - b) ** 2).sum(1), 1e-300), 0, 1)
        return np.linalg.norm(a - b - along[:, None] * (c - b), axis=1)

    least = np.min([to_segment(p, r, s), to_segment(q, r, s), to_segment(r, p, q), to_segment(s, p, q)], axis=0)
    u, v, w = q - p, s - r, p - r
    a, b, c, d, e = (u * u).sum(1), (u * v).sum(1), (v * v).sum(1), (u * w).sum(1), (v * w).sum(1)
    det = a * c - b * b
    good = det > 1e-12 * a * c
    t, k = (b * e - c * d) / np.where(good, det, 1), (a * e - b * d) / np.where(good, det, 1)
    inside = good & (t >= 0) & (t <= 1) & (k >= 0) & (k <= 1)
    return np.where(inside, np.linalg.norm(w + t[:, None] * u - k[:, None] * v, axis=1), least)


def triangle_distance(v, a, b, c):
    """Of points and triangles, by rows."""
    def to_segment(p, q):
        return segment_distance(v, v, p, q)

    least = np.min([to_segment(a, b), to_segment(b, c), to_segment(c, a)], axis=0)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    inside = length > 0
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(q - p, v - p) * normal).sum(1) >= 0
    plane = np.abs(((v - a) * normal).sum(1)) / np.maximum(length, 1e-300)
    return np.where(inside, np.minimum(least, plane), least)


def all_distances(model, at, rings):
    """Of all pairs that the filter leaves: {pair: distance}, for vertices and triangles, and both orders of edges."""
    at = at.astype(float)
    triangles, edges = model.tri_indices.numpy().reshape(-1, 3), model.edge_indices.numpy()[:, 2:]
    joined = np.eye(len(at), dtype=bool)
    step = joined.copy()
    step[edges[:, 0], edges[:, 1]] = step[edges[:, 1], edges[:, 0]] = True
    for _ in range(max(rings, 1) - 1):
        joined = (joined.astype(np.float32) @ step.astype(np.float32)) > 0
    v, t = np.nonzero(~joined[:, triangles].any(axis=2))
    corners = at[triangles[t]]
    of_triangles = v, t, triangle_distance(at[v], corners[:, 0], corners[:, 1], corners[:, 2])
    close = joined[edges[:, 0]] | joined[edges[:, 1]]
    a, b = np.nonzero(~(close[:, edges[:, 0]] | close[:, edges[:, 1]]))
    p, q = at[edges[a]], at[edges[b]]
    return of_triangles, (a, b, segment_distance(p[:, 0], p[:, 1], q[:, 0], q[:, 1]))


def make(kind, model, rows=(400, 1200), rings=2, **options):
    return kind(model, init_collision_info=True, vertex_collision_buffer_pre_alloc=rows[0],
                edge_collision_buffer_pre_alloc=rows[1], topological_contact_filter_threshold=rings, **options)


def search(detector, at, radius, **options):
    detector.refit(wp.array(at, dtype=wp.vec3, device="cpu"))
    detector.vertex_triangle_collision_detection(radius, **options)
    detector.edge_edge_collision_detection(radius, **options)
    info = detector.collision_info
    return rows_of(info, "vertex_colliding_triangles"), rows_of(info, "edge_colliding_edges")


def bounds(model, info, radius):
    """What newton's kernel makes of the least distances."""
    out = wp.zeros(model.particle_count, dtype=float, device="cpu")
    wp.launch(compute_particle_conservative_bound, dim=model.particle_count,
              inputs=[1.0, radius, model.soft_mesh_adjacency_device, info], outputs=[out], device="cpu")
    return out.numpy().copy()


def same(found, right, radius, what, slack=1e-6):
    """found: a set of pairs; right: rows, columns and distances of all pairs."""
    a, b, distances = right
    def nearer(limit):
        return set(zip(a[distances < limit].tolist(), b[distances < limit].tolist()))

    within, may = nearer(radius * (1 - slack)), nearer(radius * (1 + slack))
    check(within <= found, f"{what}: {len(within - found)} pairs are missing")
    check(found <= may, f"{what}: {len(found - may)} pairs are too far, or left out")
    return len(found), len(within - found)


def test_random():
    """Lengths of edges are far above newton's sqrt(1e-5) here, and pairs the same."""
    for seed, rings in enumerate((0, 1, 2, 2, 3)):
        generator = np.random.default_rng(seed)
        model = finish(make_builder(10, 1.0))
        at, radius = crumple(model, generator, 3.0), (0.25, 0.4, 0.6, 0.7, 0.5)[seed]
        right = all_distances(model, at, rings)
        ends = at[model.edge_indices.numpy()[:, 2:]]
        longest = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).max()
        stock = make(TriMeshCollisionDetector, model, rings=rings)
        count = 0
        theirs = search(stock, at, radius)
        for exact in (False, True):
            ours = make(starcontour_newton.Detector, model, rings=rings, distances=exact)
            mine = search(ours, at, radius)
            for k in range(2):
                what = ("vertices and triangles", "edges")[k]
                count += same(mine[k], right[k], radius, f"ours, seed {seed}, {what}")[0]
                same(theirs[k], right[k], radius, f"newton, seed {seed}, {what}", 1e-4)
            # Least distances: ours are bounds, and with distances=True those of newton.
            for name, (row, _, distance), size in (
                    ("vertex_colliding_triangles_min_dist", right[0], model.particle_count),
                    ("triangle_colliding_vertices_min_dist", (right[0][1], None, right[0][2]), model.tri_count),
                    ("edge_colliding_edges_min_dist", right[1], model.edge_count)):
                true = np.full(size, radius)
                np.minimum.at(true, row, distance)
                got = getattr(ours.collision_info, name).numpy()
                check((got <= true * (1 + 1e-6)).all(), f"{name}: above the distance, seed {seed}")
                if exact:
                    check((got >= true * (1 - 1e-6) - 1e-7).all(), f"{name}: below the distance, seed {seed}")
            if exact:
                # The library's bounds are below the distances by at most so much, and never above.
                below = 5e-7 * np.ptp(at, axis=0).max() + 3e-5 * (radius + longest) + 1e-6
                more = bounds(model, ours.collision_info, radius) - loose
                check((more > -1e-6).all() and (more < below).all(), f"bounds of vertices differ, seed {seed}")
            loose = bounds(model, ours.collision_info, radius)
        check(not stock.resize_flags.numpy().any() and count > 1000,
              f"seed {seed}: rows are too short, or all is empty")
        print(f"seed {seed}, rings {rings}: {count // 2} pairs, the same by both")


def test_short_edges():
    """Edges of 2 mm where the unit is the metre: newton takes them for points, ours does not."""
    model = finish(make_builder(10, 0.002))
    at = crumple(model, np.random.default_rng(5), 0.006)
    right = all_distances(model, at, 2)[1]
    mine = search(make(starcontour_newton.Detector, model), at, 0.0008)[1]
    theirs = search(make(TriMeshCollisionDetector, model), at, 0.0008)[1]
    same(mine, right, 0.0008, "short edges")
    print(f"edges of 2 mm: {len(mine)} pairs within 0.8 mm, of which newton does not find {len(mine - theirs)}")


def test_short_rows():
    """Rows too short: newton drops, ours makes room."""
    model = finish(make_builder(12, 1.0))
    at, radius = crumple(model, np.random.default_rng(7), 2.0), 0.5
    whole = search(make(TriMeshCollisionDetector, model), at, radius)
    stock, ours = (make(kind, model, (2, 3)) for kind in (TriMeshCollisionDetector, starcontour_newton.Detector))
    theirs, mine = search(stock, at, radius), search(ours, at, radius)
    check(len(theirs[0]) < len(whole[0]) and len(theirs[1]) < len(whole[1]), "newton dropped nothing")
    check(ours.enlarged == 2, f"{ours.enlarged} arrays were enlarged, not 2")
    for k in range(2):
        check(len(mine[k] ^ whole[k]) <= 2, "ours dropped something")
    dropped = sum(map(len, whole)) - sum(map(len, theirs))
    print(f"rows of 2 and 3: newton drops {dropped} of {sum(map(len, whole))} pairs, ours none")
    search(ours, at, 0.2)
    check(ours.enlarged == 2, "arrays were enlarged again")


def test_filters():
    """Maps of the caller, the distance at rest, recorded vertices of triangles, worlds."""
    model = finish(make_builder(10, 1.0))
    at, radius = crumple(model, np.random.default_rng(8), 2.0), 0.5
    plain = search(make(TriMeshCollisionDetector, model), at, radius)
    maps = {"external_vertex_triangle_filtering_map": {}, "external_edge_edge_filtering_map": {}}
    for name, pairs in zip(maps, plain):
        for a, b in sorted(pairs)[::3]:
            maps[name].setdefault(a, set()).add(b)
    rest = {"min_query_radius": 5.0, "min_distance_filtering_ref_pos": model.particle_q}
    for what, options, asked in (("maps", maps, {}), ("rest", {}, rest), ("maps and rest", maps, rest)):
        theirs, mine = (search(make(kind, model, **options), at, radius, **asked)
                        for kind in (TriMeshCollisionDetector, starcontour_newton.Detector))
        for k in range(2):
            check(len(theirs[k] ^ mine[k]) <= 2, f"{what}: {len(theirs[k] ^ mine[k])} pairs differ")
            check(0 < len(mine[k]) < len(plain[k]), f"{what}: nothing, or all, was left out")
    theirs, mine = (make(kind, model, record_triangle_contacting_vertices=True, triangle_collision_buffer_pre_alloc=400)
                    for kind in (TriMeshCollisionDetector, starcontour_newton.Detector))
    found = search(mine, at, radius)[0]
    search(theirs, at, radius)
    of_triangles = [rows_of(one.collision_info, "triangle_colliding_vertices") for one in (theirs, mine)]
    check(len(of_triangles[0] ^ of_triangles[1]) <= 2, "vertices of triangles differ")
    check(of_triangles[1] == {(b, a) for a, b in found}, "vertices of triangles are not those of the pairs")

    # Two cloths in worlds of their own, and one in all, in the same place.
    scene, cloth = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0)), make_builder(6, 1.0)
    scene.add_builder(cloth)
    scene.add_world(cloth)
    scene.add_world(cloth)
    model = finish(scene)
    at = crumple(model, np.random.default_rng(9), 2.0)
    theirs, mine = (search(make(kind, model), at, 0.3)
                    for kind in (TriMeshCollisionDetector, starcontour_newton.Detector))
    for k in range(2):
        check(len(theirs[k] ^ mine[k]) <= 2 and mine[k], f"worlds: {len(theirs[k] ^ mine[k])} pairs differ")


def twist(detector, frames=24, cells=16):
    """A cloth, its two ends turned against each other; returns how many triangles intersect at the end, how
    many contacts were found in all, and how far vertices are from the middle."""
    starcontour_newton.install(detector)
    try:
        builder = make_builder(cells, 1.0 / cells)
        builder.color()
        ends = [i for i in range(builder.particle_count) if i % (cells + 1) in (0, cells)]
        for i in ends:
            builder.particle_flags[i] = int(builder.particle_flags[i]) & ~int(newton.ParticleFlags.ACTIVE)
        model = builder.finalize(device="cpu")
        model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 1e3, 1e-1, 0.2
        solver = newton.solvers.SolverVBD(
            model, iterations=4, particle_enable_self_contact=True, particle_self_contact_margin=0.008,
            particle_self_contact_gap=0.006, particle_vertex_contact_buffer_size=1,
            particle_edge_contact_buffer_size=1)
    finally:
        starcontour_newton.uninstall()
    states, control = [model.state(), model.state()], model.control()
    contacts = newton.CollisionPipeline(model).contacts()
    start = model.particle_q.numpy().copy()
    middle = start[:, 1].mean()
    found, substeps = 0, 5
    for substep in range(frames * substeps):
        turn = 12.0 * np.pi / 5 * (substep + 1) / (frames * substeps)
        for state in states:
            at = state.particle_q.numpy()
            for i in ends:
                way = turn if i % (cells + 1) else -turn
                at[i] = start[i][0], middle + (start[i][1] - middle) * np.cos(way), (start[i][1] - middle) * np.sin(way)
        solver.step(states[0], states[1], control, contacts, 1 / 300)
        states.reverse()
        info = solver.trimesh_collision_info
        found += int(info.vertex_colliding_triangles_count.numpy().sum())
    at = states[0].particle_q.numpy()
    check(np.isfinite(at).all() and np.abs(at).max() < 2, "the twisted cloth flew away")
    searcher = starcontour_newton.starcontour.Model(start, model.tri_indices.numpy().reshape(-1, 3), weld="none")
    return searcher.count(at), found, solver.trimesh_collision_detector


def test_twist():
    theirs, mine = twist(TriMeshCollisionDetector), twist(starcontour_newton.Detector)
    check(isinstance(mine[2], starcontour_newton.Detector), "the solver does not have the detector")
    check(mine[1] > 0 and mine[2].enlarged > 0, "the twisted cloth had no contacts, or few")
    check(mine[0] <= theirs[0], "the cloth with all contacts has more intersections")
    print(f"twisted cloth, rows of one pair: {theirs[0]} intersections with newton's detector, {mine[0]} with ours "
          f"({theirs[1]} and {mine[1]} vertex-triangle contacts)")


def main():
    wp.set_device("cpu")
    for test in (test_random, test_short_edges, test_short_rows, test_filters, test_twist):
        test()
    print("failed" if failures else "all right")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
