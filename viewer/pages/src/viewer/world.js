// The map as three.js objects, updated message by message.

import { Box3, Group, Layers, Matrix4, Plane, Quaternion, Vector3 } from 'three';

import { FAR_M, sharedUniforms } from '../shared/cloudMaterial.js';
import { cloudPiece, drawPart, placePiece } from '../shared/cloudPiece.js';
import { roundLength } from './framing.js';
import { KeyframePictures } from './keyframePictures.js';
import { Lines } from './lines.js';
import { NO_KEYFRAME } from './messages.js';
import { meshPiece } from './meshPiece.js';
import { meshOf, readModel } from './models.js';
import { matrixOf, PART_LENGTH, poseFrom, Poses } from './poses.js';
import { CAMERA_SIZE_M, ShownCamera } from './shownCamera.js';

const COLORS = { path: 0x4aa8ff, doubt: 0xe05252, keyframes: 0x7fd0a0, camera: 0xff3d8b, covisibility: 0x6f7f9f, truth: 0xb9bcc4, otherPath: 0xff9d2e, errors: 0xe0459b };
const LOOP_COLORS = { accepted: 0xff8a3d, provisional: 0xb48cff, rejected: 0xe05252, withdrawn: 0x8f96a3 };
const SELECTED = 0xffc400;
const DASH_M = 0.04;
const KEYFRAME_SIZE_M = 0.06;
const ERROR_SHARE = 0.1; // of the path's extent that the longest error arrow has at most
const COARSE = 1; // index of the message of a mesh that stands in for the other
const OWN_WORLD = new Matrix4();
const SHOWN = new Layers().mask; // of an object that the camera sees

export class World {
  constructor() {
    this.uniforms = sharedUniforms();
    // Of meshes: those of the lower bounds, then of the upper ones. Points use uniforms.
    this.clipPlanes = [1, -1].flatMap((sign) => [0, 1, 2].map((axis) => new Plane(new Vector3().setComponent(axis, sign))));
    this.group = new Group(); // rotated so that up points up
    this.layers = {};
    for (const name of ['cloud', 'mesh', 'path', 'otherPath', 'keyframes', 'images', 'covisibility', 'loops', 'truth', 'errors', 'boxes']) {
      this.layers[name] = new Group();
      this.group.add(this.layers[name]);
    }
    this.layers.covisibility.visible = false;
    this.layers.images.visible = false;
    this.layers.errors.visible = false;
    this.pictures = new KeyframePictures(this.layers.images);
    this.lines = {
      path: new Lines({ color: COLORS.path }),
      doubt: new Lines({ color: COLORS.doubt, segments: true }),
      keyframes: new Lines({ color: COLORS.keyframes, segments: true, opacity: 0.7 }),
      covisibility: new Lines({ color: COLORS.covisibility, segments: true, opacity: 0.5 }),
      truth: new Lines({ color: COLORS.truth }),
      otherPath: new Lines({ color: COLORS.otherPath }),
      errors: new Lines({ color: COLORS.errors, segments: true }),
    };
    const layerOf = { doubt: 'path' };
    for (const [name, lines] of Object.entries(this.lines)) this.layers[layerOf[name] ?? name].add(lines.object);
    this.loopLines = {};
    for (const [status, color] of Object.entries(LOOP_COLORS)) {
      this.loopLines[status] = new Lines({ color, segments: true, opacity: status === 'accepted' ? 0.3 : 0.8 });
      this.layers.loops.add(this.loopLines[status].object);
    }
    this.selectedLines = selectionLines();
    this.layers.loops.add(this.selectedLines.object);
    this.boxLines = selectionLines();
    this.layers.boxes.add(this.boxLines.object);
    // The second is that of the run that is compared with the first.
    this.cameras = [new ShownCamera(this.layers.path, COLORS.camera, addFrustum), new ShownCamera(this.layers.otherPath, COLORS.otherPath, addFrustum)];
    this.lines.doubt.object.renderOrder = 1; // over the path, at the same places
    this.onProblem = () => {}; // (text)
    this.clear();
  }

