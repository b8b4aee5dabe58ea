// What is at a place on the screen: a keyframe, or a point of the cloud or mesh.

import { Matrix4, Ray, Raycaster, Vector2, Vector3 } from 'three';

const REACH_PX = 12; // of a point from the pointer
const KEYFRAME_REACH_PX = 12;
const LINE_REACH_PX = 6;
const CENTRAL = 0.02; // of its distance: a point in the middle wins against one that much nearer at the edge

/** Calls onClick(x, y), px from the corner of the canvas, on clicks that are no drags. */
export function listenToClicks(canvas, onClick) {
  const MOST_MOVED_PX = 4;
  let down;
  canvas.addEventListener('pointerdown', (event) => (down = event.isPrimary && event.button === 0 ? event : undefined));
  canvas.addEventListener('pointerup', (event) => {
    const moved = down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY);
    if (moved <= MOST_MOVED_PX) onClick(event.offsetX, event.offsetY);
    down = undefined;
  });
}

/** The index of the keyframe whose position is nearest to (x, y); undefined if none is near or shown. */
export function pickKeyframe(view, x, y) {
  const { camera } = view.cameraControls;
  const { clientWidth, clientHeight } = view.renderer.domElement;
  if (!view.world.layers.keyframes.visible) return undefined;
  let best = { px: KEYFRAME_REACH_PX };
  view.keyframePlaces().forEach((place, keyframe) => {
    const onScreen = place.project(camera);
    if (onScreen.z > 1) return; // behind the viewpoint
    const px = Math.hypot(((onScreen.x + 1) / 2) * clientWidth - x, ((1 - onScreen.y) / 2) * clientHeight - y);
    if (px < best.px) best = { px, keyframe };
  });
  return best.keyframe;
}

/** The loop of `lines` [loop, keyframe, keyframe] that passes nearest to (x, y), unless `place` hides it. */
export function pickLoop(view, x, y, lines, place) {
  const { camera } = view.cameraControls;
  const { clientWidth, clientHeight } = view.renderer.domElement;
  if (!view.world.layers.loops.visible) return undefined;
  const HIDDEN_M = 0.05; // so far behind the surface
  const limitM = place ? camera.position.distanceTo(place) + HIDDEN_M : Infinity;
  const raycaster = new Raycaster();
  raycaster.setFromCamera(new Vector2((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight), camera);
  const places = view.keyframePlaces();
  const pixelsPerRadian = view.cameraControls.pixelsPerRadian(clientHeight);
  let best = { px: LINE_REACH_PX };
  for (const [loop, a, b] of lines) {
    if (!places[a] || !places[b]) continue;
    const [onRay, onLine] = [new Vector3(), new Vector3()];
    raycaster.ray.distanceSqToSegment(places[a], places[b], onRay, onLine);
    const awayM = camera.position.distanceTo(onLine);
    const px = (pixelsPerRadian * onRay.distanceTo(onLine)) / Math.max(1e-6, awayM);
    if (px < best.px && awayM < limitM) best = { px, loop };
  }
  return best.loop;
}

/** The visible point of the map under (x, y), in the scene; undefined if there is none. */
export function pickPlace(view, x, y) {
  const { camera } = view.cameraControls;
  const { clientWidth, clientHeight } = view.renderer.domElement;
  const raycaster = new Raycaster();
  raycaster.setFromCamera(new Vector2((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight), camera);
  const reach = REACH_PX / view.cameraControls.pixelsPerRadian(clientHeight);
  const isShown = (place) => view.isShown(place);
  const best = { score: Infinity };
  const { cloud, mesh } = view.world.layers;
  if (cloud.visible) cloud.children.forEach((piece) => piece.visible && pickInPiece(piece, raycaster.ray, reach, isShown, best));
  if (mesh.visible) {
    const hit = raycaster.intersectObject(mesh, true).find(({ point }) => isShown(point));
    if (hit && hit.distance < best.score) best.place = hit.point;
  }
  return best.place;
}

/** Improves `best` { score, place } by the points within a cone of `reach` m at 1 m around the ray. */
function pickInPiece(piece, ray, reach, isShown, best) {
  const { origin, direction } = new Ray().copy(ray).applyMatrix4(new Matrix4().copy(piece.matrixWorld).invert());
  const unitM = piece.matrixWorld.getMaxScaleOnAxis();
  const { array } = piece.geometry.attributes.position;
  for (let i = 0; i < array.length; i += 4) {
    const [x, y, z] = [array[i] - origin.x, array[i + 1] - origin.y, array[i + 2] - origin.z];
    const along = x * direction.x + y * direction.y + z * direction.z;
    if (along <= 0) continue;
    const away = Math.sqrt(Math.max(0, x * x + y * y + z * z - along * along)) / (reach * along);
    const score = unitM * along * (1 + CENTRAL * away);
    if (away > 1 || score >= best.score) continue;
    const place = new Vector3().fromArray(array, i).applyMatrix4(piece.matrixWorld);
    if (isShown(place)) Object.assign(best, { score, place });
  }
}
