//! A scene while it is being furnished.

use glam::{DVec3, Vec3};

use super::kind::Kind;
use crate::bounds::Sphere;
use crate::files::Scene;
use crate::scene::{Object, ObjectId, Settings, TableId};

/// A kind that a scene has in stock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stock {
    table: TableId,
    bounds: Sphere,
    settings: Settings,
}

/// A scene in the making. Objects get their ids in the order in which they are put down.
pub(super) struct Draft(Scene);

impl Draft {
    pub fn new(name: &str) -> Self {
        Self(Scene { name: name.into(), ..Scene::default() })
    }

    /// Takes a kind into stock.
    pub fn stock(&mut self, kind: Kind) -> Stock {
        let (table, settings) = (kind.table(), kind.settings());
        let stock = Stock { table: TableId(self.0.tables.len() as u16), bounds: table.bounds(), settings };
        self.0.tables.push(table);
        stock
    }

    /// Puts one down; its settings may be changed.
    pub fn put(&mut self, stock: Stock, at: DVec3) -> &mut Settings {
        self.put_scaled(stock, at, 1.0)
    }

    /// Puts one down that is `scale` times as large. What is stored is rounded to millimetres.
    pub fn put_scaled(&mut self, stock: Stock, at: DVec3, scale: f64) -> &mut Settings {
        let center = at + stock.bounds.center.as_dvec3() * scale;
        let center = Vec3::new(millimetres(center.x), millimetres(center.y), millimetres(center.z));
        let bounds = Sphere::new(center, millimetres(f64::from(stock.bounds.radius) * scale));
        let id = ObjectId(self.0.objects.len() as u64);
        self.0.objects.push(Object { id, bounds, table: stock.table, settings: stock.settings });
        let last = self.0.objects.len() - 1;
        &mut self.0.objects[last].settings
    }

    pub fn finish(self) -> Scene {
        self.0
    }
}

/// The nearest whole millimetre, in metres.
fn millimetres(metres: f64) -> f32 {
    ((metres * 1000.0).round() / 1000.0) as f32
}
