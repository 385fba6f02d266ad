//! The row `general_cost_vs_hull`: costs of which the slower of two stages counts, everything in view.

use crate::agreement::Reference;
use crate::baselines::hull_per_object::{HullPerObject, TICKS_PER_US, TwoStages};
use crate::camera::{Camera, Lens};
use crate::ours::{self, Loop, NOT_SHOWN, Policy, Store};
use crate::plan::{Plan, SEED};
use crate::race::{Contestant, race, timed};
use crate::report::Findings;
use crate::scene::Scene;

const ROUNDS: usize = 8;
const ROW: &str = "general_cost_vs_hull";

/// High enough for pixels to be the slower stage of coarse levels of one object in three or so.
const PIXEL_US: f64 = 4.0;

/// The share of the budget that a last bit of every projected area, rounded otherwise than here, may come to.
const SLACK: u64 = 10_000_000;

/// The objects of a scene as a camera sees them, with buffers.
struct Objects<'a> {
    scene: &'a Scene,
    weight: Vec<f32>,
    pixel_ticks: Vec<u64>,
}

impl<'a> Objects<'a> {
    fn of(scene: &'a Scene) -> Self {
        Self { scene, weight: Vec::new(), pixel_ticks: Vec::new() }
    }

    fn look(&mut self, lens: &Lens) -> TwoStages<'_> {
        let Self { scene, weight, pixel_ticks } = self;
        weight.clear();
        pixel_ticks.clear();
        for i in 0..scene.len() {
            let area_px2 = lens.weight(scene.sphere(i), 1.0);
            weight.push(area_px2 * scene.importance[i]);
            pixel_ticks.push((f64::from(area_px2) * (PIXEL_US * TICKS_PER_US)) as u64);
        }
        TwoStages { tables: &scene.tables, table: &scene.table, weight, pixel_ticks }
    }
}

pub fn measure(plan: &Plan, findings: &mut Findings) {
    if !plan.wants(ROW) {
        return;
    }
    let scene = Scene::scatter(plan.objects(), SEED);
    let camera = Camera::of_all();
    let mut objects = Objects::of(&scene);
    let budget = budget(&objects.look(&ours::lens(&camera)));
    let budget_us = budget as f64 / TICKS_PER_US;
    let mut store = Store::new(&scene);
    let mut frames = Loop::new(Policy::SlowerStage { pixel_us: PIXEL_US });
    match agree(&camera, &mut objects, &mut store, &mut frames, budget) {
        Ok(surplus) => findings.note(ROW, format!("gain {surplus:+.1e} against the greedy's")),
        Err(why) => return findings.refuse(ROW, &why),
    }
    let mut level = vec![0; scene.len()];
    let mut hulls = HullPerObject::default();
    let contestants = vec![
        Contestant::new("frame", |round| {
            timed(|| {
                frames.frame(&mut store, &camera.at_frame(round), budget_us);
            })
        }),
        Contestant::new("hulls", |round| {
            let lens = ours::lens(&camera.at_frame(round));
            timed(|| hulls.choose(&objects.look(&lens), budget, &mut level))
        }),
    ];
    let times = race(plan.rounds(ROUNDS), contestants);
    findings.row(ROW, times.ratio("hulls", "frame"));
    for name in ["frame", "hulls"] {
        let per_object = times.ns(name).map(|ns| ns / level.len() as f64);
        findings.more("max(geometry, pixels), all in view, ns per object", name, per_object);
    }
}

/// Two fifths of the way from the least to the most.
fn budget(objects: &TwoStages<'_>) -> u64 {
    let total = |pick: fn(usize) -> usize| -> u64 {
        let ticks = |i: usize| {
            let levels = objects.tables[usize::from(objects.table[i])].len();
            objects.ticks(i, pick(levels) as u8)
        };
        (0..objects.table.len()).map(ticks).sum()
    };
    let (least, most) = (total(|levels| levels - 1), total(|_| 0));
    least + (most - least) / 5 * 2
}

/// Checks that the bracket changes nothing of the greedy's answer, and the crate against it.
fn agree(
    camera: &Camera,
    objects: &mut Objects<'_>,
    store: &mut Store,
    frames: &mut Loop,
    budget: u64,
) -> Result<f64, String> {
    const FRAME: usize = 3;
    let count = objects.scene.len();
    let (mut bracketed, mut sorted) = (HullPerObject::default(), HullPerObject::default());
    let mut levels = [vec![0; count], vec![0; count]];
    for frame in 0..=FRAME {
        let camera = camera.at_frame(frame);
        bracketed.choose(&objects.look(&ours::lens(&camera)), budget, &mut levels[0]);
        frames.frame(store, &camera, budget as f64 / TICKS_PER_US);
    }
    let seen = objects.look(&ours::lens(&camera.at_frame(FRAME)));
    sorted.choose(&seen, budget, &mut levels[1]);
    if levels[0] != levels[1] {
        return Err("the bracket changes the greedy's answer".to_owned());
    }
    let coarsest: Vec<u8> =
        seen.table.iter().map(|&t| (seen.tables[usize::from(t)].len() - 1) as u8).collect();
    let (textbook, least) = (seen.totals(&levels[1]), seen.totals(&coarsest));
    let reference = Reference { textbook, least, budget, slack: budget / SLACK, classes: count };
    let ours = frames.levels(store, count);
    if ours.contains(&NOT_SHOWN) {
        return Err("the frame does not show all that is in view".to_owned());
    }
    reference.check(seen.totals(&ours))
}
