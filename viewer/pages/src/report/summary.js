// Summary of a run with its figures; for several runs as a table.

import { count, millimetres } from '../shared/format.js';
import { adviceLine, verdictLine, warningLines } from './doubt.js';
import { element, section, table } from './page.js';

/** Every figure: its name, and its text for a run, or nothing if unknown. */
const FIGURES = [
  ['quality', ({ figures: f }, index, runs) => runs.length > 1 && f.quality?.verdict],
  ['tracked frames', ({ figures: f }) => f.frames && `${count(f.tracked)} of ${count(f.frames)}`],
  ['ATE RMSE', ({ evaluation: e }) => e && millimetres(e.ate.rmse_m)],
  ['ATE RMSE as given live', ({ figures: f }) => f.evaluation?.live && millimetres(f.evaluation.live.ate.rmse_m)],
  ['max ATE', ({ evaluation: e }) => e && millimetres(e.ate.max_m)],
  ['RPE RMSE over 1 s', ({ evaluation: e }) => e?.rpe_1s && `${millimetres(e.rpe_1s.translation.rmse_m)}, ${e.rpe_1s.rotation.rmse_deg.toFixed(2)}\u00b0`],
  ['RPE RMSE frame to frame', ({ evaluation: e }) => e?.rpe_frame && `${millimetres(e.rpe_frame.translation.rmse_m)}, ${e.rpe_frame.rotation.rmse_deg.toFixed(2)}\u00b0`],
  ['keyframes', ({ figures: f }) => count(f.keyframes)],
  ['landmarks', ({ figures: f }) => count(f.landmarks)],
  ['loop closures', ({ figures: f }) => f.loops && String(f.loops.length)],
  ['map points', ({ figures: f }) => count(f.map?.points)],
  ['median time per frame', ({ figures: f }) => f.frame_ms && `${f.frame_ms.median.toFixed(1)} ms`],
  ['95th percentile of time per frame', ({ figures: f }) => f.frame_ms && `${f.frame_ms.p95.toFixed(1)} ms`],
  ['latency from image to pose: median, 99 %, longest', ({ figures: f }) => f.latency_ms && `${f.latency_ms.median.toFixed(1)}, ${f.latency_ms.p99.toFixed(1)}, ${f.latency_ms.longest.toFixed(1)} ms`],
  ['wall time', ({ figures: f }) => f.wall_s && `${f.wall_s.toFixed(1)} s`],
  ['CPU time', ({ figures: f }) => f.cpu_s && `${f.cpu_s.toFixed(1)} s`],
  ['peak memory', ({ figures: f }) => f.peak_memory_mib && `${Math.round(f.peak_memory_mib)} MiB`],
];

export function headSection(runs) {
  const title = runs.length === 1 ? runs[0].name : `Comparison of ${runs.length} runs`;
  const lines = runs.length === 1 ? [verdictLine(runs[0]), ...warningLines(runs[0]), adviceLine(runs[0])] : [];
  return element('header', {}, element('h1', {}, title), ...lines, element('p', { class: 'soft' }, runs.map(subtitle).join(' \u00b7 ')));
}

function subtitle({ name, path }, _, runs) {
  const { t, x, y, z } = path;
  if (t.length === 0) return 'no tracked frames';
  const length = t.slice(1).reduce((sum, _, i) => sum + Math.hypot(x[i + 1] - x[i], y[i + 1] - y[i], z[i + 1] - z[i]), 0);
  const text = `${(t.at(-1) - t[0]).toFixed(1)} s, trajectory length ${length.toFixed(2)} m`;
  return runs.length === 1 ? text : `${name}: ${text}`;
}

export function summarySection(runs) {
  const known = FIGURES.map(([name, text]) => [name, ...runs.map(text)]).filter((line) => line.slice(1).some(Boolean));
  if (known.length === 0) return undefined;
  if (runs.length > 1) {
    const cells = known.map((line) => line.map((cell) => cell || '\u2013'));
    return section('Results', table(['', ...runs.map((run) => run.name)], cells, runs.map((_, i) => i + 1)));
  }
  const tile = ([name, text]) => element('div', { class: 'tile' }, element('b', {}, text), element('small', {}, name));
  return element('section', { class: 'tiles' }, ...known.map(tile));
}
