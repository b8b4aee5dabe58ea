// Per frame: features and processing time.

import { line, ruleY } from '@observablehq/plot';

import { doubtCaption, doubtMarks } from './doubt.js';
import { figure, legend, row, section } from './page.js';
import { draw, outline, quantile, rows } from './plot.js';

export function trackingSection(all) {
  const runs = all.filter((run) => run.frames.t.length > 0);
  if (runs.length === 0) return undefined;
  const seen = runs.length === 1 ? 'Features: detected (grey) and matched to landmarks (blue)' : 'Features matched to landmarks of the map';
  return section(
    'Tracking',
    all.length > 1 ? legend(runs) : undefined,
    row(
      figure(features(runs), `${seen}${doubtCaption(runs)}`),
      figure(times(runs), 'Time per frame; dashed: median'),
    ),
  );
}

function features(runs) {
  const marks = [doubtMarks(runs)];
  for (const run of runs) {
    const frames = rows(run.frames);
    if (runs.length === 1) marks.push(line(outline(frames, 'features'), { x: 't', y: 'features', stroke: 'var(--truth)', strokeWidth: 1 }));
    marks.push(line(outline(frames, 'tracked'), { x: 't', y: 'tracked', stroke: run.color, strokeWidth: 1.2 }));
  }
  return draw('Features over time', [...marks, ruleY([0])], { x: { label: 's' }, y: { label: 'features' } });
}

function times(runs) {
  const most = Math.max(...runs.map((run) => 1.5 * quantile(run.frames.ms, 0.99)));
  const marks = runs.flatMap((run) => [
    line(outline(rows(run.frames), 'ms'), { x: 't', y: ({ ms }) => Math.min(ms, most), stroke: run.color, strokeWidth: 1 }),
    ruleY([quantile(run.frames.ms, 0.5)], { stroke: run.color, strokeDasharray: '5 4' }),
  ]);
  return draw('Time per frame', [doubtMarks(runs), ...marks], { x: { label: 's' }, y: { label: 'ms', domain: [0, most] } });
}
