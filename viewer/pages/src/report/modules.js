// Where the time went.

import { barX, ruleX } from '@observablehq/plot';

import { figure, legend, row, section, table } from './page.js';
import { draw } from './plot.js';

export function roomSection(all) {
  const runs = all.filter((run) => Object.keys(run.figures.rooms ?? {}).length > 0);
  if (runs.length === 0) return undefined;
  const bars = figure(roomPlot(runs), 'CPU seconds in all; the medians are of pieces of work, frames or keyframes');
  if (runs.length > 1) return section('Where the time went', legend(runs), row(bars));
  const { rooms, frames } = runs[0].figures;
  const lines = Object.entries(rooms).map(([name, room]) => [
    name,
    ((1000 * room.wall_s) / Math.max(1, frames)).toFixed(2),
    room.median_ms?.toFixed(2) ?? '',
    room.p95_ms?.toFixed(2) ?? '',
    room.wall_s.toFixed(2),
    room.cpu_s.toFixed(2),
  ]);
  const head = ['room', 'ms a frame', 'median, ms', '95 %, ms', 'wall s', 'CPU s'];
  return section('Where the time went', row(bars, table(head, lines, [1, 2, 3, 4, 5])));
}

function roomPlot(runs) {
  const spent = runs.flatMap((run, index) =>
    Object.entries(run.figures.rooms).map(([room, { cpu_s: seconds }]) => ({ room, seconds, color: run.color, index })),
  );
  const rooms = new Set(spent.map(({ room }) => room)).size;
  const options = { x: 'seconds', y: 'index', fy: 'room', fill: 'color', sort: { fy: '-x', reduce: 'sum' } };
  return draw('CPU seconds by room', [barX(spent, options), ruleX([0])], {
    height: 50 + rooms * (12 + 12 * runs.length),
    marginLeft: 110,
    marginRight: 10,
    color: { type: 'identity' },
    y: { axis: null },
    fy: { label: null, axis: 'left' },
    x: { label: 's' },
  });
}
