// How the viewer's page copes with a large cloud or mesh (bench/viewer_building.mjs makes them): bytes and time until the
// first picture over a slow connection, then the frame rate while the view is rotated, as it comes and with everything
// drawn in every frame, and the time until everything is drawn once the view rests. Chromium renders in software here
// unless the machine has a GPU (--gpu).
//
//   node bench/viewer_page.mjs MAP.ply [--kinloop PROGRAM] [--gpu] [--mbit 8] [--slow-only] [--skip-all]
//
// --slow-only: only the slow connection; --skip-all: without the frames with everything, which may take minutes

import { execSync, spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { fileURLToPath } from 'node:url';

const args = process.argv.slice(2);
const option = (name, fallback) => (args.includes(name) ? args.splice(args.indexOf(name), 2)[1] : fallback);
const flag = (name) => args.includes(name) && args.splice(args.indexOf(name), 1).length > 0;
const program = option('--kinloop', 'build/release/apps/kinloop');
const mbitPerS = Number(option('--mbit', 8));
const gpu = flag('--gpu');
const slowOnly = flag('--slow-only');
const skipAll = flag('--skip-all');
const [map] = args;
const BROWSER_TIMEOUT_MS = 600_000;
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** A server that forwards to `port`, and answers no faster than so many Mbit/s. */
function slowServer(port, mbit) {
  const TICK_MS = 10;
  const most = (mbit * 1e6 * TICK_MS) / 8000; // bytes per tick, of all connections
  let left = most;
  setInterval(() => (left = most), TICK_MS).unref();
  return createServer(async (browser) => {
    const kinloop = connect(port, '127.0.0.1');
    browser.pipe(kinloop);
    [browser, kinloop].forEach((socket) => socket.on('error', () => [browser, kinloop].forEach((end) => end.destroy())));
    const forward = async (data) => {
      for (let at = 0; at < data.length; ) {
        while (left < 1) await pause(1);
        const part = data.subarray(at, at + Math.ceil(left));
        left -= part.length;
        at += part.length;
        browser.write(part);
      }
    };
    try {
      for await (const data of kinloop) await forward(data);
    } catch (error) {
      if (!browser.destroyed) throw error; // else the page has been closed
    }
    browser.end();
  }).listen(0);
}

/** Notes when something of the map was drawn for the first time, and what had come until then. */
function watchForPicture() {
  const look = () => {
    const { world, view } = window.kinloop ?? {};
    if (!world || !(world.has('cloud') || world.has('mesh')) || view.dirty || world.moved) return requestAnimationFrame(look);
    const bytes = performance.getEntriesByType('navigation')[0].transferSize + window.kinloop.connection.bytes;
    const context = view.renderer.getContext();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4)); // waits until it is drawn
    window.firstPicture = { bytes, ms: performance.now() };
    return undefined;
  };
  requestAnimationFrame(look);
}

async function openPage(browser, url) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.setDefaultTimeout(BROWSER_TIMEOUT_MS);
  await page.addInitScript(watchForPicture);
  await page.goto(url);
  return page;
}

async function firstPicture(browser, url) {
  const slow = slowServer(Number(new URL(url).port), mbitPerS);
  const page = await openPage(browser, Object.assign(new URL(url), { port: slow.address().port }).href);
  const { bytes, ms } = await (await page.waitForFunction(() => window.firstPicture)).jsonValue();
  await page.close();
  slow.close();
  console.log(`first picture at ${mbitPerS} Mbit/s: ${(ms / 1000).toFixed(2)} s, ${(bytes / 1e6).toFixed(2)} MB`);
}

/** CPU seconds of Chromium's GPU process, the measure least affected by other programs. */
function drawingCpuS(pid) {
  const TICKS_PER_SECOND = 100;
  const [user, system] = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ').slice(11, 13).map(Number);
  return (user + system) / TICKS_PER_SECOND;
}

/** Waits until everything has come; returns the number of points and of triangles. */
async function loaded(page) {
  const contents = () =>
    page.evaluate(() => {
      const { world, connection } = window.kinloop;
      const triangles = world.models.reduce((most, model) => Math.max(most, (model.geometry?.index?.count ?? 0) / 3), 0);
      return { points: world.pointCount, triangles, bytes: connection.bytes };
    });
  for (let before = { bytes: -1 }; ; ) {
    const now = await contents();
    if (now.bytes === before.bytes && now.points + now.triangles > 0) return now;
    before = now;
    await pause(2000);
  }
}

