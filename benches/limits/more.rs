//! Figures without goals: sizes, policies, moving objects, cold caches, teleports.

use std::cell::RefCell;
use std::hint::black_box;
use std::time::Duration;

use crate::camera::Camera;
use crate::crowd;
use crate::machine;
use crate::ours::{Loop, Policy, SelectStage, Store};
use crate::plan::{Plan, SEED};
use crate::race::{Contestant, Times, race, timed};
use crate::report::Findings;
use crate::scene::Scene;

const ROUNDS: usize = 10;
const SHARE: f32 = 0.2;
/// Memory that a scene of ten million objects is given.
const LARGE: (usize, f64) = (10_000_000, 14.0);
/// Larger than the caches that a core has to itself.
const COLD_BYTES: usize = 64 << 20;

pub fn measure(plan: &Plan, findings: &mut Findings) {
    if plan.only.is_some() {
        return;
    }
    let fits = machine::free_gib().is_none_or(|gib| gib >= LARGE.1);
    let sizes = [10_000, 100_000, 1_000_000, LARGE.0];
    for objects in sizes.into_iter().filter(|&n| n <= plan.objects() || fits && !plan.quick) {
        let mut place = Place::new(objects);
        per_object(plan, &mut place, findings);
        if objects == 1_000_000 {
            moving(plan, &mut place, findings);
            teleport(plan, &mut place, findings);
        }
        if (10_000..=1_000_000).contains(&objects) {
            cold_caches(plan, &mut place, findings);
        }
    }
}

/// A scene with a view of all of it and one of a fifth.
struct Place {
    scene: Scene,
    store: Store,
    all: View,
    fifth: View,
}

#[derive(Clone, Copy)]
struct View {
    camera: Camera,
    budget_us: f64,
    visible: usize,
}

impl View {
    fn new(scene: &Scene, camera: Camera) -> Self {
        let visible = crowd::in_view(scene, &crate::ours::lens(&camera));
        let budget_us = crowd::in_us(crowd::budget(scene, &visible));
        Self { camera, budget_us, visible: visible.len() }
    }
}

impl Place {
    fn new(objects: usize) -> Self {
        let scene = Scene::scatter(objects, SEED);
        let (all, fifth) = (Camera::of_all(), Camera::of_share(&scene, SHARE));
        let [all, fifth] = [all, fifth].map(|camera| View::new(&scene, camera));
        Self { store: Store::new(&scene), scene, all, fifth }
    }

    fn frame(&mut self, frames: &mut Loop, view: View, round: usize) -> Duration {
        timed(|| {
            frames.frame(&mut self.store, &view.camera.at_frame(round), view.budget_us);
        })
    }
}

/// Frames and selection alone, by size and policy. Of the largest scene, where a policy's first frame takes long, the
/// first policy alone.
fn per_object(plan: &Plan, place: &mut Place, findings: &mut Findings) {
    let (all, fifth) = (place.all, place.fifth);
    let objects = place.scene.len();
    let is_large = objects > 1_000_000;
    let rounds = plan.rounds(if is_large { ROUNDS / 2 } else { ROUNDS });
    let mut tell = |what: &str, ns: Option<f64>, per: usize| {
        let name = format!("{objects} objects, {what}");
        findings.more("By size, ns per object in view", &name, ns.map(|ns| ns / per as f64));
    };
    let policies = [Policy::Predictive, Policy::Priced, Policy::Static];
    for policy in policies.into_iter().take(if is_large { 1 } else { 3 }) {
        let (mut frames, mut stage) = (Loop::new(policy), SelectStage::new(policy));
        for (view, seen) in [(all, "all".to_owned()), (fifth, fifth.visible.to_string())] {
            let times = frames_of(&mut frames, &mut stage, place, view, rounds);
            let name = |what| format!("{}, {seen} in view: {what}", policy.name());
            tell(&name("frame"), times.ns("frame"), view.visible);
            tell(&name("selection alone"), times.ns("select"), view.visible);
        }
    }
}

