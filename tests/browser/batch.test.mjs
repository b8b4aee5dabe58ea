// The page of kinloop batch with 10,000 runs: drawn at once, sorted, filtered, plotted.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

import { withBrowser, paintedPixels, until } from './harness.mjs';

const TEMPLATE = join(dirname(fileURLToPath(import.meta.url)), '../../python/kinloop/batch/page.html');
const RUNS = 10_000;
const COLUMNS = ['dataset', 'sequence', 'variant', 'seed', 'status', 'ate_m', 'frames', 'key', 'cpu_s'];
const TEXTS = ['dataset', 'sequence', 'variant', 'status', 'key'];

/** Every hundredth run is lost; the others have errors that differ. */
function row(i) {
  const lost = i % 100 === 99;
  const ate = lost ? null : 0.001 + ((i * 7919) % RUNS) / 1e5;
  return ['rooms', `room${i}`, i % 2 ? 'no_loop' : 'default', 1, lost ? 'lost' : 'done', ate, 500, `k${i}`, 3 + (i % 13), 'run.json'];
}

function writePage(file) {
  const data = {
    title: 'many', counts: '9900 done, 100 lost', columns: COLUMNS, texts: TEXTS,
    rows: Array.from({ length: RUNS }, (_, i) => row(i)),
    variantColumns: ['variant', 'dataset', 'failed'], variants: [['default', 'rooms', 0], ['no_loop', 'rooms', 100]],
    worst: [{ text: 'room1 & <b>', href: 'runs/k1/run.json', picture: '' }],
  };
  writeFileSync(file, readFileSync(TEMPLATE, 'utf8').replace('DATA', () => JSON.stringify(data)));
}

await withBrowser(async ({ open, folder, shoot }) => {
  const file = join(folder, 'index.html');
  writePage(file);
  const page = await open(pathToFileURL(file).href);
  const cells = (column) => page.locator(`#runs tbody tr td:nth-child(${COLUMNS.indexOf(column) + 1})`).allTextContents();
  const shown = (text) => until(async () => (await page.locator('#shown').textContent()) === text, text);
  const head = (column) => page.locator('#runs th', { hasText: new RegExp(`^${column}$`) });

  assert.equal(await page.locator('h1').textContent(), 'many');
  await shown(`${RUNS} of ${RUNS}`);
  assert.ok((await cells('sequence')).length < 100, 'only the rows in view are drawn');
  assert.equal(await page.locator('canvas').getAttribute('data-points'), '9900');
  assert.ok((await paintedPixels(page, 'canvas')) > 1000, 'the plot is drawn');
  assert.equal(await page.locator('#runs a').first().getAttribute('href'), 'runs/k0/run.json');
  assert.equal(await page.locator('#worst').textContent(), 'room1 & <b>');

  // Sorted by the error, unknown ones last in both directions; names by their numbers.
  await head('ate_m').click();
  let errors = (await cells('ate_m')).map(Number);
  assert.deepEqual(errors, [...errors].sort((a, b) => a - b));
  await head('ate_m').click();
  errors = (await cells('ate_m')).map(Number);
  assert.deepEqual(errors, [...errors].sort((a, b) => b - a));
  assert.ok(errors[0] > 0.09);
  await head('sequence').click();
  assert.deepEqual((await cells('sequence')).slice(0, 3), ['room0', 'room1', 'room2']);

  // Scrolled to the end.
  await page.evaluate(() => (document.querySelector('.scroll').scrollTop = 1e9));
  await until(async () => (await cells('sequence')).at(-1) === `room${RUNS - 1}`, 'the last row is drawn');

  // Filtered by words and conditions.
  await page.fill('#filter', 'status=lost');
  await shown(`100 of ${RUNS}`);
  await page.fill('#filter', 'no_loop ate_m<=0.01');
  const few = Array.from({ length: RUNS }, (_, i) => row(i)).filter((r) => r[2] === 'no_loop' && r[5] !== null && r[5] <= 0.01);
  await shown(`${few.length} of ${RUNS}`);
  assert.equal(await page.locator('canvas').getAttribute('data-points'), String(few.length));
  await page.fill('#filter', 'no such run');
  await shown(`0 of ${RUNS}`);
  await page.fill('#filter', '');
  await shown(`${RUNS} of ${RUNS}`);
  await shoot(page, 'batch', { fullPage: true });
  await page.close();

  const phone = await open(pathToFileURL(file).href, { viewport: { width: 390, height: 844 }, colorScheme: 'dark' });
  const width = await phone.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(width <= 0, `nothing sticks out at the side, ${width} px`);
});
