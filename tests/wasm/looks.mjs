/*
 * Looks at the page with the cloth, and at the package, in Chromium without a window; for page.sh.
 *
 *     node tests/wasm/looks.mjs MODULES BROWSER page FILE MESH...  "ok NAME" or "not ok NAME: why"
 *     node tests/wasm/looks.mjs MODULES BROWSER answers PACKAGE MESH...      lines, as answers.c
 *     node tests/wasm/looks.mjs MODULES BROWSER shot FILE PNG      a picture, as README.md shows it
 *
 * MODULES: the folder in whose node_modules playwright-core is. MESHes of page: see page.sh.
 *
 * SPDX-License-Identifier: MIT
 */
import {readFileSync} from 'node:fs';
import {basename} from 'node:path';

import {check, errors, launch, look, open_file, open_page, requests} from '../browser.mjs';

const [modules, browser_path, job, file, ...rest] = process.argv.slice(2);
const browser = await launch(modules, browser_path);

async function open_cloth(options) {
    const page = await open_page(browser, {...options, colorScheme: 'light'});
    await open_file(page, file, () => window.starcontour?.state().ready);
    return page;
}

const frames_on = (page, count) => page.evaluate(count => new Promise(done => {
    const wait = left => left ? requestAnimationFrame(() => wait(left - 1)) : done();
    wait(count);
}), count);

const CELLS = 48, vertex = (i, j) => i * (CELLS + 1) + j;

/* Leads the lower edge of the cloth up, to both sides and down again; says what the most pairs and the
   most red pixels were meanwhile, and leaves the mouse pressed. */
async function pull(page) {
    const most = {pairs: 0, red: 0};
    const where = (i, j) => page.evaluate(v => starcontour.project(v), vertex(i, j));
    const [begin, top] = [await where(2, 24), await where(44, 24)];
    const [left, right] = [await where(30, 2), await where(30, 46)];
    let at = begin;
    await page.mouse.move(...at);
    await page.mouse.down();
    for (const to of [top, left, right, top, begin, left]) {
        for (let i = 1; i <= 8; ++i) {
            await page.mouse.move(...at.map((x, k) => x + (to[k] - x) * i / 8));
            await frames_on(page, 2);
            const [{pairs}, {red}] = [await page.evaluate('starcontour.state()'), await look(page)];
            most.pairs = Math.max(most.pairs, pairs);
            most.red = Math.max(most.red, red);
        }
        at = to;
    }
    return most;
}

