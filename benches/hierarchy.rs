//! An update of a cut: per frame, by the speed of the camera and the size of the mesh; and what reading a hierarchy takes.
//!
//! `cargo bench --features bake --bench hierarchy`. Terrains of 10⁴ and 10⁵ vertices, and on demand of 10⁶ and 10⁷:
//! `LOD_BUDGET_VERTICES=1e7` is how many there may be. To make a hierarchy takes a minute for 10⁶ vertices, ten
//! minutes and 5 GB of memory for 10⁷, so these are kept as `.lodh` files in the target folder's `tmp`; delete them when
//! what makes them has changed. What matters is that a frame at one speed takes the same whatever the size.

use std::hint::black_box;
use std::path::Path;
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

/// Cells on a side; those from `KEPT` on are made once.
const SIDES: [u32; 4] = [100, 316, 1000, 3162];
const KEPT: u32 = 1000;

fn main() {
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    let largest = std::env::var("LOD_BUDGET_VERTICES").map_or(200_000.0, |vertices| {
        vertices.parse::<f64>().expect("LOD_BUDGET_VERTICES must be a number, such as 1e7")
    });
    // A size is meant by its power of ten.
    for side in SIDES.into_iter().take_while(|&side| f64::from(side).powi(2) < 1.01 * largest) {
        let bytes = if side < KEPT { made(side) } else { kept(side) };
        let hierarchy = hierarchy::from_bytes(&bytes, "bench").expect("delete the file, it is not of today");
        read(&mut criterion, hierarchy.leaves(), &bytes);
        drop(bytes);
        update(&mut criterion, Arc::new(hierarchy));
    }
    criterion.final_summary();
}

/// The hierarchy of a terrain, as a file.
fn made(side: u32) -> Vec<u8> {
    let terrain = shapes::terrain(side, 1).into();
    let method = GarlandHeckbert::default();
    hierarchy::to_bytes(&hierarchy::of(&terrain, &method, &mut quietly).expect("a good shape"))
}

/// As it was made when it was needed first.
fn kept(side: u32) -> Vec<u8> {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("terrain-{side}.lodh"));
    std::fs::read(&file).unwrap_or_else(|_| {
        let bytes = made(side);
        std::fs::write(&file, &bytes).expect("the target folder can be written to");
        bytes
    })
}

fn read(criterion: &mut Criterion, leaves: usize, bytes: &[u8]) {
    let mut group = criterion.benchmark_group("read");
    group.throughput(Throughput::Bytes(bytes.len() as u64)).sample_size(10);
    group.bench_function(BenchmarkId::from_parameter(leaves), |b| {
        b.iter(|| hierarchy::from_bytes(black_box(bytes), "bench").expect("just read"));
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
