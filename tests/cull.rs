//! Culling: the exact test against the vocabulary's own arithmetic, and the tree against the linear scan.

use glam::{DVec3, Quat, Vec2, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::cull::{BlockTree, CullOptions, CullReport, ValueFloor, VisibleBlock, linear, linear_above};
use lod_budget::rate::{CostModel, Stages};
use lod_budget::scene::{BLOCK, Object, ObjectId, Objects, Settings, TableId};
use lod_budget::table::{Level, LevelRecord, LodTable};
use lod_budget::view::{Lens, Projection, View, Window};
use proptest::prelude::*;
use proptest::sample::{Index, select};

fn store(objects: impl IntoIterator<Item = (Sphere, Settings)>) -> Objects {
    let mut store = Objects::new();
    let sphere = Sphere::new(Vec3::ZERO, 1.0);
    for triangles in [100, 10, 100_000] {
        let levels = vec![LevelRecord::new(triangles, triangles / 2)];
        store.add_table(LodTable::new("ball", sphere, levels).expect("a good table")).expect("room");
    }
    for (id, (bounds, settings)) in (0..).zip(objects) {
        insert(&mut store, id, bounds, settings);
    }
    store
}

fn insert(store: &mut Objects, id: u64, bounds: Sphere, settings: Settings) {
    store.insert(Object { settings, ..Object::new(id, bounds, TableId((id % 3) as u16)) }).expect("a new id");
}

fn plain(spheres: impl IntoIterator<Item = Sphere>) -> Objects {
    store(spheres.into_iter().map(|s| (s, Settings::default())))
}

fn arranged(objects: &mut Objects) -> BlockTree {
    let mut tree = BlockTree::new();
    tree.update(objects);
    tree
}

fn grid(side: i32, step: f32) -> impl Iterator<Item = Sphere> {
    let axis = -side..=side;
    axis.clone()
        .flat_map(move |x| axis.clone().map(move |z| (x, z)))
        .map(move |(x, z)| Sphere::new(Vec3::new(x as f32, 0.0, z as f32) * step, 0.5))
}

fn ahead(distance: f32) -> Sphere {
    Sphere::new(Vec3::new(0.0, 0.0, -distance), 1.0)
}

/// A window of 45° to either side, whose planes go through points of whole numbers.
fn square() -> View {
    View::through(Projection::Perspective(Window::symmetric(1.0, 1.0)), Vec2::splat(1000.0))
}

fn lens(view: &View) -> Lens {
    view.lens(DVec3::ZERO)
}

/// What is asked beside the view.
#[derive(Clone, Debug, Default)]
struct Question {
    options: CullOptions,
    lambda: f64,
    best_slope: Vec<f32>,
}

impl Question {
    fn floor(&self) -> ValueFloor<'_> {
        ValueFloor { lambda: self.lambda, best_slope: &self.best_slope }
    }
}

impl From<CullOptions> for Question {
    fn from(options: CullOptions) -> Self {
        Self { options, ..Self::default() }
    }
}

/// The answer of the scan, into a buffer that held something else.
fn scan(objects: &Objects, lens: &Lens, options: &CullOptions) -> (Vec<VisibleBlock>, CullReport) {
    let mut visible = vec![VisibleBlock { block: 9, mask: 9 }];
    let report = linear(objects, lens, options, &mut visible);
    (visible, report)
}

/// The answer of the tree, likewise.
fn search(
    tree: &BlockTree,
    objects: &Objects,
    lens: &Lens,
    options: &CullOptions,
) -> (Vec<VisibleBlock>, CullReport) {
    let mut visible = vec![VisibleBlock { block: 9, mask: 9 }];
    let report = tree.cull(objects, lens, options, &mut visible);
    (visible, report)
}

/// Who is visible, by id: what must not depend on the arrangement.
fn ids(objects: &Objects, visible: &[VisibleBlock]) -> Vec<ObjectId> {
    let slots = |v: &VisibleBlock| {
        let (block, mask) = (v.block as usize, v.mask);
        (0..BLOCK).filter(move |lane| mask & (1 << lane) != 0).map(move |lane| block * BLOCK + lane)
    };
    let mut ids: Vec<ObjectId> = visible.iter().flat_map(slots).filter_map(|s| objects.id_of(s)).collect();
    ids.sort_unstable();
    ids
}

