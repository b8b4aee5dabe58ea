// CPU time per module.

import { barX, ruleX } from '@observablehq/plot';

import { figure, legend, row, section, table } from './page.js';
import { draw, FULL_WIDTH } from './plot.js';

const TITLE = 'CPU time per module';

export function moduleSection(all) {
  const runs = all.filter((run) => Object.keys(run.figures.timings ?? {}).length > 0);
  if (runs.length === 0) return undefined;
  const bars = figure(modulePlot(runs), 'Total CPU time');
  bars.classList.add('full-width');
  if (runs.length > 1) return section(TITLE, legend(runs), row(bars));
  bars.classList.add('screen-only'); // duplicates the table
  const { timings, frames } = runs[0].figures;
  const lines = Object.entries(timings).map(([name, module]) => [
    name,
    ((1000 * module.wall_s) / Math.max(1, frames)).toFixed(2),
    module.median_ms?.toFixed(2) ?? '',
    module.p95_ms?.toFixed(2) ?? '',
    module.wall_s.toFixed(2),
    module.cpu_s.toFixed(2),
  ]);
  const head = ['module', 'ms per frame', 'ms per call, median', '95th percentile', 'wall time, s', 'CPU time, s'];
  return section(TITLE, row(bars), table(head, lines, [1, 2, 3, 4, 5]));
}

function modulePlot(runs) {
  const spent = runs.flatMap((run, index) =>
    Object.entries(run.figures.timings).map(([module, { cpu_s: seconds }]) => ({ module, seconds, color: run.color, index })),
  );
  const modules = [...new Set(spent.map(({ module }) => module))];
  const letter = 7.2; // pixels, of the widest usual letters
  const options = { x: 'seconds', y: 'index', fy: 'module', fill: 'color', sort: { fy: '-x', reduce: 'sum' } };
  return draw(TITLE, [barX(spent, options), ruleX([0])], {
    width: FULL_WIDTH,
    height: 62 + modules.length * (12 + 12 * runs.length),
    marginLeft: 12 + letter * Math.max(...modules.map((name) => name.length)),
    marginRight: 10,
    color: { type: 'identity' },
    y: { axis: null },
    fy: { label: null, axis: 'left' },
    x: { label: 's' },
  });
}
