//! Plots of a line per policy with the legend beside them: how the frames are distributed.

use std::ops::Range;

use lod_budget::sim::{Comparison, PolicyResult};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::style::{self, Area, Chart, FAINT, GRID, INK, Stroke, WIDTH};
use crate::compare::summary::Summary;
use crate::text::plain;

const HEIGHT: u32 = 420;
/// Height of the title and width of the legend in px.
const TITLE: u32 = 36;
const LEGEND: u32 = 190;

/// A line has so many points.
const POINTS: usize = 400;

/// Where a plot of shares of the budget ends, unless one frame in a hundred of a competing policy takes longer.
const CUT: f64 = 3.0;

/// A line per policy.
struct Curves {
    title: String,
    x: Axis,
    y: Axis,
    lines: Vec<Line>,
    /// A vertical line, and what it says.
    mark: Option<(f64, &'static str)>,
}

struct Axis {
    name: &'static str,
    range: Range<f64>,
}

struct Line {
    name: &'static str,
    stroke: Stroke,
    points: Vec<(f64, f64)>,
}

/// The share of frames that take up to so much of the budget.
pub fn time_over_budget(summary: &Summary, comparison: &Comparison) -> anyhow::Result<String> {
    let line = |result: &PolicyResult| {
        let shares = result.rows.iter().map(|r| r.time_us / comparison.budget_us);
        let flip = |(percent, share): (f64, f64)| (share, percent);
        line(result, quantiles(shares.collect()).into_iter().map(flip).collect())
    };
    let lines: Vec<Line> = comparison.policies.iter().map(line).collect();
    let longest = lines.iter().flat_map(|l| &l.points).map(|p| p.0).fold(1.0, f64::max);
    let shortest = lines.iter().flat_map(|l| &l.points).map(|p| p.0).fold(1.0, f64::min);
    let p99 = |r: &&PolicyResult| r.metrics.frame_ms.p99 * 1e3 / comparison.budget_us;
    let cut = style::competing(comparison).iter().map(p99).fold(CUT, f64::max);
    Curves {
        title: format!("How long frames take in '{}'{}", plain(&summary.scene), assumed(summary)),
        x: Axis { name: "frame time ÷ budget", range: (shortest * 0.95)..(longest.min(cut) * 1.02) },
        y: Axis { name: "frames that take no longer, %", range: 0.0..101.0 },
        lines,
        mark: Some((1.0, "budget")),
    }
    .svg()
}

/// How much of the attainable gain the frames get, the worst frames first.
pub fn gain_over_bound(summary: &Summary, comparison: &Comparison) -> anyhow::Result<String> {
    let gains = |result: &PolicyResult| {
        let gains = result.rows.iter().filter_map(|r| r.gain_over_bound).map(|g| g * 100.0);
        line(result, quantiles(gains.collect()))
    };
    let lines: Vec<Line> = style::competing(comparison).into_iter().map(gains).collect();
    let least = lines.iter().flat_map(|l| &l.points).map(|p| p.1).fold(90.0, f64::min).max(0.0);
    Curves {
        title: format!("How well frames spend their time in '{}'{}", plain(&summary.scene), assumed(summary)),
        x: Axis { name: "frames, worst first, %", range: 0.0..100.0 },
        y: Axis { name: "gain ÷ certified bound, %", range: ((least / 10.0).floor() * 10.0)..101.0 },
        lines,
        mark: None,
    }
    .svg()
}

fn assumed(summary: &Summary) -> &'static str {
    if summary.assumed_tables > 0 { ", levels assumed" } else { "" }
}

fn line(result: &PolicyResult, points: Vec<(f64, f64)>) -> Line {
    Line { name: result.policy.name(), stroke: style::stroke(result.policy), points }
}

/// Percent of values, and the value that so many are not above. Nothing of nothing.
fn quantiles(mut values: Vec<f64>) -> Vec<(f64, f64)> {
    values.sort_unstable_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return Vec::new() };
    let steps = last.clamp(1, POINTS);
    (0..=steps).map(|i| (100.0 * i as f64 / steps as f64, values[last * i / steps])).collect()
}

impl Curves {
    fn svg(&self) -> anyhow::Result<String> {
        let mut svg = String::new();
        let root = SVGBackend::with_string(&mut svg, (WIDTH, HEIGHT)).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, body) = root.split_vertically(TITLE);
        let (plot, legend) = body.split_horizontally(WIDTH - LEGEND);
        style::write(&head, &self.title, (64, 18), HPos::Left, style::font(17, INK))?;
        self.draw_plot(&plot)?;
        self.draw_legend(&legend)?;
        root.present()?;
        drop((root, head, body, plot, legend));
        Ok(svg)
    }

    fn draw_plot(&self, area: &Area<'_>) -> anyhow::Result<()> {
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(44)
            .y_label_area_size(56)
            .build_cartesian_2d(self.x.range.clone(), self.y.range.clone())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(GRID)
            .axis_style(FAINT)
            .label_style(style::font(12, INK))
            .axis_desc_style(style::font(13, INK))
            .x_label_formatter(&style::label)
            .y_label_formatter(&style::label)
            .x_labels(12)
            .y_labels(8)
            .x_desc(self.x.name)
            .y_desc(self.y.name)
            .draw()?;
        if let Some(mark) = self.mark {
            self.draw_mark(&mut chart, mark)?;
        }
        // Dashes last: they show on top of a solid line, and it shows through them.
        let (solid, dashed): (Vec<_>, Vec<_>) = self.lines.iter().partition(|l| l.stroke.dash.is_none());
        solid.into_iter().chain(dashed).try_for_each(|line| self.draw_line(&mut chart, line))
    }

    fn draw_mark(&self, chart: &mut Chart<'_, '_>, (x, name): (f64, &'static str)) -> anyhow::Result<()> {
        let Range { start, end } = self.y.range;
        chart.draw_series(DashedLineSeries::new([(x, start), (x, end)], 6, 4, INK.stroke_width(1)))?;
        let at = (x, start + (end - start) * 0.05);
        chart.draw_series([EmptyElement::at(at) + Text::new(name, (5, 0), style::font(12, INK))])?;
        Ok(())
    }

    fn draw_line(&self, chart: &mut Chart<'_, '_>, line: &Line) -> anyhow::Result<()> {
        let inside = |p: &(f64, f64)| p.0 <= self.x.range.end && p.1 >= self.y.range.start;
        let points: Vec<(f64, f64)> = line.points.iter().copied().filter(inside).collect();
        let style = line.stroke.color.stroke_width(line.stroke.width);
        match line.stroke.dash {
            Some((dash, gap)) => chart.draw_series(DashedLineSeries::new(points, dash, gap, style))?,
            None => chart.draw_series(LineSeries::new(points, style))?,
        };
        Ok(())
    }

    fn draw_legend(&self, area: &Area<'_>) -> anyhow::Result<()> {
        for (i, line) in self.lines.iter().enumerate() {
            let y = 24 + 24 * i as i32;
            style::sample(area, (4, y), 36, line.stroke)?;
            style::write(area, line.name, (48, y), HPos::Left, style::font(13, INK))?;
        }
        Ok(())
    }
}
