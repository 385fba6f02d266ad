//! Any bytes are read as an instance or refused; what is read is solved within its budget and its bound.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::knapsack::{Instance, exact, greedy};

fuzz_target!(|bytes: &[u8]| {
    let Ok(instance) = Instance::read_json(bytes) else {
        return;
    };
    let quick = greedy(&instance);
    assert_eq!(quick.choice.len(), instance.len());
    assert!(!quick.feasible || quick.cost <= instance.budget());
    assert!(quick.upper_bound.is_none_or(|bound| quick.benefit <= bound));
    let mut polls = 0;
    let proved = exact(&instance, &mut || {
        polls += 1;
        polls > 100
    });
    assert_eq!(proved.feasible, quick.feasible);
    assert!(proved.benefit >= quick.benefit);
    assert!(proved.upper_bound.is_none_or(|bound| proved.benefit <= bound));
});
