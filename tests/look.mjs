/*
 * Looks at what sc-query --html and --png write, in Chromium without a window; for test_page.sh.
 *
 *     node tests/look.mjs MODULES BROWSER page FILE        prints "ok NAME" or "not ok NAME: why"
 *     node tests/look.mjs MODULES BROWSER contours FILE    the same of a page of --trace
 *     node tests/look.mjs MODULES BROWSER nothing FILE     the same of one without any mesh
 *     node tests/look.mjs MODULES BROWSER picture FILE     the same of a PNG file
 *     node tests/look.mjs MODULES BROWSER contour-picture FILE    the same of one of --trace
 *     node tests/look.mjs MODULES BROWSER shot FILE PNG [KEY...]   after keys, as README.md shows it
 *
 * tools/page/contours.png is such a shot, of a pose of tools/untangle:
 *
 *     python tools/untangle/untangle.py body --write build
 *     (cd build && bin/sc-query --trace --html body.html body-before.obj)
 *     node tests/look.mjs build/page BROWSER shot build/body.html tools/page/contours.png x
 *
 * MODULES: the folder in whose node_modules playwright-core is. FILE of page and contours: two frames
 * of test_page.sh.
 *
 * SPDX-License-Identifier: MIT
 */
import {readFileSync} from 'node:fs';

import {check, errors, launch, look, open_file, open_page, requests} from './browser.mjs';

const [modules, browser_path, job, file, ...rest] = process.argv.slice(2);
const browser = await launch(modules, browser_path);
const wide = {viewport: {width: 1100, height: 700}, colorScheme: 'light'};
const phone = {viewport: {width: 390, height: 780}, hasTouch: true, isMobile: true, deviceScaleFactor: 2};

async function open(options) {
    const page = await open_page(browser, options);
    await open_file(page, file, () => window.starcontour?.ready);
    return page;
}

const state = page => page.evaluate('starcontour.state()');

/* Waits until the camera stands still and has been drawn. */
async function settle(page) {
    await page.waitForFunction(() => !starcontour.state().flying, null, {timeout: 20000});
    await page.evaluate(() => new Promise(done =>
        requestAnimationFrame(() => requestAnimationFrame(done))));
}

/* Presses keys, one after the other. */
async function press(page, ...keys) {
    for (const key of keys) await page.keyboard.press(key);
    await settle(page);
}

/* Presses a key where a selector points, which leads to another frame. */
async function press_at(page, selector, key, frame) {
    await page.locator(selector).focus();
    await page.keyboard.press(key);
    await page.waitForFunction(frame => starcontour.state().frame === frame, frame);
    await settle(page);
}

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

/* Clicks on one of the list beside the mesh of a frame, which is a place or a contour. */
async function click_on(page, word, i, frame) {
    const button = page.locator('#places button').nth(i), before = await state(page);
    await button.click();
    await settle(page);
    const after = await state(page);
    const target = frame.places[i].center.map((x, k) => x - (frame.low[k] + frame.high[k]) / 2);
    check(`a click on ${word} ${i + 1} moves the camera`, distance(before.eye, after.eye) > 0.1,
        JSON.stringify([before.eye, after.eye]));
    check('towards it', distance(after.target, target) < 1e-6, JSON.stringify([after.target, target]));
    check('and it is marked', await button.getAttribute('aria-current') === 'true');
}

async function tap_on(page, i) {
    await page.locator('#places button').nth(i).tap();
    await settle(page);
    check('a tap flies there', (await state(page)).place === i);
}

const fits = page => page.evaluate('document.documentElement.scrollWidth <= innerWidth');

/* At the end, when the file was opened so many times. */
function check_quiet(opened) {
    check('no errors', errors.length === 0, errors.join('; '));
    check('nothing is fetched but the page',
        requests.length === opened && requests.every(url => url.startsWith('file:')), requests.join(' '));
}

