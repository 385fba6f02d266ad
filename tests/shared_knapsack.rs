//! The frame loop's greedy against slow twins: the textbook's greedy, from scratch, and exhaustive search.

use lod_budget::knapsack::{
    Crowd, Ends, Instance, Item, Menus, Octet, OddClass, Outcome, OwnClass, Position, ProfileItem, Profiles,
    SharedClass, SharedKnapsack, exact,
};
use proptest::prelude::*;

/// One class: its items, and its row of [`Classes`].
#[derive(Clone, Debug)]
struct Class {
    items: Vec<ProfileItem>,
    weight: f32,
    scale: f32,
    current: u8,
    stay: f32,
    key: u128,
}

impl Class {
    fn cost(&self, ticks: u64) -> u64 {
        if self.scale == 1.0 { ticks } else { (ticks as f64 * f64::from(self.scale)).ceil() as u64 }
    }

    fn benefit(&self, item: &ProfileItem) -> f64 {
        f64::from(self.weight) * f64::from(item.value)
    }

    /// The best of the cheapest items.
    fn cheapest(&self) -> &ProfileItem {
        let order = |a: &&ProfileItem, b: &&ProfileItem| {
            a.ticks.cmp(&b.ticks).then(b.value.total_cmp(&a.value)).then(a.item.cmp(&b.item))
        };
        self.items.iter().min_by(order).expect("a class has an item")
    }
}

fn fill(solver: &mut SharedKnapsack, classes: &[Class]) {
    solver.profiles.truncate(0);
    solver.classes.clear();
    for class in classes {
        let profile = solver.profiles.push(&class.items);
        let Class { weight, scale, stay, current, .. } = *class;
        solver.classes.push(SharedClass { profile, weight, scale, stay, current });
    }
}

fn solve(solver: &mut SharedKnapsack, classes: &[Class], budget: u64) -> Outcome {
    fill(solver, classes);
    solver.solve(budget, budget, |i| classes[i].key)
}

/// The textbook: all steps of all hulls in one list, by slope, taken while they fit.
struct Textbook<'a> {
    classes: &'a [Class],
    hulls: Vec<Vec<Position>>,
    current: Vec<u8>,
}

/// What the textbook ends with: a position per class, and the first step that did not fit.
#[derive(Clone, Debug, PartialEq)]
struct Taken {
    positions: Vec<usize>,
    critical: Option<(usize, usize)>,
    room: u64,
    lambda: f32,
}

fn hull(items: &[ProfileItem]) -> Vec<Position> {
    let mut profiles = Profiles::default();
    let profile = profiles.push(items);
    profiles.positions(profile).to_vec()
}

impl<'a> Textbook<'a> {
    /// Hulls of the items that fit beside the cheapest of all others; `None` where not even those do.
    fn new(classes: &'a [Class], budget: u64) -> Option<Self> {
        let cheapest: u64 = classes.iter().map(|c| c.cost(c.cheapest().ticks)).sum();
        let room = budget.checked_sub(cheapest)?;
        let mut book = Self { classes, hulls: Vec::new(), current: Vec::new() };
        for class in classes {
            let full = hull(&class.items);
            let limit = class.cost(full[0].ticks) + room;
            let fits = |ticks: u64| class.cost(ticks) <= limit;
            let held = full[usize::from(class.current).min(full.len() - 1)].ticks;
            let (hull, current) = if full.iter().all(|p| fits(p.ticks)) {
                (full, class.current)
            } else {
                let items: Vec<_> = class.items.iter().filter(|i| fits(i.ticks)).copied().collect();
                let hull = hull(&items);
                let current = hull.iter().filter(|p| p.ticks <= held).count().max(1) - 1;
                (hull, current as u8)
            };
            book.hulls.push(hull);
            book.current.push(current);
        }
        Some(book)
    }

    fn cost(&self, class: usize, position: usize) -> u64 {
        self.classes[class].cost(self.hulls[class][position].ticks)
    }

    fn slope(&self, class: usize, from: usize) -> f32 {
        let Class { weight, scale, stay, .. } = self.classes[class];
        let price = if from < usize::from(self.current[class]) { 1.0 + stay } else { 1.0 - stay };
        weight / scale * self.hulls[class][from].next_slope * price
    }