/// The contract, object by object, in the words of the vocabulary.
fn is_visible(object: &Object, lens: &Lens, question: &Question) -> bool {
    let (Object { bounds, settings, .. }, options) = (object, &question.options);
    let true_distance = Lens { perspective: true, near: 0.0, ..*lens }.distance(bounds.center);
    let biased = Sphere::new(bounds.center, bounds.radius * settings.bias);
    let below = options.min_size_px > 0.0 && lens.size_px(&biased) < options.min_size_px;
    let beyond = true_distance > settings.draw_distance;
    bounds.is_valid()
        && !settings.hidden
        && lens.frustum.sees(bounds)
        && !below
        && !beyond
        && !is_passed_over(object, lens, question)
}

/// Worth, by the documentation, not quite λ: area · gain · slope ÷ multiplier, where the eye is not inside. The tables
/// of these tests have one level each.
fn is_passed_over(object: &Object, lens: &Lens, question: &Question) -> bool {
    let Object { bounds, settings, table, .. } = object;
    let Some(&slope) = question.best_slope.get(usize::from(table.0)) else { return false };
    let distance = f64::from(lens.distance(bounds.center));
    let (radius, gain) = (f64::from(bounds.radius), settings.importance * (settings.bias * settings.bias));
    let worth = radius * radius * f64::from(gain) * f64::from(slope) / f64::from(settings.cost_multiplier);
    let scale = f64::from(lens.scale_px);
    let unit_px2 = std::f64::consts::PI * scale * scale;
    let inside = lens.perspective && lens.distance(bounds.center) <= bounds.radius;
    let least = question.lambda * (1.0 - 4e-6);
    settings.may_be_left_out(1) && !inside && least > 0.0 && worth * unit_px2 < least * (distance * distance)
}

fn live(objects: &Objects) -> u64 {
    objects.blocks().iter().map(|b| u64::from(b.live.count_ones())).sum()
}

/// Compares the scan with the contract, and the tree with the scan. `all` are the ids in the store, ascending.
fn compare(tree: &BlockTree, objects: &Objects, all: &[u64], lens: &Lens, question: impl Into<Question>) {
    let question = question.into();
    let buffer = || vec![VisibleBlock { block: 9, mask: 9 }];
    let mut expected = buffer();
    let scanned = linear_above(objects, lens, &question.options, &question.floor(), &mut expected);
    let of_contract = all
        .iter()
        .map(|&id| ObjectId(id))
        .filter(|&id| objects.get(id).is_some_and(|object| is_visible(&object, lens, &question)));
    assert_eq!(ids(objects, &expected), of_contract.collect::<Vec<_>>());
    assert!(expected.windows(2).all(|w| w[0].block < w[1].block) && expected.iter().all(|v| v.mask != 0));
    assert_eq!(scanned.visible, expected.iter().map(|v| u64::from(v.mask.count_ones())).sum::<u64>());
    assert_eq!((scanned.objects_tested, scanned.nodes_visited), (live(objects), 0));

    let mut found = buffer();
    let searched = tree.cull_above(objects, lens, &question.options, &question.floor(), &mut found);
    assert_eq!(found, expected);
    assert_eq!(searched.visible, scanned.visible);
    assert!(searched.worth_too_little >= scanned.worth_too_little);
    assert!(searched.objects_tested + searched.objects_accepted <= live(objects));
    assert!(searched.objects_accepted <= searched.visible);
}

#[test]
fn an_empty_store_shows_nothing() {
    let mut objects = Objects::new();
    let tree = arranged(&mut objects);
    compare(&tree, &objects, &[], &lens(&square()), CullOptions::default());
}

#[test]
fn one_object_is_seen_or_not() {
    for (distance, expected) in [(5.0, 1), (-5.0, 0)] {
        let mut objects = plain([ahead(distance)]);
        let tree = arranged(&mut objects);
        let (visible, report) = search(&tree, &objects, &lens(&square()), &CullOptions::default());
        assert_eq!((visible.len(), report.visible), (expected, expected as u64));
    }
}

#[test]
fn spheres_that_touch_a_plane_are_seen() {
    let objects = plain([ahead(1001.0), ahead(1001.5)]);
    let (visible, _) = scan(&objects, &lens(&square()), &CullOptions::default());
    assert_eq!(ids(&objects, &visible), [ObjectId(0)]);
}

