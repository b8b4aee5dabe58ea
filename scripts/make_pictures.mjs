// The pictures of README and docs, taken of a simulated room; see make_pictures.sh.

import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { onStage, seen, until } from '../tests/browser/stage.mjs';

const images = process.env.KINLOOP_SCREENSHOTS;
const JPEG = { type: 'jpeg', quality: 82 };

/** The drawn page; `selector` alone where it is given. */
async function shoot(page, name, selector) {
  await page.waitForTimeout(1500); // what glides comes to rest, and all points are drawn
  const what = selector ? page.locator(selector).first() : page;
  await what.screenshot({ path: join(images, `${name}.jpg`), ...JPEG, ...(name.startsWith('viewer') ? {} : { fullPage: true }) });
}

await onStage(async ({ open, kinloop, folder }) => {
  const [out, plain] = [join(folder, 'sim_room'), join(folder, 'sim_room_without_loops')];

  // The live page, while a loop has just been closed.
  const run = kinloop('run', 'sim:room', '-o', out, '--viewer=0', '--pace', '30', '--set', 'viewer.paused=true');
  const live = await open(await run.url());
  await until(async () => (await seen(live)).badge.includes('paused'), 'the run waits');
  await live.keyboard.press(' ');
  await until(async () => (await seen(live)).loops > 0, 'a loop is closed');
  await live.keyboard.press('f');
  await shoot(live, 'viewer_live');
  await run.ended;

  // What the runs left behind: the figures of README and docs are those of these commands.
  await kinloop('run', 'sim:room', '-q', '-o', out).ended;
  await kinloop('run', 'sim:room', '-q', '--no-loop', '-o', plain).ended;
  const saved = await open(await kinloop('view', out, '--port', '0').url());
  await until(async () => (await seen(saved)).points > 10_000, 'the map is there');
  await shoot(saved, 'viewer_saved');

  const report = await open(pathToFileURL(join(out, 'report.html')).href, { viewport: { width: 960, height: 800 } });
  await shoot(report, 'report');
  const map = await report.locator('figure img').first().getAttribute('src');
  writeFileSync(join(images, 'simulated_room.jpg'), Buffer.from(map.split(',')[1], 'base64'));

  const comparison = join(folder, 'comparison.html');
  await kinloop('report', out, plain, '-o', comparison).ended;
  await shoot(await open(pathToFileURL(comparison).href, { viewport: { width: 960, height: 800 } }), 'comparison');
});
