/*
 * A page that finds self-collisions while one looks: of a cloth that the mouse pulls, and of meshes
 * and animations that are dropped onto it. Faces that collide are red.
 *
 * SPDX-License-Identifier: MIT
 */
import {BufferAttribute, BufferGeometry, Plane, Raycaster, Vector2, Vector3} from 'three';

import {Model, version} from './index.js';
import {read_mesh} from './read_mesh.js';
import {Sheet} from './sheet.js';
import {at, color_of, fit_to_room, make_view, plural} from './view.js'; // of tools/page

/* ------------------------------------------------------------------------------------------------
 * The view
 */

const view = make_view(['#dc1e1e']);
const {canvas, renderer, camera, controls, scene, surface, all, hits} = view;

function paint() {
    renderer.setClearColor(color_of('--ground'));
    surface.color = color_of('--mesh');
}

/* For floats, all is told from the middle of what is first seen: far from the origin they are
   coarse. */
let origin = [0, 0, 0];

/* Shows other triangles, from where all of them are seen. */
function show_mesh(positions, triangles, direction) {
    const low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
    for (let i = 0; i < positions.length; ++i) {
        low[i % 3] = Math.min(low[i % 3], positions[i]);
        high[i % 3] = Math.max(high[i % 3], positions[i]);
    }
    origin = low.map((x, k) => (x + high[k]) / 2);
    const size = Math.hypot(...low.map((x, k) => high[k] - x)) || 1;
    for (const object of [all, hits]) object.geometry.dispose();
    const shared = new BufferAttribute(new Float32Array(positions.length), 3);
    all.geometry = new BufferGeometry().setAttribute('position', shared);
    all.geometry.setIndex(new BufferAttribute(triangles, 1));
    hits.geometry = new BufferGeometry().setAttribute('position', shared);
    hits.geometry.setIndex(new BufferAttribute(new Uint32Array(triangles.length), 1));
    const half = Math.tan(camera.fov * Math.PI / 360) * Math.min(1, camera.aspect);
    camera.near = size / 500;
    camera.far = size * 20;
    camera.updateProjectionMatrix();
    controls.target.set(0, 0, 0);
    camera.position.copy(direction).setLength(0.6 * size / half);
    controls.update();
}

/* Shows a pose of them, and which of them are in pairs. */
function show_pose(positions, triangles, pairs) {
    const place = all.geometry.attributes.position, index = hits.geometry.index;
    for (let i = 0; i < positions.length; ++i) place.array[i] = positions[i] - origin[i % 3];
    place.needsUpdate = true;
    const colliding = new Set(pairs);
    let count = 0;
    for (const triangle of colliding)
        for (let k = 0; k < 3; ++k) index.array[count++] = triangles[3 * triangle + k];
    index.needsUpdate = true;
    hits.geometry.setDrawRange(0, count);
    state.faces = colliding.size;
}

/* ------------------------------------------------------------------------------------------------
 * What is shown: the cloth, or frames from files
 */

const state = {
    ready: false, mode: '', error: '',
    pairs: 0, faces: 0, number: 0, drawn: 0, // faces that collide; which frame; how often drawn
    query: 0, frame: 0 // milliseconds
};
let sheet = null, frames = [], playing = false, must_show = false;

function say(...parts) {
    at('said').textContent = parts.join(', ');
}

const milliseconds = time => `${time.toFixed(time < 10 ? 2 : 1)} ms`;

/* A mean over the last frames, as single times jump. */
function smooth(name, time, is_first) {
    state[name] = is_first ? time : 0.9 * state[name] + 0.1 * time;
}

function hang_up() {
    for (const model of new Set(frames.map(frame => frame.model))) model.free();
    sheet?.free();
    frames = [];
    sheet = new Sheet(Model, 48);
    state.mode = 'cloth';
    state.query = state.frame = 0;
    at('title').textContent = `A cloth of ${plural(sheet.triangles.length / 3, 'triangle')}`;
    for (const id of ['play', 'slider']) at(id).hidden = true;
    at('apart').disabled = false;
    show_mesh(sheet.positions, sheet.triangles, new Vector3(0.5, 0.2, 1));
}

function step_cloth() {
    const begin = performance.now();
    const near = sheet.step(at('apart').getAttribute('aria-pressed') === 'true');
    const middle = performance.now(), pairs = sheet.model.query(sheet.positions);
    const end = performance.now();
    show_pose(sheet.positions, sheet.triangles, pairs);
    smooth('query', end - middle + near, !state.query);
    smooth('frame', end - begin, !state.frame);
    state.pairs = pairs.length / 2;
    say(plural(state.pairs, 'pair'), `${milliseconds(state.query)} to find what collides`,
        `${milliseconds(state.frame)} with the cloth's motion`);
}

const same = (a, b) => a.length === b.length && a.every((x, i) => x === b[i]);

