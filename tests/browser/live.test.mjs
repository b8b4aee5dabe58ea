// A run of the simulated Kinect in the viewer, from its first frame to its loop closure.

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

import { findings } from './axe.mjs';
import { withBrowser, paintedPixels, seen, until } from './harness.mjs';

const WAITING = ['--set', 'viewer.paused=true', '--set', 'sim.width=320', '--set', 'sim.height=240'];
const FEW_FRAMES = 60;
const meshIsAtKeyframes = (page) =>
  page.evaluate(() => {
    const { world } = window.kinloop;
    return world.meshPieces.size > 0 && [...world.meshPieces.values()].every(({ object, anchor }) => {
      const pose = world.poses.at(anchor);
      return pose && object.matrix.equals(pose.clone().multiply(object.userData.toAnchor));
    });
  });
const frame = ({ facts }) => Number(facts.match(/frame\s+(\d+)/)?.[1]);

// Tests that need a paused run come first: with slow rendering, a run may be over before the page can pause
// it.
await withBrowser(async ({ open, kinloop, folder, shoot }) => {
  const out = join(folder, 'out');
  const run = kinloop('run', 'sim:room', '-o', out, '--viewer=0', ...WAITING);
  const url = await run.url();
  const page = await open(url);
  const other = await open(url);

  assert.equal(await page.title(), 'sim:room - kinloop');

  // Without the token, or with that of an earlier run, a page shows the run but does not control it.
  const spectator = await open(new URL('/', url).href);
  await until(async () => (await seen(spectator)).badge.includes('paused'), 'a spectator sees the run');
  for (const button of ['pause', 'step', 'save']) assert.ok(await spectator.isDisabled(`#${button}`));
  await spectator.goto(`${new URL('/', url).href}?token=${'0'.repeat(32)}`);
  await until(() => spectator.isEnabled('#pause'), 'the page does not know the token');
  await spectator.click('#pause');
  await until(() => spectator.isDisabled('#pause'), 'the command is refused');
  assert.match(await spectator.getAttribute('#pause', 'title'), /Open the URL/);
  await spectator.close();

  // The run waits for its first frame, and steps one frame at a time.
  await until(async () => (await seen(page)).badge.includes('paused'), 'the run waits');
  for (let i = 0; i < FEW_FRAMES; ++i) await page.keyboard.press('s');
  await until(async () => frame(await seen(page)) === FEW_FRAMES, 'a step is one frame');
  await until(async () => (await seen(page)).keyframes > 1, 'keyframes arrive');
  await until(async () => frame(await seen(other)) === FEW_FRAMES, 'the other browser sees the same');
  assert.ok((await seen(other)).badge.includes('paused'));

  // The connection breaks: the page reconnects, keeps its data and receives only the rest.
  const isQuiet = async () => {
    const { bytes } = await seen(page);
    await page.waitForTimeout(1000);
    return (await seen(page)).bytes === bytes;
  };
  await until(isQuiet, 'all of the frames so far has arrived');
  const whole = await seen(page);
  await page.evaluate(() => window.kinloop.connection.socket.close());
  await until(() => page.evaluate(() => window.kinloop.connection.socket.readyState === WebSocket.OPEN), 'it reconnects');
  await page.waitForTimeout(500);
  const rest = await seen(page);
  assert.ok(rest.points >= whole.points, 'it keeps its data');
  assert.ok(rest.bytes - whole.bytes < whole.bytes / 4, `${rest.bytes - whole.bytes} bytes after ${whole.bytes}`);

  // A browser that connects late, or reconnects, receives everything.
  await other.reload();
  await until(async () => (await seen(other)).points === (await seen(page)).points, 'a late browser receives the whole map');

  // The current map can be saved while the run is paused.
  await page.click('#save');
  await until(() => existsSync(join(out, 'map.ply')), 'the map is saved on demand');

  // Advice for the recording, as the run would send it: it is paused and sends nothing.
  await until(async () => (await seen(page)).message === 'map saved', 'it is told');
  await page.waitForTimeout(1500); // the frame rate is that of the last second
  const advise = (hints) => page.evaluate((texts) => window.kinloop.panel.state.show({ ...window.kinloop.panel.state.status, hints: texts, warnings: ['depth is mirrored; flip it'] }), hints);
  assert.equal(await page.isVisible('#hints'), false, 'there is none');
  await advise(['Too fast: move and turn more slowly', 'Too dark: switch on a light']);
  const lines = page.getByRole('status', { name: 'Advice for the recording' }).locator('p');
  assert.deepEqual(await lines.allInnerTexts(), ['Too fast: move and turn more slowly', 'Too dark: switch on a light']);
  const first = await page.evaluateHandle(() => document.getElementById('hints').firstChild);
  await advise(['Too fast: move and turn more slowly', 'Too dark: switch on a light']);
  assert.ok(await first.evaluate((line) => line.isConnected), 'what stays is not announced again');
  await shoot(page, 'live-hints');
  assert.deepEqual(await findings(page, 'live page with advice'), []);
  await shoot(page, 'live-hints-phone');
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.emulateMedia({ colorScheme: 'light' });
  await advise([]);
  assert.equal(await page.isVisible('#hints'), false, 'they end');

  // There is a mesh beside the cloud, with a checkbox and a key.
  await until(async () => (await seen(page)).meshPieces > 5, 'a mesh grows');
  await shoot(page, 'live-mesh');
  await page.uncheck('[data-layer=cloud]');
  await until(async () => (await paintedPixels(page, '#scene')) > 5000, 'the mesh is painted');
  await shoot(page, 'live-mesh-alone');
  const withMesh = await paintedPixels(page, '#scene');
  await page.uncheck('[data-layer=mesh]');
  await until(async () => (await paintedPixels(page, '#scene')) < withMesh / 2, 'it is hidden');
  await page.keyboard.press('d');
  const shown = ['cloud', 'mesh'].map((layer) => page.isChecked(`[data-layer=${layer}]`));
  assert.deepEqual(await Promise.all(shown), [true, true], 'D shows both');
  await page.focus('#scene'); // on a checkbox, the space bar toggles it

  // The run continues: the cloud grows, the camera moves, images arrive.
  const before = await seen(page);
  await page.keyboard.press(' ');
  await until(async () => (await seen(page)).points > 2 * before.points, 'the cloud grows');
  const later = await seen(page);
  assert.notDeepEqual(later.camera, before.camera, 'the camera moves');
  assert.ok(later.path > before.path, 'the path grows');
  assert.ok(later.truth > 100, 'there is ground truth');
  for (const picture of ['#scene', '#colorImage', '#depthImage']) {
    await until(async () => (await paintedPixels(page, picture)) > 5000, `${picture} is painted`);
  }

  // The viewpoint follows the camera, and the colours change.
  await page.check('[name=camera][value=follow]');
  const eye = (await seen(page)).eye;
  await until(async () => Math.hypot(...(await seen(page)).eye.map((x, i) => x - eye[i])) > 0.1, 'the viewpoint follows');
  assert.equal(await page.locator('#color option:disabled').count(), 0, 'a run has times');
  for (const color of ['height', 'depth', 'time', 'camera']) await page.selectOption('#color', color);
  await shoot(page, 'live-follow');
  await page.check('[name=camera][value=orbit]');
  await page.click('#reset');

  // The loop closure is displayed.
  await until(async () => (await seen(page)).loops > 0, 'a loop is closed');
  assert.equal((await seen(page)).flash, 'on', 'the page reports the loop');
  await page.keyboard.press('Escape');
  assert.ok(await page.evaluate(() => window.kinloop.world.has('loops')), 'its edge stays');
  await shoot(page, 'live-loop');

  // The mesh follows the correction.
  await until(() => meshIsAtKeyframes(page), 'pieces are at their keyframes');

  assert.equal(await run.ended, 0, run.text);
  await until(async () => (await seen(page)).message.includes('closed'), 'the page reports that the connection is lost');
  const ended = await seen(page);
  assert.equal(ended.badge, 'run ended');
  assert.equal(ended.message, 'The run has ended; the connection is closed.');
  for (const button of ['pause', 'step', 'save']) assert.ok(await page.isDisabled(`#${button}`), `nothing to ${button}`);
  await until(async () => (await seen(page)).path > 150, 'the path is complete and stays visible');
});
