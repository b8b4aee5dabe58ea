// Pictures: the map (Fig. 7a of the founding paper), and the places that were recognised.

import { element, figure, row, section } from './page.js';

export function mapSection([run]) {
  if (run.mapPictures.length === 0) return undefined;
  return section('Map', row(...run.mapPictures.map(picture)));
}

export function loopSection([run]) {
  if (run.loopPictures.length === 0) return undefined;
  return section('Loops', row(...run.loopPictures.map(picture)));
}

function picture({ caption, jpeg }) {
  return figure(element('img', { alt: caption, src: `data:image/jpeg;base64,${jpeg}` }), caption);
}
