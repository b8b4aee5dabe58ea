// kinloop view of files from other programs, and what the page offers for them: framing, cut, colours, keys,
// phones.

import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { withBrowser, paintedPixels, seen, until } from './harness.mjs';

const ROOM_M = [4, 3, 2.5];

/** A box of points with z up and some outliers, as ascii PLY with doubles; `comment`: a line of its header. */
function cloudWithOutliers(comment = 'comment of another program') {
  const points = [];
  for (let i = 0; i < 20_000; ++i) {
    const place = ROOM_M.map((size, k) => size * ((i * [0.7548776662, 0.5698402909, 0.3819660113][k]) % 1));
    place[i % 3] = i % 2 ? 0 : ROOM_M[i % 3];
    points.push(i % 200 === 0 ? place.map((x) => 1000 * (x - 1)) : place);
  }
  const properties = ['x', 'y', 'z'].map((name) => `property double ${name}\n`).join('');
  const lines = points.map((point) => point.join(' ')).join('\n');
  return `ply\nformat ascii 1.0\n${comment}\nelement vertex ${points.length}\n${properties}end_header\n${lines}\n`;
}

const MESH = `ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 2
property list uchar int vertex_indices
end_header
0 0 0 255 0 0
1 0 0 0 255 0
1 0 1 0 0 255
0 0 1 255 255 0
3 0 1 2
3 0 2 3
`;

const PCD = `VERSION .7
FIELDS x y z
SIZE 4 4 4
TYPE F F F
WIDTH 1000
HEIGHT 1
DATA ascii
${Array.from({ length: 1000 }, (_, i) => `${i % 10} ${Math.floor(i / 10) % 10} ${Math.floor(i / 100)}`).join('\n')}
`;

/** A GLB file of one triangle that is followed by so many unused bytes. */
function largeGlb(bytes) {
  const file = glb();
  const padding = Buffer.alloc(bytes);
  const binaryAt = file.indexOf('BIN\0') - 4;
  file.writeUInt32LE(file.length + bytes, 8);
  file.writeUInt32LE(file.readUInt32LE(binaryAt) + bytes, binaryAt);
  return Buffer.concat([file, padding]);
}

/** A script that closes the first connection after so many messages, and counts connections. */
const breakAfter = (messages) => `{
  let left = ${messages};
  window.opened = 0;
  window.WebSocket = class extends WebSocket {
    constructor(...args) {
      super(...args);
      window.opened += 1;
    }
    set onmessage(take) {
      super.onmessage = (event) => {
        if (this.readyState !== WebSocket.OPEN) return; // what is on its way when a connection breaks is lost
        take(event);
        if (--left === 0) this.close();
      };
    }
  };
}`;

/** One triangle without colours. */
function glb() {
  const positions = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer);
  let json = JSON.stringify({
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    buffers: [{ byteLength: positions.length }],
    bufferViews: [{ buffer: 0, byteLength: positions.length }],
    accessors: [{ bufferView: 0, componentType: 5126, type: 'VEC3', count: 3, min: [0, 0, 0], max: [1, 1, 0] }],
  });
  json = json.padEnd(Math.ceil(json.length / 4) * 4);
  const words = (...numbers) => Buffer.from(new Uint32Array(numbers).buffer);
  const chunks = [words(json.length, 0x4e4f534a), Buffer.from(json), words(positions.length, 0x004e4942), positions];
  const size = chunks.reduce((sum, chunk) => sum + chunk.length, 12);
  return Buffer.concat([words(0x46546c67, 2, size), ...chunks]);
}

/** The eight corners of the room. */
const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7].map((bits) => ROOM_M.map((s, k) => (bits & (1 << k) ? s : 0)));

/** Screen positions of places in the room, and the size of the screen, px. */
function onScreen(page, places) {
  return page.evaluate((all) => {
    const { world, view } = window.kinloop;
    const { camera } = view.cameraControls;
    const canvas = view.renderer.domElement;
    const projected = all.map((place) => camera.position.clone().fromArray(place).applyMatrix4(world.group.matrixWorld).project(camera));
    const box = canvas.getBoundingClientRect();
    return projected.map(({ x, y }) => [((x + 1) / 2) * box.width, ((1 - y) / 2) * box.height, box.width, box.height]);
  }, places);
}