    /// The greedy, one class pinned to a position if asked for.
    fn greedy(&self, budget: u64, pin: Option<(usize, usize)>) -> Taken {
        let is_pinned = |i: usize| pin.filter(|p| p.0 == i);
        let start = |i: usize| is_pinned(i).map_or(0, |p| p.1);
        let mut positions: Vec<usize> = (0..self.classes.len()).map(start).collect();
        let spent: u64 = positions.iter().enumerate().map(|(i, &p)| self.cost(i, p)).sum();
        let mut taken = Taken { positions: vec![], critical: None, room: budget - spent, lambda: 0.0 };
        let mut blocked = vec![false; self.classes.len()];
        for (slope, i, from) in self.steps() {
            if blocked[i] || is_pinned(i).is_some() {
                continue;
            }
            let cost = self.cost(i, from + 1) - self.cost(i, from);
            if cost <= taken.room {
                taken.room -= cost;
                positions[i] = from + 1;
            } else {
                blocked[i] = true;
                if taken.critical.is_none() {
                    (taken.critical, taken.lambda) = (Some((i, from + 1)), slope);
                }
            }
        }
        Taken { positions, ..taken }
    }

    /// Every step worth taking, best first, ties by key.
    fn steps(&self) -> Vec<(f32, usize, usize)> {
        let all =
            (0..self.classes.len()).flat_map(|i| (0..self.hulls[i].len() - 1).map(move |from| (i, from)));
        let mut steps: Vec<_> = all
            .map(|(i, from)| (self.slope(i, from), i, from))
            .filter(|&(slope, ..)| slope >= f32::MIN_POSITIVE)
            .collect();
        steps.sort_by(|a, b| {
            let keys = self.classes[a.1].key.cmp(&self.classes[b.1].key);
            b.0.total_cmp(&a.0).then(keys).then(a.2.cmp(&b.2))
        });
        steps
    }

    /// Benefit with switching priced in: what is held counts more, what lies beyond less.
    fn priced(&self, positions: &[usize]) -> f64 {
        let mut sum = 0.0;
        for (i, &position) in positions.iter().enumerate() {
            let value = |p: usize| f64::from(self.hulls[i][p].value);
            let stay = f64::from(self.classes[i].stay);
            let held =
                value(position.min(usize::from(self.current[i])).min(self.hulls[i].len() - 1)) - value(0);
            let beyond = value(position) - value(0) - held;
            let priced = value(0) + (1.0 + stay) * held + (1.0 - stay) * beyond;
            sum += f64::from(self.classes[i].weight) * priced;
        }
        sum
    }

    fn items(&self, positions: &[usize]) -> Vec<u8> {
        positions.iter().zip(&self.hulls).map(|(&p, hull)| hull[p].item).collect()
    }

    /// The answers that the solver may give, if the gap that it certifies is the right one: two where the greedy and
    /// its rival are worth the same.
    fn answers(&self, budget: u64, outcome: &Outcome) -> Vec<Vec<u8>> {
        let plain = self.greedy(budget, None);
        let value = self.priced(&plain.positions);
        let gap = (outcome.priced_bound - value) / (outcome.upper_bound - outcome.minimum_benefit);
        let mut answers = vec![self.items(&plain.positions)];
        if let Some(critical) = plain.critical.filter(|_| gap > 1e-3 * (1.0 - TIE)) {
            let rival = self.greedy(budget, Some(critical));
            let lead = self.priced(&rival.positions) - value;
            if lead > TIE * value && gap > 1e-3 * (1.0 + TIE) {
                answers.clear();
            }
            if lead > -TIE * value {
                answers.push(self.items(&rival.positions));
            }
        }
        answers
    }
}

/// What rounding can make of a difference, relatively.
const TIE: f64 = 1e-9;

/// The solver's answer is the textbook's.
fn agrees(solver: &mut SharedKnapsack, classes: &[Class], budget: u64) -> Result<(), TestCaseError> {
    let outcome = solve(solver, classes, budget);
    match Textbook::new(classes, budget) {
        Some(book) => prop_assert!(book.answers(budget, &outcome).contains(&solver.chosen)),
        None => {
            let cheapest: Vec<u8> = classes.iter().map(|c| c.cheapest().item).collect();
            prop_assert_eq!(&solver.chosen, &cheapest);
            prop_assert_eq!(outcome.shortfall, outcome.cost - budget);
        }
    }
    Ok(())
}