#[test]
fn a_subtree_in_view_is_accepted_untested_and_one_out_of_view_is_not_entered() {
    let mut objects = plain(grid(40, 1.0));
    let tree = arranged(&mut objects);
    let far = View { far: f32::INFINITY, ..square() };
    let above = far.at(Vec3::Y * 500.0, Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let (_, report) = search(&tree, &objects, &lens(&above), &CullOptions::default());
    let all = objects.len() as u64;
    let expected = CullReport { nodes_visited: 1, objects_accepted: all, visible: all, ..Default::default() };
    assert_eq!(report, expected);
    let away = far.at(Vec3::Z * -500.0, Quat::IDENTITY);
    let (_, report) = search(&tree, &objects, &lens(&away), &CullOptions::default());
    assert_eq!(report, CullReport { nodes_visited: 1, ..Default::default() });
}

#[test]
fn a_city_is_tested_at_the_border_of_the_view_only() {
    let mut objects = plain(grid(100, 4.0));
    let tree = arranged(&mut objects);
    let street = lens(&square().at(Vec3::new(3.0, 1.0, 7.0), Quat::from_rotation_y(0.4)));
    let (visible, report) = search(&tree, &objects, &street, &CullOptions::default());
    assert_eq!(visible, scan(&objects, &street, &CullOptions::default()).0);
    assert!(report.objects_tested < objects.len() as u64 / 5, "{report:?}");
    assert!(report.objects_accepted > report.visible / 2, "{report:?}");
}

#[test]
fn small_and_far_subtrees_are_left_out_whole() {
    let mut objects = plain(grid(40, 1.0));
    let mut tree = arranged(&mut objects);
    let view = lens(&square().at(Vec3::Z * 100.0, Quat::IDENTITY));
    let (_, report) = search(&tree, &objects, &view, &CullOptions { min_size_px: 1e6 });
    assert_eq!((report.nodes_visited, report.too_small), (1, objects.len() as u64));
    for id in 0..objects.len() as u64 {
        let settings = Settings { draw_distance: 1.0, ..Settings::default() };
        objects.set_settings(ObjectId(id), settings).expect("a known id");
    }
    tree.update(&mut objects);
    let (_, report) = search(&tree, &objects, &view, &CullOptions::default());
    assert_eq!((report.nodes_visited, report.too_far), (1, objects.len() as u64));
}

#[test]
fn subtrees_that_are_worth_too_little_are_left_out_whole() {
    let mut objects = store(grid(40, 1.0).map(|sphere| (sphere, skippable())));
    let tree = arranged(&mut objects);
    let view = lens(&square().at(Vec3::Z * 100.0, Quat::IDENTITY));
    let floor = ValueFloor { lambda: 1e9, best_slope: &[1.0; 3] };
    let mut visible = Vec::new();
    let report = tree.cull_above(&objects, &view, &CullOptions::default(), &floor, &mut visible);
    let expected =
        CullReport { nodes_visited: 1, worth_too_little: objects.len() as u64, ..Default::default() };
    assert_eq!((visible.len(), report), (0, expected));
}

/// With ten times the city around the same view, hardly more is looked at.
#[test]
fn what_is_far_and_worth_little_costs_nothing() {
    let visits = |side: i32| {
        let mut objects = store(grid(side, 4.0).map(|sphere| (sphere, skippable())));
        let tree = arranged(&mut objects);
        let view = lens(&View { far: f32::INFINITY, ..square() });
        let floor = ValueFloor { lambda: 100.0, best_slope: &[1.0; 3] };
        let mut visible = Vec::new();
        let report = tree.cull_above(&objects, &view, &CullOptions::default(), &floor, &mut visible);
        assert!(report.visible > 10, "{report:?}");
        report.nodes_visited + report.blocks_tested
    };
    assert!(visits(160) < 2 * visits(50), "{} and {}", visits(160), visits(50));
}

#[test]
fn bias_counts_as_size_and_orthographic_sizes_ignore_distance() {
    let biased = Settings { bias: 4.0, ..Settings::default() };
    let plain = Settings::default();
    let objects = store([(ahead(10.0), plain), (ahead(900.0), biased), (ahead(900.0), plain)]);
    let options = CullOptions { min_size_px: 30.0 };
    let perspective = scan(&objects, &lens(&square()), &options);
    assert_eq!((ids(&objects, &perspective.0), perspective.1.too_small), (vec![ObjectId(0)], 2));
    let flat = lens(&View::orthographic(100.0, Vec2::splat(1000.0)));
    let orthographic = scan(&objects, &flat, &options);
    assert_eq!((ids(&objects, &orthographic.0), orthographic.1.too_small), (vec![ObjectId(1)], 2));
}

#[test]
fn a_draw_distance_is_a_true_distance_in_any_view() {
    let limited = Settings { draw_distance: 50.0, ..Settings::default() };
    let objects = store([(ahead(50.0), limited), (ahead(50.5), limited)]);
    for view in [square(), View::orthographic(10.0, Vec2::splat(1000.0))] {
        let (visible, report) = scan(&objects, &lens(&view), &CullOptions::default());
        assert_eq!((ids(&objects, &visible), report.too_far), (vec![ObjectId(0)], 1));
    }
}

#[test]
fn nothing_is_done_when_nothing_changed_and_little_when_little_did() {
    let mut objects = plain(grid(20, 1.0));
    let mut tree = BlockTree::new();
    let first = tree.update(&mut objects);
    assert!(first.reordered && first.blocks_refitted == objects.blocks().len());
    assert_eq!(tree.update(&mut objects), Default::default());
    objects.set_bounds(ObjectId(3), Sphere::new(Vec3::splat(2.0), 1.0)).expect("a known id");
    let second = tree.update(&mut objects);
    assert_eq!((second.blocks_refitted, second.reordered), (1, false));
}

#[test]
fn few_objects_are_never_arranged() {
    assert!(!BlockTree::new().update(&mut plain(grid(1, 1.0))).reordered);
}

/// A thousand objects in a row of towns, each going to a town of its own and staying there.
#[test]
fn objects_that_have_moved_away_find_their_neighbours_a_few_at_a_time() {
    let mut objects = plain(grid(60, 1.0));
    let mut tree = arranged(&mut objects);
    let n = objects.len() as u64;
    let at_home = border(&tree, &objects);
    for id in (0..n).step_by(40) {
        let place = (id * 797) % n;
        let center = Vec3::new((place % 121) as f32 - 60.0, 0.0, (place / 121) as f32 - 60.0);
        objects.set_bounds(ObjectId(id), Sphere::new(center, 0.5)).expect("a known id");
    }
    let astray = tree.update(&mut objects);
    assert!(!astray.reordered && astray.objects_repaired > 0 && astray.objects_repaired < n as usize / 2);
    let mut updates = 1;
    while tree.update(&mut objects).objects_repaired > 0 {
        updates += 1;
        assert!(updates < 100, "repairs come to an end");
    }
    assert!(border(&tree, &objects) < 2 * at_home, "{} for {at_home}", border(&tree, &objects));
    let all: Vec<u64> = (0..n).collect();
    compare(&tree, &objects, &all, &lens(&square()), CullOptions::default());
}

/// Objects tested one by one when a quarter of the scene is in view.
fn border(tree: &BlockTree, objects: &Objects) -> u64 {
    let view = lens(&square().at(Vec3::Y, Quat::IDENTITY));
    search(tree, objects, &view, &CullOptions::default()).1.objects_tested
}

#[test]
fn a_scene_in_full_motion_is_never_arranged_as_a_whole() {
    let mut objects = plain(grid(60, 1.0));
    let mut tree = arranged(&mut objects);
    let n = objects.len() as u64;
    for frame in 0..50 {
        for id in 0..n {
            let place = (id * 797 + frame) % n;
            let center = Vec3::new((place % 121) as f32, 0.0, (place / 121) as f32);
            objects.set_bounds(ObjectId(id), Sphere::new(center, 0.5)).expect("a known id");
        }
        let report = tree.update(&mut objects);
        assert!(!report.reordered && report.objects_repaired < 7000, "{report:?}");
    }
}

#[test]
fn a_store_that_has_doubled_or_is_half_empty_is_arranged() {
    let mut objects = plain(grid(20, 1.0));
    let mut tree = arranged(&mut objects);
    let (n, blocks) = (objects.len() as u64, objects.blocks().len());
    (0..n / 3).for_each(|id| assert!(objects.remove(ObjectId(id)).is_some()));
    assert!(!tree.update(&mut objects).reordered);
    (n / 3..n * 3 / 4).for_each(|id| assert!(objects.remove(ObjectId(id)).is_some()));
    assert!(tree.update(&mut objects).reordered);
    assert!(objects.disorder() == 0 && objects.blocks().len() < blocks / 2);
    grid(20, 1.0).zip(n..).for_each(|(sphere, id)| insert(&mut objects, id, sphere, Settings::default()));
    assert!(tree.update(&mut objects).reordered);
}

#[test]
fn slots_do_not_pile_up_where_objects_come_and_go() {
    let mut objects = plain(grid(20, 1.0));
    let mut tree = arranged(&mut objects);
    let n = objects.len() as u64;
    for id in 0..10 * n {
        assert!(objects.remove(ObjectId(id)).is_some());
        insert(&mut objects, id + n, ahead((id % 50) as f32), Settings::default());
        if id % 100 == 0 {
            assert!(!tree.update(&mut objects).reordered);
        }
    }
    assert!(objects.blocks().len() * BLOCK < 2 * n as usize, "{} blocks", objects.blocks().len());
}

/// Slopes that change are followed a slice at a time; the answer is right all the way.
#[test]
fn new_slopes_are_followed_in_slices() {
    let mut objects = store(grid(120, 0.5).map(|sphere| (sphere, skippable())));
    let mut tree = BlockTree::new();
    tree.expect_slopes(&[1.0, 2.0, 3.0]);
    tree.update(&mut objects);
    let all: Vec<u64> = (0..objects.len() as u64).collect();
    let question = Question { lambda: 3e3, best_slope: vec![5.0, 0.01, 1.0], ..Question::default() };
    let view = lens(&square().at(Vec3::Z * 80.0, Quat::IDENTITY));
    tree.expect_slopes(&question.best_slope);
    let mut slices = 0;
    loop {
        compare(&tree, &objects, &all, &view, question.clone());
        match tree.update(&mut objects).blocks_refitted {
            0 => break,
            _ => slices += 1,
        }
    }
    assert!(slices > 1);
}

#[test]
fn the_arrangement_does_not_depend_on_the_order_of_insertion() {
    let spheres: Vec<Sphere> = grid(20, 1.7).collect();
    let arrange = |ids: Vec<usize>| {
        let mut objects = plain([]);
        ids.into_iter().for_each(|id| insert(&mut objects, id as u64, spheres[id], Settings::default()));
        arranged(&mut objects);
        (0..objects.len()).map(|slot| objects.id_of(slot)).collect::<Vec<_>>()
    };
    let forwards = arrange((0..spheres.len()).collect());
    assert_eq!(forwards, arrange((0..spheres.len()).rev().collect()));
    assert!(forwards.iter().all(Option::is_some));
}

/// Where all distances tie, the hierarchy's builder would take quadratic time: minutes instead of milliseconds.
#[test]
fn a_crowd_in_one_place_and_a_row_of_posts_are_arranged() {
    let n = 60_000;
    let crowd = |place| plain((0..n).map(move |_| place));
    let posts = (0..n).map(|i| Sphere::new(Vec3::X * i as f32, 0.25));
    for mut objects in [crowd(Sphere::new(Vec3::splat(7.0), 1.0)), crowd(Sphere::default()), plain(posts)] {
        let mut tree = BlockTree::new();
        assert!(tree.update(&mut objects).reordered);
        let view = lens(&square().at(Vec3::new(9.0, 9.0, 30.0), Quat::IDENTITY));
        let options = CullOptions { min_size_px: 1.0 };
        assert_eq!(search(&tree, &objects, &view, &options).0, scan(&objects, &view, &options).0);
    }
}

#[test]
fn hidden_and_broken_objects_share_no_block_with_the_others() {
    let hidden = Settings { hidden: true, ..Settings::default() };
    let broken = Sphere::new(Vec3::NAN, 1.0);
    let mut objects = store(grid(20, 1.0).enumerate().map(|(i, sphere)| match i % 3 {
        0 => (sphere, hidden),
        1 => (broken, Settings::default()),
        _ => (sphere, Settings::default()),
    }));
    arranged(&mut objects);
    let mixed = objects.blocks().iter().filter(|b| b.live != 0 && b.live != u16::MAX).count();
    assert!(mixed <= 1, "{mixed} blocks of {}", objects.blocks().len());
}

#[test]
fn a_tree_that_was_not_updated_still_answers_right() {
    let mut objects = plain(grid(20, 1.0));
    let tree = arranged(&mut objects);
    objects.set_bounds(ObjectId(5), ahead(90.0)).expect("a known id");
    let view = lens(&square().at(Vec3::Z * -60.0, Quat::IDENTITY));
    let (visible, report) = search(&tree, &objects, &view, &CullOptions::default());
    assert_eq!((ids(&objects, &visible), report.nodes_visited), (vec![ObjectId(5)], 0));
}

/// An eye so far off that its coordinates overflow, and an object beyond boxes: no box of theirs says anything.
#[test]
fn an_eye_at_infinity_sees_no_small_object() {
    let huge = Sphere::new(Vec3::ZERO, 1e20);
    let mut objects = plain(grid(20, 1.0).chain([huge]));
    let tree = arranged(&mut objects);
    let view = View { origin: DVec3::X * 1e300, far: f32::INFINITY, ..square() };
    let view = lens(&view.at(Vec3::ZERO, Quat::from_xyzw(0.0, 0.794, 0.0, 0.676)));
    assert_eq!(view.eye.x, f32::INFINITY);
    let all: Vec<u64> = (0..objects.len() as u64).collect();
    compare(&tree, &objects, &all, &view, CullOptions { min_size_px: 1.0 });
}

/// Numbers so small that halving them loses a bit: relative room for rounding is no room there.
#[test]
fn a_scene_of_subnormal_numbers_is_seen_alike() {
    let step = f32::from_bits(1);
    let spheres = grid(12, step).map(|s| Sphere::new(s.center, 0.0));
    let mut objects = plain(spheres);
    let tree = arranged(&mut objects);
    let all: Vec<u64> = (0..objects.len() as u64).collect();
    for turn in 0..64 {
        let rotation = Quat::from_rotation_y(turn as f32 * 0.1);
        let view = View { near: step, ..square() }.at(Vec3::X * step * (turn % 7) as f32, rotation);
        compare(&tree, &objects, &all, &lens(&view), CullOptions::default());
    }
}

#[test]
fn reports_add_up() {
    let a = CullReport { visible: 1, too_far: 2, nodes_visited: 3, ..Default::default() };
    let mut sum = CullReport { visible: 10, blocks_tested: 5, ..Default::default() };
    sum += a;
    assert_eq!(sum, CullReport { visible: 11, blocks_tested: 5, ..a });
}

/// A coordinate: usually of the neighbourhood, often a whole number, sometimes absurd.
fn coordinate() -> impl Strategy<Value = f32> {
    let absurd = vec![0.0, -0.0, 1e-40, -1e-30, 1e14, -3e15, 1e19, -2e30, f32::MAX, f32::MIN];
    prop_oneof![
        12 => -60f32..60.0,
        12 => (-20i8..20).prop_map(f32::from),
        1 => -1e7f32..1e7,
        1 => select(absurd),
    ]
}

fn center() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        30 => (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from),
        1 => Just(Vec3::new(f32::NAN, 0.0, 0.0)),
        1 => Just(Vec3::new(0.0, f32::NEG_INFINITY, 0.0)),
    ]
}

