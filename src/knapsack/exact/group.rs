//! Partial choices of a group of classes: the Pareto list that dynamic programming with dominance keeps.

use super::super::dyadic::Number;
use super::super::ledger::Totals;
use super::super::meter::Meter;
use super::prices::{PricedClass, Prices};
use super::relief::Relief;

/// A partial choice, relative to the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct State<T> {
    pub cost: T,
    pub benefit: T,
    pub loss: f64,
    /// The last deviation from the base; 0 for none.
    node: u32,
    /// The deviation just made, as an index into the class plus 1, not yet a node; 0 for none.
    fresh: u32,
}

impl<T: Number> State<T> {
    pub fn totals(&self) -> Totals<T> {
        Totals { cost: self.cost, benefit: self.benefit }
    }
}

/// A deviation and the ones before it.
#[derive(Clone, Copy, Debug)]
struct Node {
    parent: u32,
    class: u32,
    item: u32,
}

/// All partial choices of some classes that may still be part of a better choice.
#[derive(Clone, Debug)]
pub(super) struct Group<T> {
    /// By cost and by benefit, both strictly ascending.
    pub states: Vec<State<T>>,
    nodes: Vec<Node>,
    /// How many nodes there may be before unreachable ones are dropped.
    nodes_allowed: usize,
}

/// Nodes kept beyond twice the reachable ones: fewer cost time, more cost memory (12 bytes each).
const NODES: usize = 1 << 20;

/// Why a list was not extended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Halt {
    /// It would outgrow its capacity.
    Full,
    /// The caller asked to stop.
    Stopped,
}

/// Losses above the limit by less than this, relatively, are kept: they may be rounding.
const SLOP: f64 = 1.0 + 1e-9;

impl<T: Number> Group<T> {
    /// The group of no classes: one state, the base.
    pub fn new() -> Self {
        let base = State { cost: T::ZERO, benefit: T::ZERO, loss: 0.0, node: 0, fresh: 0 };
        Self { states: vec![base], nodes: vec![Node { parent: 0, class: 0, item: 0 }], nodes_allowed: NODES }
    }

    /// Adds a class: every state with every alternative, without what is dominated or what must end with a gap above
    /// `limit`.
    ///
    /// `relief` is of all classes outside the group, the new one being inside.
    pub fn extend(
        &mut self,
        prices: &Prices<T>,
        class: &PricedClass<T>,
        relief: &Relief,
        limit: f64,
        capacity: usize,
        meter: &mut Meter<'_>,
    ) -> Result<(), Halt> {
        let limit = limit * SLOP;
        // Capacities are meant for states of 32 bytes.
        let capacity = capacity * 32 / size_of::<State<T>>();
        let mut next = Vec::with_capacity(self.states.len() * 2);
        let mut run = |cost: T, benefit: T, loss: f64, fresh: u32| {
            if !meter.spend(self.states.len() as u64) {
                return Err(Halt::Stopped);
            }
            let mut cursor = relief.cursor();
            for state in &self.states {
                let (cost, loss) = (state.cost + cost, state.loss + loss);
                if loss <= limit && loss + cursor.at(prices.cost_f64(prices.room - cost)) <= limit {
                    next.push(State {
                        cost,
                        benefit: state.benefit + benefit,
                        loss,
                        node: state.node,
                        fresh,
                    });
                }
            }
            if next.len() > 4 * capacity { Err(Halt::Full) } else { Ok(()) }
        };
        run(T::ZERO, T::ZERO, 0.0, 0)?;
        for (i, alternative) in class.alternatives.iter().enumerate() {
            if alternative.loss <= limit {
                run(alternative.cost, alternative.benefit, alternative.loss, i as u32 + 1)?;
            }
        }
        // The runs are sorted: the standard stable sort merges them.
        next.sort_by(|a, b| a.cost.cmp(&b.cost).then(b.benefit.cmp(&a.benefit)));
        keep_undominated(&mut next);
        if next.len() > capacity {
            return Err(Halt::Full);
        }
        self.states = next;
        self.record(class);
        Ok(())
    }

    /// Turns fresh deviations into nodes.
    fn record(&mut self, class: &PricedClass<T>) {
        for state in self.states.iter_mut().filter(|state| state.fresh > 0) {
            let item = class.alternatives[state.fresh as usize - 1].item;
            self.nodes.push(Node { parent: state.node, class: class.class, item });
            state.node = self.nodes.len() as u32 - 1;
            state.fresh = 0;
        }
        if self.nodes.len() > self.nodes_allowed {
            self.forget_unreachable();
            self.nodes_allowed = 2 * self.nodes.len() + NODES;
        }
    }

    /// Drops nodes that no state leads to; parents always come before their children.
    fn forget_unreachable(&mut self) {
        let mut place = vec![0u32; self.nodes.len()];
        for state in &self.states {
            place[state.node as usize] = 1;
        }
        place[0] = 1;
        for at in (1..place.len()).rev() {
            if place[at] == 1 {
                place[self.nodes[at].parent as usize] = 1;
            }
        }
        let mut kept = 0;
        for at in 0..place.len() {
            if place[at] == 1 {
                let node = self.nodes[at];
                self.nodes[kept] = Node { parent: place[node.parent as usize], ..node };
                place[at] = kept as u32;
                kept += 1;
            }
        }
        self.nodes.truncate(kept);
        for state in &mut self.states {
            state.node = place[state.node as usize];
        }
    }

    /// Indices of the states, by loss ascending.
    pub fn by_loss(&self) -> Vec<u32> {
        let mut order: Vec<u32> = (0..self.states.len() as u32).collect();
        order.sort_by(|&a, &b| self.states[a as usize].loss.total_cmp(&self.states[b as usize].loss));
        order
    }

    /// Writes the deviations of state `index` into `choice`.
    pub fn write(&self, index: usize, choice: &mut [u32]) {
        let mut at = self.states[index].node;
        while at != 0 {
            let node = self.nodes[at as usize];
            choice[node.class as usize] = node.item;
            at = node.parent;
        }
    }
}

fn keep_undominated<T: Number>(states: &mut Vec<State<T>>) {
    let mut best: Option<T> = None;
    states.retain(|state| {
        let better = best.is_none_or(|best| state.benefit > best);
        if better {
            best = Some(state.benefit);
        }
        better
    });
}

/// The pair of states with the highest joint benefit whose costs fit into `room`.
pub(super) fn best_pair<T: Number>(a: &[State<T>], b: &[State<T>], room: T) -> Option<(usize, usize)> {
    let mut best = None;
    let mut record = None;
    let mut j = b.len();
    for (i, state) in a.iter().enumerate() {
        let left = room - state.cost;
        while j > 0 && b[j - 1].cost > left {
            j -= 1;
        }
        if j == 0 {
            break;
        }
        let benefit = state.benefit + b[j - 1].benefit;
        if record.is_none_or(|record| benefit > record) {
            (record, best) = (Some(benefit), Some((i, j - 1)));
        }
    }
    best
}
