/*
 * What the scripts that look at pages share: tests/look.mjs and tests/wasm/looks.mjs. Chromium without
 * a window, what a page does wrong or fetches, and the pixels of its canvas.
 *
 * SPDX-License-Identifier: MIT
 */
import {createRequire} from 'node:module';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

/* Of all pages of open_page: what was thrown or told as an error, and the addresses asked for. */
export const errors = [], requests = [];

/* modules: the folder in whose node_modules playwright-core is; path: of the browser. */
export function launch(modules, path) {
    const {chromium} = createRequire(resolve(modules) + '/')('playwright-core');
    return chromium.launch({executablePath: path, args: ['--no-sandbox', '--enable-unsafe-swiftshader']});
}

/* An empty page. In what is opened in it, copy_canvas() is a 2D context of a copy of the canvas. */
export async function open_page(browser, options) {
    const page = await browser.newPage(options);
    page.on('pageerror', error => errors.push(error.message));
    page.on('console', message => message.type() === 'error' && errors.push(message.text()));
    page.on('request', request => requests.push(request.url()));
    await page.addInitScript(() => {
        window.copy_canvas = () => {
            const from = document.getElementById('canvas'), copy = document.createElement('canvas');
            copy.width = from.width;
            copy.height = from.height;
            const context = copy.getContext('2d');
            context.drawImage(from, 0, 0);
            return context;
        };
    });
    return page;
}

/* Opens a file in a page, and waits until is_ready is true there. */
export async function open_file(page, file, is_ready) {
    await page.goto(pathToFileURL(resolve(file)).href);
    await page.waitForFunction(is_ready, null, {timeout: 60000});
}

export function check(name, is_true, why = '') {
    console.log(is_true ? `ok ${name}` : `not ok ${name}: ${why}`);
}

/* Red pixels of the canvas, those of them near a point of the mesh, if one is given, and a sum over
   all. */
export const look = (page, point) => page.evaluate(point => {
    const context = copy_canvas(), {width, height} = context.canvas;
    const {data} = context.getImageData(0, 0, width, height);
    const center = point && starcontour.project(point), near = width / 12;
    let red = 0, there = 0, sum = 0;
    for (let i = 0; i < data.length; i += 4) {
        sum = (sum * 31 + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1000000007;
        if (data[i] <= 120 || data[i + 1] >= 0.45 * data[i] || data[i + 2] >= 0.45 * data[i]) continue;
        red++;
        const x = i / 4 % width, y = Math.floor(i / 4 / width);
        if (center && Math.hypot(x - center[0], y - center[1]) < near) there++;
    }
    return {red, there, sum, center};
}, point);