fn radius() -> impl Strategy<Value = f32> {
    let absurd = vec![0.0, 1e-40, 1e-6, 1e3, 1e10, 1e20, f32::MAX, f32::INFINITY, f32::NAN, -1.0];
    prop_oneof![12 => 0f32..3.0, 6 => (0u8..4).prop_map(f32::from), 1 => select(absurd)]
}

fn bounds() -> impl Strategy<Value = Sphere> {
    (center(), radius()).prop_map(|(center, radius)| Sphere::new(center, radius))
}

fn settings() -> impl Strategy<Value = Settings> {
    let bias = select(vec![1.0, 1.0, 0.25, 3.0, 1e-3, 1e3, 1e-30, 1e6]);
    let distance = select(vec![f32::INFINITY, f32::INFINITY, 0.0, 5.0, 20.0, 33.3, 1e20]);
    let cost = select(vec![1.0, 1.0, 0.5, 8.0, 1e-30, 1e6]);
    let special = (bias, distance, cost, prop::bool::weighted(0.1), any::<bool>()).prop_map(
        |(bias, draw_distance, cost_multiplier, hidden, may_skip)| Settings {
            bias,
            draw_distance,
            cost_multiplier,
            hidden,
            may_skip,
            ..Settings::default()
        },
    );
    let forced = Settings { forced: Some(Level(0)), may_skip: true, ..Settings::default() };
    prop_oneof![6 => Just(Settings::default()), 6 => Just(skippable()), 4 => special, 1 => Just(forced)]
}

