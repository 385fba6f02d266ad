//! Culling a city from a corner of it: the scan, the tree, and a traversal of obvhs' own hierarchy by the box of
//! the view. `stream` is a streaming read of 16 bytes per object, the yardstick of the others.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Quat, Vec2, Vec3, Vec3A};
use lod_budget::bounds::{Aabb, Sphere};
use lod_budget::cull::{BlockTree, CullOptions, VisibleBlock, linear};
use lod_budget::scene::{BLOCK, Object, ObjectId, Objects};
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
    let mut city = Objects::new();
    let sphere = Sphere::new(Vec3::ZERO, 1.0);
    let table = LodTable::new("house", sphere, vec![LevelRecord::new(1000, 600)]).expect("a good table");
    let table = city.add_table(table).expect("room");
    let mut random = Pcg64::seed_from_u64(1976);
    for id in 0..objects {
        let place: [f32; 4] = random.random();
        let center = Vec3::new(place[0] * side(objects), place[1] * 30.0, place[2] * side(objects));
        let house = Sphere::new(center, 0.5 + 4.5 * place[3]);
        city.insert(Object::new(id, house, table)).expect("a new id");
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

/// What changes cost: all objects arranged at first, one in a hundred moved, and nothing.
fn update(c: &mut Criterion) {
    for objects in SIZES {
        let city = city(objects);
        let mut group = c.benchmark_group(format!("update/{objects}"));
        group.sample_size(10).warm_up_time(Duration::from_millis(300));
        group.measurement_time(Duration::from_millis(700));
        let (mut moving, mut tree) = (city.clone(), BlockTree::new());
        group.bench_function("first", |b| {
            b.iter_batched_ref(
                || (city.clone(), BlockTree::new()),
                |(city, tree)| tree.update(city),
                criterion::BatchSize::PerIteration,
            );
        });
        tree.update(&mut moving);
        let mut lift = 0.0;
        group.bench_function("one percent", |b| {
            b.iter(|| {
                lift = 1.0 - lift;
                for slot in (0..objects as usize).step_by(100) {
                    let sphere = moving.blocks()[slot / BLOCK].sphere(slot % BLOCK);
                    let id = moving.id_of(slot).expect("every slot is occupied");
                    let lifted = Sphere::new(sphere.center.with_y(lift), sphere.radius);
                    moving.set_bounds(id, lifted).expect("a known id");
                }
                tree.update(&mut moving)
            });
        });
        group.bench_function("nothing", |b| b.iter(|| tree.update(black_box(&mut moving))));
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
        let warm = interleaved(
            40,
            &mut [&mut || {
                black_box(tree.cull(&city, black_box(&lens), &options, &mut visible));
            }],
        );
        println!("warm {percent} us {:.1}", warm[0] * 1e6);
        println!("cull{percent}_vs_stream {:.3}", times[1] / times[0]);
        println!("cull{percent}_vs_obvhs {:.1}", times[2] / times[1]);
        println!("{percent} us {:.1} {:?}", times[1] * 1e6, tree.cull(&city, &lens, &options, &mut visible));
    }
}

criterion_group!(benches, cull, update);
criterion_group! { name = figures; config = Criterion::default(); targets = ratios }
criterion_main!(figures, benches);
