// Frame rate of the viewer's page while a cloud is rotated: with adaptive thinning, and with all points.
// Chromium renders in software here unless the machine has a GPU (--gpu).
//
//   node bench/viewer_page.mjs MAP.ply [--kinloop PROGRAM] [--gpu]
//   node bench/viewer_page.mjs --make 2000000 MAP.ply       writes a room of that many points first

import { execSync, spawn } from 'node:child_process';
import { createWriteStream, readFileSync } from 'node:fs';
import { once } from 'node:events';
import { fileURLToPath } from 'node:url';

const args = process.argv.slice(2);
const option = (name, fallback) => (args.includes(name) ? args.splice(args.indexOf(name), 2)[1] : fallback);
const program = option('--kinloop', 'build/release/apps/kinloop');
const make = Number(option('--make', 0));
const gpu = args.includes('--gpu') && args.splice(args.indexOf('--gpu'), 1);
const [map] = args;

/** A room of 6 x 5 x 2.6 m: points on its walls and its floor. */
async function writeRoom(path, count) {
  const file = createWriteStream(path);
  const properties = ['float x', 'float y', 'float z', 'uchar red', 'uchar green', 'uchar blue'];
  file.write(`ply\nformat binary_little_endian 1.0\ncomment kinloop\nelement vertex ${count}\n${properties.map((p) => `property ${p}\n`).join('')}end_header\n`);
  const bytes = Buffer.alloc(15 * count);
  const size = [6, 2.6, 5];
  for (let i = 0; i < count; ++i) {
    const place = size.map((s) => (Math.random() - 0.5) * s);
    const side = Math.floor(5 * Math.random());
    if (side === 4) place[1] = size[1] / 2;
    else place[side < 2 ? 0 : 2] = (side % 2 ? 0.5 : -0.5) * size[side < 2 ? 0 : 2];
    place.forEach((x, k) => bytes.writeFloatLE(x, 15 * i + 4 * k));
    place.forEach((x, k) => bytes.writeUInt8(128 + Math.round((120 * x) / size[k]), 15 * i + 12 + k));
  }
  file.end(bytes);
  await once(file, 'finish');
}

/** CPU seconds of Chromium's GPU process, the measure least affected by other programs. */
function drawingCpuS() {
  const TICKS_PER_SECOND = 100;
  const pid = execSync('pgrep -n -f [t]ype=gpu-process').toString().trim();
  const [user, system] = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ').slice(11, 13).map(Number);
  return (user + system) / TICKS_PER_SECOND;
}

/** Drags for some seconds; returns the frame rate and the share of points drawn. */
async function drag(page, thinned) {
  const SECONDS = 8;
  await page.evaluate((on) => {
    const { view } = window.kinloop;
    view.adapt = on ? Object.getPrototypeOf(view).adapt : () => (view.share = 1);
    window.drawn = [];
    const draw = Object.getPrototypeOf(view).draw;
    view.draw = function () {
      draw.call(view);
      window.drawn.push({ ms: performance.now(), share: view.share });
    };
  }, thinned);
  await page.mouse.move(400, 400);
  await page.mouse.down();
  const before = { cpuS: drawingCpuS(), frames: await page.evaluate(() => window.drawn.length) };
  const end = Date.now() + 1000 * SECONDS;
  for (let i = 0; Date.now() < end; ++i) {
    await page.mouse.move(400 + 200 * Math.sin(i / 40), 400);
    await page.waitForTimeout(8);
  }
  await page.mouse.up();
  const cpuS = drawingCpuS() - before.cpuS;
  const frames = (await page.evaluate(() => window.drawn.length)) - before.frames;
  const pace = await page.evaluate(() => {
    const later = window.drawn.slice(Math.floor(window.drawn.length / 2)); // once adaptation has settled
    const seconds = (later.at(-1).ms - later[0].ms) / 1000;
    return { framesPerSecond: (later.length - 1) / seconds, share: later.reduce((sum, { share }) => sum + share, 0) / later.length };
  });
  return { ...pace, cpuMs: (1000 * cpuS) / frames };
}

if (make) await writeRoom(map, make);
const kinloop = spawn(program, ['view', map, '--port', '0'], { stdio: ['ignore', 'ignore', 'pipe'] });
const url = await new Promise((resolve) => kinloop.stderr.on('data', (data) => resolve(String(data).match(/http:\S+\//)[0])));
const library = fileURLToPath(new URL('../viewer/pages/node_modules/playwright-core/index.mjs', import.meta.url));
const { chromium } = await import(library);
const software = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', ...(gpu ? [] : software)] });
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const start = Date.now();
await page.goto(url);
let points = 0;
for (let before = -1; points !== before || points === 0; ) {
  before = points;
  await page.waitForTimeout(1000);
  points = await page.evaluate(() => window.kinloop.world.pointCount);
}
const bytes = await page.evaluate(() => window.kinloop.connection.bytes);
console.log(`${points} points, ${(bytes / 1e6).toFixed(1)} MB, all there after at most ${((Date.now() - start) / 1000).toFixed(1)} s`);
for (const thinned of [true, false]) {
  const { framesPerSecond, share, cpuMs } = await drag(page, thinned);
  console.log(`${thinned ? 'as it comes' : 'all points '}  ${framesPerSecond.toFixed(1)} frames a second, ${Math.round(100 * share)} % of the points, ${cpuMs.toFixed(0)} ms of CPU a frame`);
}
await browser.close();
kinloop.kill();
