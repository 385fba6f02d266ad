//! Tiles and words, laid out as SVG.

use std::fmt::Write;

use super::image::base64;
use super::{Moment, TILE_PX};
use crate::bake::write::{LevelOut, Measured};

/// A level's pictures, as PNG.
pub(super) struct Tile {
    pub(super) whole: Vec<u8>,
    pub(super) close: Option<Vec<u8>>,
    /// Where the close look starts, as shares of the tile.
    pub(super) corner: Option<[f64; 2]>,
}

/// All in pixels.
const MARGIN: usize = 28;
const GAP: usize = 16;
const TITLE: usize = 54;
const LINE: usize = 19;
const CAPTION: usize = 4 * LINE + 24;

/// As many tiles stand side by side as fit a wide screen.
const MOST_IN_A_ROW: usize = 6;

const STYLE: &str = "text{font:13px system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;fill:#3c4043;\
    font-variant-numeric:tabular-nums}.name{font-size:20px;font-weight:600;fill:#202124}\
    .level{font-size:14px;font-weight:600;fill:#202124}.far{text-anchor:end;fill:#80868b}\
    .pale{fill:#80868b}.frame{fill:none;stroke:#dadce0}.mark{fill:none;stroke:#d9480f;stroke-width:1.5}";

/// A page in the making.
#[derive(Default)]
pub(super) struct Page {
    body: String,
    width: usize,
    height: usize,
}

