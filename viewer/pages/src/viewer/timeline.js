// Replays a saved run, or two that are compared: a moment, the cameras and their images at that moment, and a link to
// it (#t=SECONDS).

import { Vector3 } from 'three';

import { lengthText, millimetres } from '../shared/format.js';
import { element, mark } from './elements.js';
import { TimelineBar } from './timelineBar.js';
import { lastUpTo, startsOf, Track } from './track.js';

const at = (id) => document.getElementById(id);
const LINK_EVERY_MS = 500; // browsers refuse more frequent changes of the address
const PLOTTED_FIRST = ['tracked', 'errorM']; // of one run, of two
const SIDES = ['before', 'after'];

export class Timeline {
  constructor({ world, view, images }) {
    Object.assign(this, { world, view, images });
    this.bar = new TimelineBar(at('bar'), (timeS) => this.seek(timeS));
    at('play').onclick = () => this.toggle();
    at('plotted').onchange = () => this.bar.plot(at('plotted').value);
    addEventListener('hashchange', () => this.followLink());
    this.clear();
  }

  clear() {
    this.runs = []; // frames of each
    this.tracks = []; // the same on a common time axis
    this.momentsS = []; // of all frames, in order
    this.keyMoments = []; // indices of those that are keyframes
    this.moment = undefined; // none is shown yet
    this.names = SIDES;
    this.playing = false;
    at('play').textContent = 'Play';
    at('timeline').hidden = true;
    at('tracks').replaceChildren();
    document.body.classList.remove('timed', 'compared');
  }

  /** The names of two runs that are compared. */
  name(names) {
    this.names = names;
  }

  /** Takes the frames of run 0, or of run 1 that is compared with it. */
  take(frames, index) {
    if (frames.count === 0) return;
    this.runs[index] = frames;
    const runs = this.runs.filter((run) => run);
    const starts = startsOf(runs);
    this.tracks = runs.map((run, i) => new Track(run, starts[i]));
    this.order();
    at('timeline').hidden = false;
    document.body.classList.add('timed');
    document.body.classList.toggle('compared', this.compares);
    this.offerPlots(runs);
    this.bar.show(this.tracks, at('plotted').value, this.momentsS.length);
    this.moment = undefined;
    this.followLink();
  }

  /** Collects the moments of all tracks. */
  order() {
    this.momentsS = [...new Set(this.tracks.flatMap(({ timeS }) => [...timeS]))].sort((a, b) => a - b);
    const keysS = this.tracks.flatMap(({ timeS, keyframes }) => keyframes.map((frame) => timeS[frame]));
    this.keyMoments = [...new Set(keysS.map((timeS) => lastUpTo(this.momentsS, timeS)))].sort((a, b) => a - b);
  }

  /** Offers the figures that are known. */
  offerPlots(runs) {
    const options = [...at('plotted').options];
    const known = ({ value }) => runs.some((frames) => frames[value].some((figure) => figure > 0));
    for (const option of options) option.hidden = option.disabled = !known(option);
    const possible = options.filter((option) => !option.disabled);
    at('plotted').hidden = possible.length === 0;
    const first = possible.find(({ value }) => value === PLOTTED_FIRST[this.compares ? 1 : 0]) ?? possible[0];
    if (first) at('plotted').value = first.value;
  }

  get compares() {
    return this.tracks.length > 1;
  }

  /** Marks the keyframes that loops connect. */
  markLoops() {
    const connected = new Set(this.world.loops);
    this.bar.markLoops(this.tracks.map(({ frames, keyframes }) => keyframes.filter((frame) => connected.has(frames.keyframe[frame]))));
  }

  /** Where a keyframe is on the timeline: { frames, frame, timeS }; undefined if it is not known. */
  locate(keyframe) {
    for (const track of this.tracks) {
      const frame = track.frameOf(keyframe);
      if (frame !== undefined) return { frames: track.frames, frame, timeS: track.timeS[frame] };
    }
    return undefined;
  }

  /** Seconds from the first frame of a saved run to that stamp; undefined if the timeline does not cover it. */
  sinceStartS(stampS) {
    if (!this.shown) return undefined;
    const TOLERANCE_S = 1e-6; // of stamps as text
    const [{ startS, endS }] = this.tracks;
    const sinceS = stampS - startS;
    return sinceS >= -TOLERANCE_S && sinceS <= endS + TOLERANCE_S ? sinceS : undefined;
  }

  get shown() {
    return this.tracks.length > 0;
  }

