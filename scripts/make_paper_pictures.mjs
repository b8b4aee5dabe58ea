// Makes the pictures of docs/lab/paper.md from the folder of `kinloop reproduce`; see make_pictures.sh.

import { copyFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { withBrowser } from '../tests/browser/harness.mjs';

const images = process.env.KINLOOP_SCREENSHOTS;
const made = resolve(process.argv[2]);

await withBrowser(async ({ open }) => {
  for (const name of ['sift_all', 'sift_screened', 'orb_all', 'orb_screened']) {
    const picture = pathToFileURL(join(made, 'matches', `${name}.png`)).href;
    const page = await open(picture, { viewport: { width: 1280, height: 536 } });
    await page.screenshot({ path: join(images, `paper_${name}.jpg`), type: 'jpeg', quality: 82 });
  }
  copyFileSync(join(made, 'trajectories.svg'), join(images, 'paper_trajectories.svg'));
});
