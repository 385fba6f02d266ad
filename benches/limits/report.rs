//! The rows, their goals, and how they are told: a table on the terminal, and `limits.csv` and `limits.md` in
//! `docs/`.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::machine;
use crate::plan::Plan;

/// Anything that can go wrong while a report is written.
pub type Failure = Box<dyn std::error::Error>;

/// Which side of the goal is good.
#[derive(Clone, Copy, PartialEq)]
pub enum Sense {
    AtMost,
    AtLeast,
}

/// A figure that has a goal.
#[derive(Clone, Copy)]
pub struct Row {
    pub name: &'static str,
    pub sense: Sense,
    pub goal: f64,
    pub what: &'static str,
}

const fn at_most(name: &'static str, goal: f64, what: &'static str) -> Row {
    Row { name, sense: Sense::AtMost, goal, what }
}

const fn at_least(name: &'static str, goal: f64, what: &'static str) -> Row {
    Row { name, sense: Sense::AtLeast, goal, what }
}

/// All rows, in the order in which they are told.
pub const ROWS: [Row; 23] = [
    at_most("warm_vs_stream", 3.0, "frame, everything in view ÷ stream"),
    at_least("warm_vs_sort", 100.0, "textbook, all steps sorted as structs ÷ the same frame"),
    at_least("warm_vs_u64_sort", 40.0, "packed steps sorted ÷ the same frame"),
    at_least("warm_vs_quickselect", 15.0, "weighted quickselect ÷ the same frame"),
    at_least("warm_vs_fs", 8.0, "the rule of 1993, two heaps from the last frame's levels ÷ the same frame"),
    at_most("cold_vs_stream", 8.0, "frame, everything in view, the policy's memory wiped before ÷ stream"),
    at_most("cull20_vs_stream", 0.4, "culling to a list, 20 % in view ÷ stream"),
    at_most("cull2_vs_stream", 0.15, "culling to a list, 2 % in view ÷ stream"),
    at_least("cull20_vs_obvhs", 100.0, "box query on obvhs and exact test ÷ culling, 20 % in view"),
    at_least("cull2_vs_obvhs", 40.0, "the same, 2 % in view"),
    at_most("frame_vs_stream", 2.0, "frame, a fifth in view ÷ stream"),
    at_most("frame_ns_per_visible", 5.0, "the same frame, ns per object in view"),
    at_least(
        "frame_vs_textbook",
        75.0,
        "box query, array of structs, steps sorted as structs ÷ the same frame",
    ),
    at_least("frame_vs_strong", 15.0, "scan of all blocks, packed steps sorted ÷ the same frame"),
    at_most("predictive_vs_static", 1.3, "the same frame ÷ the same with the static policy"),
    at_most(
        "growth_visited",
        5.0,
        "fixed budget, objects may be left out, 100 times the objects: factor of visits",
    ),
    at_most("growth_time", 5.0, "the same: factor of time"),
    at_least(
        "general_cost_vs_hull",
        10.0,
        "a hull per object and a bracket ÷ frame, for costs max(geometry, pixels), everything in view",
    ),
    at_most("gap_1k", 1e-4, "worst (bound − benefit) ÷ bound of `greedy` (fill and repair), 1 000 classes"),
    at_most("gap_10k", 1e-6, "the same, 10 000 classes"),
    at_most("gap_100k", 1e-8, "the same, 100 000 classes"),
    at_least(
        "small_exact",
        1.0,
        "share of instances of 1 to 16 classes that `capped` solves as exhaustive search does",
    ),
    at_least("n100_proved", 0.85, "share of instances of 100 classes that `capped` proves within its steps"),
];

