//! The rows `cull*`: from a camera to a list of what is in view.

use crate::baselines::obvhs_query::ObvhsQuery;
use crate::camera::Camera;
use crate::crowd;
use crate::ours::{self, Cull, Store};
use crate::plan::{Plan, SEED};
use crate::race::{Contestant, Times, race, timed};
use crate::report::Findings;
use crate::scene::Scene;
use crate::stream::Stream;

const ROUNDS: usize = 60;

/// Shares in view, and the rows against the stream and against obvhs.
const SHARES: [(f32, [&str; 2]); 2] =
    [(0.2, ["cull20_vs_stream", "cull20_vs_obvhs"]), (0.02, ["cull2_vs_stream", "cull2_vs_obvhs"])];

/// What a test plane by plane lets pass around the corners of a view, in the largest radius of all.
const ROOM: f32 = 2.7 * 64.0;

pub fn measure(plan: &Plan, findings: &mut Findings) {
    if !plan.wants_any(SHARES.map(|(_, rows)| rows).as_flattened()) {
        return;
    }
    let scene = Scene::scatter(plan.objects(), SEED);
    let mut ours = Ours::over(&scene);
    named(plan, &scene, &mut ours, findings);
    if plan.only.is_none() {
        kinder(plan, &scene.in_spatial_order(), &mut ours, findings);
    }
}

/// The crate's tree and store.
struct Ours {
    store: Store,
    cull: Cull,
}

impl Ours {
    fn over(scene: &Scene) -> Self {
        let (mut store, mut cull) = (Store::new(scene), Cull::default());
        cull.update(&mut store);
        Self { store, cull }
    }
}

/// The named rows.
fn named(plan: &Plan, scene: &Scene, ours: &mut Ours, findings: &mut Findings) {
    let query = ObvhsQuery::over(scene);
    for (share, rows) in SHARES.iter().filter(|(_, rows)| plan.wants_any(rows)) {
        let camera = Camera::of_share(scene, *share);
        match agree(scene, &query, ours, &camera) {
            Ok(visible) => findings.note(rows[0], format!("{visible} of {} in view", scene.len())),
            Err(why) => {
                rows.iter().for_each(|row| findings.refuse(row, &why));
                continue;
            }
        }
        let times = run(plan, scene, &query, ours, camera);
        findings.row(rows[0], times.ratio("cull", "stream"));
        findings.row(rows[1], times.ratio("obvhs", "cull"));
    }
}

/// The same against a query over objects that lie in memory as they do in space.
fn kinder(plan: &Plan, scene: &Scene, ours: &mut Ours, findings: &mut Findings) {
    let query = ObvhsQuery::over(scene);
    for (share, rows) in &SHARES {
        let times = run(plan, scene, &query, ours, Camera::of_share(scene, *share));
        let heading = "Ratios where the objects given to obvhs are in spatial order";
        findings.more(heading, rows[1], times.ratio("obvhs", "cull"));
    }
}

/// Checks that the scan of all objects, the crate, and the query with room enough see the same, and says how many.
fn agree(scene: &Scene, query: &ObvhsQuery, ours: &mut Ours, camera: &Camera) -> Result<usize, String> {
    let lens = ours::lens(camera);
    let expected = crowd::in_view(scene, &lens);
    let mut visible = Vec::new();
    query.cull(&lens, camera.aabb(ROOM), &mut visible);
    visible.sort_unstable();
    let found = ours.cull.run(&ours.store, camera);
    if visible != expected || found != expected.len() {
        return Err(format!("in view: {}, by query {}, by tree {found}", expected.len(), visible.len()));
    }
    Ok(found)
}

fn run(plan: &Plan, scene: &Scene, query: &ObvhsQuery, ours: &mut Ours, camera: Camera) -> Times {
    let stream = Stream::of(scene.len());
    let mut visible = Vec::new();
    let contestants = vec![
        Contestant::new("stream", |_| timed(|| stream.read())),
        Contestant::new("cull", |round| {
            timed(|| {
                ours.cull.run(&ours.store, &camera.at_frame(round));
            })
        }),
        Contestant::new("obvhs", |round| {
            let camera = camera.at_frame(round);
            let lens = ours::lens(&camera);
            timed(|| query.cull(&lens, camera.aabb(0.0), &mut visible))
        }),
    ];
    race(plan.rounds(ROUNDS), contestants)
}
