// What axe-core finds on a page: names and roles of controls, contrast, order of headings.

import { readFileSync } from 'node:fs';
import { join } from 'node:path';

const AXE = readFileSync(join(process.env.KINLOOP_PAGES_SOURCE, 'node_modules/axe-core/axe.min.js'), 'utf8');
const SCREENS = { desktop: { width: 1280, height: 800 }, phone: { width: 390, height: 844 } };

/** What it finds on the page as it is now: a line for each element. */
async function violationsOf(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => window.axe.run());
  return violations.flatMap(({ id, help, nodes }) => nodes.map(({ target, any }) => `${id} (${help}): ${target} ${any[0]?.message ?? ''}`));
}

/** What is found on both screens in light and dark. */
export async function findings(page, name) {
  const found = [];
  for (const [screen, size] of Object.entries(SCREENS)) {
    for (const colorScheme of ['light', 'dark']) {
      await page.setViewportSize(size);
      await page.emulateMedia({ colorScheme });
      await page.waitForTimeout(300); // colours fade
      for (const violation of await violationsOf(page)) found.push(`${name}, ${screen}, ${colorScheme}: ${violation}`);
    }
  }
  return found;
}
