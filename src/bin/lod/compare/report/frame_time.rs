//! Frame time over the path: a panel per policy, all on the same scales.

use std::ops::Range;

use lod_budget::sim::{Comparison, PolicyResult, Reference};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::style::{self, Area, BAND, Chart, FAINT, GRID, INK, Stroke, WIDTH};
use crate::compare::summary::Summary;
use crate::text::{percent, plain};

/// Heights in px: what is above the panels, a panel, what is below.
const TOP: u32 = 64;
const PANEL: u32 = 150;
const BOTTOM: u32 = 48;
/// Room for the labels of the vertical axis, and to the right of the panels, in px.
const LEFT: u32 = 64;
const RIGHT: u32 = 20;

/// Frames of a path are drawn as so many columns at most: lowest, mean and highest of the frames in each.
const COLUMNS: usize = 600;

/// Panels are cut at so many times the budget (or the dearest coarsest frame), so that one hitch hides nothing else.
const CUT: f64 = 2.5;

/// Everything in a panel but the policy.
struct Scene<'a> {
    budget_ms: f64,
    fps: f64,
    references: &'a [Reference],
    time_s: Range<f64>,
    frame_ms: Range<f64>,
}

pub fn svg(summary: &Summary, comparison: &Comparison) -> anyhow::Result<String> {
    let shown = style::competing(comparison);
    let height = TOP + PANEL * shown.len() as u32 + BOTTOM;
    let scene = Scene {
        budget_ms: summary.budget_ms,
        fps: summary.camera.fps,
        references: &comparison.references,
        time_s: 0.0..(comparison.references.len() as f64 / summary.camera.fps),
        frame_ms: 0.0..highest_ms(summary, comparison, &shown),
    };
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, panels) = root.split_vertically(TOP);
    draw_head(&head, summary)?;
    let mut rest = panels;
    for (i, result) in shown.iter().enumerate() {
        let is_last = i + 1 == shown.len();
        let (panel, below) = rest.split_vertically(PANEL + if is_last { BOTTOM } else { 0 });
        draw_panel(&panel, &scene, result, is_last)?;
        rest = below;
    }
    root.present()?;
    drop((root, head, rest));
    Ok(svg)
}

/// Where the vertical axis ends.
fn highest_ms(summary: &Summary, comparison: &Comparison, shown: &[&PolicyResult]) -> f64 {
    let highest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max) / 1e3;
    let times = highest(&mut shown.iter().flat_map(|r| &r.rows).map(|r| r.time_us));
    let coarsest = highest(&mut comparison.references.iter().map(|r| r.coarsest_us));
    times.min(CUT * coarsest.max(summary.budget_ms)).max(1.3 * summary.budget_ms) * 1.05
}

/// Title and legend.
fn draw_head(area: &Area<'_>, summary: &Summary) -> anyhow::Result<()> {
    let title = format!(
        "Frame time over the path '{}' in '{}', machine {}{}",
        plain(&summary.path),
        plain(&summary.scene),
        summary.machine,
        if summary.assumed_tables > 0 { ", levels assumed" } else { "" }
    );
    style::write(area, &title, (LEFT as i32, 18), HPos::Left, style::font(17, INK))?;
    let y = 46;
    let label = |text: &str, x: i32| style::write(area, text, (x, y), HPos::Left, style::font(13, INK));
    let mut x = LEFT as i32;
    area.draw(&Rectangle::new([(x, y - 6), (x + 26, y + 6)], BAND.filled()))?;
    label("from all coarsest to all finest", x + 32)?;
    x += 250;
    style::sample(area, (x, y), 26, BUDGET)?;
    label("budget", x + 32)?;
    x += 110;
    area.draw(&Rectangle::new([(x, y - 6), (x + 26, y + 6)], FAINT.mix(0.3).filled()))?;
    style::sample(area, (x, y), 26, Stroke { color: FAINT, width: 2, dash: None })?;
    label("frames: mean, lowest and highest of neighbours", x + 32)
}

const BUDGET: Stroke = Stroke { color: INK, width: 1, dash: Some((6, 4)) };

