/*
 * Tests the package for npm in Node, as npm packs and installs it.
 *
 *     node tests/wasm/package.mjs PACKAGE FOLDER FILE.obj...    prints "ok NAME" or "not ok NAME: why"
 *
 * PACKAGE: its index.js. FOLDER: what answers.c wrote, its lines as native.txt.
 *
 * SPDX-License-Identifier: MIT
 */
import {readFileSync} from 'node:fs';
import {basename, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

import {answers, read_obj} from './answers.mjs';

const [where, folder, ...files] = process.argv.slice(2);

// The library's memory, which the package keeps to itself.
const {instantiate} = WebAssembly;
let memory;
WebAssembly.instantiate = async (...all) => {
    const made = await instantiate(...all);
    memory = made.instance.exports.memory;
    return made;
};
const package_ = await import(pathToFileURL(resolve(where)).href);
const {Incomplete, Model, StarcontourError, edgeVertices, version} = package_;

function check(name, is_true, why = '') {
    console.log(is_true ? `ok ${name}` : `not ok ${name}: ${why}`);
}

/* Whether a call throws an error of this kind that says so, and of this status. */
function refuses(name, kind, words, call, status) {
    try {
        const answer = call();
        check(name, false, `returned ${answer}`);
    } catch (error) {
        const is_so = error instanceof kind && words.test(error.message) && error.status === status;
        check(name, is_so, `${error.name} ${error.status}: ${error.message}`);
    }
}

const same = (a, b) => a.length === b.length && a.every((number, i) => number === b[i]);

// The same answers as native.
const wanted = readFileSync(`${folder}/native.txt`, 'utf8').trimEnd().split('\n');
const lines = [];
for (const file of files) {
    const name = basename(file), answer = answers(package_, name, readFileSync(file, 'utf8'));
    lines.push(...answer.lines);
    check(`the bytes of ${name} are those of sc_model_save`,
        Buffer.compare(readFileSync(`${folder}/${name}.scm`), answer.saved) === 0);
}
const others = lines.filter((line, i) => line !== wanted[i]);
check('there are pairs', lines.some(line => Number(line.split(' ')[3]) > 100));
check(`${lines.length} answers are those of the library here`,
    lines.length === wanted.length && lines.length > 0 && !others.length, others.slice(0, 3).join('; '));

// The example of README.md.
const rest = [0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 1, 2, 1, 1, 1, 2, 1], triangles = [0, 1, 2, 3, 4, 5];
const pose = rest.slice();
pose[11] = -1;
const model = new Model(rest, triangles);
check('a version', /^\d+\.\d+\.\d+$/.test(version), version);
check('the example', same(model.query(pose), [0, 1]));
check('of floats, too', same(model.query(Float32Array.from(pose)), [0, 1]));
check('and of a part of an array',
    same(model.query(Float64Array.from([7, ...pose, 7]).subarray(1, 19)), [0, 1]));
check('floats are not rounded doubles', model.count(Float32Array.from(pose)) === 1);
check('apart at rest', model.query(rest).length === 0 && !model.collides(rest) && model.collides(pose));
check('info', model.info.vertexCount === 6 && model.info.triangleCount === 2 && model.info.modelBytes > 0,
    JSON.stringify(model.info));
check('edges', same(edgeVertices(triangles, [0, 2, 5]), [0, 1, 2, 0, 5, 3]));
check('a smaller distance', same(model.nearCounts(rest, 0.99), [0, 0]) && !model.isNear(rest, 0.99));
check('the distance itself', same(model.nearCounts(rest, 1), [3, 0]) && model.isNear(rest, 1));
check('kinds', same(model.nearCounts(rest, 2, {kinds: 'edge_edge'}), [0, 9]));
check('a rest pose', same(model.nearCounts(rest, 1, {rest, restDistance: 1}), [0, 0]));
const ignore = model.near(rest, 1);
check('pairs to ignore', same(model.nearCounts(rest, 1, {ignore}), [0, 0]));
check('of a query', model.count(pose, {ignore: model.query(pose)}) === 0);
const step = model.step(rest, pose);
check('a step', same(step.vertexFaces, [3, 0]) && step.earliest > 0.49 && step.earliest < 0.5, step.earliest);
check('collides', model.stepCollides(rest, pose) && !model.stepCollides(rest, rest));
check('welding', new Model(rest, triangles, {weld: 'none'}).info.pointCount === 6 &&
    new Model(rest, triangles, {weld: [0, 1, 2, 0, 4, 5]}).info.pointCount === 5);
const boxes = new Model(rest, triangles, {boxes: true});
check('boxes', same(boxes.query(pose), [0, 1]) && boxes.info.modelBytes < model.info.modelBytes);

// Who collides with whom: categories 1 and 2, which want each other, themselves or nobody.
const groups = (...masks) => masks.flatMap((mask, i) => [1 + Math.floor(i * 2 / masks.length), mask]);
const both = {triangleGroups: groups(2, 1)}, own = {triangleGroups: groups(1, 2)};
check('groups of triangles', model.count(pose, both) === 1 && model.count(pose, own) === 0);
check('groups of vertices', model.count(pose, {vertexGroups: groups(2, 2, 2, 1, 1, 1)}) === 1 &&
    model.count(pose, {vertexGroups: groups(1, 1, 1, 2, 2, 2)}) === 0);
check('of what is near', same(model.nearCounts(rest, 1, own), [0, 0]) && same(model.nearCounts(rest, 1, both), [3, 0]));
check('of steps', !model.stepCollides(rest, pose, own) && model.stepCollides(rest, pose, both));
const left = model.step(rest, pose, {candidates: true});
check('candidates', left.vertexFaces.length >= 2 && left.vertexFaceTimes === null && left.earliest === 0);
const impact = model.stepStencils(rest, pose, step.vertexFaces, step.vertexFaceTimes, 'vertex_face');
check('closest points of a step', impact.start.distance[0] === 1 && impact.impact.distance[0] < 1e-5 &&
    impact.time[0] === step.earliest && Math.abs(impact.normal[2]) === 1 && impact.side[0] === 1 && impact.flags[0] === 1,
    JSON.stringify(impact));
const {length, gradient} = model.traceLength(pose), traced = model.trace(pose);
check('contours', length > 0 && gradient.length === rest.length && traced.contours.begin[0] === 1 &&
    traced.nodes.point.length === 3 * traced.nodes.edge.length, JSON.stringify(traced));
const squares = [0, -4, -4, 0, 12, -4, 0, -4, 12, -4, 1, -4, 12, 1, -4, -4, 1, 12, -4, -4, 2, 12, -4, 2, -4, 12, 2];
const triples = new Model(squares, [0, 1, 2, 3, 4, 5, 6, 7, 8], {weld: 'none'}).traceTriples(squares);
check('triples', same(triples.triangles, [0, 1, 2]) && triples.point.every((x, i) => Math.abs(x - i) < 1e-14) &&
    model.traceTriples(pose, traced).point.length === 0, JSON.stringify(triples));
const {regions} = model.regions(pose);
check('regions', same(regions.area, [8, 0.375, 1.125]) && same(regions.vertexCount, [3, 1, 2]), JSON.stringify(regions));
check('an order', same(new Model(rest, triangles, {order: [1, 0]}).query(pose), [0, 1]));

// All methods, and a copy, on a mesh with many pairs.
const roll = read_obj(readFileSync(files.find(file => file.endsWith('touching_cubes.obj')), 'utf8'));
const large = new Model(roll.positions, roll.triangles), all = large.query(roll.positions);
check('many pairs', all.length > 20, all.length);
for (const method of ['sctt', 'aabb_sctt', 'aabb'])
    check(`by ${method}`, same(large.query(roll.positions, {method}), all));
const copy = Model.fromBytes(large.toBytes());
check('of saved bytes', same(copy.query(roll.positions), all));
check('without neighbors', large.count(roll.positions, {ignoreRings: 1}) <= all.length / 2);
try {
    large.query(roll.positions, {budget: 1});
    check('a budget', false, 'it ended');
} catch (error) {
    check('a budget', error instanceof Incomplete && error.found instanceof Uint32Array && error.status === 28, error);
}

// More pairs than there was room for, and memory that grows meanwhile: n triangles at one place.
const pile = 600, corners = [0, 0, 0, 1, 0, 0, 0, 1, 0];
const places = Array(pile).fill(corners).flat();
const flat = new Model(places, [...Array(3 * pile).keys()], {weld: 'none'});
const pairs = flat.query(places);
check('all of a pile', pairs.length === pile * (pile - 1) && pairs[0] === 0 && pairs.at(-1) === pile - 1, pairs.length);

// What is refused.
const doubles = Float64Array.from(rest);
refuses('too few numbers', RangeError, /three numbers/, () => model.query([1, 2]));
refuses('too few vertices', StarcontourError, /vertex_count is 1/, () => model.query([1, 2, 3]), 9);
refuses('NaN', StarcontourError, /vertex 1 is NaN/, () => model.query(doubles.with(3, NaN)), 8);
refuses('no array', TypeError, /pose must be/, () => model.query('abc'));
refuses('no numbers', TypeError, /pose must be/, () => model.query(['1', '2', '3']));
refuses('whole numbers as positions', TypeError, /pose must be/, () => model.query(new Int32Array(18)));
refuses('no such option', TypeError, /no option pair/, () => model.query(pose, {pair: 'edge'}));
refuses('no such value', RangeError, /pairs must be one of/, () => model.query(pose, {pairs: 'edges'}));
refuses('a negative distance', StarcontourError, /^distance is -1/, () => model.near(pose, -1), 3);
refuses('no distance', TypeError, /distance must be a number/, () => model.near(pose));
refuses('a negative budget', RangeError, /budget/, () => model.query(pose, {budget: -1}));
refuses('rings', StarcontourError, /ignore_rings is 99/, () => model.query(pose, {ignoreRings: 99}), 3);
refuses('unsorted pairs', StarcontourError, /ignore/, () => large.query(roll.positions, {ignore: [1, 2, 0, 1]}), 27);
refuses('half a pair', RangeError, /2 numbers/, () => model.contacts(pose, [1]));
refuses('foreign contours', TypeError, /what trace returned/, () => model.traceGradients(pose, {}));
refuses('too many pairs for a trace', StarcontourError, /./, () => model.trace(pose, [3, 0, 0, 3]), 27);
refuses('no such pair', StarcontourError, /./, () => model.contacts(pose, [0, 2]), 27);
refuses('no such kind', RangeError, /kind must be/, () => model.stencils(pose, [0, 1], ''));
refuses('an index', StarcontourError, /triangle 0 names vertex 9/, () => new Model(rest, [0, 1, 9]), 7);
refuses('a negative index', RangeError, /triangles/, () => new Model(rest, [0, 1, -1]));
refuses('half an index', RangeError, /triangles/, () => new Model(rest, [0, 1, 0.5]));
refuses('no triangle', StarcontourError, /no triangles/, () => new Model(rest, []), 4);
refuses('a weld map', StarcontourError, /./, () => new Model(rest, triangles, {weld: [9, 9, 9, 9, 9, 9]}), 13);
refuses('a short one', RangeError, /weld/, () => new Model(rest, triangles, {weld: [0]}));
refuses('no permutation', StarcontourError, /./, () => new Model(rest, triangles, {order: [1, 1]}), 14);
refuses('too few groups', RangeError, /vertexGroups must have 12/, () => model.query(pose, {vertexGroups: [1, 1]}));
refuses('too few times', TypeError, /times must be/, () => model.stepStencils(rest, pose, [3, 0], [], 'vertex_face'));
refuses('a time', StarcontourError, /./, () => model.stepStencils(rest, pose, [3, 0], Float64Array.of(2), 'vertex_face'), 3);
refuses('a boxes-only model', StarcontourError, /./, () => boxes.query(pose, {method: 'sctt'}), 29);
refuses('no bytes', TypeError, /Uint8Array/, () => Model.fromBytes([1, 2]));
refuses('foreign bytes', StarcontourError, /./, () => Model.fromBytes(new Uint8Array(99)), 19);
refuses('too few bytes', StarcontourError, /./, () => Model.fromBytes(large.toBytes().subarray(0, 999)), 20);
refuses('an edge', RangeError, /no edge 6/, () => edgeVertices(triangles, [6]));
check('and all goes on', same(model.query(pose), [0, 1]));

// Memory comes back: the second time around, none is needed that was not there.
function come_and_go() {
    for (let i = 0; i < 300; ++i) {
        const one = Model.fromBytes(large.toBytes());
        one.isNear(roll.positions, 0);
        one.free();
        one.free();
    }
    return memory.buffer.byteLength;
}
const before = come_and_go(), after = come_and_go();
check('memory comes back', before === after, `${before} bytes, then ${after}`);
refuses('a freed model', TypeError, /freed/, () => { model.free(); model.query(pose); });
if (Symbol.dispose) check('dispose', Model.prototype[Symbol.dispose] === Model.prototype.free);
