// The figures, the buttons and the keys.

import { COLOR_MODES } from '../shared/cloudMaterial.js';
import { count, millimetres } from '../shared/format.js';

const at = (id) => document.getElementById(id);

export class Panel {
  constructor({ world, view, connection }) {
    Object.assign(this, { world, view, connection });
    this.paused = false;
    this.listenToRun();
    this.listenToView();
    addEventListener('keydown', (event) => this.press(event));
  }

  listenToRun() {
    at('pause').onclick = () => this.connection.send(this.paused ? 'resume' : 'pause');
    at('step').onclick = () => this.connection.send('step');
    at('save').onclick = () => this.connection.send('save');
  }

  listenToView() {
    const { world, view } = this;
    const redraw = (change) => (event) => {
      change(event.target);
      view.dirty = true;
    };
    document.querySelectorAll('[name=camera]').forEach((input) => (input.onchange = () => view.setMode(input.value)));
    at('color').onchange = redraw(({ value }) => (world.uniforms.mode.value = COLOR_MODES.indexOf(value)));
    at('pointSize').oninput = redraw(({ value }) => (view.pointSizeCm = Number(value)));
    at('cut').oninput = redraw(({ value }) => {
      view.cutShare = Number(value);
      view.measure();
    });
    document.querySelectorAll('[data-layer]').forEach((input) => {
      input.onchange = redraw(() => (world.layers[input.dataset.layer].visible = input.checked));
    });
    at('screenshot').onclick = () => this.saveScreenshot();
    at('home').onclick = () => {
      view.touched = false;
      view.showAll();
    };
  }

  press(event) {
    if (event.target.matches('input, select') || event.ctrlKey || event.metaKey || event.altKey) return;
    const button = { ' ': 'pause', s: 'step', p: 'screenshot', h: 'home' }[event.key];
    if (!button) return;
    event.preventDefault();
    at(button).click();
  }

  async saveScreenshot() {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(await this.view.screenshot());
    link.download = 'kinloop.png';
    link.click();
    URL.revokeObjectURL(link.href);
  }

  greet({ input, live }) {
    document.title = `${input} - kinloop`;
    at('input').textContent = input;
    at('run').hidden = !live;
    at('color').querySelectorAll('[value=depth], [value=time]').forEach((option) => (option.hidden = !live));
  }

  showConnected(connected) {
    document.body.classList.toggle('disconnected', !connected);
    if (!connected) this.badge('not connected', 'lost');
  }

  show(status) {
    this.paused = status.paused;
    at('pause').textContent = status.paused ? 'Resume' : 'Pause';
    at('message').textContent = status.message ?? '';
    const going = status.stage === 'mapping';
    const name = going ? (status.tracking ?? 'waiting') : status.stage;
    this.badge(status.paused ? `${name}, paused` : name, status.tracking === 'lost' && going ? 'lost' : 'good');
    at('facts').replaceChildren(...facts(status).map(([what, figure]) => fact(what, figure)));
  }

  badge(text, kind) {
    at('tracking').textContent = text;
    at('tracking').className = `badge ${kind}`;
  }

  /** Tells that a loop was closed. */
  flash(text) {
    const flash = at('flash');
    flash.textContent = text;
    flash.classList.remove('on');
    void flash.offsetWidth; // so that the animation begins again
    flash.classList.add('on');
  }
}

/** Pairs of what is told and its figure; those that are not known are left out. */
function facts(status) {
  const frames = status.frames ? `${count(status.frame)} of ${count(status.frames)}` : count(status.frame);
  return [
    ['frame', frames],
    ['frames a second', status.framesPerSecond?.toFixed(1)],
    ['features tracked', status.inliers],
    ['error (ATE)', status.ateM && millimetres(status.ateM)],
    ['keyframes', count(status.keyframes)],
    ['landmarks', count(status.landmarks)],
    ['loops', count(status.loops)],
    ['relocalised', status.relocalisations || undefined],
    ['points', count(status.points)],
  ].filter(([, figure]) => figure !== undefined);
}

function fact(what, figure) {
  const row = document.createElement('div');
  const [name, value] = [document.createElement('span'), document.createElement('b')];
  name.textContent = what;
  value.textContent = figure;
  row.append(name, value);
  return row;
}
