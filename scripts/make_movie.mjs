// Makes the pictures of the README's movie, a map that grows in the viewer; see make_pictures.sh.

import { join } from 'node:path';

import { withBrowser, seen, until } from '../tests/browser/harness.mjs';

const [folder] = process.argv.slice(2);
const STEP_FRAMES = 8;
const RATE_HZ = 1; // a picture of the growing map takes the software renderer seconds

await withBrowser(async ({ open, kinloop }) => {
  const run = kinloop('run', 'sim:room', '-o', join(folder, 'out'), '--viewer=0', `--pace=${RATE_HZ}`, '--set', 'viewer.image_rate_hz=10');
  const page = await open(await run.url(), { viewport: { width: 800, height: 500 } });
  await page.addStyleTag({ content: '#options, #run, #images figure:last-child { display: none !important }' });
  await page.focus('#scene');
  const frame = async () => Number((await seen(page)).facts.match(/frame\s+(\d+)/)?.[1] ?? 0);
  let number = 0;
  const shoot = () => page.screenshot({ path: join(folder, `${String(number++).padStart(3, '0')}.png`) });
  for (let next = STEP_FRAMES; !(await seen(page)).badge.includes('ended'); next += STEP_FRAMES) {
    await until(async () => (await frame()) >= next || (await seen(page)).badge.includes('ended'), 'the run proceeds');
    await shoot();
  }
});