/// What may be left out, and has a plain look otherwise.
fn skippable() -> Settings {
    Settings { may_skip: true, ..Settings::default() }
}

fn anything() -> impl Strategy<Value = (Sphere, Settings)> {
    (bounds(), settings())
}

fn ordinary() -> impl Strategy<Value = (Sphere, Settings)> {
    (-60f32..60.0, -60f32..60.0, -60f32..60.0, 0f32..2.0)
        .prop_map(|(x, y, z, r)| (Sphere::new(Vec3::new(x, y, z), r), Settings::default()))
}

fn ordinary_and_skippable() -> impl Strategy<Value = (Sphere, Settings)> {
    (ordinary(), 0.0f32..4.0)
        .prop_map(|((sphere, _), gain)| (sphere, Settings { importance: gain, ..skippable() }))
}

/// Scenes of ordinary objects take the tree's short cuts; the others have a bit of everything.
fn scene() -> impl Strategy<Value = Vec<(Sphere, Settings)>> {
    prop_oneof![
        prop::collection::vec(anything(), 0..60),
        prop::collection::vec(anything(), 60..900),
        prop::collection::vec(prop_oneof![200 => ordinary(), 1 => anything()], 100..1500),
        prop::collection::vec(ordinary(), 0..3000),
        prop::collection::vec(ordinary_and_skippable(), 0..3000),
        prop::collection::vec(prop_oneof![ordinary(), ordinary_and_skippable()], 100..2000),
    ]
}

