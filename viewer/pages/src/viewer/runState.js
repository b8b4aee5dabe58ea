// The state of the run as known to the page: its badge, a line of text, and which buttons are enabled.

import { count, millimetres } from '../shared/format.js';
import { element } from './elements.js';

const at = (id) => document.getElementById(id);
const CONTROLS = ['pause', 'step', 'save'];

export class RunState {
  constructor() {
    this.connected = false;
    this.live = false;
    this.status = undefined;
    this.problem = '';
    this.noControl = new URLSearchParams(location.search).has('token') ? '' : 'Open the URL that kinloop printed to control the run.';
  }

  greet({ live }) {
    this.live = live;
    this.problem = '';
    this.show(undefined);
  }

  setConnected(connected) {
    this.connected = connected;
    this.show(this.status);
  }

  /** Shows a permanent problem. */
  showProblem(text) {
    this.problem = text;
    this.show(this.status);
  }

  /** Disables the controls and shows why. */
  refuseControl(reason) {
    this.noControl = reason;
    this.show(this.status);
  }

  get paused() {
    return this.status?.paused ?? false;
  }

  /** Whether the program processes frames. */
  get running() {
    return this.connected && this.live && this.status?.stage === 'mapping';
  }

  show(status) {
    this.status = status;
    const [name, kind, message] = this.describe();
    at('tracking').textContent = name;
    at('tracking').className = `badge ${kind}`;
    at('message').textContent = message;
    showTexts(at('warnings'), status?.warnings ?? []);
    showTexts(at('hints'), status?.hints ?? []);
    document.body.classList.toggle('disconnected', !this.connected);
    at('run').hidden = !this.live || status?.stage === 'calibrating';
    CONTROLS.forEach((id) => {
      at(id).disabled = !this.running || this.noControl !== '';
      if (this.noControl) at(id).title = this.noControl;
    });
    at('pause').textContent = this.running && this.paused ? 'Resume' : 'Pause';
    if (status) at('facts').replaceChildren(...facts(status).map(([what, figure]) => fact(what, figure)));
    at('facts').hidden = at('facts').childElementCount === 0;
  }

  /** [badge, its kind, the line beside it] */
  describe() {
    const { connected, live, status } = this;
    const ended = status?.stage === 'finished';
    if (this.problem) return ['error', 'lost', this.problem];
    if (ended) return ['run ended', 'ended', connected ? 'The run has ended.' : 'The run has ended; the connection is closed.'];
    if (!connected && !status) return ['not connected', 'lost', 'kinloop does not answer; trying again.'];
    if (!connected) {
      const what = live ? 'kinloop has ended or cannot be reached' : 'kinloop view has ended or cannot be reached';
      return ['not connected', 'lost', `Connection closed: ${what}.`];
    }
    if (!status) return ['connected', 'good', ''];
    const mapping = status.stage === 'mapping';
    const name = mapping ? (status.tracking ?? 'waiting') : status.stage;
    const kind = (mapping && { lost: 'lost', doubtful: 'doubtful' }[status.tracking]) || 'good';
    return [status.paused && mapping ? `${name}, paused` : name, kind, status.message ?? ''];
  }
}

/** Shows texts, a paragraph each, in an element that screen readers read when it changes: so only if it does. */
function showTexts(box, texts) {
  const shown = [...box.children].map(({ textContent }) => textContent);
  if (texts.length === shown.length && texts.every((text, i) => text === shown[i])) return;
  box.hidden = texts.length === 0;
  box.replaceChildren(...texts.map((text) => element('p', {}, text)));
}

/** Pairs of label and figure; unknown ones are left out. */
function facts(status) {
  const frames = status.frames ? `${count(status.frame)} of ${count(status.frames)}` : count(status.frame);
  return [
    ['frame', frames],
    ['frames a second', status.stage === 'finished' ? undefined : status.framesPerSecond?.toFixed(1)],
    ['features tracked', status.inliers],
    ['error (ATE)', status.ateM && millimetres(status.ateM)],
    ['keyframes', count(status.keyframes)],
    ['landmarks', count(status.landmarks)],
    ['loops', count(status.loops)],
    ['relocalised', status.relocalisations || undefined],
    ['points', count(status.points)],
    ['vertices', count(status.vertices)],
    ['triangles', count(status.triangles)],
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
