// Line drawings: frusta, paths, edges. Each is one buffer that grows by doubling and is refilled when
// something moves.

import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, LineSegments } from 'three';

import { LINES } from './eyeDome.js';

/** Lines through changing points; `segments`: each two points form a separate line. */
export class Lines {
  constructor({ color, segments = false, opacity = 1 }) {
    const material = new LineBasicMaterial({ color, transparent: opacity < 1, opacity });
    const Kind = segments ? LineSegments : Line;
    this.object = new Kind(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.object.layers.set(LINES);
    this.reserve(64);
    this.fill(() => {});
  }

  reserve(points) {
    this.object.geometry.dispose(); // the renderer's copy of the buffer so far
    this.attribute = new BufferAttribute(new Float32Array(3 * points), 3);
    this.object.geometry.setAttribute('position', this.attribute);
  }

  /** `draw(add)` calls add(point) for every point. */
  fill(draw) {
    const points = [];
    draw((point) => points.push(point.x, point.y, point.z));
    if (points.length > this.attribute.array.length) this.reserve(2 * (points.length / 3));
    this.attribute.array.set(points);
    this.attribute.needsUpdate = true;
    this.object.geometry.setDrawRange(0, points.length / 3);
  }
}
