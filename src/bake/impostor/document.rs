//! An impostor as JSON, for engines: the file beside the levels, and what a level's mesh in a GLB carries.
//!
//! ```json
//! {"format": "lod-budget impostor", "version": 1, "impostor": {"name": "tree", "kind": {"octahedral": {…}}, …}}
//! ```
//! The keys are the fields of [`Impostor`]; vectors are lists of numbers. Unknown and repeated keys are refused, and so is
//! whatever does not fit together.

use std::fmt;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Frame, Impostor, Rectangle};

/// What the key `format` says.
pub const FORMAT: &str = "lod-budget impostor";

/// What the key `version` says.
pub const VERSION: u64 = 1;

/// Why a file is no impostor. Displayed as `FILE: PLACE: RULE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentError {
    /// The file, as the caller named it.
    pub file: String,
    /// Line and column, field or frame at fault; `None` where it is the whole file.
    pub place: Option<String>,
    /// The rule it breaks.
    pub rule: String,
}

impl fmt::Display for DocumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file)?;
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.rule)
    }
}

impl std::error::Error for DocumentError {}

/// What a file must have before anything else is looked at, so that one of another kind is called that.
#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document<T> {
    format: String,
    version: u64,
    impostor: T,
}

/// Place and rule.
type Broken = (String, String);

impl Impostor {
    /// Reads what [`Impostor::to_json`] has written. `file` names it in errors.
    ///
    /// # Errors
    /// Whatever is not as described; frames that overlap in the atlas or are beyond it, axes that are not across each
    /// other, windows of another size than their rectangle, outlines beyond their window, numbers out of range.
    pub fn from_json(bytes: &[u8], file: &str) -> Result<Self, DocumentError> {
        let refused =
            |place: Option<String>, rule: String| DocumentError { file: file.to_owned(), place, rule };
        let malformed = |error: serde_json::Error| {
            let message = error.to_string();
            let place = format!("line {}, column {}", error.line(), error.column());
            let rule = message.split(" at line ").next().unwrap_or_default().to_owned();
            refused(Some(place), rule)
        };
        let header: Header = serde_json::from_slice(bytes).map_err(malformed)?;
        check_header(&header).map_err(|rule| refused(None, rule))?;
        let document: Document<Self> = serde_json::from_slice(bytes).map_err(malformed)?;
        document.impostor.check().map_err(|(place, rule)| refused(Some(place), rule))?;
        Ok(document.impostor)
    }

    /// The impostor as JSON. Equal impostors give equal bytes, and it reads back as the same.
    ///
    /// # Errors
    /// Numbers that are not finite, and whatever else [`Impostor::from_json`] would refuse; the name of the impostor
    /// stands for the file.
    pub fn to_json(&self) -> Result<String, DocumentError> {
        let refused = |place, rule| DocumentError { file: self.name.clone(), place, rule };
        self.check().map_err(|(place, rule)| refused(Some(place), rule))?;
        let text =
            serde_json::to_string_pretty(&self.document()).map_err(|e| refused(None, e.to_string()))?;
        Ok(text + "\n")
    }

    /// As a value, for what a GLB says of a mesh.
    pub(in crate::bake) fn to_value(&self) -> Value {
        // Keys are strings, and numbers that JSON cannot hold become null.
        serde_json::to_value(self.document()).unwrap_or_default()
    }

    fn document(&self) -> Document<&Self> {
        Document { format: FORMAT.to_owned(), version: VERSION, impostor: self }
    }

    fn check(&self) -> Result<(), Broken> {
        self.check_numbers()?;
        self.check_validity()?;
        self.check_atlas()?;
        for (i, frame) in self.frames.iter().enumerate() {
            self.check_frame(frame).map_err(|rule| (format!("frame {i}"), rule.to_owned()))?;
        }
        match overlapping(&self.frames, self.atlas.gutter_px) {
            Some([a, b]) => {
                Err((format!("frame {b}"), format!("it must be clear of frame {a} and its gutter")))
            }
            None => Ok(()),
        }
    }

    fn check_numbers(&self) -> Result<(), Broken> {
        let at_least_0 = |x: f64| x.is_finite() && x >= 0.0;
        let girth = at_least_0(self.girth) && self.girth <= self.radius * (1.0 + TOLERANCE);
        first_broken([
            ("kind", self.kind.check().is_ok(), self.kind.check().err().unwrap_or_default()),
            ("center", self.center.is_finite(), "it must be finite"),
            ("radius", self.radius.is_finite() && self.radius > 0.0, "it must be finite and above 0"),
            ("girth", girth, "it must be from 0 to the radius"),
            (
                "front",
                are_axes(self.up, self.front),
                "up and front must be of length 1 and across each other",
            ),
            ("cover", self.cover.into_iter().all(at_least_0), "it must be finite and not negative"),
            ("error", at_least_0(self.error), "it must be finite and not negative"),
            ("rms", at_least_0(self.rms), "it must be finite and not negative"),
            ("fill", at_least_0(self.fill), "it must be finite and not negative"),
        ])
    }

