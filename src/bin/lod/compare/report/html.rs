//! A page that needs nothing but itself.

use super::Plots;
use crate::compare::columns::{Column, TIME, WORTH};
use crate::compare::summary::{PolicyRow, Summary};
use crate::compare::words;
use crate::text::plain;

/// The whole page, plots inlined.
pub fn page(summary: &Summary, plots: &Plots) -> String {
    let title = format!("Levels of detail in '{}'", escaped(&summary.scene));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{}{}{}{}{}{}{}</body>\n</html>\n",
        facts(summary),
        table(summary),
        notes(summary),
        figure(&plots.frame_time, FRAME_TIME),
        figure(&plots.time_over_budget, TIME_OVER_BUDGET),
        figure(&plots.gain_over_bound, GAIN_OVER_BOUND),
        legend()
    )
}

const STYLE: &str = "
body { max-width: 1120px; margin: 2rem auto; padding: 0 1rem; color: #222; background: #fff;
  font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; margin-bottom: .5rem; } h2 { font-size: 1.2rem; margin-top: 2.5rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; }
dt { color: #666; } dd { margin: 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .85rem; margin: 1.5rem 0; }
th, td { padding: .3rem .45rem; text-align: right; border-bottom: 1px solid #e2e2e2; }
th { vertical-align: bottom; font-weight: 600; } th small { font-weight: 400; color: #666; display: block; }
th:first-child, td:first-child { text-align: left; white-space: nowrap; }
.words th, .words td { text-align: left; vertical-align: top; }
.end td { color: #777; }
figure { margin: 2.5rem 0; } figure svg { max-width: 100%; height: auto; }
figcaption { color: #555; font-size: .9rem; max-width: 46rem; }
";

const FRAME_TIME: &str = "Each panel is one policy. Where the grey band lies above the budget line, even all coarsest \
    levels take longer than the budget; where it lies below, all finest levels take less. Panels are cut where a \
    frame takes far longer than all others.";
const TIME_OVER_BUDGET: &str = "The further left a line rises, the shorter the frames; the steeper it is, the more \
    alike they are. What lies right of 1 exceeds the budget.";
const GAIN_OVER_BOUND: &str = "Every policy is held against the best that the time it took itself could have bought: \
    how well it spends, whatever it spends. Frames in which nothing could be bought are left out.";

/// Text for a page: nothing in it is markup.
fn escaped(text: &str) -> String {
    let replaced = |c: char| match c {
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '&' => "&amp;".to_owned(),
        '"' => "&quot;".to_owned(),
        '\'' => "&#39;".to_owned(),
        other => other.to_string(),
    };
    plain(text).chars().map(replaced).collect()
}

fn facts(s: &Summary) -> String {
    let origin = |file: &Option<String>| file.clone().unwrap_or_else(|| "made on the spot".to_owned());
    let c = &s.camera;
    let camera = format!(
        "{}° vertical field of view, {} × {} px, from {} to {}",
        c.fov_deg, c.viewport_px[0], c.viewport_px[1], c.near, c.far
    );
    let expected = format!("{} before the first measurement", words::model(&s.cost_model.prior));
    let files = format!("scene: {}; path: {}", origin(&s.scene_file), origin(&s.path_file));
    let more = [("Camera", camera), ("Expected", expected), ("Files", files)];
    let entry = |(name, words): (&str, String)| format!("<dt>{name}</dt><dd>{}</dd>\n", escaped(&words));
    let entries: String = words::facts(s).into_iter().chain(more).map(entry).collect();
    format!("<dl>\n{entries}</dl>\n")
}

fn columns() -> impl Iterator<Item = &'static Column> {
    TIME.iter().chain(&WORTH)
}

fn table(s: &Summary) -> String {
    let heading = |c: &Column| format!("<th>{}<small>{}</small></th>", c.name, c.unit);
    let headings: String = columns().map(heading).collect();
    let rows: String = s.policies.iter().map(|p| table_row(s, p)).collect();
    format!("<div class=\"scroll\"><table>\n<tr><th>policy</th>{headings}</tr>\n{rows}</table></div>\n")
}

fn table_row(s: &Summary, p: &PolicyRow) -> String {
    let values: String = columns().map(|c| format!("<td>{}</td>", (c.value)(s, p))).collect();
    let class = if p.competes() { "" } else { " class=\"end\"" };
    format!("<tr{class}><td>{}</td>{values}</tr>\n", p.policy)
}

fn notes(s: &Summary) -> String {
    words::notes(s).iter().map(|note| format!("<p>{}</p>\n", escaped(note))).collect()
}

fn figure(svg: &str, caption: &str) -> String {
    format!("<figure>\n{svg}\n<figcaption>{caption}</figcaption>\n</figure>\n")
}

fn legend() -> String {
    let row = |c: &Column| format!("<tr><td>{}, {}</td><td>{}</td></tr>\n", c.name, c.unit, c.meaning);
    let rows: String = columns().map(row).collect();
    format!("<h2>What the columns mean</h2>\n<table class=\"words\">\n{rows}</table>\n{POLICIES}")
}

const POLICIES: &str = "<h2>What the policies do</h2>
<table class=\"words\">
<tr><td>coarsest, finest</td><td>Every object at its cheapest choice, or at its finest level: the ends of the scale.</td></tr>
<tr><td>static-default</td><td>By size in the image, thresholds as they are.</td></tr>
<tr><td>static</td><td>The same times one factor for the whole path: the one that tracks the budget best, found in
hindsight.</td></tr>
<tr><td>reactive</td><td>By size in the image, the factor steered by measured frame times.</td></tr>
<tr><td>funkhouser-sequin</td><td>The incremental rule of Funkhouser and Séquin, 1993.</td></tr>
<tr><td>predictive</td><td>The multiple-choice knapsack under the predicted frame time, with a certificate.</td></tr>
</table>
";
