//! Culling a city from a corner of it: the scan, the tree, and a traversal of obvhs' own hierarchy by the box of
//! the view. `stream` is a streaming read of 16 bytes per object, the yardstick of the others.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Quat, Vec2, Vec3, Vec3A};
use lod_budget::bounds::{Aabb, Sphere};
use lod_budget::cull::{BlockTree, CullOptions, CullReport, ValueFloor, VisibleBlock, linear};
use lod_budget::scene::{Object, ObjectId, Objects, Settings};
use lod_budget::table::{LevelRecord, LodTable};
use lod_budget::view::{Lens, Projection, View, Window};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const SIZES: [u64; 4] = [1_000, 10_000, 100_000, 1_000_000];

/// Share of the city that is in view, in percent.
const SHARES: [f32; 3] = [2.0, 20.0, 100.0];

/// Side of a city with a hundred square units to an object.
fn side(objects: u64) -> f32 {
    10.0 * (objects as f32).sqrt()
}

fn city(objects: u64) -> Objects {
    city_of(objects, &Settings::default())
}

fn city_of(objects: u64, settings: &Settings) -> Objects {
    let mut city = Objects::new();
    let sphere = Sphere::new(Vec3::ZERO, 1.0);
    let table = LodTable::new("house", sphere, vec![LevelRecord::new(1000, 600)]).expect("a good table");
    let table = city.add_table(table).expect("room");
    let mut random = Pcg64::seed_from_u64(1976);
    for id in 0..objects {
        let place: [f32; 4] = random.random();
        let center = Vec3::new(place[0] * side(objects), place[1] * 30.0, place[2] * side(objects));
        let house = Sphere::new(center, 0.5 + 4.5 * place[3]);
        city.insert(Object { settings: *settings, ..Object::new(id, house, table) }).expect("a new id");
    }
    city
}

/// From a corner along the diagonal, a quarter turn wide, so far that `percent` of the area is in view.
fn view(objects: u64, percent: f32) -> View {
    let window = Window::symmetric(1.0, 1.0);
    let depth = (percent / 100.0).sqrt() * side(objects);
    let far = if percent < 100.0 { depth } else { f32::INFINITY };
    let rotation = Quat::from_rotation_y(-135f32.to_radians());
    let corner = Vec3::new(0.0, 10.0, 0.0);
    View { far, ..View::through(Projection::Perspective(window), Vec2::splat(1080.0)) }.at(corner, rotation)
}

/// The box around what is in view of a city.
fn box_of_view(objects: u64, percent: f32) -> obvhs::aabb::Aabb {
    let reach = ((percent / 100.0).sqrt() * side(objects) * std::f32::consts::SQRT_2).min(side(objects));
    obvhs::aabb::Aabb { min: Vec3A::new(-5.0, -10.0, -5.0), max: Vec3A::new(reach, 50.0, reach) }
}

fn spheres(city: &Objects) -> Vec<Sphere> {
    (0..city.len() as u64).filter_map(|id| city.get(ObjectId(id))).map(|o| o.bounds).collect()
}

fn hierarchy(spheres: &[Sphere]) -> Bvh2 {
    let boxes = spheres.iter().map(Sphere::aabb);
    let boxes: Vec<_> =
        boxes.map(|Aabb { min, max }| obvhs::aabb::Aabb { min: min.into(), max: max.into() }).collect();
    build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default())
}

fn traverse(bvh: &Bvh2, spheres: &[Sphere], lens: &Lens, aabb: obvhs::aabb::Aabb, visible: &mut Vec<u32>) {
    visible.clear();
    bvh.aabb_traverse(aabb, |bvh, node| {
        let node = &bvh.nodes[node as usize];
        let leaf = node.first_index as usize..(node.first_index + node.prim_count) as usize;
        let primitives = bvh.primitive_indices[leaf].iter();
        visible.extend(primitives.filter(|&&i| lens.frustum.sees(&spheres[i as usize])));
        true
    });
}

