/*
 * starcontour for JavaScript: every self-collision of a deforming triangle mesh, exactly and fast,
 * on typed arrays. README.md is the manual, index.d.ts has the types.
 *
 * SPDX-License-Identifier: MIT
 *
 * The library is WebAssembly with a memory of its own. Each call copies its arrays in and its
 * answer out, so that what callers get is theirs and stays as it is. Structures are written by
 * name: where their members are comes from the library itself (layouts.c).
 */
import encoded from './starcontour.wasm.js';

const bytes = Uint8Array.from(atob(encoded), character => character.charCodeAt(0));
const {instance} = await WebAssembly.instantiate(bytes, {
    env: {emscripten_notify_memory_growth() {}},
    wasi_snapshot_preview1: {
        // Only statistics read clocks, and nothing here asks for them: 52 is "not supported".
        clock_time_get: () => 52
    }
});
const library = instance.exports;
library._initialize();

/* ------------------------------------------------------------------------------------------------
 * Memory of the library
 */

// Views of it, made anew after it has grown.
let view = new DataView(library.memory.buffer);
let heap = new Uint8Array(library.memory.buffer);

function refresh() {
    if (heap.buffer === library.memory.buffer) return;
    view = new DataView(library.memory.buffer);
    heap = new Uint8Array(library.memory.buffer);
}

function text_at(address) {
    refresh();
    return new TextDecoder().decode(heap.subarray(address, heap.indexOf(0, address)));
}

const status_text = status => text_at(library.sc_status_string(status));
const ERROR_MEMORY = 10, ERROR_SHORT_BUFFER = 11, ERROR_INCOMPLETE = 28;

/** The version of the library, such as "0.1.0". */
export const version = text_at(library.sc_version_string());

/** What the library refused. `status` is its number, SC_ERROR_... in starcontour.h. */
export class StarcontourError extends Error {
    constructor(status, message = '') {
        super(message || status_text(status));
        this.name = 'StarcontourError';
        this.status = status;
    }
}

/** A query that ran out of its budget. `found`: what it would have returned, as far as it got. */
export class Incomplete extends StarcontourError {
    constructor(found) {
        super(ERROR_INCOMPLETE);
        this.name = 'Incomplete';
        this.found = found;
    }
}

function allocate(size) {
    const address = library.malloc(Math.max(size, 1));
    if (!address) throw new StarcontourError(ERROR_MEMORY);
    refresh();
    return address;
}

// Why a call was refused; said once.
function take_refusal() {
    const address = library.sc_refusal(), refusal = text_at(address);
    heap[address] = 0;
    return refusal.replace(/^options\.(\w*filter\.)?/, '');
}

function check(status) {
    refresh();
    const refusal = take_refusal();
    if (status) throw new StarcontourError(status, refusal);
}

// NAME -> {size, members: NAME -> [offset, kind]}, see layouts.c.
const layouts = new Map();
for (const line of text_at(library.sc_layouts()).trimEnd().split('\n')) {
    const [kind, name, at] = line.split(' ');
    if (kind === 's') layouts.set(name, {size: Number(at), members: new Map()});
    else [...layouts.values()].at(-1).members.set(name, [Number(at), kind]);
}

/* What one call writes to memory, and gives back at its end. */
class Call {
    #blocks = [];

    room(size) {
        const address = allocate(size);
        this.#blocks.push(address);
        return address;
    }

    /* A copy of a typed array; 0 for none. */
    copy(array) {
        if (!array) return 0;
        const address = this.room(array.byteLength);
        heap.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), address);
        return address;
    }

    /* A structure; members that are not named are 0. */
    structure(name, members) {
        const {size} = layouts.get(name), address = this.room(size);
        heap.fill(0, address, address + size);
        write(name, address, {struct_size: size, ...members});
        return address;
    }

    end() {
        for (const address of this.#blocks) library.free(address);
    }
}

function write(name, address, members) {
    for (const [member, value] of Object.entries(members)) {
        const [offset, kind] = layouts.get(name).members.get(member), at = address + offset;
        if (kind === 'w') view.setUint32(at, value, true);
        else if (kind === 'l') view.setBigUint64(at, BigInt(value), true);
        else view.setFloat64(at, value, true);
    }
}

