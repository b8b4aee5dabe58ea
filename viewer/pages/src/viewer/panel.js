// The buttons and checkboxes, and their actions.

import { Vector3 } from 'three';

import { COLOR_MODES } from '../shared/cloudMaterial.js';
import { lengthText } from '../shared/format.js';
import { ClipBox } from './clipBox.js';
import { Comparison } from './comparison.js';
import { HeightCut } from './cut.js';
import { makeCollapsible } from './drawer.js';
import { listenToKeys } from './keys.js';
import { Loops } from './loops.js';
import { Measures } from './measures.js';
import { Picked } from './picked.js';
import { listenToClicks, pickKeyframe, pickLoop, pickPlace } from './picking.js';
import { RunState } from './runState.js';
import { showScale } from './scaleBar.js';
import { listenToTheme } from './theme.js';

const at = (id) => document.getElementById(id);
const POINT_SIZE_STEP = 0.3;

export class Panel {
  constructor({ world, view, connection, timeline }) {
    Object.assign(this, { world, view, connection, timeline });
    this.state = new RunState();
    this.cut = new HeightCut(at('cut'), at('cutAt'), view);
    this.clip = new ClipBox(document.querySelectorAll('[data-clip]'), view);
    this.measures = new Measures(view, at('measures'));
    this.picked = new Picked(this, at('picked'));
    this.loops = new Loops(this);
    this.comparison = new Comparison(this, () => this.setCamera('orbit'));
    this.listenToRun();
    this.listenToView();
    this.listenToPicks();
    listenToTheme(at('theme'));
    makeCollapsible(at('row'));
    listenToKeys(this.actions(), at('keys'));
    view.onMeasured = () => {
      this.cut.show();
      this.offer();
      at('gridStep').textContent = `(${lengthText(view.floor.stepM)})`;
    };
    view.onDrawn = () => {
      showScale(at('scale'), view.metresPerPixel);
      this.measures.drawLabels();
    };
  }

  listenToRun() {
    at('pause').onclick = () => this.connection.send(this.state.paused ? 'resume' : 'pause');
    at('step').onclick = () => this.connection.send('step');
    at('save').onclick = () => this.connection.send('save');
  }

  listenToView() {
    const { world, view } = this;
    const redraw = (change) => (event) => {
      change(event.target);
      view.dirty = true;
    };
    document.querySelectorAll('[name=camera]').forEach((input) => (input.onchange = () => view.cameraControls.setMode(input.value)));
    at('color').onchange = redraw(({ value }) => (world.uniforms.mode.value = COLOR_MODES.indexOf(value)));
    at('up').onchange = ({ target }) => {
      world.setUp(new Vector3(...target.value.split(' ').map(Number)));
      view.stale = true;
      this.reset();
    };
    at('pointSize').oninput = redraw(({ value }) => (view.pointSizeCm = Number(value)));
    document.querySelectorAll('[data-layer]').forEach((input) => {
      input.onchange = redraw(() => {
        world.layers[input.dataset.layer].visible = input.checked;
        world.moved = true; // pictures are made when they are first shown
      });
    });
    world.pictures.onDecoded = () => (view.dirty = true);
    at('shading').onchange = redraw(({ checked }) => (view.shades = checked));
    at('ceiling').onchange = redraw(({ checked }) => (view.hidesCeiling = checked));
    at('grid').onchange = redraw(({ checked }) => (view.floor.object.visible = checked));
    at('screenshot').onclick = () => this.saveScreenshot();
    at('fit').onclick = () => this.fit();
    at('reset').onclick = () => this.reset();
    at('help').onclick = () => at('helpTable').showModal();
  }

  listenToPicks() {
    const canvas = this.view.renderer.domElement;
    listenToClicks(canvas, (x, y) => this.pick(x, y));
    document.querySelectorAll('[name=tool]').forEach((input) => (input.onchange = () => this.measures.choose(input.value)));
    at('clearMeasures').onclick = () => this.measures.clear();
    at('unclip').onclick = () => this.clip.reset();
  }

  /** What a click at (x, y) does: measures, or shows a keyframe, loop or point. */
  pick(x, y) {
    const { view, picked, measures, loops } = this;
    const keyframe = measures.kind ? undefined : pickKeyframe(view, x, y);
    if (keyframe !== undefined) return picked.showKeyframe(keyframe);
    const place = pickPlace(view, x, y);
    const loop = measures.kind ? undefined : pickLoop(view, x, y, loops.lines, place);
    if (loop !== undefined) return loops.select(loop);
    if (!place) return measures.kind ? undefined : picked.clear();
    return measures.kind ? measures.add(place) : picked.showPlace(place);
  }

  pickCentre() {
    const { clientWidth, clientHeight } = this.view.renderer.domElement;
    this.pick(clientWidth / 2, clientHeight / 2);
  }

  /** Hides the controls that do not apply to what there is. */
  offer() {
    const { world, view } = this;
    document.querySelectorAll('[data-layer]').forEach((input) => (input.closest('label').hidden = !world.has(input.dataset.layer)));
    at('errorFactor').textContent = `\u00d7${world.errorFactor}`;
    at('pointSizeChoice').hidden = !world.has('cloud');
    at('cameraChoice').hidden = !this.state.live && !this.timeline.shown;
    at('ceilingChoice').hidden = view.ceilingM === undefined;
    const colorings = [...at('color').options].filter((option) => !option.hidden);
    at('colorChoice').hidden = !world.has('cloud') || colorings.length < 2;
  }