  toggle() {
    if (!this.shown) return;
    this.playing = !this.playing;
    at('play').textContent = this.playing ? 'Pause' : 'Play';
    if (!this.playing) return this.link();
    if (this.moment === undefined || this.moment === this.momentsS.length - 1) this.go(0);
    this.timeS = this.momentsS[this.moment];
    this.lastMs = performance.now();
    requestAnimationFrame((nowMs) => this.tick(nowMs));
  }

  tick(nowMs) {
    if (!this.playing) return;
    this.seek(this.timeS + (Number(at('speed').value) * Math.max(0, nowMs - this.lastMs)) / 1000);
    this.lastMs = nowMs;
    if (this.moment === this.momentsS.length - 1) this.toggle();
    requestAnimationFrame((next) => this.tick(next));
  }

  /** Shows the last frames not after that moment. */
  seek(timeS) {
    if (!this.shown) return;
    this.timeS = timeS;
    this.go(lastUpTo(this.momentsS, timeS));
  }

  /** Moves by that many frames or, if `keyframes`, to the next or previous keyframe. */
  step(by, keyframes = false) {
    if (!this.shown) return;
    const from = this.moment ?? 0;
    const next = by > 0 ? this.keyMoments.find((moment) => moment > from) : this.keyMoments.findLast((moment) => moment < from);
    this.jump(keyframes ? (next ?? from) : from + by);
  }

  /** Shows a moment, by its number, and continues from there if it plays. */
  jump(moment) {
    if (!this.shown) return;
    this.go(moment);
    this.timeS = this.momentsS[this.moment];
  }

  jumpToEnd() {
    this.jump(Infinity);
  }

  go(moment) {
    const next = Math.min(Math.max(0, moment), this.momentsS.length - 1);
    if (next === this.moment) return;
    this.moment = next;
    this.tracks.forEach((track) => track.go(this.momentsS[next]));
    this.bar.point(this.momentsS[next], next);
    this.describe();
    this.tracks.forEach((track, i) => this.showCamera(track, i));
    this.view.dirty = true;
    this.linkLater();
  }

  describe() {
    const time = `${this.momentsS[this.moment].toFixed(2)} s`;
    const parts = this.tracks.map((track) => track.describe());
    const [head, rows] = this.compares ? [[time, ...this.apartText()], parts] : [[time, ...parts[0]], []];
    at('momentText').textContent = head.join(' \u00b7 ');
    at('tracks').replaceChildren(...rows.map((words, i) => element('div', {}, mark(SIDES[i]), `${this.names[i]}: ${words.join(' \u00b7 ')}`)));
    this.bar.describe([head.join(', '), ...rows.map((words, i) => `${this.names[i]}: ${words.join(', ')}`)].join('; '));
  }

  /** How far the two cameras are from each other. */
  apartText() {
    const [a, b] = this.tracks.map(({ pose }) => pose && new Vector3().setFromMatrixPosition(pose));
    if (!a || !b) return [];
    const apartM = a.distanceTo(b);
    return [`${apartM < 0.1 ? millimetres(apartM) : lengthText(apartM)} apart`];
  }

  /** A frame without a pose leaves its camera where it was. */
  showCamera(track, side) {
    if (track.frame === undefined) return this.world.moveCamera(undefined, side);
    if (track.pose) this.world.moveCamera(track.pose, side);
    const nearest = track.nearestPicture(this.world.pictures);
    if (nearest === undefined) return undefined;
    const keyframe = track.frames.keyframe[nearest];
    const awayS = track.timeS[nearest] - track.timeS[track.frame];
    const when = awayS === 0 ? '' : `, ${Math.abs(awayS).toFixed(2)} s ${awayS < 0 ? 'earlier' : 'later'}`;
    const whose = this.compares ? ` of ${this.names[side]}` : '';
    this.images.showKeyframe(this.world.pictures.of(keyframe), `keyframe ${keyframe}${whose}${when}`, side);
    return this.world.showCameraPicture(keyframe, side).then(() => (this.view.dirty = true));
  }

  linkLater() {
    this.linking ??= setTimeout(() => this.link(), LINK_EVERY_MS);
  }

  link() {
    clearTimeout(this.linking);
    this.linking = undefined;
    if (this.moment === undefined) return;
    history.replaceState(null, '', `${location.pathname}${location.search}#t=${this.momentsS[this.moment].toFixed(3)}`);
  }

  followLink() {
    const sinceS = Number(new URLSearchParams(location.hash.slice(1)).get('t') ?? NaN);
    if (this.shown && Number.isFinite(sinceS)) this.seek(sinceS + 1e-3);
  }
}
