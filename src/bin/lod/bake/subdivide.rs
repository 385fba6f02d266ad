//! Levels upwards.

use lod_budget::bake::chain::{Chain, Length, Plan};
use lod_budget::bake::subdivide::{ControlFile, FOREVER_SHARP, Scheme, SubdivideError, Upward, load};
use lod_budget::bake::{Finding, MeshError};

use super::inputs::Input;
use super::length;
use super::mesh::Asked;

/// How to go upwards from control meshes.
#[derive(clap::Args)]
#[command(next_help_heading = "Subdivision")]
pub struct SubdivideArgs {
    /// Take meshes as control meshes and make levels upwards from them: so many subdivisions at most, the control mesh
    /// being the last level. Errors are distances to the limit surface. A glTF file is one mesh
    #[arg(
        long,
        value_name = "N",
        conflicts_with_all = ["method", "preset", "levels", "ratios", "triangles", "errors", "scene", "split"]
    )]
    subdivide: Option<usize>,
    /// How to subdivide [default: loop where all faces are triangles, else catmull-clark]
    #[arg(long, value_name = "NAME", requires = "subdivide")]
    scheme: Option<Scheme>,
    /// Keep edges sharp whose faces meet at this angle or more, in degrees: 180 is a fold
    #[arg(long, value_name = "DEGREES", requires = "subdivide", value_parser = angle)]
    crease_angle: Option<f64>,
    /// Subdivide no further once a level is this close to the limit surface, in object units or percent of the diagonal
    #[arg(long, value_name = "ERROR", requires = "subdivide", value_parser = length)]
    within: Option<Length>,
    /// Subdivide no further where this would make more triangles; refuse what it would after once [default: 524288]
    #[arg(long, value_name = "TRIANGLES", requires = "subdivide")]
    most_triangles: Option<usize>,
}

/// What was asked for.
#[derive(Clone, Debug)]
pub struct Subdivision {
    plan: Upward,
    crease_degrees: Option<f64>,
}

impl SubdivideArgs {
    /// Measured and looked at as `plan` has it; nothing where levels go downwards.
    ///
    /// # Errors
    /// A number of subdivisions out of range.
    pub fn over(&self, plan: &Plan) -> Result<Option<Subdivision>, SubdivideError> {
        let Some(levels) = self.subdivide else { return Ok(None) };
        let default = Upward::default();
        let plan = Upward {
            scheme: self.scheme,
            levels,
            error: self.within,
            most_triangles: self.most_triangles.unwrap_or(default.most_triangles),
            measure: plan.measure,
            look: plan.look,
            ..default
        };
        plan.check()?;
        Ok(Some(Subdivision { plan, crease_degrees: self.crease_angle }))
    }
}

impl Subdivision {
    /// The control mesh of a file, creased as was asked for.
    ///
    /// # Errors
    /// What the reader refuses.
    pub fn read(&self, input: &Input) -> Result<ControlFile, MeshError> {
        let mut file = load(&input.file)?;
        file.mesh.name.clone_from(&input.name);
        if let Some(degrees) = self.crease_degrees {
            file.mesh.sharpen(degrees, FOREVER_SHARP);
        }
        Ok(file)
    }

    /// Its levels.
    ///
    /// # Errors
    /// What cannot be subdivided.
    pub fn bake(&self, file: &ControlFile, progress: &mut Asked<'_>) -> Result<Chain, SubdivideError> {
        self.plan.bake(&file.mesh, progress)
    }

    /// What its method is called.
    pub fn method(&self, file: &ControlFile) -> String {
        self.plan.scheme.unwrap_or(Scheme::of(&file.mesh)).to_string()
    }
}

/// What there is to say of a file.
pub fn findings(found: &[Finding]) -> Vec<String> {
    found.iter().map(ToString::to_string).collect()
}

fn angle(text: &str) -> Result<f64, String> {
    let degrees = text.parse().ok().filter(|degrees| (0.0..=180.0).contains(degrees));
    degrees.ok_or_else(|| "must be an angle from 0 to 180 degrees".to_owned())
}
