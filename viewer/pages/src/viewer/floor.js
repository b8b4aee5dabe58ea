// A grid on the floor, with lines at whole steps of 1, 2 or 5.

import { Vector3 } from 'three';

import { roundLength } from './framing.js';
import { Lines } from './lines.js';

const CELLS = 4; // minimum along the longer side
const MARGIN_CELLS = 1;

export class Floor {
  constructor() {
    this.lines = new Lines({ color: 0x8a93a3, segments: true, opacity: 0.35 });
    this.stepM = 1;
  }

  get object() {
    return this.lines.object;
  }

  /** Places the grid under the box. */
  lay({ min, max }) {
    this.stepM = roundLength(Math.max(max.x - min.x, max.z - min.z, 1e-3) / CELLS);
    const [left, right] = this.span(min.x, max.x);
    const [near, far] = this.span(min.z, max.z);
    this.lines.fill((add) => {
      for (let i = left; i <= right; ++i) this.addLine(add, [i, near], [i, far], min.y);
      for (let i = near; i <= far; ++i) this.addLine(add, [left, i], [right, i], min.y);
    });
  }

  /** Indices of the first and the last line. */
  span(min, max) {
    return [Math.floor(min / this.stepM) - MARGIN_CELLS, Math.ceil(max / this.stepM) + MARGIN_CELLS];
  }

  addLine(add, from, to, height) {
    for (const [x, z] of [from, to]) add(new Vector3(x * this.stepM, height, z * this.stepM));
  }
}
