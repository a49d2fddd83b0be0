/*
 * Looks at what sc-query --html and --png write, in Chromium without a window; for test_page.sh.
 *
 *     node tests/look.mjs MODULES BROWSER page FILE        prints "ok NAME" or "not ok NAME: why"
 *     node tests/look.mjs MODULES BROWSER nothing FILE     the same of one without any mesh
 *     node tests/look.mjs MODULES BROWSER picture FILE     the same of a PNG file
 *     node tests/look.mjs MODULES BROWSER shot FILE PNG [KEY...]   after keys, as README.md shows it
 *
 * MODULES: the folder in whose node_modules playwright-core is. FILE of page: two frames of
 * test_page.sh.
 *
 * SPDX-License-Identifier: MIT
 */
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [modules, browser_path, job, file, ...rest] = process.argv.slice(2);
const {chromium} = createRequire(resolve(modules) + '/')('playwright-core');
const browser = await chromium.launch({
    executablePath: browser_path,
    args: ['--no-sandbox', '--enable-unsafe-swiftshader']
});
const errors = [], requests = [];

async function open(options) {
    const page = await browser.newPage(options);
    page.on('pageerror', error => errors.push(error.message));
    page.on('console', message => message.type() === 'error' && errors.push(message.text()));
    page.on('request', request => requests.push(request.url()));
    await page.goto(pathToFileURL(resolve(file)).href);
    await page.waitForFunction(() => window.starcontour?.ready, null, {timeout: 60000});
    return page;
}

function check(name, is_true, why = '') {
    console.log(is_true ? `ok ${name}` : `not ok ${name}: ${why}`);
}

/* Waits until the camera stands still and has been drawn. */
async function settle(page) {
    await page.waitForFunction(() => !starcontour.state().flying, null, {timeout: 20000});
    await page.evaluate(() => new Promise(done =>
        requestAnimationFrame(() => requestAnimationFrame(done))));
}

/* Red pixels of the canvas, those of them near a point, and a sum over all. */
const look = (page, point) => page.evaluate(point => {
    const from = document.getElementById('canvas'), copy = document.createElement('canvas');
    copy.width = from.width;
    copy.height = from.height;
    const context = copy.getContext('2d');
    context.drawImage(from, 0, 0);
    const {data} = context.getImageData(0, 0, copy.width, copy.height);
    const center = point && starcontour.project(point), near = copy.width / 12;
    let red = 0, there = 0, sum = 0;
    for (let i = 0; i < data.length; i += 4) {
        sum = (sum * 31 + data[i] + 7 * data[i + 1] + 13 * data[i + 2]) % 1000000007;
        if (data[i] < 120 || data[i + 1] > 0.45 * data[i] || data[i + 2] > 0.45 * data[i]) continue;
        red++;
        const x = i / 4 % copy.width, y = Math.floor(i / 4 / copy.width);
        there += center && Math.hypot(x - center[0], y - center[1]) < near;
    }
    return {red, there, sum, center};
}, point);

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