  /** Removes everything of a run. */
  clear() {
    this.poses = new Poses();
    this.pieces = new Map(); // index -> { object, anchor }, of the cloud
    this.meshPieces = new Map(); // the same of a mesh that grows
    this.models = [];
    this.coarse = undefined;
    this.parts = { path: [], covisibility: [] };
    this.loops = new Uint32Array(0);
    this.showLoops({});
    this.doubt = new Uint32Array(0);
    this.truth = new Float32Array(0);
    this.truthPose = OWN_WORLD;
    this.otherPath = new Float32Array(0);
    this.errors = new Float32Array(0);
    this.differences = {}; // names of the layers of a comparison -> { first, end, shown }
    this.boxes = [];
    this.cameras.forEach((camera) => camera.clear());
    this.frustum = [0.6, 0.45];
    for (const layer of [this.layers.cloud, this.layers.mesh]) {
      layer.traverse(dispose);
      layer.clear();
    }
    this.pictures.clear();
    this.moved = true;
  }

  /** Processes one message. */
  take({ kind, index, body }) {
    const take = {
      hello: () => (this.frustum = body.frustum),
      status: () => this.setUp(new Vector3(...body.up)),
      camera: () => this.cameras[0].move(matrixOf(poseFrom(body))),
      keyframes: () => this.poses.take(index, body),
      path: () => (this.parts.path[index] = body),
      covisibility: () => (this.parts.covisibility[index] = body),
      loops: () => this.showLoops({ accepted: (this.loops = body) }),
      doubt: () => (this.doubt = body),
      cloud: () => this.takePiece(this.pieces, this.layers.cloud, index, body, cloudPiece),
      meshPiece: () => this.takePiece(this.meshPieces, this.layers.mesh, index, body, meshPiece),
      mesh: () => (index === COARSE ? this.addCoarse(body) : this.addModel(meshOf(body, this.clipPlanes))),
      model: () => this.takeModel(body),
      truth: () => (this.truth = body),
      otherPath: () => (this.otherPath = body),
      truthErrors: () => (this.errors = body),
      keyframeImage: () => this.pictures.take(index, body),
      truthPose: () => (this.truthPose = matrixOf(poseFrom(body))),
    }[kind];
    if (!take) return;
    take();
    this.moved = true;
  }

  /** Draws loops: pairs of keyframes by status, and the selected pair if there is one. */
  showLoops(edges, selected) {
    this.loopEdges = edges;
    this.selectedLoop = selected;
    this.moved = true;
  }

  /** `pieces`: the range [first, end) of the cloud's pieces that each layer of a comparison has. */
  showDifferences(pieces) {
    this.differences = Object.fromEntries(Object.entries(pieces).map(([layer, [first, end]]) => [layer, { first, end, shown: true }]));
    this.cameras[0].paint(COLORS.path); // as its path
    this.moved = true;
  }

  /** Shows or hides a layer of a comparison. */
  showDifference(layer, shown) {
    this.differences[layer].shown = shown;
    this.moved = true;
  }

  /** Draws boxes, each eight corners in the world with x alternating fastest; missing ones are left out. */
  selectBoxes(boxes) {
    this.boxes = boxes.filter((box) => box);
    this.moved = true;
  }

  /** Replaces a piece in `pieces` and in their layer by what `make` makes of it; an empty one only removes it. */
  takePiece(pieces, layer, index, piece, make) {
    const before = pieces.get(index);
    if (before) {
      layer.remove(before.object);
      dispose(before.object);
      pieces.delete(index);
    }
    if (piece.count === 0) return;
    const object = make(piece, this.uniforms);
    pieces.set(index, { object, anchor: piece.anchor });
    layer.add(object);
  }

  async takeModel(buffer) {
    try {
      this.addModel(await readModel(buffer, this.clipPlanes));
    } catch (error) {
      this.onProblem(`The mesh cannot be shown: ${error.message}`);
    }
  }

  /** Takes what stands in for a mesh until that comes, and while it takes too long to draw. */
  addCoarse(body) {
    this.coarse = meshOf(body, this.clipPlanes);
    this.layers.mesh.add(this.coarse);
  }

  addModel(model) {
    this.models.push(model);
    this.layers.mesh.add(model);
    this.moved = true;
  }

