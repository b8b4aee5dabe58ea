// The extent of the map without stray points, and the viewpoint that shows all of it.

import { Box3, Vector3 } from 'three';

const SAMPLES = 6000;
const FENCE = 0.05; // quantiles that determine the fences; up to this share of stray points on either side is
                    // tolerated
const LOWEST_CEILING_M = 1.9; // height of a room
const HIGHEST_CEILING_M = 8;
const CEILING_LAYER_M = 0.05;
const CEILING_FROM = 0.7; // of the map's height
const CEILING_SHARE = 0.04; // of the points, at least
const CEILING_TIMES = 2; // as many points as the walls have in a layer
const CEILING_SPAN = 0.5; // of the map's width and depth
const EDGE = 0.003; // share of the points inside the fences that may still be cut off on either side

/** { places, box }: a sample of the map without stray points, and its bounding box. */
export function sampleMap(world) {
  const all = samplePlaces(world);
  if (all.length === 0) return { places: [], box: new Box3() };
  const fences = spread(all, FENCE);
  fences.expandByVector(fences.getSize(new Vector3()).addScalar(1e-3));
  const inside = all.filter((place) => fences.containsPoint(place));
  const box = spread(inside, EDGE);
  return { places: inside.filter((place) => box.containsPoint(place)), box };
}

/**
 * The height of the lower side of the ceiling; undefined if the places have none: a layer high up that holds many more
 * of them than the walls below, and spans most of the box.
 */
export function ceilingOf(places, box) {
  const size = box.getSize(new Vector3());
  if (size.y < LOWEST_CEILING_M || size.y > HIGHEST_CEILING_M) return undefined;
  const layers = Array.from({ length: Math.ceil(size.y / CEILING_LAYER_M) + 1 }, () => []);
  for (const place of places) layers[Math.floor((place.y - box.min.y) / CEILING_LAYER_M)].push(place);
  const [low, high] = [0.5, CEILING_FROM].map((share) => Math.floor(share * layers.length));
  const ofWalls = layers.slice(low, high).reduce((sum, { length }) => sum + length, 0) / (high - low);
  const isCeiling = (layer, i) => {
    const inside = [...layer, ...(layers[i + 1] ?? [])];
    if (i < high || inside.length < Math.max(CEILING_SHARE * places.length, CEILING_TIMES * 2 * ofWalls)) return false;
    const span = spread(inside, FENCE).getSize(new Vector3());
    return span.x > CEILING_SPAN * size.x && span.z > CEILING_SPAN * size.z;
  };
  const found = layers.findIndex(isCeiling);
  return found < 0 ? undefined : box.min.y + (found - 1) * CEILING_LAYER_M;
}

/** The range between this quantile of each coordinate and its mirror image. */
function spread(places, quantile) {
  const box = new Box3();
  for (const axis of ['x', 'y', 'z']) {
    const sorted = Float64Array.from(places, (place) => place[axis]).sort();
    const last = sorted.length - 1;
    box.min[axis] = sorted[Math.floor(quantile * last)];
    box.max[axis] = sorted[Math.ceil((1 - quantile) * last)];
  }
  return box;
}

/** Samples points of every piece, which are in random order, and vertices of every mesh. */
function samplePlaces(world) {
  const places = [];
  const share = Math.min(1, SAMPLES / Math.max(1, world.pointCount));
  for (const { object } of world.pieces.values()) {
    if (!object.visible) continue;
    const { array } = object.geometry.attributes.position;
    for (let i = 0; i < Math.ceil(share * object.userData.count); ++i) {
      places.push(new Vector3().fromArray(array, 4 * i).applyMatrix4(object.matrixWorld));
    }
  }
  for (const [object, vertices] of world.meshes()) {
    for (let i = 0; i < vertices.count; i += Math.max(1, vertices.count / SAMPLES)) {
      places.push(new Vector3().fromBufferAttribute(vertices, Math.floor(i)).applyMatrix4(object.matrixWorld));
    }
  }
  return places;
}

/**
 * The nearest viewpoint that looks against `direction` with all points in view: { position, distance }, where distance
 * is to their centre. `tan`: half the width and height of the view at 1 m.
 */
export function frame(places, direction, tan) {
  const right = new Vector3(0, 1, 0).cross(direction).normalize();
  const up = direction.clone().cross(right);
  // A point is in view if |across| <= tan * (its distance along the view): two linear bounds per axis.
  const across = [right, up].map((axis, i) => {
    const reach = (sign) => places.reduce((most, place) => Math.max(most, sign * place.dot(axis) + tan[i] * place.dot(direction)), -Infinity);
    const [high, low] = [reach(1), reach(-1)];
    return { eye: (high - low) / 2, away: (high + low) / (2 * tan[i]) };
  });
  const away = Math.max(...across.map((axis) => axis.away));
  const middle = places.reduce((sum, place) => sum + place.dot(direction), 0) / places.length;
  const position = new Vector3().addScaledVector(right, across[0].eye).addScaledVector(up, across[1].eye).addScaledVector(direction, away);
  return { position, distance: away - middle };
}

/** The greatest of 1, 2, 5, 10, 20, 50, ... (and 0.5, 0.2, 0.1, ...) that is not above `length`. */
export function roundLength(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * [5, 2, 1].find((step) => step * power <= length * (1 + 1e-9));
}
