// The view: the renderer, the extent of the map, and how much of it is drawn to keep it smooth. What rests is drawn
// slice by slice into one picture, so that the page answers meanwhile, however large the map is.

import { AmbientLight, Box3, DirectionalLight, Scene, Vector3, WebGLRenderer } from 'three';

import { CameraControls } from './cameraControls.js';
import { EyeDome } from './eyeDome.js';
import { Floor } from './floor.js';
import { ceilingOf, sampleMap } from './framing.js';
import { interiorView } from './interior.js';

const SMOOTH_MS = 33; // after a slower frame, fewer points are drawn
const SLOW_MS = 100; // after two slower ones, where fewer cannot be drawn, pixels are larger
const LARGER = 0.7; // factor on the resolution then
const SMOOTH_FRAMES = 10; // after so many, they are smaller again
const LEAST_RESOLUTION = 0.3; // of that of the canvas
const REST_MS = 250; // idle time after which everything is drawn
const SLICE = 1_000_000; // points or triangles of each frame in which this happens: some 0.7 s in software
const MEASURE_MS = 200; // interval of measuring the map's extent
const FEWEST = 50_000; // points that are drawn in any case
const LARGEST = 2.5; // maximum factor on the point size when few points are drawn
const COVERING = 1 / LARGEST ** 2; // share of the points that covers as much as fewer, larger ones
const ROOM_M = 0.5; // radius of a map below which points are drawn smaller

