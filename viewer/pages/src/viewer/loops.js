// The loops of a saved run: the list, its filter by status, and the pictures and figures of the selected one.

import { keyframesText, LOOP_STATUSES, reasonText, scaleText } from '../shared/loops.js';
import { element, figureRows, mark, markedCheckbox } from './elements.js';
import { showPicture } from './images.js';
import { NO_KEYFRAME } from './messages.js';
import { SelectList } from './selectList.js';

const at = (id) => document.getElementById(id);
const SHOWN_AT_FIRST = ['accepted', 'provisional'];

export class Loops {
  constructor({ world, view, timeline, connection }) {
    Object.assign(this, { world, view, timeline, connection });
    this.list = new SelectList(at('loopList'), (loop) => this.select(loop));
    at('closeLoop').onclick = () => this.deselect();
    at('copyWithdrawal').onclick = () => this.copyCommand();
    at('withdraw').onclick = () => this.withdraw();
    this.clear();
  }

  clear() {
    this.loops = []; // in the order of their later ends
    this.list.show([]);
    this.chosen = new Set(SHOWN_AT_FIRST);
    at('loops').hidden = true;
    this.setBusy(false);
    this.deselect();
  }

  /** While kinloop takes a loop out, no other one can be taken out. */
  setBusy(busy) {
    at('withdraw').disabled = busy;
    at('withdraw').textContent = busy ? 'Taking it out\u2026' : 'Take it out';
  }

  /** Kinloop does not take commands of this page. */
  refuse(reason) {
    this.setBusy(true);
    Object.assign(at('withdraw'), { textContent: 'Take it out', title: reason });
  }

  /** Lets kinloop take the selected loop out of the map; the page then shows the new map. */
  withdraw() {
    const { stampA, stampB } = this.loops[this.selected];
    this.setBusy(true);
    this.connection.send('withdraw', { loop: `${stampA},${stampB}` });
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
    const choices = LOOP_STATUSES.map((status) => this.countOf(status)).filter(([, n]) => n > 0).map(([status, n]) =>
      markedCheckbox(status, `${status} ${n}`, this.chosen.has(status), (checked) => {
        if (checked) this.chosen.add(status);
        else this.chosen.delete(status);
        this.show();
      }),
    );
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
    this.list.show(shown, (i) => this.content(i));
    if (!shown.includes(this.selected)) this.deselect();
    else this.list.mark(this.selected);
    this.drawLines();
  }

  drawLines() {
    if (this.loops.length === 0) return; // the scene then has edges without a table
    const edges = Object.fromEntries(LOOP_STATUSES.map((status) => [status, []]));
    for (const [i, a, b] of this.lines) edges[this.loops[i].status].push(a, b);
    this.world.showLoops(edges, this.lines.find(([i]) => i === this.selected)?.slice(1));
    this.view.dirty = true;
  }

  content(i) {
    const { stampA, stampB, status, reason, ...figures } = this.loops[i];
    const when = `${this.timeText(stampA)} \u2194 ${this.timeText(stampB)}`;
    const why = reasonText(reason);
    const lines = [element('div', {}, mark(status), element('b', {}, status), element('span', {}, when))];
    for (const text of [figuresText(figures), why]) if (text) lines.push(element('small', {}, text));
    return lines;
  }

  /** Seconds since the first frame if the timeline has that moment. */
  timeText(stamp) {
    const sinceS = this.timeline.sinceStartS(Number(stamp));
    return sinceS === undefined ? `stamp ${Number(stamp).toFixed(2)}` : `${sinceS.toFixed(2)} s`;
  }

  /** Shows a loop: its line, its pictures, and the moment of its later end. */
  select(i) {
    this.list.mark(i);
    this.drawLines();
    const loop = this.loops[i];
    const [earlier, later] = Number(loop.stampA) <= Number(loop.stampB) ? ['a', 'b'] : ['b', 'a'];
    this.showLoop(loop, earlier, later);
    const moment = loop[later] === null ? undefined : this.timeline.locate(loop[later]);
    const timeS = moment?.timeS ?? this.timeline.sinceStartS(loop.laterS);
    if (timeS !== undefined) this.timeline.seek(timeS);
  }

  deselect() {
    at('loop').hidden = true;
    this.list.mark(undefined);
    this.drawLines();
  }

  get selected() {
    return this.list.selected;
  }

  showLoop(loop, earlier, later) {
    const { status, reason, scale } = loop;
    at('loop').hidden = false;
    at('loop').querySelector('h2').replaceChildren(mark(status), `${status} loop`);
    at('loop').querySelector('.why').textContent = reasonText(reason);
    [earlier, later].forEach((end, side) => this.showEnd(at('loop').querySelectorAll('figure')[side], loop, end));
    const figures = [
      ['keyframes that agree', loop.support || 'unknown'],
      ['inliers', loop.inliers || 'unknown'],
      ['scale', scaleText(scale)],
    ];
    at('loop').querySelector('dl').replaceChildren(...figureRows(figures));
    this.showCommand(loop);
  }

  showEnd(figure, loop, end) {
    const keyframe = loop[end] ?? NO_KEYFRAME;
    const name = keyframe === NO_KEYFRAME ? 'keyframe not shown' : `keyframe ${keyframe}`;
    const when = this.timeText(end === 'a' ? loop.stampA : loop.stampB);
    showPicture(figure, this.world.pictures.of(keyframe), name, `, ${when}`, () => this.loops[this.selected] === loop);
  }

  /** The command that takes an accepted loop out of the map, where that is known. */
  showCommand({ status, stampA, stampB }) {
    at('withdrawal').hidden = status !== 'accepted' || !this.map;
    if (at('withdrawal').hidden) return;
    const output = this.map.replace(/(\.kinmap)?$/, '_withdrawn.kinmap');
    at('withdrawalCommand').textContent = `kinloop map withdraw ${quoted(this.map)} --loop ${stampA},${stampB} -o ${quoted(output)}`;
    at('copyWithdrawal').textContent = 'Copy';
    at('withdraw').hidden = !this.connection.mayCommand;
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

/** For a shell. */
function quoted(path) {
  return /^[\w@%+=:,./-]+$/.test(path) ? path : `'${path.replaceAll("'", `'\\''`)}'`;
}
