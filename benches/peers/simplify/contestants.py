"""Who simplifies: each turns one PLY into another of so many triangles, and tells how many seconds of the processor's
time that took.

Reading and writing are not timed. VTK and MeshLab run in this process, the rest in one that stays as well: memory and
code are there for everybody alike from the second call on.
"""

import functools
import json
import subprocess
import time

import pymeshlab
import vtk


def contestants(program, variants):
    """By name, with their other settings if wanted."""
    own = ["lod-budget", "lod-budget-free", "meshoptimizer-update", "meshoptimizer"]
    plain = {
        **{name: functools.partial(by_call, program, name) for name in own},
        "vtk": functools.partial(by_vtk, volume_preservation=False),
        "meshlab": functools.partial(by_meshlab, preservetopology=False),
    }
    other = {
        "vtk-volume": functools.partial(by_vtk, volume_preservation=True),
        "meshlab-topology": functools.partial(by_meshlab, preservetopology=True),
    }
    return {**plain, **other} if variants else plain


class Program:
    """`simplify serve`, as long as somebody has questions."""

    def __init__(self, path):
        pipe = subprocess.PIPE
        self.process = subprocess.Popen([path, "serve"], stdin=pipe, stdout=pipe, text=True, bufsize=1)

    def ask(self, *words):
        """The answer to a command."""
        print(json.dumps([str(word) for word in words]), file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()
        answer = json.loads(line) if line else {"error": "simplify is gone"}
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer


def by_call(program, name, fine, triangles, coarse):
    return program.ask("lower", name, fine, triangles, coarse)["cpu_s"]


def by_vtk(fine, triangles, coarse, volume_preservation):
    """vtkQuadricDecimation, its other settings as they are by default."""
    reader = vtk.vtkPLYReader(file_name=str(fine))
    reader.Update()
    mesh = reader.GetOutput()
    decimation = vtk.vtkQuadricDecimation(volume_preservation=volume_preservation)
    decimation.target_reduction = 1 - triangles / mesh.GetNumberOfCells()
    decimation.SetInputData(mesh)
    seconds = timed(decimation.Update)
    writer = vtk.vtkPLYWriter(file_name=str(coarse), input_connection=decimation.GetOutputPort())
    writer.SetFileTypeToBinary()
    writer.Write()
    return seconds


def by_meshlab(fine, triangles, coarse, preservetopology):
    """Quadric edge collapse, its other settings as they are by default: best places, a quality threshold of 0.3."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(fine))
    collapse = functools.partial(
        meshes.meshing_decimation_quadric_edge_collapse,
        targetfacenum=triangles,
        preservetopology=preservetopology,
    )
    seconds = timed(collapse)
    meshes.save_current_mesh(str(coarse), binary=True)
    return seconds


def timed(call):
    start = time.process_time()
    call()
    return time.process_time() - start