/// Items whose values and ticks lie on coarse grids, so that slopes are often equal. No step is free after scaling.
fn items() -> impl Strategy<Value = Vec<ProfileItem>> {
    items_of(1..6)
}

fn items_of(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<ProfileItem>> {
    let point = (0u32..=16, 0u64..=24);
    prop::collection::vec(point, count).prop_map(|points| {
        let item = |(i, (value, ticks)): (usize, (u32, u64))| ProfileItem {
            value: value as f32 / 16.0,
            ticks: ticks * 64,
            item: i as u8,
        };
        points.into_iter().enumerate().map(item).collect()
    })
}

fn class() -> impl Strategy<Value = Class> {
    let weight = prop_oneof![
        1 => Just(0.0f32),
        3 => prop_oneof![Just(0.5f32), Just(1.0), Just(2.0)],
        2 => 0.001f32..1000.0
    ];
    let scale = prop_oneof![3 => Just(1.0f32), 1 => Just(0.5), 1 => Just(2.0), 1 => 0.1f32..8.0];
    let stay = prop_oneof![2 => Just(0.0f32), 1 => Just(0.1), 1 => Just(0.5)];
    (items(), weight, scale, 0u8..6, stay).prop_map(|(items, weight, scale, current, stay)| Class {
        items,
        weight,
        scale,
        current,
        stay,
        key: 0,
    })
}

/// Classes with keys that are unique and in no order.
fn classes(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Class>> {
    (prop::collection::vec(class(), count), any::<u64>()).prop_map(|(mut classes, seed)| {
        for (i, class) in classes.iter_mut().enumerate() {
            class.key = u128::from((i as u64 ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15)) << 32 | i as u128;
        }
        classes
    })
}

fn total(classes: &[Class], ticks: impl Fn(&Class) -> u64) -> u64 {
    classes.iter().map(|c| c.cost(ticks(c))).sum()
}

/// The budget that leaves this share of the way from the cheapest choice to the dearest.
fn share_of(classes: &[Class], share: f64) -> u64 {
    let least = total(classes, |c| c.cheapest().ticks);
    let most = total(classes, |c| c.items.iter().map(|i| i.ticks).max().unwrap_or(0));
    least + ((most - least) as f64 * share) as u64
}

/// Below this budget the fill goes on to the last tick: there is no difference from the textbook left.
const SMALL: u64 = 1 << 15;

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn cold_or_warm_it_is_the_textbook(
        classes in classes(0..30),
        shares in prop::collection::vec(0.0f64..1.1, 1..8),
    ) {
        let mut warm = SharedKnapsack::default();
        for share in shares {
            let budget = share_of(&classes, share).min(SMALL - 1);
            agrees(&mut warm, &classes, budget)?;
            agrees(&mut SharedKnapsack::default(), &classes, budget)?;
        }
    }

    #[test]
    fn it_stays_the_textbook_when_everything_changes_at_once(
        scenes in prop::collection::vec((classes(1..25), 0.0f64..1.0, 0i32..6), 2..5),
    ) {
        let mut warm = SharedKnapsack::default();
        for (mut classes, share, exponent) in scenes {
            classes.iter_mut().for_each(|c| c.weight *= 1000f32.powi(exponent - 3));
            let budget = share_of(&classes, share).min(SMALL - 1);
            agrees(&mut warm, &classes, budget)?;
        }
    }

    #[test]
    fn ties_go_by_key_whatever_the_order_of_classes(
        classes in classes(1..20),
        share in 0.0f64..1.0,
        seed in any::<u64>(),
    ) {
        let budget = share_of(&classes, share);
        let mut order: Vec<usize> = (0..classes.len()).collect();
        order.sort_by_key(|&i| (i as u64 + 1).wrapping_mul(seed | 1));
        let shuffled: Vec<Class> = order.iter().map(|&i| classes[i].clone()).collect();
        let (mut one, mut other) = (SharedKnapsack::default(), SharedKnapsack::default());
        let outcomes = [solve(&mut one, &classes, budget), solve(&mut other, &shuffled, budget)];
        prop_assert_eq!(outcomes[0], outcomes[1]);
        let expected: Vec<u8> = order.iter().map(|&i| one.chosen[i]).collect();
        prop_assert_eq!(&other.chosen, &expected);
    }

    /// Where ticks are fine the fill leaves crumbs, and no more than crumbs are lost.
    #[test]
    fn fine_ticks_leave_no_more_than_crumbs(classes in classes(1..25), share in 0.0f64..1.0) {
        let mut fine = classes;
        fine.iter_mut().flat_map(|c| &mut c.items).for_each(|item| item.ticks <<= 24);
        let budget = share_of(&fine, share);
        let mut solver = SharedKnapsack::default();
        let outcome = solve(&mut solver, &fine, budget);
        let book = Textbook::new(&fine, budget).expect("no share is below the cheapest choice");
        if budget - outcome.cost > budget >> 15 {
            prop_assert!(book.answers(budget, &outcome).contains(&solver.chosen));
        }
        let taken = book.greedy(budget, None);
        let crumbs = f64::from(taken.lambda) * (budget >> 15) as f64;
        let slack = 1e-6 * outcome.priced_benefit + 1e-6;
        prop_assert!(outcome.priced_benefit >= book.priced(&taken.positions) - crumbs - slack);
    }
}

/// A crowd: profiles, and per class the profile, the weight and the price of switching. What each class holds follows
/// from call to call; an odd one holds nothing that is counted, and one of its own has the items and no profile.
#[derive(Clone, Debug)]
struct Scene {
    profiles: Vec<Vec<ProfileItem>>,
    members: Vec<(prop::sample::Index, f32, f32, Kind)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Holder,
    Odd,
    Own,
}

/// The members of a scene that have items of their own.
struct OwnMembers<'a>(Vec<(OwnClass, &'a [ProfileItem])>);

