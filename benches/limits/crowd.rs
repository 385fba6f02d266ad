//! What is in view of a scene: weights, budgets, and the totals of a choice of levels.

use crate::baselines::classes::{Classes, Hull, Totals};
use crate::camera::Lens;
use crate::ours::NOT_SHOWN;
use crate::scene::{Scene, UNITS_PER_US};

/// The part of the way from the least to the most that a frame can cost at which budgets are: nearly every object has
/// to be weighed.
const BUDGET: f64 = 0.4;

pub fn hulls(scene: &Scene) -> Vec<Hull> {
    scene.tables.iter().map(|levels| Hull::of(levels)).collect()
}

/// Rates all objects of a scene, in view or not.
pub fn rate_all(scene: &Scene, lens: &Lens, weight: &mut Vec<f32>) {
    weight.resize(scene.len(), 0.0);
    let [x, y, z] = [&scene.x, &scene.y, &scene.z].map(|column| column.iter());
    let spheres = x.zip(y).zip(z).zip(&scene.radius).zip(&scene.importance);
    for (weight, ((((&x, &y), &z), &radius), &importance)) in weight.iter_mut().zip(spheres) {
        *weight = lens.weight([x, y, z, radius], importance);
    }
}

/// The objects in view, ascending.
pub fn in_view(scene: &Scene, lens: &Lens) -> Vec<u32> {
    (0..scene.len() as u32).filter(|&i| lens.sees(scene.sphere(i as usize))).collect()
}

/// The budget for some of the objects, in 1024ths of a microsecond.
pub fn budget(scene: &Scene, objects: &[u32]) -> u64 {
    let levels = |&i: &u32| &scene.tables[usize::from(scene.table[i as usize])];
    let least: u64 = objects.iter().filter_map(|i| levels(i).last()).map(|l| u64::from(l.units())).sum();
    let most: u64 = objects.iter().filter_map(|i| levels(i).first()).map(|l| u64::from(l.units())).sum();
    least + (BUDGET * (most - least) as f64) as u64
}

pub fn in_us(units: u64) -> f64 {
    units as f64 / UNITS_PER_US
}

/// The weights and tables of objects in view.
pub struct Crowd {
    pub table: Vec<u16>,
    pub weight: Vec<f32>,
}

impl Crowd {
    pub fn of(scene: &Scene, lens: &Lens, objects: &[u32]) -> Self {
        let of = |&i: &u32| lens.weight(scene.sphere(i as usize), scene.importance[i as usize]);
        Self {
            table: objects.iter().map(|&i| scene.table[i as usize]).collect(),
            weight: objects.iter().map(of).collect(),
        }
    }

    pub fn classes<'a>(&'a self, hulls: &'a [Hull]) -> Classes<'a> {
        Classes { hulls, table: &self.table, weight: &self.weight }
    }

    /// What a level for each comes to; an error where one is not shown.
    pub fn totals(&self, scene: &Scene, levels: impl Iterator<Item = u8>) -> Result<Totals, String> {
        let mut totals = Totals::default();
        for (object, level) in levels.enumerate() {
            if level == NOT_SHOWN {
                return Err("the frame does not show all that is in view".to_owned());
            }
            let detail = scene.tables[usize::from(self.table[object])][usize::from(level)];
            totals.units += u64::from(detail.units());
            totals.benefit += f64::from(self.weight[object]) * f64::from(detail.accuracy);
        }
        Ok(totals)
    }
}