/** Drags for some seconds; returns the frame rate and the share of points drawn. */
async function drag(page, pid, thinned) {
  const SECONDS = 30; // the first frame of a large mesh may take ten
  await page.evaluate((adapts) => {
    const { view } = window.kinloop;
    view.adapt = adapts ? Object.getPrototypeOf(view).adapt : () => Object.assign(view, { share: 1, shadesMoving: true });
    window.drawn = [];
    const { draw } = Object.getPrototypeOf(view);
    view.draw = function (...range) {
      draw.apply(view, range);
      window.drawn.push({ ms: performance.now(), share: view.share });
    };
  }, thinned);
  await page.mouse.move(400, 400);
  await page.mouse.down();
  const before = { cpuS: drawingCpuS(pid), frames: await page.evaluate(() => window.drawn.length) };
  const end = Date.now() + 1000 * SECONDS;
  for (let i = 0; Date.now() < end; ++i) {
    await page.mouse.move(400 + 200 * Math.sin(i / 40), 400);
    await pause(8);
  }
  const cpuS = drawingCpuS(pid) - before.cpuS;
  const pace = await page.evaluate(() => {
    const later = window.drawn.slice(Math.floor(window.drawn.length / 2)); // once adaptation has settled
    const seconds = later.length > 1 ? (later.at(-1).ms - later[0].ms) / 1000 : Infinity;
    return { frames: window.drawn.length, framesPerSecond: (later.length - 1) / seconds, share: later.reduce((sum, { share }) => sum + share, 0) / later.length };
  });
  await page.mouse.up();
  return { ...pace, cpuMs: (1000 * cpuS) / (pace.frames - before.frames) };
}

/** Seconds until everything is drawn once the view rests, and CPU seconds of it. */
async function rest(page, pid) {
  const began = { ms: Date.now(), cpuS: drawingCpuS(pid) };
  await page.waitForFunction(() => !window.kinloop.view.unfinished && !window.kinloop.view.dirty);
  await page.evaluate(() => {
    const context = window.kinloop.view.renderer.getContext();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
  });
  return { seconds: (Date.now() - began.ms) / 1000, cpuS: drawingCpuS(pid) - began.cpuS };
}

async function frameRates(browser, url) {
  const page = await openPage(browser, url);
  const pid = execSync('pgrep -n -f [t]ype=gpu-process').toString().trim();
  const start = Date.now();
  const { points, triangles, bytes } = await loaded(page);
  console.log(`${points} points, ${triangles} triangles, ${(bytes / 1e6).toFixed(1)} MB, all there after at most ${((Date.now() - start) / 1000).toFixed(1)} s`);
  for (const thinned of skipAll ? [true] : [true, false]) {
    const { framesPerSecond, share, cpuMs } = await drag(page, pid, thinned);
    const drawn = `${framesPerSecond.toFixed(1)} frames a second, ${(100 * share).toFixed(2)} % of the points, ${cpuMs.toFixed(0)} ms of CPU a frame`;
    console.log(`${thinned ? 'as it comes' : 'everything '}  ${drawn}`);
    if (!thinned) continue;
    const { seconds, cpuS } = await rest(page, pid);
    console.log(`at rest      everything is drawn after ${seconds.toFixed(1)} s, ${cpuS.toFixed(1)} s of CPU`);
  }
  await page.close();
}

const started = Date.now();
const kinloop = spawn(program, ['view', map, '--port', '0'], { stdio: ['ignore', 'ignore', 'pipe'] });
const url = await new Promise((resolve) => kinloop.stderr.on('data', (data) => String(data).includes('http') && resolve(String(data).match(/http:\S+\//)[0])));
const library = fileURLToPath(new URL('../viewer/pages/node_modules/playwright-core/index.mjs', import.meta.url));
const { chromium } = await import(library);
const software = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', ...(gpu ? [] : software)] });
try {
  console.log(`${map}: served after ${((Date.now() - started) / 1000).toFixed(1)} s`);
  await firstPicture(browser, url);
  if (!slowOnly) await frameRates(browser, url);
} finally {
  await browser.close();
  kinloop.kill();
}