impl Menus for OwnMembers<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn ends(&self) -> Ends {
        let mut ends = Ends::default();
        for (_, items) in &self.0 {
            let best = items.iter().map(|i| i.value).fold(0.0, f32::max);
            let ticks = |least: f32| items.iter().filter(|i| i.value >= least).map(|i| i.ticks).min();
            ends.add(ticks(0.0).expect("an item"), ticks(best).expect("an item"));
        }
        ends
    }

    fn class(&self, n: usize) -> OwnClass {
        self.0[n].0
    }

    fn octets(&self, n: usize) -> usize {
        self.0[n].1.len().div_ceil(8)
    }

    fn most_octets(&self) -> usize {
        (0..self.len()).map(|n| self.octets(n)).max().unwrap_or(0)
    }

    fn octet(&self, n: usize, octet: usize) -> Octet {
        let item = |lane: usize| self.0[n].1.get(octet * 8 + lane);
        let [no_value, no_ticks] = Octet::NOTHING;
        Octet {
            value: std::array::from_fn(|lane| item(lane).map_or(no_value, |item| f64::from(item.value))),
            ticks: std::array::from_fn(|lane| item(lane).map_or(no_ticks, |item| item.ticks as f64)),
        }
    }

    fn code(&self, n: usize, item: u8) -> u8 {
        self.0[n].1[usize::from(item)].item
    }
}

fn scene() -> impl Strategy<Value = Scene> {
    let weight = prop_oneof![1 => Just(0.0f32), 2 => Just(1.0), 8 => 0.001f32..1000.0];
    let stay = prop_oneof![2 => Just(0.0f32), 1 => Just(0.2), 1 => Just(0.7)];
    let kind = prop_oneof![6 => Just(Kind::Holder), 1 => Just(Kind::Odd), 4 => Just(Kind::Own)];
    let member = (any::<prop::sample::Index>(), weight, stay, kind);
    let items = prop_oneof![3 => items(), 1 => items_of(1..20)];
    (prop::collection::vec(items, 1..5), prop::collection::vec(member, 0..120))
        .prop_map(|(profiles, members)| Scene { profiles, members })
}

