// A camera in the scene: its frustum at a pose, with the image of a keyframe in it.

import { Lines } from './lines.js';
import { pictureMesh, placePicture, showIn } from './keyframePictures.js';

export const CAMERA_SIZE_M = 0.16;

export class ShownCamera {
  /** Draws into `layer`; addFrustum(add, pose, frustum, size) adds the edges. */
  constructor(layer, color, addFrustum) {
    Object.assign(this, { color, addFrustum });
    this.lines = new Lines({ color, segments: true });
    this.picture = pictureMesh();
    layer.add(this.lines.object, this.picture);
    this.clear();
  }

  clear() {
    this.pose = undefined;
    this.hidePicture();
    this.paint(this.color);
  }

  paint(color) {
    this.lines.object.material.color.set(color);
  }

  /** Moves it; undefined: there is none. */
  move(pose) {
    this.pose = pose;
    if (!pose) this.hidePicture();
  }

  draw(frustum) {
    this.lines.fill((add) => this.pose && this.addFrustum(add, this.pose, frustum, CAMERA_SIZE_M));
    placePicture(this.picture, this.pose, frustum, CAMERA_SIZE_M);
  }

  hidePicture() {
    this.picture.visible = false;
    this.keyframe = undefined;
  }

  /** Shows the image of a keyframe. */
  async show(keyframe, jpeg) {
    if (this.keyframe === keyframe) return;
    this.keyframe = keyframe;
    await showIn(this.picture, jpeg, () => this.keyframe === keyframe);
  }
}