function read(name, address, member) {
    const [offset, kind] = layouts.get(name).members.get(member), at = address + offset;
    if (kind === 'w') return view.getUint32(at, true);
    return kind === 'l' ? Number(view.getBigUint64(at, true)) : view.getFloat64(at, true);
}

/* Runs a function with a Call. */
function calling(work) {
    const call = new Call();
    try {
        return work(call);
    } finally {
        call.end();
    }
}

const words = (address, count) => new Uint32Array(heap.slice(address, address + 4 * count).buffer);
const reals = (address, count) => new Float64Array(heap.slice(address, address + 8 * count).buffer);

/* ------------------------------------------------------------------------------------------------
 * Arguments
 */

const CHOICES = {
    pairs: ['triangle', 'edge'],
    contact: ['touching', 'proper'],
    method: ['default', 'sctt', 'aabb_sctt', 'aabb'],
    step_method: ['default', 'sctt', 'two_boxes', 'swept'],
    near_method: ['default', 'sctt', 'boxes'],
    kinds: ['both', 'vertex_face', 'edge_edge'],
    kind: ['', 'vertex_face', 'edge_edge']
};

function choice(name, value, choices = CHOICES[name]) {
    const number = choices.indexOf(value);
    if (number < 0 || value === '')
        throw new RangeError(`${name} must be one of ${choices.filter(Boolean).join(', ')}, not ${value}`);
    return number;
}

function whole(name, value, largest = 0xffffffff) {
    if (!Number.isInteger(value) || value < 0 || value > largest)
        throw new RangeError(`${name} must be a whole number from 0 to ${largest}, not ${value}`);
    return value;
}

function real(name, value) {
    if (typeof value !== 'number') throw new TypeError(`${name} must be a number, not ${value}`);
    return value;
}

/* Nobody should wonder why an option that is spelt wrongly does nothing. */
function known(options, names) {
    if (options === null || typeof options !== 'object')
        throw new TypeError(`options must be an object, not ${options}`);
    for (const name of Object.keys(options))
        if (!names.includes(name))
            throw new TypeError(`there is no option ${name}; there are ${names.join(', ')}`);
    return options;
}

/* The coordinates of n vertices, x, y, z and so on. Plain arrays are doubles. */
function positions(name, array) {
    if (Array.isArray(array)) {
        if (!array.every(number => typeof number === 'number'))
            throw new TypeError(`${name} must be an array of numbers: x, y, z, x and so on`);
        array = new Float64Array(array);
    }
    if (!(array instanceof Float32Array || array instanceof Float64Array))
        throw new TypeError(`${name} must be a Float32Array, a Float64Array or an array of numbers`);
    if (array.length % 3)
        throw new RangeError(`${name} must have three numbers a vertex, not ${array.length} in all`);
    return array;
}

/* Whole numbers as a Uint32Array, `each` a row. */
function numbers(name, array, each) {
    if (!(array instanceof Uint32Array)) {
        if (!Array.isArray(array) && !(ArrayBuffer.isView(array) && 'length' in array))
            throw new TypeError(`${name} must be a Uint32Array or another array of whole numbers`);
        for (const number of array) whole(`each of ${name}`, number);
        array = Uint32Array.from(array);
    }
    if (array.length % each)
        throw new RangeError(`${name} must have ${each} numbers a row, not ${array.length} in all`);
    return array;
}

function pose_in(call, name, array) {
    array = positions(name, array);
    return call.structure('sc_pose', {
        vertex_count: array.length / 3,
        position_type: array instanceof Float64Array ? 1 : 0,
        positions: call.copy(array)
    });
}

/* Whole numbers, `each` for each of so many things, that may be left out. */
function numbers_of(name, array, count, each) {
    if (!array) return null;
    array = numbers(name, array, each);
    if (array.length !== each * count)
        throw new RangeError(`${name} must have ${each * count} numbers, not ${array.length}`);
    return array;
}

function filter_in(call, info, {ignoreRings = 0, vertexGroups, triangleGroups}, ignore) {
    if (ignore) ignore = numbers('ignore', ignore, 2);
    return call.structure('sc_filter', {
        ignore_rings: whole('ignoreRings', ignoreRings),
        vertex_groups: call.copy(numbers_of('vertexGroups', vertexGroups, info.vertexCount, 2)),
        triangle_groups: call.copy(numbers_of('triangleGroups', triangleGroups, info.triangleCount, 2)),
        ignore: call.copy(ignore),
        ignore_count: ignore ? ignore.length / 2 : 0
    });
}

