// Absolute trajectory error: over time, and as a histogram.

import { binX, line, rectY, ruleY } from '@observablehq/plot';

import { doubtCaption, doubtMarks } from './doubt.js';
import { figure, legend, row, section } from './page.js';
import { draw, extent, outline, rows } from './plot.js';

export function errorSection(all) {
  const runs = all.filter((run) => run.errors);
  if (runs.length === 0) return undefined;
  const { ate } = runs[0].evaluation;
  const mm = (metres) => (1000 * metres).toFixed(1);
  const single = `median ${mm(ate.median_m)} mm, mean ${mm(ate.mean_m)} mm, RMSE ${mm(ate.rmse_m)} mm, max ${mm(ate.max_m)} mm`;
  return section(
    'Absolute trajectory error',
    all.length > 1 ? legend(runs) : undefined,
    row(
      figure(overTime(runs), `ATE over time; dashed: RMSE${liveCaption(runs)}${doubtCaption(runs)}`),
      figure(histogram(runs), `Error histogram${all.length > 1 ? '' : `: ${single}`}`),
    ),
  );
}

function overTime(runs) {
  const marks = runs.flatMap((run) => [
    line(outline(rows(run.errors), 'mm'), { x: 't', y: 'mm', stroke: run.color, strokeWidth: 1.3 }),
    ruleY([1000 * run.evaluation.ate.rmse_m], { stroke: run.color, strokeDasharray: '5 4' }),
  ]);
  if (live(runs)) marks.unshift(line(outline(rows(live(runs)), 'mm'), { x: 't', y: 'mm', stroke: 'var(--live)', strokeWidth: 1 }));
  return draw('ATE over time', [doubtMarks(runs), ...marks], { x: { label: 's' }, y: { label: 'mm', domain: fromZero(runs) } });
}

/** The errors of the poses as they were given live; of several runs they would hide the others. */
function live(runs) {
  return runs.length === 1 ? runs[0].liveErrors : undefined;
}

function liveCaption(runs) {
  if (!live(runs)) return '';
  const { mm } = live(runs);
  const rmse = Math.sqrt(mm.reduce((sum, error) => sum + error * error, 0) / mm.length);
  return `; purple: as given live, RMSE ${rmse.toFixed(1)} mm`;
}

function histogram(runs) {
  const bins = { x: 'mm', thresholds: 30, domain: fromZero(runs) };
  const marks = runs.map((run) =>
    runs.length === 1
      ? rectY(rows(run.errors), binX({ y: 'count' }, { ...bins, fill: run.color }))
      : line(rows(run.errors), binX({ y: 'count' }, { ...bins, stroke: run.color, curve: 'step' })),
  );
  return draw('Error histogram', [...marks, ruleY([0])], { x: { label: 'mm' }, y: { label: 'poses' } });
}

function fromZero(runs) {
  const mm = runs.flatMap((run) => run.errors.mm).concat(live(runs)?.mm ?? []);
  return [0, extent(mm)[1] || 1];
}
