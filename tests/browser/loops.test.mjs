// The loops of a saved run: the list, its filter, and the selection by mouse and by keys.

import assert from 'node:assert/strict';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { withBrowser, paintedPixels, seen, until } from './harness.mjs';

const FAST = ['--set', 'sim.fps=10', '--set', 'sim.width=320', '--set', 'sim.height=240'];

/** Adds loops that are no edges to a run: two provisional ones, a rejected and a withdrawn one. */
function addOtherLoops(folder) {
  const stamps = readFileSync(join(folder, 'keyframes.txt'), 'utf8').match(/^[\d.]+/gm);
  const file = join(folder, 'run.json');
  const figures = JSON.parse(readFileSync(file, 'utf8'));
  const half = Math.floor(stamps.length / 2);
  const loop = (a, b, status, reason, scale) => ({ stamp_a: stamps[a], stamp_b: stamps[b], inliers: 41, support: 2, scale, status, reason });
  figures.other_loops = [
    loop(2, half, 'provisional', 'ambiguous', null),
    loop(3, half + 2, 'provisional', 'too few keyframes', 1.004),
    loop(5, half + 4, 'rejected', 'different scale', 0.93),
    loop(6, half + 6, 'withdrawn', 'does not fit', 1.01),
  ];
  writeFileSync(file, JSON.stringify(figures));
  return { accepted: figures.loops, others: figures.other_loops };
}

const rows = (page) => page.locator('#loopList [role=option]').allInnerTexts();
const selected = (page) => page.locator('#loopList [aria-selected=true]').allInnerTexts();
const moment = (page) => page.textContent('#momentText');
/** Numbers of drawn points of the lines, by status. */
const drawn = (page) =>
  page.evaluate(() => Object.fromEntries(Object.entries(window.kinloop.world.loopLines).map(([status, { object }]) => [status, object.geometry.drawRange.count])));

async function checkFilter(page, loops) {
  const shown = await rows(page);
  assert.equal(shown.length, loops.accepted.length + 2, 'accepted and provisional ones at first');
  const ambiguous = shown.find((text) => text.includes('another place fits as well'));
  assert.match(ambiguous, /provisional\s+[\d.]+ s ↔ [\d.]+ s\s+2 keyframes · 41 inliers\s/, 'status, times and figures');
  await until(async () => (await drawn(page)).accepted === 2 * loops.accepted.length, 'a line each');
  const before = await drawn(page);
  assert.ok(before.provisional > 2 * 2, 'dashed');
  assert.ok(before.rejected === 0 && before.withdrawn === 0);

  await page.getByLabel(/^rejected/).check();
  assert.equal((await rows(page)).length, loops.accepted.length + 3);
  await until(async () => (await drawn(page)).rejected > 2, 'its line');
  await page.getByLabel(/^accepted/).uncheck();
  assert.equal((await rows(page)).length, 3);
  await until(async () => (await drawn(page)).accepted === 0, 'their lines are gone');
  await page.getByLabel(/^rejected/).uncheck();
  await page.getByLabel(/^provisional/).uncheck();
  assert.equal(await page.isVisible('#loopList'), false, 'nothing is left');
  for (const status of ['accepted', 'provisional', 'withdrawn']) await page.getByLabel(new RegExp(`^${status}`)).check();
  assert.match((await rows(page)).join(), /withdrawn/);
}

