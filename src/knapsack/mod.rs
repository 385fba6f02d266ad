//! The multiple-choice knapsack: choose one item of every class, as much benefit as possible within one budget of cost.
//!
//! Levels of detail under a frame time are one use; animation rates, shadow resolutions or splat counts are others.
//! Nothing here knows graphics: an [`Instance`] is a budget and classes of (cost, benefit) items, ragged and in any
//! order, with zero costs, duplicates and useless items allowed.
//!
//! | you want | take | cost | promise |
//! |---|---|---|---|
//! | a good choice and a certificate, now | [`greedy`] | O(n log n) | at least half of the optimum, in practice within 1e-4 at 1 000 classes, 1e-6 at 10 000; an upper bound |
//! | the same, cut after so many steps | [`greedy_within`] | O(n + s log s) | within the budget, an upper bound |
//! | the optimum of a hundred classes, in a frame | [`capped`] | the greedy and so many steps | `optimal` mostly proved, else an honest bound |
//! | the optimum | [`exact`] | exponential at worst | `optimal` proved, or an honest bound when stopped |
//! | the pieces | [`upper_hull`], [`compare_slopes`] | O(n log n), O(1) | exact geometry |
//!
//! Do not take them where classes constrain each other (trees, residency, several resources), where cost is not
//! additive, or where each class may stay empty and has no free item: add the item (0, 0) yourself.
//!
//! # What is exact
//! Every `f64` is an integer times a power of two. Costs and benefits are summed as integers on the grid their bits
//! share, so a budget equal to the exact sum of the costs is kept, and one bit less is not. Reported sums are rounded
//! once; bounds are rounded up. `optimal` means: no choice within the budget has a benefit that, rounded to `f64`, is
//! above the one reported.
//!
//! # Sources
//! H. Kellerer, U. Pferschy, D. Pisinger, *Knapsack Problems*, 2004, ch. 11 (the problem, the linear relaxation, the
//! half); P. Sinha, A. A. Zoltners, "The multiple-choice knapsack problem", 1979 (dominance, the relaxation's greedy);
//! D. Pisinger, "A minimal algorithm for the multiple-choice knapsack problem", 1995 (the expanding core).
//!
//! # Example
//! ```
//! use lod_budget::knapsack::{Instance, Item, exact, greedy};
//!
//! let near = [(0.2, 1.0), (1.0, 4.0), (4.0, 9.0)].map(Item::from);
//! let far = [(0.1, 0.2), (0.5, 0.4)].map(Item::from);
//! let instance = Instance::new(4.5, [&near[..], &far[..]])?;
//!
//! let quick = greedy(&instance);
//! assert_eq!(quick.choice, [2, 1]);
//! assert!(quick.cost <= 4.5 && quick.optimal);
//! assert_eq!(exact(&instance, &mut || false).benefit, quick.benefit);
//! # Ok::<(), lod_budget::knapsack::InstanceError>(())
//! ```

mod attempt;
mod dyadic;
mod exact;
mod greedy;
mod hull;
mod instance;
#[cfg(feature = "files")]
mod json;
mod ledger;
mod meter;
mod relaxation;
mod repair;
mod shared;
mod solution;
mod sum;

pub use exact::{capped, exact};
pub use greedy::{Effort, greedy, greedy_within};
pub use hull::{Step, compare_slopes, upper_hull, upper_hull_of};
pub use instance::{Instance, InstanceError, Item};
#[cfg(feature = "files")]
pub use json::InstanceJsonError;
pub(crate) use shared::{Columns, Hold, Units, opened, sift};
pub use shared::{
    Crowd, Ends, Menus, Octet, OddClass, Offer, Outcome, OwnClass, Position, ProfileItem, Profiles,
    SharedClass, SharedKnapsack,
};
pub use solution::Solution;
pub use sum::FixedSum;
