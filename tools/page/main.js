/*
 * The page that sc-query --html writes: a mesh that turns, its colliding faces, and the places where
 * they are; with --trace contours in place of places, and the regions that they divide it into.
 *
 * SPDX-License-Identifier: MIT
 *
 * The data stand before this script, in blocks that a browser does not run; tools/page_write.h says
 * what is in them. A frame is decoded when it is looked at.
 */
import {
    Box3, Box3Helper, BufferAttribute, BufferGeometry, Color, DoubleSide, LineBasicMaterial, LineSegments,
    MeshLambertMaterial, Vector3
} from 'three';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';
import {LineSegments2} from 'three/addons/lines/LineSegments2.js';
import {LineSegmentsGeometry} from 'three/addons/lines/LineSegmentsGeometry.js';
import {divide, read_contours} from './contours.js';
import {at, color_of, fit_to_room, make_view, plural} from './view.js';

const is_picture = location.hash === '#picture';
const still = matchMedia('(prefers-reduced-motion: reduce)').matches;

/* -------------------------------------------------------------------------------------------------
 * Data
 */

const frames = [...document.querySelectorAll('script[data-frame]')].map(s => JSON.parse(s.textContent));
const has_contours = frames.some(info => info.regions !== undefined); /* of --trace: all have */
const block = name => document.querySelector(`script[data-block="${name}"]`).textContent;