  /** The actions of keyboard shortcuts, by the names in keys.js. */
  actions() {
    const click = (id) => () => at(id).click();
    const { timeline } = this;
    const buttons = ['step', 'fit', 'reset', 'grid', 'screenshot', 'help', 'shading'];
    const directions = ['oblique', 'top', 'side', 'inside'];
    return {
      ...Object.fromEntries(buttons.map((id) => [id, click(id)])),
      ...Object.fromEntries(directions.map((direction) => [direction, () => this.show(direction)])),
      pause: () => (timeline.shown ? timeline.toggle() : at('pause').click()),
      earlier: ({ shiftKey }) => timeline.step(-1, shiftKey),
      later: ({ shiftKey }) => timeline.step(1, shiftKey),
      first: () => (timeline.shown ? timeline.jump(0) : this.fit()),
      last: () => timeline.jumpToEnd(),
      pickCentre: () => this.pickCentre(),
      nextTool: () => checkNext('tool'),
      clear: () => this.clear(),
      follow: () => this.setCamera('follow'),
      loops: () => document.querySelector('[data-layer=loops]').click(),
      nextSurface: () => this.showNextSurface(),
      nextLoop: ({ shiftKey }) => this.loops.list.step(shiftKey ? -1 : 1),
      nextObject: ({ shiftKey }) => this.comparison.list.step(shiftKey ? -1 : 1),
      close: () => this.close(),
      nextColor: () => selectNext(at('color')),
      nextUp: () => at('upChoice').hidden || selectNext(at('up')),
      lowerCut: () => this.cut.move(-1),
      raiseCut: () => this.cut.move(1),
      smallerPoints: () => this.resizePoints(-POINT_SIZE_STEP),
      largerPoints: () => this.resizePoints(POINT_SIZE_STEP),
    };
  }

  /** Shows the mesh instead of cloud and mesh, then the cloud, then both again, if there are both. */
  showNextSurface() {
    const [cloud, mesh] = ['cloud', 'mesh'].map((layer) => document.querySelector(`[data-layer=${layer}]`));
    if (!this.world.has('cloud') || !this.world.has('mesh')) return;
    const next = cloud.checked === mesh.checked ? (cloud.checked ? [false, true] : [true, true]) : [true, !mesh.checked];
    [cloud, mesh].forEach((box, i) => box.checked === next[i] || box.click());
  }

  setCamera(mode) {
    const input = document.querySelector(`[name=camera][value=${mode}]`);
    if (!input.checked) input.click();
  }

  show(direction) {
    this.setCamera('orbit');
    this.view.cameraControls.show(direction);
  }

  fit() {
    this.setCamera('orbit');
    const { cameraControls } = this.view;
    if (cameraControls.direction === 'inside') cameraControls.setManualControl(); // steps back until all is in view
    cameraControls.fit(this.view.contents());
  }

  /** Removes all measures and what is shown of a click. */
  clear() {
    this.measures.clear();
    this.picked.clear();
    this.close();
  }

  /** Deselects a loop and an object. */
  close() {
    this.loops.deselect();
    this.comparison.deselect();
  }

  /** Restores the initial view. */
  reset() {
    this.clip.reset();
    this.cut.set(Infinity);
    this.show(this.home);
  }

  resizePoints(step) {
    at('pointSize').value = Number(at('pointSize').value) + step;
    at('pointSize').oninput({ target: at('pointSize') });
  }

  async saveScreenshot() {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(await this.view.screenshot());
    link.download = 'kinloop.png';
    link.click();
    URL.revokeObjectURL(link.href);
  }

  greet({ input, live, upKnown = true, colors = COLOR_MODES }) {
    document.title = `${input} - kinloop`;
    at('input').textContent = input;
    this.state.greet({ live });
    at('upChoice').hidden = upKnown;
    this.view.isOriented = upKnown;
    this.home = live || !upKnown ? 'oblique' : 'inside'; // a growing map is best seen as a whole
    this.view.cameraControls.direction = this.home;
    for (const option of at('color').options) option.hidden = option.disabled = !colors.includes(option.value);
    if (!colors.includes(at('color').value)) select(at('color'), colors[0]);
  }

  /** Shows a short notification. */
  flash(text) {
    const flash = at('flash');
    flash.textContent = text;
    flash.classList.remove('on');
    void flash.offsetWidth; // restarts the animation
    flash.classList.add('on');
  }
}

function select(list, value) {
  list.value = value;
  list.onchange({ target: list });
}

/** Checks the next of the radio buttons with that name. */
function checkNext(name) {
  const inputs = [...document.querySelectorAll(`[name=${name}]`)];
  inputs[(inputs.findIndex(({ checked }) => checked) + 1) % inputs.length].click();
}

/** Among the enabled options. */
function selectNext(list) {
  const possible = [...list.options].filter((option) => !option.disabled);
  const next = possible[(possible.indexOf(list.selectedOptions[0]) + 1) % possible.length];
  select(list, next.value);
}
