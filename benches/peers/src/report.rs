//! The rows as tables: on the terminal, and as `peers.md` and `peers.csv` in `docs/`.

use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use crate::camera::Camera;
use crate::knapsack::{self, Solved};
use crate::machine;
use crate::peer::{Frames, Row};
use crate::scene::Scene;

/// Everything that was measured.
#[derive(Default)]
pub struct Report {
    frames: Vec<Line>,
    knapsacks: Vec<knapsack::Row>,
    /// Versions of what was measured, and the like.
    facts: Vec<(String, String)>,
}

/// A row of frames, and how many objects its bounds let into view when counted one by one.
struct Line {
    row: Row,
    expected: usize,
}

impl Report {
    /// `last` is the camera that the censuses are of.
    pub fn frames(&mut self, scene: &Scene, last: &Camera, rows: Vec<Row>) {
        let expected =
            |row: &Row| row.outcome.as_ref().map_or(0, |frames| last.in_view(scene, frames.bound).count());
        self.frames.extend(rows.into_iter().map(|row| Line { expected: expected(&row), row }));
    }

    pub fn knapsacks(&mut self, rows: Vec<knapsack::Row>) {
        self.knapsacks.extend(rows);
    }

    /// Remembers a fact unless it is known.
    pub fn fact(&mut self, name: &str, value: &str) {
        if self.facts.iter().all(|(known, _)| known != name) {
            self.facts.push((name.to_owned(), value.to_owned()));
        }
    }

    /// What is printed: the tables without the words around them.
    pub fn tables(&self) -> String {
        let parts = [self.times(), self.answers(), self.solvers()];
        parts.join("\n")
    }

    pub fn write(&self, docs: &Path) -> io::Result<()> {
        fs::create_dir_all(docs)?;
        fs::write(docs.join("peers.csv"), self.csv())?;
        fs::write(docs.join("peers.md"), self.page())
    }

    fn page(&self) -> String {
        let [times, answers, solvers] = [self.times(), self.answers(), self.solvers()];
        let machine = machine::description().into_iter().map(|(name, value)| (name.to_owned(), value));
        let facts =
            machine.chain(self.facts.iter().cloned()).fold(String::new(), |mut text, (name, value)| {
                let _ = writeln!(text, "| {name} | {value} |");
                text
            });
        format!(
            "{HEAD}\n{times}\n{FRAMES}\n{answers}\n{LACKING}\n{solvers}\n{SOLVERS}\n## The machine\n\n| | |\n|---|---|\n{facts}"
        )
    }

    /// A row per peer, a column per size.
    fn times(&self) -> String {
        let mut sizes: Vec<usize> = self.frames.iter().map(|line| line.row.objects).collect();
        sizes.dedup();
        let heads: String = sizes.iter().map(|size| format!(" {size} objects |")).collect();
        let mut text =
            format!("| ns per object in the scene |{heads}\n|---|{}\n", "---:|".repeat(sizes.len()));
        for peer in self.peers() {
            let cell = |&size: &usize| {
                let line = self.frames.iter().find(|line| line.row.peer == peer && line.row.objects == size);
                line.map_or_else(String::new, |line| time(&line.row))
            };
            let _ = writeln!(text, "| {peer} | {} |", sizes.iter().map(cell).collect::<Vec<_>>().join(" | "));
        }
        text
    }

    /// Who was to be measured, in the order in which they were met.
    fn peers(&self) -> Vec<&str> {
        let mut peers: Vec<&str> = Vec::new();
        for Line { row, .. } in &self.frames {
            peers.extend((!peers.contains(&row.peer.as_str())).then_some(row.peer.as_str()));
        }
        peers
    }

    /// What was answered in the last frame.
    fn answers(&self) -> String {
        let mut text =
            "| last frame | objects | in view | bound | against a count one by one | levels 0 / 1 / 2 / 3 \
                        | of the budget | gap |\n|---|---:|---:|---|---:|---:|---:|---:|\n"
                .to_owned();
        for Line { row, expected } in &self.frames {
            let Ok(frames) = &row.outcome else { continue };
            let (visible, bound) = (frames.census.visible(), frames.bound.name());
            let difference = visible as i64 - *expected as i64;
            let levels = frames.census.0.map(|count| count.to_string()).join(" / ");
            let spent =
                frames.spent.map_or("–".to_owned(), |spent| format!("{:.1} %", 100.0 * spent.share));
            let gap = frames.spent.and_then(|spent| spent.gap);
            let (peer, objects, gap) = (&row.peer, row.objects, gap.map_or("–".to_owned(), figure));
            let _ = writeln!(
                text,
                "| {peer} | {objects} | {visible} | {bound} | {difference:+} | {levels} | {spent} | {gap} |"
            );
        }
        text
    }

