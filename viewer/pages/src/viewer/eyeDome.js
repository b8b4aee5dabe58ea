// Eye-dome lighting (Boucheny 2009): darkens what lies behind its neighbours in the image. It shows the shape of
// clouds without normals, and outlines white walls on a bright background.

import { DepthTexture, HalfFloatType, NoBlending, ShaderMaterial, Vector2, WebGLRenderTarget } from 'three';
import { FullScreenQuad } from 'three/examples/jsm/postprocessing/Pass.js';

/** Layers of three.js: surfaces are shaded, lines are drawn over them. */
export const SURFACES = 0;
export const LINES = 1;

const RADIUS_PX = 1.4;
const STRENGTH = 25; // of the shading

const vertexShader = `
  varying vec2 at;
  void main() {
    at = uv;
    gl_Position = vec4(position.xy, 0.0, 1.0);
  }`;

const fragmentShader = `
  #include <packing>
  uniform sampler2D colors, depths;
  uniform vec2 step;
  uniform float near, far, strength;
  varying vec2 at;

  float logDistance(vec2 place) {
    return log2(-perspectiveDepthToViewZ(texture2D(depths, place).x, near, far));
  }

  void main() {
    const float outline = 0.3;  // of surfaces against the background
    float own = logDistance(at);
    float behind = 0.0;
    for (int i = 0; i < 4; ++i) {
      vec2 side = vec2(i < 2 ? 1 : 0, i < 2 ? 0 : 1) * (i % 2 == 0 ? 1.0 : -1.0);
      behind += max(0.0, own - logDistance(at + side * step));
    }
    float shade = exp(-strength * behind);
    float depth = texture2D(depths, at).x;
    bool background = depth == 1.0;
    if (background && behind == 0.0) discard;
    gl_FragColor = background ? vec4(0.0, 0.0, 0.0, outline * (1.0 - shade)) : vec4(shade * texture2D(colors, at).rgb, 1.0);
    #include <colorspace_fragment>
    gl_FragDepth = depth;
  }`;

export class EyeDome {
  constructor() {
    this.target = new WebGLRenderTarget(1, 1, { type: HalfFloatType, depthTexture: new DepthTexture(1, 1) });
    const uniforms = { colors: { value: this.target.texture }, depths: { value: this.target.depthTexture } };
    Object.assign(uniforms, { step: { value: new Vector2() }, near: { value: 0 }, far: { value: 0 }, strength: { value: 0 } });
    this.quad = new FullScreenQuad(new ShaderMaterial({ uniforms, vertexShader, fragmentShader, blending: NoBlending }));
  }

  /** Draws surfaces for `show`; `over`: over those of the last time. */
  drawSurfaces(renderer, scene, camera, over) {
    const size = renderer.getDrawingBufferSize(new Vector2());
    if (size.x !== this.target.width || size.y !== this.target.height) this.target.setSize(size.x, size.y);
    renderer.setRenderTarget(this.target);
    renderer.autoClear = !over;
    camera.layers.set(SURFACES);
    renderer.render(scene, camera);
    camera.layers.enableAll();
    renderer.autoClear = true;
    renderer.setRenderTarget(null);
  }

  /** Shows them, shaded or not, and draws lines over them. */
  show(renderer, scene, camera, shades) {
    const { uniforms } = this.quad.material;
    const radiusPx = RADIUS_PX * renderer.getPixelRatio();
    uniforms.step.value.set(radiusPx / this.target.width, radiusPx / this.target.height);
    uniforms.near.value = camera.near;
    uniforms.far.value = camera.far;
    uniforms.strength.value = shades ? STRENGTH : 0;
    this.quad.render(renderer);
    renderer.autoClear = false;
    camera.layers.set(LINES);
    renderer.render(scene, camera);
    renderer.autoClear = true;
    camera.layers.enableAll();
  }
}
