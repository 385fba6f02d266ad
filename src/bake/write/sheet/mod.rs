//! Contact sheets: the levels of objects side by side, since a look tells what numbers do not.
//!
//! A sheet is one SVG that needs nothing else. Every level is a tile: all of it in the same three-quarter view, below
//! that the place where the coarsest level differs most from the finest, and what was counted and measured. Meshes are
//! drawn in grey clay by a small rasteriser of our own, with their edges where triangles are large enough on the tile
//! to be told apart. Back sides are bluish, so that turned triangles and open surfaces show.
//!
//! Y is up, as in glTF. Normals are the mesh's own; where it has none, surfaces are smooth but for edges of more than
//! 80° or so.

mod camera;
mod clay;
mod difference;
mod image;
mod normals;
mod page;
mod raster;
mod sky;

use std::io;

use glam::DVec3;

use self::camera::Camera;
use self::image::Image;
use self::normals::Normals;
use self::page::{Page, Tile};
use self::raster::Frame;
use super::LevelOut;
use crate::bake::mesh::Mesh;

/// The levels of one object.
#[derive(Clone, Copy, Debug)]
pub struct Chain<'a> {
    /// Written above them.
    pub name: &'a str,
    /// Finest first.
    pub levels: &'a [LevelOut<'a>],
}

/// Width and height of a tile.
const TILE_PX: usize = 320;

/// A pixel is so many samples wide and high. More give smoother lines and take longer in the square of it.
const SAMPLES: usize = 2;

/// How much nearer the second look is. With less there is little to see, with more nobody knows where it is.
const ZOOM: usize = 4;

/// A sheet of these objects, one below the other. Each picture costs a look at every triangle and at 640 × 640 samples.
///
/// # Errors
/// What keeps an image from becoming a PNG; nothing is known to.
///
/// # Panics
/// Where a mesh does not [check](Mesh::check).
pub fn svg(chains: &[Chain<'_>]) -> io::Result<String> {
    let mut page = Page::default();
    for chain in chains {
        let tiles = tiles(chain.levels)?;
        page.add(chain.name, diagonal(chain.levels), chain.levels, &tiles);
    }
    Ok(page.finish())
}

/// What an object looks like at one moment.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// What it is drawn as.
    pub mesh: &'a Mesh,
    /// Written below.
    pub caption: &'a str,
    /// Written below that.
    pub about: &'a str,
}

/// A sheet of moments, a row for each of these series, called by its name: what a geomorph does, beside a hard switch.
/// All of a row are seen by the camera of its first, and nearer where the last differs most from it.
///
/// # Errors
/// As [`svg`].
///
/// # Panics
/// As [`svg`].
pub fn moments_svg(rows: &[(&str, &[Moment<'_>])]) -> io::Result<String> {
    let mut page = Page::default();
    for (name, moments) in rows {
        let levels: Vec<LevelOut<'_>> = moments.iter().map(|moment| LevelOut::new(moment.mesh)).collect();
        page.add_moments(name, moments, &tiles(&levels)?);
    }
    Ok(page.finish())
}

/// The picture of a mesh by itself, as a PNG of so many pixels each way (made 1 to 4096).
///
/// # Errors
/// As [`svg`].
///
/// # Panics
/// As [`svg`].
pub fn png(mesh: &Mesh, side_px: usize) -> io::Result<Vec<u8>> {
    let camera = Camera::around(mesh, side_px.clamp(1, 4096) * SAMPLES);
    picture(&Normals::of(mesh), &camera).png()
}

/// All levels as the finest one's camera sees them.
fn tiles(levels: &[LevelOut<'_>]) -> io::Result<Vec<Tile>> {
    let [finest, .., coarsest] = levels else {
        let alone = levels.iter().map(|level| {
            let camera = Camera::around(shown(level), TILE_PX * SAMPLES);
            tile(shown(level), &camera, None)
        });
        return alone.collect();
    };
    let camera = Camera::around(shown(finest), TILE_PX * SAMPLES);
    let seen = |level: &LevelOut<'_>| Frame::of(shown(level), &camera);
    let corner = difference::greatest(&seen(finest), &seen(coarsest), TILE_PX * SAMPLES / ZOOM);
    levels.iter().map(|level| tile(shown(level), &camera, Some(corner))).collect()
}

fn shown<'a>(level: &LevelOut<'a>) -> &'a Mesh {
    level.picture.unwrap_or(level.mesh)
}

/// The direction, from the mesh to the viewer, from which a sheet shows it.
pub fn direction(mesh: &Mesh) -> DVec3 {
    Camera::around(mesh, TILE_PX).back()
}

/// A mesh, and again what lies to the right of and below a corner, nearer.
fn tile(mesh: &Mesh, camera: &Camera, corner: Option<[usize; 2]>) -> io::Result<Tile> {
    let normals = Normals::of(mesh);
    let look = |camera: &Camera| picture(&normals, camera).png();
    let share = |at: usize| at as f64 / (TILE_PX * SAMPLES) as f64;
    Ok(Tile {
        whole: look(camera)?,
        close: corner.map(|corner| look(&camera.nearer(corner, ZOOM))).transpose()?,
        corner: corner.map(|corner| corner.map(share)),
    })
}

fn picture(normals: &Normals<'_>, camera: &Camera) -> Image {
    let frame = Frame::of(normals.mesh, camera);
    let colours = clay::colours(normals, camera, &frame, SAMPLES);
    Image::of_samples(&colours, frame.side, SAMPLES)
}

/// Of the box around the finest level, in object units.
fn diagonal(levels: &[LevelOut<'_>]) -> f64 {
    let bounds = levels.first().map(|level| level.mesh.bounds());
    let full = bounds.filter(|bounds| !bounds.is_empty());
    full.map_or(0.0, |b| (b.max.as_dvec3() - b.min.as_dvec3()).length())
}