    fn check_validity(&self) -> Result<(), Broken> {
        let valid = &self.validity;
        let [low, high] = valid.elevation_deg;
        let yaw = valid.yaw_deg > 0.0 && valid.yaw_deg <= 180.0;
        let nearest = valid.nearest.is_finite() && valid.nearest > self.radius;
        let size = valid.size_px.is_finite() && valid.size_px > 0.0;
        first_broken([
            ("validity", -90.0 <= low && low <= high && high <= 90.0, "elevations must rise, from -90 to 90"),
            ("validity", yaw, "yaw_deg must be above 0, to 180"),
            ("validity", nearest, "nearest must be finite and beyond the radius"),
            ("validity", size, "size_px must be finite and above 0"),
        ])
    }

    fn check_atlas(&self) -> Result<(), Broken> {
        let atlas = &self.atlas;
        let sides = [atlas.width_px, atlas.height_px].iter().all(|side| (1..=MOST_PX).contains(side));
        let gutter = atlas.mips <= 6 && atlas.gutter_px == 1 << atlas.mips;
        let density = atlas.texels_per_unit.is_finite() && atlas.texels_per_unit > 0.0;
        first_broken([
            ("atlas", sides, "its sides must be from 1 to 65536 pixels"),
            ("atlas", gutter, "mips must be at most 6, and gutter_px 2 to their power"),
            ("atlas", density, "texels_per_unit must be finite and above 0"),
            ("frames", self.frames.len() == self.kind.frame_count(), "there must be as many as the kind has"),
        ])
    }

    /// The first rule that a frame breaks by itself.
    fn check_frame(&self, frame: &Frame) -> Result<(), &'static str> {
        let Frame { direction, right, up, window, depth: [least, most], rectangle_px, outline } = frame;
        let axes = are_axes(*right, *up) && right.cross(*up).distance(*direction) < TOLERANCE;
        let texels = (window.max - window.min) * self.atlas.texels_per_unit;
        let is_near =
            |texels: f64, px: u32| (texels - f64::from(px)).abs() < TOLERANCE * f64::from(px.max(1));
        let fits = is_near(texels.x, rectangle_px.width) && is_near(texels.y, rectangle_px.height);
        let slack = TOLERANCE * self.radius;
        let inside =
            |&p: &glam::DVec2| p.cmpge(window.min - slack).all() && p.cmple(window.max + slack).all();
        let rules = [
            (axes, "right, up and direction must be of length 1 and across each other"),
            (least <= most && least.is_finite() && most.is_finite(), "depths must be finite and rise"),
            (self.holds(rectangle_px), "its rectangle must have pixels, and be in the atlas with its gutter"),
            (fits, "its window must have the size of its rectangle"),
            ((3..=8).contains(&outline.len()), "its outline must have 3 to 8 corners"),
            (outline.iter().all(inside), "its outline must be in its window"),
        ];
        rules.into_iter().find(|(holds, _)| !holds).map_or(Ok(()), |(_, rule)| Err(rule))
    }

    fn holds(&self, rectangle: &Rectangle) -> bool {
        let gutter = u64::from(self.atlas.gutter_px);
        let fits = |from: u32, length: u32, side: u32| {
            let (from, length) = (u64::from(from), u64::from(length));
            length > 0 && from >= gutter && from + length + gutter <= u64::from(side)
        };
        fits(rectangle.x, rectangle.width, self.atlas.width_px)
            && fits(rectangle.y, rectangle.height, self.atlas.height_px)
    }
}

/// More than any graphics card has.
const MOST_PX: u32 = 1 << 16;

/// How far lengths and angles may be off, as a share: files are written by others, too.
const TOLERANCE: f64 = 1e-6;

fn check_header(header: &Header) -> Result<(), String> {
    if header.format != FORMAT {
        return Err(format!("its \"format\" must be \"{FORMAT}\", not \"{}\"", header.format));
    }
    if header.version != VERSION {
        return Err(format!("its \"version\" must be {VERSION}, not {}", header.version));
    }
    Ok(())
}

fn first_broken<const N: usize>(rules: [(&str, bool, &str); N]) -> Result<(), Broken> {
    match rules.into_iter().find(|(_, holds, _)| !holds) {
        Some((place, _, rule)) => Err((place.to_owned(), rule.to_owned())),
        None => Ok(()),
    }
}

fn are_axes(a: DVec3, b: DVec3) -> bool {
    let is_unit = |v: DVec3| (v.length() - 1.0).abs() < TOLERANCE;
    is_unit(a) && is_unit(b) && a.dot(b).abs() < TOLERANCE
}

/// Two frames, the lower first, one of which is in the other's gutter. At most some thousand frames are compared, each
/// with those that begin left of its end.
fn overlapping(frames: &[Frame], gutter: u32) -> Option<[usize; 2]> {
    let reach =
        |from: u32, length: u32| [u64::from(from), u64::from(from) + u64::from(length) + u64::from(gutter)];
    let mut order: Vec<usize> = (0..frames.len()).collect();
    order.sort_by_key(|&i| (frames[i].rectangle_px.x, i));
    let spans = |i: usize, r: &Rectangle| (i, reach(r.x, r.width), reach(r.y, r.height));
    let spans: Vec<_> = order.into_iter().map(|i| spans(i, &frames[i].rectangle_px)).collect();
    spans.iter().enumerate().find_map(|(at, (i, x, y))| {
        let right = spans[at + 1..].iter().take_while(|(_, other, _)| other[0] < x[1]);
        let meets = |(_, _, other): &&(usize, [u64; 2], [u64; 2])| other[0] < y[1] && y[0] < other[1];
        right.into_iter().find(meets).map(|(j, _, _)| [*i.min(j), *i.max(j)])
    })
}
