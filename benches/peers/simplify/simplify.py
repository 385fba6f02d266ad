"""Everybody's simplifications of the same meshes, measured alike.

PROGRAM is `simplify` of this package; run.sh builds it. Writes docs/simplification.md and docs/simplification.csv.
"""

import argparse
import contextlib
import gzip
import pathlib
import shutil
import sys
import tempfile

import contestants
import deviation
import report

SHARES = [50, 25, 12, 6, 3]
"""Percent of the triangles that are kept."""

DOCS = pathlib.Path(__file__).resolve().parents[3] / "docs"


def main():
    arguments = parse()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for mesh in meshes(arguments.program, arguments.meshes, pathlib.Path(folder)):
            for share in SHARES[-1:] if arguments.quick else SHARES:
                found = race(arguments, mesh, share)
                report.tell(found)
                rows += found
            if arguments.quick:
                break
            report.write(rows, arguments.rounds, DOCS)


def parse():
    parser = argparse.ArgumentParser(description="Compares simplifications.")
    parser.add_argument("program", type=contestants.Program)
    parser.add_argument("meshes", nargs="*", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=3, help="times are the least of so many rounds")
    parser.add_argument("--variants", action="store_true", help="other settings of the contestants too")
    parser.add_argument("--quick", action="store_true", help="does it run? writes nothing")
    parser.add_argument("--samples", type=int, default=deviation.SAMPLES, help="points per measuring pass")
    arguments = parser.parse_intermixed_args()
    deviation.SAMPLES = arguments.samples
    return arguments


def meshes(program, given, folder):
    """All meshes as PLY of single precision, welded and repaired by lod-budget, so that all start from the same."""
    for path in given:
        plain = unpacked(path, folder)
        clean = folder / f"{plain.stem}.ply"
        program.ask("clean", plain, clean)
        yield clean
    made = program.ask("shapes", folder)
    yield from (folder / f"{name}.ply" for name in made)


def unpacked(path, folder):
    if path.suffix != ".gz":
        return path
    plain = folder / f"unpacked/{path.stem}"
    plain.parent.mkdir(exist_ok=True)
    with gzip.open(path) as packed, open(plain, "wb") as file:
        shutil.copyfileobj(packed, file)
    return plain


def race(arguments, mesh, share):
    """A row per contestant. They take turns, round by round; what they make is the same in each."""
    original = deviation.Original(mesh)
    triangles = original.triangles * share // 100
    everybody = contestants.contestants(arguments.program, arguments.variants)
    files = {name: mesh.with_suffix(f".{name}.ply") for name in everybody}
    seconds = {name: [] for name in everybody}
    for _ in range(arguments.rounds):
        for name, simplify in everybody.items():
            with complaining(f"{name} on {mesh.stem}, {share} %"):
                seconds[name].append(simplify(mesh, triangles, files[name]))
    finished = [name for name in everybody if seconds[name]]
    return [
        {
            "mesh": mesh.stem,
            "of": original.triangles,
            "share": share,
            "contestant": name,
            "cpu_s": min(seconds[name]),
            **original.measure(files[name]),
            "bound": bound(arguments.program, original, mesh, files[name]) if name == "lod-budget" else None,
        }
        for name in finished
    ]


def bound(program, original, fine, coarse):
    """What a table would store of lod-budget's level."""
    return original.percent(program.ask("bound", fine, coarse)["bound"])


@contextlib.contextmanager
def complaining(what):
    """Says what went wrong and goes on without it."""
    try:
        yield
    except Exception as error:
        print(f"simplify.py: {what}: {error}", file=sys.stderr)


main()
