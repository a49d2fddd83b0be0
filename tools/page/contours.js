/*
 * Contours for the page of sc-query --trace --html: decodes a frame of them and divides the surface
 * along them into regions.
 *
 * SPDX-License-Identifier: MIT
 *
 * A triangle through which no contour passes is in the region of its corners. Another is cut along
 * its chords, the segments of contours in it: its faces are found by walking along chords and sides,
 * always turning left as far as possible. A face at a corner has the region of that corner's vertex;
 * from there on, across a chord the region changes from one side of its contour to the other. That is
 * not known behind points where chords cross, as three sheets meet: such a face, if it is at no
 * corner, may have the region of its neighbour.
 */
import {ShapeUtils, Vector2} from 'three';

/* What a frame has behind its positions; see page_add_trace in tools/page_write.h. */
export function read_contours(numbers, vertex_count) {
    const step = () => {
        const value = numbers.next();
        return value % 2 ? -(value + 1) / 2 : value / 2;
    };
    const smaller = Array.from({length: numbers.next()}, () => numbers.next() === 1);
    const vertex_regions = new Uint32Array(vertex_count);
    let region = 0;
    for (let v = 0; v < vertex_count; v++) vertex_regions[v] = region += step();
    const last = [0, 0, 0, 0];
    const contours = Array.from({length: numbers.next()}, () => {
        const value = numbers.next(), sides = last.map((_, k) => last[k] += step());
        return {count: Math.floor(value / 2), is_closed: value % 2 === 1,
            sides: [sides.slice(0, 2), sides.slice(2)]};
    });
    let edge = 0, vertex = 0;
    const sheets = [0, 0];
    for (const contour of contours) {
        contour.nodes = Array.from({length: contour.count}, (_, i) => {
            const node = {edge: (edge += step()) - 1, vertex: -1, along: 0, sheets: null};
            if (node.edge < 0) node.vertex = vertex += step();
            else node.along = numbers.next() / 65535;
            if (contour.is_closed || i + 1 < contour.count)
                node.sheets = [0, 1].map(s => sheets[s] += step());
            return node;
        });
    }
    return {smaller, vertex_regions, contours};
}

/* Sets where nodes are, and, of those on edges, both ends of the edge. */
function place_nodes(contours, positions, indices) {
    const point = v => [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]];
    for (const {nodes} of contours) {
        for (const node of nodes) {
            if (node.edge < 0) {
                node.point = point(node.vertex);
                continue;
            }
            const first = node.edge - node.edge % 3;
            node.ends = [point(indices[node.edge]), point(indices[first + (node.edge + 1) % 3])];
            node.point = node.ends[0].map((x, k) => x + node.along * (node.ends[1][k] - x));
        }
    }
}

/* Of more chords in a triangle it is not looked for where they cross, and faces overlap there. */
const CROSSED = 500;

const same = (a, b) => a[0] === b[0] && a[1] === b[1] && a[2] === b[2];
const minus = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => a.map(x => x / Math.sqrt(dot(a, a)));

/* Of vertices that are joined only one may have a region; the others are at the same place. */
function share_regions(vertex_regions, count, positions) {
    const key = v => `${positions[3 * v]} ${positions[3 * v + 1]} ${positions[3 * v + 2]}`;
    const wanting = new Map();
    vertex_regions.forEach((region, v) => {
        if (region < count) return;
        if (!wanting.has(key(v))) wanting.set(key(v), []);
        wanting.get(key(v)).push(v);
    });
    if (!wanting.size) return;
    vertex_regions.forEach((region, v) => {
        if (region < count) for (const other of wanting.get(key(v)) ?? []) vertex_regions[other] = region;
    });
}

/* The chords of each triangle that has any. */
function find_chords(contours) {
    const chords = new Map();
    contours.forEach((contour, c) => {
        contour.nodes.forEach((node, i) => {
            if (!node.sheets) return;
            const next = contour.nodes[(i + 1) % contour.count];
            node.sheets.forEach((triangle, sheet) => {
                if (!chords.has(triangle)) chords.set(triangle, []);
                chords.get(triangle).push({ends: [node, next], sides: contour.sides[sheet]});
            });
        });
    });
    return chords;
}

