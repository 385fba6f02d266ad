//! Repair: what the greedy leaves of the budget is spent by exchanging items that are nearly as good.
//!
//! Items with slopes near λ are worth nearly their price, but cost all kinds of amounts. Of k classes that may move
//! there are 2^k combinations and more, so some leave next to nothing over and lose next to nothing. They are looked
//! for in two lists of partial choices that meet in the middle (E. Horowitz, S. Sahni, "Computing partitions with
//! applications to the knapsack problem", 1974), built class by class with dominance and pruned by what they lose: the
//! exact search's first level, cut to a fixed size.
//!
//! Plain data in, plain data out, in integers of any width, so that every greedy can use it.

use super::dyadic::Number;
use super::meter::Meter;

/// Another item for one class, relative to the one that the class has.
///
/// A step of a hull that may be taken, of slope s, cost c and gain g, is the exchange (c, g), apart by λ − s; one that
/// may be taken back is (−c, −g), apart by s − λ. Where a class has several such steps in a row, each further one is an
/// exchange of its own with the sums of all up to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Exchange<T> {
    /// The same for all exchanges of a class and for no other; ties go to the lower one.
    pub key: u128,
    /// For the caller: which class moves, …
    pub class: u32,
    /// … and to which item. Tells the exchanges of a class apart.
    pub item: u32,
    /// Cost added; negative where it is saved.
    pub cost: T,
    /// Benefit added; negative where it is given up.
    pub gain: T,
    /// λ·cost − gain, in units of benefit and rounded as it may be: it decides what is tried, never what fits. Negative
    /// only where the class is not at its best for λ.
    pub loss: f64,
    /// Loss per cost moved, so how far the slope is from λ. The nearest are tried first.
    pub apart: f64,
}

/// What a repair is after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Goal<T> {
    /// What the exchanges may cost together.
    pub room: T,
    /// What they have to gain more than.
    pub to_beat: T,
    /// λ·room − `to_beat`, in units of benefit: exchanges that lose more together cannot gain enough.
    pub limit: f64,
}

/// What the exchanges found come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Repaired<T> {
    /// At most the room.
    pub cost: T,
    /// More than what was to be beaten.
    pub gain: T,
}

/// The scratch of a repair; allocates only to grow.
#[derive(Clone, Debug)]
pub(super) struct Repair<T> {
    /// Partial choices that a list may hold.
    capacity: usize,
    movers: Vec<Mover>,
    lists: [List<T>; 2],
    next: Vec<State<T>>,
    spare: Vec<State<T>>,
    nodes: Vec<Node>,
    found: Vec<u32>,
}

/// A class that may move, with its exchanges `start..end`.
#[derive(Clone, Copy, Debug)]
struct Mover {
    key: u128,
    start: u32,
    end: u32,
    apart: f64,
    least_loss: f64,
}

/// Partial choices of some of the classes, by cost and by gain, both strictly ascending.
#[derive(Clone, Debug, Default)]
struct List<T> {
    states: Vec<State<T>>,
    full: bool,
}

#[derive(Clone, Copy, Debug)]
struct State<T> {
    cost: T,
    gain: T,
    loss: f64,
    /// The last exchange made, as an index into `nodes`; 0 for none.
    node: u32,
    /// The exchange just made, plus 1, not yet a node; 0 for none.
    fresh: u32,
}

/// An exchange and the ones made before it.
#[derive(Clone, Copy, Debug)]
struct Node {
    before: u32,
    exchange: u32,
}

