// The loops of a saved run: the list, its filter by status, and the pictures and figures of the selected one.

import { keyframesText, LOOP_STATUSES, reasonText, scaleText } from '../shared/loops.js';
import { drawJpeg } from './images.js';
import { NO_KEYFRAME } from './messages.js';

const at = (id) => document.getElementById(id);
const SHOWN_AT_FIRST = ['accepted', 'provisional'];

export class Loops {
  constructor({ world, view, timeline }) {
    Object.assign(this, { world, view, timeline });
    this.list = at('loopList');
    this.list.onkeydown = (event) => this.onKey(event);
    this.list.onclick = ({ target }) => target.closest('li') && this.select(Number(target.closest('li').dataset.loop));
    at('closeLoop').onclick = () => this.deselect();
    at('copyWithdrawal').onclick = () => this.copyCommand();
    this.clear();
  }

  clear() {
    this.loops = []; // in the order of their later ends
    this.chosen = new Set(SHOWN_AT_FIRST);
    at('loops').hidden = true;
    this.deselect();
  }

  take({ loops, map }) {
    const laterS = ({ stampA, stampB }) => Math.max(Number(stampA), Number(stampB));
    this.loops = loops.map((loop) => ({ ...loop, laterS: laterS(loop) })).sort((a, b) => a.laterS - b.laterS);
    this.map = map;
    at('loops').hidden = loops.length === 0;
    at('loopCount').textContent = loops.length;
    this.makeFilter();
    this.show();
  }

  countOf(status) {
    return [status, this.loops.filter((loop) => loop.status === status).length];
  }

  makeFilter() {
    const choices = LOOP_STATUSES.map((status) => this.countOf(status)).filter(([, n]) => n > 0).map(([status, n]) => {
      const input = element('input', { type: 'checkbox', value: status, checked: this.chosen.has(status) });
      input.onchange = () => {
        if (input.checked) this.chosen.add(status);
        else this.chosen.delete(status);
        this.show();
      };
      return element('label', {}, input, statusMark(status), `${status} ${n}`);
    });
    at('loopFilter').replaceChildren(...choices);
  }

  /** Indices of the loops that pass the filter. */
  get shown() {
    return [...this.loops.keys()].filter((i) => this.chosen.has(this.loops[i].status));
  }

  /** Those of them that have a line: [index, keyframe, keyframe]. */
  get lines() {
    return this.shown.map((i) => [i, this.loops[i].a, this.loops[i].b]).filter(([, a, b]) => a !== null && b !== null);
  }

  /** Shows the list, and the lines in the scene, anew. */
  show() {
    const { shown } = this;
    this.list.replaceChildren(...shown.map((i) => this.row(i)));
    this.list.hidden = shown.length === 0;
    if (!shown.includes(this.selected)) this.deselect();
    else this.mark();
    this.drawLines();
  }

  drawLines() {
    const edges = Object.fromEntries(LOOP_STATUSES.map((status) => [status, []]));
    for (const [i, a, b] of this.lines) edges[this.loops[i].status].push(a, b);
    this.world.showLoops(edges, this.lines.find(([i]) => i === this.selected)?.slice(1));
    this.view.dirty = true;
  }

  row(i) {
    const { stampA, stampB, status, reason, ...figures } = this.loops[i];
    const when = `${this.timeText(stampA)} \u2194 ${this.timeText(stampB)}`;
    const why = reasonText(reason);
    const row = element('li', { id: `loop${i}`, role: 'option' });
    row.dataset.loop = i;
    row.append(element('div', {}, statusMark(status), element('b', {}, status), element('span', {}, when)));
    row.append(element('small', {}, figuresText(figures)));
    if (why) row.append(element('small', {}, why));
    return row;
  }

  /** Seconds since the first frame if the timeline has that moment. */
  timeText(stamp) {
    const sinceS = this.timeline.sinceStartS(Number(stamp));
    return sinceS === undefined ? `stamp ${Number(stamp).toFixed(2)}` : `${sinceS.toFixed(2)} s`;
  }

  /** The next or previous loop; the first or last if none is selected. */
  step(by) {
    const { shown } = this;
    if (shown.length === 0) return;
    const from = shown.indexOf(this.selected);
    const to = from < 0 ? (by > 0 ? 0 : shown.length - 1) : Math.min(Math.max(0, from + by), shown.length - 1);
    this.select(shown[to]);
  }

