// How far the path is from the true one: over time, and how often how far.

import { binX, line, rectY, ruleY } from '@observablehq/plot';

import { figure, legend, row, section } from './page.js';
import { draw, rows } from './plot.js';

export function errorSection(all) {
  const runs = all.filter((run) => run.errors);
  if (runs.length === 0) return undefined;
  const { ate } = runs[0].evaluation;
  const mm = (metres) => (1000 * metres).toFixed(1);
  const single = `median ${mm(ate.median_m)} mm, mean ${mm(ate.mean_m)} mm, rmse ${mm(ate.rmse_m)} mm, at most ${mm(ate.max_m)} mm`;
  return section(
    'Error',
    all.length > 1 ? legend(runs) : undefined,
    row(
      figure(overTime(runs), 'Distance from the truth over time; dashed: rmse'),
      figure(histogram(runs), `How often which distance${all.length > 1 ? '' : `: ${single}`}`),
    ),
  );
}

function overTime(runs) {
  const marks = runs.flatMap((run) => [
    line(rows(run.errors), { x: 't', y: 'mm', stroke: run.color, strokeWidth: 1.3 }),
    ruleY([1000 * run.evaluation.ate.rmse_m], { stroke: run.color, strokeDasharray: '5 4' }),
  ]);
  return draw('Distance from the truth over time', marks, { x: { label: 's' }, y: { label: 'mm', domain: fromZero(runs) } });
}

function histogram(runs) {
  const bins = { x: 'mm', thresholds: 30, domain: fromZero(runs) };
  const marks = runs.map((run) =>
    runs.length === 1
      ? rectY(rows(run.errors), binX({ y: 'count' }, { ...bins, fill: run.color }))
      : line(rows(run.errors), binX({ y: 'count' }, { ...bins, stroke: run.color, curve: 'step' })),
  );
  return draw('Histogram of the distance from the truth', [...marks, ruleY([0])], { x: { label: 'mm' }, y: { label: 'poses' } });
}

function fromZero(runs) {
  return [0, Math.max(...runs.flatMap((run) => run.errors.mm)) || 1];
}
