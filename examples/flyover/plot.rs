//! Pictures of a flight.

use std::error::Error;
use std::path::Path;

use plotters::prelude::*;

use crate::Row;
use crate::growth::Point;

type Outcome = Result<(), Box<dyn Error>>;

/// One line of a chart.
struct Line<'a> {
    name: &'a str,
    points: Vec<(f64, f64)>,
}

/// Triangles, changes, µs and errors, one below the other.
pub fn flight(rows: &[Row], path: &Path) -> Outcome {
    let along = |of: &dyn Fn(&Row) -> Option<f64>| -> Vec<(f64, f64)> {
        rows.iter().enumerate().skip(1).filter_map(|(i, row)| Some((i as f64, of(row)?))).collect()
    };
    let every = |name, of: &dyn Fn(&Row) -> f64| Line { name, points: along(&|row| Some(of(row))) };
    let measured =
        |name, i: usize| Line { name, points: along(&|row| row.measured_px.map(|m| f64::from(m[i]))) };
    let charts = [
        ("triangles", vec![every("cut", &|r| r.triangles as f64)]),
        ("changes per frame", vec![every("splits and contractions", &|r| r.changes as f64)]),
        ("µs per frame", vec![every("update", &|r| r.us)]),
        ("px off, at most", vec![measured("cut", 0), measured("level of as many triangles", 1)]),
    ];
    let root = SVGBackend::new(path, (900, 1000)).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, (title, lines)) in root.split_evenly((4, 1)).iter().zip(&charts) {
        chart(area, title, "frame", lines)?;
    }
    Ok(root.present()?)
}

/// µs against changes, a line per mesh.
pub fn growth(points: &[Point], path: &Path) -> Outcome {
    let mut lines: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for mesh in points.chunk_by(|a, b| a.vertices == b.vertices) {
        let name = format!("{} vertices", mesh[0].vertices);
        lines.push((name, mesh.iter().map(|p| (p.changes, p.us)).collect()));
    }
    let lines: Vec<Line> = lines.iter().map(|(name, points)| Line { name, points: points.clone() }).collect();
    let root = SVGBackend::new(path, (900, 500)).into_drawing_area();
    root.fill(&WHITE)?;
    chart(&root, "µs per frame", "splits and contractions per frame", &lines)?;
    Ok(root.present()?)
}

fn chart(
    area: &DrawingArea<SVGBackend, plotters::coord::Shift>,
    title: &str,
    below: &str,
    lines: &[Line],
) -> Outcome {
    let most =
        |of: fn(&(f64, f64)) -> f64| lines.iter().flat_map(|l| &l.points).map(of).fold(1e-9, f64::max) * 1.05;
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 16))
        .margin(8)
        .x_label_area_size(34)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..most(|p| p.0), 0.0..most(|p| p.1))?;
    chart.configure_mesh().x_desc(below).light_line_style(WHITE).draw()?;
    for (i, line) in lines.iter().enumerate() {
        let colour = Palette99::pick(i).to_rgba();
        let drawn = chart.draw_series(LineSeries::new(line.points.iter().copied(), colour))?;
        drawn.label(line.name).legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour));
    }
    chart.configure_series_labels().background_style(WHITE.mix(0.8)).draw()?;
    Ok(())
}
