// Live capture of calibration images in the viewer: the camera's image and the next instruction.

import assert from 'node:assert/strict';
import { join } from 'node:path';

import { withBrowser, paintedPixels, until } from './harness.mjs';

await withBrowser(async ({ open, kinloop, folder, shoot }) => {
  const board = ['--board', '5x7', '--square', '0.03'];
  const live = kinloop('calibrate', 'intrinsics', join(folder, 'stills'), '--live', 'sim:room', '--viewer=0', ...board);
  const page = await open(await live.url());
  await until(async () => (await page.textContent('#message')).includes('show the board (0 of 20)'), 'a hint');
  await until(async () => (await paintedPixels(page, '#colorImage')) > 5000, 'the camera image is shown');
  await shoot(page, 'calibrate');
  live.process.kill('SIGINT');
  await live.ended;
  assert.ok(live.text.includes('0 stills in'), live.text);
});
