//! The rows `growth_*`: a fixed budget, objects that may be left out, and a scene that grows around a still camera.

use std::path::Path;
use std::time::Duration;

use plotters::prelude::*;

use crate::camera::Camera;
use crate::machine;
use crate::ours::{self, Loop, Policy, Store};
use crate::plan::{Plan, SEED};
use crate::race::{Contestant, Times, race, timed};
use crate::report::{Failure, Findings};
use crate::scene::Scene;

const ROWS: [&str; 2] = ["growth_visited", "growth_time"];
const ROUNDS: usize = 6;

/// The budget: what a display of 120 Hz leaves, less than the smallest scene could use.
const BUDGET_US: f64 = 8_000.0;

const SIZES: [usize; 5] = [100_000, 300_000, 1_000_000, 3_000_000, 10_000_000];
/// With less memory than the largest scene needs, it is this large instead.
const SMALLER: usize = 4_000_000;
const NEEDED_GIB: f64 = 14.0;

/// One size of the scene.
pub struct Point {
    objects: usize,
    visits: usize,
    visible: usize,
    /// Time of a frame in ms.
    ms: f64,
    /// The same over that of the smallest scene, measured in the same rounds.
    factor: f64,
}

/// Measures all sizes. Returns the points for the plot.
pub fn measure(plan: &Plan, findings: &mut Findings) -> Vec<Point> {
    if !plan.wants_any(&ROWS) {
        return Vec::new();
    }
    let sizes = sizes(plan, findings);
    let mut points: Vec<Point> = Vec::new();
    for objects in sizes {
        let mut subjects = [Subject::new(SIZES[0].min(objects)), Subject::new(objects)];
        points.push(point(plan, objects, &mut subjects));
    }
    if let [first, .., last] = &points[..] {
        findings.row("growth_visited", Some(last.visits as f64 / first.visits as f64));
        findings.row("growth_time", Some(last.factor));
        findings.note("growth_time", format!("{} to {} objects", first.objects, last.objects));
    }
    for point in &points {
        let name = format!("{} objects, {} in view, {} visits", point.objects, point.visible, point.visits);
        findings.more("Growth at a fixed budget, ms per frame", &name, Some(point.ms));
    }
    points
}

/// The scenes to measure: as large as the memory allows, which is told.
fn sizes(plan: &Plan, findings: &mut Findings) -> Vec<usize> {
    let mut sizes = SIZES.to_vec();
    if plan.quick {
        sizes.truncate(3);
    } else if machine::free_gib().is_some_and(|gib| gib < NEEDED_GIB) {
        sizes[4] = SMALLER;
        let why = format!("less than {NEEDED_GIB} GiB of memory are free: {SMALLER} objects at most");
        ROWS.iter().for_each(|row| findings.note(row, why.clone()));
    }
    sizes
}

/// A scene with its frame loop.
struct Subject {
    store: Store,
    camera: Camera,
    frames: Loop,
}

impl Subject {
    fn new(objects: usize) -> Self {
        let scene = Scene::scatter(objects, SEED);
        let (store, camera) = (Store::may_skip(&scene), Camera::in_the_middle(&scene));
        Self { store, camera, frames: Loop::new(Policy::Predictive) }
    }

    fn frame(&mut self, round: usize) -> (ours::Done, Duration) {
        let mut done = ours::Done::default();
        let camera = self.camera.at_frame(round);
        let time = timed(|| done = self.frames.frame(&mut self.store, &camera, BUDGET_US));
        (done, time)
    }
}

fn point(plan: &Plan, objects: usize, [small, large]: &mut [Subject; 2]) -> Point {
    let mut done = ours::Done::default();
    let contestants = vec![
        Contestant::new("small", |round| small.frame(round).1),
        Contestant::new("large", |round| {
            let time;
            (done, time) = large.frame(round);
            time
        }),
    ];
    let times: Times = race(plan.rounds(ROUNDS), contestants);
    Point {
        objects,
        visits: done.visits,
        visible: done.visible,
        ms: times.ns("large").map_or(f64::NAN, |ns| ns * 1e-6),
        factor: times.ratio("large", "small").unwrap_or(f64::NAN),
    }
}

const SIZE_PX: (u32, u32) = (820, 480);
/// Colours that colour-blind eyes tell apart, after M. Okabe and K. Ito, "Color Universal Design", 2008.
const VISITS: RGBColor = RGBColor(0x00, 0x72, 0xb2);
const TIME: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
const FAINT: RGBColor = RGBColor(0x77, 0x77, 0x77);
const GRID: RGBColor = RGBColor(0xe2, 0xe2, 0xe2);

/// Draws visits and time over the number of objects, both as factors over the smallest scene.
pub fn plot(points: &[Point], file: &Path) -> Result<(), Failure> {
    let [first, .., last] = points else { return Ok(()) };
    let x = |p: &Point| p.objects as f64;
    let growth = x(last) / x(first);
    let visits: Vec<_> = points.iter().map(|p| (x(p), p.visits as f64 / first.visits as f64)).collect();
    let time: Vec<_> = points.iter().map(|p| (x(p), p.factor)).collect();
    let most = visits.iter().chain(&time).fold(growth, |most, p| most.max(p.1));
    let root = SVGBackend::new(file, SIZE_PX).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption("A scene that grows around the camera, at a fixed budget", ("sans-serif", 20))
        .margin(14)
        .margin_right(36)
        .x_label_area_size(46)
        .y_label_area_size(60)
        .build_cartesian_2d((x(first)..x(last)).log_scale(), (0.7..most * 1.3).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .x_desc("objects in the scene")
        .y_desc(format!("factor over {} objects", short(x(first))))
        .x_label_formatter(&|&x| short(x))
        .y_label_formatter(&|y| format!("{y}"))
        .label_style(("sans-serif", 15))
        .draw()?;
    let proportional = [(x(first), 1.0), (x(last), growth)];
    let lines = [
        ("in proportion to the scene", FAINT, &proportional[..]),
        ("objects visited", VISITS, &visits),
        ("time of a frame", TIME, &time),
    ];
    for (name, color, line) in lines {
        let series = LineSeries::new(line.iter().copied(), color.stroke_width(2)).point_size(3);
        let drawn = chart.draw_series(series)?;
        let key = move |(x, y)| PathElement::new([(x, y), (x + 22, y)], color.stroke_width(2));
        drawn.label(name).legend(key);
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE)
        .border_style(GRID)
        .label_font(("sans-serif", 15))
        .draw()?;
    root.present()?;
    Ok(())
}

/// A number of objects in thousands or millions.
fn short(objects: f64) -> String {
    if objects < 1e6 { format!("{} k", objects / 1e3) } else { format!("{} M", objects / 1e6) }
}