    fn solvers(&self) -> String {
        let mut text = "| solver | classes | time | gap by its own bound | short of the best bound | proved \
                        | over the budget |\n|---|---:|---:|---:|---:|---|---:|\n"
            .to_owned();
        for row in &self.knapsacks {
            let (solver, classes) = (row.solver, row.classes);
            let _ = match &row.outcome {
                Ok(solved) => writeln!(text, "| {solver} | {classes} | {} |", self.solved(classes, solved)),
                Err(why) => writeln!(text, "| {solver} | {classes} | not measured: {why} | | | | |"),
            };
        }
        text
    }

    fn solved(&self, classes: usize, solved: &Solved) -> String {
        let share = |bound: f64| {
            solved.short_of(bound).map_or("–".to_owned(), |s| figure(if s < ROUNDING { 0.0 } else { s }))
        };
        let proved = match solved.gain {
            None => "–",
            Some(_) if solved.proved => "yes",
            Some(_) => "no",
        };
        [
            duration(solved.time_s),
            share(solved.bound),
            share(self.best_bound(classes)),
            proved.to_owned(),
            figure(solved.excess),
        ]
        .join(" | ")
    }

    /// The tightest bound that any solver has on the instance.
    fn best_bound(&self, classes: usize) -> f64 {
        let rows = self.knapsacks.iter().filter(|row| row.classes == classes);
        rows.filter_map(|row| row.outcome.as_ref().ok()).map(|s| s.bound).fold(f64::INFINITY, f64::min)
    }

    /// One figure per line.
    fn csv(&self) -> String {
        let mut text = "who,size,figure,value\n".to_owned();
        let mut tell = |who: &str, size: usize, name: &str, value: f64| {
            let _ = writeln!(text, "\"{who}\",{size},{name},{value}");
        };
        for Line { row, expected } in &self.frames {
            for (name, value) in
                row.outcome.iter().flat_map(|frames| frame_figures(frames, row.objects, *expected))
            {
                tell(&row.peer, row.objects, name, value);
            }
        }
        for row in &self.knapsacks {
            for (name, value) in row.outcome.iter().flat_map(solver_figures) {
                tell(row.solver, row.classes, name, value);
            }
        }
        text
    }
}

fn frame_figures(frames: &Frames, objects: usize, expected: usize) -> Vec<(&'static str, f64)> {
    let mut figures = vec![
        ("ns_per_object", frames.p10_ns() / objects as f64),
        ("in_view", frames.census.visible() as f64),
        ("in_view_one_by_one", expected as f64),
    ];
    let levels = ["level_0", "level_1", "level_2", "level_3"].into_iter().zip(frames.census.0);
    figures.extend(levels.map(|(name, count)| (name, count as f64)));
    figures.extend(frames.spent.map(|spent| ("budget_share", spent.share)));
    figures.extend(frames.spent.and_then(|spent| spent.gap).map(|gap| ("gap", gap)));
    figures
}

fn solver_figures(solved: &Solved) -> Vec<(&'static str, f64)> {
    let mut figures = vec![("time_s", solved.time_s)];
    figures.extend(solved.bound.is_finite().then_some(("bound_on_gain", solved.bound)));
    figures.extend(solved.gain.map(|gain| ("gain", gain)));
    figures.push(("proved", f64::from(u8::from(solved.proved))));
    figures
}

fn time(row: &Row) -> String {
    match &row.outcome {
        Ok(frames) => figure(frames.p10_ns() / row.objects as f64),
        Err(why) => format!("not measured: {why}"),
    }
}

/// A share of a sum of thousands of numbers that says nothing.
const ROUNDING: f64 = 1e-12;

/// Three significant digits.
fn figure(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if !(1e-3..1e6).contains(&value.abs()) => format!("{value:.1e}"),
        _ => format!("{value:.*}", (2 - value.abs().log10().floor() as i32).max(0) as usize),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{} µs", figure(s * 1e6)),
        s if s < 1.0 => format!("{} ms", figure(s * 1e3)),
        s => format!("{} s", figure(s)),
    }
}

const HEAD: &str = "# Peers