async function look_at_page() {
    const page = await open(wide);
    const frames = await page.evaluate('starcontour.frames');
    await settle(page);
    const places = frames[0].places;
    check('two frames', frames.length === 2, frames.length);
    check('of one mesh', frames[1].mesh === frames[0].mesh);
    check('two places', places.length === 2 && frames[0].place_count === 2, places.length);
    check('which are listed', await page.locator('#places button').count() === 2);
    check('the names are those of the file',
        (await page.locator('#places').innerText()).includes('</script><b>odd / two'),
        await page.locator('#places').innerText());

    const first = await look(page, places[0].center);
    check('there is red', first.red > 20, first.red);

    for (const [i, one] of places.entries()) {
        await click_on(page, 'place', i, frames[0]);
        const seen = await look(page, one.center);
        check('where it is red', seen.there > 20, JSON.stringify(seen));
    }
    await press(page, 'c');
    check('the second place has another color', (await look(page, places[1].center)).there === 0);
    await press(page, 'c');
    check('or is red again', (await look(page, places[1].center)).there > 20);
    await press(page, 'n');
    check('the key N goes on', (await state(page)).place === 0, (await state(page)).place);
    await press(page, 'f');
    const fitted = await look(page);
    await press(page, 'x');
    check('X sees through the mesh', (await look(page)).sum !== fitted.sum);
    await press(page, 'x');
    check('and back', (await look(page)).sum === fitted.sum);

    await press_at(page, '#slider', 'End', 1);
    const second = await look(page);
    check('the slider changes the picture', second.sum !== fitted.sum);
    check('the other frame has no red', second.red === 0, second.red);
    check('and says so', (await page.locator('#count').innerText()) === 'No collision');
    check('and its name', (await page.locator('#title').innerText()).includes('clean<!--<script>.obj'),
        await page.locator('#title').innerText());
    check('two curves', await page.locator('#curve polyline').count() === 2);
    await press_at(page, '#canvas', 'ArrowLeft', 0);
    check('a key goes back to the first picture', (await look(page)).sum === fitted.sum);
    const curve = await page.locator('#curve').boundingBox();
    await page.mouse.click(curve.x + curve.width - 6, curve.y + curve.height / 2);
    await page.waitForFunction(() => starcontour.state().frame === 1);
    check('the curve is a slider, too', (await state(page)).frame === 1);
    await press(page, 't');
    check('T makes it dark', (await state(page)).theme === 'dark' && (await look(page)).sum !== second.sum);
    await page.locator('#help').click();
    check('help opens', await page.locator('#keys').isVisible());
    await page.close();

    const dark = await open({viewport: {width: 600, height: 500}, colorScheme: 'dark'});
    check('dark where the system is', (await state(dark)).theme === 'dark');
    await dark.close();
    const small = await open(phone);
    const {width, height} = await small.locator('#canvas').boundingBox();
    check('on a phone the mesh has room', width >= 380 && height >= 240, `${width} x ${height}`);
    check('and nothing is cut off', await fits(small));
    await tap_on(small, 0);
    await small.close();
    check_quiet(3);
}

/*
 * Contours of the frame that is shown, in the canvas: how many pixels have their color, how many of
 * these are far from all of them, and of points along each contour the part that has such a pixel
 * near. counts: of the segments of each.
 */
const look_along = (page, counts) => page.evaluate(async counts => {
    const {lines} = await starcontour.contours();
    const context = copy_canvas(), {width, height} = context.canvas;
    const {data} = context.getImageData(0, 0, width, height);
    context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--contour').trim();
    context.fillRect(0, 0, 1, 1);
    const wanted = context.getImageData(0, 0, 1, 1).data;
    const has = new Uint8Array(width * height), near = new Uint8Array(has.length);
    let colored = 0, stray = 0;
    for (let i = 0; i < has.length; i++)
        colored += has[i] = [0, 1, 2].every(k => Math.abs(data[4 * i + k] - wanted[k]) < 10);
    const round = ([x, y], act) => {
        for (let v = Math.round(y) - 5; v <= y + 5; v++) {
            for (let u = Math.round(x) - 5; u <= x + 5; u++)
                if (u >= 0 && v >= 0 && u < width && v < height) act(v * width + u);
        }
    };
    let segment = 0;
    const parts = counts.map(count => {
        let hit = 0, points = 0;
        for (const end = segment + count; segment < end; segment++) {
            for (let i = 0; i <= 200; i++, points++) {
                let found = 0;
                round(starcontour.project([0, 1, 2].map(k => {
                    const a = lines[6 * segment + k];
                    return a + i / 200 * (lines[6 * segment + 3 + k] - a);
                })), at => {
                    found |= has[at];
                    near[at] = 1;
                });
                hit += found;
            }
        }
        return hit / points;
    });
    for (let i = 0; i < has.length; i++) stray += has[i] && !near[i];
    let length = 0;
    for (let i = 0; i < lines.length; i += 6) length += Math.hypot(...[0, 1, 2].map(k => lines[i + 3 + k] - lines[i + k]));
    return {colored, stray, parts, length, segments: lines.length / 6};
}, counts);