fn draw_panel(
    area: &Area<'_>,
    scene: &Scene<'_>,
    result: &PolicyResult,
    is_last: bool,
) -> anyhow::Result<()> {
    let mut chart = ChartBuilder::on(area)
        .margin_top(8)
        .margin_bottom(8)
        .margin_right(RIGHT)
        .y_label_area_size(LEFT)
        .x_label_area_size(if is_last { BOTTOM } else { 0 })
        .build_cartesian_2d(scene.time_s.clone(), scene.frame_ms.clone())?;
    draw_band(&mut chart, scene)?;
    draw_axes(&mut chart, is_last)?;
    draw_frames(&mut chart, scene, result)?;
    let ends = [scene.time_s.start, scene.time_s.end].map(|t| (t, scene.budget_ms));
    chart.draw_series(DashedLineSeries::new(ends, 6, 4, BUDGET.color.stroke_width(1)))?;
    let (left, right) = (LEFT as i32 + 10, (WIDTH - RIGHT) as i32 - 10);
    let m = &result.metrics;
    let numbers =
        format!("tracking {} %, missed {} %", percent(m.tracking_over_budget, 1), percent(m.missed, 1));
    let name = style::font(14, style::stroke(result.policy).color);
    style::write(area, result.policy.name(), (left, 20), HPos::Left, name)?;
    style::write(area, &numbers, (right, 20), HPos::Right, style::font(12, FAINT))
}

fn draw_axes(chart: &mut Chart<'_, '_>, is_last: bool) -> anyhow::Result<()> {
    let mut mesh = chart.configure_mesh();
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(FAINT)
        .label_style(style::font(12, INK))
        .axis_desc_style(style::font(13, INK))
        .y_labels(4)
        .x_label_formatter(&style::label)
        .y_label_formatter(&style::label)
        .y_desc("frame, ms");
    if is_last {
        mesh.x_labels(12).x_desc("time on the path, s");
    } else {
        mesh.x_labels(12);
    }
    Ok(mesh.draw()?)
}

fn draw_band(chart: &mut Chart<'_, '_>, scene: &Scene<'_>) -> anyhow::Result<()> {
    let lower = columns(scene, |i| scene.references[i].coarsest_us / 1e3);
    let upper = columns(scene, |i| scene.references[i].finest_us / 1e3);
    draw_between(
        chart,
        lower.iter().map(|c| (c.time_s, c.mean)),
        upper.iter().map(|c| (c.time_s, c.mean)),
        BAND.filled(),
    )
}

fn draw_frames(chart: &mut Chart<'_, '_>, scene: &Scene<'_>, result: &PolicyResult) -> anyhow::Result<()> {
    let color = style::stroke(result.policy).color;
    let columns = columns(scene, |i| result.rows[i].time_us / 1e3);
    let lowest = columns.iter().map(|c| (c.time_s, c.lowest));
    let highest = columns.iter().map(|c| (c.time_s, c.highest));
    draw_between(chart, lowest, highest, color.mix(0.35).filled())?;
    chart.draw_series(LineSeries::new(columns.iter().map(|c| (c.time_s, c.mean)), color.stroke_width(1)))?;
    Ok(())
}

/// Fills what lies between two lines.
fn draw_between(
    chart: &mut Chart<'_, '_>,
    lower: impl Iterator<Item = (f64, f64)>,
    upper: impl DoubleEndedIterator<Item = (f64, f64)>,
    style: ShapeStyle,
) -> anyhow::Result<()> {
    let outline: Vec<(f64, f64)> = lower.chain(upper.rev()).collect();
    chart.draw_series([Polygon::new(outline, style)])?;
    Ok(())
}

/// Neighbouring frames in one.
struct Column {
    time_s: f64,
    lowest: f64,
    mean: f64,
    highest: f64,
}

/// Gathers frames into columns, cut at the end of the axis.
fn columns(scene: &Scene<'_>, value: impl Fn(usize) -> f64) -> Vec<Column> {
    let frames = scene.references.len();
    let count = frames.min(COLUMNS);
    let column = |c: usize| {
        let members = frames * c / count..frames * (c + 1) / count;
        let values = || members.clone().map(|i| value(i).min(scene.frame_ms.end));
        Column {
            time_s: (members.start + members.end - 1) as f64 / 2.0 / scene.fps,
            lowest: values().fold(f64::INFINITY, f64::min),
            mean: values().sum::<f64>() / members.len() as f64,
            highest: values().fold(0.0, f64::max),
        }
    };
    (0..count).map(column).collect()
}