async function look_at_page() {
    const page = await open({viewport: {width: 1100, height: 700}, colorScheme: 'light'});
    const state = () => page.evaluate('starcontour.state()');
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
        const before = await state();
        await page.locator('#places button').nth(i).click();
        await settle(page);
        const after = await state(), seen = await look(page, one.center);
        const target = one.center.map((x, k) => x - (frames[0].low[k] + frames[0].high[k]) / 2);
        check(`a click on place ${i + 1} moves the camera`, distance(before.eye, after.eye) > 0.1,
            JSON.stringify([before.eye, after.eye]));
        check('towards it', distance(after.target, target) < 1e-6, JSON.stringify([after.target, target]));
        check('where it is red', seen.there > 20, JSON.stringify(seen));
        check('and it is marked', await page.locator('#places button').nth(i).getAttribute('aria-current') === 'true');
    }
    await page.keyboard.press('c');
    await settle(page);
    check('the second place has another color', (await look(page, places[1].center)).there === 0);
    await page.keyboard.press('c');
    await settle(page);
    check('or is red again', (await look(page, places[1].center)).there > 20);
    await page.keyboard.press('n');
    await settle(page);
    check('the key N goes on', (await state()).place === 0, (await state()).place);
    await page.keyboard.press('f');
    await settle(page);
    const fitted = await look(page);
    await page.keyboard.press('x');
    await settle(page);
    check('X sees through the mesh', (await look(page)).sum !== fitted.sum);
    await page.keyboard.press('x');
    await settle(page);
    check('and back', (await look(page)).sum === fitted.sum);

    await page.locator('#slider').focus();
    await page.keyboard.press('End');
    await page.waitForFunction(() => starcontour.state().frame === 1);
    await settle(page);
    const second = await look(page);
    check('the slider changes the picture', second.sum !== fitted.sum);
    check('the other frame has no red', second.red === 0, second.red);
    check('and says so', (await page.locator('#count').innerText()) === 'No collision');
    check('and its name', (await page.locator('#title').innerText()).includes('clean<!--<script>.obj'),
        await page.locator('#title').innerText());
    check('two curves', await page.locator('#curve polyline').count() === 2);
    await page.locator('#canvas').focus();
    await page.keyboard.press('ArrowLeft');
    await page.waitForFunction(() => starcontour.state().frame === 0);
    await settle(page);
    check('a key goes back to the first picture', (await look(page)).sum === fitted.sum);
    const curve = await page.locator('#curve').boundingBox();
    await page.mouse.click(curve.x + curve.width - 6, curve.y + curve.height / 2);
    await page.waitForFunction(() => starcontour.state().frame === 1);
    check('the curve is a slider, too', (await state()).frame === 1);
    await page.keyboard.press('t');
    await settle(page);
    check('T makes it dark', (await state()).theme === 'dark' && (await look(page)).sum !== second.sum);
    await page.locator('#help').click();
    check('help opens', await page.locator('#keys').isVisible());
    await page.close();

    const dark = await open({viewport: {width: 600, height: 500}, colorScheme: 'dark'});
    check('dark where the system is', (await dark.evaluate('starcontour.state()')).theme === 'dark');
    await dark.close();
    const phone = await open({viewport: {width: 390, height: 780}, hasTouch: true, isMobile: true, deviceScaleFactor: 2});
    const {width, height} = await phone.locator('#canvas').boundingBox();
    check('on a phone the mesh has room', width >= 380 && height >= 240, `${width} x ${height}`);
    check('and nothing is cut off', await phone.evaluate('document.documentElement.scrollWidth <= innerWidth'));
    await phone.locator('#places button').first().tap();
    await settle(phone);
    check('a tap flies there', (await phone.evaluate('starcontour.state()')).place === 0);
    await phone.close();
    check('no errors', errors.length === 0, errors.join('; '));
    check('nothing is fetched but the page', requests.length === 3 && requests.every(url => url.startsWith('file:')),
        requests.join(' '));
}

/* A picture: how large, and what is in each view, and whether there is red in the first. */
async function look_at_picture() {
    const page = await browser.newPage();
    const found = await page.evaluate(async text => {
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
            red[third] += data[i] > 120 && data[i + 1] < 0.45 * data[i];
            drawn[third] += data[i] < 250;
        }
        return {width: image.width, height: image.height, red, drawn};
    }, readFileSync(file).toString('base64'));
    check('1500 by 500 pixels', found.width === 1500 && found.height === 500, JSON.stringify(found));
    check('something in each view', found.drawn.every(count => count > 1000), JSON.stringify(found));
    check('red in the first', found.red[0] > 200, JSON.stringify(found));
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
else if (job === 'picture') await look_at_picture();
else {
    const page = await open({viewport: {width: 1200, height: 760}, colorScheme: 'light'});
    for (const key of rest.slice(1)) {
        await page.keyboard.press(key);
        await page.waitForTimeout(1500);
    }
    await page.screenshot({path: rest[0]});
}
await browser.close();