  onKey(event) {
    const moves = { ArrowDown: 1, ArrowUp: -1, Home: -Infinity, End: Infinity, Enter: 0 };
    if (!(event.key in moves) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation(); // those are keys of the timeline, too
    if (event.key === 'Enter' && this.selected !== undefined) this.select(this.selected);
    else this.step(moves[event.key] || 1);
  }

  /** Shows a loop: its line, its pictures, and the moment of its later end. */
  select(i) {
    this.selected = i;
    this.mark();
    this.drawLines();
    const loop = this.loops[i];
    const [earlier, later] = Number(loop.stampA) <= Number(loop.stampB) ? ['a', 'b'] : ['b', 'a'];
    this.showLoop(loop, earlier, later);
    const frame = loop[later] === null ? undefined : this.timeline.frameOf(loop[later]);
    if (frame !== undefined) this.timeline.jump(frame);
    else if (this.timeline.sinceStartS(loop.laterS) !== undefined) this.timeline.seek(loop.laterS);
  }

  deselect() {
    this.selected = undefined;
    at('loop').hidden = true;
    this.mark();
    this.drawLines();
  }

  mark() {
    for (const row of this.list.children) row.setAttribute('aria-selected', Number(row.dataset.loop) === this.selected);
    const row = at(`loop${this.selected}`);
    if (!row) return this.list.removeAttribute('aria-activedescendant');
    this.list.setAttribute('aria-activedescendant', row.id);
    row.scrollIntoView({ block: 'nearest' });
  }

  showLoop(loop, earlier, later) {
    const { status, reason, scale } = loop;
    at('loop').hidden = false;
    at('loop').querySelector('h2').replaceChildren(statusMark(status), `${status} loop`);
    at('loop').querySelector('.why').textContent = reasonText(reason);
    [earlier, later].forEach((end, side) => this.showEnd(at('loop').querySelectorAll('figure')[side], loop, end));
    const figures = [
      ['keyframes that agree', loop.support || 'unknown'],
      ['inliers', loop.inliers || 'unknown'],
      ['scale', scaleText(scale)],
    ];
    at('loop').querySelector('dl').replaceChildren(...figures.map(([what, figure]) => element('div', {}, element('dt', {}, what), element('dd', {}, `${figure}`))));
    this.showCommand(loop);
  }

  showEnd(figure, loop, end) {
    const keyframe = loop[end] ?? NO_KEYFRAME;
    const canvas = figure.querySelector('canvas');
    const jpeg = this.world.pictures.of(keyframe);
    const name = keyframe === NO_KEYFRAME ? 'keyframe not shown' : `keyframe ${keyframe}`;
    figure.querySelector('figcaption').textContent = `${name}, ${this.timeText(end === 'a' ? loop.stampA : loop.stampB)}${jpeg ? '' : ', no image'}`;
    canvas.setAttribute('aria-label', `image of ${name}`);
    canvas.hidden = jpeg === undefined;
    if (jpeg) drawJpeg(canvas, jpeg, () => this.loops[this.selected] === loop);
  }

  /** The command that takes an accepted loop out of the map, where that is known. */
  showCommand({ status, stampA, stampB }) {
    at('withdrawal').hidden = status !== 'accepted' || !this.map;
    if (at('withdrawal').hidden) return;
    const output = this.map.replace(/(\.kinmap)?$/, '_withdrawn.kinmap');
    at('withdrawalCommand').textContent = `kinloop map withdraw ${quoted(this.map)} --loop ${stampA},${stampB} -o ${quoted(output)}`;
    at('copyWithdrawal').textContent = 'Copy';
  }

  async copyCommand() {
    const text = at('withdrawalCommand').textContent;
    const copied = await navigator.clipboard?.writeText(text).then(() => true, () => false);
    if (!copied) getSelection().selectAllChildren(at('withdrawalCommand')); // without https there is no clipboard
    at('copyWithdrawal').textContent = copied ? 'Copied' : 'Press Ctrl-C';
  }
}

function figuresText({ support, inliers, scale }) {
  const parts = [];
  if (support) parts.push(keyframesText(support));
  if (inliers) parts.push(`${inliers} inliers`);
  if (scale !== null) parts.push(`scale ${scaleText(scale)}`);
  return parts.join(' \u00b7 ');
}

function statusMark(status) {
  return element('i', { className: `mark ${status}` });
}

function element(name, properties, ...children) {
  const { role, ...others } = properties;
  const made = Object.assign(document.createElement(name), others);
  if (role) made.setAttribute('role', role);
  made.append(...children);
  return made;
}

/** For a shell. */
function quoted(path) {
  return /^[\w@%+=:,./-]+$/.test(path) ? path : `'${path.replaceAll("'", `'\\''`)}'`;
}
