// Point rendering: size and colour, in one shader shared by the live viewer and the report. Pieces of the live mesh
// have the same colours.

import { ShaderMaterial, Vector2, Vector3 } from 'three';

/** Colour modes; the index in this list is the shader's `mode`. */
export const COLOR_MODES = ['camera', 'height', 'depth', 'time'];

/** Stands for no clipping: a shader need not know infinity. */
export const FAR_M = 1e9;

/** The colour of a vertex, and clipping, for the vertex shaders of clouds and meshes. */
export const coloring = `
  attribute vec4 tint;
  uniform float unitM, timeShare;
  uniform vec3 origin, clipLowM, clipHighM;
  uniform vec2 heightsM;
  uniform int mode;
  varying vec3 vColor;

  // A fit to the colour map Turbo (Mikhailov 2019), from blue for 0 to red for 1.
  vec3 turbo(float x) {
    vec4 v4 = vec4(1.0, x, x * x, x * x * x);
    vec2 v2 = v4.zw * v4.z;
    return vec3(
      dot(v4, vec4(0.13572138, 4.61539260, -42.66032258, 132.13108234)) + dot(v2, vec2(-152.94239396, 59.28637943)),
      dot(v4, vec4(0.09140261, 2.19418839, 4.84296658, -14.18503333)) + dot(v2, vec2(4.27729857, 2.82956604)),
      dot(v4, vec4(0.10667330, 12.64194608, -60.58204836, 110.36276771)) + dot(v2, vec2(-89.90310912, 27.34824973)));
  }

  // Colours as they are stored, in the light that three.js computes with.
  vec3 linear(vec3 srgb) {
    return mix(pow((srgb + 0.055) / 1.055, vec3(2.4)), srgb / 12.92, step(srgb, vec3(0.04045)));
  }

  bool isClipped(vec3 world) {
    return any(lessThan(world, clipLowM)) || any(greaterThan(world, clipHighM));
  }

  vec3 shownColor(vec3 world) {
    const float farthestM = 4.5;  // that a Kinect sees
    float height = (world.y - heightsM.x) / max(heightsM.y - heightsM.x, 0.01);
    float nearness = 1.0 - (origin.z + position.z * unitM) / farthestM;
    float share = mode == 1 ? height : mode == 2 ? nearness : timeShare;
    return linear(mode == 0 ? tint.rgb : clamp(turbo(clamp(share, 0.0, 1.0)), 0.0, 1.0));
  }`;

const vertexShader = `
  uniform float pointSizeCm, pixelsPerRadian;
  ${coloring}

  void main() {
    const float smallest = sqrt(2.0);  // px: a smaller disc may cover no pixel's centre, and the point vanishes
    vec4 world = modelMatrix * vec4(position, 1.0);
    vec4 eye = viewMatrix * world;
    gl_Position = isClipped(world.xyz) ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * eye;  // 2: out of sight
    gl_PointSize = clamp(0.01 * pointSizeCm * pixelsPerRadian / -eye.z, smallest, 32.0);
    vColor = shownColor(world.xyz);
  }`;

const fragmentShader = `
  varying vec3 vColor;
  void main() {
    vec2 fromCentre = gl_PointCoord - 0.5;
    if (dot(fromCentre, fromCentre) > 0.25) discard;
    gl_FragColor = vec4(vColor, 1.0);
    #include <colorspace_fragment>
  }`;

/** The uniforms shared by all pieces of a cloud. */
export function sharedUniforms() {
  return {
    pointSizeCm: { value: 1.6 },
    pixelsPerRadian: { value: 500 },
    mode: { value: 0 },
    lit: { value: 1 }, // of meshes, whether by their normals
    heightsM: { value: new Vector2(0, 3) },
    clipLowM: { value: new Vector3().setScalar(-FAR_M) },
    clipHighM: { value: new Vector3().setScalar(FAR_M) },
  };
}

/** The uniforms of one piece. */
export function pieceUniforms({ unitM, origin }) {
  return { unitM: { value: unitM }, origin: { value: new Vector3(...origin) }, timeShare: { value: 0 } };
}

/** The material of one piece. */
export function cloudMaterial(shared, { unitM, origin }) {
  return new ShaderMaterial({ uniforms: { ...shared, ...pieceUniforms({ unitM, origin }) }, vertexShader, fragmentShader });
}
