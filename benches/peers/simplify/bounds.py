"""Whether the deviation that is stored with a level is no less than how far the level is, found by libigl's nearest
points of vertices, edges' middles and points spread over the surfaces: nothing in the measuring is lod-budget's."""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import igl
import numpy

ROUNDING = 1e-12
"""Of the diagonal: what double precision may be off by."""


def main():
    arguments = parse()
    levels, below = 0, 0
    for mesh in arguments.meshes:
        with tempfile.TemporaryDirectory() as folder:
            found = list(measure(folder, arguments.samples)) if bake(arguments.program, mesh, folder) else []
        shares = [distance / error if error else 1.0 for error, distance, _ in found]
        low = [error < distance - ROUNDING * diagonal for error, distance, diagonal in found]
        levels, below = levels + len(found), below + sum(low)
        if found:
            print(f"{mesh.name}: {len(found)} levels, {min(shares):.4f} to {max(shares):.4f} of what is stored", flush=True)
        if any(low):
            print(f"{mesh.name}: too little is stored with {[i + 1 for i, is_low in enumerate(low) if is_low]}", flush=True)
    print(f"{levels} levels of {len(arguments.meshes)} meshes; too little is stored with {below}")
    sys.exit(1 if below else 0)


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="the command `lod`")
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=50_000, help="points spread over each surface")
    return parser.parse_args()


def bake(program, mesh, folder):
    """Bakes into a folder, and says whether the mesh was not refused."""
    command = [program, "bake", str(mesh), "--out", folder, "--format", "obj,json"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        print(f"{mesh.name}: refused: {done.stderr.strip().splitlines()[-1]}", flush=True)
    return done.returncode == 0


def measure(folder, samples):
    """Per level but the first: the error that is stored, the largest distance found, and the diagonal."""
    (scene,) = (path for path in pathlib.Path(folder).glob("*/*.json") if not path.name.endswith(".bake.json"))
    (table,) = json.loads(scene.read_text())["tables"]
    levels = [surface(scene.with_name(f"{scene.stem}_LOD{level}.obj")) for level in range(len(table["levels"]))]
    diagonal = numpy.linalg.norm(numpy.ptp(levels[0][0], axis=0))
    for level, record in zip(levels[1:], table["levels"][1:]):
        distance = max(one_sided(levels[0], level, samples), one_sided(level, levels[0], samples))
        # The file has as many digits as single precision needs.
        yield float(numpy.float32(record["error"])), distance, diagonal


def surface(path):
    """The vertices that triangles use, in single precision as lod-budget has them, and the triangles."""
    vertices, triangles = igl.read_triangle_mesh(str(path))
    used, triangles = numpy.unique(triangles, return_inverse=True)
    return vertices[used].astype(numpy.float32).astype(numpy.float64), triangles.reshape(-1, 3)


def one_sided(sampled, target, samples):
    """The largest distance of points of one surface from the other."""
    nearest = igl.point_mesh_squared_distance(points(*sampled, samples), *target)
    return float(numpy.sqrt(numpy.max(nearest[0])))


def points(vertices, triangles, samples):
    """All vertices, the middles of all edges, and so many points by area."""
    corners = vertices[triangles]
    middles = (corners + numpy.roll(corners, 1, axis=1)).reshape(-1, 3) / 2
    areas = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    if not areas.sum():
        return numpy.concatenate([vertices, middles])
    random = numpy.random.default_rng(1)
    chosen = corners[random.choice(len(areas), samples, p=areas / areas.sum())]
    weights = random.dirichlet([1, 1, 1], samples)
    return numpy.concatenate([vertices, middles, numpy.einsum("ij,ijk->ik", weights, chosen)])


if __name__ == "__main__":
    main()
