"""How far two meshes are apart, by MeshLab's sampling: nothing in here is lod-budget's."""

import math

import pymeshlab

SAMPLES = 500_000
"""Points per pass, spread evenly over the surface, unless asked for another number."""


class Original:
    """A mesh that others are measured against."""

    def __init__(self, path):
        self.meshes = pymeshlab.MeshSet()
        self.meshes.load_new_mesh(str(path))
        self.diagonal = self.meshes.current_mesh().bounding_box().diagonal()
        self.triangles = self.meshes.current_mesh().face_number()

    def measure(self, path):
        """The figures of the mesh in a file."""
        self.meshes.load_new_mesh(str(path))
        self.meshes.meshing_remove_unreferenced_vertices()
        coarse = self.meshes.current_mesh_id()
        there, back = self.one_sided(0, coarse), self.one_sided(coarse, 0)
        triangles = self.meshes.current_mesh().face_number()
        self.meshes.delete_current_mesh()
        rms, hausdorff = map(max, zip(there, back))
        return {
            "triangles": triangles,
            "rms": self.percent(rms),
            "hausdorff": self.percent(hausdorff),
        }

    def one_sided(self, sampled, target):
        """Root mean square over the area, and the largest distance found there or at vertices and edges."""
        common = {"sampledmesh": sampled, "targetmesh": target, "samplenum": SAMPLES}
        measure = self.meshes.get_hausdorff_distance
        area = measure(**common, samplevert=False, sampleedge=False, sampleface=True)
        lines = measure(**common, samplevert=True, sampleedge=True, sampleface=False)
        return area["RMS"], max(area["max"], lines["max"])

    def percent(self, length):
        """Of the bounding box's diagonal."""
        return 100 * length / self.diagonal if self.diagonal else math.nan
