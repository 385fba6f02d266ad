//! How to make an impostor, and from where it may be looked at.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Atlas, AtlasOptions, ImpostorError, Kind, Outline};

/// How to make an impostor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What is drawn.
    pub kind: Kind,
    /// The axis, of any length that is not 0.
    pub up: DVec3,
    /// The projected diameter of the object, in pixels, up to which the impostor is to be used: a texel is a pixel
    /// there. 8 to 4096. The atlas grows with its square. Where it gets too large, texels do.
    pub size_px: f64,
    /// The nearest viewer, in radii from the middle: 2 to 1e6. What is nearer than the middle looks larger than in a
    /// picture taken from infinitely far, so the error grows as 1 / distance. An object is 64 px high at 29 radii, in an
    /// image of 1080 lines and 60°.
    pub nearest_radii: f64,
    /// From how far below to how far above the horizon the error is to hold: −89 to 89, for octahedral impostors and
    /// cross-quads with a horizontal quad −90 to 90.
    pub elevation_deg: [f64; 2],
    /// How far to either side of the front it is to hold, above 0 and at most 180. Billboards alone heed it; their frames
    /// are spread over it.
    pub yaw_deg: f64,
    /// What quads are cut to.
    pub outline: Outline,
    /// How the frames are put together.
    pub atlas: AtlasOptions,
}

impl Options {
    /// What is usual for a kind: +Y up, 64 px, from 20 radii on, all around; elevations of ±30° for what gets flat from
    /// above, from −10° for a hemisphere, else all; outlines cut, and rectangles for octahedral impostors, whose quad
    /// has to cover three frames.
    pub fn new(kind: Kind) -> Self {
        let (elevation_deg, outline) = match kind {
            Kind::Billboard { .. } | Kind::CrossQuads { horizontal: false, .. } => {
                ([-30.0, 30.0], Outline::Polygon)
            }
            Kind::CrossQuads { horizontal: true, .. } => ([-90.0, 90.0], Outline::Polygon),
            Kind::Octahedral { hemisphere: true, .. } => ([-10.0, 90.0], Outline::Rectangle),
            Kind::Octahedral { hemisphere: false, .. } => ([-90.0, 90.0], Outline::Rectangle),
        };
        let atlas = AtlasOptions::default();
        Self {
            kind,
            up: DVec3::Y,
            size_px: 64.0,
            nearest_radii: 20.0,
            elevation_deg,
            yaw_deg: 180.0,
            outline,
            atlas,
        }
    }

    /// Whether all is in range.
    ///
    /// # Errors
    /// [`ImpostorError::Options`] with the first rule that is broken.
    pub fn check(&self) -> Result<(), ImpostorError> {
        let [low, high] = self.elevation_deg;
        let most = self.most_elevation_deg();
        let rules = [
            (self.up.try_normalize().is_some(), "the axis must be finite and not 0".to_owned()),
            ((8.0..=4096.0).contains(&self.size_px), "the size must be from 8 to 4096 pixels".to_owned()),
            (
                (2.0..=1e6).contains(&self.nearest_radii),
                "the nearest viewer must be 2 to 1e6 radii off".to_owned(),
            ),
            (
                -most <= low && low <= high && high <= most,
                format!("elevations must rise, and be from -{most} to {most} degrees"),
            ),
            (
                self.yaw_deg > 0.0 && self.yaw_deg <= 180.0,
                "the yaw must be above 0, to 180 degrees".to_owned(),
            ),
        ];
        self.kind.check().map_err(|rule| ImpostorError::Options(rule.to_owned()))?;
        self.atlas.check().map_err(|rule| ImpostorError::Options(rule.to_owned()))?;
        match rules.into_iter().find(|(holds, _)| !holds) {
            Some((_, rule)) => Err(ImpostorError::Options(rule)),
            None => Ok(()),
        }
    }

    /// Where something is left to be seen.
    fn most_elevation_deg(&self) -> f64 {
        match self.kind {
            Kind::Billboard { .. } | Kind::CrossQuads { horizontal: false, .. } => 89.0,
            _ => 90.0,
        }
    }

    pub(super) fn validity(&self, radius: f64, atlas: &Atlas) -> Validity {
        let yaw_deg = if self.kind.stands() { 180.0 } else { self.yaw_deg };
        Validity {
            elevation_deg: self.elevation_deg,
            yaw_deg,
            nearest: self.nearest_radii * radius,
            size_px: 2.0 * radius * atlas.texels_per_unit,
        }
    }
}

/// From where an impostor may be looked at for its error to hold.
///
/// Beyond it nothing breaks, but the error grows: [`Impostor::error_at`](super::Impostor::error_at) says how far, for
/// any view. From above, what is upright vanishes: [`Impostor::facing`](super::Impostor::facing) says how much of it is
/// left. A runtime shows the level before instead; one that cannot, lets it fade.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Validity {
    /// Lowest and highest direction of the viewer above the horizon, −90 to 90.
    pub elevation_deg: [f64; 2],
    /// To either side of the front, up to 180, which is all around.
    pub yaw_deg: f64,
    /// The least distance from the middle, in object units.
    pub nearest: f64,
    /// The projected diameter of the bound, in pixels, at which a texel is a pixel. Larger, it gets blurred.
    pub size_px: f64,
}
