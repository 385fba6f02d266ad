//! The textbook: a list of all steps as structs, sorted by slope, then taken one by one.

use super::Selection;
use super::classes::Classes;

#[derive(Clone, Copy)]
struct Step {
    slope: f32,
    object: u32,
    from: u8,
    units: u32,
}

#[derive(Default)]
pub struct StructSort {
    steps: Vec<Step>,
}

impl Selection for StructSort {
    fn choose(&mut self, classes: &Classes<'_>, budget: u64, position: &mut [u8]) {
        self.list(classes);
        self.steps.sort_unstable_by(|a, b| {
            b.slope.total_cmp(&a.slope).then(a.object.cmp(&b.object)).then(a.from.cmp(&b.from))
        });
        position.fill(0);
        let mut room = budget.saturating_sub(classes.least_units());
        for step in self.steps.iter() {
            if u64::from(step.units) > room {
                break;
            }
            room -= u64::from(step.units);
            position[step.object as usize] += 1;
        }
    }
}

impl StructSort {
    fn list(&mut self, classes: &Classes<'_>) {
        self.steps.clear();
        for object in 0..classes.len() {
            let (hull, weight) = (classes.hull(object), classes.weight[object]);
            self.steps.extend((0..hull.last).map(|from| Step {
                slope: weight * hull.slope[usize::from(from)],
                object: object as u32,
                from,
                units: hull.step_units(usize::from(from)),
            }));
        }
    }
}
