//! The peers that run in node: three.ez's instanced-mesh and three.js by itself. The scripts are in `three/`; this side
//! hands them the scene and the walk in a folder.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde::Deserialize;
use serde_json::json;
use tempfile::TempDir;

use crate::camera::{Bound, Camera, FOV_Y, NEAR, VIEWPORT_PX};
use crate::peer::{Census, Frames, Row};
use crate::scene::Scene;
use crate::tool;

/// A peer as `three/measure.mjs` knows it.
struct Script {
    name: &'static str,
    peer: &'static str,
    bound: Bound,
    /// What an object takes on the heap of node.
    object_bytes: f64,
}

const SCRIPTS: [Script; 2] = [
    Script {
        name: "instanced_mesh",
        peer: "three.ez instanced-mesh, hierarchy and LOD",
        bound: Bound::Cube,
        object_bytes: 1e3,
    },
    Script {
        name: "lod",
        peer: "three.js, LOD.update and frustum test",
        bound: Bound::Sphere,
        object_bytes: 11e3,
    },
];

/// More than a page would ever get.
const HEAP_BYTES: f64 = 4e9;

/// What a run of node answers.
#[derive(Deserialize)]
struct Answer {
    /// Name and version of what ran.
    versions: Vec<(String, String)>,
    times_ns: Vec<f64>,
    census: Census,
}

/// A scene on disk, and what node made of it so far.
pub struct Three {
    folder: TempDir,
    objects: usize,
    /// The runs of each script.
    answers: [Vec<Result<Answer, String>>; SCRIPTS.len()],
}

impl Three {
    pub fn new(scene: &Scene, walk: &[Camera]) -> io::Result<Self> {
        let folder = tempfile::tempdir()?;
        write(scene, walk, folder.path())?;
        Ok(Self { folder, objects: scene.len(), answers: Default::default() })
    }

    /// A process for each script.
    pub fn run(&mut self) {
        for (script, answers) in SCRIPTS.iter().zip(&mut self.answers) {
            answers.push(script.run(self.folder.path(), self.objects));
        }
    }

    pub fn versions(&self) -> Vec<(String, String)> {
        let answers = self.answers.iter().flatten().flatten();
        answers.flat_map(|answer| answer.versions.iter().cloned()).collect()
    }

    /// A row for each script, the times of all its runs together.
    pub fn rows(self) -> Vec<Row> {
        let Self { objects, answers, .. } = self;
        let row = |(script, answers): (&Script, Vec<_>)| {
            let outcome = answers.into_iter().collect::<Result<Vec<_>, _>>().and_then(|a| script.joined(a));
            Row { peer: script.peer.to_owned(), objects, outcome }
        };
        SCRIPTS.iter().zip(answers).map(row).collect()
    }
}

impl Script {
    fn run(&self, folder: &Path, objects: usize) -> Result<Answer, String> {
        let bytes = objects as f64 * self.object_bytes;
        if bytes > HEAP_BYTES {
            return Err(format!("its objects would take {:.0} GB", bytes / 1e9));
        }
        if !tool::home().join("node_modules").is_dir() {
            return Err("its packages are missing (npm ci)".to_owned());
        }
        let heap = format!("--max-old-space-size={:.0}", HEAP_BYTES / 1e6);
        let script = tool::home().join("three/measure.mjs");
        tool::ask("node".as_ref(), &[heap.into(), script, folder.into(), self.name.into()])
    }

    fn joined(&self, answers: Vec<Answer>) -> Result<Frames, String> {
        let census = answers.last().ok_or("it was not run")?.census;
        let times_ns = answers.into_iter().flat_map(|answer| answer.times_ns).collect();
        Ok(Frames { bound: self.bound, times_ns, census, spent: None })
    }
}

/// `scene.json` and `instances.f32`, as `three/scene.mjs` reads them.
fn write(scene: &Scene, walk: &[Camera], folder: &Path) -> io::Result<()> {
    let kinds: Vec<_> = scene
        .kinds
        .iter()
        .map(|kind| json!({"radius": kind.radius, "distances": kind.distances()}))
        .collect();
    let cameras: Vec<_> = walk.iter().map(|c| json!({"eye": c.eye, "yaw": c.yaw, "far": c.far})).collect();
    let lens = json!({
        "fov_y_degrees": f64::from(FOV_Y).to_degrees(),
        "aspect": VIEWPORT_PX[0] / VIEWPORT_PX[1],
        "near": NEAR,
    });
    let scene_json = json!({"kinds": kinds, "cameras": cameras, "lens": lens});
    std::fs::write(folder.join("scene.json"), scene_json.to_string())?;
    let mut file = BufWriter::new(std::fs::File::create(folder.join("instances.f32"))?);
    for instance in &scene.instances {
        let [x, y, z] = instance.center;
        for number in [x, y, z, instance.kind as f32] {
            file.write_all(&number.to_le_bytes())?;
        }
    }
    file.flush()
}
