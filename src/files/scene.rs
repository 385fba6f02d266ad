//! A scene as it is read or generated: tables and objects, not yet in the hot store.

use crate::scene::{Object, ObjectError, Objects};
use crate::table::LodTable;

/// Tables, and objects that refer to them by position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Name, for reports.
    pub name: String,
    /// LOD tables; [`crate::scene::TableId`] is the position here.
    pub tables: Vec<LodTable>,
    /// Objects, with unique ids.
    pub objects: Vec<Object>,
}

impl Scene {
    /// The scene in a hot store, tables in the same order.
    ///
    /// # Errors
    /// The first object that [`Objects::insert`] refuses.
    pub fn to_objects(&self) -> Result<Objects, ObjectError> {
        let mut store = Objects::new();
        for table in &self.tables {
            store.add_table(table.clone())?;
        }
        for object in &self.objects {
            store.insert(*object)?;
        }
        Ok(store)
    }
}
