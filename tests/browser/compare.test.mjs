// Two compared maps, and the errors of a run against its ground truth.

import assert from 'node:assert/strict';
import { join } from 'node:path';

import { findings } from './axe.mjs';
import { withBrowser, paintedPixels, seen, until } from './harness.mjs';

const SMALL = ['--set', 'sim.fps=10', '--set', 'sim.width=320', '--set', 'sim.height=240'];
const ROOM = 'sim:room:100';

const rows = (page) => page.locator('#objectList [role=option]').allInnerTexts();
const selected = (page) => page.locator('#objectList [aria-selected=true]').allInnerTexts();
const lines = (page, name) => page.evaluate((key) => window.kinloop.world.lines[key].object.geometry.drawRange.count, name);
const boxLines = (page) => page.evaluate(() => window.kinloop.world.boxLines.object.geometry.drawRange.count);
/** Numbers of drawn points by layer of the comparison. */
const drawnPoints = (page) =>
  page.evaluate(() => {
    const { pieces, differences } = window.kinloop.world;
    const sum = ({ first, end }) => [...pieces].filter(([i, { object }]) => first <= i && i < end && object.visible).reduce((all, [, { object }]) => all + object.userData.count, 0);
    return Object.fromEntries(Object.entries(differences).map(([layer, range]) => [layer, sum(range)]));
  });

async function checkLayers(page) {
  const all = await drawnPoints(page);
  assert.ok(all.added > 500 && all.restBefore > 10_000 && all.restAfter > 10_000, JSON.stringify(all));
  assert.equal(all.gone, 0);
  await page.getByLabel(/^added: 2 objects/).uncheck();
  await until(async () => (await drawnPoints(page)).added === 0, 'what was added is hidden');
  assert.equal((await drawnPoints(page)).restAfter, all.restAfter, 'the rest is still there');
  await page.getByLabel(/^added/).check();
  await until(async () => (await drawnPoints(page)).added === all.added, 'it is back');
  for (const path of ['path before', 'path after']) await page.getByLabel(path).uncheck();
  await until(() => page.evaluate(() => !window.kinloop.world.layers.path.visible && !window.kinloop.world.layers.otherPath.visible), 'no path');
  for (const path of ['path before', 'path after']) await page.getByLabel(path).check();
  assert.ok((await lines(page, 'otherPath')) > 100);
  assert.match(await page.textContent('#differences'), /\d points seen again, .*\d not looked at/);
  assert.match(await page.textContent('#alignedBy'), /^Aligned by \d+ places recognised in both/);
}

async function checkSelection(page) {
  const list = await rows(page);
  assert.equal(list.length, 2);
  assert.match(list[0], /added\s+0\.\d\d m²/);
  await page.locator('#objectList [role=option]').first().click();
  assert.equal((await selected(page)).length, 1);
  await until(async () => (await boxLines(page)) === 2 * 12, 'the edges of a box');
  assert.match(await page.textContent('#object h2'), /added/);
  assert.match(await page.textContent('#object dl'), /surface0\.\d\d m²at-?\d/);
  for (const side of [0, 1]) {
    const image = `#object figure:nth-child(${side + 1}) canvas`;
    await until(async () => (await paintedPixels(page, image)) > 5000, `picture ${side}`);
  }
  const captions = await page.locator('#object figcaption').allTextContents();
  assert.match(captions[0], /^keyframe \d+ of before, before$/);
  assert.match(captions[1], /^keyframe \d+ of after, after$/);
  await until(() => page.evaluate(() => !window.kinloop.view.cameraControls.goal), 'the view has arrived');
  const [ahead, away] = await page.evaluate(() => {
    const { world, view } = window.kinloop;
    const corners = world.boxes[0].map((corner) => view.cameraControls.camera.position.clone().set(...corner).applyMatrix4(world.group.matrixWorld));
    const centre = corners.reduce((sum, corner) => sum.add(corner), corners[0].clone().set(0, 0, 0)).divideScalar(8);
    const onScreen = centre.clone().project(view.cameraControls.camera);
    return [Math.hypot(onScreen.x, onScreen.y), centre.distanceTo(view.cameraControls.camera.position)];
  });
  assert.ok(ahead < 0.05, `in the middle of the view: ${ahead}`);
  assert.ok(away < 5, `${away} m away`);
  await page.click('#closeObject');
  assert.equal(await page.isVisible('#object'), false);
  assert.deepEqual(await selected(page), []);
  await until(async () => (await boxLines(page)) === 0, 'no box');
}