  /** Whether there is anything in a layer. */
  has(layer) {
    return {
      cloud: this.pieces.size > 0,
      mesh: this.models.length + this.meshPieces.size > 0 || this.coarse !== undefined,
      path: this.parts.path.length > 0,
      keyframes: this.poses.count > 0,
      images: this.pictures.count > 0,
      covisibility: this.parts.covisibility.length > 0,
      loops: Object.values(this.loopEdges).some((pairs) => pairs.length > 0),
      truth: this.truth.length > 0,
      otherPath: this.otherPath.length > 0,
      errors: this.errors.length > 0,
    }[layer];
  }

  /** Draws only what is inside the box, which may be unbounded. */
  clipTo({ min, max }) {
    this.uniforms.clipLowM.value.copy(min).clampScalar(-FAR_M, FAR_M);
    this.uniforms.clipHighM.value.copy(max).clampScalar(-FAR_M, FAR_M);
    const [low, high] = [this.uniforms.clipLowM.value.toArray(), this.uniforms.clipHighM.value.toArray()];
    this.clipPlanes.forEach((plane, i) => (plane.constant = i < 3 ? -low[i] : high[i - 3]));
  }

  /** Pairs of a model's object and its vertices. */
  meshes() {
    const found = [];
    const take = (object) => object.geometry && found.push([object, object.geometry.attributes.position]);
    if (this.models.length === 0 && this.coarse) take(this.coarse);
    this.models.forEach((model) => model.traverse(take));
    return found;
  }

  /** Rotates the world so that `up` is three.js's y; ignores small corrections, which would make it sway. */
  setUp(up) {
    const NOTICEABLE = 0.03; // rad
    const turn = new Quaternion().setFromUnitVectors(up, new Vector3(0, 1, 0));
    if (turn.angleTo(this.group.quaternion) > NOTICEABLE) this.group.quaternion.copy(turn);
    this.moved = true;
  }

  /** Moves objects to their current poses; returns true if anything changed. */
  advance(seconds) {
    const glided = this.poses.advance(seconds);
    if (!glided && !this.moved) return false;
    this.moved = false;
    this.placePieces();
    this.drawFrusta();
    this.drawPath();
    this.drawEdges();
    this.drawTruth();
    this.drawErrors();
    this.boxLines.fill((add) => this.boxes.forEach((corners) => addBox(add, corners)));
    this.pictures.place(this.poses, this.frustum);
    this.group.updateMatrixWorld(true);
    return true;
  }

  placePieces() {
    const hidden = Object.values(this.differences).filter(({ shown }) => !shown);
    for (const [index, piece] of this.pieces) this.place(piece, !hidden.some(({ first, end }) => first <= index && index < end));
    for (const piece of this.meshPieces.values()) this.place(piece, true);
  }

  /** Moves a piece to its anchor; it is visible if that is known. */
  place({ object, anchor }, visible) {
    const pose = anchor === NO_KEYFRAME ? OWN_WORLD : this.poses.at(anchor);
    object.visible = pose !== undefined && visible;
    if (pose) placePiece(object, pose);
    object.material.uniforms.timeShare.value = anchor / Math.max(1, this.poses.count - 1);
  }

  drawFrusta() {
    this.lines.keyframes.fill((add) => {
      for (const pose of this.poses.matrices) addFrustum(add, pose, this.frustum, KEYFRAME_SIZE_M);
    });
    this.cameras.forEach((camera) => camera.draw(this.frustum));
  }

  get cameraPose() {
    return this.cameras[0].pose;
  }

  /** Moves a camera alone; undefined: there is none. */
  moveCamera(pose, camera = 0) {
    this.cameras[camera].move(pose);
    this.cameras[camera].draw(this.frustum);
  }

  /** Shows the image of a keyframe in a camera's frustum. */
  showCameraPicture(keyframe, camera = 0) {
    return this.cameras[camera].show(keyframe, this.pictures.of(keyframe));
  }

  drawPath() {
    this.lines.path.fill((add) => this.eachPlace((place) => add(place)));
    this.lines.doubt.fill((add) => {
      const isInDoubt = inRanges(this.doubt);
      let before;
      let inDoubt = false; // since the last place: lost frames have none
      this.eachPlace(
        (place) => {
          if (before && inDoubt) [before, place].forEach(add);
          before = place.clone();
          inDoubt = false;
        },
        (frame) => (inDoubt ||= isInDoubt(frame)),
      );
    });
  }

