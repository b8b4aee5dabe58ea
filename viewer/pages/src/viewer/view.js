// What one sees: the renderer, the eye, and how much of the cloud is drawn so that it stays smooth.

import { Box3, Matrix4, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

const FIELD_OF_VIEW_DEG = 50;
const SMOOTH_MS = 33; // a frame that takes longer draws fewer points the next time
const REST_MS = 250; // without change, after which all points are drawn
const FEWEST = 0.05; // share of the points
const LARGEST = 2.5; // times the size of a point, where few are drawn
const BEHIND = new Vector3(0, -0.5, -1.4); // the following eye, in the camera's frame (x right, y down, z ahead)
const AHEAD = new Vector3(0, 0, 1.5);
const ABOVE_CAMERA_M = 0.3; // what is higher than the camera ever was is cut off: one looks into rooms past ceilings

export class View {
  constructor(canvas, world) {
    this.world = world;
    // Without the drawing buffer a screenshot would be empty.
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.scene = new Scene().add(world.group);
    this.eye = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.02, 200);
    this.eye.position.set(2, 3, 4);
    this.controls = new OrbitControls(this.eye, canvas);
    this.controls.enableDamping = true;
    this.controls.addEventListener('start', () => (this.touched = true));
    this.controls.addEventListener('change', () => (this.dirty = true));
    this.mode = 'orbit';
    this.touched = false; // nobody has turned the view yet: it may show the whole map as it grows
    this.pointSizeCm = 1.6;
    this.cutShare = undefined; // by hand; else by the height of the camera
    this.share = 1;
    this.lastMs = performance.now();
    this.changedMs = this.lastMs;
    this.framesPerSecond = 0;
    this.dirty = true;
    addEventListener('resize', () => this.resize(canvas));
    this.resize(canvas);
    requestAnimationFrame((now) => this.frame(now));
  }

  resize(canvas) {
    this.renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
    this.eye.aspect = canvas.clientWidth / Math.max(1, canvas.clientHeight);
    this.eye.updateProjectionMatrix();
    this.dirty = true;
  }

  frame(nowMs) {
    const passedMs = nowMs - this.lastMs;
    this.lastMs = nowMs;
    const seconds = Math.min(0.1, passedMs / 1000);
    if (this.world.advance(seconds)) {
      this.measure();
      if (this.mode === 'orbit' && !this.touched) this.showAll();
      this.dirty = true;
    }
    if (this.mode === 'follow') this.follow(seconds);
    else this.controls.update();

    const resting = !this.dirty && nowMs - this.changedMs > REST_MS;
    if (this.dirty) {
      this.changedMs = nowMs;
      this.adapt(passedMs);
      this.draw();
    } else if (resting && this.share < 1) {
      this.share = 1;
      this.draw();
    }
    requestAnimationFrame((now) => this.frame(now));
  }

  /** Draws as many points as the last frames had time for. */
  adapt(passedMs) {
    const smoothing = 0.9;
    this.framesPerSecond = smoothing * this.framesPerSecond + (1 - smoothing) * (1000 / Math.max(1, passedMs));
    const wanted = this.share * Math.min(1.15, Math.max(0.25, SMOOTH_MS / Math.max(1, passedMs)));
    this.share = Math.min(1, Math.max(FEWEST, wanted));
  }

  draw() {
    const { uniforms } = this.world;
    const height = this.renderer.domElement.height;
    uniforms.pixelsPerRadian.value = height / (2 * Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360));
    uniforms.pointSizeCm.value = this.pointSizeCm * Math.min(LARGEST, 1 / Math.sqrt(this.share));
    this.world.thin(this.share);
    this.renderer.render(this.scene, this.eye);
    this.dirty = false;
  }

  /** How high the map reaches, for its colours and for what is cut off. */
  measure() {
    const box = new Box3().setFromObject(this.world.layers.cloud);
    if (box.isEmpty()) return;
    const { heightsM, cutAtM } = this.world.uniforms;
    heightsM.value.set(box.min.y, box.max.y);
    const cameraM = this.pathBox().max.y + ABOVE_CAMERA_M;
    cutAtM.value = this.cutShare === undefined ? cameraM : box.min.y + this.cutShare * (box.max.y - box.min.y) + 1e-3;
  }

  pathBox() {
    const box = new Box3();
    const { poses, lines, group } = this.world;
    for (const pose of poses.matrices) box.expandByPoint(new Vector3().setFromMatrixPosition(pose).applyMatrix4(group.matrixWorld));
    if (!box.isEmpty()) return box;
    const path = lines.path;
    for (let i = 0; i < path.object.geometry.drawRange.count; ++i) {
      box.expandByPoint(new Vector3().fromBufferAttribute(path.attribute, i).applyMatrix4(group.matrixWorld));
    }
    return box.isEmpty() ? new Box3().setFromObject(this.world.layers.cloud) : box;
  }

  /** Turns the eye to the whole map, at a slant. */
  showAll() {
    const box = this.pathBox().union(this.cloudCore());
    if (box.isEmpty()) return;
    const centre = box.getCenter(new Vector3());
    const radius = Math.max(0.5, box.getSize(new Vector3()).length() / 2);
    const distance = radius / Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360);
    this.controls.target.copy(centre);
    this.eye.position.copy(centre).addScaledVector(new Vector3(0.35, 0.8, 0.65).normalize(), 1.05 * distance);
    this.controls.update();
    this.dirty = true;
  }

  /** The middle of every piece of the cloud, which stray points do not stretch, up to the cut. */
  cloudCore() {
    const box = new Box3();
    const piece = new Box3();
    for (const { object } of this.world.pieces.values()) {
      if (!object.visible) continue;
      piece.copy(object.geometry.boundingBox).applyMatrix4(object.matrixWorld);
      box.union(piece.expandByVector(piece.getSize(new Vector3()).multiplyScalar(-0.15)));
    }
    box.max.y = Math.min(box.max.y, this.world.uniforms.cutAtM.value);
    return box;
  }

  /** The eye goes where the camera goes, a little behind and above it. */
  follow(seconds) {
    const pose = this.world.cameraPose;
    if (!pose) return;
    const inWorld = new Matrix4().multiplyMatrices(this.world.group.matrixWorld, pose);
    const share = 1 - Math.exp(-seconds / 0.4);
    const from = BEHIND.clone().applyMatrix4(inWorld);
    if (this.eye.position.distanceTo(from) < 1e-3) return;
    this.eye.position.lerp(from, share);
    this.controls.target.lerp(AHEAD.clone().applyMatrix4(inWorld), share);
    this.eye.lookAt(this.controls.target);
    this.dirty = true;
  }

  setMode(mode) {
    this.mode = mode;
    this.controls.enabled = mode === 'orbit';
    this.touched = true;
  }

  /** The picture as a PNG blob, with every point. */
  screenshot() {
    this.share = 1;
    this.draw();
    return new Promise((resolve) => this.renderer.domElement.toBlob(resolve, 'image/png'));
  }
}
