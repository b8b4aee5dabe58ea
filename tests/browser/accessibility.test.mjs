// Every page against the rules of axe-core: names and roles of controls, contrast, order of headings.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { findings } from './axe.mjs';
import { withBrowser, seen, until } from './harness.mjs';

const SMALL = ['--set', 'sim.fps=5', '--set', 'sim.width=320', '--set', 'sim.height=240'];

/** The first keyframe of a run with three others, as run.json lists loops. */
function loopsOfEveryStatus(folder) {
  const stamps = readFileSync(join(folder, 'keyframes.txt'), 'utf8').match(/^[\d.]+/gm);
  return ['provisional', 'rejected', 'withdrawn'].map((status, i) => ({ stamp_a: stamps[0], stamp_b: stamps[i + 1], inliers: 40, support: 1, scale: null, status, reason: 'does not fit' }));
}

await withBrowser(async ({ open, kinloop, folder }) => {
  const out = join(folder, 'out');
  assert.equal(await kinloop('run', 'sim:room:3', ...SMALL, '-o', out).ended, 0);

  const found = [];
  const saved = await open(await kinloop('view', out, '--port', '0').url());
  await until(async () => (await seen(saved)).points > 1000, 'the cloud is there');
  found.push(...(await findings(saved, 'viewer')));
  await saved.evaluate(() => window.kinloop.panel.picked.showKeyframe(0));
  found.push(...(await findings(saved, 'viewer with a keyframe selected')));
  await saved.close();

  // With loops of every status, and one selected.
  const figures = JSON.parse(readFileSync(join(out, 'run.json'), 'utf8'));
  writeFileSync(join(out, 'run.json'), JSON.stringify({ ...figures, other_loops: loopsOfEveryStatus(out) }));
  const looped = await open(await kinloop('view', out, '--port', '0').url());
  await until(() => looped.isVisible('#loopList'), 'the loops are listed');
  await looped.evaluate(() => window.kinloop.panel.loops.select(0));
  found.push(...(await findings(looped, 'viewer with loops')));
  await looped.close();

  const [summary, doubtful] = [join(out, 'run.json'), join(folder, 'doubtful.html')];
  const run = JSON.parse(readFileSync(summary, 'utf8'));
  writeFileSync(summary, JSON.stringify({ ...run, quality: { verdict: 'doubtful', reasons: ['5.0 s are in doubt'] }, advice: [{ kind: 'too_fast', seconds: 2.5, advice: 'Too fast: move and turn more slowly' }] }));
  assert.equal(await kinloop('report', out, '-o', doubtful).ended, 0);
  const shared = join(folder, 'room.html');
  assert.equal(await kinloop('share', out, '-o', shared).ended, 0);
  for (const [name, file] of Object.entries({ report: join(out, 'report.html'), 'doubtful report': doubtful, 'shared room': shared })) {
    const page = await open(pathToFileURL(file).href);
    if (name === 'doubtful report') assert.match(await page.textContent('header'), /while recording: Too fast: move and turn more slowly \(2\.5 s\)/);
    found.push(...(await findings(page, name)));
    await page.close();
  }
  assert.deepEqual(found, []);
});
