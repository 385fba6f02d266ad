//! The rows `frame_*` and `predictive_vs_static`: whole frames with a fifth of the scene in view.

use std::cell::RefCell;

use crate::agreement::Reference;
use crate::baselines::Selection;
use crate::baselines::classes::Hull;
use crate::baselines::strong_frame::StrongFrame;
use crate::baselines::struct_sort::StructSort;
use crate::baselines::textbook_frame::TextbookFrame;
use crate::camera::Camera;
use crate::crowd::{self, Crowd};
use crate::ours::{self, Loop, NOT_SHOWN, Policy, Store};
use crate::plan::{Plan, SEED};
use crate::race::{Contestant, Times, race, timed};
use crate::report::Findings;
use crate::scene::Scene;
use crate::stream::Stream;

const ROUNDS: usize = 40;
/// The share of the ground that is in view.
const SHARE: f32 = 0.208;
const ROWS: [&str; 5] = [
    "frame_vs_stream",
    "frame_ns_per_visible",
    "frame_vs_textbook",
    "frame_vs_strong",
    "predictive_vs_static",
];
/// See [`crate::culls`].
const ROOM: f32 = 2.7 * 64.0;

struct Place {
    scene: Scene,
    hulls: Vec<Hull>,
    camera: Camera,
    budget: u64,
    visible: usize,
}

impl Place {
    fn new(objects: usize) -> Self {
        let scene = Scene::scatter(objects, SEED);
        let camera = Camera::of_share(&scene, SHARE);
        let visible = crowd::in_view(&scene, &ours::lens(&camera));
        let (hulls, budget) = (crowd::hulls(&scene), crowd::budget(&scene, &visible));
        Self { scene, hulls, camera, budget, visible: visible.len() }
    }

    fn budget_us(&self) -> f64 {
        crowd::in_us(self.budget)
    }
}

pub fn measure(plan: &Plan, findings: &mut Findings) {
    if !plan.wants_any(&ROWS) {
        return;
    }
    let place = Place::new(plan.objects());
    let mut textbook = TextbookFrame::over(&place.scene, &place.hulls);
    let mut strong = StrongFrame::over(&place.scene, &place.hulls);
    match agree(&place, &mut textbook, &mut strong) {
        Ok(surplus) => findings.note(
            "frame_vs_stream",
            format!("{} objects in view; gain {surplus:+.1e} against the textbook greedy's", place.visible),
        ),
        Err(why) => return ROWS.iter().for_each(|row| findings.refuse(row, &why)),
    }
    let times = run(plan, &place, textbook, strong);
    findings.row("frame_vs_stream", times.ratio("frame", "stream"));
    findings.row("frame_ns_per_visible", times.ns("frame").map(|ns| ns / place.visible as f64));
    findings.row("frame_vs_textbook", times.ratio("textbook", "frame"));
    findings.row("frame_vs_strong", times.ratio("strong", "frame"));
    findings.row("predictive_vs_static", times.ratio("frame", "static"));
}

/// Checks that the frames of both baselines and the crate see the same and give the textbook's answer. Returns by
/// how much the crate's is better.
fn agree(
    place: &Place,
    textbook: &mut TextbookFrame<'_>,
    strong: &mut StrongFrame<'_>,
) -> Result<f64, String> {
    const FRAME: usize = 3;
    let camera = place.camera.at_frame(FRAME);
    let lens = ours::lens(&camera);
    let visible = crowd::in_view(&place.scene, &lens);
    let crowd = Crowd::of(&place.scene, &lens, &visible);
    let classes = crowd.classes(&place.hulls);
    let mut position = vec![0; visible.len()];
    StructSort::default().choose(&classes, place.budget, &mut position);
    textbook.run(&lens, camera.aabb(ROOM), place.budget);
    let reference = Reference::of(&classes, &position, place.budget);
    reference.check(classes.totals(&sorted_positions(textbook, &visible)?))?;
    strong.run(&lens, place.budget);
    let of_strong = Crowd { table: strong.table.clone(), weight: strong.weight.clone() };
    reference.check(of_strong.classes(&place.hulls).totals(&strong.position))?;
    let (mut store, mut frames) = (Store::new(&place.scene), Loop::new(Policy::Predictive));
    (0..=FRAME).for_each(|f| {
        frames.frame(&mut store, &place.camera.at_frame(f), place.budget_us());
    });
    let levels = frames.levels(&store, place.scene.len());
    if levels.iter().filter(|&&l| l != NOT_SHOWN).count() != visible.len() {
        return Err("the frame shows what is not in view".to_owned());
    }
    reference.check(crowd.totals(&place.scene, visible.iter().map(|&i| levels[i as usize]))?)
}

/// The positions that the textbook's frame has given to what is in view, objects ascending.
fn sorted_positions(textbook: &TextbookFrame<'_>, visible: &[u32]) -> Result<Vec<u8>, String> {
    let pairs = textbook.visible.iter().copied().zip(textbook.position.iter().copied());
    let mut found: Vec<(u32, u8)> = pairs.collect();
    found.sort_unstable();
    if found.iter().map(|f| f.0).ne(visible.iter().copied()) {
        return Err(format!("the textbook's frame sees {} of {}", found.len(), visible.len()));
    }
    Ok(found.into_iter().map(|f| f.1).collect())
}

fn run(plan: &Plan, place: &Place, mut textbook: TextbookFrame<'_>, mut strong: StrongFrame<'_>) -> Times {
    let stream = Stream::of(place.scene.len());
    let store = RefCell::new(Store::new(&place.scene));
    let frame_of = |name, policy| {
        let (mut frames, store) = (Loop::new(policy), &store);
        Contestant::new(name, move |round| {
            let (camera, store) = (place.camera.at_frame(round), &mut store.borrow_mut());
            timed(|| {
                frames.frame(store, &camera, place.budget_us());
            })
        })
    };
    let mut contestants = vec![
        Contestant::new("stream", |_| timed(|| stream.read())),
        frame_of("frame", Policy::Predictive),
        frame_of("static", Policy::Static),
    ];
    if plan.wants("frame_vs_strong") {
        contestants.push(Contestant::new("strong", |round| {
            let lens = ours::lens(&place.camera.at_frame(round));
            timed(|| strong.run(&lens, place.budget))
        }));
    }
    if plan.wants("frame_vs_textbook") {
        contestants.push(Contestant::new("textbook", |round| {
            let camera = place.camera.at_frame(round);
            let lens = ours::lens(&camera);
            timed(|| textbook.run(&lens, camera.aabb(0.0), place.budget))
        }));
    }
    race(plan.rounds(ROUNDS), contestants)
}
