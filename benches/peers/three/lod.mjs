// three.js by itself: a LOD object per object, holding a mesh per level. A frame is what its renderer does with them
// before anything is drawn: `LOD.update` of every object, then the frustum against the mesh that this has left visible.
// Matrices are final; the renderer's walk over them is not measured.

import { Frustum, LOD, Matrix4, Mesh, MeshBasicMaterial } from 'three';
import { unitGeometry } from './instanced_mesh.mjs';
import { eachInstance } from './scene.mjs';

export class Lods {
  constructor(scene) {
    const [geometry, material] = [unitGeometry(), new MeshBasicMaterial()];
    this.lods = [];
    eachInstance(scene, (x, y, z, kind) => {
      this.lods.push(lod(scene.kinds[kind], [x, y, z], geometry, material));
    });
    this.drawn = [];
    this.frustum = new Frustum();
    this.matrix = new Matrix4();
  }

  frame(camera) {
    const { lods, drawn, frustum, matrix } = this;
    frustum.setFromProjectionMatrix(matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    drawn.length = 0;
    for (let i = 0; i < lods.length; i++) {
      lods[i].update(camera);
      const mesh = lods[i].children[lods[i].getCurrentLevel()];
      if (frustum.intersectsObject(mesh)) drawn.push(mesh);
    }
  }

  census() {
    const census = [0, 0, 0, 0];
    for (const mesh of this.drawn) census[mesh.parent.getCurrentLevel()]++;
    return census;
  }
}

function lod({ radius, distances }, place, geometry, material) {
  const lod = new LOD();
  for (const distance of distances) lod.addLevel(new Mesh(geometry, material), distance);
  lod.position.fromArray(place);
  lod.scale.setScalar(radius);
  lod.updateMatrixWorld(true);
  return lod;
}