/** Everything is in view, and large: the corners span most of the width or of the height. */
async function assertFramed(page, name) {
  const corners = await onScreen(page, CORNERS);
  const [, , width, height] = corners[0];
  for (const [x, y] of corners) assert.ok(x > -1 && y > -1 && x < width + 1 && y < height + 1, `${name}: ${x} ${y} of ${width} x ${height}`);
  const span = (axis) => Math.max(...corners.map((c) => c[axis])) - Math.min(...corners.map((c) => c[axis]));
  assert.ok(Math.max(span(0) / width, span(1) / height) > 0.75, `${name}: ${span(0)} x ${span(1)} of ${width} x ${height}`);
}

/** The mean of red, green and blue over the drawn pixels. */
function brightness(page) {
  return page.evaluate(() => {
    const source = document.querySelector('#scene');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [source.width, source.height];
    const paint = copy.getContext('2d');
    paint.drawImage(source, 0, 0);
    const { data } = paint.getImageData(0, 0, copy.width, copy.height);
    let [sum, painted] = [0, 0];
    for (let i = 0; i < data.length; i += 4) {
      if (data[i + 3] < 255) continue; // an outline before the background
      sum += data[i] + data[i + 1] + data[i + 2];
      ++painted;
    }
    return sum / (3 * Math.max(1, painted));
  });
}

const settled = (page) => until(() => page.evaluate(() => !window.kinloop.view.cameraControls.goal && !window.kinloop.view.stale), 'the viewpoint has arrived');

await withBrowser(async ({ open, kinloop, folder, shoot }) => {
  const write = (name, content) => {
    writeFileSync(join(folder, name), content);
    return join(folder, name);
  };
  const view = async (name, content, options) => {
    const url = await kinloop('view', write(name, content), '--port', '0').url();
    const page = await open(url, options);
    await until(() => page.evaluate(() => !window.kinloop.view.box.isEmpty()), `${name} is there`);
    await settled(page);
    return page;
  };

  // A cloud of doubles, without colours and with outliers: framed on a desktop and on a phone.
  const screens = { desktop: { width: 1280, height: 800 }, portrait: { width: 390, height: 844 }, landscape: { width: 844, height: 390 } };
  for (const [name, viewport] of Object.entries(screens)) {
    const page = await view('room.ply', cloudWithOutliers(), { viewport });
    await assertFramed(page, name);
    await shoot(page, `view-strays-${name}`);
    if (name === 'desktop') await checkDesktop(page);
    else await checkPhone(page, name);
    await page.close();
  }

  // A room whose up direction is known: seen from inside at first, and without its ceiling from above.
  const room = await view('known.ply', cloudWithOutliers('comment frame z-up'));
  const heights = () =>
    room.evaluate(() => {
      const { view, world } = window.kinloop;
      const floorM = view.box.min.y;
      return { eyeM: view.cameraControls.camera.position.y - floorM, ceilingM: view.ceilingM - floorM, cutM: world.uniforms.clipHighM.value.y - floorM };
    });
  const inside = await heights();
  assert.ok(Math.abs(inside.eyeM - 1.6) < 0.05, `the eye is ${inside.eyeM} m above the floor`);
  assert.ok(inside.ceilingM > 0.9 * ROOM_M[2] && inside.ceilingM < ROOM_M[2], `a ceiling at ${inside.ceilingM} m`);
  assert.ok(inside.cutM > 1e6, 'the ceiling is seen from inside');
  await shoot(room, 'view-inside');
  await room.keyboard.press('1');
  await until(async () => Math.abs((await heights()).cutM - inside.ceilingM) < 1e-6, 'it is hidden from above');
  await settled(room);
  await shoot(room, 'view-without-ceiling');
  await room.uncheck('#ceiling');
  await until(async () => (await heights()).cutM > 1e6, 'unless the user wants it');
  await room.check('#ceiling');
  await checkMeasures(room, shoot);
  await room.close();

  // Meshes and other formats.
  for (const [name, content, facts, pixels] of [['mesh.ply', MESH, 'triangles', 20_000], ['cloud.pcd', PCD, 'points', 950], ['mesh.glb', glb(), '', 20_000]]) {
    const page = await view(name, content);
    await page.keyboard.press('g'); // its lines would be counted
    await until(async () => (await paintedPixels(page, '#scene')) > pixels, `${name} is drawn`);
    await until(async () => (await brightness(page)) > 60, `${name} is not black`);
    assert.equal(await page.title(), `${name} - kinloop`);
    assert.ok((await seen(page)).facts.includes(facts), `${name}: ${(await seen(page)).facts}`);
    assert.ok(!(await seen(page)).message, (await seen(page)).message);
    await shoot(page, `view-${name}`);
    await page.close();
  }

  // A part of which the connection breaks in the middle is continued, not sent again.
  const largeBytes = 4_000_000;
  const large = kinloop('view', write('large.glb', largeGlb(largeBytes)), '--port', '0');
  const broken = await open('about:blank');
  await broken.addInitScript(breakAfter(20));
  await broken.goto(await large.url());
  await until(() => broken.evaluate(() => !window.kinloop.view.box.isEmpty()), 'the rest arrives');
  const { bytes } = await seen(broken);
  assert.ok(bytes > largeBytes && bytes < 1.02 * largeBytes, `${bytes} bytes`);
  assert.equal(await broken.evaluate(() => window.opened), 2, 'the connection has broken once');
  await broken.close();

  // Damage is reported on the terminal, and nothing is served.
  const bad = kinloop('view', write('bad.glb', glb().subarray(0, 100)), '--port', '0');
  assert.equal(await bad.ended, 3);
  assert.match(bad.text, /bad\.glb: truncated/);

  // The program ends, and the page says so.
  const served = kinloop('view', write('again.ply', MESH), '--port', '0');
  const page = await open(await served.url());
  await until(async () => (await seen(page)).badge === 'saved', 'it is shown');
  served.process.kill('SIGINT');
  await until(async () => (await seen(page)).badge === 'not connected', 'the page notices');
  assert.ok((await seen(page)).message.startsWith('Connection closed: kinloop view has ended'));
});