/* The members of sc_step_options and sc_near_options that say which pairs are not wanted. */
function features_in(call, info, options) {
    const {ignore = {}, rest, restDistance = 0} = options;
    return {
        vertex_face_filter: filter_in(call, info, options, ignore.vertexFaces),
        edge_edge_filter: filter_in(call, info, options, ignore.edgeEdges),
        rest: rest ? pose_in(call, 'rest', rest) : 0,
        rest_distance: real('restDistance', restDistance)
    };
}

/* ------------------------------------------------------------------------------------------------
 * Models
 */

const PAIRS = 0, COUNT = 1, ANY = 2; // SC_OUTPUT_...
const WORKSPACE_NEAR = 2;
const COMMON = ['ignoreRings', 'ignore', 'vertexGroups', 'triangleGroups', 'budget'];
const QUERY = ['pairs', 'contact', 'method', ...COMMON];
const STEP = ['separation', 'tolerance', 'method', 'candidates', 'onlyNearer', 'rest', 'restDistance', ...COMMON];
const NEAR = ['kinds', 'method', 'rest', 'restDistance', ...COMMON];

// Of models that nobody has freed and nobody refers to any more.
const forgotten = new FinalizationRegistry(handles => give_back(handles));

function give_back(handles) {
    library.sc_workspace_free(handles.workspace);
    library.sc_model_free(handles.model);
    for (const list of [handles.first, handles.second]) library.free(list.address);
    handles.model = handles.workspace = 0;
}

/* Room for pairs of so many bytes each; grows with what is found. */
function grow(list, count, size) {
    if (count * size <= list.bytes) return;
    library.free(list.address);
    Object.assign(list, {address: 0, bytes: 0});
    list.address = allocate(count * size);
    list.bytes = count * size;
}

// Members of structures, as arrays with so many numbers for each.
const STENCIL = {
    feature: [Uint32Array, 1], flags: [Uint32Array, 1], vertices: [Uint32Array, 4],
    weights: [Float64Array, 4], vector: [Float64Array, 3], distance: [Float64Array, 1]
};
const STEP_STENCIL = {
    time: [Float64Array, 1], normal: [Float64Array, 3], side: [Int32Array, 1], flags: [Uint32Array, 1]
};
const CONTACT = {
    kind: [Uint32Array, 1], points: [Float64Array, 6], weights_a: [Float64Array, 6], weights_b: [Float64Array, 6]
};

const NODE = {
    edge: [Uint32Array, 1], triangle: [Uint32Array, 1], sheet: [Uint32Array, 1], sheets: [Uint32Array, 2],
    along: [Float64Array, 1], weights: [Float64Array, 3], point: [Float64Array, 3]
};
const CONTOUR = { // of first and count, which have 64 bits, the lower half: memory has no room for more
    first: [Uint32Array, 1], count: [Uint32Array, 1], begin: [Uint32Array, 1], end: [Uint32Array, 1],
    flags: [Uint32Array, 1], length: [Float64Array, 1]
};
const TRIPLE = { // nodes as above
    triangles: [Uint32Array, 3], nodes: [Uint32Array, 3, 8], along: [Float64Array, 3], point: [Float64Array, 3]
};
const REGION = {
    component: [Uint32Array, 1], vertex_count: [Uint32Array, 1], area: [Float64Array, 1], inside: [Int32Array, 1]
};
const GRADIENT = {
    vertices: [Uint32Array, 5], flags: [Uint32Array, 1], weights: [Float64Array, 5], vectors: [Float64Array, 6]
};

/* An array of each member of count structures that are so many bytes apart. */
function columns(rows, count, size, name, members) {
    const made = {};
    for (const [member, [Type, width, apart = Type.BYTES_PER_ELEMENT]] of Object.entries(members)) {
        const array = made[member] = new Type(count * width), [offset] = layouts.get(name).members.get(member);
        const get = {Uint32Array: 'getUint32', Int32Array: 'getInt32', Float64Array: 'getFloat64'}[Type.name];
        for (let i = 0; i < count; ++i)
            for (let k = 0; k < width; ++k)
                array[width * i + k] = view[get](rows + size * i + offset + apart * k, true);
    }
    return made;
}

