// A large synthetic building for measurements of the viewer's page: rooms of 5 x 4 x 2.8 m side by side and on several
// floors, as many as the number of points or triangles asks for; surfaces are rough by 2 mm and have a pattern.
//
//   node bench/viewer_building.mjs points 50000000 cloud.ply       about one per cm^2
//   node bench/viewer_building.mjs triangles 10000000 mesh.ply     of 1.5 cm, with colours

import { once } from 'node:events';
import { createWriteStream } from 'node:fs';
import { pathToFileURL } from 'node:url';

const SIZE_M = [5, 4, 2.8];
const PER_ROOM = 900_000;
const ROUGH_M = 0.002;
const TILE_M = 0.4;
const FLOORS = 3;

/** The corners of the rooms. */
function roomsFor(count) {
  const rooms = Math.max(1, Math.round(count / PER_ROOM));
  const perFloor = Math.ceil(rooms / FLOORS);
  const width = Math.ceil(Math.sqrt(perFloor));
  return Array.from({ length: rooms }, (_, i) => {
    const [floor, place] = [Math.floor(i / perFloor), i % perFloor];
    return [SIZE_M[0] * (place % width), SIZE_M[1] * Math.floor(place / width), SIZE_M[2] * floor];
  });
}

/** The six faces of a room: { along: two axes, across: the third, at: where on it, areaM2 }. */
const FACES = [0, 1, 2].flatMap((across) =>
  [0, SIZE_M[across]].map((at) => {
    const along = [0, 1, 2].filter((axis) => axis !== across);
    return { along, across, at, areaM2: SIZE_M[along[0]] * SIZE_M[along[1]] };
  }),
);
const AREA_M2 = FACES.reduce((sum, { areaM2 }) => sum + areaM2, 0);

/** Writes the place at (u, v) m of a face and its colour: 15 bytes. */
function put(bytes, at, corner, face, u, v) {
  const place = [...corner];
  place[face.along[0]] += u;
  place[face.along[1]] += v;
  place[face.across] += face.at + ROUGH_M * (2 * Math.random() - 1);
  place.forEach((x, axis) => bytes.writeFloatLE(x, at + 4 * axis));
  const isDark = (Math.floor(u / TILE_M) + Math.floor(v / TILE_M)) % 2;
  [0, 1, 2].forEach((channel) => bytes.writeUInt8((isDark ? 90 : 190) + (channel === face.across ? 50 : 0), at + 12 + channel));
}

const head = (vertices, faces) => `ply
format binary_little_endian 1.0
comment frame z-up
element vertex ${vertices}
${['float x', 'float y', 'float z', 'uchar red', 'uchar green', 'uchar blue'].map((property) => `property ${property}\n`).join('')}${
  faces ? `element face ${faces}\nproperty list uchar int vertex_indices\n` : ''
}end_header
`;

function pointsOf(corner, count) {
  const bytes = Buffer.alloc(15 * count);
  let done = 0;
  FACES.forEach((face, i) => {
    const upTo = i === FACES.length - 1 ? count : done + Math.floor((count * face.areaM2) / AREA_M2);
    for (; done < upTo; ++done) put(bytes, 15 * done, corner, face, ...face.along.map((axis) => SIZE_M[axis] * Math.random()));
  });
  return bytes;
}

/** Columns and rows of vertices of each face. */
const gridsFor = (stepM) => FACES.map((face) => face.along.map((axis) => 1 + Math.max(1, Math.round(SIZE_M[axis] / stepM))));

function verticesOf(corner, grids) {
  return Buffer.concat(
    FACES.map((face, i) => {
      const [columns, rows] = grids[i];
      const bytes = Buffer.alloc(15 * columns * rows);
      for (let vertex = 0; vertex < columns * rows; ++vertex) {
        const [u, v] = [(vertex % columns) / (columns - 1), Math.floor(vertex / columns) / (rows - 1)];
        put(bytes, 15 * vertex, corner, face, u * SIZE_M[face.along[0]], v * SIZE_M[face.along[1]]);
      }
      return bytes;
    }),
  );
}

function trianglesOf(first, grids) {
  const triangles = [];
  let from = first;
  for (const [columns, rows] of grids) {
    for (let row = 0; row + 1 < rows; ++row) {
      for (let column = 0; column + 1 < columns; ++column) {
        const corner = from + row * columns + column;
        triangles.push([corner, corner + 1, corner + columns], [corner + 1, corner + columns + 1, corner + columns]);
      }
    }
    from += columns * rows;
  }
  const bytes = Buffer.alloc(13 * triangles.length);
  triangles.forEach((corners, i) => {
    bytes.writeUInt8(3, 13 * i);
    corners.forEach((vertex, k) => bytes.writeInt32LE(vertex, 13 * i + 1 + 4 * k));
  });
  return bytes;
}

async function* cloudOf(count) {
  const rooms = roomsFor(count);
  yield head(count);
  for (const [i, corner] of rooms.entries()) {
    const [from, to] = [i, i + 1].map((room) => Math.floor((count * room) / rooms.length));
    yield pointsOf(corner, to - from);
  }
}

async function* meshOf(count) {
  const rooms = roomsFor(count);
  const grids = gridsFor(Math.sqrt((2 * AREA_M2 * rooms.length) / count));
  const vertices = grids.reduce((sum, [columns, rows]) => sum + columns * rows, 0);
  const triangles = grids.reduce((sum, [columns, rows]) => sum + 2 * (columns - 1) * (rows - 1), 0);
  yield head(rooms.length * vertices, rooms.length * triangles);
  for (const corner of rooms) yield verticesOf(corner, grids);
  for (const i of rooms.keys()) yield trianglesOf(i * vertices, grids);
}

/** Writes a building of so many 'points' or 'triangles'. */
export async function writeBuilding(kind, count, path) {
  const file = createWriteStream(path);
  for await (const part of kind === 'triangles' ? meshOf(count) : cloudOf(count)) if (!file.write(part)) await once(file, 'drain');
  file.end();
  await once(file, 'finish');
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [kind, count, path] = process.argv.slice(2);
  await writeBuilding(kind, Number(count), path);
}