/* Files are frames in the order of their names; those with the same faces share a model. */
async function open_files(files) {
    try {
        const order = new Intl.Collator('en', {numeric: true}).compare, made = [];
        for (const file of [...files].sort((a, b) => order(a.name, b.name))) {
            const mesh = read_mesh(file.name, await file.arrayBuffer()), last = made.at(-1);
            const goes_on = last && last.positions.length === mesh.positions.length &&
                same(last.triangles, mesh.triangles);
            const begin = performance.now();
            const model = goes_on ? last.model : new Model(mesh.positions, mesh.triangles);
            const triangles = goes_on ? last.triangles : mesh.triangles;
            const build = goes_on ? 0 : performance.now() - begin;
            made.push({name: file.name, positions: mesh.positions, triangles, model, build});
        }
        if (!made.length) return;
        for (const model of new Set(frames.map(frame => frame.model))) model.free();
        sheet?.free();
        sheet = null;
        frames = made;
        state.mode = 'frames';
        state.error = '';
        at('apart').disabled = true;
        at('slider').max = frames.length - 1;
        for (const id of ['play', 'slider']) at(id).hidden = frames.length < 2;
        show_mesh(frames[0].positions, frames[0].triangles, new Vector3(0.5, 0.4, 1));
        play(frames.length > 1);
        go_to(0);
    } catch (error) {
        state.error = error.message;
        at('hint').textContent = `Not shown: ${error.message}`;
    }
}

function go_to(number) {
    const changes = frames[number].triangles !== frames[state.number]?.triangles;
    if (changes) show_mesh(frames[number].positions, frames[number].triangles, new Vector3(0.5, 0.4, 1));
    state.number = number;
    at('slider').value = number;
    must_show = true;
}

function play(wanted) {
    playing = wanted;
    at('play').setAttribute('aria-pressed', wanted);
}

function show_frame() {
    const {model, name, positions, triangles, build} = frames[state.number];
    const begin = performance.now(), pairs = model.query(positions);
    state.query = state.frame = performance.now() - begin;
    show_pose(positions, triangles, pairs);
    state.pairs = pairs.length / 2;
    at('title').textContent = name;
    say(`${plural(state.pairs, 'pair')} of ${plural(triangles.length / 3, 'triangle')}`,
        `${milliseconds(state.query)} to find them`, build ? `${milliseconds(build)} to prepare the mesh` : 'a pose of the first mesh');
}

/* ------------------------------------------------------------------------------------------------
 * The mouse
 */

const ray = new Raycaster();
const plane = new Plane();

function aim(event) {
    const {left, top, width, height} = canvas.getBoundingClientRect();
    ray.setFromCamera(new Vector2(2 * (event.clientX - left) / width - 1,
        1 - 2 * (event.clientY - top) / height), camera);
}

/* Before OrbitControls hears of it: the cloth is pulled, all else turns. */
canvas.addEventListener('pointerdown', event => {
    if (!sheet || event.button !== 0) return;
    aim(event);
    all.geometry.computeBoundingSphere();
    const [hit] = ray.intersectObject(all);
    if (!hit) return;
    plane.setFromNormalAndCoplanarPoint(camera.getWorldDirection(new Vector3()), hit.point);
    sheet.grab(hit.face.a, hit.point.toArray().map((x, k) => x + origin[k]));
    controls.enabled = false;
    canvas.setPointerCapture(event.pointerId);
    event.stopImmediatePropagation();
}, {capture: true});
canvas.addEventListener('pointermove', event => {
    if (!sheet?.grabbed) return;
    aim(event);
    const point = ray.ray.intersectPlane(plane, new Vector3());
    if (point) sheet.pull(point.toArray().map((x, k) => x + origin[k]));
});
for (const kind of ['pointerup', 'pointercancel'])
    canvas.addEventListener(kind, () => {
        sheet?.let_go();
        controls.enabled = true;
    });

addEventListener('dragover', event => {
    event.preventDefault();
    document.body.classList.add('over');
});
addEventListener('dragleave', () => document.body.classList.remove('over'));
addEventListener('drop', event => {
    event.preventDefault();
    document.body.classList.remove('over');
    open_files(event.dataTransfer.files);
});
at('files').addEventListener('change', () => open_files(at('files').files));
at('cloth').addEventListener('click', hang_up);
at('apart').addEventListener('click', () => {
    at('apart').setAttribute('aria-pressed', at('apart').getAttribute('aria-pressed') !== 'true');
    hang_up(); // what is through itself already could not be kept apart
});
at('play').addEventListener('click', () => play(!playing));
at('slider').addEventListener('input', () => {
    play(false);
    go_to(Number(at('slider').value));
});

let last = 0;
function turn(time) {
    requestAnimationFrame(turn);
    if (sheet) step_cloth();
    else {
        if (playing && time - last > 40) {
            go_to((state.number + 1) % frames.length);
            last = time;
        }
        if (must_show) show_frame();
        must_show = false;
    }
    controls.update();
    renderer.render(scene, camera);
    ++state.drawn;
    state.ready = true;
}

new ResizeObserver(() => fit_to_room(view)).observe(at('view'));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', paint);
fit_to_room(view);
paint();
hang_up();
requestAnimationFrame(turn);

/* For tests: what is shown, and where a vertex is on the page. */
window.starcontour = {
    version,
    state: () => ({...state}),
    project(vertex) {
        const {left, top, width, height} = canvas.getBoundingClientRect();
        const point = new Vector3().fromBufferAttribute(all.geometry.attributes.position, vertex).project(camera);
        return [left + (1 + point.x) / 2 * width, top + (1 - point.y) / 2 * height];
    }
};
