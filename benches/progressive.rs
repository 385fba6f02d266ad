//! A million triangles as a progressive mesh: reading the file's bytes, loading it, and extracting a tenth, in one run, so
//! that the latter two can be told as ratios to the first. Building it comes first. The file is read from
//! the system's cache, not from a disk.

use std::fs;
use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput};
use lod_budget::bake::Mesh;
use lod_budget::bake::progressive::{Cursor, Options, Progressive};
use lod_budget::bake::shapes::torus_knot;
use lod_budget::bake::simplify::{Target, quietly};

const TRIANGLES: usize = 1_000_000;

fn main() {
    let knot: Mesh = torus_knot(5_000, 100).into();
    assert_eq!(knot.triangles.len(), TRIANGLES);
    let options = Options { marks_per_halving: 0, ..Options::default() };
    let built = Progressive::build(&knot, &options, &mut quietly).expect("a good mesh");
    let file = std::env::temp_dir().join(format!("lod-budget-progressive-{}.lodp", std::process::id()));
    fs::write(&file, built.bytes()).expect("the folder of temporary files can be written to");
    ratios(&file, built.bytes().len());

    let mut criterion = Criterion::default().configure_from_args().sample_size(20);
    let mut group = criterion.benchmark_group("progressive");
    group.throughput(Throughput::Bytes(built.bytes().len() as u64));
    group.bench_function("read", |b| b.iter(|| fs::read(&file).expect("it is there").len()));
    group.bench_function("load", |b| b.iter(|| load(&file).splits()));
    group.bench_function("load and extract 10 %", |b| b.iter(|| extract(&load(&file)).triangles.len()));
    group.bench_function("extract 10 %", |b| b.iter(|| extract(&built).triangles.len()));
    group.bench_function("refine and coarsen 1000 at 10 %", |b| {
        let mut cursor = Cursor::new(&built);
        cursor.go_to(&built, Target::triangles(TRIANGLES / 10)).expect("a good file");
        b.iter(|| {
            (0..1000).for_each(|_| assert!(cursor.refine(&built).expect("a good file")));
            (0..1000).for_each(|_| assert!(cursor.coarsen()));
        });
    });
    group
        .bench_function("all splits and the original", |b| b.iter(|| built.original().expect("a good file")));
    group.finish();
    criterion.final_summary();
    fs::remove_file(&file).expect("it is there");
}

fn load(file: &std::path::Path) -> Progressive {
    Progressive::load(file).expect("a good file").0
}

fn extract(mesh: &Progressive) -> Mesh {
    mesh.extract(Target::triangles(TRIANGLES / 10)).expect("a good file").mesh
}

/// The least of some times of each, taken in turns, beside that of reading.
fn ratios(file: &std::path::Path, bytes: usize) {
    let mut least = [f64::INFINITY; 3];
    for _ in 0..15 {
        let runs: [&dyn Fn() -> usize; 3] =
            [&|| fs::read(file).expect("it is there").len(), &|| load(file).splits(), &|| {
                extract(&load(file)).triangles.len()
            }];
        for (least, run) in least.iter_mut().zip(runs) {
            let start = Instant::now();
            black_box(run());
            *least = least.min(start.elapsed().as_secs_f64());
        }
    }
    let [read, load, extract] = least;
    println!("{:.2} bytes a triangle; read {:.2} ms", bytes as f64 / TRIANGLES as f64, 1e3 * read);
    println!("load {:.2} times that, load and extract 10 % {:.2} times", load / read, extract / read);
}