/// One call: the budget as a share, its dead band, and how the weights have changed.
fn call() -> impl Strategy<Value = (f64, f64, Vec<f32>)> {
    (-0.05f64..1.1, prop_oneof![Just(1.0), 0.9..1.0], prop::collection::vec(0.5f32..2.0, 7))
}

impl Scene {
    /// The solver with the profiles, and where the items of each start.
    fn solver(&self) -> (SharedKnapsack, Vec<u32>) {
        let mut solver = SharedKnapsack::default();
        let mut starts = vec![0];
        for items in &self.profiles {
            solver.profiles.push(items);
            starts.push(starts[starts.len() - 1] + items.len() as u32);
        }
        (solver, starts)
    }

    fn budget(&self, share: f64) -> u64 {
        let ticks = |profile: &Vec<ProfileItem>| profile.iter().map(|i| i.ticks).collect::<Vec<_>>();
        let of = |best: fn(&Vec<u64>) -> u64| -> u64 {
            self.members.iter().map(|m| best(&ticks(m.0.get(&self.profiles)))).sum()
        };
        let least = of(|t| t.iter().copied().min().unwrap_or(0));
        let most = of(|t| t.iter().copied().max().unwrap_or(0));
        (least as f64 + (most - least) as f64 * share).max(0.0) as u64
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    /// Sifted or listed, warm or cold: the same items, and sums that differ by rounding alone.
    #[test]
    fn a_crowd_is_answered_as_its_list(scene in scene(), calls in prop::collection::vec(call(), 1..7)) {
        let ((mut crowded, starts), (mut listed, _)) = (scene.solver(), scene.solver());
        let item_at = |m: usize, code: u8| starts[scene.members[m].0.index(scene.profiles.len())] + u32::from(code);
        let mut held: Vec<u8> = vec![0; scene.members.len()];
        for (share, ease, drift) in calls {
            let budget = scene.budget(share);
            let ease = (budget as f64 * ease) as u64;
            let weight: Vec<f32> =
                scene.members.iter().enumerate().map(|(m, member)| member.1 * drift[m % drift.len()]).collect();
            let is = |m: usize, kind: Kind| scene.members[m].3 == kind;
            let place_of = |m: usize| if is(m, Kind::Holder) { item_at(m, held[m]) } else { u32::MAX };
            let place: Vec<u32> = (0..held.len()).map(place_of).collect();
            let mut census = vec![0; starts[starts.len() - 1] as usize];
            place.iter().filter(|&&p| p != u32::MAX).for_each(|&p| census[p as usize] += 1);
            let class = |m: usize| listed.profiles.class_at(item_at(m, held[m]), weight[m], scene.members[m].2);
            let classes: Vec<SharedClass> = (0..held.len()).map(class).collect();
            let odd: Vec<OddClass> = (0..held.len())
                .filter(|&m| is(m, Kind::Odd))
                .map(|m| OddClass { at: m as u32, class: classes[m] })
                .collect();
            let own_class = |m: usize| {
                let (profile, stay) = (scene.members[m].0.get(&scene.profiles), scene.members[m].2);
                // Who is at the cheapest position may as well hold nothing.
                let held = (!m.is_multiple_of(5) || classes[m].current > 0).then_some(held[m]);
                (OwnClass { at: m as u32, weight: weight[m], stay, held }, profile.as_slice())
            };
            let own = OwnMembers((0..held.len()).filter(|&m| is(m, Kind::Own)).map(own_class).collect());
            listed.classes.clone_from(&classes);
            let plain = listed.solve(budget, ease, |m| m as u128);
            let stay = |m: usize| scene.members[m].2;
            let heaviest = weight.iter().copied().fold(0.0, f32::max);
            let (weight, place, census, odd) = (&weight[..], &place[..], &census[..], &odd[..]);
            let crowd = Crowd { weight, heaviest, place, census, odd, own, stay, threads: 1 };
            let outcome = crowded.solve_crowd(&crowd, budget, ease, |m| m as u128);
            let mut found = held.clone();
            crowded.changed().for_each(|(m, code)| found[m] = code);
            prop_assert_eq!(&found, &listed.chosen);
            prop_assert_eq!((outcome.cost, outcome.shortfall), (plain.cost, plain.shortfall));
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * plain.upper_bound.abs() + 1e-4;
            prop_assert!(close(outcome.benefit, plain.benefit), "{} {}", outcome.benefit, plain.benefit);
            prop_assert!(close(outcome.minimum_benefit, plain.minimum_benefit));
            if plain.shortfall == 0 {
                prop_assert!(close(outcome.upper_bound, plain.upper_bound), "{outcome:?} {plain:?}");
            }
            held = found;
        }
    }
}

/// The most benefit within the budget, by trying everything; `None` when nothing fits.
fn optimum(classes: &[Class], budget: u64) -> Option<f64> {
    let mut sums = vec![(0u64, 0.0f64)];
    for class in classes {
        let add = |&(cost, benefit): &(u64, f64), i: &ProfileItem| {
            (cost + class.cost(i.ticks), benefit + class.benefit(i))
        };
        sums = sums.iter().flat_map(|sum| class.items.iter().map(move |i| add(sum, i))).collect();
        sums.retain(|&(cost, _)| cost <= budget);
    }
    sums.into_iter().map(|(_, benefit)| benefit).reduce(f64::max)
}

/// What must hold of any answer, given the optimum.
fn is_honest(
    solver: &SharedKnapsack,
    classes: &[Class],
    budget: u64,
    outcome: &Outcome,
    best: f64,
) -> Result<(), TestCaseError> {
    let chosen: Vec<&ProfileItem> = classes
        .iter()
        .zip(&solver.chosen)
        .map(|(class, &item)| class.items.iter().find(|i| i.item == item).expect("an item of the class"))
        .collect();
    let cost: u64 = classes.iter().zip(&chosen).map(|(c, i)| c.cost(i.ticks)).sum();
    let benefit: f64 = classes.iter().zip(&chosen).map(|(c, i)| c.benefit(i)).sum();
    let least: f64 = classes.iter().map(|c| c.benefit(c.cheapest())).sum();
    let slack = classes.len() as f64 / (1u64 << 32) as f64 + 1e-12 * best;
    prop_assert_eq!(outcome.cost, cost);
    prop_assert!((outcome.benefit - benefit).abs() <= slack);
    prop_assert!((outcome.minimum_benefit - least).abs() <= slack);
    prop_assert!(cost <= budget && outcome.shortfall == 0);
    prop_assert!(outcome.upper_bound >= best - slack, "{} < {}", outcome.upper_bound, best);
    prop_assert!(benefit <= best + slack);
    let gap = outcome.gap();
    prop_assert!((0.0..=1.0).contains(&gap) && (0.0..=1.0).contains(&outcome.priced_gap()));
    prop_assert!(gap * (outcome.upper_bound - least) >= best - benefit - 2.0 * slack);
    prop_assert!(outcome.lambda >= 0.0 && outcome.lambda.is_finite());
    if classes.iter().all(|c| c.stay == 0.0) {
        prop_assert!(benefit - least >= 0.5 * (best - least) - slack, "{benefit} of {best} from {least}");
        prop_assert_eq!(outcome.priced_benefit, outcome.benefit);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn small_instances_hold_their_promises_against_exhaustive_search(
        mut classes in classes(1..6),
        share in -0.05f64..1.0,
        free in any::<bool>(),
    ) {
        if free {
            classes.iter_mut().for_each(|c| c.stay = 0.0);
        }
        let least = total(&classes, |c| c.cheapest().ticks);
        let budget = if share < 0.0 { least } else { share_of(&classes, share) };
        let mut solver = SharedKnapsack::default();
        let outcome = solve(&mut solver, &classes, budget);
        let best = optimum(&classes, budget).expect("the cheapest choice fits");
        is_honest(&solver, &classes, budget, &outcome, best)?;
        if budget > 0 && least == budget {
            let outcome = solve(&mut solver, &classes, budget - 1);
            prop_assert_eq!((outcome.shortfall, outcome.cost), (1, least));
        }
    }

    #[test]
    fn a_dozen_classes_hold_their_promises_against_the_exact_core(
        classes in classes(6..14),
        share in 0.0f64..1.0,
    ) {
        let budget = share_of(&classes, share);
        let mut solver = SharedKnapsack::default();
        let outcome = solve(&mut solver, &classes, budget);
        let item = |c: &Class, i: &ProfileItem| Item { cost: c.cost(i.ticks) as f64, benefit: c.benefit(i) };
        let items = classes.iter().map(|c| c.items.iter().map(|i| item(c, i)).collect::<Vec<_>>());
        let instance = Instance::new(budget as f64, items).expect("amounts");
        let best = exact(&instance, &mut || false);
        prop_assert!(best.optimal);
        is_honest(&solver, &classes, budget, &outcome, best.benefit)?;
    }
}

fn plain(items: &[(f32, u64)]) -> Class {
    let item = |(i, &(value, ticks)): (usize, &(f32, u64))| ProfileItem { value, ticks, item: i as u8 };
    let items = items.iter().enumerate().map(item).collect();
    Class { items, weight: 1.0, scale: 1.0, current: 0, stay: 0.0, key: 0 }
}

#[test]
fn no_class_is_solved() {
    let mut solver = SharedKnapsack::default();
    let outcome = solve(&mut solver, &[], 100);
    assert!(solver.chosen.is_empty());
    assert_eq!((outcome.cost, outcome.benefit, outcome.shortfall, outcome.gap()), (0, 0.0, 0, 0.0));
}

#[test]
fn a_class_of_one_item_takes_it_whatever_the_budget() {
    let mut solver = SharedKnapsack::default();
    let one = [plain(&[(0.5, 10)])];
    assert_eq!(solve(&mut solver, &one, 9).shortfall, 1);
    assert_eq!(solver.chosen, [0]);
    assert_eq!(solve(&mut solver, &one, 10).shortfall, 0);
    assert_eq!(solve(&mut solver, &one, u64::MAX).cost, 10);
}

#[test]
fn what_is_worth_nothing_gets_nothing_while_others_want_more() {
    let worthless = Class { weight: 0.0, key: 1, ..plain(&[(0.1, 1), (1.0, 5)]) };
    let worthy = Class { key: 2, ..plain(&[(0.1, 1), (0.9, 50), (1.0, 100)]) };
    let mut solver = SharedKnapsack::default();
    solve(&mut solver, &[worthless, worthy], 60);
    assert_eq!(solver.chosen, [0, 1]);
}

/// Mason's counterexample to the rule of 1993, in ticks of 2⁻¹³.
#[test]
fn masons_counterexample_is_solved_to_the_optimum() {
    let tick = |cost: f64| (cost * 8192.0).ceil() as u64;
    let big = [(0.4652f32, 0.1136), (5.0387, 1.7599), (34.5056, 18.8952), (618.5195, 346.7490)];
    let small = [(0.3795f32, 0.1086), (0.6621, 0.3057), (2.1120, 5.2287), (6.1775, 21.4700)];
    let class = |key, items: &[(f32, f64)]| {
        let items: Vec<_> = items.iter().map(|&(value, cost)| (value, tick(cost))).collect();
        Class { key, ..plain(&items) }
    };
    let mut solver = SharedKnapsack::default();
    let budget = tick(346.7490) + tick(0.1086);
    let outcome = solve(&mut solver, &[class(0, &big), class(1, &small)], budget);
    assert_eq!(solver.chosen, [3, 0]);
    assert!((outcome.benefit - 618.899).abs() < 1e-3);
}

#[test]
fn costs_beyond_all_ticks_are_out_of_the_budget_and_not_out_of_range() {
    let mut solver = SharedKnapsack::default();
    let vast = |key| Class { scale: f32::MAX, key, ..plain(&[(0.5, 0), (1.0, 1 << 36)]) };
    let outcome = solve(&mut solver, &[vast(0), vast(1), plain(&[(0.5, 0), (1.0, 7)])], 1 << 50);
    assert_eq!(solver.chosen, [0, 0, 1]);
    assert_eq!((outcome.cost, outcome.shortfall), (7, 0));
    let dear = |key| Class { scale: f32::MAX, key, ..plain(&[(0.5, 1 << 36), (1.0, 1 << 37)]) };
    let outcome = solve(&mut solver, &[dear(0), dear(1)], 1 << 50);
    assert_eq!(solver.chosen, [0, 0]);
    assert!(outcome.shortfall > 0);
}
