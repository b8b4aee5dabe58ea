// A piece of the live mesh as a three.js object: coloured as the cloud, and lit from the viewpoint, which shows the
// shape of surfaces of one colour.

import { BufferAttribute, BufferGeometry, InterleavedBuffer, InterleavedBufferAttribute, Mesh, ShaderMaterial } from 'three';

import { coloring, pieceUniforms } from '../shared/cloudMaterial.js';
import { anchored } from '../shared/cloudPiece.js';

const vertexShader = `
  attribute float facing;
  ${coloring}
  uniform float lit;
  varying vec3 vWorld;

  // Octahedral coordinates, two signed bytes in one number.
  vec3 unpacked(float both) {
    float high = floor(both / 256.0);
    float low = both - 256.0 * high;
    vec2 p = vec2(low > 127.0 ? low - 256.0 : low, high) / 127.0;
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0) n.xy = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    return normalize(n);
  }

  void main() {
    const float darkest = 0.45;  // of surfaces seen edge-on
    vec4 world = modelMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * viewMatrix * world;
    vWorld = world.xyz;
    vec3 normal = normalize(mat3(modelMatrix) * unpacked(facing));
    float light = abs(dot(normal, normalize(cameraPosition - world.xyz)));
    vColor = shownColor(world.xyz) * mix(1.0, mix(darkest, 1.0, light), lit);
  }`;

const fragmentShader = `
  uniform vec3 clipLowM, clipHighM;
  varying vec3 vColor, vWorld;
  void main() {
    if (any(lessThan(vWorld, clipLowM)) || any(greaterThan(vWorld, clipHighM))) discard;
    gl_FragColor = vec4(vColor, 1.0);
    #include <colorspace_fragment>
  }`;

/** Makes a mesh of { unitM, origin, points (3 i16 and a normal each), colors (4 u8 each), triangles }. */
export function meshPiece(piece, shared) {
  const geometry = new BufferGeometry();
  const vertices = new InterleavedBuffer(piece.points, 4);
  geometry.setAttribute('position', new InterleavedBufferAttribute(vertices, 3, 0));
  geometry.setAttribute('facing', new InterleavedBufferAttribute(vertices, 1, 3));
  geometry.setAttribute('tint', new BufferAttribute(piece.colors, 4, true));
  geometry.setIndex(new BufferAttribute(piece.triangles, 1));
  const uniforms = { ...shared, ...pieceUniforms(piece) };
  return anchored(new Mesh(geometry, new ShaderMaterial({ uniforms, vertexShader, fragmentShader })), piece);
}
