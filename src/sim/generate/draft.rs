//! A scene while it is being furnished.

use glam::{DVec3, Vec3};

use super::kind::Kind;
use crate::bounds::Sphere;
use crate::files::Scene;
use crate::scene::{Object, ObjectId, Settings, TableId};
use crate::table::LodTable;

/// A kind that a scene has in stock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stock {
    table: TableId,
    bounds: Sphere,
    settings: Settings,
}

/// A scene in the making. Objects get their ids in the order in which they are put down.
pub(super) struct Draft {
    scene: Scene,
    kinds: Vec<Kind>,
    measured: Vec<LodTable>,
}

impl Draft {
    /// A scene whose kinds have been measured; `tables` is a scene of their tables, in any order.
    ///
    /// # Panics
    /// Tables come with the crate. That they can be read is held by tests.
    pub fn new(name: &str, tables: &str) -> Self {
        let measured =
            Scene::from_json(tables.as_bytes(), name).expect("the tables that come with the crate").tables;
        Self { measured, ..Self::of(name) }
    }

    /// A scene whose kinds are tables alone.
    pub fn of(name: &str) -> Self {
        let scene = Scene { name: name.into(), ..Scene::default() };
        Self { scene, kinds: Vec::new(), measured: Vec::new() }
    }

    /// Takes a kind into stock, with the table that was measured of it.
    pub fn stock(&mut self, kind: Kind) -> Stock {
        let measured = self.measured.iter().find(|table| table.name() == kind.name).cloned();
        let (table, settings) = (measured.unwrap_or_else(|| kind.unmeasured()), kind.settings);
        self.kinds.push(kind);
        self.stock_table(table, settings)
    }

    /// Takes what has but a table into stock.
    pub fn stock_table(&mut self, table: LodTable, settings: Settings) -> Stock {
        let stock =
            Stock { table: TableId(self.scene.tables.len() as u16), bounds: table.bounds(), settings };
        self.scene.tables.push(table);
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
        let id = ObjectId(self.scene.objects.len() as u64);
        self.scene.objects.push(Object { id, bounds, table: stock.table, settings: stock.settings });
        let last = self.scene.objects.len() - 1;
        &mut self.scene.objects[last].settings
    }

    pub fn finish(self) -> Scene {
        self.scene
    }

    /// The kinds in stock, in the order of their tables.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }
}

/// The nearest whole millimetre, in metres.
fn millimetres(metres: f64) -> f32 {
    ((metres * 1000.0).round() / 1000.0) as f32
}
