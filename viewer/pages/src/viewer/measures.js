// Distances, angles and heights between points of the map, drawn in the scene and listed in the panel.

import { Vector3 } from 'three';
import { CSS2DObject, CSS2DRenderer } from 'three/examples/jsm/renderers/CSS2DRenderer.js';

import { lengthText } from '../shared/format.js';
import { Lines } from './lines.js';

const MARK_PX = 7;

/** What is measured: the number of points, and { text, lines: pairs of points, at: place of the label }. */
const KINDS = {
  distance: { points: 2, measure: ([a, b]) => ({ text: lengthText(a.distanceTo(b)), lines: [a, b], at: middle(a, b) }) },
  angle: {
    points: 3,
    measure: ([a, corner, b]) => {
      const angle = a.clone().sub(corner).angleTo(b.clone().sub(corner));
      return { text: `${((180 / Math.PI) * angle).toFixed(1)}\u00b0`, lines: [a, corner, corner, b], at: corner };
    },
  },
  height: {
    points: 2,
    measure: ([a, b]) => {
      const above = new Vector3(a.x, b.y, a.z);
      return { text: `${lengthText(Math.abs(b.y - a.y))} high`, lines: [a, above, above, b], at: middle(a, above) };
    },
  },
};

export class Measures {
  /** Draws in `view`; lists in `list`, an <ol>. */
  constructor(view, list) {
    Object.assign(this, { view, list });
    this.kind = undefined; // none: clicks do not measure
    this.pending = [];
    this.done = [];
    this.lines = new Lines({ color: 0xffc400, segments: true });
    this.lines.object.material.depthTest = false; // visible through walls
    this.lines.object.renderOrder = 2;
    view.scene.add(this.lines.object);
    this.labels = new CSS2DRenderer({ element: document.getElementById('labels') });
    this.show();
  }

  /** Measures 'distance', 'angle' or 'height' from here on; undefined: nothing. */
  choose(kind) {
    this.kind = KINDS[kind] && kind;
    this.pending = [];
    this.show();
  }

  /** Takes the next point. */
  add(place) {
    this.pending.push(place);
    const { points, measure } = KINDS[this.kind];
    if (this.pending.length === points) {
      const measured = { kind: this.kind, ...measure(this.pending) };
      measured.label = labelAt(measured.at, measured.text);
      this.view.scene.add(measured.label);
      this.done.push(measured);
      this.pending = [];
    }
    this.show();
  }

  remove(measured) {
    this.view.scene.remove(measured.label);
    this.done = this.done.filter((other) => other !== measured);
    this.show();
  }

  clear() {
    this.done.forEach(({ label }) => this.view.scene.remove(label));
    this.done = [];
    this.pending = [];
    this.show();
  }

  show() {
    this.list.replaceChildren(...this.done.map((measured) => this.entry(measured)));
    this.drawMarks();
    this.view.dirty = true;
  }

  entry(measured) {
    const [entry, remove] = [document.createElement('li'), document.createElement('button')];
    remove.textContent = '\u00d7';
    remove.setAttribute('aria-label', `Remove ${measured.text}`);
    remove.onclick = () => this.remove(measured);
    entry.append(`${measured.kind} ${measured.text.replace(' high', '')} `, remove);
    return entry;
  }

  /** Lines of all measures, and crosses at the points taken so far. */
  drawMarks() {
    this.lines.fill((add) => {
      this.done.forEach(({ lines }) => lines.forEach(add));
      for (const place of this.pending) {
        const size = (MARK_PX * this.view.cameraControls.camera.position.distanceTo(place)) / this.view.pixelsPerRadian;
        for (const axis of [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)]) {
          add(place.clone().addScaledVector(axis, size));
          add(place.clone().addScaledVector(axis, -size));
        }
      }
    });
  }

  /** Draws the labels over the view. */
  drawLabels() {
    if (this.done.length === 0) return;
    const { clientWidth, clientHeight } = this.view.renderer.domElement;
    this.labels.setSize(clientWidth, clientHeight);
    this.labels.render(this.view.scene, this.view.cameraControls.camera);
  }
}

function middle(a, b) {
  return a.clone().lerp(b, 0.5);
}

function labelAt(place, text) {
  const label = new CSS2DObject(Object.assign(document.createElement('span'), { textContent: text, className: 'measure' }));
  label.position.copy(place);
  return label;
}
