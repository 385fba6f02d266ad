//! The rows `warm_*` and `cold_vs_stream`: everything in view.

use std::cell::RefCell;

use crate::agreement::{Reference, with_textbook};
use crate::baselines::Selection;
use crate::baselines::classes::{Classes, Hull};
use crate::baselines::funkhouser_sequin::FunkhouserSequin;
use crate::baselines::heap::Heap;
use crate::baselines::quickselect::Quickselect;
use crate::baselines::radix_sort::RadixSort;
use crate::baselines::struct_sort::StructSort;
use crate::baselines::u64_sort::U64Sort;
use crate::camera::Camera;
use crate::crowd::{self, Crowd};
use crate::ours::{self, Loop, Policy, Store};
use crate::plan::{Plan, SEED};
use crate::race::{Contestant, Times, race, timed};
use crate::report::Findings;
use crate::scene::Scene;
use crate::stream::Stream;

const ROUNDS: usize = 25;
/// A heap of a million misses the caches at every step, and takes seconds.
const HEAP_EVERY: usize = 5;

/// Who is timed for which row.
const ROWS: [(&str, &str); 6] = [
    ("warm_vs_stream", "stream"),
    ("warm_vs_sort", "sort"),
    ("warm_vs_u64_sort", "u64 sort"),
    ("warm_vs_quickselect", "quickselect"),
    ("warm_vs_fs", "1993"),
    ("cold_vs_stream", "cold"),
];

/// A baseline with its buffers.
struct Entrant {
    name: &'static str,
    selection: Box<dyn Selection>,
    weight: Vec<f32>,
    position: Vec<u8>,
}

impl Entrant {
    fn new(name: &'static str, selection: impl Selection + 'static) -> Self {
        Self { name, selection: Box::new(selection), weight: Vec::new(), position: Vec::new() }
    }

    /// Rates all objects and chooses.
    fn run(&mut self, place: &Place, frame: usize) {
        let lens = ours::lens(&place.camera.at_frame(frame));
        crowd::rate_all(&place.scene, &lens, &mut self.weight);
        self.position.resize(place.scene.len(), 0);
        let classes = Classes { hulls: &place.hulls, table: &place.scene.table, weight: &self.weight };
        self.selection.choose(&classes, place.budget, &mut self.position);
    }
}

/// Where all of it happens.
struct Place {
    scene: Scene,
    hulls: Vec<Hull>,
    camera: Camera,
    budget: u64,
}

impl Place {
    fn new(objects: usize) -> Self {
        let scene = Scene::scatter(objects, SEED);
        let all: Vec<u32> = (0..objects as u32).collect();
        let (hulls, budget) = (crowd::hulls(&scene), crowd::budget(&scene, &all));
        Self { scene, hulls, camera: Camera::of_all(), budget }
    }
}

pub fn measure(plan: &Plan, findings: &mut Findings) {
    if !plan.wants_any(&ROWS.map(|(row, _)| row)) {
        return;
    }
    let place = Place::new(plan.objects());
    let mut entrants = entrants(plan);
    if let Err(why) = agree(&place, &mut entrants, findings) {
        ROWS.iter().for_each(|(row, _)| findings.refuse(row, &why));
        return;
    }
    let times = run(plan, &place, entrants);
    findings.row("warm_vs_stream", times.ratio("warm", "stream"));
    findings.row("cold_vs_stream", times.ratio("cold", "stream"));
    for (row, baseline) in &ROWS[1..5] {
        findings.row(row, times.ratio(baseline, "warm"));
    }
    for name in ["stream", "warm", "cold", "sort", "u64 sort", "radix sort", "quickselect", "heap", "1993"] {
        let per_object = times.ns(name).map(|ns| ns / place.scene.len() as f64);
        findings.more("All in view, ns per object", name, per_object);
    }
}

fn entrants(plan: &Plan) -> Vec<Entrant> {
    let mut all = vec![
        Entrant::new("sort", StructSort::default()),
        Entrant::new("u64 sort", U64Sort::default()),
        Entrant::new("radix sort", RadixSort::default()),
        Entrant::new("quickselect", Quickselect::default()),
        Entrant::new("heap", Heap::default()),
        Entrant::new("1993", FunkhouserSequin::default()),
    ];
    let wanted = |name: &str| match ROWS.iter().find(|(_, baseline)| *baseline == name) {
        Some((row, _)) => plan.wants(row),
        None => plan.only.is_none(),
    };
    all.retain(|e| wanted(e.name));
    all
}

/// Checks that all but the rule of 1993, which does not claim to, agree with the textbook, and the crate with it.
fn agree(place: &Place, entrants: &mut [Entrant], findings: &mut Findings) -> Result<(), String> {
    const FRAME: usize = 3;
    let mut textbook = Entrant::new("textbook", StructSort::default());
    textbook.run(place, FRAME);
    for entrant in entrants.iter_mut().filter(|e| e.name != "1993") {
        entrant.run(place, FRAME);
        with_textbook(entrant.name, &entrant.position, &textbook.position)?;
    }
    let crowd = Crowd { table: place.scene.table.clone(), weight: textbook.weight };
    let reference = Reference::of(&crowd.classes(&place.hulls), &textbook.position, place.budget);
    let mut store = Store::new(&place.scene);
    for (policy, row) in [(Policy::Predictive, "warm_vs_stream"), (Policy::Forgetful, "cold_vs_stream")] {
        let mut frames = Loop::new(policy);
        for frame in 0..=FRAME {
            frames.frame(&mut store, &place.camera.at_frame(frame), crowd::in_us(place.budget));
        }
        let levels = frames.levels(&store, place.scene.len());
        let surplus = reference.check(crowd.totals(&place.scene, levels.into_iter())?)?;
        findings.note(row, format!("gain {surplus:+.1e} against the textbook greedy's"));
    }
    Ok(())
}

fn run(plan: &Plan, place: &Place, entrants: Vec<Entrant>) -> Times {
    let stream = Stream::of(place.scene.len());
    let store = RefCell::new(Store::new(&place.scene));
    let mut contestants = vec![
        Contestant::new("stream", |_| timed(|| stream.read())),
        ours("warm", Policy::Predictive, place, &store),
    ];
    if plan.wants("cold_vs_stream") {
        contestants.push(ours("cold", Policy::Forgetful, place, &store));
    }
    contestants.extend(entrants.into_iter().map(|mut entrant| {
        let every = if entrant.name == "heap" { HEAP_EVERY } else { 1 };
        Contestant::new(entrant.name, move |round| timed(|| entrant.run(place, round))).every(every)
    }));
    race(plan.rounds(ROUNDS), contestants)
}

fn ours<'a>(
    name: &'static str,
    policy: Policy,
    place: &'a Place,
    store: &'a RefCell<Store>,
) -> Contestant<'a> {
    let mut frames = Loop::new(policy);
    Contestant::new(name, move |round| {
        let (camera, store) = (place.camera.at_frame(round), &mut store.borrow_mut());
        timed(|| {
            frames.frame(store, &camera, crowd::in_us(place.budget));
        })
    })
}
