//! How plots look: colours, fonts, lines and their legend.

use lod_budget::sim::{Comparison, Policy, PolicyResult};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Text, axes and grids.
pub const INK: RGBColor = RGBColor(0x22, 0x22, 0x22);
pub const FAINT: RGBColor = RGBColor(0x66, 0x66, 0x66);
pub const GRID: RGBColor = RGBColor(0xe2, 0xe2, 0xe2);
/// What lies between the coarsest and the finest.
pub const BAND: RGBColor = RGBColor(0xec, 0xec, 0xec);

/// The width of every plot in px.
pub const WIDTH: u32 = 1000;

/// How the line of a policy is drawn.
#[derive(Clone, Copy)]
pub struct Stroke {
    pub color: RGBColor,
    pub width: u32,
    /// Lengths of dash and gap in px; `None` is a solid line.
    pub dash: Option<(i32, i32)>,
}

/// Colours that colour-blind eyes tell apart, after M. Okabe and K. Ito, "Color Universal Design", 2008; dashes for
/// who prints in grey.
pub fn stroke(policy: Policy) -> Stroke {
    let (color, width, dash) = match policy {
        Policy::Coarsest => (RGBColor(0x99, 0x99, 0x99), 2, None),
        Policy::Finest => (RGBColor(0x00, 0x00, 0x00), 2, None),
        Policy::StaticDefault => (RGBColor(0xe6, 0x9f, 0x00), 2, Some((2, 4))),
        Policy::Static => (RGBColor(0xd5, 0x5e, 0x00), 2, Some((9, 4))),
        Policy::Reactive => (RGBColor(0xcc, 0x79, 0xa7), 2, Some((5, 3))),
        Policy::FunkhouserSequin => (RGBColor(0x00, 0x9e, 0x73), 2, Some((14, 5))),
        Policy::Predictive => (RGBColor(0x00, 0x72, 0xb2), 3, None),
    };
    Stroke { color, width, dash }
}

/// The policies that compete; the ends of the scale where nobody does.
pub fn competing(comparison: &Comparison) -> Vec<&PolicyResult> {
    let competes = |r: &&PolicyResult| !matches!(r.policy, Policy::Coarsest | Policy::Finest);
    let found: Vec<&PolicyResult> = comparison.policies.iter().filter(competes).collect();
    if found.is_empty() { comparison.policies.iter().collect() } else { found }
}

/// Sizes are the backend's: it divides them by 1.24 to get px.
pub fn font(px: u32, color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", f64::from(px) * 1.24).into_font().color(&color)
}

/// A number at an axis, without zeros that say nothing.
pub fn label(value: &f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Text that begins, or ends, at half its height at `at`.
pub fn write(
    area: &Area<'_>,
    text: &str,
    at: (i32, i32),
    from: HPos,
    style: TextStyle<'_>,
) -> anyhow::Result<()> {
    let style = style.pos(Pos::new(from, VPos::Center));
    Ok(area.draw_text(text, &style, at)?)
}

/// A short horizontal piece of a line, for legends.
pub fn sample(area: &Area<'_>, (x, y): (i32, i32), length: i32, stroke: Stroke) -> anyhow::Result<()> {
    let style = ShapeStyle::from(stroke.color).stroke_width(stroke.width);
    let (dash, gap) = stroke.dash.unwrap_or((length, 1));
    for start in (0..length).step_by((dash + gap) as usize) {
        let end = (start + dash).min(length);
        area.draw(&PathElement::new(vec![(x + start, y), (x + end, y)], style))?;
    }
    Ok(())
}