  /** Calls onFrame(index) for every frame of the path, in order, and then onPlace(position) if it has one. */
  eachPlace(onPlace, onFrame = () => {}) {
    const point = new Vector3();
    this.parts.path.forEach(({ references, places }, part) => {
      for (let i = 0; i < references.length; i += 4) {
        onFrame(part * PART_LENGTH + i / 4);
        const pose = references[i] === NO_KEYFRAME ? OWN_WORLD : this.poses.at(references[i]);
        if (pose && !Number.isNaN(places[i + 1])) onPlace(point.fromArray(places, i + 1).applyMatrix4(pose));
      }
    });
  }

  drawEdges() {
    const addPairs = (add, pairs, addLine = addWhole) => {
      for (let i = 0; i < pairs.length; i += 2) {
        const [a, b] = [this.poses.at(pairs[i]), this.poses.at(pairs[i + 1])];
        if (a && b) addLine(add, ...[a, b].map((pose) => new Vector3().setFromMatrixPosition(pose)));
      }
    };
    for (const [status, lines] of Object.entries(this.loopLines)) {
      lines.fill((add) => addPairs(add, this.loopEdges[status] ?? [], status === 'accepted' ? addWhole : addDashes));
    }
    this.selectedLines.fill((add) => {
      if (!this.selectedLoop) return;
      addPairs(add, this.selectedLoop);
      for (const keyframe of this.selectedLoop) {
        if (this.poses.at(keyframe)) addFrustum(add, this.poses.at(keyframe), this.frustum, CAMERA_SIZE_M);
      }
    });
    this.lines.covisibility.fill((add) => this.parts.covisibility.forEach((pairs) => addPairs(add, pairs)));
  }

  drawTruth() {
    const point = new Vector3();
    this.lines.truth.fill((add) => {
      for (let i = 0; i < this.truth.length; i += 3) add(point.fromArray(this.truth, i).applyMatrix4(this.truthPose));
    });
    this.lines.otherPath.fill((add) => {
      for (let i = 0; i < this.otherPath.length; i += 3) add(point.fromArray(this.otherPath, i));
    });
  }

  /** Arrows from estimated to true positions, which are millimetres apart and therefore magnified. */
  drawErrors() {
    const ends = Array.from({ length: this.errors.length / 3 }, (_, i) => new Vector3().fromArray(this.errors, 3 * i));
    const longestM = ends.reduce((most, end, i) => (i % 2 ? Math.max(most, end.distanceTo(ends[i - 1])) : most), 1e-9);
    const extentM = new Box3().setFromPoints(ends).getSize(new Vector3()).length();
    this.errorFactor = Math.max(1, roundLength(Math.max(1, (ERROR_SHARE * extentM) / longestM)));
    this.lines.errors.fill((add) => {
      for (let i = 0; i < ends.length; i += 2) {
        const tip = ends[i].clone().addScaledVector(ends[i + 1].clone().sub(ends[i]), this.errorFactor);
        addArrow(add, ends[i], tip);
      }
    });
  }

  get pointCount() {
    return [...this.pieces.values()].reduce((sum, { object }) => sum + object.userData.count, 0);
  }

  get triangleCount() {
    const count = ({ geometry }) => (geometry.index ?? geometry.attributes.position).count / 3;
    const pieces = [...this.meshPieces.values()].reduce((sum, { object }) => sum + count(object), 0);
    return this.meshes().reduce((sum, [object]) => sum + count(object), pieces);
  }

  /** Draws that share of all points. Unless `all`: no mesh that grows beside them, and of others the coarse one if any. */
  thin(share, all) {
    this.drawPoints(0, share);
    this.showMeshes(all || !this.layers.cloud.visible, all);
  }

  /** Draws the part from one share to another of all points and triangles, and for these no stand-in. */
  slice(from, to) {
    this.drawPoints(from, to);
    for (const { object } of this.meshPieces.values()) drawPart(object, from, to);
    for (const [object] of this.meshes()) drawPart(object, from, to);
    this.showMeshes(true, true);
  }

