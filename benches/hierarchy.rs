//! An update of a cut: per frame, by the speed of the camera and the size of the mesh; and what reading a hierarchy takes.
//!
//! `cargo bench --features bake --bench hierarchy`. Terrains of 10⁴ and 10⁵ vertices; with a number as argument, one of so
//! many cells on a side as well. What matters is that a frame at one speed takes the same whatever the size.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, Throughput};
use glam::{Mat3, Quat, Vec2, Vec3};
use lod_budget::View;
use lod_budget::bake::simplify::{GarlandHeckbert, quietly};
use lod_budget::bake::{hierarchy, shapes};
use lod_budget::hierarchy::{Budget, Cut, Hierarchy};

/// Triangles of the cut.
const BUDGET: usize = 8_000;

/// How far the camera comes in a frame, in widths of the terrain.
const SPEEDS: [f32; 4] = [0.0, 1e-4, 1e-3, 1e-2];

fn main() {
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    let named = std::env::args().filter_map(|argument| argument.parse().ok());
    for side in [100, 316].into_iter().chain(named) {
        let terrain = shapes::terrain(side, 1).into();
        let hierarchy =
            hierarchy::of(&terrain, &GarlandHeckbert::default(), &mut quietly).expect("a good shape");
        read(&mut criterion, &hierarchy);
        update(&mut criterion, Arc::new(hierarchy));
    }
    criterion.final_summary();
}

fn read(criterion: &mut Criterion, hierarchy: &Hierarchy) {
    let bytes = hierarchy::to_bytes(hierarchy);
    let mut group = criterion.benchmark_group("read");
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function(BenchmarkId::from_parameter(hierarchy.leaves()), |b| {
        b.iter(|| hierarchy::from_bytes(black_box(&bytes), "bench").expect("just written"));
    });
    group.finish();
}

fn update(criterion: &mut Criterion, hierarchy: Arc<Hierarchy>) {
    let mut group = criterion.benchmark_group("update");
    for speed in SPEEDS {
        let mut cut = Cut::new(hierarchy.clone());
        let mut way = 0.0;
        group.bench_function(BenchmarkId::new(hierarchy.leaves().to_string(), speed), |b| {
            b.iter(|| {
                way += speed;
                cut.update(&[view(way)], &Budget::triangles(BUDGET))
            });
        });
    }
    group.finish();
}

/// Around the middle of the terrain, along a circle whose circumference is twice its width.
fn view(way: f32) -> View {
    let at = Vec2::from_angle(way * std::f32::consts::PI);
    let eye = (Vec2::splat(0.5) + at * std::f32::consts::FRAC_1_PI).extend(0.25);
    let forward = at.perp().extend(-0.3).normalize();
    let right = forward.cross(Vec3::Z).normalize();
    let rotation = Quat::from_mat3(&Mat3::from_cols(right, right.cross(forward), -forward));
    View { near: 1e-3, ..View::perspective(1.0, Vec2::new(1920.0, 1080.0)).at(eye, rotation) }
}