async function checkSelection(page, loops) {
  const index = (await rows(page)).findIndex((text) => text.startsWith('accepted'));
  await page.locator('#loopList [role=option]').nth(index).click();
  assert.equal((await selected(page)).length, 1);
  assert.match(await page.textContent('#loop h2'), /accepted loop/);
  assert.match(await page.textContent('#loop dl'), /keyframes that agree\d+inliers\d+scale[\d.]+/);
  for (const side of [0, 1]) {
    const image = `#loop figure:nth-child(${side + 1}) canvas`;
    await until(async () => (await paintedPixels(page, image)) > 5000, `picture ${side}`);
  }
  const captions = await page.locator('#loop figcaption').allTextContents();
  const [earlier, later] = captions.map((text) => Number(text.match(/([\d.]+) s/)[1]));
  assert.ok(earlier < later, captions.join());
  assert.ok((await moment(page)).startsWith(`${later.toFixed(2)} s`), 'the timeline is at the later end');
  const highlighted = () => page.evaluate(() => window.kinloop.world.selectedLines.object.geometry.drawRange.count);
  await until(async () => (await highlighted()) > 2, 'its line and its cameras');

  const command = await page.textContent('#withdrawalCommand');
  assert.match(command, /^kinloop map withdraw \S+map\.kinmap --loop [\d.]+,[\d.]+ -o \S+_withdrawn\.kinmap$/);
  const stamps = command.match(/--loop (\S+)/)[1];
  assert.ok(loops.accepted.some(({ stamp_a: a, stamp_b: b }) => `${a},${b}` === stamps), command);

  await page.click('#closeLoop');
  assert.equal(await page.isVisible('#loop'), false);
  await until(async () => (await highlighted()) === 0, 'nothing is highlighted');
}

async function checkKeys(page) {
  const count = (await rows(page)).length;
  await page.locator('#scene').focus();
  await page.keyboard.press('n');
  assert.deepEqual(await selected(page), (await rows(page)).slice(0, 1), 'the first');
  await page.keyboard.press('n');
  await page.keyboard.press('Shift+N');
  assert.deepEqual(await selected(page), (await rows(page)).slice(0, 1), 'and back');
  await page.locator('#loopList').focus();
  await page.keyboard.press('ArrowDown');
  assert.deepEqual(await selected(page), (await rows(page)).slice(1, 2));
  const active = await page.getAttribute('#loopList', 'aria-activedescendant');
  assert.equal(await page.getAttribute(`#${active}`, 'aria-selected'), 'true');
  const there = await moment(page);
  await page.keyboard.press('End');
  assert.deepEqual(await selected(page), (await rows(page)).slice(count - 1), 'End is a key of the list here');
  assert.notEqual(await moment(page), there);
  await page.keyboard.press('Escape');
  assert.deepEqual(await selected(page), []);
  assert.equal(await page.isVisible('#loop'), false);
}

/** A click on the line of the provisional loop, seen from above. */
async function checkClickOnLine(page) {
  await page.keyboard.press('2');
  await until(() => page.evaluate(() => !window.kinloop.view.cameraControls.goal), 'the view from above');
  await page.uncheck('[data-layer=cloud]');
  const [loop, x, y] = await page.evaluate(() => {
    const { view, panel } = window.kinloop;
    const [i, a, b] = panel.loops.lines.find(([index]) => panel.loops.loops[index].status === 'provisional');
    const places = view.keyframePlaces();
    const place = places[a].clone().lerp(places[b], 0.45).project(view.cameraControls.camera);
    const { clientWidth, clientHeight } = view.renderer.domElement;
    return [i, ((place.x + 1) / 2) * clientWidth, ((1 - place.y) / 2) * clientHeight];
  });
  await page.mouse.click(x, y);
  assert.equal(await page.evaluate(() => window.kinloop.panel.loops.selected), loop);
  assert.equal(await page.isVisible('#withdrawal'), false, 'it is not in the map');
  await page.keyboard.press('l');
  await page.keyboard.press('Escape');
  await page.mouse.click(x, y);
  assert.equal(await page.evaluate(() => window.kinloop.panel.loops.selected), undefined, 'hidden lines cannot be selected');
  await page.keyboard.press('l');
  await page.check('[data-layer=cloud]');
}

async function checkPhone(page, shoot) {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.click('#row [data-opens=loops]');
  await page.locator('#loopList [role=option]').first().click();
  const [card, panel, bar] = await Promise.all(['#loop', '#panel', '#timeline'].map((part) => page.locator(part).boundingBox()));
  assert.ok(card.x >= 0 && card.x + card.width <= 390, 'it is as wide as the phone');
  assert.ok(card.y + card.height <= panel.y && panel.y + panel.height <= bar.y + 1, 'nothing overlaps');
  await shoot(page, 'loops-phone');
}