async function checkKeys(page) {
  await page.locator('#scene').focus();
  await page.keyboard.press('o');
  assert.deepEqual(await selected(page), (await rows(page)).slice(0, 1), 'the first');
  await page.keyboard.press('o');
  assert.deepEqual(await selected(page), (await rows(page)).slice(1));
  await page.keyboard.press('Shift+O');
  assert.deepEqual(await selected(page), (await rows(page)).slice(0, 1), 'and back');
  await page.locator('#objectList').focus();
  await page.keyboard.press('ArrowDown');
  const active = await page.getAttribute('#objectList', 'aria-activedescendant');
  assert.equal(await page.getAttribute(`#${active}`, 'aria-selected'), 'true');
  assert.deepEqual(await selected(page), (await rows(page)).slice(1));
  await page.keyboard.press('Escape');
  assert.deepEqual(await selected(page), []);
  // A layer, by the keyboard alone.
  await page.getByLabel(/^rest of before/).focus();
  await page.keyboard.press(' ');
  await until(async () => (await drawnPoints(page)).restBefore === 0, 'the space bar hides it');
  await page.keyboard.press(' ');
}

/** An object that was moved has a box before and one after; the view takes in both. */
async function checkMoved(page) {
  await page.evaluate(() => {
    const { comparison } = window.kinloop.panel;
    const [first, second] = comparison.objects;
    const moved = { ...first, change: 'moved', boxBefore: second.boxAfter, moved_to_m: second.center_m, moved_by_m: 1.25 };
    comparison.take({ ...comparison.table, objects: [moved] });
  });
  assert.match((await rows(page)).join(), /moved\s+by 1.25 m/);
  assert.ok(await page.getByLabel(/^moved: 1 object/).isVisible());
  await page.keyboard.press('o');
  await until(async () => (await boxLines(page)) === 2 * 2 * 12, 'two boxes');
  assert.match(await page.textContent('#object dl'), /now at/);
  await page.keyboard.press('Escape');
}

/** One timeline for both runs: a cursor, a camera and an image of each, and their errors in one plot. */
async function checkTimeline(page, open, shoot) {
  const moment = () => page.textContent('#momentText');
  const rows = () => page.locator('#tracks div').allTextContents();
  const cameras = () => page.evaluate(() => window.kinloop.world.cameras.map(({ pose }) => pose?.elements.slice(12, 15)));
  assert.ok(await page.isVisible('#timeline'));
  assert.equal(await page.inputValue('#plotted'), 'errorM', 'both have ground truth');
  await page.locator('#bar').focus();
  await page.keyboard.press('Home');
  assert.match(await moment(), /^0\.00 s · .* apart$/);
  assert.match((await rows()).join(' | '), /^before: frame 1 of \d+ · tracked.* \| after: frame 1 of \d+ · tracked/);
  assert.match(await page.getAttribute('#bar', 'aria-valuetext'), /^0\.00 s.*; before: frame 1 of .*; after: frame 1 of /);
  const first = await cameras();
  await page.keyboard.press('ArrowRight');
  assert.match((await rows()).join(' | '), /before: frame 2 of .* after: frame 2 of /, 'they share a clock');
  for (let i = 0; i < 30; ++i) await page.keyboard.press('ArrowRight');
  const later = await cameras();
  later.forEach((camera, side) => assert.notDeepEqual(camera, first[side], `camera ${side} moves`));
  assert.match((await rows()).join(' | '), /error \d+\.\d mm.* \| .*error \d+\.\d mm/);
  const [apart, unit] = (await moment()).match(/([\d.]+) (mm|cm|m) apart/).slice(1);
  const wantedM = Math.hypot(...later[0].map((x, axis) => x - later[1][axis]));
  assert.ok(Math.abs(Number(apart) * { mm: 1e-3, cm: 1e-2, m: 1 }[unit] - wantedM) < 1e-3 + 0.01 * wantedM, await moment());
  await page.keyboard.press('Shift+ArrowRight');
  assert.match((await rows()).join(' | '), /keyframe \d+/, 'the next keyframe of either');
  for (const image of ['#colorImage', '#otherImage']) await until(async () => (await paintedPixels(page, image)) > 5000, image);
  assert.match(await page.textContent('#colorImage + figcaption'), /^keyframe \d+ of before/);
  assert.match(await page.textContent('#otherImage + figcaption'), /^keyframe \d+ of after/);
  await until(() => page.evaluate(() => window.kinloop.world.cameras.length === 2 && window.kinloop.world.cameras.every(({ picture }) => picture.visible)), 'they are in the frusta, too');

  // By pointer, and a link to the moment.
  const { x, y, width, height } = await page.locator('#bar').boundingBox();
  await page.mouse.click(x + width / 2, y + height / 2);
  await until(() => page.url().includes('#t='), 'the address is a link to the moment');
  await page.waitForTimeout(600); // it is changed twice a second
  const linked = await open(page.url());
  await until(async () => (await linked.textContent('#momentText')) === (await moment()), 'a link opens at its moment');
  await linked.close();

  // A keyframe of the second run moves both cameras to its moment.
  await page.evaluate(() => window.kinloop.panel.picked.showKeyframe(window.kinloop.world.poses.count - 1));
  assert.match((await rows())[1], /keyframe \d+$/);
  await page.keyboard.press('1');
  await page.waitForTimeout(1500);
  await shoot(page, 'compare-timeline-light');
}

