// kinloop view and the report of a run in a simulated room.

import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { withBrowser, paintedPixels, seen, until } from './harness.mjs';

const FAST = ['--set', 'sim.fps=10', '--set', 'sim.width=320', '--set', 'sim.height=240'];
const MOST_BYTES = 5e6;
const LONG_RUN = 150_000; // frames: more than a function takes as arguments

/** The folder of a run with so many frames, of which every thousandth is lost and another doubtful. */
function writeLongRun(folder) {
  mkdirSync(folder);
  const frames = Array.from({ length: LONG_RUN }, (_, i) => i);
  const write = (name, line) => writeFileSync(join(folder, name), frames.map(line).join('\n'));
  const place = (i, error) => `${i / 30} ${Math.cos(i / 1500) + error} 0 ${Math.sin(i / 1500)} 0 0 0 1`;
  write('trajectory.txt', (i) => place(i, 0.01 * Math.sin(i)));
  write('groundtruth.txt', (i) => place(i, 0));
  const status = (i) => ({ 499: 'doubtful', 999: 'lost' })[i % 1000] ?? 'tracked';
  write('frames.txt', (i) => `${i / 30} ${status(i)} ${900 + (i % 100)} 500 ${10 + (i % 13)}`);
  const quality = { verdict: 'doubtful', reasons: ['5.0 s are in doubt', '5.0 s are lost'] };
  writeFileSync(join(folder, 'run.json'), JSON.stringify({ frames: LONG_RUN, tracked: LONG_RUN, quality }));
}

const TRIANGLE = `ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 1
1 0 1
1 1 1
3 0 1 2
`;

/** Background, first view, shading, and layers that are shown together. */
async function checkLook(page, shoot) {
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  await page.emulateMedia({ colorScheme: 'dark' });
  await until(async () => (await theme()) === 'dark', 'as the system prefers');
  await shoot(page, 'view-dark');
  await page.emulateMedia({ colorScheme: 'light' });
  await until(async () => (await theme()) === 'light', 'it follows the system');
  await page.selectOption('#theme', 'dark');
  await page.reload();
  assert.equal(await theme(), 'dark', 'the browser remembers it');
  await page.selectOption('#theme', 'light');
  await until(async () => (await seen(page)).points > 10_000, 'the cloud is there again');

  const isInside = () => page.evaluate(() => window.kinloop.view.box.containsPoint(window.kinloop.view.cameraControls.camera.position));
  await until(isInside, 'the first view is inside the room');
  await page.keyboard.press('1');
  await until(async () => !(await isInside()), 'the oblique view is outside');
  await page.keyboard.press('r');
  await until(isInside, 'a reset restores the first view');

  const shaded = () => page.evaluate(() => window.kinloop.view.shaded);
  await until(shaded, 'what rests is shaded');
  await page.keyboard.press('e');
  await until(async () => !(await shaded()), 'shading can be switched off');
  await page.keyboard.press('e');
  const shown = (layer) => page.evaluate((name) => window.kinloop.world.layers[name].visible, layer);
  assert.ok((await shown('cloud')) && (await shown('mesh')), 'mesh and cloud together');
  await page.uncheck('[data-layer=cloud]');
  assert.ok(!(await shown('cloud')) && (await shown('mesh')), 'or separately');
  await page.check('[data-layer=cloud]');
  await until(() => page.isVisible('[data-layer=images]'), 'they arrive again');
  await page.check('[data-layer=images]');
  await until(() => page.evaluate(() => window.kinloop.world.layers.images.children.filter(({ visible }) => visible).length > 10), 'they stand in the scene');
  await shoot(page, 'view-images');
  await page.uncheck('[data-layer=images]');
}

/** After slow frames fewer points are drawn, and larger pixels; what rests is drawn as a whole. */
async function checkSlowFrames(page) {
  const moving = await page.evaluate(() => {
    const { view } = window.kinloop;
    for (let i = 0; i < 20; ++i) {
      view.turned = true;
      view.adapt(500);
    }
    view.draw();
    const { width, clientWidth } = view.renderer.domElement;
    return { share: view.share, width, clientWidth };
  });
  assert.ok(moving.share < 1, 'fewer points');
  assert.ok(moving.width < 0.5 * moving.clientWidth, 'larger pixels');
  await until(() => page.evaluate(() => window.kinloop.view.resolution === 1), 'the pixels are small again');
  assert.ok((await paintedPixels(page, '#scene')) > 5000, 'the picture is there while the rest is drawn');
  const rests = () => {
    const { view } = window.kinloop;
    const { width, clientWidth } = view.renderer.domElement;
    return !view.unfinished && width >= clientWidth;
  };
  await until(() => page.evaluate(rests), 'what rests is drawn as a whole');
}

