// Types of the package; see README.md, and starcontour.h for what a pair is and what is guaranteed.
//
// SPDX-License-Identifier: MIT

/** x, y, z of each vertex. Float32Array is taken as the floats that it has, all else as doubles. */
export type Positions = Float32Array | Float64Array | readonly number[];
/** Whole numbers; a Uint32Array is read as it is. */
export type Numbers = Uint32Array | Uint16Array | Int32Array | readonly number[];

/** The version of the library, such as "0.1.0". */
export const version: string;

/** What the library refused: `message` says which argument it is, and why. */
export class StarcontourError extends Error {
    /** SC_ERROR_... in starcontour.h. */
    readonly status: number;
    constructor(status: number, message?: string);
}

/** A query that ran out of its budget. */
export class Incomplete extends StarcontourError {
    /** What the query would have returned, as far as it got. */
    readonly found: unknown;
    constructor(found: unknown);
}

export interface BuildOptions {
    /** Which vertices are one: those at equal rest positions ("rest", the default), none, or, as an
     *  array, for each vertex the one that represents it. */
    weld?: 'rest' | 'none' | Numbers;
    /** A permutation of the triangles, consecutive ones of which form patches; else the library's. */
    order?: Numbers;
    /** For few poses: built in a third of the time, and queries take longer. */
    boxes?: boolean;
}

interface Common<Ignored> {
    /** Leaves out pairs so near to each other on the mesh; 1: that share a vertex. */
    ignoreRings?: number;
    /** Leaves out these pairs, sorted as a query returns them. */
    ignore?: Ignored;
    /** A category and a mask for each vertex, or for each triangle: see sc_group in starcontour.h. */
    vertexGroups?: Numbers;
    triangleGroups?: Numbers;
    /** Ends the query by an Incomplete after so many units of work; 0: no limit. */
    budget?: number;
}

export interface QueryOptions extends Common<Numbers> {
    /** What a pair is: two triangles, or an edge 3 t + k and a triangle. */
    pairs?: 'triangle' | 'edge';
    contact?: 'touching' | 'proper';
    /** The answer is the same. */
    method?: 'default' | 'sctt' | 'aabb_sctt' | 'aabb';
}

/** Two lists of pairs, a, b, a, b and so on: a vertex and a triangle, and two edges. */
export interface FeaturePairs {
    vertexFaces?: Numbers;
    edgeEdges?: Numbers;
}

interface FeatureOptions extends Common<FeaturePairs> {
    /** Leaves out pairs that are within restDistance of each other in this pose. */
    rest?: Positions;
    restDistance?: number;
}

export interface StepOptions extends FeatureOptions {
    /** How near is a collision; 0: touching. */
    separation?: number;
    /** How exactly distances are told; 0: a millionth of the size. */
    tolerance?: number;
    method?: 'default' | 'sctt' | 'two_boxes' | 'swept';
    /** What boxes and culling leave, in place of collisions; without times. */
    candidates?: boolean;
    /** Of pairs that begin within the separation only those that come nearer, or touch. */
    onlyNearer?: boolean;
}

export interface NearCountOptions extends FeatureOptions {
    kinds?: 'both' | 'vertex_face' | 'edge_edge';
    method?: 'default' | 'sctt' | 'boxes';
}

export interface NearOptions extends NearCountOptions {
    /** The closest points of each pair as well. */
    stencils?: boolean;
    /** For each vertex how far it may move, twice over; see vertex_bounds in starcontour.h. */
    vertexBound?: boolean;
}

/** Of n pairs the closest points; the vector between them is the sum of weights times positions. */
export interface Stencils {
    /** n: SC_FEATURE_..., 1 two vertices, 2 a vertex and an edge, 3 two edges, 4 a vertex and a face. */
    feature: Uint32Array;
    /** n: 1 for parallel edges, and faces without area. */
    flags: Uint32Array;
    /** 4 n. */
    vertices: Uint32Array;
    /** 4 n: of the first of the pair negative, of the second positive. */
    weights: Float64Array;
    /** 3 n: from the closest point of the first to that of the second. */
    vector: Float64Array;
    /** n. */
    distance: Float64Array;
}

/** Of n pairs of a step: closest points at its start and at a time, and how they stand then; see
 *  sc_step_stencil in starcontour.h. */
export interface StepStencils {
    start: Stencils;
    impact: Stencils;
    /** n. */
    time: Float64Array;
    /** 3 n. */
    normal: Float64Array;
    /** n: the side of the face on which the vertex began, 1, -1 or 0. */
    side: Int32Array;
    /** n: a sum of 1, they approach, and 2, there is no normal. */
    flags: Uint32Array;
}

/** Of n pairs where they meet: a point, the ends of a segment, or two corners of an area. */
export interface Contacts {
    /** n: 0 nowhere, 1 point, 2 segment, 3 area. */
    kind: Uint32Array;
    /** 6 n: both ends. */
    points: Float64Array;
    /** 6 n each: the weights of the corners of the first of the pair, and of the second, at both ends. */
    weightsA: Float64Array;
    weightsB: Float64Array;
}

/** Contours of intersections. On the surface each is two curves, through the triangles sheets[0] and
 *  sheets[1] of its nodes; see sc_trace in starcontour.h. */
