/*
 * What the package for npm answers about meshes, as lines of text: those that answers.c prints. Runs
 * in Node and in browsers.
 *
 * SPDX-License-Identifier: MIT
 */
const POSES = 3;

/* Positions and triangles of an OBJ file whose faces are triangles. */
export function read_obj(text) {
    const positions = [], triangles = [];
    for (const line of text.split('\n')) {
        const [kind, ...rest] = line.trim().split(/\s+/);
        if (kind === 'v') positions.push(...rest.slice(0, 3).map(Number));
        else if (kind === 'f') triangles.push(...rest.map(corner => parseInt(corner, 10) - 1));
    }
    return {positions: Float64Array.from(positions), triangles: Uint32Array.from(triangles)};
}

/* As it is, sheared, and folded. */
function move(rest, number) {
    const to = rest.slice();
    for (let i = 0; i < rest.length; i += 3) {
        const [x, y, z] = rest.subarray(i, i + 3);
        if (number === 1) to[i + 2] = z * 0.5 + x * y;
        if (number === 2) to[i] = x * x - 0.25 * y;
    }
    return to;
}

/* Some numbers of each of several arrays in turn. */
function* rows(count, ...columns) {
    for (let i = 0; i < count; ++i)
        for (const [array, width] of columns) yield array.subarray(width * i, width * (i + 1));
}

export function answers({Model}, name, text) {
    const {positions: rest, triangles} = read_obj(text), lines = [];
    const model = new Model(rest, triangles);
    let sum = 2166136261;
    const add = array => {
        const bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
        for (const byte of bytes) sum = Math.imul(sum ^ byte, 16777619);
    };
    const tell = (pose, what, count) => {
        lines.push(`${name} ${pose} ${what} ${count} ${(sum >>> 0).toString(16).padStart(8, '0')}`);
        sum = 2166136261;
    };
    const add_stencils = ({feature, vertices, weights, vector, distance}) => {
        const columns = [[feature, 1], [vertices, 4], [weights, 4], [vector, 3], [distance, 1]];
        for (const some of rows(feature.length, ...columns)) add(some);
    };
    const add_trace = (pose, found, i) => {
        const traced = model.trace(pose, found), {nodes, contours} = traced, count = nodes.edge.length;
        const of_nodes = [[nodes.edge, 1], [nodes.triangle, 1], [nodes.sheet, 1], [nodes.sheets, 2],
            [nodes.along, 1], [nodes.weights, 3], [nodes.point, 3]];
        const of_contours = ['first', 'count', 'begin', 'end', 'flags', 'length'].map(name => [contours[name], 1]);
        for (const some of rows(count, ...of_nodes)) add(some);
        for (const some of rows(contours.first.length, ...of_contours)) add(some);
        tell(i, 'trace', count);
        const {vertices, flags, weights, vectors} = model.traceGradients(pose, traced);
        for (const some of rows(count, [vertices, 5], [flags, 1], [weights, 5], [vectors, 6])) add(some);
        tell(i, 'gradients', count);
        const {triangles: three, nodes: at, along, point} = model.traceTriples(pose, traced);
        for (const some of rows(point.length / 3, [three, 3], [at, 3], [along, 3], [point, 3])) add(some);
        tell(i, 'triples', point.length / 3);
        const {regions, vertexRegions, sides} = model.regions(pose, traced, {inside: true});
        const of_regions = ['component', 'vertexCount', 'area', 'inside'].map(name => [regions[name], 1]);
        for (const some of rows(regions.area.length, ...of_regions)) add(some);
        for (const array of [vertexRegions, sides]) add(array);
        tell(i, 'regions', regions.area.length);
    };
    const size = rest.reduce((a, b) => Math.max(a, b)) - rest.reduce((a, b) => Math.min(a, b));
    for (let i = 0; i < POSES; ++i) {
        const pose = move(rest, i), end = move(rest, (i + 1) % POSES);
        for (const pairs of ['triangle', 'edge']) {
            const found = model.query(pose, {pairs}), count = found.length / 2;
            add(found);
            tell(i, `${pairs}s`, count);
            const {kind, points, weightsA, weightsB} = model.contacts(pose, found, {pairs});
            for (const some of rows(count, [kind, 1], [points, 6], [weightsA, 6], [weightsB, 6])) add(some);
            tell(i, 'contacts', count);
            if (pairs === 'edge') add_trace(pose, found, i);
        }
        const near = model.near(pose, size / 64, {stencils: true, vertexBound: true});
        const count = (near.vertexFaces.length + near.edgeEdges.length) / 2;
        for (const array of [near.vertexFaces, near.edgeEdges, near.vertexBound]) add(array);
        tell(i, 'near', count);
        add_stencils(near.vertexFaceStencils);
        add_stencils(near.edgeEdgeStencils);
        tell(i, 'stencils', count);
        const step = model.step(pose, end, {separation: size / 64 / 4});
        for (const array of [step.vertexFaces, step.edgeEdges]) add(array);
        for (const array of [step.vertexFaceTimes, step.edgeEdgeTimes]) add(array);
        add(Float64Array.of(step.earliest));
        for (const some of [
            model.stepStencils(pose, end, step.vertexFaces, step.vertexFaceTimes, 'vertex_face'),
            model.stepStencils(pose, end, step.edgeEdges, step.edgeEdgeTimes, 'edge_edge')
        ]) {
            add_stencils(some.start);
            add_stencils(some.impact);
            for (const array of [some.time, some.normal, some.side, some.flags]) add(array);
        }
        tell(i, 'step', (step.vertexFaces.length + step.edgeEdges.length) / 2);
    }
    const saved = model.toBytes();
    model.free();
    return {lines, saved};
}