const area_of = points => points.reduce((sum, a, i) => {
    const b = points[(i + 1) % points.length];
    return sum + (a.x * b.y - b.x * a.y) / 2;
}, 0);

function is_within(points, p) {
    let inside = false;
    points.forEach((a, i) => {
        const b = points[(i + 1) % points.length];
        if (a.y > p.y !== b.y > p.y && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    });
    return inside;
}

/* Where two chords from point a to point b cross, they get a point between. */
function cross_rows(one, other, points) {
    if (one.a === other.a || one.a === other.b || one.b === other.a || one.b === other.b) return;
    const side = (row, p) => {
        const a = points[row.a], b = points[row.b];
        return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    };
    const [u, v] = [other.a, other.b].map(i => side(one, points[i]));
    const [s, t] = [one.a, one.b].map(i => side(other, points[i]));
    if (!(u * v < 0 && s * t < 0)) return;
    const number = points.push(points[one.a].clone().lerp(points[one.b], s / (s - t))) - 1;
    one.between.push({number, along: s / (s - t)});
    other.between.push({number, along: u / (u - v)});
}

/*
 * Cuts a triangle with these corners, whose vertices are in these regions, along chords. Returns
 * pieces, {region, corners: three points}, or null if it is too small to be cut.
 */
function cut(corners, regions, chords) {
    const across = unit(minus(corners[1], corners[0]));
    const normal = unit(cross(across, minus(corners[2], corners[0]))), up = cross(normal, across);
    if (!Number.isFinite(up[0])) return null;
    const flat = p => new Vector2(dot(minus(p, corners[0]), across), dot(minus(p, corners[0]), up));
    const solid = p => corners[0].map((x, k) => x + p.x * across[k] + p.y * up[k]);

    /* Points: corners, then nodes. */
    const points = corners.map(flat), numbers = new Map(), sides = [[], [], []], at_nodes = [];
    const number_of = node => {
        const key = node.edge < 0 ? `${node.vertex}` : `${node.edge} ${node.along}`; /* one at a branch */
        if (numbers.has(key)) return numbers.get(key);
        const place = p => corners.findIndex(corner => same(corner, p));
        let number = node.edge < 0 ? place(node.point) : -1;
        if (number >= 0) {
            at_nodes[number] = true;
        } else {
            number = points.push(flat(node.point)) - 1;
            const [a, b] = node.edge < 0 ? [-1, -1] : node.ends.map(place);
            if (a >= 0 && b >= 0 && a !== b) {
                const is_forward = b === (a + 1) % 3;
                sides[is_forward ? a : b].push({number, along: is_forward ? node.along : 1 - node.along});
            }
        }
        numbers.set(key, number);
        return number;
    };

    /* Half-edges, each from a point to another, with a face on its left. */
    const halves = [], leaving = [];
    const add = (from, to, chord) => {
        const a = points[from], b = points[to];
        const half = {from, to, chord, twin: null, cycle: -1, angle: Math.atan2(b.y - a.y, b.x - a.x)};
        halves.push(half);
        (leaving[from] ??= []).push(half);
        return half;
    };
    const rows = chords.map(chord => chord.ends.map(number_of)).map(([a, b]) => ({a, b, between: []}));
    for (let i = 0; i < rows.length && rows.length <= CROSSED; i++)
        for (let k = 0; k < i; k++) cross_rows(rows[k], rows[i], points);
    rows.forEach(({a, b, between}, i) => {
        between.sort((one, other) => one.along - other.along);
        const row = [a, ...between.map(one => one.number), b];
        for (let k = 0; k + 1 < row.length; k++) {
            if (row[k] === row[k + 1]) continue;
            const there = add(row[k], row[k + 1], chords[i]), back = add(row[k + 1], row[k], chords[i]);
            there.twin = back;
            back.twin = there;
        }
    });
    sides.forEach((side, k) => {
        side.sort((a, b) => a.along - b.along);
        const row = [k, ...side.map(one => one.number), (k + 1) % 3];
        for (let i = 0; i + 1 < row.length; i++) add(row[i], row[i + 1], null);
    });

    /* Behind a half-edge comes what is first clockwise from the way back. */
    const next_of = half => {
        const a = points[half.to], b = points[half.from], back = Math.atan2(b.y - a.y, b.x - a.x);
        let best = null, least = Infinity;
        for (const one of leaving[half.to]) {
            let turn = back - one.angle;
            while (turn <= 0) turn += 2 * Math.PI;
            if (one === half.twin) turn = 2 * Math.PI;
            if (turn < least || best === half.twin) {
                least = turn;
                best = one;
            }
        }
        return best;
    };
    const cycles = [];
    for (const begin of halves) {
        if (begin.cycle >= 0) continue;
        const cycle = {halves: [], region: -1, holes: []};
        for (let half = begin; half && half.cycle < 0; half = next_of(half)) {
            half.cycle = cycles.length;
            cycle.halves.push(half);
        }
        cycle.points = cycle.halves.map(half => points[half.from]);
        cycle.area = area_of(cycle.points);
        cycles.push(cycle);
    }

    /* Others go round a hole of a face. */
    const least = 1e-9 * area_of(points.slice(0, 3));
    const faces = cycles.filter(cycle => cycle.area > least);
    const face_of = new Map(faces.map(face => [face, face]));
    for (const hole of cycles) {
        if (hole.area > least) continue;
        let around = null;
        for (const face of faces) {
            if (face.area > -hole.area && (!around || face.area < around.area) &&
                is_within(face.points, hole.points[0]) && !face.points.includes(hole.points[0]))
                around = face;
        }
        face_of.set(hole, around);
        if (around && hole.area < -least) around.holes.push(hole.points);
    }

    /* Regions: at corners that no contour ends in, then across chords. */
    const known = [];
    for (const face of faces) {
        const half = face.halves.find(one => one.from < 3 && !at_nodes[one.from]);
        if (!half) continue;
        face.region = regions[half.from];
        known.push(face);
    }
    const inner = new Map(faces.map(face => [face, []]));
    for (const cycle of cycles) inner.get(face_of.get(cycle))?.push(...cycle.halves);
    while (known.length) {
        const face = known.pop();
        for (const {chord, twin} of inner.get(face)) {
            const other = twin && face_of.get(cycles[twin.cycle]);
            if (!other || other.region >= 0) continue;
            const side = chord.sides.indexOf(face.region);
            other.region = side < 0 ? face.region : chord.sides[1 - side];
            known.push(other);
        }
    }
    const pieces = [];
    for (const face of faces) {
        const outline = face.points.map(p => p.clone()), holes = face.holes.map(hole => hole.map(p => p.clone()));
        const triangles = outline.length === 3 && !holes.length ? [[0, 1, 2]]
            : ShapeUtils.triangulateShape(outline, holes);
        const every = [outline, ...holes].flat();
        const region = face.region < 0 ? regions[0] : face.region;
        for (const one of triangles) pieces.push({region, corners: one.map(i => solid(every[i]))});
    }
    return pieces;
}

/* The lines of contours, two points each, and the surface by regions: positions, and of each region
   the corners of its triangles. */
export function divide({contours, vertex_regions, smaller}, positions, indices) {
    share_regions(vertex_regions, smaller.length, positions);
    place_nodes(contours, positions, indices);
    const chords = find_chords(contours), parts = new Map(), more = [], lines = [];
    const first = positions.length / 3;
    const part_of = region => {
        if (!parts.has(region)) parts.set(region, []);
        return parts.get(region);
    };
    for (let t = 0; 3 * t < indices.length; t++) {
        const corners = [0, 1, 2].map(k => indices[3 * t + k]);
        const cuts = chords.get(t);
        const pieces = cuts && cut(corners.map(v => [...positions.subarray(3 * v, 3 * v + 3)]),
            corners.map(v => vertex_regions[v]), cuts);
        if (!pieces) part_of(vertex_regions[corners[0]]).push(...corners);
        for (const piece of pieces || []) {
            for (const corner of piece.corners) {
                part_of(piece.region).push(first + more.length / 3);
                more.push(...corner);
            }
        }
    }
    for (const {nodes, count, is_closed} of contours) {
        for (let i = 0; i + !is_closed < count; i++) lines.push(...nodes[i].point, ...nodes[(i + 1) % count].point);
    }
    const all = new Float32Array(positions.length + more.length);
    all.set(positions);
    all.set(more, positions.length);
    return {positions: all, parts, lines: new Float32Array(lines)};
}
