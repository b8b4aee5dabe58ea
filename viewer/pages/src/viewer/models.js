// Meshes: from kinloop's messages, and GLB files read by three.js.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, MeshBasicMaterial, MeshStandardMaterial, SRGBColorSpace } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

/** Mesh of { points, triangles, colors }, clipped by `planes`. */
export function meshOf({ points, triangles, colors }, planes) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  const cut = { side: DoubleSide, clippingPlanes: planes };
  if (!colors) return new Mesh(geometry, new MeshStandardMaterial({ ...cut, flatShading: true }));
  geometry.setAttribute('color', new BufferAttribute(toLinearColors(colors), 3));
  return new Mesh(geometry, new MeshBasicMaterial({ ...cut, vertexColors: true }));
}

/** three.js expects linear vertex colours, not sRGB. */
function toLinearColors(colors) {
  const light = Float32Array.from({ length: 256 }, (_, value) => new Color().setRGB(value / 255, 0, 0, SRGBColorSpace).r);
  const linear = new Float32Array((3 * colors.length) / 4);
  for (let i = 0; i < colors.length / 4; ++i) {
    for (let channel = 0; channel < 3; ++channel) linear[3 * i + channel] = light[colors[4 * i + channel]];
  }
  return linear;
}

/** The scene of a GLB file in kinloop's axes (y down), clipped by `planes`. */
export async function readModel(buffer, planes) {
  const { scene } = await new GLTFLoader().parseAsync(buffer, '');
  scene.rotation.x = Math.PI; // y is up in glTF
  scene.traverse((object) => {
    if (!object.material) return;
    object.material = toUnlitMaterial(object, object.material);
    Object.assign(object.material, { side: DoubleSide, clippingPlanes: planes, metalness: 0 }); // metallic
                                                                                                 // materials
                                                                                                 // would
                                                                                                 // reflect a
                                                                                                 // missing
                                                                                                 // environment
  });
  return scene;
}

/** Captured colours already contain the lighting; uncoloured meshes are lit, to show their shape. */
function toUnlitMaterial({ isMesh, geometry }, material) {
  if (!isMesh || !(material.map || geometry.attributes.color)) return material;
  const { map, color, vertexColors, transparent, opacity, alphaTest } = material;
  return new MeshBasicMaterial({ map, color, vertexColors, transparent, opacity, alphaTest });
}
