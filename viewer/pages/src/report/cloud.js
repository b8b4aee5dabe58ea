// The map as a rotatable cloud. Print shows pictures of it instead.

import { Box3, Matrix4, PerspectiveCamera, Quaternion, Scene, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

import { sharedUniforms } from '../shared/cloudMaterial.js';
import { cloudPiece, placePiece } from '../shared/cloudPiece.js';
import { count } from '../shared/format.js';
import { readCloud } from '../shared/readCloud.js';
import { element, figure, problem, section } from './page.js';

const FIELD_OF_VIEW_DEG = 45;
const HEIGHT_BY_WIDTH = 0.55;

export function cloudSection([run]) {
  if (!run.cloud) return undefined;
  const piece = readCloud(Uint8Array.from(atob(run.cloud), (character) => character.charCodeAt(0)).buffer, 0);
  const canvas = element('canvas', { class: 'cloud', tabindex: '0', 'aria-label': '3D map' });
  const shown = figure(canvas, `${count(piece.count)} points, up to just above the highest camera position. Drag to rotate, scroll to zoom, right-drag to pan.`);
  requestAnimationFrame(() => tryToShow(canvas, piece, run.up)); // once the canvas has a size
  const made = section('3D map', shown);
  made.classList.add('screen-only');
  return made;
}

/** Not every browser has WebGL. */
function tryToShow(canvas, piece, up) {
  try {
    show(canvas, piece, up);
  } catch (error) {
    canvas.replaceWith(problem('The map', error));
  }
}

function show(canvas, piece, up) {
  const uniforms = sharedUniforms();
  const points = cloudPiece(piece, uniforms);
  placePiece(points, new Matrix4().makeRotationFromQuaternion(new Quaternion().setFromUnitVectors(new Vector3(...up), new Vector3(0, 1, 0))));
  points.updateMatrixWorld(true);
  const box = new Box3().setFromObject(points);

  // The drawing buffer is kept, since a screenshot or a test may ask for it at any time.
  const renderer = new WebGLRenderer({ canvas, alpha: true, preserveDrawingBuffer: true });
  const eye = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1 / HEIGHT_BY_WIDTH, 0.05, 500);
  const controls = new OrbitControls(eye, canvas);
  box.getCenter(controls.target);
  const distance = (0.5 * box.getSize(new Vector3()).length()) / Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360);
  eye.position.copy(controls.target).addScaledVector(new Vector3(0.3, 0.75, 0.6).normalize(), 0.7 * distance);
  controls.update();

  const scene = new Scene().add(points);
  const drawNow = () => renderer.render(scene, eye);
  const resize = () => {
    const width = canvas.clientWidth;
    renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    renderer.setSize(width, width * HEIGHT_BY_WIDTH, false);
    uniforms.pixelsPerRadian.value = canvas.height / (2 * Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360));
    drawNow();
  };
  uniforms.pointSizeCm.value = 2.2;
  controls.addEventListener('change', drawNow);
  addEventListener('resize', resize);
  resize();
}