/// What has been measured.
#[derive(Default)]
pub struct Findings {
    values: Vec<(&'static str, Result<f64, String>)>,
    notes: Vec<(&'static str, String)>,
    /// Heading, name, value.
    more: Vec<(&'static str, String, f64)>,
}

impl Findings {
    /// A row's value; nothing when it was not measured.
    pub fn row(&mut self, name: &'static str, value: Option<f64>) {
        if let Some(value) = value {
            self.result(name, Ok(value));
        }
    }

    pub fn result(&mut self, name: &'static str, value: Result<f64, String>) {
        self.values.push((name, value));
    }

    /// A row that is not measured because its answers are wrong.
    pub fn refuse(&mut self, name: &'static str, why: &str) {
        self.result(name, Err(why.to_owned()));
    }

    pub fn note(&mut self, name: &'static str, note: String) {
        self.notes.push((name, note));
    }

    /// A figure without a goal.
    pub fn more(&mut self, heading: &'static str, name: &str, value: Option<f64>) {
        self.more.extend(value.map(|value| (heading, name.to_owned(), value)));
    }
}

impl Sense {
    fn is_met(self, value: f64, goal: f64) -> bool {
        match self {
            Self::AtMost => value <= goal,
            Self::AtLeast => value >= goal,
        }
    }

    fn sign(self) -> &'static str {
        if self == Self::AtMost { "≤" } else { "≥" }
    }

    fn code(self) -> &'static str {
        if self == Self::AtMost { "le" } else { "ge" }
    }
}

impl Findings {
    fn value(&self, row: &Row) -> Option<&Result<f64, String>> {
        self.values.iter().find(|(name, _)| *name == row.name).map(|(_, value)| value)
    }

    /// The rows that were refused, and why.
    pub fn refused(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.values.iter().filter_map(|(name, value)| Some((*name, value.as_ref().err()?.as_str())))
    }

    /// The rows of the plan, as a table in Markdown.
    pub fn table(&self, plan: &Plan) -> String {
        let mut text =
            "| name | value | goal | met | what | note |\n|---|---:|---:|---|---|---|\n".to_owned();
        for row in ROWS.into_iter().filter(|row| plan.wants(row.name)) {
            let Some(value) = self.value(&row) else { continue };
            let (value, met) = match value {
                Ok(value) => (figure(*value), if row.sense.is_met(*value, row.goal) { "yes" } else { "no" }),
                Err(why) => (format!("refused: {why}"), "no"),
            };
            let notes =
                self.notes.iter().filter(|(name, _)| *name == row.name).map(|(_, note)| note.as_str());
            let notes = notes.collect::<Vec<_>>().join("; ");
            let (name, goal, what) = (row.name, figure(row.goal), row.what);
            let _ = writeln!(
                text,
                "| {name} | {value} | {} {goal} | {met} | {what} | {notes} |",
                row.sense.sign()
            );
        }
        text
    }

    /// The figures without goals, a table for each heading, in the order in which the headings were met.
    pub fn more_tables(&self) -> String {
        let mut headings: Vec<&str> = Vec::new();
        for (heading, ..) in &self.more {
            headings.extend((!headings.contains(heading)).then_some(*heading));
        }
        let mut text = String::new();
        for heading in headings {
            let _ = writeln!(text, "\n### {heading}\n\n| what | value |\n|---|---:|");
            for (_, name, value) in self.more.iter().filter(|(h, ..)| *h == heading) {
                let _ = writeln!(text, "| {name} | {} |", figure(*value));
            }
        }
        text
    }

    fn csv(&self) -> String {
        let mut text = "name,value,goal,sense\n".to_owned();
        for row in ROWS {
            if let Some(Ok(value)) = self.value(&row) {
                let _ = writeln!(
                    text,
                    "{},{},{},{}",
                    row.name,
                    significant(*value, 6),
                    row.goal,
                    row.sense.code()
                );
            }
        }
        text
    }

    /// Writes `limits.csv` and `limits.md`.
    pub fn write(&self, plan: &Plan, docs: &Path) -> Result<(), Failure> {
        fs::create_dir_all(docs)?;
        fs::write(docs.join("limits.csv"), self.csv())?;
        fs::write(docs.join("limits.md"), self.page(plan))?;
        Ok(())
    }