fn cull(c: &mut Criterion) {
    for objects in SIZES {
        let mut city = city(objects);
        let mut tree = BlockTree::new();
        tree.update(&mut city);
        let mut visible: Vec<VisibleBlock> = Vec::new();
        let spheres = spheres(&city);
        let bvh = hierarchy(&spheres);
        let mut indices = Vec::new();
        let stream = vec![[1u32; 4]; objects as usize];
        let mut group = c.benchmark_group(format!("cull/{objects}"));
        group.sample_size(10).warm_up_time(Duration::from_millis(300));
        group.measurement_time(Duration::from_millis(700));
        group.bench_function("stream", |b| {
            b.iter(|| {
                black_box(&stream).iter().fold([0; 4], |s: [u32; 4], x| [0, 1, 2, 3].map(|i| s[i] ^ x[i]))
            });
        });
        for percent in SHARES {
            let lens = view(objects, percent).lens(DVec3::ZERO);
            for (name, min_size_px) in [("", 0.0), ("-size", 4.0)] {
                let options = CullOptions { min_size_px };
                group.bench_function(BenchmarkId::new(format!("linear{name}"), percent), |b| {
                    b.iter(|| linear(&city, black_box(&lens), &options, &mut visible));
                });
                group.bench_function(BenchmarkId::new(format!("tree{name}"), percent), |b| {
                    b.iter(|| tree.cull(&city, black_box(&lens), &options, &mut visible));
                });
            }
            let aabb = box_of_view(objects, percent);
            group.bench_function(BenchmarkId::new("obvhs", percent), |b| {
                b.iter(|| traverse(&bvh, &spheres, black_box(&lens), aabb, &mut indices));
            });
            assert_eq!(
                indices.len() as u64,
                linear(&city, &lens, &CullOptions::default(), &mut visible).visible
            );
        }
    }
}

/// A city that grows around its viewer, all of whose objects may be left out, under one floor.
fn growth(_: &mut Criterion) {
    println!("growth: objects, kept, nodes + blocks looked at, us, in a fixed view under a fixed floor");
    // Leaves some 20 000 objects of the larger cities.
    let lambda = 3.2;
    for objects in [100_000, 300_000, 1_000_000, 3_000_000, 10_000_000] {
        let mut city = city_of(objects, &Settings { may_skip: true, ..Settings::default() });
        let mut tree = BlockTree::new();
        tree.update(&mut city);
        let middle = Vec3::new(0.5 * side(objects), 10.0, 0.5 * side(objects));
        let window = Projection::Perspective(Window::symmetric(1.0, 1.0));
        let view = View { far: f32::INFINITY, ..View::through(window, Vec2::splat(1080.0)) };
        let lens = view.at(middle, Quat::from_rotation_y(-135f32.to_radians())).lens(DVec3::ZERO);
        let floor = ValueFloor { lambda, best_slope: &[1.0] };
        let (options, mut visible) = (CullOptions::default(), Vec::new());
        let report = tree.cull_above(&city, &lens, &options, &floor, &mut visible);
        let times = interleaved(
            20,
            &mut [&mut || {
                black_box(tree.cull_above(&city, black_box(&lens), &options, &floor, &mut visible));
            }],
        );
        let visited = report.nodes_visited + report.blocks_tested;
        println!("{objects}, {}, {visited}, {:.0}", report.visible, times[0] * 1e6);
    }
}

/// Every `stride`th object of a city drives along, turning back at the walls.
struct Traffic {
    city: Objects,
    tree: BlockTree,
    cars: Vec<(ObjectId, Sphere, Vec3)>,
}

impl Traffic {
    fn new(objects: u64, stride: usize) -> Self {
        let (mut city, mut tree) = (city(objects), BlockTree::new());
        tree.update(&mut city);
        let mut random = Pcg64::seed_from_u64(1990);
        let cars = (0..objects).step_by(stride).filter_map(|id| {
            let [x, z]: [f32; 2] = random.random();
            let speed = Vec3::new(x - 0.5, 0.0, z - 0.5);
            city.get(ObjectId(id)).map(|car| (car.id, car.bounds, speed))
        });
        let cars = cars.collect();
        Self { city, tree, cars }
    }

    /// A sixtieth of a second at up to 30 units per second.
    fn drive(&mut self) {
        let side = side(self.city.len() as u64);
        for (id, sphere, speed) in &mut self.cars {
            let next = sphere.center + *speed;
            speed.x = if (0.0..side).contains(&next.x) { speed.x } else { -speed.x };
            speed.z = if (0.0..side).contains(&next.z) { speed.z } else { -speed.z };
            sphere.center += *speed;
            self.city.set_bounds(*id, *sphere).expect("a known id");
        }
    }
}