/** A click on a keyframe shows it, with its loops, and moves the timeline there. */
async function checkPicks(page, shoot) {
  await page.keyboard.press('2');
  await until(() => page.evaluate(() => !window.kinloop.view.cameraControls.goal), 'the view from above');
  const [keyframe, x, y] = await page.evaluate(() => {
    const { world, view } = window.kinloop;
    const keyframe = world.loops[0];
    const { clientWidth, clientHeight } = view.renderer.domElement;
    const place = view.keyframePlaces()[keyframe].project(view.cameraControls.camera);
    return [keyframe, ((place.x + 1) / 2) * clientWidth, ((1 - place.y) / 2) * clientHeight];
  });
  await page.mouse.click(x, y);
  const picked = await page.textContent('#picked');
  const number = Number(picked.match(/keyframe (\d+)/)[1]);
  assert.ok(Math.abs(number - keyframe) <= 2, `${picked}: the keyframe at the pointer, or one beside it`);
  assert.match(picked, /stamp[\d.]+ s/);
  await until(async () => (await paintedPixels(page, '#picked canvas')) > 5000, 'its image');
  assert.ok((await page.textContent('#momentText')).endsWith(`keyframe ${number}`), 'the timeline follows');
  await page.evaluate((loop) => window.kinloop.panel.picked.showKeyframe(loop), keyframe);
  assert.match(await page.textContent('#picked'), /loops with\d+/);
  await shoot(page, 'view-picked');
}

/** Replay by keys and pointer, and the link to a moment. */
async function checkTimeline(page, open, shoot) {
  const moment = () => page.textContent('#momentText');
  const camera = async () => (await seen(page)).camera;
  const count = await page.evaluate(() => window.kinloop.timeline.tracks[0].frames.count);
  await page.locator('#bar').focus();
  await page.keyboard.press('End');
  assert.match(await moment(), new RegExp(`frame ${count} of ${count}`));
  assert.match(await page.getAttribute('#bar', 'aria-valuetext'), new RegExp(`frame ${count} of ${count}`));
  const last = await camera();
  await page.keyboard.press('ArrowLeft');
  assert.match(await moment(), new RegExp(`frame ${count - 1} of ${count}`));
  await page.keyboard.press('Shift+ArrowLeft');
  assert.match(await moment(), /error \d+\.\d mm .* keyframe \d+/, 'there is ground truth');
  assert.notDeepEqual(await camera(), last, 'the camera moves');
  await until(async () => (await paintedPixels(page, '#colorImage')) > 5000, 'the image of the nearest keyframe');
  await until(() => page.evaluate(() => window.kinloop.world.cameras[0].picture.visible), 'it is in the frustum, too');
  await page.keyboard.press('Home');
  assert.match(await moment(), /frame 1 of/);
  await page.selectOption('#speed', '0.5'); // so that it is not over before it can be paused
  await page.locator('#bar').focus();
  await page.keyboard.press('Space');
  await until(async () => !(await moment()).includes('frame 1 of'), 'it plays');
  await page.keyboard.press('Space');
  assert.equal(await page.textContent('#play'), 'Play', 'it is paused');
  await page.selectOption('#plotted', 'errorM'); // there is ground truth
  await page.selectOption('#plotted', 'sigmaM');
  assert.ok((await page.evaluate(() => window.kinloop.timeline.bar.loops[0].length)) >= 2, 'loops are marked');
  assert.ok((await paintedPixels(page, '#bar')) > 5000, 'it is drawn');

  const { x, y, width, height } = await page.locator('#bar').boundingBox();
  await page.mouse.click(x + width / 2, y + height / 2);
  const middle = await moment();
  const [frame] = middle.match(/\d+ of/);
  assert.ok(Math.abs(parseInt(frame) - count / 2) < 0.05 * count, `${middle}: the pointer seeks`);
  const link = await page.evaluate(() => {
    const [{ frames, frame }] = window.kinloop.timeline.tracks;
    return `#t=${(frames.stampS[frame] - frames.stampS[0]).toFixed(3)}`;
  });
  await until(() => page.url().endsWith(link), 'the address is a link to the moment');
  await shoot(page, 'view-timeline');
  const linked = await open(page.url());
  await until(async () => (await linked.textContent('#momentText')) === middle, 'a link opens at its moment');

  // On a phone a panel opens above it.
  await linked.setViewportSize({ width: 390, height: 844 });
  await linked.click('#row [data-opens=options]');
  const [panel, bar] = [await linked.locator('#panel').boundingBox(), await linked.locator('#timeline').boundingBox()];
  assert.ok(panel.y >= 0 && panel.y + panel.height <= bar.y + 1, 'the panel and the timeline do not overlap');
  await shoot(linked, 'view-phone');
  await linked.close();
}

