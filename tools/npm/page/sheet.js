/*
 * A cloth that hangs by two corners, moved by position-based dynamics (M. Mueller et al., 2007):
 * vertices go on as they went, then edges pull them back to their lengths.
 *
 * SPDX-License-Identifier: MIT
 *
 * Either the cloth goes through itself, or it is kept apart: then vertices that come near to
 * something are pushed off, along the vector between the closest points, and none moves by half of
 * the bound that near() gives it. So a cloth without intersections has none after (Offset Geometric
 * Contact, A. Chen et al., 2025).
 */
const GRAVITY = -2.5, FRAME = 1 / 60, ROUNDS = 10, DAMPING = 0.995;
const STEPS = 2, STEPS_APART = 4; // a frame
const THICKNESS = 0.45; // in cells: below 0.7, at which neighbours in the plane are

export class Sheet {
    grabbed = null;
    #model;
    #before;
    #weights; // how easily each vertex is moved; 0: not at all
    #edges = [];
    #thickness;

    constructor(Model, cells) {
        const row = cells + 1, corner = (i, j) => i * row + j;
        this.positions = new Float64Array(3 * row * row);
        this.#weights = new Float64Array(row * row).fill(1);
        this.#weights[corner(cells, 0)] = this.#weights[corner(cells, cells)] = 0;
        const triangles = [];
        for (let i = 0; i <= cells; ++i)
            for (let j = 0; j <= cells; ++j) {
                // A little bent, so that it falls to one side.
                const bend = 0.02 * Math.cos(9 * i / cells);
                this.positions.set([j / cells - 0.5, i / cells - 0.5, bend], 3 * corner(i, j));
                if (i < cells && j < cells) {
                    const a = corner(i, j), b = corner(i, j + 1);
                    const c = corner(i + 1, j), d = corner(i + 1, j + 1);
                    triangles.push(a, b, c, b, d, c);
                    this.#tie(b, c, 0.6);
                    this.#tie(a, d, 0.6);
                }
                if (i < cells) this.#tie(corner(i, j), corner(i + 1, j), 1);
                if (j < cells) this.#tie(corner(i, j), corner(i, j + 1), 1);
                if (i + 2 <= cells) this.#tie(corner(i, j), corner(i + 2, j), 0.1);
                if (j + 2 <= cells) this.#tie(corner(i, j), corner(i, j + 2), 0.1);
            }
        for (const edge of this.#edges) edge.length = this.#distance(edge.a, edge.b);
        this.triangles = Uint32Array.from(triangles);
        this.#before = this.positions.slice();
        this.#thickness = THICKNESS / cells;
        this.#model = new Model(this.positions, this.triangles);
    }

    get model() {
        return this.#model;
    }

    free() {
        this.#model.free();
    }

    #tie(a, b, stiffness) {
        this.#edges.push({a, b, stiffness, length: 0});
    }

    #distance(a, b) {
        const p = this.positions;
        return Math.hypot(p[3 * b] - p[3 * a], p[3 * b + 1] - p[3 * a + 1], p[3 * b + 2] - p[3 * a + 2]);
    }

    /* The mouse has a vertex, and where it wants it to be. */
    grab(vertex, point) {
        this.grabbed = {vertex, point, weight: this.#weights[vertex]};
        this.#weights[vertex] = 0;
    }

    pull(point) {
        this.grabbed.point = point;
    }

    let_go() {
        if (this.grabbed) this.#weights[this.grabbed.vertex] = this.grabbed.weight;
        this.grabbed = null;
    }

    /* Moves on by a frame; returns how many milliseconds went into finding what is near. */
    step(is_kept_apart) {
        const steps = is_kept_apart ? STEPS_APART : STEPS;
        let time = 0;
        for (let i = 0; i < steps; ++i) {
            const begin = performance.now();
            const near = is_kept_apart &&
                this.#model.near(this.positions, this.#thickness, {stencils: true, vertexBound: true});
            time += performance.now() - begin;
            this.#move(FRAME / steps, near);
        }
        return time;
    }

    #move(seconds, near) {
        const p = this.positions, before = this.#before, start = near && p.slice();
        for (let i = 0; i < p.length; ++i) {
            const is_free = this.#weights[Math.floor(i / 3)] > 0;
            const speed = is_free ? (p[i] - before[i]) * DAMPING : 0;
            before[i] = p[i];
            p[i] += speed + (is_free && i % 3 === 1 ? GRAVITY * seconds * seconds : 0);
        }
        if (this.grabbed) p.set(this.grabbed.point, 3 * this.grabbed.vertex);
        for (let i = 0; i < ROUNDS; ++i) {
            for (const edge of this.#edges) this.#shorten(edge);
            if (near) for (const list of [near.vertexFaceStencils, near.edgeEdgeStencils]) this.#push(list);
        }
        if (near) this.#limit(start, near.vertexBound);
    }

    /* Brings two vertices nearer to their distance at rest. */
    #shorten({a, b, stiffness, length}) {
        const p = this.positions, weight = this.#weights[a] + this.#weights[b], now = this.#distance(a, b);
        if (!weight || !now) return;
        const part = stiffness * (now - length) / now / weight;
        for (let k = 0; k < 3; ++k) {
            const difference = part * (p[3 * b + k] - p[3 * a + k]);
            p[3 * a + k] += this.#weights[a] * difference;
            p[3 * b + k] -= this.#weights[b] * difference;
        }
    }

    /* Pushes what was near at the start of the step apart, along the vector of then. */
    #push({vertices, weights, vector, distance}) {
        const p = this.positions;
        for (let i = 0; i < distance.length; ++i) {
            if (!distance[i]) continue;
            const normal = [0, 1, 2].map(k => vector[3 * i + k] / distance[i]);
            let now = 0, sum = 0;
            for (let j = 4 * i; j < 4 * i + 4; ++j) {
                const v = vertices[j];
                sum += weights[j] * weights[j] * this.#weights[v];
                for (let k = 0; k < 3; ++k) now += weights[j] * p[3 * v + k] * normal[k];
            }
            const lack = this.#thickness - now;
            if (lack <= 0 || !sum) continue;
            for (let j = 4 * i; j < 4 * i + 4; ++j) {
                const part = weights[j] * this.#weights[vertices[j]] * lack / sum;
                for (let k = 0; k < 3; ++k) p[3 * vertices[j] + k] += part * normal[k];
            }
        }
    }

    /* No vertex moves by half of its bound: 0.49 leaves room for rounding. */
    #limit(start, bounds) {
        const p = this.positions;
        for (let v = 0; v < bounds.length; ++v) {
            const move = [0, 1, 2].map(k => p[3 * v + k] - start[3 * v + k]);
            const part = 0.49 * bounds[v] / Math.hypot(...move);
            if (part < 1) for (let k = 0; k < 3; ++k) p[3 * v + k] = start[3 * v + k] + part * move[k];
        }
    }
}