  /**
   * Draws the part from one share to another of all points. A piece of a saved cloud is a sample of all of it, so that few
   * pieces do, and few calls of the graphics card; of other pieces, that part of each is drawn.
   */
  drawPoints(from, to) {
    const isSample = ({ anchor }) => anchor === NO_KEYFRAME && Object.keys(this.differences).length === 0;
    const pieces = [...this.pieces.values()];
    const total = pieces.filter(isSample).reduce((sum, { object }) => sum + object.userData.count, 0);
    let before = 0;
    for (const piece of pieces) {
      const { object } = piece;
      const { count } = object.userData;
      const own = isSample(piece) ? [from, to].map((share) => Math.min(1, Math.max(0, (share * total - before) / count))) : [from, to];
      if (isSample(piece)) before += count;
      drawPart(object, ...own);
      object.layers.mask = own[1] > own[0] ? SHOWN : 0;
    }
  }

  /** Shows or hides the mesh that grows, and shows others as they are, or coarse. */
  showMeshes(growing, fine) {
    for (const { object } of this.meshPieces.values()) object.layers.mask = growing ? SHOWN : 0;
    if (!this.coarse) return;
    const isCoarse = !fine || this.models.length === 0;
    this.coarse.layers.mask = isCoarse ? SHOWN : 0;
    this.models.forEach((model) => (model.layers.mask = isCoarse ? 0 : SHOWN));
  }
}

/** A function that tells of increasing numbers whether one of the ranges [first, end, first, end ...) holds them. */
function inRanges(ranges) {
  let at = 0;
  return (number) => {
    while (at < ranges.length && ranges[at + 1] <= number) at += 2;
    return at < ranges.length && ranges[at] <= number;
  };
}

/** Releases what the renderer keeps of an object, which it would otherwise keep forever. */
function dispose({ geometry, material }) {
  geometry?.dispose();
  material?.map?.dispose();
  material?.dispose();
}

function addWhole(add, from, to) {
  [from, to].forEach(add);
}

/** Lines that are drawn also behind surfaces. */
function selectionLines() {
  const lines = new Lines({ color: SELECTED, segments: true });
  lines.object.material.depthTest = false;
  lines.object.renderOrder = 2;
  return lines;
}

/** A line with a head of two strokes. */
function addArrow(add, from, to) {
  const HEAD = 0.25; // of its length
  const along = new Vector3().subVectors(to, from).multiplyScalar(HEAD);
  const across = new Vector3(along.z, 0, -along.x); // level, also of a steep arrow: an upright one gets another
  if (across.lengthSq() < 1e-2 * along.lengthSq()) across.set(along.length(), 0, 0);
  across.setLength(0.5 * along.length());
  addWhole(add, from, to);
  for (const sign of [1, -1]) addWhole(add, to, to.clone().sub(along).addScaledVector(across, sign));
}

/** The twelve edges of a box: corners that differ in one coordinate, which is one bit of their number. */
function addBox(add, corners) {
  const places = corners.map((corner) => new Vector3(...corner));
  for (let i = 0; i < places.length; ++i) {
    for (const bit of [1, 2, 4]) if (!(i & bit)) addWhole(add, places[i], places[i | bit]);
  }
}

/** A dashed line. */
function addDashes(add, from, to) {
  const MOST = 500;
  const steps = Math.min(MOST, Math.max(3, Math.ceil(from.distanceTo(to) / DASH_M) | 1));
  for (let i = 0; i < steps; i += 2) [i, i + 1].forEach((step) => add(new Vector3().lerpVectors(from, to, step / steps)));
}

/** The eight edges of a pyramid that looks along z; `frustum`: half its width and height at z = 1. */
function addFrustum(add, pose, [x, y], size) {
  const [apex, ...corners] = [[0, 0, 0], [-x, -y, 1], [x, -y, 1], [x, y, 1], [-x, y, 1]].map((corner) =>
    new Vector3(...corner).multiplyScalar(size).applyMatrix4(pose),
  );
  corners.forEach((corner, i) => [apex, corner, corner, corners[(i + 1) % corners.length]].forEach(add));
}
