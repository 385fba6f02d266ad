//! The render loop: one selection for everything, whose level for the terrain is the budget of the cut.

use std::error::Error;

use lod_budget::CostModel;
use lod_budget::frame::{FrameTime, GroupId};
use lod_budget::hierarchy::{Budget, Cut};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{ObjectId, Objects};
use lod_budget::select::Predictive;
use lod_budget::sim::{Camera, Machine};
use lod_budget::table::Level;

use crate::world::{Sort, TERRAIN, World};

/// What the selection knows of the terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offer {
    /// The table of the file, the same from everywhere.
    Fixed,
    /// What a cut is worth to the camera, from a second one that always has the same share of the triangles.
    ///
    /// The offer of the cut that is steered would feed back: once it is coarse it is off by so much that no size is
    /// worth its triangles, and it stays coarse.
    EveryFrame,
}

/// The share of all triangles at which offers are made.
const PROBED: f64 = 1.0 / 16.0;

/// What a frame came to.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// What the selection could spend and what it costs by the model; and the whole frame by prediction and by the
    /// simulated machine.
    pub select_us: f64,
    pub cost_us: f64,
    pub predicted_us: f64,
    pub time_us: f64,
    pub infeasible_us: f64,
    /// How much better any other choice could be, as a share.
    pub gap: Option<f64>,
    /// Triangles of the terrain: of the level that was chosen, and of the cut.
    pub allowed: usize,
    pub used: usize,
    /// What the cut says that it is off by at most.
    pub off_px: f32,
    /// Cost of the terrain, of trees and of props by the model.
    pub spread_us: [f64; 3],
    /// How many props are at each level, and trees as triangles and as impostors.
    pub props: Vec<usize>,
    pub trees: [usize; 2],
}

/// Runs the path under a budget, on a machine that is not quite the one that the runtime believes in.
pub fn drive(
    world: &World,
    camera: Camera,
    budget_us: f64,
    offer: Offer,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let machine = Machine::default_for(&world.scene.tables, &CostModel::default(), 1);
    let mut runtime = Runtime::new(RuntimeOptions::default(), Box::new(Predictive::default()))?;
    let mut objects = world.scene.to_objects()?;
    let mut cut = Cut::new(world.hierarchy.clone());
    let mut probe = cut.clone();
    let probed = Budget::triangles((PROBED * world.hierarchy.triangles() as f64) as usize);
    let table = &world.scene.tables[usize::from(TERRAIN.0)];
    let (mut rows, mut times) = (Vec::<Row>::new(), Vec::new());
    for (k, noise) in (0..camera.frames(&world.path)).zip(machine.noise()) {
        let view = camera.view(&world.path.sample(k as f64 / camera.fps));
        if offer == Offer::EveryFrame {
            probe.update(&[view], &probed);
            objects.replace_table(TERRAIN, probe.offer(table)?)?;
        }
        let measured = k.checked_sub(machine.latency()).and_then(|k| times.get(k..=k)).unwrap_or_default();
        let views = [ViewInput::new(view, 0)];
        let input =
            FrameInput { measured, dt_s: (1.0 / camera.fps) as f32, ..FrameInput::new(&views, budget_us) };
        let frame = runtime.frame(&mut objects, &input).frame;
        let level = runtime.shown(&objects, GroupId(0), ObjectId(0)).level;
        let allowed = table.levels().get(level.index()).map_or(0, |level| level.triangles as usize);
        let report = cut.update(&[view], &Budget::triangles(allowed));
        let time_us = machine_us(&machine, &runtime, &objects) * noise;
        times.push(FrameTime::busy(frame, time_us as f32));
        rows.push(Row {
            allowed,
            used: report.triangles,
            off_px: report.max_error_px,
            time_us,
            ..row(world, &runtime, &objects)
        });
    }
    Ok(rows)
}

/// The time that the machine takes, the terrain counted as its level has it.
fn machine_us(machine: &Machine, runtime: &Runtime, objects: &Objects) -> f64 {
    let mut seen = runtime.last_frame(objects).detailed();
    machine.see(&mut seen);
    machine.time_us(&seen, runtime.shown_slots(GroupId(0)).map(|(_, shown)| shown.level))
}

/// What the runtime says of its last frame.
fn row(world: &World, runtime: &Runtime, objects: &Objects) -> Row {
    let report = runtime.report();
    let mut row = Row {
        select_us: report.budget.select_us,
        cost_us: report.select.cost_us,
        predicted_us: report.predicted_us,
        infeasible_us: report.select.infeasible_us,
        gap: report.select.certificate.map(|c| c.gap),
        ..Row::default()
    };
    let detailed = runtime.last_frame(objects).detailed();
    let frame = lod_budget::select::Frame { candidates: &detailed, ..runtime.last_frame(objects) };
    for (i, &level) in runtime.wanted().iter().enumerate() {
        let sort = world.sorts[usize::from(detailed.table[i])];
        row.spread_us[sort.column()] += frame.cost_us(i, level);
        row.count(sort, level);
    }
    row
}

impl Sort {
    fn column(self) -> usize {
        match self {
            Self::Terrain => 0,
            Self::Tree(_) => 1,
            Self::Prop => 2,
        }
    }
}

impl Row {
    fn count(&mut self, sort: Sort, level: Level) {
        match sort {
            Sort::Terrain => {}
            Sort::Tree(picture) => self.trees[usize::from(picture == Some(level))] += 1,
            Sort::Prop => {
                self.props.resize(self.props.len().max(level.index() + 1), 0);
                self.props[level.index()] += 1;
            }
        }
    }
}
