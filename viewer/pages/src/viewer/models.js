// Meshes: those of kinloop's messages, and glTF files as three.js reads them.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, MeshBasicMaterial, MeshStandardMaterial, SRGBColorSpace } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

/** { points, triangles, colors }, cut by `plane`. */
export function meshOf({ points, triangles, colors }, plane) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(points, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  const cut = { side: DoubleSide, clippingPlanes: [plane] };
  if (!colors) return new Mesh(geometry, new MeshStandardMaterial({ ...cut, flatShading: true }));
  geometry.setAttribute('color', new BufferAttribute(toLight(colors), 3));
  return new Mesh(geometry, new MeshBasicMaterial({ ...cut, vertexColors: true }));
}

/** three.js takes colours of vertices as light, not as pixel values. */
function toLight(colors) {
  const light = new Float32Array((3 * colors.length) / 4);
  const color = new Color();
  for (let i = 0; i < colors.length / 4; ++i) {
    color.setRGB(colors[4 * i] / 255, colors[4 * i + 1] / 255, colors[4 * i + 2] / 255, SRGBColorSpace).toArray(light, 3 * i);
  }
  return light;
}

/** The scene of a GLB file in kinloop's axes (y down), cut by `plane`. */
export async function readModel(buffer, plane) {
  const { scene } = await new GLTFLoader().parseAsync(buffer, '');
  scene.rotation.x = Math.PI; // in glTF y points up
  scene.traverse((object) => {
    if (!object.material) return;
    object.material = asCaptured(object, object.material);
    Object.assign(object.material, { side: DoubleSide, clippingPlanes: [plane], metalness: 0 }); // metal mirrors what is not there
  });
  return scene;
}

/** Colours of a camera hold the light of the place; what has none is lit, so that its shape can be seen. */
function asCaptured({ isMesh, geometry }, material) {
  if (!isMesh || !(material.map || geometry.attributes.color)) return material;
  const { map, color, vertexColors, transparent, opacity, alphaTest } = material;
  return new MeshBasicMaterial({ map, color, vertexColors, transparent, opacity, alphaTest });
}