impl<T: Number> Repair<T> {
    /// With lists of up to `capacity` partial choices each.
    pub fn new(capacity: usize) -> Self {
        let list = || List { states: Vec::new(), full: false };
        Self {
            capacity,
            movers: Vec::new(),
            lists: [list(), list()],
            next: Vec::new(),
            spare: Vec::new(),
            nodes: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Looks for the exchanges, at most one of each class, that cost at most the room and gain the most; `None` where
    /// they do not gain enough. [`Repair::found`] tells which they are.
    ///
    /// The best there are if both lists hold all that matters, else good ones. `exchanges` come in any order and leave
    /// in another; the answer does not depend on it. A partial choice made is one step of `meter`; where that runs out
    /// the best so far is the answer. At most `capacity` steps for each exchange, and a few times `capacity` in all
    /// where costs differ, since full lists end it.
    pub fn run(
        &mut self,
        exchanges: &mut [Exchange<T>],
        goal: Goal<T>,
        meter: &mut Meter<'_>,
    ) -> Option<Repaired<T>> {
        self.begin(exchanges);
        let regained: f64 = self.movers.iter().map(|mover| mover.least_loss.min(0.0)).sum();
        let limit = goal.limit - regained;
        let mut best = None;
        for at in 0..self.movers.len() {
            let Mover { start, end, least_loss, .. } = self.movers[at];
            let Some(side) = self.shorter() else { break };
            if least_loss > limit {
                continue;
            }
            if !self.extend(side, &exchanges[start as usize..end as usize], start, limit, meter) {
                break;
            }
            best = self.join(goal).or(best);
        }
        best
    }

    /// Indices into the exchanges as the last run left them, one per class that is to move; empty where nothing gained
    /// enough.
    pub fn found(&self) -> &[u32] {
        &self.found
    }

    /// Groups the exchanges by class, the class with the nearest one first, and empties the lists.
    fn begin(&mut self, exchanges: &mut [Exchange<T>]) {
        exchanges.sort_unstable_by(|a, b| {
            a.key.cmp(&b.key).then(a.apart.total_cmp(&b.apart)).then(a.item.cmp(&b.item))
        });
        self.movers.clear();
        let mut start = 0;
        for class in exchanges.chunk_by(|a, b| a.key == b.key) {
            let least_loss = class.iter().map(|exchange| exchange.loss).fold(f64::INFINITY, f64::min);
            let Exchange { key, apart, .. } = class[0];
            let end = start + class.len() as u32;
            self.movers.push(Mover { key, start, end, apart, least_loss });
            start = end;
        }
        self.movers.sort_unstable_by(|a, b| a.apart.total_cmp(&b.apart).then(a.key.cmp(&b.key)));
        for list in &mut self.lists {
            list.full = false;
            list.states.clear();
            list.states.push(State { cost: T::ZERO, gain: T::ZERO, loss: 0.0, node: 0, fresh: 0 });
        }
        self.nodes.clear();
        self.nodes.push(Node { before: 0, exchange: 0 });
        self.found.clear();
    }

    /// The list to grow next.
    fn shorter(&self) -> Option<usize> {
        let open = (0..2).filter(|&side| !self.lists[side].full);
        open.min_by_key(|&side| self.lists[side].states.len())
    }

    /// Adds a class to a list: every partial choice with each of its exchanges, without what is dominated or loses too
    /// much. A list that would outgrow its capacity stays as it was and is full. False when the meter has run out.
    fn extend(
        &mut self,
        side: usize,
        exchanges: &[Exchange<T>],
        first: u32,
        limit: f64,
        meter: &mut Meter<'_>,
    ) -> bool {
        let list = &mut self.lists[side];
        self.next.clone_from(&list.states);
        for (exchange, index) in exchanges.iter().zip(first..).filter(|(e, _)| e.loss <= limit) {
            if !meter.spend(list.states.len() as u64) {
                return false;
            }
            merge(&self.next, moved(&list.states, exchange, index, limit), &mut self.spare);
            std::mem::swap(&mut self.next, &mut self.spare);
        }
        list.full = self.next.len() > self.capacity;
        if !list.full {
            std::mem::swap(&mut list.states, &mut self.next);
            record(&mut list.states, &mut self.nodes);
        }
        true
    }

    /// The best pair of partial choices, one of each list, if it is good enough.
    fn join(&mut self, goal: Goal<T>) -> Option<Repaired<T>> {
        let [a, b] = &self.lists;
        let (pair, repaired) = best_pair(&a.states, &b.states, goal)?;
        self.found.clear();
        for (list, i) in self.lists.iter().zip(pair) {
            let mut at = list.states[i].node;
            while at != 0 {
                let Node { before, exchange } = self.nodes[at as usize];
                self.found.push(exchange);
                at = before;
            }
        }
        Some(repaired)
    }
}

/// The partial choices after one more exchange, where they may still be worth it.
fn moved<T: Number>(
    states: &[State<T>],
    exchange: &Exchange<T>,
    index: u32,
    limit: f64,
) -> impl Iterator<Item = State<T>> {
    let Exchange { cost, gain, loss, .. } = *exchange;
    let shift = move |state: &State<T>| State {
        cost: state.cost + cost,
        gain: state.gain + gain,
        loss: state.loss + loss,
        fresh: index + 1,
        ..*state
    };
    states.iter().map(shift).filter(move |state| state.loss <= limit)
}

/// Merges two lists in order of cost and drops what is dominated; of equal ones that of the first list stays.
fn merge<T: Number>(first: &[State<T>], second: impl Iterator<Item = State<T>>, out: &mut Vec<State<T>>) {
    out.clear();
    let mut push = |state: State<T>| {
        if out.last().is_none_or(|last| state.gain > last.gain) {
            // Equally dear but better: it replaces.
            out.pop_if(|last| last.cost == state.cost);
            out.push(state);
        }
    };
    let mut first = first.iter().copied().peekable();
    for state in second {
        while let Some(other) = first.next_if(|other| other.cost <= state.cost) {
            push(other);
        }
        push(state);
    }
    first.for_each(push);
}

/// Turns fresh exchanges into nodes.
fn record<T>(states: &mut [State<T>], nodes: &mut Vec<Node>) {
    for state in states.iter_mut().filter(|state| state.fresh > 0) {
        nodes.push(Node { before: state.node, exchange: state.fresh - 1 });
        (state.node, state.fresh) = (nodes.len() as u32 - 1, 0);
    }
}

/// The pair with the highest joint gain among those that fit; of equal ones the one that costs least in `a`.
fn best_pair<T: Number>(a: &[State<T>], b: &[State<T>], goal: Goal<T>) -> Option<([usize; 2], Repaired<T>)> {
    let mut best: Option<([usize; 2], Repaired<T>)> = None;
    let mut to_beat = goal.to_beat;
    let mut end = b.len();
    for (i, state) in a.iter().enumerate() {
        while end > 0 && state.cost + b[end - 1].cost > goal.room {
            end -= 1;
        }
        let Some(other) = b[..end].last() else { break };
        let repaired = Repaired { cost: state.cost + other.cost, gain: state.gain + other.gain };
        if repaired.gain > to_beat {
            to_beat = repaired.gain;
            best = Some(([i, end - 1], repaired));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Row = (i64, i64);
    /// Classes and the items they move to.
    type Moves = Vec<(u32, u32)>;

    fn exchange(class: usize, item: usize, &(cost, gain): &Row, lambda: f64) -> Exchange<i64> {
        let loss = lambda * cost as f64 - gain as f64;
        let apart = loss / cost.abs() as f64;
        Exchange { key: class as u128, class: class as u32, item: item as u32, cost, gain, loss, apart }
    }

    /// Of classes that are at their best for λ = 1.
    fn exchanges(classes: &[Vec<Row>]) -> Vec<Exchange<i64>> {
        let rows = classes.iter().enumerate();
        rows.flat_map(|(c, class)| class.iter().enumerate().map(move |(i, row)| exchange(c, i, row, 1.0)))
            .collect()
    }

    /// The highest gain by trying everything.
    fn best(classes: &[Vec<Row>], room: i64) -> i64 {
        let mut sums = vec![(0, 0)];
        for class in classes {
            let moved = |&(cost, gain): &Row| class.iter().map(move |&(c, g)| (cost + c, gain + g));
            sums = sums.iter().flat_map(|sum| moved(sum).chain([*sum])).collect();
        }
        sums.into_iter().filter(|sum| sum.0 <= room).map(|sum| sum.1).max().unwrap_or(0)
    }

    fn run(
        exchanges: &mut [Exchange<i64>],
        goal: Goal<i64>,
        capacity: usize,
        steps: u64,
    ) -> Option<(Repaired<i64>, Moves)> {
        let mut repair = Repair::new(capacity);
        let repaired = repair.run(exchanges, goal, &mut Meter::new(steps, &mut || false))?;
        let mut moves: Moves = repair
            .found()
            .iter()
            .map(|&at| (exchanges[at as usize].class, exchanges[at as usize].item))
            .collect();
        moves.sort_unstable();
        Some((repaired, moves))
    }

    fn classes() -> impl Strategy<Value = Vec<Vec<Row>>> {
        let row = (-40i64..40, 0i64..12).prop_filter("costs something", |row| row.0 != 0);
        let row = row.prop_map(|(cost, lost)| (cost, cost - lost));
        prop::collection::vec(prop::collection::vec(row, 1..4), 0..9)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        #[test]
        fn with_room_for_all_the_best_is_found(classes in classes(), room in 0i64..60, to_beat in 0i64..20) {
            let limit = (room - to_beat) as f64;
            let found = run(&mut exchanges(&classes), Goal { room, to_beat, limit }, usize::MAX, u64::MAX);
            let best = best(&classes, room);
            prop_assert_eq!(found.map(|(repaired, _)| repaired.gain), (best > to_beat).then_some(best));
        }

        #[test]
        fn cut_anywhere_it_fits_and_gains(classes in classes(), room in 0i64..60, capacity in 1usize..9, steps in 0u64..60) {
            let goal = Goal { room, to_beat: 0, limit: room as f64 };
            let Some((repaired, moves)) = run(&mut exchanges(&classes), goal, capacity, steps) else { return Ok(()) };
            let rows = moves.iter().map(|&(class, item)| classes[class as usize][item as usize]);
            let sums = rows.fold((0, 0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
            prop_assert_eq!((repaired.cost, repaired.gain), sums);
            prop_assert!(repaired.cost <= room && repaired.gain > 0);
            prop_assert!(moves.windows(2).all(|pair| pair[0].0 < pair[1].0), "one exchange a class");
        }

        #[test]
        fn the_order_of_exchanges_does_not_matter(classes in classes(), room in 0i64..60, by in 0usize..20, capacity in 1usize..30) {
            let goal = Goal { room, to_beat: 0, limit: room as f64 };
            let mut turned = exchanges(&classes);
            let by = by % turned.len().max(1);
            turned.rotate_left(by);
            turned.reverse();
            prop_assert_eq!(run(&mut exchanges(&classes), goal, capacity, 500), run(&mut turned, goal, capacity, 500));
        }
    }
}
