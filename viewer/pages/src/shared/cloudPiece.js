// A piece of the cloud as a three.js object.

import { BufferAttribute, BufferGeometry, Box3, Matrix4, Points, Sphere, Vector3 } from 'three';

import { cloudMaterial } from './cloudMaterial.js';

/** Makes points of { count, unitM, origin, points (4 i16 each), colors (4 u8 each) }; see placePiece for the pose. */
export function cloudPiece(piece, shared) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(piece.points, 4));
  geometry.setAttribute('tint', new BufferAttribute(piece.colors, 4, true));
  const object = new Points(geometry, cloudMaterial(shared, piece));
  object.userData.count = piece.count;
  return anchored(object, piece);
}

/** Prepares an object of a piece's points for placePiece. */
export function anchored(object, { points, origin, unitM }) {
  object.geometry.boundingBox = boxOf(points);
  object.geometry.boundingSphere = object.geometry.boundingBox.getBoundingSphere(new Sphere());
  object.matrixAutoUpdate = false;
  object.userData.toAnchor = new Matrix4().makeTranslation(...origin).multiply(new Matrix4().makeScale(unitM, unitM, unitM));
  return object;
}

/** Moves a piece to the pose of its anchor. */
export function placePiece(object, anchor) {
  object.matrix.multiplyMatrices(anchor, object.userData.toAnchor);
  object.matrixWorldNeedsUpdate = true;
}

/** Draws the part of an object from one share of it to another; points are in random order, so it is a thinned cloud. */
export function drawPart({ geometry }, from, to) {
  const { index, attributes } = geometry;
  const [size, count] = index ? [3, index.count / 3] : [1, attributes.position.count];
  const [first, end] = [from, to].map((share) => Math.ceil(count * share));
  geometry.setDrawRange(size * first, size * (end - first));
}

function boxOf(points) {
  const box = new Box3();
  const p = new Vector3();
  for (let i = 0; i < points.length; i += 4) box.expandByPoint(p.fromArray(points, i));
  return box;
}