/** Takes the first accepted loop out of the map that a page shows. */
async function checkWithdrawal(page, file, before) {
  const old = readFileSync(file);
  await page.locator('#loopList [role=option]', { hasText: /^\s*accepted/ }).first().click();
  const shownRun = () => page.evaluate(() => window.kinloop.connection.run);
  const run = await shownRun();
  await page.click('#withdraw');
  await until(async () => (await shownRun()) !== run, 'another scene');
  await until(async () => (await page.textContent('#message')).includes('map_withdrawn.kinmap'), 'the page names the new map');
  await until(async () => (await rows(page)).filter((text) => text.startsWith('accepted')).length === before - 1, 'one loop less');
  await page.getByLabel(/^withdrawn 1/).check();
  assert.match((await rows(page)).join(), /withdrawn[^]*it was taken out by hand/);
  assert.ok(existsSync(file.replace('.kinmap', '_withdrawn.kinmap')));
  assert.ok(old.equals(readFileSync(file)), 'the old map is as it was');
  await until(async () => (await seen(page)).points > 10_000, 'the cloud of the new map');
}

await withBrowser(async ({ open, kinloop, folder, shoot }) => {
  const out = join(folder, 'out');
  assert.equal(await kinloop('run', 'sim:room', '-q', '-o', out, ...FAST).ended, 0);
  const loops = addOtherLoops(out);
  assert.ok(loops.accepted.length > 0);

  const page = await open(await kinloop('view', out, '--port', '0').url());
  await until(async () => (await seen(page)).points > 10_000, 'the cloud is there');
  await until(() => page.evaluate(() => window.kinloop.world.pictures.count > 10), 'the images are there');
  await checkFilter(page, loops);
  await checkSelection(page, loops);
  await checkKeys(page);
  await checkClickOnLine(page);
  await page.keyboard.press('n');
  await shoot(page, 'loops-light');
  await page.emulateMedia({ colorScheme: 'dark' });
  await shoot(page, 'loops-dark');
  await checkPhone(page, shoot);
  await page.close();

  // The map alone has its own ones; a cloud has none.
  const file = join(out, 'map.kinmap');
  const url = await kinloop('view', file, '--port', '0').url();
  const map = await open(url);
  const accepted = async () => (await rows(map)).filter((text) => text.startsWith('accepted'));
  await until(async () => (await accepted()).length === loops.accepted.length, 'those of the map');
  await until(() => map.evaluate(() => window.kinloop.world.pictures.count > 10), 'the images are there');
  await checkWithdrawal(map, file, loops.accepted.length);
  await map.close();
  const spectator = await open(url.replace(/\?.*/, ''));
  await until(async () => (await rows(spectator)).length > 0, 'the loops are there');
  await spectator.locator('#loopList [role=option]').first().click();
  assert.equal(await spectator.isVisible('#withdraw'), false, 'without the token');
  await spectator.close();
  const cloud = await open(await kinloop('view', join(out, 'map.ply'), '--port', '0').url());
  await until(async () => (await seen(cloud)).points > 10_000, 'the cloud is there');
  assert.equal(await cloud.isVisible('#loops'), false);
  await cloud.close();

  // The report lists all of them.
  const report = join(folder, 'report.html');
  assert.equal(await kinloop('report', out, '-o', report).ended, 0);
  const paper = await open(pathToFileURL(report).href);
  const summary = paper.getByText(`all loops: ${loops.accepted.length} accepted, 2 provisional, 1 rejected, 1 withdrawn`);
  await summary.click();
  const rejected = await paper.locator('tr', { hasText: 'rejected' }).innerText();
  assert.match(rejected, /0\.930\s+the place has another size in each visit/);
});
