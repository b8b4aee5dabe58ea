// A run of the simulated Kinect, watched from its first frame to the loop that it closes.

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

import { onStage, paintedPixels, seen, until } from './stage.mjs';

const SMALL = ['--set', 'sim.width=320', '--set', 'sim.height=240'];
const frame = ({ facts }) => Number(facts.match(/frame\s+(\d+)/)?.[1]);

/** The frame at which the page comes to rest: where a computer draws slowly, it shows for a while what was before. */
async function settled(page) {
  let shown = frame(await seen(page));
  await until(async () => {
    const before = shown;
    await page.waitForTimeout(2000);
    shown = frame(await seen(page));
    return shown === before;
  }, 'while it is paused no frame is taken');
  return shown;
}

await onStage(async ({ open, kinloop, folder, shoot }) => {
  const out = join(folder, 'out');
  const run = kinloop('run', 'sim:room', '-o', out, '--viewer=0', ...SMALL);
  const url = await run.url();
  const page = await open(url);
  const other = await open(url);

  // The page loads, pauses, and steps one frame at a time.
  await until(async () => (await seen(page)).keyframes > 1, 'keyframes come');
  await page.click('#pause');
  await until(async () => (await seen(page)).badge.includes('paused'), 'the run pauses');
  const still = await settled(page);
  await page.click('#step');
  await until(async () => frame(await seen(page)) === still + 1, 'a step is one frame');
  assert.ok((await seen(other)).badge.includes('paused'), 'the other browser sees the same');

  // The line breaks: the page comes back, keeps what it has and gets only the rest.
  const whole = await seen(page);
  await page.evaluate(() => window.kinloop.connection.socket.close());
  await until(() => page.evaluate(() => window.kinloop.connection.socket.readyState === WebSocket.OPEN), 'it comes back');
  await page.waitForTimeout(500);
  const rest = await seen(page);
  assert.equal(rest.points, whole.points);
  assert.ok(rest.bytes - whole.bytes < whole.bytes / 4, `${rest.bytes - whole.bytes} bytes after ${whole.bytes}`);

  // The map is saved as it is, while the run is paused.
  await page.click('#save');
  await until(() => existsSync(join(out, 'map.ply')), 'the map is saved on demand');

  // It goes on: the cloud grows, the camera moves, the images come.
  const before = await seen(page);
  await page.keyboard.press(' ');
  await until(async () => (await seen(page)).points > 2 * before.points, 'the cloud grows');
  const later = await seen(page);
  assert.notDeepEqual(later.camera, before.camera, 'the camera moves');
  assert.ok(later.path > before.path, 'the path grows');
  assert.ok(later.truth > 100, 'there is ground truth');
  assert.ok((await paintedPixels(page, '#scene')) > 5000, 'the scene is drawn');
  assert.ok((await paintedPixels(page, '#colorImage')) > 5000, 'the colour image is shown');
  assert.ok((await paintedPixels(page, '#depthImage')) > 5000, 'the depth image is shown');

  // The eye follows the camera, and the colours change.
  await page.check('[name=camera][value=follow]');
  const eye = (await seen(page)).eye;
  await until(async () => Math.hypot(...(await seen(page)).eye.map((x, i) => x - eye[i])) > 0.1, 'the eye follows');
  for (const color of ['height', 'depth', 'time', 'camera']) await page.selectOption('#color', color);
  await shoot(page, 'live-follow');
  await page.check('[name=camera][value=orbit]');
  await page.click('#home');

  // A browser that comes late, or back, gets all there is.
  await page.keyboard.press(' ');
  await until(async () => (await seen(page)).badge.includes('paused'), 'the run pauses again');
  await other.reload();
  await until(async () => (await seen(other)).points >= later.points, 'a late browser gets the whole map');
  await page.keyboard.press(' ');

  // The loop is closed, and one sees it.
  await until(async () => (await seen(page)).loops > 0, 'a loop is closed');
  assert.equal((await seen(page)).flash, 'on', 'the page tells of the loop');
  await shoot(page, 'live-loop');

  assert.equal(await run.ended, 0, run.text);
  const end = await seen(page);
  assert.ok(end.path > 150, `the path is whole: ${end.path}`);
  await until(async () => (await seen(page)).badge === 'not connected', 'the page tells that the run is over');
  assert.ok((await seen(page)).points > 0, 'what was seen stays to be looked at');
});
