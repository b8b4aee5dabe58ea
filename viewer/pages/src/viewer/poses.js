// The keyframe poses. When the map is corrected they move smoothly to their new poses, which makes the
// correction visible.

import { Matrix4, Quaternion, Vector3 } from 'three';

export const PART_LENGTH = 64; // keyframes, or frames, in a message

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

  /** The displayed pose of a keyframe; undefined if it is not known yet. */
  at(keyframe) {
    return this.matrices[keyframe];
  }

  /** Updates part `index` of the list; new keyframes appear at their final pose. */
  take(index, floats) {
    for (let i = 0; i < floats.length / FLOATS; ++i) {
      const keyframe = index * PART_LENGTH + i;
      const target = poseFrom(floats, i * FLOATS);
      this.targets[keyframe] = target;
      if (!this.matrices[keyframe]) this.matrices[keyframe] = matrixOf(target);
    }
    this.gliding = true;
  }

  /** Advances the animation; returns true if anything moved. */
  advance(seconds) {
    if (!this.gliding) return false;
    this.gliding = false;
    const share = 1 - Math.exp(-seconds / GLIDE_S);
    const shown = { position: new Vector3(), rotation: new Quaternion() };
    const size = new Vector3();
    this.matrices.forEach((matrix, keyframe) => {
      const target = this.targets[keyframe];
      matrix.decompose(shown.position, shown.rotation, size);
      const far = shown.position.distanceTo(target.position) > STILL_M || shown.rotation.angleTo(target.rotation) > STILL_RAD;
      shown.position.lerp(target.position, far ? share : 1);
      shown.rotation.slerp(target.rotation, far ? share : 1);
      matrix.copy(matrixOf(shown));
      this.gliding ||= far;
    });
    return true;
  }
}

/** Seven floats of a message. */
export function poseFrom(floats, at = 0) {
  return { position: new Vector3().fromArray(floats, at), rotation: new Quaternion().fromArray(floats, at + 3).normalize() };
}

export function matrixOf({ position, rotation }) {
  return new Matrix4().compose(position, rotation, new Vector3(1, 1, 1));
}