async function bytes_of(name) {
    const text = atob(block(name));
    const packed = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/* Numbers of seven bits a byte, the low ones first; the lowest bit of a number is its sign. */
class Numbers {
    constructor(bytes, begin) { this.bytes = bytes; this.at = begin; this.last = 0; }
    next() {
        let value = 0, scale = 1, byte;
        do {
            byte = this.bytes[this.at++];
            value += (byte & 127) * scale;
            scale *= 128;
        } while (byte & 128);
        return value;
    }
    step() { /* a number, told by how far it is from the one before */
        const value = this.next();
        this.last += value % 2 ? -(value + 1) / 2 : value / 2;
        return this.last;
    }
}

const meshes = new Map();
function mesh_of(number) {
    if (!meshes.has(number)) {
        meshes.set(number, bytes_of(`mesh-${number}`).then(bytes => {
            const numbers = new Numbers(bytes, 0), indices = new Uint32Array(numbers.next());
            for (let i = 0; i < indices.length; i++) indices[i] = numbers.step();
            return indices;
        }));
    }
    return meshes.get(number);
}

/* Sixteen bits a coordinate: all of x, then y, then z; of each the low bytes, then the high ones, of
   steps from vertex to vertex. */
function decode_positions(bytes, count, info) {
    const out = new Float32Array(3 * count);
    for (let k = 0; k < 3; k++) {
        const low = 2 * k * count, high = low + count;
        const scale = (info.high[k] - info.low[k]) / 65535;
        let value = 0;
        for (let v = 0; v < count; v++) {
            const step = bytes[low + v] | bytes[high + v] << 8;
            value = (value + (step & 1 ? ~(step >> 1) : step >> 1)) & 65535;
            out[3 * v + k] = info.low[k] + scale * value - info.origin[k];
        }
    }
    return out;
}

async function decode_frame(info) {
    const [indices, bytes] = await Promise.all([mesh_of(info.mesh), bytes_of(`frame-${info.number}`)]);
    const positions = decode_positions(bytes, info.vertices, info);
    const numbers = new Numbers(bytes, 6 * info.vertices);
    if (has_contours) {
        const read = read_contours(numbers, info.vertices);
        return {indices, read, ...divide(read, positions, indices)};
    }
    const sizes = Array.from({length: numbers.next()}, () => numbers.next());
    const colliding = new Uint32Array(3 * sizes.reduce((sum, size) => sum + size, 0));
    for (let i = 0; i < colliding.length; i += 3) {
        const triangle = numbers.step();
        for (let k = 0; k < 3; k++) colliding[i + k] = indices[3 * triangle + k];
    }
    const segments = new Float32Array(6 * info.segments);
    for (let i = 0, from = numbers.at; i < segments.length; i++, from += 2) {
        const k = i % 3, value = bytes[from] | bytes[from + 1] << 8;
        segments[i] = info.low[k] + (info.high[k] - info.low[k]) * value / 65535 - info.origin[k];
    }
    return {positions, indices, sizes, colliding, segments};
}

const decoded = new Map(); /* the last few frames, as promises */
function frame_of(number) {
    if (!decoded.has(number)) {
        decoded.set(number, decode_frame(frames[number]));
        if (decoded.size > 24) decoded.delete(decoded.keys().next().value);
    }
    return decoded.get(number);
}

/* For floats, all is told from the middle of the first frame on: far from the origin they are
   coarse. */
const origin = frames.length ? frames[0].low.map((x, k) => (x + frames[0].high[k]) / 2) : [0, 0, 0];
for (const info of frames) info.origin = origin;

/* -------------------------------------------------------------------------------------------------
 * The view
 */

const palette = ['#dc1e1e', '#1e6edc', '#f09614', '#149650', '#a03cbe', '#e65a96', '#14a0b4', '#96781e'];
const view = make_view(palette);
const {canvas, renderer, camera, controls, scene, surface, paints, all, hits} = view;
const lines = new LineSegments(new BufferGeometry(),
    new LineBasicMaterial({color: '#000000', depthTest: false, transparent: true, opacity: 0.55}));
const box = new Box3Helper(new Box3(), new Color('#000000'));
box.visible = false;
lines.renderOrder = 2;

/* Contours, thick; below them all that the mesh hides, thinner and paler. They are opaque, as short
   segments overlap, and drawn after the mesh. Regions: soft colors, and then the same in full, of the
   smaller sides of contours. */
const curves = [[false, 2, 3], [true, 4, 4]].map(([depthTest, linewidth, renderOrder]) => {
    const material = new LineMaterial({linewidth, depthTest, transparent: true, depthWrite: false});
    return Object.assign(new LineSegments2(new LineSegmentsGeometry(), material), {renderOrder});
});
const soft = ['#4a7fd0', '#2f9e62', '#d99a2b', '#8a68cc', '#24a0b0', '#a97a48', '#93a233', '#6c7aa6'];
const tints = [...soft, ...soft, soft[0]].map(() => new MeshLambertMaterial({
    side: DoubleSide, flatShading: true, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4
}));
for (const object of [lines, ...curves]) object.frustumCulled = false;
scene.add(lines, box, ...(has_contours ? curves : []));

let current = -1, place = -1, size = 1, drawn = null, asked = false, flight = null, wanted = 0;
let has_colors = has_contours, sees_through = false;

function redraw() {
    if (asked || is_picture) return;
    asked = true;
    requestAnimationFrame(time => {
        asked = false;
        if (flight) fly_on(time);
        controls.update();
        renderer.render(scene, camera);
    });
}
controls.addEventListener('change', redraw);

function resize() {
    if (!fit_to_room(view)) return;
    redraw();
    draw_curve();
}

function paint() {
    renderer.setClearColor(is_picture ? new Color('#ffffff') : color_of('--ground'));
    surface.color = color_of('--mesh');
    lines.material.color = box.material.color = color_of('--mark');
    tints.forEach((tint, i) => {
        tint.color = i === 2 * soft.length ? color_of('--mesh')
            : color_of('--mesh').lerp(new Color(soft[i % soft.length]), i < soft.length ? 0.35 : 1);
    });
    for (const material of [surface, ...tints]) {
        material.transparent = sees_through;
        material.opacity = sees_through ? 0.18 : 1;
        material.depthWrite = !sees_through;
        material.needsUpdate = true;
    }
    curves[0].material.color = color_of('--mesh').lerp(color_of('--contour'), 0.4);
    curves[1].material.color = color_of('--contour');
    if (has_contours) all.material = has_colors ? tints : tints[2 * soft.length];
    hits.material = has_colors ? paints : paints[0];
    redraw();
}

/* A place among tints for a region; the last one for what is in none. */
const tint_of = (region, smaller) => region < smaller.length
    ? region % soft.length + (smaller[region] ? soft.length : 0) : 2 * soft.length;

function show_contours(data) {
    let begin = 0;
    const indices = new Uint32Array([...data.parts.values()].reduce((sum, part) => sum + part.length, 0));
    for (const object of [all, ...curves]) object.geometry.dispose();
    all.geometry = new BufferGeometry();
    all.geometry.setAttribute('position', new BufferAttribute(data.positions, 3));
    for (const [region, part] of data.parts) {
        indices.set(part, begin);
        all.geometry.addGroup(begin, part.length, tint_of(region, data.read.smaller));
        begin += part.length;
    }
    all.geometry.setIndex(new BufferAttribute(indices, 1));
    for (const curve of curves) {
        curve.geometry = new LineSegmentsGeometry();
        curve.geometry.setPositions(data.lines);
        curve.visible = data.lines.length > 0;
    }
}

function show_geometry(data) {
    if (has_contours) return show_contours(data);
    const positions = new BufferAttribute(data.positions, 3);
    for (const object of [all, hits, lines]) object.geometry.dispose();
    all.geometry = new BufferGeometry();
    all.geometry.setAttribute('position', positions);
    all.geometry.setIndex(new BufferAttribute(data.indices, 1));
    hits.geometry = new BufferGeometry();
    hits.geometry.setAttribute('position', positions);
    hits.geometry.setIndex(new BufferAttribute(data.colliding, 1));
    let begin = 0;
    data.sizes.forEach((count, i) => {
        hits.geometry.addGroup(begin, 3 * count, i % palette.length);
        begin += 3 * count;
    });
    lines.geometry = new BufferGeometry();
    lines.geometry.setAttribute('position', new BufferAttribute(data.segments, 3));
}

/* Where all of a frame is: its middle and its size. */
function extent(info) {
    const low = new Vector3(...info.low), high = new Vector3(...info.high);
    return {
        center: low.clone().add(high).multiplyScalar(0.5).sub(new Vector3(...info.origin)),
        size: high.sub(low).length() || 1
    };
}

function fly_to(target, eye) {
    const begin = {target: controls.target.clone(), eye: camera.position.clone()};
    flight = {begin, target, eye, start: performance.now(), length: still ? 0 : 500};
    redraw();
}

function fly_on(time) {
    const part = flight.length ? Math.min(1, Math.max(0, (time - flight.start) / flight.length)) : 1;
    const eased = part * part * (3 - 2 * part);
    controls.target.lerpVectors(flight.begin.target, flight.target, eased);
    camera.position.lerpVectors(flight.begin.eye, flight.eye, eased);
    if (part === 1) flight = null; else redraw();
}

/* How far away something of a size fills the view. */
function distance_of(length) {
    const half = Math.tan(camera.fov * Math.PI / 360) * Math.min(1, camera.aspect);
    return 0.55 * length / half;
}

function fit(at_once) {
    const {center, size: length} = extent(frames[current]);
    size = length;
    camera.near = size / 2000;
    camera.far = size * 20;
    camera.updateProjectionMatrix();
    const direction = at_once ? new Vector3(0.5, 0.4, 1)
        : camera.position.clone().sub(controls.target);
    const eye = direction.setLength(distance_of(size)).add(center);
    if (at_once) {
        controls.target.copy(center);
        camera.position.copy(eye);
        redraw();
    } else {
        choose(-1);
        fly_to(center, eye);
    }
}

/* Flies to a place, from the side of it that is away from the middle of the mesh. */
function visit(number) {
    const info = frames[current], list = info.places;
    if (!list.length) return;
    number = (number + list.length) % list.length;
    choose(number);
    const one = list[number], middle = extent(info);
    const center = new Vector3(...one.center).sub(new Vector3(...info.origin));
    const direction = center.clone().sub(middle.center);
    if (direction.length() < 0.05 * size) direction.subVectors(camera.position, controls.target);
    const length = Math.max(3 * new Vector3(...one.size).length(), size / 40);
    fly_to(center, direction.setLength(Math.min(distance_of(length), distance_of(size))).add(center));
}

/* -------------------------------------------------------------------------------------------------
 * What stands round it
 */

const number_of = (value, digits = 3) =>
    value !== 0 && (Math.abs(value) < 1e-4 || Math.abs(value) >= 1e9) ? value.toExponential(digits - 1)
        : value.toLocaleString('en', {maximumSignificantDigits: digits});

function choose(number) {
    place = number;
    const list = frames[current].places;
    at('places').querySelectorAll('button').forEach((button, i) => {
        button.setAttribute('aria-current', i === number);
        if (i === number) button.scrollIntoView({block: 'nearest'});
    });
    box.visible = number >= 0;
    if (number >= 0) {
        const one = list[number], center = new Vector3(...one.center).sub(new Vector3(...origin));
        const half = new Vector3(...one.size).multiplyScalar(0.55);
        half.max(new Vector3(size, size, size).multiplyScalar(0.002));
        box.box.set(center.clone().sub(half), center.clone().add(half));
        box.updateMatrixWorld(true);
    }
    redraw();
}

/* What the list says of a place, and below. */
function tell_place(one, info) {
    const owners = one.objects.length ? one.objects.map(name => name ?? '(unnamed)')
        : info.parts > 1 ? one.parts.map(part => `part ${part}`) : [];
    return [plural(one.faces, 'face'), owners.slice(0, 4).join(' / ') + (owners.length > 4 ? ' …' : ''),
        plural(one.pairs, 'pair'), one.size.map(x => number_of(x)).join(' × '),
        one.depth === null ? '' : `about ${number_of(one.depth, 2)} deep`];
}

/* The same of a contour. */
function tell_contour(one) {
    return [`${number_of(one.length)} long, ${one.begin === 'closed' ? 'closed' : 'open'}`,
        one.begin === 'closed' ? '' : `${one.begin} to ${one.end}`, plural(one.nodes, 'node'),
        one.one_sheet ? 'one sheet' : '',
        one.areas.length ? `cuts off ${one.areas.map(area => number_of(area)).join(' and ')}` : 'cuts nothing off'];
}

function list_places(info) {
    const word = has_contours ? 'contour' : 'place';
    at('count').textContent = info.place_count ? plural(info.place_count, word)
        : has_contours ? 'No contour' : 'No collision';
    at('places').replaceChildren(...info.places.map((one, i) => {
        const item = document.createElement('li'), button = document.createElement('button');
        const swatch = document.createElement('span'), small = document.createElement('small');
        swatch.className = 'swatch';
        if (has_contours) swatch.classList.add(one.begin === 'closed' ? 'closed' : 'open');
        else swatch.style.background = palette[has_colors ? i % palette.length : 0];
        const [head, ...others] = has_contours ? tell_contour(one) : tell_place(one, info);
        small.textContent = others.filter(text => text).join(', ');
        button.append(swatch, `${i + 1}: ${head}`, small);
        button.addEventListener('click', () => visit(i));
        item.append(button);
        return item;
    }));
    const left = info.place_count - info.places.length;
    if (has_contours) {
        at('defects').textContent = [left > 0 ? `and ${plural(left, 'shorter contour')}.` : '',
            info.drawn < info.place_count ? `Drawn are the longest ${info.drawn}.` : '',
            info.place_count ? `${info.closed} closed.` : '', `${plural(info.regions, 'region')} of the surface.`,
            info.smaller ? 'Those in stronger colors are the smaller side of a contour.'
                : info.place_count ? 'No contour cuts anything off.' : ''].filter(text => text).join(' ');
        return;
    }
    const defects = Object.entries(info.defects ?? {}).filter(([, count]) => count)
        .map(([name, count]) => `${name.replace('_', ' ').replace('non manifold', 'non-manifold')} ${count}`);
    at('defects').textContent = [left > 0 ? `and ${plural(left, 'smaller place')}` : '',
        info.segments < info.pairs ? `Lines show the first ${info.segments} contacts.` : '',
        defects.length ? `Defects: ${defects.join(', ')}.` : '',
        `${info.closed_parts} of ${plural(info.parts, 'part')} closed.`].filter(text => text).join(' ');
}

function say(info) {
    at('title').textContent = info.name;
    document.title = `${info.name}: ${has_contours ? 'contours' : 'self-collisions'}`;
    const found = has_contours ? `${plural(info.place_count, 'contour')}, ${number_of(info.length)} long,`
        : `${info.incomplete ? 'at least ' : ''}${plural(info.pairs, 'pair')} of`;
    at('said').textContent = `${found} ${plural(info.triangles, 'triangle')}, ${number_of(info.ms)} ms`;
    at('name').textContent = `${info.number + 1} / ${frames.length}`;
}

const svg = (name, members, text) => {
    const element = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(members)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
};

/* Two rows, pairs or lengths and milliseconds, each from 0 to its largest value. */
function draw_curve() {
    if (frames.length < 2) return;
    const chart = at('curve'), width = chart.clientWidth || 300;
    const x = i => 4 + (width - 8) * i / (frames.length - 1);
    chart.replaceChildren();
    const [key, color] = has_contours ? ['length', 'var(--contour)'] : ['pairs', 'var(--pairs)'];
    [[key, key, color], ['ms', 'ms', 'var(--time)']].forEach(([key, unit, color], row) => {
        const top = 14 + 38 * row, height = 22;
        const most = frames.reduce((m, info) => Math.max(m, info[key]), 0);
        const y = value => top + height * (1 - (most ? value / most : 0));
        chart.append(svg('line', {x1: 4, x2: width - 4, y1: top + height, y2: top + height, stroke: 'var(--line)'}),
            svg('polyline', {points: frames.map((info, i) => `${x(i).toFixed(1)},${y(info[key]).toFixed(1)}`).join(' '),
                fill: 'none', stroke: color, 'stroke-width': 1.5}),
            svg('text', {x: 4, y: top - 3}, `${unit}, at most ${number_of(most, 4)}`),
            svg('text', {x: width - 4, y: top - 3, 'text-anchor': 'end', class: 'now', 'data-key': key}),
            svg('circle', {r: 3, fill: color, class: 'dot', 'data-x': 0, 'data-key': key, 'data-top': top, 'data-most': most}));
    });
    mark_curve();
}

function mark_curve() {
    if (current < 0) return;
    const width = at('curve').clientWidth || 300;
    for (const dot of at('curve').querySelectorAll('.dot')) {
        const {key, top, most} = dot.dataset, value = frames[current][key];
        dot.setAttribute('cx', 4 + (width - 8) * current / (frames.length - 1));
        dot.setAttribute('cy', +top + 22 * (1 - (+most ? value / +most : 0)));
    }
    for (const text of at('curve').querySelectorAll('.now'))
        text.textContent = number_of(frames[current][text.dataset.key], 4);
}

async function show(number) {
    wanted = Math.min(frames.length - 1, Math.max(0, number));
    at('slider').value = wanted;
    const mine = wanted, data = await frame_of(mine);
    if (mine !== wanted || mine === current) return; /* another one was asked for meanwhile */
    const first = current < 0, other = !first && frames[current].mesh !== frames[mine].mesh;
    current = mine;
    place = -1;
    box.visible = false;
    show_geometry(data);
    say(frames[current]);
    list_places(frames[current]);
    mark_curve();
    if (first || other) fit(true);
    redraw();
    if (current + 1 < frames.length) frame_of(current + 1); /* the next one is likely */
}

/* -------------------------------------------------------------------------------------------------
 * Input
 */

let timer = 0;
function play(on) {
    clearInterval(timer);
    timer = on ? setInterval(() => show((wanted + 1) % frames.length), 80) : 0;
    at('play').setAttribute('aria-pressed', !!timer);
}
function toggle_colors() {
    has_colors = !has_colors;
    at('colors').setAttribute('aria-pressed', has_colors);
    list_places(frames[current]);
    choose(place);
    paint();
}
function toggle_xray() {
    sees_through = !sees_through;
    at('xray').setAttribute('aria-pressed', sees_through);
    paint();
}
function set_theme(name) {
    document.documentElement.dataset.theme = name;
    paint();
}
function toggle_theme() { set_theme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'); }

const keys = {
    ArrowLeft: () => show(wanted - 1), ArrowRight: () => show(wanted + 1),
    Home: () => show(0), End: () => show(frames.length - 1),
    ' ': () => frames.length > 1 && play(!timer),
    n: () => visit(place + 1), p: () => visit(place < 0 ? -1 : place - 1),
    f: () => fit(false), x: toggle_xray, c: toggle_colors, t: toggle_theme,
    '?': () => at('keys').showModal()
};
addEventListener('keydown', event => {
    if (current < 0 || event.ctrlKey || event.altKey || event.metaKey || at('keys').open) return;
    const inside = event.target.tagName;
    if (inside === 'INPUT' && event.key.length > 1) return; /* the slider's own keys */
    if (inside === 'BUTTON' && event.key === ' ') return;
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
});
at('fit').addEventListener('click', () => fit(false));
at('xray').addEventListener('click', toggle_xray);
at('colors').addEventListener('click', toggle_colors);
at('theme').addEventListener('click', toggle_theme);
at('help').addEventListener('click', () => at('keys').showModal());
at('play').addEventListener('click', () => play(!timer));
at('slider').addEventListener('input', () => show(+at('slider').value));
at('curve').addEventListener('pointerdown', event => at('curve').setPointerCapture(event.pointerId));
for (const kind of ['pointerdown', 'pointermove']) {
    at('curve').addEventListener(kind, event => {
        if (!event.buttons) return;
        const {left, width} = at('curve').getBoundingClientRect();
        show(Math.round((event.clientX - left - 4) / (width - 8) * (frames.length - 1)));
    });
}
canvas.addEventListener('pointerdown', () => { flight = null; });

/* -------------------------------------------------------------------------------------------------
 * Beginning
 */

/* Three views side by side, along z, x and y, for --png; each as near as the box allows. */
function draw_views() {
    const width = innerWidth, height = innerHeight, third = width / 3, info = frames[0];
    const {center, size: length} = extent(info), sides = info.high.map((x, k) => x - info.low[k]);
    renderer.setPixelRatio(1);
    renderer.setSize(width, height, false);
    renderer.setScissorTest(true);
    camera.aspect = third / height;
    camera.near = length / 2000;
    camera.far = length * 20;
    camera.updateProjectionMatrix();
    [[0, 1, 2], [2, 1, 0], [0, 2, 1]].forEach(([across, up, along], i) => {
        const half = Math.tan(camera.fov * Math.PI / 360);
        const most = Math.max(sides[across] / camera.aspect, sides[up]) || length;
        const eye = center.clone();
        eye.setComponent(along, eye.getComponent(along) + 0.5 * sides[along] + 0.54 * most / half);
        camera.up.set(0, up === 1 ? 1 : 0, up === 1 ? 0 : -1);
        camera.position.copy(eye);
        camera.lookAt(center);
        renderer.setViewport(i * third, 0, third, height);
        renderer.setScissor(i * third, 0, third, height);
        renderer.render(scene, camera);
    });
}

async function draw_picture() {
    document.body.classList.add('picture');
    show_geometry(await frame_of(0));
    current = 0;
    paint();
    draw_views();
    addEventListener('resize', draw_views); /* a browser without a window takes its size late */
}

/* The words of a page with contours. */
function name_contours() {
    for (const word of document.querySelectorAll('[data-contours]')) word.textContent = word.dataset.contours;
    at('colors').title = 'Colors of regions (C)';
    at('colors').setAttribute('aria-pressed', has_colors);
    at('curve').setAttribute('aria-label', 'Length of contours and milliseconds over the frames');
}

/* What tests look at. */
const page = window.starcontour = {
    ready: false,
    /* where a point of the mesh is in the canvas, in its pixels */
    project: point => {
        const {x, y} = new Vector3(...point).sub(new Vector3(...origin)).project(camera);
        return [(x + 1) / 2 * canvas.width, (1 - y) / 2 * canvas.height];
    },
    frames,
    /* of this frame: the ends of all segments of contours, and of each region its triangles' corners */
    contours: () => frame_of(current).then(data => {
        const point = i => [...data.positions.slice(3 * i, 3 * i + 3)].map((x, k) => x + origin[k]);
        return {lines: [...data.lines].map((x, i) => x + origin[i % 3]), smaller: data.read.smaller,
            parts: [...data.parts].map(([region, part]) => ({region, corners: part.map(point)}))};
    }),
    state: () => ({frame: current, place, eye: camera.position.toArray(), target: controls.target.toArray(),
        flying: !!flight, theme: document.documentElement.dataset.theme})
};
async function begin() {
    if (has_contours) name_contours();
    if (!frames.length) {
        at('title').textContent = 'No mesh could be read.';
        document.querySelector('header > span:last-child').hidden = true;
    } else if (is_picture) {
        await draw_picture();
    } else {
        set_theme(matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
        at('slider').max = frames.length - 1;
        at('time').hidden = frames.length < 2;
        resize();
        new ResizeObserver(resize).observe(at('view'));
        await show(0);
        draw_curve();
    }
    page.ready = true;
}
begin().catch(error => {
    at('said').textContent = `This page cannot be shown here: ${error.message}`;
    throw error;
});
