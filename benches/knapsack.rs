//! The general solvers, which sort every step and compare slopes exactly: what there is to gain from the frame loop's
//! own (`select/predictive` of `cargo bench --features sim --bench frame`), and what a proof costs.
//!
//! ```text
//! cargo bench --bench knapsack
//! ```
//!
//! Ids are `greedy/N`, `capped/N` (100 000 steps) and `exact/N` for N classes of two to six levels each, triangles
//! halving or better from one to the next and benefits of a size at random times 1 − ½ / triangles; the budget is two
//! fifths of the way from the least to the most.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use lod_budget::knapsack::{Instance, Item, capped, exact, greedy};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const CLASSES: [usize; 3] = [100, 1_000, 10_000];
const CAP_STEPS: u64 = 100_000;

fn instance(classes: usize) -> Instance {
    let mut random = Pcg64::seed_from_u64(1995);
    let classes: Vec<Vec<Item>> = (0..classes).map(|_| class(&mut random)).collect();
    let sum = |pick: fn(&Vec<Item>) -> &Item| classes.iter().map(|class| pick(class).cost).sum::<f64>();
    let (least, most) = (sum(|class| &class[class.len() - 1]), sum(|class| &class[0]));
    Instance::new(least + 0.4 * (most - least), classes).expect("a good instance")
}

/// An object of its own: levels finest first.
fn class(random: &mut Pcg64) -> Vec<Item> {
    let levels = random.random_range(2..=6);
    let area_px2 = 10f64.powf(random.random_range(1.0..5.0));
    let mut triangles = random.random_range(2_000.0f64..60_000.0);
    let mut level = || {
        let item = Item { cost: 0.2 + 0.0015 * triangles, benefit: area_px2 * (1.0 - 0.5 / triangles) };
        triangles = (triangles * random.random_range(0.2..0.5)).max(8.0);
        item
    };
    (0..levels).map(|_| level()).collect()
}

fn solvers(c: &mut Criterion) {
    for classes in CLASSES {
        let instance = instance(classes);
        let solvers: [(_, fn(&Instance) -> _); 3] = [
            ("greedy", greedy),
            ("capped", |i| capped(i, CAP_STEPS)),
            ("exact", |i| exact(i, &mut || false)),
        ];
        for (name, solve) in solvers {
            let mut group = c.benchmark_group(name);
            group.sample_size(10).nresamples(2000);
            group.warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_secs(1));
            group.bench_function(BenchmarkId::from_parameter(classes), |b| {
                b.iter(|| solve(black_box(&instance)))
            });
        }
    }
}

criterion_group!(benches, solvers);
criterion_main!(benches);
