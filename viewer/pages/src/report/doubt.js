// The verdict on a run, and its doubtful and lost stretches on every plot over time.

import { rect } from '@observablehq/plot';

import { element } from './page.js';

const COLORS = { doubtful: 'var(--doubt)', lost: 'var(--bad)' };
const NONE = { t: [], status: [] };
const MOST_STRETCHES = 500; // far more than can be told apart

/** The verdict in a line, or nothing for a run of an earlier version. */
export function verdictLine({ figures: { quality } }) {
  if (!quality?.verdict) return undefined;
  const reasons = (quality.reasons ?? []).join('; ');
  return element('p', { class: `verdict ${quality.verdict}` }, element('b', {}, `quality: ${quality.verdict}`), reasons && ` ${reasons}`);
}

/** Where the input of a run contradicts itself, a line each; nothing if it does not. */
export function warningLines({ figures: { warnings } }) {
  return (warnings ?? []).map(({ evidence, remedy }) => element('p', { class: 'verdict doubtful' }, element('b', {}, 'warning:'), ` ${evidence}; ${remedy}`));
}

/** What spoiled the recording of a run, and for how long, a line for all of it; nothing if nothing did. */
export function adviceLine({ figures: { advice } }) {
  if (!advice?.length) return undefined;
  const hints = advice.map(({ seconds, advice: text }) => `${text} (${seconds.toFixed(1)} s)`);
  return element('p', { class: 'verdict' }, element('b', {}, 'while recording:'), ` ${hints.join('; ')}`);
}

/** Marks that shade the stretches of runs over the whole height of a plot. */
export function doubtMarks(runs) {
  const found = runs.flatMap(stretches);
  return Object.entries(COLORS).map(([name, fill]) =>
    rect(found.filter(({ status }) => status === name), { x1: 'from', x2: 'to', fill, fillOpacity: 0.3 }),
  );
}

/** What the shades mean, with the numbers of frames; empty if there are none. */
export function doubtCaption(runs) {
  const counted = (status) => runs.reduce((sum, { frames = NONE }) => sum + frames.status.filter((one) => one === status).length, 0);
  const [doubtful, lost] = [counted('doubtful'), counted('lost')];
  return [doubtful && `; orange: doubtful (${doubtful} frames)`, lost && `; red: tracking lost (${lost} frames)`].filter(Boolean).join('');
}

/** Successive frames of one status: { status, from, to }, in seconds; the longest, if there are too many. */
function stretches({ frames: { t, status } = NONE }) {
  const found = [];
  status.forEach((one, i) => {
    if (!COLORS[one]) return;
    const to = t[i + 1] ?? t[i] + (i > 0 ? t[i] - t[i - 1] : 0);
    if (i > 0 && status[i - 1] === one) found.at(-1).to = to;
    else found.push({ status: one, from: t[i], to });
  });
  return found.sort((a, b) => b.to - b.from - (a.to - a.from)).slice(0, MOST_STRETCHES);
}