What others do with the same scene, the same cameras and the same knapsacks. `benches/peers/run.sh` fetches the peers,
measures this page and writes it together with [`peers.csv`](peers.csv). None of it is a test: figures depend on the
machine and on what else it does.

## Frames
";

const FRAMES: &str = "**Scene.** Objects from a seed, scattered over a square of ground, a hundred square metres to each, in no
spatial order; sixteen kinds of one radius (0.5 m to 6 m) and four levels each. The camera stands in the middle, sees
91° by 60° without a limit to how far, so that a quarter of all is in view, and walks and turns a little each frame.

**What is timed.** From where the camera is to which objects are to be drawn at which level; nothing is drawn or
uploaded. Nanoseconds of the processor's time, not of the clock on the wall, per object in the scene, visible or not: the
tenth percentile of frames. lod-budget and Bevy take turns frame by frame in one process, with one thread; each first
repeats its last frame untimed, so that its data are in the caches as far as they fit. Then three.ez and three.js have a
process of node each, whose other threads (garbage, compiler) count too, and so on five times.

- **lod-budget** is a whole `Runtime::frame`: culling, rating, selection, hard transitions, the list of changes and the
  prediction of the frame's time. Options are the defaults, save that *static* and *reactive* have thresholds without
  hysteresis, as the peers have. The time predicted for a frame is handed back as measured, so that the policies with a
  budget have something to follow; the budget is two fifths of the way from the least to the most that what is in view
  can cost.
- **Bevy** is the schedule `PostUpdate` with `CameraPlugin` (`check_visibility_ranges`, `check_visibility_cpu_culling`
  and what resets and marks), one thread. Its levels are entities: each object is four, each with a mesh and the
  `VisibilityRange` in which it is drawn, as Bevy's documentation has it. So it tests four times as many. Bounds and
  transforms are given and never change.
- **three.ez instanced-mesh** is `performFrustumCulling` of an `InstancedMesh2` per kind, with its hierarchy of boxes
  and its levels. Objects are added in the order of the scene; in trials its time went up and down by a factor of two
  from process to process, more than anybody else's.
- **three.js** is what its renderer does before it draws: `LOD.update` of every object, then the frustum against the
  mesh that is left. It waits for memory: five `Object3D` an object take 11 KB. In a trial with 300 objects each took a
  tenth of the time. A million of them are more than a page would ever get.

## The same answers

Thresholds are the distances at which a level's error looks a pixel large, so that *static* and the peers should show the
same levels. They differ by what they test against the view: a sphere, or the upright cube around it, which lets some
more in at the edges. The count one by one, in double precision, uses the same bound as the peer. *Reactive* and
*predictive* show other levels on purpose. *Gap* is that of what is shown, as a fraction of the bound on the gain: the
default options hold some of the optimum back until it is worth a switch.
";

const LACKING: &str = "**What the peers do not do.** None of the three knows what drawing costs. There is no budget, no prediction and no
certificate: who wants a frame to fit tunes distances by hand. Their levels follow from distance; the size and worth of an
object matter only as far as somebody has put them into its distances. three.ez and three.js do not tell what has changed
since the last frame.

**What they do besides.** Bevy fades between levels, answers for 32 views at once, heeds layers and a hierarchy of
visibility, tells of changes, uses all cores where it may, and can leave culling to the graphics card. three.ez's lists are
what the graphics card draws from, and its hierarchy also serves picking. three.js has hysteresis per level.

**What is kind to whom.** Nothing moves, which is kind to a hierarchy (lod-budget's, three.ez's) and does nothing for
Bevy and three.js, which look at every object in every frame. No view but one, no shadows.

## Knapsacks

The knapsack that a frame has to solve: the first so many objects in view of the scene of 100 000, a class each with four
items. Gains are benefit beyond that of the coarsest levels; gaps are fractions of the bound on the gain.
";

const SOLVERS: &str = "Times are the processor's. lod-budget's are the fastest of five runs, `exact`'s of one; HiGHS's are those of one `run`
each, with one thread, presolve included, building and passing the model not. `exact` and each of HiGHS's are given a
minute. *Proved* means that nothing is better; at its default gap HiGHS stops before. Choices are added up here, whatever
the solver says of them. HiGHS works to tolerances of 1e-6, so that a choice of its may exceed the budget by a trace, and
a bound be off by one. It solves any linear programme, of which this is a small and special one. The frame loop runs none
of these solvers, but one that starts from its last answer: its gaps are in the table of frames.
";
