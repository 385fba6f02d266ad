//! What was asked for, as a plan.

use std::path::PathBuf;

use lod_budget::bake::chain::{Accuracy, Limits, Plan, Preset, Stops};
use lod_budget::bake::{impostor, progressive, scene};

use super::geomorph::GeomorphArgs;
use super::subdivide::Subdivision;
use super::{Args, ChainArgs, Format};

/// How every mesh is baked.
pub struct Settings {
    pub plan: Plan,
    /// Where levels go upwards.
    pub subdivide: Option<Subdivision>,
    pub accuracy: Accuracy,
    pub formats: Vec<Format>,
    pub geomorph: bool,
    /// What chains end with.
    pub impostor: Option<impostor::Options>,
    /// What is done to scenes.
    pub scene: scene::Options,
    /// What progressive mesh is made, if any.
    pub progressive: Option<progressive::Options>,
    pub out: PathBuf,
    pub force: bool,
    /// As `--method` has it.
    pub method: &'static str,
    pub preset: Option<&'static str>,
}

impl Settings {
    /// # Errors
    /// What no mesh could be baked with.
    pub fn of(args: &Args) -> anyhow::Result<Self> {
        let plan = args.chain.plan();
        let plan = Plan { quadric: args.quadric.over(plan.quadric), ..plan };
        plan.check()?;
        let impostor = args.impostor.options();
        impostor.as_ref().map_or(Ok(()), impostor::Options::check)?;
        let like = progressive::Options { method: plan.quadric, ..progressive::Options::default() };
        Ok(Self {
            progressive: args.progressive.options(like),
            subdivide: args.subdivide.over(&plan)?,
            plan,
            accuracy: args.chain.accuracy.accuracy(),
            formats: args.format.clone(),
            geomorph: args.geomorph.geomorph,
            impostor,
            scene: args.scene.options(),
            out: args.out.clone(),
            force: args.force,
            method: args.chain.method.name(),
            preset: args.chain.preset.map(Preset::name),
        })
    }

    pub fn wants(&self, format: Format) -> bool {
        self.formats.contains(&format)
    }

    /// All that the outputs depend on beside the mesh; equal keys make equal files.
    pub fn key(&self) -> String {
        let formats = [Format::Glb, Format::Obj, Format::Json, Format::Sheet].map(|f| (f, self.wants(f)));
        let Self { plan, subdivide, accuracy, impostor, progressive, .. } = self;
        let geomorph = GeomorphArgs::key(self.geomorph);
        let version = env!("CARGO_PKG_VERSION");
        format!(
            "{version} {plan:?} {subdivide:?} {accuracy:?} {formats:?} {impostor:?} {progressive:?}{geomorph}"
        )
    }
}

impl ChainArgs {
    /// The preset's plan, or the default one, changed by what was asked for. Levels that are named one by one are made
    /// whatever the limits of the preset.
    fn plan(&self) -> Plan {
        let plan = Plan { method: self.method, ..self.preset.map_or_else(Plan::default, Preset::plan) };
        match (self.named_stops(), self.levels) {
            (Some(stops), _) => Plan { stops, limits: Limits::NONE, ..plan },
            (None, Some(levels)) => {
                let limits = if self.preset.is_some() { plan.limits } else { Limits::NONE };
                Plan { limits: Limits { levels, ..limits }, ..plan }
            }
            (None, None) => plan,
        }
    }

    fn named_stops(&self) -> Option<Stops> {
        if !self.ratios.is_empty() {
            return Some(Stops::Shares(self.ratios.clone()));
        }
        if !self.triangles.is_empty() {
            return Some(Stops::Triangles(self.triangles.clone()));
        }
        (!self.errors.is_empty()).then(|| Stops::Errors(self.errors.clone()))
    }
}
