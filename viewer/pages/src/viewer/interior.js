// The first view of a room: from inside, at eye height, towards the largest open space.

import { Vector3 } from 'three';

const EYE_M = 1.6; // above the floor, if no camera positions are known
const BELOW_M = 1; // obstacles between this far below the eyes and that far above
const ABOVE_M = 0.4;
const SECTORS = 36;
const NEAREST = 0.1; // quantile of the distances in a sector that counts as its obstacle: points may be stray
const FEWEST_POINTS = 3; // in a sector; with fewer it counts as unmapped
const CLOSED = 0.6; // share of mapped sectors around someone in a room
const OPEN_M = 1; // least mean distance to look into
const AWAY_M = 0.4; // from the wall behind
const MOST_BACK_M = 2;
const MOST_STANDS = 40;
const LOOKING_DOWN = 0.12; // tangent
const PIVOT = 0.4; // of the open distance, about which the view turns

/**
 * The viewpoint { position, target } for `places` (points of the map) within `box`, with y up; undefined if that is no
 * room. `stands`: positions of the camera, which are free; may be empty. `fieldRad`: horizontal field of view.
 */
export function interiorView(places, box, stands, fieldRad) {
  if (places.length === 0) return undefined;
  const half = Math.max(1, Math.round((fieldRad / (2 * Math.PI)) * SECTORS) >> 1);
  let best = { openM: 0 };
  for (const eye of candidates(box, stands)) {
    const distances = obstacles(places, eye);
    if (distances.filter((distance) => distance > 0).length < CLOSED * SECTORS) continue;
    for (let sector = 0; sector < SECTORS; ++sector) {
      const field = Array.from({ length: 2 * half + 1 }, (_, i) => distances.at((sector - half + i) % SECTORS));
      const openM = field.reduce((sum, distance) => sum + distance, 0) / field.length;
      if (openM > best.openM) best = { openM, eye, sector, distances };
    }
  }
  return best.openM < OPEN_M ? undefined : viewpoint(best);
}

function viewpoint({ openM, eye, sector, distances }) {
  const angle = ((sector + 0.5) / SECTORS) * 2 * Math.PI;
  const direction = new Vector3(Math.cos(angle), -LOOKING_DOWN, Math.sin(angle));
  const behind = [-1, 0, 1].map((side) => distances.at((sector + SECTORS / 2 + side) % SECTORS));
  const backM = Math.min(MOST_BACK_M, Math.max(0, Math.min(...behind) - AWAY_M));
  const position = new Vector3(eye.x - backM * direction.x, eye.y, eye.z - backM * direction.z);
  return { position, target: position.clone().addScaledVector(direction, PIVOT * (openM + backM)) };
}

/** Places to stand: where the camera was, or the cells of the floor. */
function candidates(box, stands) {
  if (stands.length > 0) {
    const heights = stands.map(({ y }) => y).sort((a, b) => a - b);
    const eyeM = heights[heights.length >> 1];
    const every = Math.ceil(stands.length / MOST_STANDS);
    return stands.filter((_, i) => i % every === 0).map(({ x, z }) => new Vector3(x, eyeM, z));
  }
  const shares = [0.15, 0.3, 0.5, 0.7, 0.85];
  const size = box.getSize(new Vector3());
  if (size.y < EYE_M + ABOVE_M) return [];
  return shares.flatMap((u) => shares.map((v) => new Vector3(box.min.x + u * size.x, box.min.y + EYE_M, box.min.z + v * size.z)));
}

/** For each sector around the eye, the distance of its nearest obstacle; 0 if nothing is mapped there. */
function obstacles(places, eye) {
  const found = Array.from({ length: SECTORS }, () => []);
  for (const { x, y, z } of places) {
    if (y < eye.y - BELOW_M || y > eye.y + ABOVE_M) continue;
    const turn = Math.atan2(z - eye.z, x - eye.x) / (2 * Math.PI);
    found[Math.floor((turn - Math.floor(turn)) * SECTORS) % SECTORS].push(Math.hypot(x - eye.x, z - eye.z));
  }
  return found.map((distances) => {
    if (distances.length < FEWEST_POINTS) return 0;
    return distances.sort((a, b) => a - b)[Math.floor(NEAREST * distances.length)];
  });
}
