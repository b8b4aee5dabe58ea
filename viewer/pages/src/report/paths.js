// The trajectory in top and side view, over ground truth (Fig. 7b and 7c of docs/lab/paper.md).

import { dot, line, link } from '@observablehq/plot';

import { figure, legend, row, section } from './page.js';
import { buckets, draw, evenRanges, rows } from './plot.js';

const GAP_S = 0.5; // frames further apart are not connected

export function pathSection(runs) {
  if (runs.every((run) => run.path.t.length === 0)) return undefined;
  const truth = runs.find((run) => run.truth)?.truth;
  const others = [
    ...(truth ? [['ground truth', 'var(--truth)']] : []),
    ...(showsLive(runs) ? [['as given live', 'var(--live)']] : []),
    ['loop closures', 'var(--loop)'],
  ];
  const view = (name, up) => figure(pathPlot(name, runs, truth, up), name);
  return section('Trajectory', legend(runs, ...others), row(view('Top view', 'y'), view('Side view', 'z')));
}

/** Of several runs the live poses would hide the others. */
function showsLive(runs) {
  return runs.length === 1 && runs[0].live.t.length > 0;
}

function pathPlot(name, runs, truth, up) {
  const all = [...runs.map((run) => run.path), ...(truth ? [truth] : [])];
  const ranges = evenRanges(all.flatMap(({ x }) => x), all.flatMap((path) => path[up]));
  const marks = truth ? [line(pieces(truth), { x: 'x', y: up, z: 'piece', stroke: 'var(--truth)', strokeWidth: 3 })] : [];
  if (showsLive(runs)) marks.push(line(pieces(runs[0].live), { x: 'x', y: up, z: 'piece', stroke: 'var(--live)', strokeWidth: 1 }));
  for (const run of runs) {
    marks.push(line(pieces(run.path), { x: 'x', y: up, z: 'piece', stroke: run.color, strokeWidth: 1.5 }));
    if (runs.length === 1) marks.push(dot(rows(run.keyframes), { x: 'x', y: up, r: 1.6, fill: run.color }));
    const end = (side, axis) => (pair) => run.keyframes[axis][pair[side]];
    marks.push(link(run.loops, { x1: end(0, 'x'), y1: end(0, up), x2: end(1, 'x'), y2: end(1, up), stroke: 'var(--loop)', strokeWidth: 1.5 }));
  }
  return draw(name, marks, {
    aspectRatio: 1,
    height: undefined,
    x: { domain: ranges.x, label: 'm', clamp: true },
    y: { domain: ranges.y, label: 'm', clamp: true },
  });
}

/** The places of a path, with the index of their segment: tracking loss separates segments. */
function pieces(path) {
  let piece = 0;
  const places = rows(path).map((place, i, all) => {
    if (i > 0 && place.t - all[i - 1].t > GAP_S) ++piece;
    return { ...place, piece };
  });
  return buckets(places).map(([first]) => first);
}