fn window() -> impl Strategy<Value = Window> {
    let edge = || prop_oneof![Just(1.0f32), Just(0.5), 0.01f32..3.0, Just(1e4)];
    let around = (edge(), edge(), edge(), edge()).prop_map(|(left, right, bottom, top)| Window {
        left: -left,
        right,
        bottom: -bottom,
        top,
    });
    let aside = (0.1f32..2.0, 0.1f32..2.0).prop_map(|(x, width)| Window {
        left: x,
        right: x + width,
        bottom: -x,
        top: width,
    });
    prop_oneof![4 => around, 1 => aside]
}

fn projection() -> impl Strategy<Value = Projection> {
    prop_oneof![
        3 => window().prop_map(Projection::Perspective),
        1 => window().prop_map(|w| Projection::Orthographic(Window {
            left: w.left * 20.0,
            right: w.right * 20.0,
            bottom: w.bottom * 20.0,
            top: w.top * 20.0,
        })),
    ]
}

fn rotation() -> impl Strategy<Value = Quat> {
    let part = || -1f32..1.0;
    let any = (part(), part(), part(), 0.01f32..1.0).prop_map(|(x, y, z, w)| Quat::from_xyzw(x, y, z, w));
    prop_oneof![1 => Just(Quat::IDENTITY), 1 => Just(Quat::from_xyzw(0.0, 1.0, 0.0, 0.0)), 3 => any]
}