/* The colors of the canvas at points of the mesh. */
const colors_at = (page, points) => page.evaluate(points => {
    const context = copy_canvas();
    return points.map(point => {
        const [x, y] = starcontour.project(point);
        return [...context.getImageData(Math.round(x), Math.round(y), 1, 1).data.slice(0, 3)];
    });
}, points);

/* What there is of each region: its area, and whether it is the smaller side of a contour. */
const region_areas = page => page.evaluate(async () => {
    const {parts, smaller} = await starcontour.contours();
    return parts.map(({region, corners}) => {
        let area = 0;
        for (let i = 0; i < corners.length; i += 3) {
            const [a, b, c] = corners.slice(i, i + 3);
            const u = b.map((x, k) => x - a[k]), v = c.map((x, k) => x - a[k]);
            area += Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
        }
        return {area, is_smaller: smaller[region]};
    });
});

/* Two spikes through a floor, which cut their tips off and triangles out of the floor, one of them out
   of both halves; and a wall, of which a third is above the floor. Then all apart. */
async function look_at_contours() {
    const page = await open(wide);
    const frames = await page.evaluate('starcontour.frames'), contours = frames[0].places;
    await settle(page);
    check('two frames of one mesh', frames.length === 2 && frames[1].mesh === frames[0].mesh, frames.length);
    check('three contours', contours.length === 3 && frames[0].place_count === 3, contours.length);
    check('the longest first', contours[0].length > 4 && Math.abs(contours[1].length * 2 - contours[0].length) < 1e-9 &&
        Math.abs(contours[2].length - 2) < 1e-12, JSON.stringify(contours.map(one => one.length)));
    const rows = await page.locator('#places button').allInnerTexts();
    check('closed and open', /long, closed/.test(rows[0]) && /long, open\n.*border to border/.test(rows[2]),
        rows.join(' | '));
    check('and their marks tell so', await page.locator('li:nth-child(1) .swatch.closed').count() === 1 &&
        await page.locator('li:nth-child(3) .swatch.open').count() === 1);
    check('what they cut off is told', rows[0].includes('0.889') && rows[1].includes('0.222') &&
        rows[2].includes('cuts off 2'), rows.join(' | '));

    /* The spike is two thirds as wide at the floor as at its base, of area 2; vertices have 16 bits. */
    const areas = await region_areas(page);
    const has_area = (area, is_smaller) => areas.some(one =>
        Math.abs(one.area - area) < 1e-3 && one.is_smaller === is_smaller);
    check('nine regions', frames[0].regions === 9 && areas.length === 9, JSON.stringify(areas));
    check('the floor is divided', has_area(8 / 9, true) && has_area(2 / 9, true) && has_area(32 - 10 / 9, false),
        JSON.stringify(areas));
    check('and the wall', has_area(2, true) && has_area(4, false), JSON.stringify(areas));
    check('and the spike, by its smaller side',
        areas.filter(one => one.is_smaller).some(one => Math.abs(one.area - Math.max(...contours[0].areas)) < 1e-3),
        JSON.stringify([areas, contours[0].areas]));

    const counts = [contours[0].nodes, contours[1].nodes, contours[2].nodes - 1];
    const first = await look_along(page, counts);
    check('all segments are there', first.segments === counts[0] + counts[1] + counts[2], JSON.stringify(first));
    check('as long as is told', Math.abs(first.length - frames[0].length) < 1e-3,
        JSON.stringify([first.length, frames[0].length]));
    check('contours are drawn where they are', first.parts[0] > 0.6 && first.parts[2] > 0.9, JSON.stringify(first));
    check('paler where the mesh hides them', first.parts[0] < 0.9, JSON.stringify(first));
    check('and nowhere else', first.colored > 200 && first.stray === 0, JSON.stringify(first));

    /* on the floor, the tip, and the upper part of the wall */
    const spots = [[4.3, 3, 0], [2.1, 1.5, 1.1], [6, 2, 0.6]];
    const spread = color => Math.max(...color) - Math.min(...color);
    const seen = await colors_at(page, spots);
    check('regions have colors', seen.every((color, i) => seen.every((other, k) => k === i || distance(color, other) > 30)),
        JSON.stringify(seen));
    check('the smaller ones stronger', Math.min(spread(seen[1]), spread(seen[2])) > 1.5 * spread(seen[0]),
        JSON.stringify(seen));
    const before_colors = await look(page);
    await press(page, 'c');
    const plain = await colors_at(page, spots);
    check('C takes them away', plain.every(color => spread(color) < 20), JSON.stringify(plain));
    await press(page, 'c');
    check('and back', (await look(page)).sum === before_colors.sum);

    for (const i of contours.keys()) {
        await click_on(page, 'contour', i, frames[0]);
        const along = await look_along(page, counts);
        check('where it is drawn', along.parts[i] > 0.4, JSON.stringify(along));
    }
    await press(page, 'n');
    check('the key N goes on', (await state(page)).place === 0, (await state(page)).place);
    await press(page, 'f');
    const fitted = await look(page);
    await press(page, 'x');
    const through = await look_along(page, counts);
    check('X shows all of the contours', through.parts.every(part => part > 0.95), JSON.stringify(through));
    await press(page, 'x', 't');
    const dark = await look_along(page, counts);
    check('in the dark they have a color, too', dark.parts[2] > 0.9 && dark.stray === 0, JSON.stringify(dark));
    await page.keyboard.press('t');
    await press_at(page, '#slider', 'End', 1);
    const none = await look_along(page, []);
    check('the other frame has none', none.colored === 0 && none.segments === 0, JSON.stringify(none));
    check('and says so', (await page.locator('#count').innerText()) === 'No contour');
    check('two curves', await page.locator('#curve polyline').count() === 2);
    await press_at(page, '#canvas', 'ArrowLeft', 0);
    check('a key goes back to the first picture', (await look(page)).sum === fitted.sum);
    await page.locator('#help').click();
    check('help is about contours', (await page.locator('#keys').innerText()).includes('the next contour'));
    await page.close();

    const small = await open(phone);
    check('on a phone nothing is cut off', await fits(small));
    await tap_on(small, 2);
    await small.close();
    check_quiet(2);
}

