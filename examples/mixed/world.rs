//! What is in the scene: one terrain, a forest and a camp.

use std::error::Error;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use lod_budget::Sphere;
use lod_budget::bake::chain::{Accuracy, Chain, Preset, quietly};
use lod_budget::bake::hierarchy;
use lod_budget::bake::impostor::{Kind, Options};
use lod_budget::bake::simplify::{self, GarlandHeckbert};
use lod_budget::bake::{Mesh, Surface};
use lod_budget::files::{CameraPath, Scene};
use lod_budget::hierarchy::Hierarchy;
use lod_budget::scene::{Object, TableId};
use lod_budget::sim::generate::{Model, Recipe};
use lod_budget::table::{Level, LodTable};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::ground::{Ground, SIDE_M};
use crate::walk;

const TREES: u64 = 3000;
const PROPS: u64 = 500;

/// No tree is as near to the middle of the camp, and most props are, in metres.
const CLEARING_M: f32 = 45.0;

/// Levels of the terrain's table.
const SIZES: usize = 64;

/// The accuracy of a hierarchy is 1 − error / radius, so that of all others is as well.
const ACCURACY: Accuracy = Accuracy::Hausdorff;

/// The terrain is the first table and the first object.
pub const TERRAIN: TableId = TableId(0);

/// What a table is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sort {
    Terrain,
    /// With the level that is an impostor, if it was worth having.
    Tree(Option<Level>),
    Prop,
}

pub struct World {
    pub scene: Scene,
    /// Of each table.
    pub sorts: Vec<Sort>,
    pub path: CameraPath,
    pub hierarchy: Arc<Hierarchy>,
}

/// Bakes everything; the terrain has so many cells on a side.
pub fn bake(cells: u32) -> Result<World, Box<dyn Error>> {
    let ground = Ground::new(cells.max(1), 1);
    let hierarchy = hierarchy::of(&ground.mesh(), &GarlandHeckbert::default(), &mut simplify::quietly)?;
    let (mut tables, mut sorts) = (vec![hierarchy.table("terrain", SIZES)?], vec![Sort::Terrain]);
    for model in Recipe::Forest.models() {
        let made = match model.name.as_str() {
            "beech" | "spruce" | "birch" => tree(model)?,
            "shrub" | "fern" | "rock" | "log" | "tent" | "lantern" | "food stall" | "log bench" => {
                prop(model)?
            }
            _ => continue,
        };
        tables.push(made.0);
        sorts.push(made.1);
    }
    let objects = planted(&ground, &tables, &sorts)?;
    let scene = Scene { name: "mixed".to_owned(), tables, objects };
    Ok(World { scene, sorts, path: walk::over(&ground)?, hierarchy: Arc::new(hierarchy) })
}

type Made = (LodTable, Sort);

fn chain(model: Model) -> Result<(Mesh, Chain), Box<dyn Error>> {
    let surface = Surface { positions: model.positions, triangles: model.triangles };
    let mesh = Mesh { name: model.name, ..surface.into() };
    let chain = Preset::SmallProp.plan().bake(&mesh, &mut quietly)?;
    Ok((mesh, chain))
}

fn prop(model: Model) -> Result<Made, Box<dyn Error>> {
    Ok((chain(model)?.1.table(ACCURACY)?, Sort::Prop))
}

fn tree(model: Model) -> Result<Made, Box<dyn Error>> {
    let (mesh, chain) = chain(model)?;
    let impostor = Options::new(Kind::Octahedral { frames: 9, hemisphere: true }).bake(&mesh)?;
    let joined = impostor.join(&chain, ACCURACY)?;
    let picture = joined.left_out.is_none().then(|| joined.table.coarsest());
    Ok((joined.table, Sort::Tree(picture)))
}

/// The terrain, then the forest, then what lies about; the same every time.
fn planted(ground: &Ground, tables: &[LodTable], sorts: &[Sort]) -> Result<Vec<Object>, Box<dyn Error>> {
    let of = |wanted: fn(&Sort) -> bool| -> Vec<usize> {
        (0..sorts.len()).filter(|&table| wanted(&sorts[table])).collect()
    };
    let (trees, props) = (of(|s| matches!(s, Sort::Tree(_))), of(|s| *s == Sort::Prop));
    let mut dice = Pcg64Mcg::seed_from_u64(1997);
    let mut objects = vec![Object::new(0, tables[0].bounds(), TERRAIN)];
    for id in 1..=TREES + PROPS {
        let is_tree = id <= TREES;
        let kinds = if is_tree { &trees } else { &props };
        let table = kinds[dice.random_range(0..kinds.len())];
        let at = if is_tree { in_forest(&mut dice) } else { about_camp(&mut dice) };
        let scale = dice.random_range(0.6..1.3);
        objects.push(Object::new(
            id,
            stood(tables[table].bounds(), ground.place(at), scale),
            TableId(u16::try_from(table)?),
        ));
    }
    Ok(objects)
}

fn stood(bounds: Sphere, place: Vec3, scale: f32) -> Sphere {
    Sphere::new(bounds.center * scale + place, bounds.radius * scale)
}

fn in_forest(dice: &mut Pcg64Mcg) -> Vec2 {
    let reach = 0.49 * SIDE_M;
    loop {
        let at = Vec2::from_array([0, 1].map(|_| dice.random_range(-reach..reach)));
        if at.distance(walk::CAMP) > CLEARING_M {
            return at;
        }
    }
}

/// Denser towards the middle, thinning out into the forest.
fn about_camp(dice: &mut Pcg64Mcg) -> Vec2 {
    let away = dice.random_range(0.1f32..1.5);
    walk::CAMP + Vec2::from_angle(dice.random_range(0.0..std::f32::consts::TAU)) * away * away * CLEARING_M
}
