/*
 * What both pages are made of, the one that sc-query --html writes and the one with a cloth
 * (tools/npm/page): a mesh that the mouse turns, with a lamp at the camera, in the colors of the page.
 *
 * SPDX-License-Identifier: MIT
 */
import {
    AmbientLight, BufferGeometry, Color, DirectionalLight, DoubleSide, Mesh, MeshLambertMaterial,
    PerspectiveCamera, Scene, WebGLRenderer
} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';

export const at = id => document.getElementById(id);
export const plural = (count, word) => `${count.toLocaleString('en')} ${word}${count === 1 ? '' : 's'}`;

/* A color that the page's style has a name for. */
export const color_of = name =>
    new Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim());

/* A view into the page's canvas, of a scene with two objects, which are still empty: all is a mesh,
   whose material is surface, and hits the faces of it that collide, whose material is the first of
   paints, one for each of colors. */
export function make_view(colors) {
    const canvas = at('canvas');
    const renderer = new WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
    const camera = new PerspectiveCamera(40, 1, 0.01, 100);
    const controls = new OrbitControls(camera, canvas);
    const scene = new Scene();
    const lamp = new DirectionalLight('#ffffff', 2.2);
    lamp.position.set(0.4, 0.7, 1);
    camera.add(lamp);
    const surface = new MeshLambertMaterial({
        side: DoubleSide, flatShading: true, polygonOffset: true, polygonOffsetFactor: 1,
        polygonOffsetUnits: 1
    });
    const paints = colors.map(color => new MeshLambertMaterial({
        color, emissive: color, emissiveIntensity: 0.45, side: DoubleSide, flatShading: true
    }));
    const all = new Mesh(new BufferGeometry(), surface);
    const hits = new Mesh(new BufferGeometry(), paints[0]);
    for (const object of [all, hits]) object.frustumCulled = false;
    scene.add(camera, new AmbientLight('#ffffff', 1.1), all, hits);
    return {canvas, renderer, camera, controls, scene, surface, paints, all, hits};
}

/* Fits a view to the room that the page has for it; false if there is none. */
export function fit_to_room({renderer, camera}) {
    const {clientWidth: width, clientHeight: height} = at('view');
    if (!width || !height) return false;
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    return true;
}
