//! What is to be solved, checked once.

use std::error::Error;
use std::fmt;

/// One choice of a class.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Item {
    /// What it takes from the budget; finite, not negative.
    pub cost: f64,
    /// What it is worth; finite, not negative.
    pub benefit: f64,
}

impl From<(f64, f64)> for Item {
    fn from((cost, benefit): (f64, f64)) -> Self {
        Self { cost, benefit }
    }
}

/// A budget and classes of items, one of each class to be chosen. Valid by construction.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    budget: f64,
    /// Class `i` holds `items[offsets[i]..offsets[i + 1]]`.
    offsets: Vec<u32>,
    items: Vec<Item>,
}

impl Instance {
    /// Copies `classes` into compressed rows and checks them.
    ///
    /// No classes at all is valid. The first item that breaks a rule is named in the error.
    pub fn new<C: AsRef<[Item]>>(
        budget: f64,
        classes: impl IntoIterator<Item = C>,
    ) -> Result<Self, InstanceError> {
        let mut builder = InstanceBuilder::default();
        for class in classes {
            for &item in class.as_ref() {
                builder.push(item)?;
            }
            builder.close_class()?;
        }
        builder.finish(budget)
    }

    /// The cost that a choice may have at most.
    pub fn budget(&self) -> f64 {
        self.budget
    }

    /// The number of classes.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there is no class.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The items of class `index`.
    ///
    /// # Panics
    /// When there is no such class.
    pub fn class(&self, index: usize) -> &[Item] {
        &self.items[self.offsets[index] as usize..self.offsets[index + 1] as usize]
    }

    /// All classes in order.
    pub fn classes(&self) -> impl ExactSizeIterator<Item = &[Item]> + Clone {
        self.offsets.windows(2).map(|ends| &self.items[ends[0] as usize..ends[1] as usize])
    }

    /// All items, class after class.
    pub fn items(&self) -> &[Item] {
        &self.items
    }
}

/// Grows an [`Instance`] item by item, so that a reader can stop at the first broken one.
#[derive(Debug)]
pub(crate) struct InstanceBuilder {
    offsets: Vec<u32>,
    items: Vec<Item>,
}

impl Default for InstanceBuilder {
    fn default() -> Self {
        Self { offsets: vec![0], items: Vec::new() }
    }
}

