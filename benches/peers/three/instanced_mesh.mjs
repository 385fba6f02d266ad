// three.ez's InstancedMesh2: one mesh per kind of object with its levels and its hierarchy of boxes, which is how one
// is meant to be used. A frame is `performFrustumCulling` of each: culling, levels, and the lists of indices to be
// drawn. The renderer is a stand-in that takes buffers and does nothing: what is uploaded is not measured.

import { InstancedMesh2 } from '@three.ez/instanced-mesh';
import { Box3, BufferGeometry, MeshBasicMaterial, Sphere, Vector3 } from 'three';
import { eachInstance } from './scene.mjs';

const NO_GRAPHICS = { getContext: () => ({ createBuffer: () => ({}), bindBuffer() {}, bufferData() {} }) };

export class InstancedMeshes {
  constructor(scene) {
    const places = scene.kinds.map(() => []);
    eachInstance(scene, (x, y, z, kind) => places[kind].push([x, y, z]));
    this.meshes = scene.kinds.map((kind, k) => mesh(kind, places[k]));
  }

  frame(camera) {
    for (const mesh of this.meshes) mesh.performFrustumCulling(camera);
  }

  /** Objects in view at each level. */
  census() {
    const sum = (level) => this.meshes.reduce((n, m) => n + m.LODinfo.render.levels[level].object.count, 0);
    return [0, 1, 2, 3].map(sum);
  }
}

function mesh({ radius, distances }, places) {
  const params = { capacity: Math.max(places.length, 1), renderer: NO_GRAPHICS };
  const mesh = new InstancedMesh2(unitGeometry(), new MeshBasicMaterial(), params);
  for (const distance of distances.slice(1)) mesh.addLOD(unitGeometry(), new MeshBasicMaterial(), distance);
  mesh.addInstances(places.length, (instance, i) => {
    instance.position.fromArray(places[i]);
    instance.scale.setScalar(radius);
  });
  mesh.computeBVH();
  return mesh;
}

/** A geometry without vertices, bounded by the unit sphere and the cube around it. */
export function unitGeometry() {
  const geometry = new BufferGeometry();
  geometry.boundingSphere = new Sphere(new Vector3(), 1);
  geometry.boundingBox = new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));
  return geometry;
}
