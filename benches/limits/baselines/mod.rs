//! What the crate is measured against: real code, one algorithm per file, none of it the crate's.
//!
//! All selections but the rule of 1993 are *the textbook greedy*: every class at its cheapest position, then steps in
//! the order of falling slope (of equal slopes the lower object's, then the cheaper) up to the first that does not
//! fit. They give the same answer, which is checked before they are timed.

pub mod classes;
pub mod funkhouser_sequin;
pub mod heap;
pub mod hull_per_object;
pub mod obvhs_query;
pub mod quickselect;
pub mod radix_sort;
pub mod strong_frame;
pub mod struct_sort;
pub mod textbook_frame;
pub mod u64_sort;

use classes::Classes;

/// Chooses a position for every class within a budget. Scratch is kept from call to call.
pub trait Selection {
    /// `position` holds the last call's choice on entry, or zeros.
    fn choose(&mut self, classes: &Classes<'_>, budget: u64, position: &mut [u8]);
}