/// Objects in motion: what moving them, the update and the cull take, frame by frame, and what becomes of the order.
fn moving(_: &mut Criterion) {
    println!(
        "moving: share, frames driven, set_bounds us, update p50 us, p99 us, max us, cull us, nodes + blocks"
    );
    for stride in [100, 10, 1] {
        let objects = 1_000_000;
        let mut traffic = Traffic::new(objects, stride);
        let lens = view(objects, 2.0).lens(DVec3::ZERO);
        let mut visible = Vec::new();
        for frames in [1, 60, 240, 300] {
            let mut times: [Vec<f64>; 3] = Default::default();
            let mut report = CullReport::default();
            for _ in 0..frames {
                let start = Instant::now();
                traffic.drive();
                let driven = Instant::now();
                traffic.tree.update(&mut traffic.city);
                let updated = Instant::now();
                report = traffic.tree.cull(&traffic.city, &lens, &CullOptions::default(), &mut visible);
                let spans = [driven - start, updated - driven, updated.elapsed()];
                times.iter_mut().zip(spans).for_each(|(t, span)| t.push(span.as_secs_f64() * 1e6));
            }
            times.iter_mut().for_each(|t| t.sort_by(f64::total_cmp));
            let at = |which: usize, share: f64| times[which][((frames - 1) as f64 * share) as usize];
            println!(
                "1/{stride}, {frames}, {:.0}, {:.0}, {:.0}, {:.0}, {:.0}, {}",
                at(0, 0.5),
                at(1, 0.5),
                at(1, 0.99),
                at(1, 1.0),
                at(2, 0.5),
                report.nodes_visited + report.blocks_tested,
            );
        }
    }
}

/// What the first update of a store costs, and one in which nothing changed.
fn update(c: &mut Criterion) {
    for objects in SIZES {
        let city = city(objects);
        let mut group = c.benchmark_group(format!("update/{objects}"));
        group.sample_size(10).warm_up_time(Duration::from_millis(300));
        group.measurement_time(Duration::from_millis(700));
        group.bench_function("first", |b| {
            b.iter_batched_ref(
                || (city.clone(), BlockTree::new()),
                |(city, tree)| tree.update(city),
                criterion::BatchSize::PerIteration,
            );
        });
        let (mut still, mut tree) = (city.clone(), BlockTree::new());
        tree.update(&mut still);
        group.bench_function("nothing", |b| b.iter(|| tree.update(black_box(&mut still))));
    }
}

/// Tenth percentile of several timings each, the contestants taking turns.
fn interleaved(rounds: usize, contestants: &mut [&mut dyn FnMut()]) -> Vec<f64> {
    let mut times = vec![Vec::new(); contestants.len()];
    for _ in 0..rounds {
        for (run, times) in contestants.iter_mut().zip(&mut times) {
            let start = Instant::now();
            run();
            times.push(start.elapsed().as_secs_f64());
        }
    }
    times.iter_mut().for_each(|t| t.sort_by(f64::total_cmp));
    times.iter().map(|t| t[t.len() / 10]).collect()
}

/// The tree against a streaming read of 16 bytes per object and against obvhs, a million objects, in one run.
fn ratios(_: &mut Criterion) {
    let objects = 1_000_000;
    let mut city = city(objects);
    let mut tree = BlockTree::new();
    tree.update(&mut city);
    let spheres = spheres(&city);
    let bvh = hierarchy(&spheres);
    let stream = vec![[1u32; 4]; objects as usize];
    for percent in [20.0, 2.0] {
        let lens = view(objects, percent).lens(DVec3::ZERO);
        let aabb = box_of_view(objects, percent);
        let (mut visible, mut indices) = (Vec::new(), Vec::new());
        let options = CullOptions::default();
        let times = interleaved(
            40,
            &mut [
                &mut || {
                    let xor = |s: [u32; 4], x: &[u32; 4]| [0, 1, 2, 3].map(|i| s[i] ^ x[i]);
                    black_box(black_box(&stream).iter().fold([0; 4], xor));
                },
                &mut || {
                    black_box(tree.cull(&city, black_box(&lens), &options, &mut visible));
                },
                &mut || traverse(&bvh, &spheres, black_box(&lens), aabb, &mut indices),
            ],
        );
        println!("cull{percent}_vs_stream {:.3}", times[1] / times[0]);
        println!("cull{percent}_vs_obvhs {:.1}", times[2] / times[1]);
    }
}

criterion_group!(benches, cull, update);
criterion_group! { name = figures; config = Criterion::default(); targets = ratios, growth, moving }
criterion_main!(figures, benches);