impl Page {
    /// Adds an object below those before. `diagonal` is what distances are shares of.
    pub(super) fn add(&mut self, name: &str, diagonal: f64, levels: &[LevelOut<'_>], tiles: &[Tile]) {
        let top = self.height + MARGIN;
        self.text([MARGIN, top + 18], "name", name);
        let plural = if levels.len() == 1 { "" } else { "s" };
        let about =
            format!("{} level{plural} · distances in % of the diagonal of {diagonal:.4} units", levels.len());
        self.text([MARGIN, top + 38], "pale", &about);
        self.height = top + TITLE;
        self.tiles(tiles, |page, at, i| page.caption(at, i, levels, diagonal));
    }

    /// Adds a series of moments below what was there before.
    pub(super) fn add_moments(&mut self, name: &str, moments: &[Moment<'_>], tiles: &[Tile]) {
        let top = self.height + MARGIN;
        self.text([MARGIN, top + 18], "name", name);
        self.height = top + TITLE - LINE;
        self.tiles(tiles, |page, [x, y], i| {
            page.text([x, y + 4 + LINE], "level", moments[i].caption);
            page.text([x, y + 4 + 2 * LINE], "", moments[i].about);
        });
    }

    /// Adds tiles, each with its caption, which is told where and which it is.
    fn tiles(&mut self, tiles: &[Tile], caption: impl Fn(&mut Self, [usize; 2], usize)) {
        let columns = columns(tiles.len());
        for (i, row) in tiles.chunks(columns).enumerate() {
            for (j, tile) in row.iter().enumerate() {
                let at = [MARGIN + j * (TILE_PX + GAP), self.height];
                let below = self.tile(at, tile);
                caption(self, [at[0], below], i * columns + j);
            }
            let looks = if row.iter().any(|tile| tile.close.is_some()) { 2 } else { 1 };
            self.height += looks * (TILE_PX + GAP) + CAPTION;
        }
        self.width = self.width.max(2 * MARGIN + columns * (TILE_PX + GAP) - GAP);
    }

    /// Returns where its pictures end.
    fn tile(&mut self, [x, y]: [usize; 2], tile: &Tile) -> usize {
        self.picture([x, y], &tile.whole);
        let Some(close) = &tile.close else { return y + TILE_PX };
        if let Some([left, top]) = tile.corner {
            let [left, top] = [(x, left), (y, top)].map(|(at, share)| at as f64 + share * TILE_PX as f64);
            let side = TILE_PX / super::ZOOM;
            let _ = writeln!(
                self.body,
                r#"<rect class="mark" x="{left}" y="{top}" width="{side}" height="{side}"/>"#
            );
        }
        let below = y + TILE_PX + GAP;
        self.picture([x, below], close);
        below + TILE_PX
    }

    fn picture(&mut self, [x, y]: [usize; 2], png: &[u8]) {
        let place = format!(r#"x="{x}" y="{y}" width="{TILE_PX}" height="{TILE_PX}""#);
        let data = base64(png);
        let _ = writeln!(self.body, r#"<image {place} href="data:image/png;base64,{data}"/>"#);
        let _ = writeln!(self.body, r#"<rect class="frame" {place} rx="2"/>"#);
    }

    fn caption(&mut self, [x, y]: [usize; 2], i: usize, levels: &[LevelOut<'_>], diagonal: f64) {
        let (level, right) = (&levels[i], x + TILE_PX);
        let (triangles, of) = (level.mesh.triangles.len(), levels[0].mesh.triangles.len());
        let share = if of > 0 { percent(triangles as f64 / of as f64) } else { String::new() };
        let (first, second) = distances(level.measured, diagonal);
        let error =
            level.measured.map_or(String::new(), |m| format!("error {} units", rounded(f64::from(m.error))));
        let lines = [
            ("level", format!("LOD {i}"), share),
            (
                "",
                format!("{} triangles", grouped(triangles)),
                format!("{} vertices", grouped(level.mesh.wedges.len())),
            ),
            ("", first, second),
            ("pale", error, String::new()),
        ];
        for (line, (class, near, far)) in lines.iter().enumerate() {
            let below = y + 4 + (line + 1) * LINE;
            self.text([x, below], class, near);
            self.text([right, below], "far", far);
        }
    }

    fn text(&mut self, [x, y]: [usize; 2], class: &str, text: &str) {
        if !text.is_empty() {
            let _ = writeln!(self.body, r#"<text class="{class}" x="{x}" y="{y}">{}</text>"#, escaped(text));
        }
    }

    pub(super) fn finish(self) -> String {
        let (width, height) = (self.width.max(2 * MARGIN), self.height + MARGIN);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n<style>{STYLE}</style>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            self.body
        )
    }
}

/// Rows as equally full as can be.
fn columns(tiles: usize) -> usize {
    let rows = tiles.div_ceil(MOST_IN_A_ROW).max(1);
    tiles.div_ceil(rows).max(1)
}

/// Hausdorff distance and root mean square.
fn distances(measured: Option<Measured>, diagonal: f64) -> (String, String) {
    let share = |distance: f64| if diagonal > 0.0 { percent(distance / diagonal) } else { rounded(distance) };
    match measured {
        Some(m) => (format!("Hausdorff ≤ {}", share(m.hausdorff)), format!("RMS {}", share(m.rms))),
        None => (String::new(), String::new()),
    }
}

fn percent(share: f64) -> String {
    format!("{} %", rounded(share * 100.0))
}

/// Three digits that count.
fn rounded(x: f64) -> String {
    match x.abs() {
        size if size == 0.0 || size >= 100.0 => format!("{x:.0}"),
        size if size >= 10.0 => format!("{x:.1}"),
        size if size >= 1.0 => format!("{x:.2}"),
        size if size >= 1e-4 => format!("{x:.*}", (2.0 - size.log10().floor()) as usize),
        _ => format!("{x:.2e}"),
    }
}

/// In groups of three digits with narrow spaces between.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let gap_before = |i: usize| i > 0 && (digits.len() - i).is_multiple_of(3);
    let spaced =
        digits.char_indices().flat_map(|(i, digit)| [gap_before(i).then_some('\u{202f}'), Some(digit)]);
    spaced.flatten().collect()
}

/// As XML has it; characters that XML cannot have are left out.
fn escaped(text: &str) -> String {
    let mut safe = String::new();
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_equally_full() {
        let all = [0, 1, 6, 7, 12, 13].map(columns);
        assert_eq!(all, [1, 1, 6, 4, 6, 5]);
    }

    #[test]
    fn numbers_have_three_digits_that_count() {
        let all = [0.0, 123.4, 99.94, 1.234, 0.1234, 0.012345, 0.00012345, 0.0000012].map(rounded);
        assert_eq!(all, ["0", "123", "99.9", "1.23", "0.123", "0.0123", "0.000123", "1.20e-6"]);
        assert_eq!(
            (grouped(1), grouped(123), grouped(1_234_567)),
            ("1".into(), "123".into(), "1\u{202f}234\u{202f}567".into())
        );
    }

    #[test]
    fn names_do_not_break_the_page() {
        assert_eq!(escaped("a<b>&\u{1}\"c\u{ffff}"), "a&lt;b&gt;&amp;\"c");
    }
}
