// The scale bar: the length of a metre at the centre of the view.

import { lengthText } from '../shared/format.js';
import { roundLength } from './framing.js';

const LONGEST_PX = 150;

/** Draws the bar into `element`, whose first child is the line and whose last is the text. */
export function showScale(element, metresPerPixel) {
  const lengthM = roundLength(LONGEST_PX * metresPerPixel);
  element.firstElementChild.style.width = `${lengthM / metresPerPixel}px`;
  element.lastElementChild.textContent = lengthText(lengthM);
}