async function checkDesktop(page) {
  // Nothing is cut, and the slider says so; it shows the height while there is a cut.
  assert.deepEqual([(await seen(page)).cutAtM, (await seen(page)).cut], [Infinity, 'off']);
  const heightM = await page.evaluate(() => window.kinloop.view.box.max.y - window.kinloop.view.box.min.y);
  assert.ok(Math.abs(heightM - ROOM_M[2]) < 0.1, `${heightM} m high, without stray points`);
  assert.equal(await page.inputValue('#cut'), '200', 'the slider is at its end');
  await page.keyboard.press('[');
  await page.keyboard.press('[');
  const { cut, cutAtM } = await seen(page);
  assert.ok(Math.abs(parseFloat(cut) - 0.9 * heightM) < 0.02 && cut.endsWith(' m'), cut);
  assert.ok(Number.isFinite(cutAtM));
  assert.equal(await page.inputValue('#cut'), '180', 'the slider follows');
  await page.keyboard.press('r');
  assert.deepEqual([(await seen(page)).cut, await page.inputValue('#cut')], ['off', '200']);
  await page.locator('#cut').press('ArrowLeft');
  assert.notEqual((await seen(page)).cut, 'off');
  await page.locator('#cut').press('End');
  assert.deepEqual([(await seen(page)).cutAtM, (await seen(page)).cut], [Infinity, 'off']);

  // Colours: a cloud without colours and times can only be coloured by height.
  assert.equal(await page.inputValue('#color'), 'height');
  const possible = () => page.locator('#color option').evaluateAll((options) => options.filter((option) => !option.disabled).map(({ value }) => value));
  assert.deepEqual(await possible(), ['height']);
  await page.keyboard.press('c');
  assert.equal(await page.inputValue('#color'), 'height');

  // The grid, the scale and the views.
  const gridShown = () => page.evaluate(() => window.kinloop.view.floor.object.visible);
  assert.equal(await gridShown(), true);
  await page.keyboard.press('g');
  assert.equal(await gridShown(), false);
  await page.keyboard.press('g');
  const bar = () => page.evaluate(() => [document.querySelector('#scale i').clientWidth, document.querySelector('#scale span').textContent]);
  const [widthPx, length] = await bar();
  assert.ok(widthPx > 40 && widthPx <= 160 && /^\d+ (m|cm)$/.test(length), `${length}: ${widthPx} px`);
  await page.mouse.move(300, 300);
  for (let i = 0; i < 12; ++i) await page.mouse.wheel(0, -400);
  await until(async () => (await bar())[1] !== length, 'the scale follows the zoom');
  for (const key of ['2', '3', '1']) {
    const before = (await seen(page)).eye;
    await page.keyboard.press(key);
    await until(async () => Math.hypot(...(await seen(page)).eye.map((x, i) => x - before[i])) > 0.5, `key ${key} moves the eye`);
    await settled(page);
    await assertFramed(page, `key ${key}`);
  }

  // The table of keys.
  await page.keyboard.press('?');
  assert.ok(await page.isVisible('#helpTable'));
  assert.ok((await page.innerText('#helpTable')).includes('floor grid on or off'));
  await page.keyboard.press('Escape');
  assert.ok(!(await page.isVisible('#helpTable')));
}

