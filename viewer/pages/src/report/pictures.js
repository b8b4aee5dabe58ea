// Pictures: the map (Fig. 7a of docs/paper.md), and the detected loops.

import { element, figure, row, section } from './page.js';

const MOST_PRINTED = 4;

export function mapSection([run]) {
  if (run.mapPictures.length === 0) return undefined;
  return section('Map', row(...run.mapPictures.map(picture)));
}

export function loopSection([run]) {
  const pictures = run.loopPictures;
  if (pictures.length === 0) return undefined;
  const what =
    'Two keyframes per loop, the earlier one on the left. Landmarks of the left image are reprojected into the right one ' +
    'with the final map and poses; each keeps its colour. Filled: observed in both images (lines join some of them). ' +
    'Rings: predicted in the right image, but not matched there.';
  const shown = row(...pictures.map(picture));
  shown.classList.add('loops');
  [...shown.children].forEach((child, i) => isPrinted(i, pictures.length) || child.classList.add('screen-only'));
  return section('Loop closures', element('p', { class: 'soft' }, what), shown);
}

/** Selects evenly spaced pictures for print. */
function isPrinted(i, count) {
  if (count <= MOST_PRINTED) return true;
  return Math.floor((i * MOST_PRINTED) / count) !== Math.floor(((i - 1) * MOST_PRINTED) / count);
}

function picture({ caption, jpeg }) {
  return figure(element('img', { alt: caption, src: `data:image/jpeg;base64,${jpeg}` }), caption);
}
