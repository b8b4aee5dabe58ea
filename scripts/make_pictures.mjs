// Makes the pictures of README and docs from a simulated room; see make_pictures.sh.

import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { withBrowser, seen, until } from '../tests/browser/harness.mjs';

const images = process.env.KINLOOP_SCREENSHOTS;
const JPEG = { type: 'jpeg', quality: 78 };

/** Screenshot of the page; of a long one, the top. */
async function shoot(page, name, heightPx) {
  await page.waitForTimeout(1500); // wait until animations have ended and all points are drawn
  const top = heightPx ? { fullPage: true, clip: { x: 0, y: 0, width: 960, height: heightPx } } : {};
  await page.screenshot({ path: join(images, `${name}.jpg`), ...JPEG, ...top });
}

await withBrowser(async ({ open, kinloop, folder }) => {
  const [sequence, out, plain] = ['simulated_room', 'with_loops', 'without_loops'].map((name) => join(folder, name));
  assert.equal(await kinloop('simulate', 'room', '-q', '-o', sequence).ended, 0);

  // The live page, just after a loop closure.
  const run = kinloop('run', sequence, '-o', out, '--viewer=0', '--set', 'viewer.paused=true');
  const live = await open(await run.url());
  await until(async () => (await seen(live)).badge.includes('paused'), 'the run waits');
  await live.keyboard.press(' ');
  await until(async () => (await seen(live)).loops > 0, 'a loop is closed');
  await live.keyboard.press('f');
  await shoot(live, 'viewer_live');
  await run.ended;

  // The results of the runs: the figures of README and docs are those of these commands.
  assert.equal(await kinloop('run', sequence, '-q', '-o', out).ended, 0);
  assert.equal(await kinloop('run', sequence, '-q', '--no-loop', '-o', plain).ended, 0);
  const saved = await open(await kinloop('view', out, '--port', '0').url());
  await until(async () => (await seen(saved)).points > 10_000, 'the map is there');
  await shoot(saved, 'viewer_saved');

  const report = await open(pathToFileURL(join(out, 'report.html')).href, { viewport: { width: 960, height: 800 } });
  await shoot(report, 'report', 2200);
  const map = await report.locator('figure img').first().getAttribute('src');
  writeFileSync(join(images, 'simulated_room.jpg'), Buffer.from(map.split(',')[1], 'base64'));

  const comparison = join(folder, 'comparison.html');
  await kinloop('report', out, plain, '-o', comparison).ended;
  await shoot(await open(pathToFileURL(comparison).href, { viewport: { width: 960, height: 800 } }), 'comparison', 1150);
});
