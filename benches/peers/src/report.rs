//! The rows as tables: on the terminal, and as `peers.md` and `peers.csv` in `docs/`.

use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use crate::camera::Camera;
use crate::knapsack::{self, Solved};
use crate::machine;
use crate::peer::{Frames, Row};
use crate::scene::Scene;

/// The words around the tables.
const PAGE: &str = include_str!("page.md");

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
        let parts = [
            ("{times}", self.times()),
            ("{answers}", self.answers()),
            ("{solvers}", self.solvers()),
            ("{facts}", self.facts()),
        ];
        let fill = |page: String, (place, part): (&str, String)| page.replace(place, part.trim_end());
        parts.into_iter().fold(PAGE.to_owned(), fill)
    }

    fn facts(&self) -> String {
        let machine = machine::description().into_iter().map(|(name, value)| (name.to_owned(), value));
        let facts = machine.chain(self.facts.iter().cloned());
        facts.map(|(name, value)| format!("| {name} | {value} |\n")).collect()
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
