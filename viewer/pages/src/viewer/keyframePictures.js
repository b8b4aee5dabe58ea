// The keyframes' images, standing in the scene where they were taken. They are decoded when they are first shown.

import { CanvasTexture, DoubleSide, Matrix4, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace } from 'three';

const DISTANCE_M = 0.2; // from the camera's centre
const MOST_SHOWN = 300; // the memory of a graphics card is small

export class KeyframePictures {
  /** Shows them in `layer`. */
  constructor(layer) {
    this.layer = layer;
    this.onDecoded = () => {};
    this.clear();
  }

  clear() {
    this.layer.children.forEach(release);
    this.layer.clear();
    this.jpegs = new Map(); // by keyframe
    this.meshes = new Map();
  }

  get count() {
    return this.jpegs.size;
  }

  take(keyframe, jpeg) {
    this.jpegs.set(keyframe, jpeg);
  }

  /** The JPEG of the keyframe; undefined if there is none. */
  of(keyframe) {
    return this.jpegs.get(keyframe);
  }

  /** Moves them to the poses of their keyframes; makes them if the layer is visible. */
  place(poses, frustum) {
    if (!this.layer.visible) return;
    const every = Math.ceil(this.count / MOST_SHOWN);
    [...this.jpegs.keys()].filter((_, i) => i % every === 0).forEach((keyframe) => this.meshes.has(keyframe) || this.make(keyframe));
    for (const [keyframe, mesh] of this.meshes) placePicture(mesh, poses.at(keyframe), frustum, DISTANCE_M);
  }

  make(keyframe) {
    const mesh = pictureMesh();
    this.meshes.set(keyframe, mesh);
    this.layer.add(mesh);
    showIn(mesh, this.jpegs.get(keyframe)).then(() => this.onDecoded());
  }
}

/** A rectangle for a picture, of width and height 1. */
export function pictureMesh() {
  const mesh = new Mesh(new PlaneGeometry(1, 1), new MeshBasicMaterial({ side: DoubleSide }));
  mesh.matrixAutoUpdate = false;
  mesh.visible = false; // until it has a picture
  return mesh;
}

/** Puts it before the camera at `pose`, upright: y is down in an image. `frustum`: half its size at 1 m. */
export function placePicture(mesh, pose, [x, y], distanceM) {
  if (!pose) return;
  const inCamera = new Matrix4().makeTranslation(0, 0, distanceM).scale({ x: 2 * x * distanceM, y: -2 * y * distanceM, z: 1 });
  mesh.matrix.multiplyMatrices(pose, inCamera);
  mesh.matrixWorldNeedsUpdate = true;
}

/** Shows a JPEG in the rectangle if it is still wanted once decoded; a damaged one leaves it as it is. */
export async function showIn(mesh, jpeg, isWanted = () => true) {
  const bitmap = await createImageBitmap(jpeg).catch(() => undefined);
  if (!bitmap || !isWanted()) return bitmap?.close();
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [bitmap.width, bitmap.height];
  canvas.getContext('2d').drawImage(bitmap, 0, 0);
  bitmap.close();
  mesh.material.map?.dispose();
  mesh.material.map = new CanvasTexture(canvas);
  mesh.material.map.colorSpace = SRGBColorSpace;
  mesh.material.needsUpdate = true;
  mesh.visible = true;
}

function release({ geometry, material }) {
  geometry.dispose();
  material.map?.dispose();
  material.dispose();
}
