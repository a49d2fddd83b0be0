/*
 * Meshes from the bytes of files: OBJ here, as doubles; PLY and STL by three.js, as floats.
 *
 * SPDX-License-Identifier: MIT
 */
import {PLYLoader} from 'three/addons/loaders/PLYLoader.js';
import {STLLoader} from 'three/addons/loaders/STLLoader.js';

/* Polygons become fans. */
function read_obj(text) {
    const positions = [], triangles = [];
    for (const line of text.split('\n')) {
        const [kind, ...words] = line.trim().split(/\s+/);
        if (kind === 'v') positions.push(...words.slice(0, 3).map(Number));
        if (kind !== 'f') continue;
        const corners = words.map(word => {
            const number = parseInt(word, 10); // from 1, or backwards from the last vertex
            return number < 0 ? positions.length / 3 + number : number - 1;
        });
        for (let i = 2; i < corners.length; ++i) triangles.push(corners[0], corners[i - 1], corners[i]);
    }
    if (triangles.some(vertex => !(vertex >= 0))) throw new Error('a face names a vertex that is none');
    return {positions: Float64Array.from(positions), triangles: Uint32Array.from(triangles)};
}

/* Positions, three a vertex, and triangles; equal positions are joined by the library. */
export function read_mesh(name, buffer) {
    const kind = name.split('.').pop().toLowerCase();
    if (kind === 'obj') return read_obj(new TextDecoder().decode(buffer));
    if (kind !== 'ply' && kind !== 'stl') throw new Error(`${name} is neither OBJ nor PLY nor STL`);
    const geometry = kind === 'ply' ? new PLYLoader().parse(buffer) : new STLLoader().parse(buffer);
    const {position} = geometry.attributes;
    if (!position?.count || (kind === 'ply' && !geometry.index)) throw new Error(`${name} has no faces`);
    // STL has three corners of its own for each triangle.
    const triangles = geometry.index ? Uint32Array.from(geometry.index.array)
        : Uint32Array.from({length: position.count}, (_, i) => i);
    return {positions: Float32Array.from(position.array), triangles};
}
