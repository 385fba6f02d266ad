//! The tables of the bundled scenes are those of their models: measured by `lod bake`, and still true.
#![cfg(all(feature = "bake", feature = "sim"))]

use lod_budget::bake::chain::{Accuracy, Chain, Preset, quietly};
use lod_budget::bake::weld::weld;
use lod_budget::bake::{Group, Mesh, Surface};
use lod_budget::sim::generate::{Model, Recipe};
use lod_budget::table::LodTable;

fn measured() -> impl Iterator<Item = (Model, LodTable)> {
    Recipe::ALL.into_iter().flat_map(|recipe| {
        let scene = recipe.scene(recipe.bundled_seed());
        assert_eq!(recipe.models().len(), scene.tables.len(), "{recipe}");
        recipe.models().into_iter().zip(scene.tables)
    })
}

/// As an OBJ file is read: corners that are at the same place are one.
fn mesh_of(model: &Model) -> Mesh {
    let group = |(material, triangles): &(&str, _)| Group {
        name: String::new(),
        material: Some((*material).to_owned()),
        triangles: Clone::clone(triangles),
    };
    let groups = model.materials.iter().map(group).collect();
    let surface = Surface { positions: model.positions.clone(), triangles: model.triangles.clone() };
    let mut mesh = Mesh { name: model.name.clone(), groups, ..surface.into() };
    weld(&mut mesh);
    mesh
}

#[test]
fn every_class_is_a_preset() {
    for (model, _) in measured() {
        assert!(Preset::named(model.class.name()).is_some(), "{}: {}", model.name, model.class.name());
    }
}

#[test]
fn every_table_is_of_its_model() {
    for (model, table) in measured() {
        let name = &model.name;
        let finest = table.levels()[0];
        assert_eq!(table.name(), name);
        assert_eq!(finest.triangles as usize, model.triangles.len(), "{name}");
        assert_eq!(finest.draws as usize, model.materials.len(), "{name}");
        assert!(finest.vertices as usize <= model.positions.len(), "{name}");
        assert_eq!((finest.error, finest.accuracy), (Some(0.0), 1.0), "{name}");
        let bound = table.bounds();
        let farthest = model.positions.iter().map(|p| p.distance(bound.center)).fold(0.0, f32::max);
        assert!(farthest <= bound.radius * 1.000_001, "{name}: {farthest} is beyond {}", bound.radius);
    }
}

/// Small kinds of two presets, baked anew. Another platform may round otherwise in the last digits.
#[test]
fn a_fresh_bake_says_the_same() {
    let small = ["floor slab", "log bench"];
    for (model, table) in measured().filter(|(model, _)| small.contains(&model.name.as_str())) {
        let fresh = bake(&model);
        let counts = |table: &LodTable| table.levels().iter().map(|l| l.triangles).collect::<Vec<_>>();
        let again = fresh.table(Accuracy::default()).expect("a table");
        assert_eq!(counts(&table), counts(&again), "{}", model.name);
        for (level, stored) in fresh.levels.iter().zip(table.levels()) {
            let (hausdorff, error) = (level.deviation.hausdorff, f64::from(stored.error.unwrap_or(0.0)));
            assert!(hausdorff <= error * 1.0001, "{}: {hausdorff} is above the stored {error}", model.name);
        }
    }
}

fn bake(model: &Model) -> Chain {
    let plan = Preset::named(model.class.name()).expect("a preset").plan();
    plan.bake(&mesh_of(model), &mut quietly).expect("a chain")
}
