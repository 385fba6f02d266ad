// node measure.mjs FOLDER PEER: the scene in FOLDER through a peer, as JSON on standard output. Frames are drawn from
// the walk until the compiler has had its time; then the walk counts.

import { createRequire } from 'node:module';
import { performance } from 'node:perf_hooks';
import { InstancedMeshes } from './instanced_mesh.mjs';
import { Lods } from './lod.mjs';
import { newCamera, place, readScene } from './scene.mjs';

const PEERS = { instanced_mesh: InstancedMeshes, lod: Lods };
const NS_PER_US = 1e3;
const WARM_UP_MS = 1500;

function measure(scene, peer) {
  const camera = newCamera(scene);
  const start = performance.now();
  for (let i = 0; performance.now() - start < WARM_UP_MS; i++) {
    frame(peer, camera, scene.cameras[i % scene.cameras.length]);
  }
  const times_ns = scene.cameras.map((at) => frame(peer, camera, at));
  return { times_ns, census: peer.census() };
}

/** The processor's time that it took, that of node's other threads included: garbage is a peer's own. */
function frame(peer, camera, at) {
  place(camera, at);
  const start = process.cpuUsage();
  peer.frame(camera);
  const { user, system } = process.cpuUsage(start);
  return (user + system) * NS_PER_US;
}

function versions() {
  const version = (name) => createRequire(import.meta.url)(`../node_modules/${name}/package.json`).version;
  return [['node', process.versions.node], ...['three', '@three.ez/instanced-mesh'].map((n) => [n, version(n)])];
}

const [folder, name] = process.argv.slice(2);
const scene = readScene(folder);
console.log(JSON.stringify({ versions: versions(), ...measure(scene, new PEERS[name](scene)) }));