impl InstanceBuilder {
    /// The index of the class under construction.
    pub fn class(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The index of the next item in its class.
    pub fn item(&self) -> usize {
        self.items.len() - self.class_start()
    }

    fn class_start(&self) -> usize {
        self.offsets[self.class()] as usize
    }

    pub fn push(&mut self, item: Item) -> Result<(), InstanceError> {
        let (class, index) = (self.class(), self.item());
        if !is_amount(item.cost) {
            return Err(InstanceError::Cost { class, item: index, value: item.cost });
        }
        if !is_amount(item.benefit) {
            return Err(InstanceError::Benefit { class, item: index, value: item.benefit });
        }
        if self.items.len() == u32::MAX as usize {
            return Err(InstanceError::TooMany { class, item: index });
        }
        self.items.push(item);
        Ok(())
    }

    pub fn close_class(&mut self) -> Result<(), InstanceError> {
        if self.item() == 0 {
            return Err(InstanceError::EmptyClass { class: self.class() });
        }
        self.offsets.push(self.items.len() as u32);
        Ok(())
    }

    pub fn finish(self, budget: f64) -> Result<Instance, InstanceError> {
        if !is_amount(budget) {
            return Err(InstanceError::Budget { value: budget });
        }
        let instance = Instance { budget, offsets: self.offsets, items: self.items };
        for (total, of) in [
            (largest_total(&instance, |item| item.cost), "cost"),
            (largest_total(&instance, |item| item.benefit), "benefit"),
        ] {
            if total.is_infinite() {
                return Err(InstanceError::Total { of });
            }
        }
        Ok(instance)
    }
}

fn is_amount(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

fn largest_total(instance: &Instance, amount: impl Fn(&Item) -> f64) -> f64 {
    instance.classes().map(|class| class.iter().map(&amount).fold(0.0, f64::max)).sum()
}

/// Why an [`Instance`] was refused; classes and items count from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum InstanceError {
    /// The budget is negative or not finite.
    Budget {
        /// The offending budget.
        value: f64,
    },
    /// A class has no item, so nothing can be chosen from it.
    EmptyClass {
        /// The offending class.
        class: usize,
    },
    /// A cost is negative or not finite.
    Cost {
        /// The item's class.
        class: usize,
        /// The item within its class.
        item: usize,
        /// The offending cost.
        value: f64,
    },
    /// A benefit is negative or not finite.
    Benefit {
        /// The item's class.
        class: usize,
        /// The item within its class.
        item: usize,
        /// The offending benefit.
        value: f64,
    },
    /// There are more than 2^32 − 1 items.
    TooMany {
        /// The class that holds the first item too many.
        class: usize,
        /// That item within its class.
        item: usize,
    },
    /// The classes' largest costs or benefits sum to more than an `f64` holds.
    Total {
        /// "cost" or "benefit".
        of: &'static str,
    },
}

impl fmt::Display for InstanceError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Budget { value } => {
                write!(out, "the budget must be finite and not negative, but is {value}")
            }
            Self::EmptyClass { class } => {
                write!(out, "class {class} must have at least one item, but is empty")
            }
            Self::Cost { class, item, value } => {
                write!(
                    out,
                    "class {class}, item {item}: the cost must be finite and not negative, but is {value}"
                )
            }
            Self::Benefit { class, item, value } => {
                write!(
                    out,
                    "class {class}, item {item}: the benefit must be finite and not negative, but is {value}"
                )
            }
            Self::TooMany { class, item } => {
                write!(out, "class {class}, item {item}: there must be at most {} items in all", u32::MAX)
            }
            Self::Total { of } => write!(out, "the largest {of}s of all classes must sum to a finite number"),
        }
    }
}

impl Error for InstanceError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn build(budget: f64, classes: &[&[(f64, f64)]]) -> Result<Instance, InstanceError> {
        Instance::new(
            budget,
            classes.iter().map(|class| class.iter().copied().map(Item::from).collect::<Vec<_>>()),
        )
    }

    #[test]
    fn rows_come_back_as_they_went_in() -> Result<(), InstanceError> {
        let instance = build(3.0, &[&[(1.0, 2.0)], &[(0.0, 0.0), (5.0, 4.0)]])?;
        assert_eq!((instance.len(), instance.is_empty(), instance.budget()), (2, false, 3.0));
        assert_eq!(instance.class(1)[1], Item { cost: 5.0, benefit: 4.0 });
        assert_eq!(instance.classes().map(<[Item]>::len).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(instance.items().len(), 3);
        assert!(build(0.0, &[])?.is_empty());
        Ok(())
    }

    #[test]
    fn each_broken_rule_names_its_place() {
        let one = [(1.0, 1.0)];
        let huge = [(1.0, 1e308)];
        let refused = |budget, classes: &[&[(f64, f64)]], words: &[&str]| {
            let Err(error) = build(budget, classes) else { panic!("{classes:?} was accepted") };
            let message = error.to_string();
            assert!(words.iter().all(|word| message.contains(word)), "{message}");
        };
        refused(-1.0, &[], &["budget", "-1"]);
        refused(f64::NAN, &[], &["budget", "NaN"]);
        refused(f64::INFINITY, &[], &["budget", "inf"]);
        refused(1.0, &[&one, &[]], &["class 1", "empty"]);
        refused(1.0, &[&[(1.0, 1.0), (-0.5, 1.0)]], &["class 0, item 1", "cost", "-0.5"]);
        refused(1.0, &[&one, &[(1.0, f64::NAN)]], &["class 1, item 0", "benefit", "NaN"]);
        refused(1.0, &[&huge, &huge], &["benefits", "sum"]);
    }
}