/** Runs whose clocks have nothing in common start together, and the shorter one ends. */
async function checkOtherClock(page) {
  const [before, after, ended, back] = await page.evaluate(() => {
    const { timeline, world } = window.kinloop;
    const [run] = timeline.runs;
    const later = { ...run, stampS: run.stampS.map((stampS) => 1e6 + 2 * stampS) };
    timeline.take(later, 1);
    timeline.jump(20);
    const frames = timeline.tracks.map(({ frame }) => frame);
    timeline.jumpToEnd();
    return [...frames, !timeline.tracks[0].frame && !world.cameras[0].pose, timeline.tracks[1].frame === run.count - 1];
  });
  assert.ok(before >= 2 * after - 1 && after > 5, `${before} and ${after}`);
  assert.ok(ended && back);
  assert.match((await page.locator('#tracks div').allTextContents())[0], /before: no frame/);
}

async function checkPhone(page, shoot) {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.click('#row [data-opens=comparison]');
  await page.locator('#objectList [role=option]').first().click();
  const [card, panel, row] = await Promise.all(['#object', '#panel', '#row'].map((part) => page.locator(part).boundingBox()));
  assert.ok(card.x >= 0 && card.x + card.width <= 390, 'it is as wide as the phone');
  assert.ok(card.y + card.height <= panel.y && panel.y + panel.height <= row.y + 1, 'nothing overlaps');
  assert.ok(row.x >= 0 && row.x + row.width <= 390, 'all buttons fit');
  await shoot(page, 'compare-phone');
}

/** Error arrows, magnified, of a run with ground truth. */
async function checkErrors(page, shoot) {
  const box = page.getByLabel(/^errors/);
  await until(() => box.isVisible(), 'the checkbox is offered');
  assert.equal(await box.isChecked(), false, 'not at first');
  assert.equal(await page.evaluate(() => window.kinloop.world.layers.errors.visible), false);
  const factor = Number((await page.textContent('#errorFactor')).match(/^×(\d+)$/)[1]);
  assert.ok(factor >= 2, `millimetres are magnified: ${factor}`);
  await box.focus();
  await page.keyboard.press(' ');
  assert.equal(await page.evaluate(() => window.kinloop.world.layers.errors.visible), true, 'the space bar shows them');
  const { arrows, ate, longest, keyframes } = await page.evaluate(() => {
    const { world, panel } = window.kinloop;
    const { array } = world.lines.errors.object.geometry.attributes.position;
    const count = world.lines.errors.object.geometry.drawRange.count / 6; // a line and two strokes of the head
    const lengths = Array.from({ length: count }, (_, i) => Math.hypot(...[0, 1, 2].map((axis) => array[18 * i + 3 + axis] - array[18 * i + axis])));
    return { arrows: count, ate: panel.state.status.ateM, longest: Math.max(...lengths), keyframes: world.poses.count };
  });
  assert.equal(arrows, keyframes, 'one for each keyframe');
  assert.ok(longest > 0.5 * factor * ate && longest < 10 * factor * ate, `${longest} m of ${ate} m`);
  await page.keyboard.press('2');
  await page.uncheck('[data-layer=cloud]');
  await page.waitForTimeout(1500);
  await shoot(page, 'errors-light');
}

await withBrowser(async ({ open, kinloop, folder, shoot }) => {
  const [before, after] = ['before', 'after'].map((name) => join(folder, name));
  assert.equal(await kinloop('run', ROOM, '-q', '-o', before, ...SMALL, '--set', 'sim.spacious=true').ended, 0);
  assert.equal(await kinloop('run', ROOM, '-q', '-o', after, ...SMALL, '--set', 'sim.movers.chairs=2').ended, 0);

  const page = await open(await kinloop('view', before, '--compare', after, '--port', '0').url());
  await until(async () => (await seen(page)).points > 10_000, 'the clouds are there');
  await until(() => page.evaluate(() => window.kinloop.world.pictures.count > 20), 'the images are there');
  assert.equal(await page.textContent('#input'), 'before → after');
  await checkLayers(page);
  await checkSelection(page);
  await checkKeys(page);
  await checkTimeline(page, open, shoot);
  await page.keyboard.press('o');
  await page.waitForTimeout(1500); // until it has arrived
  await shoot(page, 'compare-light');
  const found = await findings(page, 'comparison');
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.waitForTimeout(1000);
  await shoot(page, 'compare-dark');
  await checkPhone(page, shoot);
  await checkMoved(page);
  await checkOtherClock(page);
  assert.deepEqual(found, []);
  await page.close();

  const own = await open(await kinloop('view', before, '--port', '0').url());
  await until(async () => (await seen(own)).points > 10_000, 'the cloud is there');
  assert.equal(await own.isVisible('#comparison'), false);
  await checkErrors(own, shoot);
  await own.close();

  // A run without ground truth has no errors to show; maps of two places cannot be compared.
  const map = await open(await kinloop('view', join(before, 'map.kinmap'), '--port', '0').url());
  await until(async () => (await seen(map)).points > 10_000, 'the cloud is there');
  assert.equal(await map.getByLabel(/^errors/).isVisible(), false);
  await map.close();
});
