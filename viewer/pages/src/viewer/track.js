// The frames of one run on the timeline. Moments are seconds since the start of the timeline.

import { millimetres } from '../shared/format.js';
import { NO_KEYFRAME } from './messages.js';

const STATUS = ['tracked', 'doubtful', 'lost'];

export class Track {
  /** `startS`: the stamp at the start of the timeline. */
  constructor(frames, startS) {
    Object.assign(this, { frames, startS });
    this.timeS = frames.stampS.map((stampS) => stampS - startS);
    this.keyframes = []; // frames that became keyframes
    for (let i = 0; i < frames.count; ++i) if (frames.keyframe[i] !== NO_KEYFRAME) this.keyframes.push(i);
    this.frame = undefined; // none is shown yet
  }

  get endS() {
    return this.timeS.at(-1);
  }

  /** Shows the last frame not after that moment; none before the first one and after the last. */
  go(timeS) {
    const covered = timeS >= this.timeS[0] && timeS <= this.endS;
    this.frame = covered ? lastUpTo(this.timeS, timeS) : undefined;
  }

  /** The frame that became a keyframe; undefined if it is not known. */
  frameOf(keyframe) {
    return this.keyframes.find((frame) => this.frames.keyframe[frame] === keyframe);
  }

  /** The pose of the shown frame; undefined if it has none. */
  get pose() {
    return this.frame === undefined ? undefined : this.frames.pose(this.frame);
  }

  /** What is known of the shown frame. */
  describe() {
    const { frames, frame } = this;
    if (frame === undefined) return ['no frame'];
    const parts = [`frame ${frame + 1} of ${frames.count}`, STATUS[frames.status[frame]]];
    if (frames.errorM[frame] > 0) parts.push(`error ${millimetres(frames.errorM[frame])}`);
    if (frames.tracked[frame] > 0) parts.push(`${frames.tracked[frame]} tracked`);
    if (frames.sigmaM[frame] > 0) parts.push(`\u03c3 ${millimetres(frames.sigmaM[frame])}`);
    if (frames.keyframe[frame] !== NO_KEYFRAME) parts.push(`keyframe ${frames.keyframe[frame]}`);
    return parts;
  }

  /** The frame nearest in time to the shown one whose keyframe has a picture. */
  nearestPicture(pictures) {
    const awayS = (frame) => Math.abs(this.timeS[frame] - this.timeS[this.frame]);
    let best;
    for (const frame of this.keyframes) {
      if (!pictures.of(this.frames.keyframe[frame])) continue;
      if (best !== undefined && awayS(frame) >= awayS(best)) break; // stamps grow
      best = frame;
    }
    return best;
  }
}

/** The index of the last of increasing numbers that is not above `number`; 0 if there is none. */
export function lastUpTo(numbers, number) {
  let [low, high] = [0, numbers.length];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= number) low = middle;
    else high = middle;
  }
  return low;
}

/** The stamps at which the timeline of these runs starts: one where they share a clock, else the first of each. */
export function startsOf(runs) {
  const first = runs.map(({ stampS }) => stampS[0]);
  const begin = Math.min(...first);
  const shareClock = Math.max(...first) <= Math.min(...runs.map(({ stampS }) => stampS.at(-1)));
  return shareClock ? runs.map(() => begin) : first;
}