// Of each answer of Model.trace: sc_trace_node and sc_trace_contour as bytes.
const traces = new WeakMap();

/* A result of sc_trace that was traced. */
function traced_in(call, traced) {
    const bytes = traces.get(traced);
    if (!bytes) throw new TypeError('traced must be what trace returned');
    const node_count = traced.nodes.edge.length, contour_count = traced.contours.first.length;
    return call.structure('sc_trace_result', {
        node_count, node_capacity: node_count, nodes: call.copy(bytes.nodes),
        contour_count, contour_capacity: contour_count, contours: call.copy(bytes.contours)
    });
}

/* What the constructor is called with by fromBytes. */
const SAVED = Symbol('saved');

/** A triangle mesh in its rest pose, made ready for queries. */
export class Model {
    #handles = {
        model: 0, workspace: 0, flags: -1,
        first: {address: 0, bytes: 0}, second: {address: 0, bytes: 0}
    };
    #info = {};

    constructor(vertices, triangles, options = {}) {
        const made = vertices === SAVED ? loaded(triangles) : built(vertices, triangles, options);
        calling(call => {
            const model = call.room(4);
            check(made(call, model));
            this.#handles.model = view.getUint32(model, true);
            const info = call.structure('sc_model_info', {});
            check(library.sc_model_get_info(this.#handles.model, info));
            for (const name of layouts.get('sc_model_info').members.keys())
                if (name !== 'struct_size') this.#info[camel(name)] = read('sc_model_info', info, name);
        });
        Object.freeze(this.#info);
        forgotten.register(this, this.#handles, this.#handles);
    }

    /** A model of what toBytes, or sc_model_save on any machine of this byte order, wrote. */
    static fromBytes(data) {
        if (!(data instanceof Uint8Array)) throw new TypeError('data must be a Uint8Array');
        return new Model(SAVED, data);
    }

    /** The model as bytes. */
    toBytes() {
        const model = this.#model();
        return calling(call => {
            const size = call.room(8);
            check(library.sc_model_save_size(model, size));
            const bytes = Number(view.getBigUint64(size, true)), data = call.room(bytes);
            check(library.sc_model_save(model, data, BigInt(bytes), 0));
            return heap.slice(data, data + bytes);
        });
    }

    /** How many vertices, triangles and so on, and how many bytes. */
    get info() {
        return this.#info;
    }

    /** Gives back the memory; the model cannot be used any more. */
    free() {
        forgotten.unregister(this.#handles);
        if (this.#handles.model) give_back(this.#handles);
    }

    /** All pairs in a pose, sorted: a, b, a, b and so on. */
    query(pose, options = {}) {
        return this.#query(pose, options, PAIRS, (result, list) =>
            words(list.address, 2 * Math.min(read('sc_result', result, 'count'), list.bytes / 8)));
    }

    /** The number of pairs in a pose. */
    count(pose, options = {}) {
        return this.#query(pose, options, COUNT, result => read('sc_result', result, 'count'));
    }

    /** Whether there is any pair in a pose. Stops at the first. */
    collides(pose, options = {}) {
        return this.#query(pose, options, ANY, result => read('sc_result', result, 'collides') === 1);
    }

    #query(pose, options, output, answer) {
        const {pairs = 'triangle', contact = 'touching', method = 'default', ignore, budget = 0} =
            known(options, QUERY);
        return this.#ask(0, 'sc_result', ['pairs'], answer, (call, workspace) => {
            const how = call.structure('sc_query_options', {
                output,
                pairs: choice('pairs', pairs),
                contact: choice('contact', contact),
                method: choice('method', method),
                filter: filter_in(call, this.#info, options, ignore),
                budget: whole('budget', budget, Number.MAX_SAFE_INTEGER)
            });
            const where = pose_in(call, 'pose', pose);
            return result => library.sc_query(this.#handles.model, workspace, where, how, result);
        });
    }

    /** What collides while all vertices move on straight lines from one pose to another. */
    step(start, end, options = {}) {
        return this.#step(start, end, options, PAIRS, (result, first, second) => {
            const {candidates = false} = options;
            const {pairs: vertexFaces, times: vertexFaceTimes} = timed(result, first, 'vertex_face', candidates);
            const {pairs: edgeEdges, times: edgeEdgeTimes} = timed(result, second, 'edge_edge', candidates);
            const earliest = read('sc_step_result', result, 'earliest');
            return {vertexFaces, edgeEdges, vertexFaceTimes, edgeEdgeTimes, earliest};
        });
    }

    /** Whether anything collides in a step. Stops at the first pair. */
    stepCollides(start, end, options = {}) {
        return this.#step(start, end, options, ANY, result => read('sc_step_result', result, 'collides') === 1);
    }

    #step(start, end, options, output, answer) {
        const {separation = 0, tolerance = 0, method = 'default', candidates = false} = known(options, STEP);
        const {onlyNearer = false, budget = 0} = options;
        const lists = ['vertex_face', 'edge_edge'];
        return this.#ask(WORKSPACE_NEAR, 'sc_step_result', lists, answer, (call, workspace) => {
            const how = call.structure('sc_step_options', {
                output,
                pairs: candidates ? 1 : 0,
                times: output === PAIRS && !candidates ? 2 : 0,
                method: choice('method', method, CHOICES.step_method),
                separation: real('separation', separation),
                tolerance: real('tolerance', tolerance),
                begun: onlyNearer ? 1 : 0,
                budget: whole('budget', budget, Number.MAX_SAFE_INTEGER),
                ...features_in(call, this.#info, options)
            });
            const from = pose_in(call, 'start', start), to = pose_in(call, 'end', end);
            return result => library.sc_query_step(this.#handles.model, workspace, from, to, how, result);
        });
    }

    /** What is within a distance in a pose, compared exactly. */
    near(pose, distance, options = {}) {
        const {stencils = false, vertexBound = false, ...others} = options;
        const answer = (result, first, second, bounds) => {
            const vertexFaces = listed(result, 'sc_near_result', first, 'vertex_face');
            const edgeEdges = listed(result, 'sc_near_result', second, 'edge_edge');
            return {
                vertexFaces, edgeEdges,
                vertexFaceStencils: stencils ? this.stencils(pose, vertexFaces, 'vertex_face') : null,
                edgeEdgeStencils: stencils ? this.stencils(pose, edgeEdges, 'edge_edge') : null,
                vertexBound: bounds ? reals(bounds, this.#info.vertexCount) : null
            };
        };
        return this.#near(pose, distance, others, PAIRS, answer, vertexBound);
    }

    /** The numbers of vertex-face and of edge-edge pairs within a distance. */
    nearCounts(pose, distance, options = {}) {
        return this.#near(pose, distance, options, COUNT, result =>
            ['vertex_face_count', 'edge_edge_count'].map(name => read('sc_near_result', result, name)));
    }

    /** Whether any pair is within a distance. Stops at the first. */
    isNear(pose, distance, options = {}) {
        return this.#near(pose, distance, options, ANY, result => read('sc_near_result', result, 'found') === 1);
    }

    #near(pose, distance, options, output, answer, with_bounds) {
        const {kinds = 'both', method = 'default', budget = 0} = known(options, NEAR);
        const lists = ['vertex_face', 'edge_edge'];
        let bounds = 0;
        const told = (result, first, second) => answer(result, first, second, bounds);
        return this.#ask(WORKSPACE_NEAR, 'sc_near_result', lists, told, (call, workspace) => {
            const how = call.structure('sc_near_options', {
                output,
                kinds: choice('kinds', kinds),
                method: choice('method', method, CHOICES.near_method),
                distance: real('distance', distance),
                budget: whole('budget', budget, Number.MAX_SAFE_INTEGER),
                ...features_in(call, this.#info, options)
            });
            const where = pose_in(call, 'pose', pose);
            if (with_bounds) bounds = call.room(8 * this.#info.vertexCount);
            return result => {
                write('sc_near_result', result, {vertex_bounds: bounds});
                return library.sc_query_near(this.#handles.model, workspace, where, how, result);
            };
        });
    }

    /** Closest points of pairs, near or not: arrays with an entry, or several, for each. */
    stencils(pose, pairs, kind) {
        const number = choice('kind', kind);
        return this.#columns(pose, pairs, 'sc_near_stencil',
            (...call) => library.sc_near_stencils(call[0], call[1], number, ...call.slice(2)),
            STENCIL);
    }

    /** The same of pairs of a step, at its start and at a time of each; without times, at its start. */
    stepStencils(start, end, pairs, times, kind) {
        const number = choice('kind', kind), at = layouts.get('sc_step_stencil').members;
        const count = numbers('pairs', pairs, 2).length / 2;
        if (times && !(times instanceof Float64Array && times.length === count))
            throw new TypeError(`times must be null or a Float64Array with a number for each of ${count} pairs`);
        return calling(call => {
            const to = pose_in(call, 'end', end), when = call.copy(times);
            const inside = (name, rows, size) =>
                columns(rows + at.get(name)[0], count, size, 'sc_near_stencil', STENCIL);
            return this.#columns(start, pairs, 'sc_step_stencil',
                (model, from, list, length, rows) =>
                    library.sc_step_stencils(model, from, to, number, list, when, length, rows),
                STEP_STENCIL,
                (rows, size) => ({start: inside('start', rows, size), impact: inside('impact', rows, size)}));
        });
    }

    /** Where pairs meet: arrays with an entry, or several, for each. */
    contacts(pose, found, {pairs = 'triangle'} = {}) {
        const number = choice('pairs', pairs);
        const {kind, points, weights_a: weightsA, weights_b: weightsB} =
            this.#columns(pose, found, 'sc_contact',
                (...call) => library.sc_contacts(call[0], call[1], number, ...call.slice(2)),
                CONTACT);
        return {kind, points, weightsA, weightsB};
    }

    /** Contours of intersections. found: the edge pairs of the pose, all of them; without, they are found. */
    trace(pose, found = null) {
        const model = this.#model();
        const pairs = numbers('found', found ?? this.query(pose, {pairs: 'edge'}), 2);
        return calling(call => {
            const where = pose_in(call, 'pose', pose), list = call.copy(pairs);
            const how = call.structure('sc_trace_options', {hooks: library.sc_refusal_hooks()});
            const result = call.structure('sc_trace_result', {});
            const ask = () => library.sc_trace(model, where, list, BigInt(pairs.length / 2), how, result);
            const number = member => read('sc_trace_result', result, member);
            let status = ask();
            refresh();
            if (status === ERROR_SHORT_BUFFER) {
                const node_capacity = number('node_count'), contour_capacity = number('contour_count');
                const nodes = call.room(layouts.get('sc_trace_node').size * node_capacity);
                const contours = call.room(layouts.get('sc_trace_contour').size * contour_capacity);
                write('sc_trace_result', result, {node_capacity, nodes, contour_capacity, contours});
                status = ask();
            }
            check(status);
            const list_of = (name, count, array, members) => {
                const {size} = layouts.get(name), rows = number(array);
                return [columns(rows, number(count), size, name, members), heap.slice(rows, rows + size * number(count))];
            };
            const [nodes, nodes_as_bytes] = list_of('sc_trace_node', 'node_count', 'nodes', NODE);
            const [contours, contours_as_bytes] = list_of('sc_trace_contour', 'contour_count', 'contours', CONTOUR);
            const traced = {nodes, contours};
            traces.set(traced, {nodes: nodes_as_bytes, contours: contours_as_bytes});
            return traced;
        });
    }

    /** Points where three sheets meet. traced: what trace said of this pose. */
    traceTriples(pose, traced = null) {
        const model = this.#model(), {size} = layouts.get('sc_trace_triple');
        traced ??= this.trace(pose);
        return calling(call => {
            const where = pose_in(call, 'pose', pose), trace = traced_in(call, traced);
            const how = call.structure('sc_trace_options', {hooks: library.sc_refusal_hooks()});
            const result = call.structure('sc_triples_result', {});
            const ask = () => library.sc_trace_triples(model, where, trace, how, result);
            let status = ask(), count = 0, triples = 0;
            refresh();
            if (status === ERROR_SHORT_BUFFER) {
                count = read('sc_triples_result', result, 'count');
                triples = call.room(size * count);
                write('sc_triples_result', result, {capacity: count, triples});
                status = ask();
            }
            check(status);
            return columns(triples, count, size, 'sc_trace_triple', TRIPLE);
        });
    }

    /** The regions into which contours divide the surface. traced: what trace said of this pose. */
    regions(pose, traced = null, {inside = false} = {}) {
        const model = this.#model();
        traced ??= this.trace(pose);
        return calling(call => {
            const where = pose_in(call, 'pose', pose), trace = traced_in(call, traced);
            const how = call.structure('sc_trace_options', {hooks: library.sc_refusal_hooks()});
            const contours = traced.contours.first.length, {size} = layouts.get('sc_region');
            const vertex_regions = call.room(4 * this.#info.vertexCount), sides = call.room(16 * contours);
            const result = call.structure('sc_regions_result', {vertex_regions, sides});
            const ask = () => library.sc_trace_regions(model, where, trace, how, result);
            let status = ask(), count = 0, regions = 0;
            refresh();
            if (status === ERROR_SHORT_BUFFER) {
                count = read('sc_regions_result', result, 'region_count');
                regions = call.room(size * count);
                write('sc_regions_result', result, {region_capacity: count, regions, flags: inside ? 1 : 0});
                status = ask();
            }
            check(status);
            const {vertex_count: vertexCount, ...others} = columns(regions, count, size, 'sc_region', REGION);
            return {
                regions: {...others, vertexCount},
                vertexRegions: words(vertex_regions, this.#info.vertexCount),
                sides: words(sides, 4 * contours)
            };
        });
    }

    /** How lengths of contours change as vertices move: arrays with entries for each node of traced. */
    traceGradients(pose, traced) {
        const model = this.#model(), {size} = layouts.get('sc_trace_gradient');
        return calling(call => {
            const where = pose_in(call, 'pose', pose), trace = traced_in(call, traced);
            const count = traced.nodes.edge.length, rows = call.room(size * count);
            check(library.sc_trace_gradients(model, where, trace, rows));
            return columns(rows, count, size, 'sc_trace_gradient', GRADIENT);
        });
    }

    /** The length of all contours, and how it changes as each vertex moves: three numbers for each. */
    traceLength(pose, found = null) {
        const traced = this.trace(pose, found), {vertices, weights, vectors} = this.traceGradients(pose, traced);
        const gradient = new Float64Array(3 * this.#info.vertexCount);
        vertices.forEach((vertex, i) => {
            const node = Math.floor(i / 5), of_triangle = i % 5 < 2 ? 0 : 1;
            for (let k = 0; k < 3; ++k)
                gradient[3 * vertex + k] += weights[i] * vectors[6 * node + 3 * of_triangle + k];
        });
        return {length: traced.contours.length.reduce((sum, length) => sum + length, 0), gradient};
    }

    /* Calls a function that fills a structure for each pair, and makes an array of each member; and
       what more(rows, size) makes of these structures. */
    #columns(pose, pairs, name, ask, members, more = () => ({})) {
        const model = this.#model(), {size} = layouts.get(name);
        pairs = numbers('pairs', pairs, 2);
        return calling(call => {
            const count = pairs.length / 2, where = pose_in(call, 'pose', pose);
            const list = call.copy(pairs), rows = call.room(count * size);
            check(ask(model, where, list, BigInt(count), rows));
            return {...columns(rows, count, size, name, members), ...more(rows, size)};
        });
    }

    #model() {
        if (!this.#handles.model) throw new TypeError('the model has been freed');
        return this.#handles.model;
    }

    /* Makes the workspace fit for queries of a kind. */
    #workspace(flags) {
        const handles = this.#handles, model = this.#model();
        if (flags > handles.flags) {
            calling(call => {
                const how = call.structure('sc_workspace_options', {flags}), made = call.room(4);
                check(library.sc_workspace_create_for(model, how, made));
                library.sc_workspace_free(handles.workspace);
                handles.workspace = view.getUint32(made, true);
                handles.flags = flags;
                check(library.sc_workspace_set_hooks(handles.workspace, library.sc_refusal_hooks()));
            });
        }
        return handles.workspace;
    }

    /*
     * Asks a question. given writes its arguments and returns the call, of the address of a result;
     * answer reads that. lists are the names of the lists of pairs in the result, for which there is
     * more room the second time if there was too little.
     */
    #ask(flags, name, lists, answer, given) {
        const workspace = this.#workspace(flags), {first, second} = this.#handles;
        const room = [first, second].slice(0, lists.length);
        return calling(call => {
            const ask = given(call, workspace), result = call.structure(name, {});
            const member = (list, what) => list === 'pairs' ? what : `${list}_${what}`;
            const arrays = list => list === 'pairs' ? list : `${list}s`;
            const is_timed = layouts.get(name).members.has('vertex_face_times');
            const bytes = is_timed ? 16 : 8; // behind the pairs come their times
            for (;;) {
                for (const [i, list] of lists.entries()) {
                    const capacity = Math.floor(room[i].bytes / bytes);
                    write(name, result, {
                        [member(list, 'capacity')]: capacity,
                        [arrays(list)]: room[i].address
                    });
                    if (is_timed) write(name, result, {[`${list}_times`]: room[i].address + 8 * capacity});
                }
                const status = ask(result);
                refresh();
                if (status !== ERROR_SHORT_BUFFER) {
                    if (status !== ERROR_INCOMPLETE) check(status);
                    const told = answer(result, ...room);
                    if (status === ERROR_INCOMPLETE) throw new Incomplete(told);
                    return told;
                }
                for (const [i, list] of lists.entries()) {
                    const count = read(name, result, member(list, 'count'));
                    grow(room[i], count + Math.ceil(count / 4), bytes);
                }
            }
        });
    }
}

