// A piece of the cloud in kinloop's format (encode_cloud in viewer/scene/wire_format.hpp), read without
// copying.

const HEAD_BYTES = 24;

/** { anchor, count, unitM, origin, points (4 i16 each), colors (4 u8 each), end } from the bytes at offset `at`. */
export function readCloud(buffer, at) {
  const head = new DataView(buffer, at, HEAD_BYTES);
  const count = head.getUint32(4, true);
  return {
    anchor: head.getUint32(0, true),
    count,
    unitM: head.getFloat32(8, true),
    origin: [12, 16, 20].map((offset) => head.getFloat32(offset, true)),
    points: new Int16Array(buffer, at + HEAD_BYTES, 4 * count),
    colors: new Uint8Array(buffer, at + HEAD_BYTES + 8 * count, 4 * count),
    end: at + HEAD_BYTES + 12 * count, // offset of what follows
  };
}
