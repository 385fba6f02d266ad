//! A geomorph to look at and in numbers: how far vertices jump from frame to frame, beside a hard switch.
//!
//! ```text
//! cargo run --release --example geomorph --features bake -- [MESH] [SHEET.svg]
//! ```
//!
//! Every pair of neighbouring levels is switched at the distance where the selector would do it: where the error of the
//! coarser one is a pixel of an image of 1080 lines. Frames are of 1/60 s, and unsteady ones too; every vertex is
//! projected in every frame, from the frame before the transition to the one after it.

use std::error::Error;
use std::f32::consts::FRAC_PI_3;
use std::path::Path;

use glam::{DVec2, DVec3, Vec2, Vec3};
use lod_budget::bake::chain::{Accuracy, Chain, Plan, quietly};
use lod_budget::bake::geomorph::{Fit, Geomorph};
use lod_budget::bake::write::sheet::{Moment, moments_svg};
use lod_budget::bake::{Mesh, read, shapes};
use lod_budget::bounds::Sphere;
use lod_budget::table::{Level, LodTable};
use lod_budget::transition::{Shown, TransitionKind, TransitionOptions};
use lod_budget::view::{Lens, View};

/// As many are shown on the sheet.
const WEIGHTS: [(f32, &str); 5] = [(0.0, "0"), (0.25, "¼"), (0.5, "½"), (0.75, "¾"), (1.0, "1")];

/// How unsteady a frame may be, as shares of 1/60 s: one after the other, over and over.
const UNSTEADY: [f32; 5] = [1.0, 1.4, 0.6, 1.2, 0.8];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut mesh: Mesh = match arguments.next() {
        Some(file) => read::load(Path::new(&file)).map_err(|e| e.to_string())?.mesh,
        None => shapes::torus_knot(400, 24).into(),
    };
    if mesh.normals.is_empty() {
        mesh.normals = smooth_normals(&mesh);
    }
    let chain = Plan { look: None, ..Plan::default() }.bake(&mesh, &mut quietly)?;
    let table = chain.table(Accuracy::default())?;
    let morphs = chain.geomorphs()?;
    report(&chain, &table, &morphs);
    let sheet = arguments.next().unwrap_or_else(|| "geomorph.svg".to_owned());
    std::fs::write(&sheet, contact_sheet(&chain, &morphs)?)?;
    println!("{sheet}");
    Ok(())
}

/// Per wedge, the mean of its position's triangles by area. A mesh should have normals before it is baked: they morph,
/// while normals that are made of the triangles of each frame turn at once where triangles collapse.
fn smooth_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; mesh.positions.len()];
    for corners in mesh.surface().triangles {
        let [a, b, c] = corners.map(|position| mesh.positions[position as usize]);
        corners.iter().for_each(|&position| sums[position as usize] += (b - a).cross(c - a));
    }
    mesh.wedges.iter().map(|&position| sums[position as usize].normalize_or_zero()).collect()
}

/// A line per pair of levels.
fn report(chain: &Chain, table: &LodTable, morphs: &[Geomorph]) {
    println!("                               largest jump of a vertex in a frame, px              energy");
    println!("levels  triangles  fit      bound    hard  geomorph   share  unsteady   share    px · px²");
    let mut worst: f64 = 0.0;
    for (i, morph) in morphs.iter().enumerate() {
        let eye = Eye::of_switch(table, i);
        let levels = [Level(i as u8), Level(i as u8 + 1)];
        let jump = |shares| eye.largest_jump_px(morph, &chain.levels[i].mesh, levels, shares);
        let hard_px = eye.jump_px(&chain.levels[i].mesh, &morph.target);
        let (steady_px, unsteady_px) = (jump(&[1.0]), jump(&UNSTEADY));
        let pop = morph.movement.pop(&eye.lens, &eye.bounds, 1.0);
        worst = worst.max(steady_px / hard_px);
        println!(
            "{:>2} → {:<2}{:>10}  {:<7}{:>7.2}{hard_px:>8.2}{steady_px:>10.3}  1/{:<5.1}{unsteady_px:>9.3}   1/{:<5.1}{:>9.2e}",
            levels[0].0,
            levels[1].0,
            chain.levels[i].triangles(),
            if morph.fit == Fit::Exact { "exact" } else { "nearest" },
            pop.max_px,
            hard_px / steady_px,
            hard_px / unsteady_px,
            pop.energy_px3,
        );
    }
    println!("At 60 Hz a geomorph's largest jump is at most 1/{:.2} of the hard switch's.", 1.0 / worst);
}

/// A camera before an object.
struct Eye {
    lens: Lens,
    /// The object's, before the camera.
    bounds: Sphere,
    /// The middle of the object, in its own units.
    center: DVec3,
}

