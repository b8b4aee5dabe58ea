// Memory of a page that shows a live run for long. A run is shown once, as fast as it goes; then the page gets the same
// messages again and again, faster than a camera would cause them, so that images, poses, the cloud and the mesh are
// replaced as often as in a long run, while the map stays as large. Figures are of the page's JavaScript heap after a
// collection of garbage, of what three.js keeps on the graphics card, and of the browser's processes.
//
//   node bench/viewer_memory.mjs SEQUENCE [--kinloop PROGRAM] [--images 36000]      10 Hz for an hour

import { spawn } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const args = process.argv.slice(2);
const option = (name, fallback) => (args.includes(name) ? args.splice(args.indexOf(name), 2)[1] : fallback);
const program = option('--kinloop', 'build/release/apps/kinloop');
const wantedImages = Number(option('--images', 36_000));
const [sequence] = args;
const REPORTS = 8;
const mib = (bytes) => (bytes / 2 ** 20).toFixed(1);

/** Keeps a copy of every message from here on, in the page. */
function record() {
  const { connection } = window.kinloop;
  const { take } = Object.getPrototypeOf(connection);
  window.recorded = [];
  connection.take = (data) => {
    window.recorded.push(data.slice(0));
    take.call(connection, data);
  };
}

/** Gives the page all recorded messages again, some in each frame; returns the number of images among them. */
async function replay() {
  const MESSAGES = 200; // per frame
  const COLOR_IMAGE = 8;
  const { connection } = window.kinloop;
  const { take } = Object.getPrototypeOf(connection);
  let images = 0;
  for (let i = 0; i < window.recorded.length; ++i) {
    const copy = window.recorded[i].slice(0);
    images += new DataView(copy).getUint32(0, true) === COLOR_IMAGE ? 1 : 0;
    take.call(connection, copy);
    if (i % MESSAGES === 0) await new Promise((resolve) => requestAnimationFrame(resolve));
  }
  return images;
}

/** Resident memory of the browser's processes of a kind. */
function residentBytes(parent, kind) {
  const of = (pid, file) => readFileSync(`/proc/${pid}/${file}`, 'utf8');
  const family = new Set([parent]);
  let most = 0;
  for (const pid of readdirSync('/proc').filter((name) => /^\d+$/.test(name)).map(Number).sort((a, b) => a - b)) {
    try {
      if (!family.has(Number(of(pid, 'stat').split(') ')[1].split(' ')[1]))) continue;
      family.add(pid);
      if (of(pid, 'cmdline').includes(`--type=${kind}`)) most = Math.max(most, 1024 * Number(of(pid, 'status').match(/VmRSS:\s+(\d+)/)[1]));
    } catch {
      // It has ended.
    }
  }
  return most;
}

const folder = mkdtempSync(join(tmpdir(), 'kinloop-memory-'));
const library = fileURLToPath(new URL('../viewer/pages/node_modules/playwright-core/index.mjs', import.meta.url));
const { chromium } = await import(library);
const kinloop = spawn(program, ['run', sequence, '-o', join(folder, 'out'), '-q', '--viewer=0', '--set', 'viewer.paused=true'], { stdio: ['ignore', 'ignore', 'pipe'] });
const url = await new Promise((resolve) => kinloop.stderr.on('data', (data) => String(data).includes('http') && resolve(String(data).match(/http:\S+token=\w+/)[0])));
const server = await chromium.launchServer({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
const browser = await chromium.connect(server.wsEndpoint());

try {
  const page = await browser.newPage({ viewport: { width: 640, height: 480 } });
  page.setDefaultTimeout(1_800_000);
  const devtools = await page.context().newCDPSession(page);
  await devtools.send('Performance.enable');

  const report = async (what) => {
    await page.waitForTimeout(1000); // images are decoded
    await devtools.send('HeapProfiler.collectGarbage');
    const { metrics } = await devtools.send('Performance.getMetrics');
    const { geometries, textures, recorded } = await page.evaluate(() => {
      const { view } = window.kinloop;
      return { ...view.renderer.info.memory, recorded: (window.recorded ?? []).reduce((sum, { byteLength }) => sum + byteLength, 0) };
    });
    const heap = metrics.find(({ name }) => name === 'JSHeapUsedSize').value;
    const [renderer, gpu] = ['renderer', 'gpu-process'].map((kind) => residentBytes(server.process().pid, kind));
    console.log(`${what}: heap ${mib(heap)} MiB; ${geometries} geometries, ${textures} textures; processes: page ${mib(renderer - recorded)} (less ${mib(recorded)} recorded), graphics ${mib(gpu)} MiB`);
  };

  await page.goto(url);
  await page.waitForFunction(() => window.kinloop?.connection.run && window.kinloop.panel.state.paused);
  await page.evaluate(record);
  await report('at the start');
  await page.focus('#scene');
  await page.keyboard.press(' ');
  await page.waitForFunction(() => !window.kinloop.panel.state.connected);
  await report('after the run');
  let images = 0;
  for (let reported = 0; images < wantedImages; ) {
    images += await page.evaluate(replay);
    if (images < ((reported + 1) * wantedImages) / REPORTS) continue;
    reported = Math.floor((images * REPORTS) / wantedImages);
    await report(`${images} images`);
  }
} finally {
  await browser.close();
  await server.close();
  kinloop.kill();
  rmSync(folder, { recursive: true });
}