export interface Trace {
    /** Of n nodes: where an edge of one sheet passes through a triangle of the other. */
    nodes: {
        /** n: 3 t + k; 0xffffffff where a contour ends in a vertex. */
        edge: Uint32Array;
        /** n: which the edge passes through; at such an end, the vertex. */
        triangle: Uint32Array;
        /** n: the sheet, 0 or 1, that the edge is on. */
        sheet: Uint32Array;
        /** 2 n: the triangles that the contour goes on in. */
        sheets: Uint32Array;
        /** n: where on the edge, from 0 to 1. */
        along: Float64Array;
        /** 3 n: where in the triangle. */
        weights: Float64Array;
        /** 3 n. */
        point: Float64Array;
    };
    /** Of m contours: which nodes, how they begin and end (0 closed, 1 border, 2 branch, 3 vertex),
     *  flags (1: its two sheets are one) and length. */
    contours: {
        first: Uint32Array;
        count: Uint32Array;
        begin: Uint32Array;
        end: Uint32Array;
        flags: Uint32Array;
        length: Float64Array;
    };
}

/** Points where three sheets meet; see sc_trace_triple in starcontour.h. */
export interface TraceTriples {
    /** 3 n: ascending. */
    triangles: Uint32Array;
    /** 3 n: behind each node is what the other two triangles have in common, */
    nodes: Uint32Array;
    /** 3 n: and where on it the point is, from 0 to 1. */
    along: Float64Array;
    /** 3 n. */
    point: Float64Array;
}

/** The parts into which contours divide a surface; see sc_trace_regions in starcontour.h. */
export interface Regions {
    regions: {
        component: Uint32Array;
        vertexCount: Uint32Array;
        area: Float64Array;
        /** How often closed components go round it; -2147483648 where that is not known. */
        inside: Int32Array;
    };
    /** Of each vertex the region it is in; 0xffffffff of those in no triangle, and of those that are
     *  welded to another one, which has their region. */
    vertexRegions: Uint32Array;
    /** 4 m: of each contour, on both sheets, the regions on both sides. */
    sides: Uint32Array;
}

/** Of each node of a Trace how its contour's length changes; see sc_trace_gradient in starcontour.h. */
export interface TraceGradients {
    /** 5 n: the ends of the edge, and the corners of the triangle. */
    vertices: Uint32Array;
    /** n: a sum of 1, the edge is parallel to the triangle, and 2, a segment has no length. */
    flags: Uint32Array;
    /** 5 n. */
    weights: Float64Array;
    /** 6 n: times weights the derivatives by the positions of the ends, and of the corners. */
    vectors: Float64Array;
}

export interface Near {
    vertexFaces: Uint32Array;
    edgeEdges: Uint32Array;
    vertexFaceStencils: Stencils | null;
    edgeEdgeStencils: Stencils | null;
    vertexBound: Float64Array | null;
}

export interface Step {
    vertexFaces: Uint32Array;
    edgeEdges: Uint32Array;
    /** When each pair collides, from 0 to 1: lower bounds; null of candidates. */
    vertexFaceTimes: Float64Array | null;
    edgeEdgeTimes: Float64Array | null;
    /** Nothing collides before this time; 1 if nothing does at all. */
    earliest: number;
}

export interface ModelInfo {
    readonly vertexCount: number;
    readonly pointCount: number;
    readonly triangleCount: number;
    readonly edgeCount: number;
    readonly componentCount: number;
    readonly boundaryEdges: number;
    readonly irregularEdges: number;
    readonly leafCount: number;
    readonly levelCount: number;
    readonly modelBytes: number;
    readonly workspaceBytes: number;
}

/** A triangle mesh in its rest pose, made ready for queries. */
export class Model {
    constructor(vertices: Positions, triangles: Numbers, options?: BuildOptions);
    static fromBytes(data: Uint8Array): Model;
    toBytes(): Uint8Array;
    get info(): ModelInfo;
    query(pose: Positions, options?: QueryOptions): Uint32Array;
    count(pose: Positions, options?: QueryOptions): number;
    collides(pose: Positions, options?: QueryOptions): boolean;
    step(start: Positions, end: Positions, options?: StepOptions): Step;
    stepCollides(start: Positions, end: Positions, options?: StepOptions): boolean;
    near(pose: Positions, distance: number, options?: NearOptions): Near;
    nearCounts(pose: Positions, distance: number, options?: NearCountOptions): [number, number];
    isNear(pose: Positions, distance: number, options?: NearCountOptions): boolean;
    stencils(pose: Positions, pairs: Numbers, kind: 'vertex_face' | 'edge_edge'): Stencils;
    stepStencils(start: Positions, end: Positions, pairs: Numbers, times: Float64Array | null,
        kind: 'vertex_face' | 'edge_edge'): StepStencils;
    contacts(pose: Positions, found: Numbers, options?: {pairs?: 'triangle' | 'edge'}): Contacts;
    trace(pose: Positions, found?: Numbers | null): Trace;
    traceTriples(pose: Positions, traced?: Trace | null): TraceTriples;
    regions(pose: Positions, traced?: Trace | null, options?: {inside?: boolean}): Regions;
    traceGradients(pose: Positions, traced: Trace): TraceGradients;
    traceLength(pose: Positions, found?: Numbers | null): {length: number, gradient: Float64Array};
    /** Gives back the memory. Also done some time after nothing refers to the model any more, and, in
     *  engines that have it, at the end of a block with `using`. */
    free(): void;
}

/** The two vertices of each edge 3 t + k. */
export function edgeVertices(triangles: Numbers, edges: Numbers): Uint32Array;
