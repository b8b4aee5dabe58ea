// The page of kinloop share, opened from disk without a network.

import assert from 'node:assert/strict';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { withBrowser, paintedPixels, seen, until } from './harness.mjs';

const FAST = ['--set', 'sim.fps=5', '--set', 'sim.width=320', '--set', 'sim.height=240'];
const MOST_BYTES = 20e6;

/** Opens a page of disk and lists what it asks for. */
async function openFile(open, file, options = {}) {
  const requests = [];
  const page = await open('about:blank', options);
  page.on('request', (request) => requests.push(request.url()));
  await page.context().setOffline(true);
  await page.goto(pathToFileURL(file).href);
  return { page, requests };
}

/** Clicks measure a distance. */
async function checkMeasure(page) {
  await page.check('[name=tool][value=distance]', { force: true });
  const { width, height } = await page.locator('#scene').boundingBox();
  const isMeasured = async () => {
    for (const x of [0.4, 0.6]) await page.mouse.click(x * width, 0.5 * height); // nothing while the view still moves
    return (await page.locator('#measures li').count()) > 0;
  };
  await until(isMeasured, 'the distance is listed');
  assert.match(await page.textContent('#measures'), /\d+(\.\d+)? (m|cm|mm)/);
}

/** The timeline moves the camera and shows images. */
async function checkTimeline(page) {
  assert.ok(await page.isVisible('#timeline'));
  await page.locator('#bar').focus();
  await page.keyboard.press('Home');
  const { camera } = await seen(page);
  await page.keyboard.press('End');
  const hasMoved = async () => JSON.stringify((await seen(page)).camera) !== JSON.stringify(camera);
  await until(hasMoved, 'the camera moves');
  await until(async () => (await paintedPixels(page, '#colorImage')) > 5000, 'the image of the nearest keyframe');
  await until(() => page.url().includes('#t='), 'the address is a link to the moment');
}

await withBrowser(async ({ open, kinloop, folder, shoot }) => {
  const [out, file] = [join(folder, 'out'), join(folder, 'room.html')];
  const run = kinloop('run', 'sim:room', '-q', '-o', out, ...FAST);
  assert.equal(await run.ended, 0, run.text);
  const share = kinloop('share', out, '-o', file);
  assert.equal(await share.ended, 0, share.text);
  assert.ok(statSync(file).size < MOST_BYTES);
  const shown = share.text.match(/(\d+) of \d+ points/);
  assert.ok(shown, share.text);
  const points = Number(shown[1]);

  for (const [name, options] of Object.entries({
    light: { colorScheme: 'light' },
    dark: { colorScheme: 'dark' },
    phone: { colorScheme: 'dark', viewport: { width: 390, height: 844 } },
  })) {
    const { page, requests } = await openFile(open, file, options);
    await until(async () => (await seen(page)).points === points, 'all points are there');
    await until(() => paintedPixels(page, '#scene').then((painted) => painted > 20_000), 'and drawn');
    await until(async () => (await seen(page)).badge === 'saved', 'the badge says that the map is a saved one');
    assert.equal(await page.title(), 'sim:room - kinloop');
    assert.equal(await page.isVisible('#run'), false, 'there is no run to pause');
    if (name === 'light') await checkMeasure(page);
    if (name === 'light') await checkTimeline(page);
    await page.waitForTimeout(500); // shading follows at rest
    await shoot(page, `share-${name}`);
    const elsewhere = requests.filter((url) => url !== pathToFileURL(file).href && !/^(blob|data):/.test(url));
    assert.deepEqual(elsewhere, [], 'nothing is loaded');
    await page.close();
  }

  // The mesh, with its texture, in place of the cloud.
  const mesh = kinloop('mesh', out, '-q', '--voxel', '0.04', '--texture', '512', '-o', join(out, 'mesh.glb'));
  assert.equal(await mesh.ended, 0, mesh.text);
  const shareMesh = kinloop('share', out, '-q', '--mesh', '-o', file);
  assert.equal(await shareMesh.ended, 0, shareMesh.text);
  const { page: solid } = await openFile(open, file);
  await until(() => solid.evaluate(() => window.kinloop.world.models.length === 1), 'the mesh is there');
  assert.equal((await seen(solid)).points, 0);
  await until(() => paintedPixels(solid, '#scene').then((painted) => painted > 20_000), 'and drawn');
  const textures = await solid.evaluate(() => {
    const widths = [];
    window.kinloop.world.models[0].traverse(({ material }) => material && widths.push(material.map?.image.width));
    return widths;
  });
  assert.ok(textures.length === 1 && textures[0] > 200 && textures[0] <= 512, `it has its texture: ${textures}`);
  await checkMeasure(solid);
  await shoot(solid, 'share-mesh');
  await solid.close();

  // A page that was cut off says so.
  const html = readFileSync(file, 'utf8');
  const begin = html.indexOf('id="recording">') + 'id="recording">'.length;
  writeFileSync(file, html.slice(0, begin + 4000) + html.slice(html.indexOf('<', begin)));
  const { page: damaged } = await openFile(open, file);
  await until(async () => (await seen(damaged)).message.includes('cannot be read'), 'the page tells');
});