/** Points of the room are picked, and its walls measured, by pointer and by keyboard; it is clipped to a box. */
async function checkMeasures(page, shoot) {
  await page.keyboard.press('2');
  await settled(page);
  // A right angle on the floor, seen from above.
  const places = await onScreen(page, [[0.5, 0.5, 0], [3.5, 0.5, 0], [0.5, 2.5, 0]]);
  const click = (i) => page.mouse.click(...places[i].slice(0, 2));
  const measures = () => page.locator('#measures li').allTextContents();
  const lengthM = (text) => parseFloat(text.match(/[\d.]+/)[0]);
  await page.check('[name=tool][value=distance]');
  await click(0);
  await click(1);
  const [width] = await measures();
  assert.match(width, /^distance [\d.]+ m/);
  assert.ok(Math.abs(lengthM(width) - 3) < 0.15, `${width} of 3 m`);
  await page.check('[name=tool][value=angle]');
  for (const corner of [1, 0, 2]) await click(corner);
  const angle = (await measures())[1];
  assert.ok(Math.abs(lengthM(angle) - 90) < 5, angle);
  await until(async () => (await page.locator('.measure').count()) === 2, 'labels stand in the scene');
  await shoot(page, 'view-measures');
  await page.click('#measures button >> nth=0');
  assert.deepEqual(await measures(), [angle], 'one is removed');
  await page.keyboard.press('Delete');
  assert.deepEqual(await measures(), []);

  // By keyboard alone: the point at the centre of the view, from above and from inside.
  await page.locator('#scene').focus();
  await page.keyboard.press('m'); // height
  assert.ok(await page.isChecked('[name=tool][value=height]'));
  await page.keyboard.press('Enter');
  await page.keyboard.press('5');
  await settled(page);
  await page.keyboard.press('Enter');
  const [height] = await measures();
  assert.match(height, /^height [\d.]+ c?m/);
  await page.keyboard.press('Delete');
  await page.keyboard.press('m'); // select
  await page.keyboard.press('Enter');
  assert.match(await page.textContent('#picked'), /point.*x, y, z.*above the floor.*from the viewpoint/s);

  // The box: half of the map is hidden, and cannot be picked.
  await page.click('#measuring summary');
  await page.locator('[data-clip="max x"]').fill('50');
  const isClipped = () =>
    page.evaluate(() => {
      const { view, world } = window.kinloop;
      const middle = (view.box.min.x + view.box.max.x) / 2;
      return Math.abs(world.uniforms.clipHighM.value.x - middle) < 1e-3 && Math.abs(world.clipPlanes[3].constant - middle) < 1e-3;
    });
  await until(isClipped, 'points and meshes are clipped');
  assert.ok(await page.evaluate(() => !window.kinloop.view.isShown(window.kinloop.view.box.max)), 'outside nothing is shown');
  await shoot(page, 'view-clipped');
  await page.click('#unclip');
  assert.ok(await page.evaluate(() => window.kinloop.view.isShown(window.kinloop.view.box.min)), 'the whole map');
}

async function checkPhone(page, name) {
  for (const section of ['#facts', '#options']) assert.ok(!(await page.isVisible(section)), `${name}: ${section} is folded`);
  await page.click('#row [data-opens=options]');
  assert.ok(await page.isVisible('#options'));
  await page.click('#row [data-opens=facts]');
  assert.ok((await page.isVisible('#facts')) && !(await page.isVisible('#options')), 'one at a time');
  await page.click('#row [data-opens=facts]');
  assert.ok(!(await page.isVisible('#facts')));
  assert.ok(!(await page.isVisible('#row [data-opens=images]')), 'there are no images');
  const width = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(width <= 0, `${name}: nothing sticks out at the side, ${width} px`);
}