/// Times frames of a moving camera, and on their candidates the selection stage by itself.
fn frames_of(
    frames: &mut Loop,
    stage: &mut SelectStage,
    place: &mut Place,
    view: View,
    rounds: usize,
) -> Times {
    let (place, frames) = (RefCell::new(place), RefCell::new(frames));
    let contestants = vec![
        Contestant::new("frame", |round| place.borrow_mut().frame(&mut frames.borrow_mut(), view, round)),
        Contestant::new("select", |_| {
            stage.select(&frames.borrow(), &place.borrow().store, |select| timed(select))
        }),
    ];
    race(rounds, contestants)
}

/// Shares of all objects that move, in percent, and the names of the frames and of the calls.
const MOVING: [(usize, &str, &str); 4] = [
    (0, "none moves: frame", "none moves: no call"),
    (1, "1 % move: frame", "1 % move: calls of set_bounds"),
    (10, "10 % move: frame", "10 % move: calls of set_bounds"),
    (100, "all move: frame", "all move: calls of set_bounds"),
];

/// A share of all objects lifted by a metre before each frame, or let down again.
fn moving(plan: &Plan, place: &mut Place, findings: &mut Findings) {
    let fifth = place.fifth;
    let (place, frames) = (RefCell::new(place), RefCell::new(Loop::new(Policy::Predictive)));
    let (place, frames) = (&place, &frames);
    let pair = |(percent, frame, calls): (usize, &'static str, &'static str)| {
        [
            Contestant::new(calls, move |round| timed(|| lift(&mut place.borrow_mut(), percent, round))),
            Contestant::new(frame, move |round| {
                place.borrow_mut().frame(&mut frames.borrow_mut(), fifth, round)
            }),
        ]
    };
    let times = race(plan.rounds(ROUNDS), MOVING.into_iter().flat_map(pair).collect());
    for name in MOVING.iter().flat_map(|&(_, frame, calls)| [frame, calls]) {
        let heading = "Moving objects of a million, a fifth in view, ms";
        findings.more(heading, name, times.ns(name).map(|ns| ns * 1e-6));
    }
}

fn lift(place: &mut Place, percent: usize, round: usize) {
    let by = if round.is_multiple_of(2) { 1.0 } else { 0.0 };
    let Place { scene, store, .. } = place;
    for object in (0..scene.len()).filter(|i| i % 100 < percent) {
        let [x, y, z, radius] = scene.sphere(object);
        store.place(object, [x, y + by, z, radius]);
    }
}

/// Everything comes into view in one frame, after one in which nothing was.
fn teleport(plan: &Plan, place: &mut Place, findings: &mut Findings) {
    let all = place.all;
    let nowhere = View { camera: Camera { eye: [1e6, 0.0, 1e6], far: 1.0 }, ..all };
    let mut frames = Loop::new(Policy::Forgetful);
    let contestants = vec![Contestant::new("teleport", |round| {
        place.frame(&mut frames, nowhere, round);
        place.frame(&mut frames, all, round)
    })];
    let times = race(plan.rounds(ROUNDS), contestants);
    let per_object = times.ns("teleport").map(|ns| ns / all.visible as f64);
    findings.more("Teleport, ns per object", "everything comes into view in one frame", per_object);
}

/// Frames between which a buffer is walked that is larger than the caches of a core.
fn cold_caches(plan: &Plan, place: &mut Place, findings: &mut Findings) {
    let mut frames = Loop::new(Policy::Predictive);
    let mut buffer = vec![0u64; COLD_BYTES / 8];
    let fifth = place.fifth;
    let contestants = vec![Contestant::new("cold", |round| {
        black_box(&mut buffer).iter_mut().for_each(|x| *x += 1);
        place.frame(&mut frames, fifth, round)
    })];
    let times = race(plan.rounds(3 * ROUNDS), contestants);
    let name = format!("{} objects, {} in view: frame", place.scene.len(), fifth.visible);
    let per_object = times.ns("cold").map(|ns| ns / fifth.visible as f64);
    findings.more("After a walk over 64 MiB, ns per object in view", &name, per_object);
}
