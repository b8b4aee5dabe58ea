// Configuration of the run: options, sensor, versions.

import { element, section, table } from './page.js';

export function detailsSection(runs) {
  const parts = runs.flatMap((run) => [options(run, runs), sensor(run)]).filter(Boolean);
  const version = runs[0].figures.version;
  if (version) parts.push(element('div', { class: 'version' }, ...version.trim().split('\n').map((line) => element('div', {}, line))));
  return parts.length > 0 ? section('Configuration', ...parts) : undefined;
}

/** All options of the first run; for the others only those that differ. */
function options({ name, figures }, runs) {
  const first = runs[0].figures.options ?? {};
  const all = Object.entries(figures.options ?? {});
  const shown = figures === runs[0].figures ? all : all.filter(([key, value]) => first[key] !== value);
  if (all.length === 0) return undefined;
  const what = shown === all ? `options (${all.length})` : `options that differ from the first run (${shown.length})`;
  const rows = shown.map(([key, value]) => [key, String(value)]);
  return element('details', {}, element('summary', {}, `${name}: ${what}`), table(['option', 'value'], rows));
}

function sensor({ name, figures }) {
  const rows = Object.entries({ ...camera(figures.camera), ...figures.sensor }).map(([key, { value, sigma }]) => [
    key,
    value.toPrecision(6),
    sigma === undefined ? '' : `\u00b1 ${sigma.toPrecision(2)}`,
  ]);
  if (rows.length === 0) return undefined;
  return element('details', {}, element('summary', {}, `${name}: camera and estimated sensor parameters`), table(['parameter', 'value', 'standard deviation'], rows, [1, 2]));
}

function camera(camera = {}) {
  return Object.fromEntries(Object.entries(camera).map(([key, value]) => [key, { value }]));
}