/** Texts of plots that stick out of their figure, and labels of axes that lie on a number. */
function hiddenTexts(page) {
  return page.evaluate(() =>
    [...document.querySelectorAll('figure svg')].flatMap((plot) => {
      const figure = plot.closest('figure').getBoundingClientRect();
      const texts = [...plot.querySelectorAll('text')].map((text) => ({ text: text.textContent, box: text.getBoundingClientRect() }));
      const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
      const isHidden = ({ text, box }) =>
        box.left < figure.left || box.right > figure.right || (text.endsWith('→') && texts.some((other) => other.text !== text && meet(other.box, box)));
      return texts.filter(isHidden).map(({ text }) => text);
    }),
  );
}

await withBrowser(async ({ open, kinloop, folder, shoot }) => {
  const [out, plain] = [join(folder, 'out'), join(folder, 'no_loop')];
  assert.equal(await kinloop('run', 'sim:room', '-q', '-o', out, ...FAST).ended, 0);
  await kinloop('run', 'sim:room', '-q', '--no-loop', '-o', plain, ...FAST).ended;

  // The report: from disk, without a network, in light and dark mode and on a phone.
  const report = join(out, 'report.html');
  assert.ok(statSync(report).size < MOST_BYTES, `${statSync(report).size} bytes`);
  for (const [name, options] of Object.entries({
    light: { colorScheme: 'light' },
    dark: { colorScheme: 'dark' },
    phone: { viewport: { width: 390, height: 844 } },
  })) {
    const page = await open(pathToFileURL(report).href, options);
    await until(() => paintedPixels(page, 'canvas.cloud').then((painted) => painted > 1000), 'the cloud is drawn');
    const headings = await page.locator('h2').allTextContents();
    assert.deepEqual(headings, ['Map', '3D map', 'Trajectory', 'Absolute trajectory error', 'Loop closures', 'Tracking', 'CPU time per module', 'Configuration']);
    const width = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(width <= 0, `${name}: nothing sticks out at the side, ${width} px`);
    assert.ok((await page.locator('figure svg text').count()) > 20, `${name}: plots have texts`);
    assert.deepEqual(await hiddenTexts(page), [], `${name}: all texts of plots can be read`);
    assert.equal(await page.locator('svg path[d*="NaN"]').count(), 0);
    assert.match(await page.locator('header .verdict').textContent(), /^quality: (good|doubtful|bad)/);
    assert.ok((await page.locator('figure img').count()) >= 3, 'map from two sides, and loops');
    await shoot(page, `report-${name}`, { fullPage: true });
    await page.close();
  }

  // In print: no canvas, at most four loops, four sheets.
  const paper = await open(pathToFileURL(report).href, { viewport: { width: 794, height: 1123 } });
  assert.equal(await paper.locator('h1').textContent(), 'sim:room');
  assert.match(await paper.locator('.loops figcaption').first().textContent(), /cameras [\d.]+ m and [\d.]+\u00b0 apart.*median error [\d.]+ px/);
  await paper.emulateMedia({ media: 'print' });
  assert.equal(await paper.locator('canvas.cloud').isVisible(), false);
  const loops = await paper.locator('.loops figure').evaluateAll((all) => all.filter((one) => one.offsetParent).length);
  assert.ok(loops >= 1 && loops <= 4, `${loops} loops are printed`);
  const sheets = (await paper.pdf({ format: 'A4' })).toString('latin1').match(/\/Type\s*\/Page\b/g).length;
  assert.ok(sheets <= 4, `${sheets} sheets`);
  await shoot(paper, 'report-print', { fullPage: true });
  await paper.close();

  // Two runs and a trajectory of another system, compared.
  const comparison = join(folder, 'comparison.html');
  assert.equal(await kinloop('report', out, plain, join(plain, 'trajectory.txt'), '-o', comparison).ended, 0);
  assert.ok(readFileSync(comparison).length < MOST_BYTES);
  const side = await open(pathToFileURL(comparison).href);
  const columns = await side.locator('.table').first().locator('tr').first().locator('th').allTextContents();
  assert.deepEqual(columns, ['', 'out', 'no_loop', 'trajectory.txt']);
  await shoot(side, 'comparison', { fullPage: true });

  // A run of more than an hour: every section is there, and no plot has many more points than pixels. A section that
  // fails leaves the others.
  const [long, longReport] = [join(folder, 'long'), join(folder, 'long.html')];
  writeLongRun(long);
  assert.equal(await kinloop('report', long, '-o', longReport).ended, 0);
  const hours = await open(pathToFileURL(longReport).href);
  assert.deepEqual(await hours.locator('h2').allTextContents(), ['Trajectory', 'Absolute trajectory error', 'Tracking']);
  assert.ok((await hours.locator('figcaption').allTextContents()).some((text) => text.includes('lost (150 frames)')), 'lost frames are counted');
  assert.ok((await hours.locator('figcaption').allTextContents()).some((text) => text.includes('doubtful (150 frames)')), 'so are doubtful ones');
  assert.equal(await hours.locator('header .verdict').textContent(), 'quality: doubtful 5.0 s are in doubt; 5.0 s are lost');
  assert.equal(await hours.locator('svg g[fill-opacity="0.3"] rect').count(), 3 * 300, 'all are shaded on every plot over time');
  const drawn = await hours.locator('svg').evaluateAll((plots) => plots.reduce((sum, plot) => sum + plot.outerHTML.length, 0));
  assert.ok(drawn < MOST_BYTES, `${drawn} bytes of plots`);
  await hours.close();
  writeFileSync(longReport, readFileSync(longReport, 'utf8').replace('"frames":{', '"unknown":{'));
  const partial = await open(pathToFileURL(longReport).href);
  assert.deepEqual(await partial.locator('h2').allTextContents(), ['Trajectory', 'Absolute trajectory error']);
  assert.equal(await partial.getByText('A section cannot be shown').count(), 1);
  await partial.close();

  // kinloop view DIR with a mesh in it, a map file, and a single cloud.
  writeFileSync(join(out, 'mesh.ply'), TRIANGLE);
  const [map, cloud] = [join(out, 'map.kinmap'), join(out, 'map.ply')];
  for (const what of [out, map, cloud]) {
    const page = await open(await kinloop('view', what, '--port', '0').url());
    await until(async () => (await seen(page)).points > 10_000, 'the saved cloud is there');
    await until(() => paintedPixels(page, '#scene').then((painted) => painted > 20_000), 'and drawn');
    if (what !== cloud) {
      assert.ok((await seen(page)).path > 150);
      assert.ok((await seen(page)).loops > 0);
    }
    if (what === out) assert.ok((await seen(page)).truth > 150);
    assert.equal(await page.title(), `${{ [out]: 'sim:room', [map]: 'map.kinmap', [cloud]: 'map.ply' }[what]} - kinloop`);
    assert.equal((await seen(page)).cutAtM, Infinity, 'nothing is cut off');
    assert.equal((await seen(page)).cut, 'off');
    assert.equal(await page.locator('#color option[value=time]:disabled').count(), 1, 'a cloud has no times');
    assert.equal(await page.locator('#run').isVisible(), false, 'there is no run to pause');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#screenshot')]);
    assert.equal(download.suggestedFilename(), 'kinloop.png');
    await page.waitForTimeout(500);
    if (what !== cloud) await until(() => page.isVisible('[data-layer=images]'), 'the images of keyframes arrive');
    const layers = await page.locator('[data-layer]:visible').evaluateAll((all) => all.map(({ dataset }) => dataset.layer));
    const ofRun = ['path', 'keyframes', 'images', 'truth', 'errors', 'loops'];
    assert.deepEqual(layers, { [out]: ['cloud', 'mesh', ...ofRun], [map]: ['cloud', ...ofRun.filter((layer) => layer !== 'truth' && layer !== 'errors')], [cloud]: ['cloud'] }[what], 'only what applies');
    assert.equal(await page.isVisible('#timeline'), what !== cloud, 'what has frames has a timeline');
    if (what === out) await checkLook(page, shoot);
    if (what === out) await checkTimeline(page, open, shoot);
    if (what === out) await checkSlowFrames(page);
    if (what === out) await checkPicks(page, shoot);
    await shoot(page, { [out]: 'view-folder', [map]: 'view-map', [cloud]: 'view-cloud' }[what]);

    // Another run takes the place of this one: the renderer keeps nothing of it.
    const released = await page.evaluate(() => {
      const { world, view } = window.kinloop;
      const before = view.renderer.info.memory.geometries;
      world.clear();
      return before - view.renderer.info.memory.geometries;
    });
    assert.ok(released > 0, 'pieces are released');
  }
});
