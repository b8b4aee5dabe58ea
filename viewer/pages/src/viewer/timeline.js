// Replays a saved run: a moment, the camera and the image at that moment, and a link to it (#t=SECONDS).

import { millimetres } from '../shared/format.js';
import { NO_KEYFRAME } from './messages.js';
import { TimelineBar } from './timelineBar.js';

const at = (id) => document.getElementById(id);
const STATUS = ['tracked', 'doubtful', 'lost'];
const LINK_EVERY_MS = 500; // browsers refuse more frequent changes of the address

export class Timeline {
  constructor({ world, view, images }) {
    Object.assign(this, { world, view, images });
    this.bar = new TimelineBar(at('bar'), (stampS) => this.seek(stampS));
    at('play').onclick = () => this.toggle();
    at('plotted').onchange = () => this.bar.plot(at('plotted').value);
    addEventListener('hashchange', () => this.followLink());
    this.clear();
  }

  clear() {
    this.frames = undefined;
    this.keyframes = undefined;
    this.frame = undefined; // none is shown yet
    this.playing = false;
    at('play').textContent = 'Play';
    at('timeline').hidden = true;
    document.body.classList.remove('timed');
    this.world.moveCamera(undefined);
  }

  take(frames) {
    this.frames = frames;
    this.keyframes = []; // frames that became keyframes
    for (let i = 0; i < frames.count; ++i) if (frames.keyframe[i] !== NO_KEYFRAME) this.keyframes.push(i);
    at('timeline').hidden = false;
    document.body.classList.add('timed');
    for (const option of at('plotted').options) option.hidden = option.disabled = !frames[option.value].some((figure) => figure > 0);
    const possible = [...at('plotted').options].find((option) => !option.disabled);
    at('plotted').hidden = !possible;
    if (possible) at('plotted').value = possible.value;
    this.bar.show(frames, this.keyframes, at('plotted').value);
    this.followLink();
  }

  /** Marks the keyframes that loops connect. */
  markLoops() {
    if (!this.frames) return;
    const frameOf = new Map(this.keyframes.map((frame) => [this.frames.keyframe[frame], frame]));
    this.bar.markLoops([...this.world.loops].map((keyframe) => frameOf.get(keyframe)).filter((frame) => frame !== undefined));
  }

  /** The frame that became a keyframe; undefined if it is not known. */
  frameOf(keyframe) {
    return this.keyframes?.find((frame) => this.frames.keyframe[frame] === keyframe);
  }

  /** Seconds from the first frame to that stamp; undefined if the timeline does not cover it. */
  sinceStartS(stampS) {
    if (!this.shown) return undefined;
    const { stampS: stamps } = this.frames;
    const TOLERANCE_S = 1e-6; // of stamps as text
    const covered = stampS >= stamps[0] - TOLERANCE_S && stampS <= stamps.at(-1) + TOLERANCE_S;
    return covered ? stampS - stamps[0] : undefined;
  }

  get shown() {
    return this.frames !== undefined;
  }

  toggle() {
    if (!this.shown) return;
    this.playing = !this.playing;
    at('play').textContent = this.playing ? 'Pause' : 'Play';
    if (!this.playing) return this.link();
    if (this.frame === undefined || this.frame === this.frames.count - 1) this.go(0);
    this.stampS = this.frames.stampS[this.frame];
    this.lastMs = performance.now();
    requestAnimationFrame((nowMs) => this.tick(nowMs));
  }

  tick(nowMs) {
    if (!this.playing) return;
    this.stampS += (Number(at('speed').value) * Math.max(0, nowMs - this.lastMs)) / 1000;
    this.lastMs = nowMs;
    this.go(this.frameAt(this.stampS));
    if (this.frame === this.frames.count - 1) this.toggle();
    requestAnimationFrame((next) => this.tick(next));
  }

