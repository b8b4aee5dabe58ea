// Where the keyframes are. When the map bends they glide to their new places, so that one sees it bend.

import { Matrix4, Quaternion, Vector3 } from 'three';

import { PART_LENGTH } from './messages.js';

const FLOATS = 7; // translation, quaternion
const GLIDE_S = 0.25; // time constant
const STILL_M = 1e-4;
const STILL_RAD = 1e-3;

export class Poses {
  constructor() {
    this.targets = [];
    this.matrices = [];
    this.gliding = false;
  }

  get count() {
    return this.matrices.length;
  }

  /** The pose of a keyframe as it is shown; nothing where it is not known yet. */
  at(keyframe) {
    return this.matrices[keyframe];
  }

  /** Takes part `index` of the list; new keyframes appear where they are. */
  take(index, floats) {
    for (let i = 0; i < floats.length / FLOATS; ++i) {
      const keyframe = index * PART_LENGTH + i;
      const target = poseFrom(floats, i * FLOATS);
      this.targets[keyframe] = target;
      if (!this.matrices[keyframe]) this.matrices[keyframe] = matrixOf(target);
    }
    this.gliding = true;
  }

  /** Glides on for a moment; true where anything moved. */
  advance(seconds) {
    if (!this.gliding) return false;
    this.gliding = false;
    const share = 1 - Math.exp(-seconds / GLIDE_S);
    const shown = { place: new Vector3(), turn: new Quaternion() };
    const size = new Vector3();
    this.matrices.forEach((matrix, keyframe) => {
      const target = this.targets[keyframe];
      matrix.decompose(shown.place, shown.turn, size);
      const far = shown.place.distanceTo(target.place) > STILL_M || shown.turn.angleTo(target.turn) > STILL_RAD;
      shown.place.lerp(target.place, far ? share : 1);
      shown.turn.slerp(target.turn, far ? share : 1);
      matrix.copy(matrixOf(shown));
      this.gliding ||= far;
    });
    return true;
  }
}

/** Seven floats of a message. */
export function poseFrom(floats, at = 0) {
  return { place: new Vector3().fromArray(floats, at), turn: new Quaternion().fromArray(floats, at + 3).normalize() };
}

export function matrixOf({ place, turn }) {
  return new Matrix4().compose(place, turn, new Vector3(1, 1, 1));
}