export class View {
  constructor(canvas, world) {
    this.world = world;
    // Without the drawing buffer a screenshot would be empty.
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: true, preserveDrawingBuffer: true });
    this.resolution = 1; // of the picture while something moves, relative to the one at rest
    this.setResolution(1);
    this.cameraControls = new CameraControls(canvas, world, () => {
      this.dirty = true;
      this.turned = this.cameraControls?.touched ?? false; // not where the view adapts to a map that grows
    });
    this.floor = new Floor();
    const headlight = new DirectionalLight(0xffffff, 2); // for meshes without colours
    headlight.position.z = 1;
    this.cameraControls.camera.add(headlight, headlight.target);
    this.scene = new Scene().add(world.group, this.floor.object, this.cameraControls.camera, new AmbientLight(0xffffff, 1));
    this.places = []; // a sample of the map without stray points
    this.box = new Box3(); // their bounding box
    this.pointSizeCm = 1.6;
    this.cutAtM = Infinity; // points above this height are not drawn
    this.clip = new Box3(new Vector3().setScalar(-Infinity), new Vector3().setScalar(Infinity)); // nor those outside
    this.ceilingM = undefined; // height of the ceiling's lower side, if there is one
    this.hidesCeiling = true; // from a viewpoint above it
    this.isOriented = false; // whether up is known, so that there may be a room
    this.eyeDome = new EyeDome();
    this.shades = true;
    this.shadesMoving = true; // false after slow frames, until the view rests; nor is a mesh drawn beside the cloud
    this.shaded = false; // the picture
    this.finished = 0; // the share of everything that has been drawn
    this.onMeasured = () => {};
    this.onDrawn = () => {};
    this.share = 1;
    this.turned = false; // whether the user has moved the viewpoint since the last frame
    this.turnedMs = -Infinity; // when it last has
    this.slowFrames = 0;
    this.smoothFrames = 0;
    this.lastMs = performance.now();
    this.changedMs = this.lastMs;
    this.measuredMs = -Infinity;
    this.framesPerSecond = 0;
    this.dirty = true;
    new ResizeObserver(() => this.resize(canvas)).observe(canvas);
    this.resize(canvas);
    requestAnimationFrame((now) => this.frame(now));
  }

  resize(canvas) {
    this.renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
    this.cameraControls.camera.aspect = canvas.clientWidth / Math.max(1, canvas.clientHeight);
    this.cameraControls.camera.updateProjectionMatrix();
    if (!this.cameraControls.touched) this.cameraControls.fit();
    this.dirty = true;
  }

  frame(nowMs) {
    const passedMs = nowMs - this.lastMs;
    this.lastMs = nowMs;
    if (this.world.advance(Math.min(0.1, passedMs / 1000))) this.stale = this.dirty = true;
    if (this.stale && nowMs - this.measuredMs > MEASURE_MS) {
      this.measuredMs = nowMs;
      this.measure();
    }
    this.cameraControls.advance(Math.min(1, passedMs / 1000));

    if (this.dirty) {
      this.changedMs = nowMs;
      if (this.turned) this.turnedMs = nowMs;
      this.adapt(passedMs);
      if (nowMs - this.turnedMs > REST_MS) this.setResolution(1); // a map that grows may take longer
      this.turned = false;
      this.draw();
    } else if (this.unfinished && nowMs - this.changedMs > REST_MS) {
      this.drawNextSlice();
    }
    requestAnimationFrame((now) => this.frame(now));
  }

  setResolution(resolution) {
    this.resolution = resolution;
    const pixelRatio = resolution * Math.min(2, devicePixelRatio);
    if (this.renderer.getPixelRatio() !== pixelRatio) this.renderer.setPixelRatio(pixelRatio);
  }

  /** Adapts the number of points, and then the resolution, to the duration of the last frames. */
  adapt(passedMs) {
    const smoothing = 0.9;
    this.framesPerSecond = smoothing * this.framesPerSecond + (1 - smoothing) * (1000 / Math.max(1, passedMs));
    const isLeast = this.adaptShare(passedMs);
    this.slowFrames = isLeast && this.turned && passedMs > SLOW_MS ? this.slowFrames + 1 : 0;
    this.smoothFrames = passedMs < SMOOTH_MS ? this.smoothFrames + 1 : 0;
    if (this.slowFrames >= 2) this.setResolution(Math.max(LEAST_RESOLUTION, LARGER * this.resolution));
    if (this.smoothFrames % SMOOTH_FRAMES === SMOOTH_FRAMES - 1) this.setResolution(Math.min(1, this.resolution / LARGER));
  }

  /** Adapts the share of the map that is drawn; returns whether no less can be drawn. */
  adaptShare(passedMs) {
    if (this.world.coarse && !this.shadesMoving) return true; // it is drawn in place of the mesh
    const least = FEWEST / Math.max(FEWEST, this.world.pointCount, this.world.triangleCount);
    const wanted = this.share * Math.min(1.15, Math.max(0.25, SMOOTH_MS / Math.max(1, passedMs)));
    this.share = Math.min(1, Math.max(least, wanted));
    this.shadesMoving &&= this.share === 1;
    return this.share === least;
  }

  /** Whether the picture lacks part of the map, or its shading. */
  get unfinished() {
    return this.finished < 1;
  }

  /** Draws more of the map once the graphics card has drawn the slice before. */
  drawNextSlice() {
    if (this.resolution < 1) {
      this.setResolution(1); // which clears the picture
      this.draw();
      return;
    }
    const context = this.renderer.getContext();
    if (this.finished > 0 && context.getSyncParameter(this.fence, context.SYNC_STATUS) !== context.SIGNALED) return;
    context.deleteSync(this.fence ?? null);
    const share = SLICE / Math.max(SLICE, this.world.pointCount, this.world.triangleCount);
    this.drawSlice(this.finished, Math.min(1, this.finished + share));
    this.fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0);
    context.flush();
  }

  /** Draws everything, shaded. */
  drawAll() {
    this.setResolution(1);
    this.drawSlice(0, 1);
  }

  /** Draws a part of everything over what has been drawn, and shows it when it covers surfaces, and when it has doubled. */
  drawSlice(from, to) {
    const { eyeDome, renderer, scene, world } = this;
    const { camera } = this.cameraControls;
    this.prepare(1);
    world.slice(from, to);
    eyeDome.drawSurfaces(renderer, scene, camera, from > 0);
    world.slice(0, 1);
    if (from === 0) this.nextShown = COVERING;
    if (to === 1 || to >= this.nextShown) {
      this.nextShown = 2 * to;
      eyeDome.show(renderer, scene, camera, this.shades);
    }
    this.finished = to;
    if (to < 1) return;
    this.shaded = this.shades;
    this.shadesMoving = this.share === 1;
    this.onDrawn();
  }

  /** Draws as much as can be drawn smoothly. */
  draw() {
    this.prepare(this.share);
    this.world.thin(this.share, this.shadesMoving);
    const { eyeDome, renderer, scene } = this;
    const { camera } = this.cameraControls;
    this.shaded = this.shades && this.shadesMoving;
    if (this.shaded) {
      eyeDome.drawSurfaces(renderer, scene, camera, false);
      eyeDome.show(renderer, scene, camera, true);
    } else {
      renderer.render(scene, camera);
    }
    this.finished = this.share === 1 && this.resolution === 1 && this.shadesMoving ? 1 : 0;
    this.dirty = false;
    this.onDrawn();
  }

  /** Sets what shaders need to know; points are larger where only a share of them is drawn. */
  prepare(share) {
    const { uniforms } = this.world;
    uniforms.pixelsPerRadian.value = this.cameraControls.pixelsPerRadian(this.renderer.domElement.height);
    uniforms.pointSizeCm.value = this.pointSizeCm * Math.min(1, this.radiusM / ROOM_M) * Math.min(LARGEST, 1 / Math.sqrt(share));
    uniforms.lit.value = this.shades ? 1 : 0;
    const box = this.drawnBox();
    // Shaders that discard pixels are slow, since hidden ones must be computed, too.
    this.renderer.localClippingEnabled = [...box.min.toArray(), ...box.max.toArray()].some(Number.isFinite);
    this.world.clipTo(box);
  }

  /** What is drawn: inside the box, below the cut, and without the ceiling while that is seen from above. */
  drawnBox() {
    const seesCeiling = this.hidesCeiling && this.cameraControls.camera.position.y > this.ceilingM;
    const box = this.clip.clone();
    box.max.y = Math.min(box.max.y, this.cutAtM, seesCeiling ? this.ceilingM : Infinity);
    return box;
  }

  /** Whether a point of the map is drawn. */
  isShown(place) {
    return this.drawnBox().containsPoint(place);
  }

  /** Measures the map's extent, for its colours, the floor, the cut, and to fit it into the view. */
  measure() {
    this.stale = false;
    Object.assign(this, sampleMap(this.world));
    if (!this.box.isEmpty()) {
      this.world.uniforms.heightsM.value.set(this.box.min.y, this.box.max.y);
      this.floor.lay(this.box);
      this.cameraControls.setScale(this.radiusM);
    }
    this.ceilingM = this.isOriented ? ceilingOf(this.places, this.box) : undefined;
    this.cameraControls.places = this.contents();
    this.cameraControls.interior = this.isOriented ? this.interior() : undefined;
    if (!this.cameraControls.touched) this.cameraControls.fit();
    this.dirty = true;
    this.onMeasured();
  }

  get radiusM() {
    return this.box.isEmpty() ? ROOM_M : Math.max(1e-6, this.box.getSize(new Vector3()).length() / 2);
  }

  /** The visible content: points of the map inside the box and up to the cut, and the keyframes. */
  contents() {
    return this.places.filter((place) => place.y <= this.cutAtM && this.clip.containsPoint(place)).concat(this.keyframePlaces());
  }

  keyframePlaces() {
    const { poses, group } = this.world;
    return poses.matrices.map((pose) => new Vector3().setFromMatrixPosition(pose).applyMatrix4(group.matrixWorld));
  }

  /** The view from inside, computed only while it may be the one to show. */
  interior() {
    const { touched, interior, horizontalFieldRad } = this.cameraControls;
    if (touched) return interior;
    return interiorView(this.places, this.box, this.keyframePlaces(), horizontalFieldRad);
  }

  /** Size of a pixel at the centre of the view. */
  get metresPerPixel() {
    return this.cameraControls.distanceM / this.pixelsPerRadian;
  }

  /** Pixels of the page that an object of 1 m at a distance of 1 m covers. */
  get pixelsPerRadian() {
    return this.cameraControls.pixelsPerRadian(this.renderer.domElement.clientHeight);
  }

  /** The view as a PNG blob, with every point. */
  screenshot() {
    this.drawAll();
    return new Promise((resolve) => this.renderer.domElement.toBlob(resolve, 'image/png'));
  }
}
