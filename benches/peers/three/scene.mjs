// The scene as the Rust side writes it: `scene.json` beside `instances.f32`, four numbers an object (x, y, z, kind).

import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { PerspectiveCamera } from 'three';

const UP = 'YXZ';

/** {kinds: [{radius, distances}], cameras: [{eye, yaw, far}], lens, instances: Float32Array} */
export function readScene(folder) {
  const scene = JSON.parse(readFileSync(join(folder, 'scene.json'), 'utf8'));
  const bytes = readFileSync(join(folder, 'instances.f32'));
  return { ...scene, instances: new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4) };
}

/** Calls `tell(x, y, z, kind)` for each object. */
export function eachInstance({ instances }, tell) {
  for (let i = 0; i < instances.length; i += 4) {
    tell(instances[i], instances[i + 1], instances[i + 2], instances[i + 3]);
  }
}

export function newCamera({ lens }) {
  return new PerspectiveCamera(lens.fov_y_degrees, lens.aspect, lens.near, 1);
}

/** Puts three's camera where the scene's is. */
export function place(camera, { eye, yaw, far }) {
  if (camera.far !== far) {
    camera.far = far;
    camera.updateProjectionMatrix();
  }
  camera.position.fromArray(eye);
  camera.rotation.set(0, yaw, 0, UP);
  camera.updateMatrixWorld(true);
}
