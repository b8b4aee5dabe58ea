// The basis of the browser tests: running kinloop, a headless Chromium, and polling for conditions. Exit code
// 77 tells CTest that a test was skipped.

import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, mkdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const SKIPPED = 77;
const PATIENCE_MS = 120_000;
const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const { KINLOOP_PROGRAM, KINLOOP_PAGES_SOURCE, KINLOOP_SCREENSHOTS } = process.env;

function skip(why) {
  console.log(`SKIPPED: ${why}`);
  process.exit(SKIPPED);
}

async function launch() {
  if (!CHROMIUM) skip('there is no chromium; scripts/install_dependencies.sh --checks installs it');
  const library = join(KINLOOP_PAGES_SOURCE, 'node_modules/playwright-core/index.mjs');
  if (!existsSync(library)) skip('playwright-core is not there; the pages are off in this build');
  const { chromium } = await import(library);
  const args = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
  return chromium.launch({ executablePath: CHROMIUM, args });
}

// The browser's own messages, and those after the end of a run, when the page keeps trying to reconnect.
const NO_FAULT = /GPU stall|GL Driver Message|ERR_CONNECTION_REFUSED/;

/** Runs a test with { open, kinloop, folder, shoot }; cleans up afterwards in any case. */
export async function withBrowser(test) {
  const browser = await launch();
  const folder = mkdtempSync(join(tmpdir(), 'kinloop-browser-'));
  const running = [];
  const complaints = [];

  /** Opens a page and fails on console errors. */
  const open = async (url, options = {}) => {
    const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, ...options });
    page.setDefaultTimeout(PATIENCE_MS); // the machine may be busy
    page.on('console', (message) => ['error', 'warning'].includes(message.type()) && complaints.push(message.text()));
    page.on('pageerror', (error) => complaints.push(error.message));
    await page.goto(url);
    return page;
  };
  /** Starts `kinloop ARGUMENTS...`. */
  const kinloop = (...args) => {
    const child = start(args);
    running.push(child);
    return child;
  };
  const shoot = async (page, name, options = {}) => {
    if (!KINLOOP_SCREENSHOTS) return;
    mkdirSync(KINLOOP_SCREENSHOTS, { recursive: true });
    await page.screenshot({ path: join(KINLOOP_SCREENSHOTS, `${name}.png`), ...options });
  };
  try {
    await test({ open, kinloop, folder, shoot });
    assert.deepEqual(complaints.filter((text) => !NO_FAULT.test(text)), [], 'the console is quiet');
  } finally {
    await browser.close();
    running.forEach((child) => child.process.kill('SIGKILL'));
    rmSync(folder, { recursive: true, force: true });
  }
}

function start(args) {
  const process_ = spawn(KINLOOP_PROGRAM, args, { stdio: ['ignore', 'pipe', 'pipe'] });
  const child = { process: process_, text: '' };
  process_.stdout.on('data', (data) => (child.text += data));
  process_.stderr.on('data', (data) => (child.text += data));
  child.ended = new Promise((resolve) => process_.on('close', resolve));
  child.url = () => until(() => child.text.match(/http:\S+\/[^\s;]*/)?.[0], () => `kinloop tells where to look: ${child.text}`);
  return child;
}

/** Polls until the answer is truthy, and returns it. */
export async function until(question, what) {
  const end = Date.now() + PATIENCE_MS;
  while (Date.now() < end) {
    const answer = await question();
    if (answer) return answer;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  return assert.fail(`never came true: ${typeof what === 'function' ? what() : what}`);
}

/** The displayed state of a viewer page. */
export function seen(page) {
  return page.evaluate(() => {
    const { world, view, connection } = window.kinloop;
    const camera = world.cameraPose?.elements.slice(12, 15);
    const eye = view.cameraControls.camera.position.toArray();
    return {
      points: world.pointCount,
      meshPieces: world.meshPieces.size,
      keyframes: world.poses.count,
      loops: world.loops.length / 2,
      path: world.lines.path.object.geometry.drawRange.count,
      truth: world.truth.length / 3,
      camera,
      eye,
      run: connection.run,
      bytes: connection.bytes,
      flash: document.getElementById('flash').className,
      facts: document.getElementById('facts').innerText,
      badge: document.getElementById('tracking').textContent,
      message: document.getElementById('message').textContent,
      cutAtM: view.cutAtM,
      cut: document.getElementById('cutAt').textContent,
    };
  });
}

/** The number of nonempty pixels of a canvas. */
export function paintedPixels(page, selector) {
  return page.evaluate(async (canvas) => {
    const source = document.querySelector(canvas);
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [source.width, source.height];
    const paint = copy.getContext('2d');
    paint.drawImage(source, 0, 0);
    const { data } = paint.getImageData(0, 0, copy.width, copy.height);
    let painted = 0;
    for (let i = 3; i < data.length; i += 4) painted += data[i] > 0;
    return painted;
  }, selector);
}
