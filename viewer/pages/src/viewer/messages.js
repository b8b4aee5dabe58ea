// The messages of viewer/scene/wire_format.hpp: pieces are joined to parts, which are read in place without
// needless copies.

import { readCloud } from '../shared/readCloud.js';
import { matrixOf, poseFrom } from './poses.js';

const HEAD_BYTES = 32;
export const NO_KEYFRAME = 0xffffffff;

const readers = [
  ['hello', json],
  ['status', json],
  ['camera', floats],
  ['keyframes', floats],
  ['path', path],
  ['covisibility', words],
  ['loops', words],
  ['cloud', (buffer) => readCloud(buffer, HEAD_BYTES)],
  ['colorImage', jpeg],
  ['depthImage', jpeg],
  ['features', (buffer) => new Uint16Array(buffer, HEAD_BYTES)],
  ['truth', floats],
  ['truthPose', floats],
  ['mesh', mesh],
  ['model', (buffer) => buffer.slice(HEAD_BYTES)],
  ['doubt', words],
  ['keyframeImage', jpeg],
  ['timeline', timeline],
  ['loopTable', json],
  ['comparison', json],
  ['otherPath', floats],
  ['truthErrors', floats],
  ['meshPiece', meshPiece],
];

/** Adds a message to the part that has come so far: { version, buffer, received, complete }, sizes with the header. */
export function addPiece(part, message) {
  const head = new DataView(message, 0, HEAD_BYTES);
  const [version, bodyBytes, offset] = [8, 16, 24].map((at) => head.getFloat64(at, true));
  const received = offset + message.byteLength;
  const complete = received === HEAD_BYTES + bodyBytes;
  if (offset === 0 && complete) return { version, buffer: message, received, complete };
  const buffer = offset === 0 ? new ArrayBuffer(HEAD_BYTES + bodyBytes) : part.buffer;
  const from = offset === 0 ? 0 : HEAD_BYTES; // the first message's header becomes that of the part
  new Uint8Array(buffer).set(new Uint8Array(message, from), offset + from);
  return { version, buffer, received, complete };
}

/** The bytes of the body that have come. */
export function bodyBytesOf(part) {
  return part ? part.received - HEAD_BYTES : 0;
}

/** The parts, each with its header, that follow one another in a buffer. */
export function* partsOf(buffer) {
  for (let at = 0; at < buffer.byteLength; ) {
    const end = at + HEAD_BYTES + new DataView(buffer, at, HEAD_BYTES).getFloat64(16, true);
    yield buffer.slice(at, end); // arrays inside it are aligned
    at = end;
  }
}

/** A part as { kind, index, version, body }; undefined if the kind is unknown. */
export function decode(buffer) {
  const head = new DataView(buffer, 0, HEAD_BYTES);
  const reader = readers[head.getUint32(0, true)];
  if (!reader) return undefined;
  const [kind, read] = reader;
  return { kind, index: head.getUint32(4, true), version: head.getFloat64(8, true), body: read(buffer) };
}

function json(buffer) {
  return JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, HEAD_BYTES)));
}

function floats(buffer) {
  return new Float32Array(buffer, HEAD_BYTES);
}

function words(buffer) {
  return new Uint32Array(buffer, HEAD_BYTES);
}

/** Entry i: reference references[4 * i], position places[4 * i + 1 ... 4 * i + 3]. */
function path(buffer) {
  return { references: words(buffer), places: floats(buffer) };
}

function mesh(buffer) {
  const [vertices, triangles, colored] = new Uint32Array(buffer, HEAD_BYTES, 3);
  const at = HEAD_BYTES + 12;
  return {
    points: new Float32Array(buffer, at, 3 * vertices),
    triangles: new Uint32Array(buffer, at + 12 * vertices, 3 * triangles),
    colors: colored ? new Uint8Array(buffer, at + 12 * (vertices + triangles), 4 * vertices) : undefined,
  };
}

/** Its vertices as those of a cloud, and triangles: three of their indices each. */
function meshPiece(buffer) {
  const vertices = readCloud(buffer, HEAD_BYTES);
  return { ...vertices, triangles: new Uint16Array(buffer, vertices.end) };
}

/** The frames of a saved run as arrays, and pose(i): a matrix, undefined if frame i has none. */
function timeline(buffer) {
  const WORDS = 16; // per frame
  const [doubles, singles, integers] = [new Float64Array(buffer, HEAD_BYTES), floats(buffer), words(buffer)];
  const count = singles.length / WORDS;
  const every = (Kind, numbers, stride, first) => Kind.from({ length: count }, (_, i) => numbers[stride * i + first]);
  return {
    count,
    stampS: every(Float64Array, doubles, WORDS / 2, 0),
    status: every(Uint8Array, integers, WORDS, 2),
    keyframe: every(Uint32Array, integers, WORDS, 3),
    tracked: every(Float32Array, singles, WORDS, 4),
    sigmaM: every(Float32Array, singles, WORDS, 5),
    ms: every(Float32Array, singles, WORDS, 6),
    errorM: every(Float32Array, singles, WORDS, 7),
    pose: (i) => (Number.isNaN(singles[WORDS * i + 9]) ? undefined : matrixOf(poseFrom(singles, WORDS * i + 9))),
  };
}

function jpeg(buffer) {
  return new Blob([new Uint8Array(buffer, HEAD_BYTES)], { type: 'image/jpeg' });
}
