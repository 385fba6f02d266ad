//! The optimum, proved.

use super::dyadic::{Number, WideSum};
use super::ledger::{Grids, Ledger, Totals, cheapest};
use super::{Instance, Solution, greedy};

/// Solves to proved optimality, or as far as `stop` allows.
///
/// `stop` is polled regularly and ends the search when it returns true; the best known choice then comes back with an honest upper bound
/// and `optimal: false`.
pub fn exact(instance: &Instance, stop: &mut dyn FnMut() -> bool) -> Solution {
    let quick = greedy(instance);
    if quick.optimal || !quick.feasible {
        return quick;
    }
    let grids = Grids::of(instance);
    if grids.bits() <= i128::BITS {
        search(&Ledger::<i128>::new(instance, grids), quick, stop)
    } else {
        search(&Ledger::<WideSum>::new(instance, grids), quick, stop)
    }
}

struct State<T> {
    totals: Totals<T>,
    parent: u32,
    item: u32,
}

fn search<T: Number>(ledger: &Ledger<'_, T>, quick: Solution, stop: &mut dyn FnMut() -> bool) -> Solution {
    let start = cheapest(ledger.instance);
    let mut rest = ledger.totals(&start).cost;
    let mut layers =
        vec![vec![State { totals: Totals { cost: T::ZERO, benefit: T::ZERO }, parent: 0, item: 0 }]];
    for (class, items) in ledger.instance.classes().enumerate() {
        if stop() {
            return quick;
        }
        rest = rest - ledger.cost(items[start[class] as usize]);
        let mut next = Vec::new();
        for (parent, state) in layers[class].iter().enumerate() {
            for (item, &amounts) in items.iter().enumerate() {
                let totals = Totals {
                    cost: state.totals.cost + ledger.cost(amounts),
                    benefit: state.totals.benefit + ledger.benefit(amounts),
                };
                if totals.cost + rest <= ledger.budget {
                    next.push(State { totals, parent: parent as u32, item: item as u32 });
                }
            }
        }
        next.sort_by(|a, b| a.totals.cost.cmp(&b.totals.cost).then(b.totals.benefit.cmp(&a.totals.benefit)));
        let mut best = None;
        next.retain(|state| {
            let better = best.is_none_or(|best| state.totals.benefit > best);
            best = best.max(Some(state.totals.benefit));
            better
        });
        layers.push(next);
    }
    let mut choice = vec![0; ledger.instance.len()];
    let mut at = layers[choice.len()].len() - 1;
    for class in (0..choice.len()).rev() {
        let state = &layers[class + 1][at];
        choice[class] = state.item;
        at = state.parent as usize;
    }
    let totals = ledger.totals(&choice);
    ledger.solution(choice, totals, None, quick.lambda)
}