async function look_at_page([hit, moved, apart, ply, stl, bad]) {
    const page = await open_cloth({viewport: {width: 900, height: 700}});
    const state = () => page.evaluate('starcontour.state()');
    const text = id => page.locator(id).innerText();
    const drop = async (...files) => {
        await page.locator('#files').setInputFiles(files);
        await page.waitForFunction(name => document.getElementById('title').textContent === name,
            basename(files[0]), {timeout: 20000});
        await frames_on(page, 2);
    };
    check('a cloth', (await state()).mode === 'cloth', JSON.stringify(await state()));
    check('of many triangles', (await text('#title')).includes('4,608'), await text('#title'));
    const first = await look(page);
    check('without red', first.red === 0 && (await state()).pairs === 0, JSON.stringify(first));
    await frames_on(page, 20);
    const second = await look(page);
    check('which moves', second.sum !== first.sum);
    const said = await text('#said');
    check('milliseconds are said', /\d ms to find what collides, .*\d ms with/.test(said), said);
    const most = await pull(page), third = await look(page);
    check('pulled, it collides', most.pairs > 20, most.pairs);
    check('and is red there', most.red > 20, most.red);
    check('the picture is another', third.sum !== second.sum);
    await page.mouse.up();
    check('the camera stood still', await page.evaluate(() => {
        const [x, y] = starcontour.project(48 * 49), [a, b] = starcontour.project(48 * 49 + 48);
        return Math.abs(y - b) < 60 && x < a;
    }));

    await page.locator('#apart').click();
    await frames_on(page, 5);
    check('kept apart, it is the cloth again', (await state()).pairs === 0 && (await look(page)).red === 0);
    const kept = await pull(page), fourth = await look(page);
    await page.mouse.up();
    check('and pulled the same way never collides', kept.pairs === 0 && kept.red === 0, JSON.stringify(kept));
    check('though it moves', fourth.sum !== first.sum && fourth.sum !== third.sum);

    await drop(hit);
    const found = await text('#said');
    check('a mesh', found.startsWith('15 pairs of 24 triangles'), found);
    check('is red', (await look(page)).red > 20, JSON.stringify(await look(page)));
    check('has no slider', !await page.locator('#slider').isVisible());
    await drop(apart);
    check('one without collisions is not', (await look(page)).red === 0 && (await state()).pairs === 0);
    await drop(ply);
    check('PLY', (await state()).pairs === 1, await text('#said'));
    await drop(stl);
    check('STL', (await state()).pairs === 1, await text('#said'));
    await page.locator('#files').setInputFiles([bad]);
    await page.waitForFunction(() => starcontour.state().error, null, {timeout: 20000});
    check('a bad file is told', (await text('#hint')).includes('names vertex 8 of 3'), await text('#hint'));
    check('and changes nothing', (await text('#title')) === basename(stl));

    await drop(apart, moved);
    const slide = async number => {
        await page.locator('#slider').fill(`${number}`);
        await page.waitForFunction(n => starcontour.state().number === n, number);
        await frames_on(page, 2);
        return {...await state(), ...await look(page)};
    };
    const [still, later] = [await slide(0), await slide(1)];
    check('an animation', still.pairs === 0 && later.pairs === 1 && later.red > 20, JSON.stringify([still, later]));
    check('of one mesh', (await text('#said')).includes('a pose of the first mesh'), await text('#said'));
    await page.locator('#play').click();
    await page.waitForFunction(() => starcontour.state().number === 0);
    check('plays', true);
    await page.evaluate(text => {
        const data = new DataTransfer();
        data.items.add(new File([text], 'dropped.obj'));
        document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true}));
    }, readFileSync(moved, 'utf8'));
    await page.waitForFunction(() => document.getElementById('title').textContent === 'dropped.obj');
    check('a file that is dropped', (await state()).pairs === 1, await text('#said'));
    await page.locator('#cloth').click();
    await frames_on(page, 2);
    check('and back to the cloth', (await state()).mode === 'cloth');
    check('no errors', errors.length === 0, errors.join('; '));
    const fetched = requests.filter(url => !url.startsWith('blob:'));
    check('nothing is fetched but the page', fetched.length === 1, fetched.join(' '));
}

/* A site that has the package, the questions and the meshes. */
async function look_at_answers(meshes) {
    const page = await open_page(browser);
    await page.route('http://localhost/**', route => {
        const name = new URL(route.request().url()).pathname.slice(1);
        if (name === '') return route.fulfill({contentType: 'text/html', body: '<!doctype html>'});
        const path = name === 'answers.mjs' ? 'tests/wasm/answers.mjs' : `${file}/${name}`;
        return route.fulfill({contentType: 'text/javascript', body: readFileSync(path)});
    });
    await page.goto('http://localhost/');
    for (const mesh of meshes) {
        const lines = await page.evaluate(async ([name, text]) => {
            const [package_, {answers}] = await Promise.all([import('/index.js'), import('/answers.mjs')]);
            return answers(package_, name, text).lines;
        }, [basename(mesh), readFileSync(mesh, 'utf8')]);
        console.log(lines.join('\n'));
    }
    if (errors.length) throw new Error(errors.join('; '));
}

if (job === 'page') await look_at_page(rest);
else if (job === 'answers') await look_at_answers(rest);
else {
    const page = await open_cloth({viewport: {width: 1000, height: 700}});
    await pull(page);
    await page.screenshot({path: rest[0]});
}
await browser.close();