  /** The last frame not after that stamp. */
  frameAt(stampS) {
    const { stampS: stamps } = this.frames;
    let [low, high] = [0, stamps.length];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (stamps[middle] <= stampS) low = middle;
      else high = middle;
    }
    return low;
  }

  seek(stampS) {
    this.stampS = stampS;
    this.go(this.frameAt(stampS));
  }

  /** Moves by that many frames or, if `keyframes`, to the next or previous keyframe. */
  step(by, keyframes = false) {
    if (!this.shown) return;
    const from = this.frame ?? 0;
    const next = by > 0 ? this.keyframes.find((frame) => frame > from) : this.keyframes.findLast((frame) => frame < from);
    this.jump(keyframes ? (next ?? from) : from + by);
  }

  /** Shows a frame and continues from there if it plays. */
  jump(frame) {
    if (!this.shown) return;
    this.go(frame);
    this.stampS = this.frames.stampS[this.frame];
  }

  jumpToEnd() {
    this.jump(Infinity);
  }

  go(frame) {
    const next = Math.min(Math.max(0, frame), this.frames.count - 1);
    if (next === this.frame) return;
    this.frame = next;
    this.bar.point(next);
    this.describe();
    this.showCamera();
    this.linkLater();
  }

  describe() {
    const { frames, frame } = this;
    const sinceS = frames.stampS[frame] - frames.stampS[0];
    const keyframe = frames.keyframe[frame];
    const parts = [`${sinceS.toFixed(2)} s`, `frame ${frame + 1} of ${frames.count}`, STATUS[frames.status[frame]]];
    if (frames.tracked[frame] > 0) parts.push(`${frames.tracked[frame]} tracked`);
    if (frames.sigmaM[frame] > 0) parts.push(`\u03c3 ${millimetres(frames.sigmaM[frame])}`);
    if (keyframe !== NO_KEYFRAME) parts.push(`keyframe ${keyframe}`);
    at('momentText').textContent = parts.join(' \u00b7 ');
    this.bar.describe(parts.join(', '));
  }

  /** A frame without a pose leaves the camera where it was. */
  showCamera() {
    const pose = this.frames.pose(this.frame);
    if (pose) this.world.moveCamera(pose);
    this.view.dirty = true;
    const nearest = this.nearestPicture();
    if (nearest === undefined) return;
    const keyframe = this.frames.keyframe[nearest];
    const awayS = this.frames.stampS[nearest] - this.frames.stampS[this.frame];
    const when = awayS === 0 ? '' : `, ${Math.abs(awayS).toFixed(2)} s ${awayS < 0 ? 'earlier' : 'later'}`;
    this.images.showKeyframe(this.world.pictures.of(keyframe), `keyframe ${keyframe}${when}`);
    this.world.showCameraPicture(keyframe).then(() => (this.view.dirty = true));
  }

  /** The frame nearest in time that has a picture. */
  nearestPicture() {
    const { stampS } = this.frames;
    const awayS = (frame) => Math.abs(stampS[frame] - stampS[this.frame]);
    let best;
    for (const frame of this.keyframes) {
      if (!this.world.pictures.of(this.frames.keyframe[frame])) continue;
      if (best !== undefined && awayS(frame) >= awayS(best)) break; // stamps grow
      best = frame;
    }
    return best;
  }

  linkLater() {
    this.linking ??= setTimeout(() => this.link(), LINK_EVERY_MS);
  }

  link() {
    clearTimeout(this.linking);
    this.linking = undefined;
    if (this.frame === undefined) return;
    const sinceS = this.frames.stampS[this.frame] - this.frames.stampS[0];
    history.replaceState(null, '', `${location.pathname}${location.search}#t=${sinceS.toFixed(3)}`);
  }

  followLink() {
    const sinceS = Number(new URLSearchParams(location.hash.slice(1)).get('t') ?? NaN);
    if (this.shown && Number.isFinite(sinceS)) this.seek(this.frames.stampS[0] + sinceS + 1e-3);
  }
}
