/*
 * Times queries of the package for npm on the frames of a scene, one after the other, as
 * `sc-bench --once` does: positions copied in and pairs copied out are part of a query.
 *
 *     node bench/wasm_times.mjs PACKAGE FOLDER FRAMES REPEATS     PACKAGE: its index.js; FOLDER: as
 *                                              `sc-bench --export` writes it; FRAMES: at most so many
 *
 * Prints the mean over the frames of each one's median of REPEATS walks, in milliseconds, and how
 * many pairs there are in all.
 *
 * SPDX-License-Identifier: MIT
 */
import {existsSync, readFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [where, folder, most, repeats] = process.argv.slice(2);
const {Model} = await import(pathToFileURL(resolve(where)).href);

const words = name => {
    const {buffer, byteOffset, byteLength} = readFileSync(`${folder}/${name}`);
    return buffer.slice(byteOffset, byteOffset + byteLength);
};
const triangles = new Uint32Array(words('tris.u32'));
const all = existsSync(`${folder}/frames.f32`) ? new Float32Array(words('frames.f32'))
    : new Float64Array(words('frames.f64'));
const [, vertices] = readFileSync(`${folder}/meta.txt`, 'utf8').split(' '); // triangles come first
const frames = [];
for (let i = 0; i < all.length && frames.length < most; i += 3 * vertices)
    frames.push(all.subarray(i, i + 3 * vertices));

const model = new Model(frames[0], triangles), times = frames.map(() => []);
let pairs = 0;
for (let walk = 0; walk <= repeats; ++walk) // the first compiles, and is not counted
    for (const [i, frame] of frames.entries()) {
        const begin = performance.now(), found = model.query(frame);
        if (walk) times[i].push(performance.now() - begin);
        else pairs += found.length / 2;
    }
const median = list => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
const mean = times.map(median).reduce((sum, time) => sum + time, 0) / frames.length;
console.log(mean.toFixed(3), pairs);