impl Eye {
    /// A camera of 1080 lines as far away as a level is switched to the next, but no nearer than the object's diameter:
    /// the finest levels are switched when the camera is all but inside.
    fn of_switch(table: &LodTable, level: usize) -> Self {
        let lens = View::perspective(FRAC_PI_3, Vec2::new(1920.0, 1080.0)).lens(DVec3::ZERO);
        let Sphere { center, radius } = table.bounds();
        let size_px = table.levels()[level].min_size.unwrap_or(1.0) * 1080.0;
        let distance = (2.0 * radius * lens.scale_px / size_px).max(2.0 * radius);
        let bounds = Sphere::new(Vec3::new(0.0, 0.0, -distance), radius);
        Self { lens, bounds, center: center.as_dvec3() }
    }

    /// Where a point is in the image, in pixels, with the object turned so that we look along an axis of it.
    fn pixel(&self, point: Vec3, axis: usize) -> DVec2 {
        let at = point.as_dvec3() - self.center;
        let depth = -f64::from(self.bounds.center.z) + at[axis];
        DVec2::new(at[(axis + 1) % 3], at[(axis + 2) % 3]) * (f64::from(self.lens.scale_px) / depth)
    }

    /// How far the vertex jumps that jumps farthest, seen along any axis.
    fn jump_px(&self, before: &Mesh, now: &Mesh) -> f64 {
        let ways = || before.positions.iter().zip(&now.positions);
        let jumps = (0..3).flat_map(|axis| {
            ways().map(move |(&a, &b)| self.pixel(a, axis).distance_squared(self.pixel(b, axis)))
        });
        jumps.fold(0.0, f64::max).sqrt()
    }

    /// The largest jump between two frames of a transition, to the coarser level or back. The frame before the first
    /// shows the old level, the one after the last the new one. Frames take these shares of 1/60 s.
    fn largest_jump_px(&self, morph: &Geomorph, finer: &Mesh, levels: [Level; 2], shares: &[f32]) -> f64 {
        let [to_coarser, to_finer] = [[0, 1], [1, 0]].map(|way| weights(way.map(|i| levels[i]), shares));
        let largest = |weights: Vec<f32>| {
            let mut before = morph.at(finer, weights[0]);
            let mut most: f64 = 0.0;
            for &weight in &weights[1..] {
                let now = morph.at(finer, weight);
                most = most.max(self.jump_px(&before, &now));
                before = now;
            }
            most
        };
        largest(to_coarser).max(largest(to_finer))
    }
}

/// The morph's weights of all frames of a transition, with that of the old level before and that of the new one behind.
fn weights([from, to]: [Level; 2], shares: &[f32]) -> Vec<f32> {
    let options = TransitionOptions { kind: TransitionKind::Geomorph, ..TransitionOptions::default() };
    let ends = if to > from { [0.0, 1.0] } else { [1.0, 0.0] };
    let mut weights = vec![ends[0]];
    let mut shown = Shown::steady(from).towards(to);
    for share in shares.iter().cycle() {
        if !shown.is_in_flight() {
            break;
        }
        weights.push(shown.morph().weight);
        shown = shown.advanced(share * 1000.0 / 60.0, &options);
    }
    weights.push(ends[1]);
    weights
}

/// Two levels near the end of the chain, where there is something to see.
fn contact_sheet(chain: &Chain, morphs: &[Geomorph]) -> Result<String, Box<dyn Error>> {
    let coarser = chain.levels.len().saturating_sub(3).max(1).min(morphs.len());
    let finer = coarser.saturating_sub(1);
    let (fine, coarse) = (&chain.levels[finer].mesh, &chain.levels[coarser].mesh);
    let morph = chain.geomorph(finer, coarser)?;
    let meshes: Vec<Mesh> = WEIGHTS.iter().map(|&(weight, _)| morph.at(fine, weight)).collect();
    let captions = WEIGHTS.map(|(_, name)| format!("weight {name}"));
    let ways =
        WEIGHTS.map(|(weight, _)| format!("up to {:.4} units on the way", weight * morph.movement.max));
    let moments: Vec<Moment<'_>> = (0..WEIGHTS.len())
        .map(|i| Moment { mesh: &meshes[i], caption: &captions[i], about: &ways[i] })
        .collect();
    let hard: Vec<Moment<'_>> = WEIGHTS
        .iter()
        .map(|&(weight, _)| match weight < 0.5 {
            true => Moment { mesh: fine, caption: "finer", about: "" },
            false => Moment { mesh: coarse, caption: "coarser", about: "" },
        })
        .collect();
    let name = |kind: &str| {
        let counts = [fine, coarse].map(|mesh| mesh.triangles.len());
        format!("{kind}: level {finer} to level {coarser}, {} to {} triangles", counts[0], counts[1])
    };
    Ok(moments_svg(&[(&name("Geomorph"), &moments), (&name("Hard switch"), &hard)])?)
}
