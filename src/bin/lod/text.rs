//! Text for people: tables, numbers, and what does not belong on a terminal.

use std::io::{self, IsTerminal};

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table};

/// A table without lines: the first column to the left, all others to the right.
pub fn table(headings: &[String], rows: &[Vec<String>]) -> String {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    let side = |column| if column == 0 { CellAlignment::Left } else { CellAlignment::Right };
    table.set_header(headings.iter().enumerate().map(|(i, h)| Cell::new(h).set_alignment(side(i))));
    table.add_rows(rows);
    for (i, column) in table.column_iter_mut().enumerate() {
        column.set_cell_alignment(side(i));
        column.set_padding((u16::from(i > 0), 1));
    }
    let lines: Vec<String> = table.lines().map(|line| line.trim_end().to_owned() + "\n").collect();
    lines.concat()
}

/// Columns of the terminal on standard output; `None` where it is none.
pub fn columns() -> Option<usize> {
    let terminal = io::stdout().is_terminal().then(terminal_size::terminal_size).flatten();
    terminal.map(|(width, _)| usize::from(width.0))
}

/// A name from a file, with control characters made visible: they are no business of the terminal's.
pub fn plain(name: &str) -> String {
    name.chars().flat_map(|c| if c.is_control() { c.escape_default().collect() } else { vec![c] }).collect()
}

/// A count with spaces between groups of three digits, from five digits on.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let place = |(i, digit): (usize, char)| {
        let gap = i > 0 && (digits.len() - i).is_multiple_of(3);
        [gap.then_some(' '), Some(digit)].into_iter().flatten()
    };
    digits.chars().enumerate().flat_map(place).collect()
}

/// `n` of something: "1 jump", "2 jumps".
pub fn counted(n: usize, what: &str) -> String {
    format!("{} {what}{}", count(n as u64), if n == 1 { "" } else { "s" })
}

/// So many decimals, and no minus before a zero.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_owned(),
        _ => text,
    }
}

/// A fraction in percent.
pub fn percent(fraction: f64, decimals: usize) -> String {
    fixed(fraction * 100.0, decimals)
}

/// How many decimals show `value` with `digits` significant ones.
pub fn decimals_for(value: f64, digits: i32) -> usize {
    let magnitude = if value > 0.0 { value.log10().floor() as i32 } else { 0 };
    (digits - 1 - magnitude).clamp(0, 12) as usize
}

/// `value` with so many significant digits.
pub fn significant(value: f64, digits: i32) -> String {
    format!("{value:.*}", decimals_for(value.abs(), digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!([0, 999, 4321, 12345, 1234567].map(count), ["0", "999", "4321", "12 345", "1 234 567"]);
        assert_eq!((counted(1, "jump"), counted(0, "jump")), ("1 jump".into(), "0 jumps".into()));
        assert_eq!(
            (percent(0.12345, 1), percent(-1e-9, 2), fixed(-0.5, 1)),
            ("12.3".into(), "0.00".into(), "-0.5".into())
        );
        let values = [0.0, 0.00012345, 1.2345, 1234.5, -0.5];
        assert_eq!(values.map(|v| significant(v, 3)), ["0.00", "0.000123", "1.23", "1234", "-0.500"]);
    }

    #[test]
    fn names_cannot_steer_the_terminal() {
        assert_eq!(plain("a\u{1b}[31m\u{9b}b é"), "a\\u{1b}[31m\\u{9b}b é");
    }
}