/* A picture: how large, and what is in each view, and whether the first has red, or a contour's
   color. */
async function look_at_picture(is_of_contours) {
    const page = await browser.newPage();
    const found = await page.evaluate(async ([text, is_of_contours]) => {
        const image = new Image();
        image.src = `data:image/png;base64,${text}`;
        await image.decode();
        const canvas = document.createElement('canvas');
        canvas.width = image.width;
        canvas.height = image.height;
        const context = canvas.getContext('2d');
        context.drawImage(image, 0, 0);
        const {data} = context.getImageData(0, 0, image.width, image.height);
        const red = [0, 0, 0], drawn = [0, 0, 0];
        for (let i = 0; i < data.length; i += 4) {
            const third = Math.floor(3 * (i / 4 % image.width) / image.width);
            red[third] += data[i] > 120 && data[i + 1] < 0.45 * data[i] &&
                (!is_of_contours || data[i + 1] < 20 && data[i + 2] > 80);
            drawn[third] += data[i] < 250;
        }
        return {width: image.width, height: image.height, red, drawn};
    }, [readFileSync(file).toString('base64'), is_of_contours]);
    check('1500 by 500 pixels', found.width === 1500 && found.height === 500, JSON.stringify(found));
    check('something in each view', found.drawn.every(count => count > 1000), JSON.stringify(found));
    check(is_of_contours ? 'a contour in the first' : 'red in the first', found.red[0] > 200, JSON.stringify(found));
}

/* A page without a mesh says so. */
async function look_at_nothing() {
    const page = await open();
    check('it says that there is no mesh',
        (await page.locator('#title').innerText()) === 'No mesh could be read.');
    check('no errors', errors.length === 0, errors.join('; '));
}

if (job === 'page') await look_at_page();
else if (job === 'nothing') await look_at_nothing();
else if (job === 'contours') await look_at_contours();
else if (job.endsWith('picture')) await look_at_picture(job !== 'picture');
else {
    const page = await open({viewport: {width: 1200, height: 760}, colorScheme: 'light'});
    for (const key of rest.slice(1)) {
        await page.keyboard.press(key);
        await page.waitForTimeout(1500);
    }
    await page.screenshot({path: rest[0]});
}
await browser.close();
