// Pictures: the map (Fig. 7a of docs/lab/paper.md), and the detected loops, with what became of each.

import { LOOP_STATUSES, reasonText, scaleText } from '../shared/loops.js';
import { element, figure, row, section, table } from './page.js';

const MOST_PRINTED = 4;

export function mapSection([run]) {
  if (run.mapPictures.length === 0) return undefined;
  return section('Map', row(...run.mapPictures.map(picture)));
}

export function loopSection([run]) {
  const parts = [...loopPictures(run), loopTable(run)].filter(Boolean);
  return parts.length > 0 ? section('Loop closures', ...parts) : undefined;
}

/** What became of all loops, the earliest first; folded, since there may be many. */
function loopTable({ figures, startS }) {
  const lists = [figures.loops, figures.other_loops].map((list) => (Array.isArray(list) ? list : []));
  const loops = lists.flat().filter((loop) => LOOP_STATUSES.includes(loop?.status));
  if (loops.length === 0) return undefined;
  const since = (stamp) => (Number(stamp) - startS).toFixed(2);
  const latest = ({ stamp_a, stamp_b }) => Math.max(Number(stamp_a), Number(stamp_b));
  const rows = loops
    .sort((a, b) => latest(a) - latest(b))
    .map((loop) => [loop.status, since(loop.stamp_a), since(loop.stamp_b), `${loop.support ?? ''}`, `${loop.inliers ?? ''}`, scaleText(loop.scale), reasonText(loop.reason)]);
  const counts = LOOP_STATUSES.map((status) => [status, loops.filter((loop) => loop.status === status).length]);
  const what = counts.filter(([, n]) => n > 0).map(([status, n]) => `${n} ${status}`).join(', ');
  const head = ['status', 'one end, s', 'other end, s', 'keyframes that agree', 'inliers', 'scale', 'reason'];
  return element('details', {}, element('summary', {}, `all loops: ${what}`), table(head, rows, [1, 2, 3, 4, 5]));
}

function loopPictures(run) {
  const pictures = run.loopPictures;
  if (pictures.length === 0) return [];
  const what =
    'Two keyframes per loop, the earlier one on the left. Landmarks of the left image are reprojected into the right one ' +
    'with the final map and poses; each keeps its colour. Filled: observed in both images (lines join some of them). ' +
    'Rings: predicted in the right image, but not matched there.';
  const shown = row(...pictures.map(picture));
  shown.classList.add('loops');
  [...shown.children].forEach((child, i) => isPrinted(i, pictures.length) || child.classList.add('screen-only'));
  return [element('p', { class: 'soft' }, what), shown];
}

/** Selects evenly spaced pictures for print. */
function isPrinted(i, count) {
  if (count <= MOST_PRINTED) return true;
  return Math.floor((i * MOST_PRINTED) / count) !== Math.floor(((i - 1) * MOST_PRINTED) / count);
}

function picture({ caption, jpeg }) {
  return figure(element('img', { alt: caption, src: `data:image/jpeg;base64,${jpeg}` }), caption);
}
