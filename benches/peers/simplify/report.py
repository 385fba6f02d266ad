"""The rows as tables: on the terminal, and as simplification.md and simplification.csv in docs/."""

import csv
import importlib.metadata
import math
import os
import pathlib
import platform
import re
import subprocess
import typing

import deviation

OURS, FREE, UPDATE = "lod-budget", "lod-budget-free", "meshoptimizer-update"
BEST = ["vtk", "meshlab"]
"""Whose quality is the goal."""

NAMES = {
    OURS: "lod-budget",
    "vtk": "VTK",
    "meshlab": "MeshLab",
    UPDATE: "meshoptimizer, with update",
    "meshoptimizer": "meshoptimizer",
    FREE: "lod-budget, `Topology::Free`",
    "vtk-volume": "VTK, volume preservation",
    "meshlab-topology": "MeshLab, topology preserved",
}


def tell(rows):
    """A line per row, to the terminal."""
    for row in rows:
        figures = "{triangles:8} triangles {cpu_s:8.3f} s  RMS {rms:.5f} %  Hausdorff {hausdorff:.5f} %".format(**row)
        print(f"{row['mesh']:18} {row['share']:3} % {row['contestant']:22} {figures}", flush=True)


def write(rows, rounds, docs):
    with open(docs / "simplification.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows({name: plain(value) for name, value in row.items()} for row in rows)
    page = pathlib.Path(__file__).with_name("page.md").read_text(encoding="utf-8")
    (docs / "simplification.md").write_text(fill(page, Results(rows), rounds), encoding="utf-8")


def plain(value):
    return f"{value:.6g}" if isinstance(value, float) else value


def fill(page, results, rounds):
    parts = {
        "meshes": results.original_triangles(),
        **{goal.place: results.table(goal) for goal in GOALS},
        "losses": results.losses(),
        "free_losses": Results(results.rows, FREE).losses(),
        "others": results.others(),
        "bounds": results.bounds(),
        "figures": results.figures(),
        "rounds": str(rounds),
        "samples": f"{deviation.SAMPLES:_}".replace("_", " "),
        "facts": "\n".join(f"| {name} | {value} |" for name, value in facts() if value),
    }
    return re.sub(r"\{(\w+)\}", lambda place: parts[place[1]], page)


class Results:
    """Rows by level, which is a mesh and a share, and by contestant, one of whom is ours."""

    def __init__(self, rows, ours=OURS):
        self.rows, self.ours, self.levels = rows, ours, {}
        for row in rows:
            self.levels.setdefault((row["mesh"], row["share"]), {})[row["contestant"]] = row
        self.meshes = list(dict.fromkeys(mesh for mesh, _ in self.levels))
        self.shares = list(dict.fromkeys(share for _, share in self.levels))

    def rms(self, level):
        """Ours ÷ the smaller of VTK's and MeshLab's."""
        return self.ratio(level, "rms", BEST)

    def hausdorff(self, level):
        """Ours ÷ the smaller of VTK's and MeshLab's."""
        return self.ratio(level, "hausdorff", BEST)

    def speed(self, level):
        """The time of the faster of VTK and MeshLab ÷ ours."""
        return 1 / self.ratio(level, "cpu_s", BEST)

    def against_update(self, level):
        """Our time ÷ that of meshoptimizer with update."""
        return self.ratio(level, "cpu_s", [UPDATE])

    def ratio(self, level, figure, others):
        """Ours ÷ the smallest of theirs; not a number where that is not known."""
        rows = self.levels.get(level, {})
        least = min((rows[name][figure] for name in others if name in rows), default=0)
        return rows[self.ours][figure] / least if self.ours in rows and least else math.nan

    def table(self, goal):
        """A row per mesh, a column per share; what misses the goal is bold."""

        def cell(mesh, share):
            value = goal.value(self, (mesh, share))
            if math.isnan(value):
                return "–"
            return f"{value:.2f}" if goal.is_met(value) else f"**{value:.2f}**"

        body = [[mesh, *(cell(mesh, share) for share in self.shares)] for mesh in self.meshes]
        return markdown(["", *(f"{share} %" for share in self.shares)], body)

    def losses(self):
        """Where a goal is missed, a line per goal."""
        return "\n".join(f"- **{goal.name}**: {self.lost(goal)}" for goal in GOALS)

    def lost(self, goal):
        values = {level: goal.value(self, level) for level in self.levels}
        known = {level: value for level, value in values.items() if not math.isnan(value)}
        lost = [level for level, value in known.items() if not goal.is_met(value)]
        if not lost:
            return f"met in all {len(known)}."
        shares = {mesh: [f"{share} %" for m, share in lost if m == mesh] for mesh, _ in lost}
        places = "; ".join(f"{mesh} at {', '.join(of_mesh)}" for mesh, of_mesh in shares.items())
        return f"missed in {len(lost)} of {len(known)}: {places}."

    def others(self):
        """Everybody against lod-budget as it is by default: geometric means over all levels."""
        body = []
        for name in NAMES:
            both = [rows for rows in self.levels.values() if name in rows and OURS in rows]
            if both and name != OURS:
                means = (geometric_mean(both, name, figure) for figure in ["cpu_s", "rms", "hausdorff"])
                body.append([NAMES[name], *(f"{mean:.2f}" for mean in means)])
        return markdown(["÷ lod-budget", "time", "RMS", "Hausdorff"], body)

    def bounds(self):
        """How the stored bound compares with what MeshLab finds."""
        ours = [rows[OURS] for rows in self.levels.values() if OURS in rows]
        ratios = [row["bound"] / row["hausdorff"] for row in ours if row["hausdorff"]]
        holds = sum(row["bound"] >= row["hausdorff"] for row in ours)
        mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
        return f"It is no less in {holds} of {len(ours)} levels, and {100 * mean - 100:.1f} % more in the mean."

    def original_triangles(self):
        counts = {mesh: self.original(mesh, share) for mesh, share in self.levels}
        return ", ".join(f"{mesh} {count}" for mesh, count in counts.items())

    def original(self, *level):
        return next(iter(self.levels[level].values()))["of"]

    def figures(self):
        """All the figures of those whom the goals name."""
        shown = [name for name in [OURS, *BEST, UPDATE, "meshoptimizer"] if self.has(name)]
        body = []
        for (mesh, share), rows in self.levels.items():
            bound = f"{rows[OURS]['bound']:.4f}" if OURS in rows else "–"
            wanted = self.original(mesh, share) * share // 100
            body.append([f"{mesh}, {share} %", *(cell_of(rows.get(name), wanted) for name in shown), bound])
        return markdown(["s / RMS / Hausdorff", *(NAMES[name] for name in shown), "stored"], body)

    def has(self, name):
        return any(name in rows for rows in self.levels.values())


class Goal(typing.NamedTuple):
    """Something that lod-budget wants of every level."""

    place: str
    """In page.md."""
    name: str
    value: typing.Callable[[Results, tuple], float]
    is_met: typing.Callable[[float], bool]


GOALS = [
    Goal("rms", "RMS", Results.rms, lambda x: x <= 1.05),
    Goal("hausdorff", "Hausdorff distance", Results.hausdorff, lambda x: x <= 1.05),
    Goal("speed", "Speed against VTK and MeshLab", Results.speed, lambda x: x >= 5),
    Goal("update", "Time against meshoptimizer with update", Results.against_update, lambda x: x <= 3),
]


def geometric_mean(levels, name, figure):
    pairs = [(rows[name][figure], rows[OURS][figure]) for rows in levels]
    logs = [math.log(theirs / ours) for theirs, ours in pairs if theirs > 0 and ours > 0]
    return math.exp(sum(logs) / len(logs)) if logs else math.nan


def cell_of(row, wanted):
    """Starred where there are more than a hundredth more triangles than wanted."""
    if not row:
        return "–"
    star = "*" if row["triangles"] > 1.01 * wanted else ""
    return "{cpu_s:.3f} / {rms:.4f} / {hausdorff:.4f}".format(**row) + star


def markdown(head, body):
    rule = ["---", *("---:" for _ in head[1:])]
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, rule, *body])


def facts():
    """What was compared, and on what."""
    lock = (pathlib.Path(__file__).parents[1] / "Cargo.lock").read_text(encoding="utf-8")
    crate = {name: re.search(f'name = "{name}"\nversion = "(.+)"', lock)[1] for name in ["lod-budget", "meshopt"]}
    return [
        ("processor", found("/proc/cpuinfo", r"model name\s*: (.+)")),
        ("cores", os.cpu_count()),
        ("load before the end", f"{os.getloadavg()[0]:.2f}"),
        ("compiler", output("rustc", "--version")),
        ("Python", platform.python_version()),
        ("lod-budget", crate["lod-budget"]),
        ("VTK", importlib.metadata.version("vtk")),
        ("MeshLab (pymeshlab)", importlib.metadata.version("pymeshlab")),
        ("meshoptimizer", f"1.3 (crate meshopt {crate['meshopt']})"),
    ]


def found(path, pattern):
    try:
        text = pathlib.Path(path).read_text(encoding="utf-8")
    except OSError:
        return None
    match = re.search(pattern, text)
    return match and match[1]


def output(*command):
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