fn view() -> impl Strategy<Value = View> {
    let depth = select(vec![(0.1, 1000.0), (1.0, 20.0), (0.5, f32::INFINITY), (1e-3, 1e30)]);
    let eye = (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from);
    let eye = prop_oneof![6 => eye, 1 => Just(Vec3::ZERO)];
    let origin = prop_oneof![8 => Just(0.0), 1 => Just(1e9), 1 => Just(1e300)];
    (projection(), rotation(), eye, depth, origin).prop_map(|(projection, rotation, eye, (near, far), x)| {
        View {
            near,
            far,
            origin: DVec3::X * x,
            ..View::through(projection, Vec2::new(1280.0, 720.0)).at(eye, rotation)
        }
    })
}

fn options() -> impl Strategy<Value = CullOptions> {
    let sizes = vec![0.0, 0.0, 0.5, 8.0, 40.0, 200.0, 1e6, f32::INFINITY, f32::NAN, -1.0, 1e-40];
    select(sizes).prop_map(|min_size_px| CullOptions { min_size_px })
}

fn question() -> impl Strategy<Value = Question> {
    let absurd = vec![0.0, -1.0, 1e-45, 1e30, f32::MAX, f32::INFINITY, f32::NAN];
    let slope = prop_oneof![6 => 0.01f32..10.0, 3 => Just(1.0), 1 => select(absurd)];
    let slopes = prop::collection::vec(slope, 0..5);
    let lambdas = vec![0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1.0, 1e3];
    let lambda = prop_oneof![2 => Just(0.0), 4 => 1f64..1e4, 4 => 1e3f64..1e6, 2 => select(lambdas)];
    (options(), lambda, slopes).prop_map(|(options, lambda, best_slope)| Question {
        options,
        lambda,
        best_slope,
    })
}

/// What may happen to a store between two frames.
#[derive(Clone, Debug)]
enum Change {
    Insert(Sphere, Settings),
    Remove(Index),
    Move(Index, Sphere),
    Set(Index, Settings),
    Shift(f64),
}

fn change() -> impl Strategy<Value = Change> {
    let who = any::<Index>;
    prop_oneof![
        8 => anything().prop_map(|(bounds, settings)| Change::Insert(bounds, settings)),
        8 => who().prop_map(Change::Remove),
        8 => (who(), bounds()).prop_map(|(who, bounds)| Change::Move(who, bounds)),
        4 => (who(), settings()).prop_map(|(who, settings)| Change::Set(who, settings)),
        1 => (-30.0..30.0).prop_map(Change::Shift),
    ]
}

/// A store that changes, and the ids in it, in ascending order.
struct Changing {
    objects: Objects,
    ids: Vec<u64>,
    next: u64,
}

impl Changing {
    fn new(scene: Vec<(Sphere, Settings)>) -> Self {
        let next = scene.len() as u64;
        Self { objects: store(scene), ids: (0..next).collect(), next }
    }

