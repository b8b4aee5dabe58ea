// The viewpoint: shows the whole map until the user moves it, or follows the camera.

import { Matrix4, PerspectiveCamera, Vector3 } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

import { frame } from './framing.js';

const FIELD_OF_VIEW_DEG = 50;
const BEHIND = new Vector3(0, -0.5, -1.4); // position when following, in the camera frame (x right, y down, z
                                           // ahead)
const AHEAD = new Vector3(0, 0, 1.5);
const FOLLOW_S = 0.4; // time constants
const GLIDE_S = 0.15;
const ARRIVED = 1e-3; // of the distance
const SWING_S = 0.3; // time constant of what is left of a movement when the pointer is released
const MARGIN = 1.08;
const MIN_DISTANCE_M = 1e-3;
const MUCH_CLOSER = 0.85;

/** Viewing directions from the centre of the map; the second if the map appears much larger from there. */
const DIRECTIONS = {
  oblique: [[0.35, 0.8, 0.65], [0.65, 0.8, -0.35]],
  top: [[0, 1, 1e-3], [1e-3, 1, 0]],
  side: [[0, 0.12, 1], [1, 0.12, 0]],
};

export class CameraControls {
  /** Views `world` in `canvas`; `onChange()` is called when the viewpoint has moved. */
  constructor(canvas, world, onChange) {
    this.world = world;
    this.onChange = onChange;
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 0.02, 200);
    this.camera.position.set(2, 3, 4);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.addEventListener('start', () => this.setManualControl());
    this.controls.addEventListener('change', onChange);
    this.mode = 'orbit';
    this.direction = 'oblique';
    this.touched = false; // false: the user has not moved the view, so it may adapt as the map grows
    this.goal = undefined; // target of the animation
    this.places = []; // points that must stay in view
    this.interior = undefined; // { position, target } of the view from inside, if the map is a room
  }

  setMode(mode) {
    this.mode = mode;
    this.controls.enabled = mode === 'orbit';
    this.setManualControl();
  }

  /** The user controls the viewpoint from here on. */
  setManualControl() {
    this.touched = true;
    this.goal = undefined;
  }

  /** Shows the whole map from 'oblique', 'top' or 'side', also while it grows, or a room from 'inside'. */
  show(direction) {
    this.direction = direction;
    this.touched = false;
    this.fit();
  }

  /** Moves along the current viewing direction until all of these points are in view. */
  fit(places = this.places) {
    this.places = places;
    if (places.length === 0 || this.mode !== 'orbit') return;
    const { camera, controls } = this;
    if (!this.touched && this.direction === 'inside' && this.interior) return this.goTo(this.interior);
    const own = [camera.position.clone().sub(controls.target)];
    const directions = this.touched ? own : (DIRECTIONS[this.direction] ?? DIRECTIONS.oblique).map((direction) => new Vector3(...direction));
    directions.forEach((direction) => direction.normalize());
    const tall = Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360) / MARGIN;
    const [first, second] = directions.map((direction) => frame(places, direction, [tall * camera.aspect, tall]));
    const turned = second && second.distance < MUCH_CLOSER * first.distance;
    const { position, distance } = turned ? second : first;
    const target = position.clone().addScaledVector(directions[turned ? 1 : 0], -Math.max(distance, MIN_DISTANCE_M));
    this.goTo({ position, target });
  }

  /** Moves to a viewpoint; the first one is there at once. */
  goTo(goal) {
    this.goal = goal;
    if (!this.placed) this.glide(1);
    this.placed = true;
    this.onChange();
  }

  /** Sets the clipping planes for objects from a hundredth to a hundred times this size. */
  setScale(radiusM) {
    this.camera.near = Math.min(0.02, radiusM / 50);
    this.camera.far = Math.max(200, 50 * radiusM);
    this.camera.updateProjectionMatrix();
  }

  advance(seconds) {
    if (this.mode === 'follow') return this.follow(1 - Math.exp(-seconds / FOLLOW_S));
    if (this.goal) this.glide(1 - Math.exp(-seconds / GLIDE_S));
    this.controls.dampingFactor = 1 - Math.exp(-seconds / SWING_S); // three.js counts frames, which may be slow
    this.controls.update();
  }

  glide(share) {
    const { target, position } = this.goal;
    this.controls.target.lerp(target, share);
    this.camera.position.lerp(position, share);
    if (this.camera.position.distanceTo(position) < ARRIVED * position.distanceTo(target)) this.goal = undefined;
    this.onChange();
  }

  /** Follows the camera from slightly behind and above. */
  follow(share) {
    const pose = this.world.cameraPose;
    if (!pose) return;
    const inWorld = new Matrix4().multiplyMatrices(this.world.group.matrixWorld, pose);
    const from = BEHIND.clone().applyMatrix4(inWorld);
    if (this.camera.position.distanceTo(from) < 1e-3) return;
    this.camera.position.lerp(from, share);
    this.controls.target.lerp(AHEAD.clone().applyMatrix4(inWorld), share);
    this.camera.lookAt(this.controls.target);
    this.onChange();
  }

  /** Pixels that an object of 1 m at a distance of 1 m covers in an image of that height. */
  pixelsPerRadian(heightPx) {
    return heightPx / (2 * Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360));
  }

  get horizontalFieldRad() {
    return 2 * Math.atan(Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360) * this.camera.aspect);
  }

  /** Distance to the centre of the view. */
  get distanceM() {
    return this.camera.position.distanceTo(this.controls.target);
  }
}