if (Symbol.dispose) Model.prototype[Symbol.dispose] = Model.prototype.free;

/* Of a budget that ended a query: what fits the array was written. */
function listed(result, name, list, kind, bytes = 8) {
    const count = read(name, result, `${kind}_count`);
    return words(list.address, 2 * Math.min(count, Math.floor(list.bytes / bytes)));
}

function timed(result, list, kind, candidates) {
    const pairs = listed(result, 'sc_step_result', list, kind, 16);
    const times = read('sc_step_result', result, `${kind}_times`);
    return {pairs, times: candidates ? null : reals(times, pairs.length / 2)};
}

const camel = name => name.replace(/_(.)/g, (_, letter) => letter.toUpperCase());

/* Each returns what makes a model: of a Call and the place for it, a status. */
function built(vertices, triangles, options) {
    const {weld = 'rest', order, boxes = false} = known(options, ['weld', 'order', 'boxes']);
    vertices = positions('vertices', vertices);
    triangles = numbers('triangles', triangles, 3);
    const map = typeof weld === 'string' ? null : numbers_of('weld', weld, vertices.length / 3, 1);
    const how = map ? 1 : choice('weld', weld, ['rest', '', 'none']);
    const patches = numbers_of('order', order, triangles.length / 3, 1);
    return (call, model) => library.sc_build(
        call.structure('sc_mesh', {
            vertex_count: vertices.length / 3,
            triangle_count: triangles.length / 3,
            position_type: vertices instanceof Float64Array ? 1 : 0,
            positions: call.copy(vertices),
            indices: call.copy(triangles)
        }),
        call.structure('sc_build_options', {
            weld: how,
            weld_map: call.copy(map),
            partition: patches ? 1 : 0,
            order: call.copy(patches),
            hooks: library.sc_refusal_hooks(),
            content: boxes ? 1 : 0
        }),
        model);
}

function loaded(data) {
    return (call, model) => library.sc_model_load(call.copy(data), BigInt(data.length),
        call.structure('sc_load_options', {hooks: library.sc_refusal_hooks()}), model);
}

/** The two vertices of each edge 3 t + k: from corner k to corner (k + 1) % 3 of triangle t. */
export function edgeVertices(triangles, edges) {
    triangles = numbers('triangles', triangles, 3);
    edges = numbers('edges', edges, 1);
    const ends = new Uint32Array(2 * edges.length);
    edges.forEach((edge, i) => {
        if (edge >= triangles.length) throw new RangeError(`there is no edge ${edge}`);
        ends[2 * i] = triangles[edge];
        ends[2 * i + 1] = triangles[edge % 3 < 2 ? edge + 1 : edge - 2];
    });
    return ends;
}