    fn apply(&mut self, change: Change) {
        match change {
            Change::Insert(bounds, settings) => {
                insert(&mut self.objects, self.next, bounds, settings);
                self.ids.push(self.next);
                self.next += 1;
            }
            Change::Shift(by) => self.objects.shift_origin(self.objects.origin() + DVec3::splat(by)),
            _ if self.ids.is_empty() => {}
            Change::Remove(who) => {
                let id = self.ids.remove(who.index(self.ids.len()));
                assert!(self.objects.remove(ObjectId(id)).is_some());
            }
            Change::Move(who, bounds) => {
                let id = ObjectId(self.ids[who.index(self.ids.len())]);
                self.objects.set_bounds(id, bounds).expect("a known id");
            }
            Change::Set(who, settings) => {
                let id = ObjectId(self.ids[who.index(self.ids.len())]);
                self.objects.set_settings(id, settings).expect("a known id");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn the_tree_sees_what_the_scan_sees(
        scene in scene(),
        views in prop::collection::vec((view(), question()), 1..6),
    ) {
        let all: Vec<u64> = (0..scene.len() as u64).collect();
        let mut objects = store(scene);
        let tree = arranged(&mut objects);
        for (view, question) in views {
            compare(&tree, &objects, &all, &lens(&view), question);
        }
    }

    /// In the arithmetic of rating, and at any level: it would cost more than it is worth at λ.
    #[test]
    fn what_is_passed_over_is_not_worth_its_cost(
        scene in scene(),
        view in view(),
        lambda in 1f64..1e6,
        stages in select(vec![Stages::Sum, Stages::Max]),
    ) {
        let objects = store(scene);
        let (lens, model) = (lens(&view), CostModel { stages, ..CostModel::default() });
        let levels: Vec<LevelRecord> = objects.tables().iter().map(|table| table.levels()[0]).collect();
        let slope = |level: &LevelRecord| (f64::from(level.accuracy) / model.geometry_us(level)) as f32;
        let best_slope: Vec<f32> = levels.iter().map(slope).collect();
        let floor = ValueFloor { lambda, best_slope: &best_slope };
        let (mut all, mut kept) = (Vec::new(), Vec::new());
        linear(&objects, &lens, &CullOptions::default(), &mut all);
        linear_above(&objects, &lens, &CullOptions::default(), &floor, &mut kept);
        let kept = ids(&objects, &kept);
        for id in ids(&objects, &all).into_iter().filter(|id| kept.binary_search(id).is_err()) {
            let Object { bounds, settings, table, .. } = objects.get(id).expect("a known id");
            let (level, scale) = (&levels[usize::from(table.0)], f64::from(settings.cost_multiplier));
            let area_px2 = lens.area_px2(&bounds);
            let weight = area_px2 * (settings.importance * (settings.bias * settings.bias));
            let benefit = f64::from(weight * level.accuracy);
            let cost_us = model.object_us(model.geometry_us(level), scale, f64::from(area_px2) * scale);
            prop_assert!(settings.may_skip && benefit <= lambda * cost_us);
        }
    }

    #[test]
    fn an_eye_at_an_object_changes_nothing(
        scene in scene(),
        view in view(),
        question in question(),
        who: Index,
    ) {
        prop_assume!(!scene.is_empty());
        let eye = scene[who.index(scene.len())].0.center;
        let all: Vec<u64> = (0..scene.len() as u64).collect();
        let mut objects = store(scene);
        let tree = arranged(&mut objects);
        compare(&tree, &objects, &all, &lens(&View { eye, ..view }), question);
    }

    #[test]
    fn a_scene_that_changes_is_seen_as_it_is(
        scene in scene(),
        frames in prop::collection::vec((prop::collection::vec(change(), 0..40), view(), question()), 1..12),
    ) {
        let mut scene = Changing::new(scene);
        let mut tree = BlockTree::new();
        for (changes, view, question) in frames {
            changes.into_iter().for_each(|change| scene.apply(change));
            tree.update(&mut scene.objects);
            let lens = view.lens(scene.objects.origin());
            compare(&tree, &scene.objects, &scene.ids, &lens, question);
        }
    }

    #[test]
    fn a_broken_view_is_answered_alike(scene in scene(), view in view(), kind in 0..5) {
        let view = match kind {
            0 => View { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..view },
            1 => View { eye: Vec3::NAN, ..view },
            2 => View { near: 0.0, viewport_px: Vec2::ZERO, ..view },
            3 => View { rotation: Quat::from_xyzw(0.0, 1e-22, 0.0, 1e-22), ..view },
            _ => View { far: f32::NAN, ..view },
        };
        let all: Vec<u64> = (0..scene.len() as u64).collect();
        let mut objects = store(scene);
        let tree = arranged(&mut objects);
        compare(&tree, &objects, &all, &lens(&view), CullOptions { min_size_px: 1.0 });
    }
}