    fn page(&self, plan: &Plan) -> String {
        let machine = machine::description().into_iter();
        let machine = machine.fold(String::new(), |mut text, (name, value)| {
            let _ = writeln!(text, "| {name} | {value} |");
            text
        });
        let (table, more) = (self.table(plan), self.more_tables());
        format!("{HEAD}\n{table}\n{HOW}\n## The machine\n\n| | |\n|---|---|\n{machine}\n## More\n{more}")
    }
}

/// A number for the tables.
fn figure(value: f64) -> String {
    significant(value, 4)
}

/// So many significant digits, two fewer where it takes an exponent.
fn significant(value: f64, count: usize) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-3..1e7).contains(&size) => format!("{value:.*e}", count - 3),
        size => {
            let decimals = count as i32 - 1 - size.log10().floor() as i32;
            let text = format!("{value:.*}", decimals.max(0) as usize);
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
    }
}

const HEAD: &str = "# Limits

How close the frame loop comes to what the machine can do. `cargo bench --bench limits` measures this page, writes it
together with [`limits.csv`](limits.csv) and [`growth.svg`](growth.svg), and takes a few minutes. None of it is a test:
figures depend on the machine and on what else it does.
";

const HOW: &str = "## How it is measured

    RUSTFLAGS=\"-C target-cpu=x86-64-v3\" cargo bench --bench limits     # this page
    cargo bench --bench limits                                          # what a plain build does
    cargo bench --bench limits -- --quick                               # does it run? writes nothing
    cargo bench --bench limits -- --only warm_vs_sort                   # one row; writes nothing

The target features below say which build made the page.

**Rounds.** Everything that a ratio is made of is timed in the same rounds, one after the other: the stream, the
crate, each baseline, and again. A ratio is that of the tenth percentiles over the rounds. The camera moves half
a metre per round. *Stream* is a streaming read of 16 bytes per object of the scene.

**Scene.** A million objects from a seed, scattered over a square of ground, 256 tables of two to six levels,
radii from 0.25 m to 64 m, importances from a half to two. They come in no spatial order. Costs are 0.25 µs per
draw and 1/1024 µs per triangle and vertex; the budget is two fifths of the way from the least to the most that
what is in view can cost.

**What a row includes.** `warm_*`, `cold_*`, `frame_*`, `general_*` and `growth_*` time a whole
`Runtime::frame`: the look for changes, culling, rating, selection with its certificate, hard transitions, the
list of changes, and the prediction of the frame's time; nothing is subtracted. The policy is `Predictive` with
switches free of charge, which is the textbook's objective; the default options (steadiness) are under *More*. The baselines
go from spheres to a level for each object and leave the rest out. `cull*` time `BlockTree::cull`, which lists
blocks with a mask each; a list of indices is what the box query makes. `cold_vs_stream` wipes the policy's
memory (its λ), not the runtime's of what was shown; a whole teleport, every object coming into view in one
frame, is under *More*.

**Same answers.** Before anything is timed the sorts, quickselect and the heap have to give the choice of the
textbook greedy bit for bit, and the crate's has to be within the budget and as good to a millionth of the gain;
a row whose answers differ is refused. All take steps up to the first that does not fit; the crate fills what is
left, which is the gain that its note tells. The rule of 1993 has its own answer.

**Baselines.** All of them are in `benches/limits/baselines/`, one algorithm per file, warm buffers, nothing
allocated in a round. They read columns in the order of the objects, and hulls are shared per table as the
crate's are. The strong frame keeps its objects along a Morton curve. The box query is given the exact box of
the view.

**Growth.** The scene grows around a camera in its middle that sees a quarter of it without end. Objects may be
left out (`Settings::may_skip`), and the budget is 8 ms for all sizes, which even the smallest could spend several times
over: with more than it can use, a small scene would draw all that it has. *Visits* are objects tested one by
one plus objects rated. Each size is timed in turns with the smallest.

![Visits and time over the number of objects](growth.svg)

**Gaps.** Random instances of five levels a class, slopes spread over decades, with a budget from 5 % to 90 % of the
way; bound and benefit are totals. They are for the general solvers, `knapsack::greedy` and `knapsack::capped`; what
the frame loop's solver leaves, on instances of its own, is under *More*. These are counts and repeat exactly.
";
