//! Lines, words and numbers of the text formats.

use std::borrow::Cow;

use super::Refused;

/// The bytes as UTF-8 if a mark says UTF-16, and without a mark. Bytes that are neither stay: only names have them.
pub(super) fn decoded(bytes: &[u8]) -> Cow<'_, [u8]> {
    let wide = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = rest.as_chunks().0.iter().map(|&pair| unit(pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&units).into_bytes())
    };
    match bytes {
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        _ => Cow::Borrowed(bytes),
    }
}

/// A line without its end, and its number from 1 on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub(super) number: u32,
    pub(super) bytes: &'a [u8],
}

/// Lines that end in LF, CR LF, CR or with the text.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: u32,
}

impl<'a> Lines<'a> {
    pub(super) fn of(text: &'a [u8]) -> Self {
        Self { rest: text, number: 0 }
    }

    /// What no line was made of yet.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The number of the last line.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// The next line that has a word in it once comments (from `#` on) are cut.
    pub(super) fn next_full(&mut self) -> Option<Line<'a>> {
        self.find_map(|line| {
            let bytes = line.bytes.split(|&b| b == b'#').next().unwrap_or_default();
            (!bytes.trim_ascii().is_empty()).then_some(Line { bytes, ..line })
        })
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (bytes, rest) = self.rest.split_at(end);
        let width = if rest.starts_with(b"\r\n") { 2 } else { 1 };
        self.rest = rest.get(width..).unwrap_or_default();
        self.number = self.number.saturating_add(1);
        Some(Line { number: self.number, bytes })
    }
}

impl<'a> Line<'a> {
    pub(super) fn words(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        self.bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
    }

    pub(super) fn refused(&self, rule: impl Into<String>) -> Refused {
        Refused::line(self.number, rule)
    }

    /// A coordinate or the like; infinite or no number where the text says so.
    pub(super) fn number_of(&self, word: &[u8]) -> Result<f32, Refused> {
        number(word).ok_or_else(|| self.refused(format!("{} must be a number", quoted(word))))
    }

    pub(super) fn count_of(&self, word: &[u8], what: &str) -> Result<u64, Refused> {
        integer(word).ok_or_else(|| self.refused(format!("{what} must be a count, not {}", quoted(word))))
    }
}

/// A decimal number as C and C++ write it: `1.`, `+2`, `3e+2`, `nan`, `-inf`, and Microsoft's `1.#IND` and the like.
fn number(word: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| special(&text.to_ascii_lowercase()))
}

/// As [`number`], in double precision, for values that may be integers of 32 bits.
pub(super) fn double(word: &[u8]) -> Option<f64> {
    integer(word).or_else(|| number(word).map(f64::from))
}

fn special(text: &str) -> Option<f32> {
    let (sign, text) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    if text.starts_with("1.#inf") {
        return Some(sign * f32::INFINITY);
    }
    let nameless = ["1.#ind", "1.#qnan", "1.#snan", "1.#nan", "nan("];
    nameless.iter().any(|start| text.starts_with(start)).then_some(f32::NAN)
}

pub(super) fn integer<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word for an error: short, and without what a terminal would obey.
pub(super) fn quoted(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(word);
    let mut shown: String = text.chars().take(24).flat_map(char::escape_debug).collect();
    if text.chars().nth(24).is_some() {
        shown.push('…');
    }
    format!("'{shown}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_three_ways() {
        let lines: Vec<_> = Lines::of(b"a\nb\r\nc\rd\n\ne").map(|l| (l.number, l.bytes)).collect();
        assert_eq!(lines, [(1, &b"a"[..]), (2, b"b"), (3, b"c"), (4, b"d"), (5, b""), (6, b"e")]);
    }

    #[test]
    fn both_kinds_of_utf_16_are_read() {
        let wide: Vec<u16> = "v 1 ü\n".encode_utf16().collect();
        let mut big = vec![0xfe, 0xff];
        big.extend(wide.iter().flat_map(|u| u.to_be_bytes()));
        let mut little = vec![0xff, 0xfe];
        little.extend(wide.iter().flat_map(|u| u.to_le_bytes()));
        assert_eq!(&*decoded(&big), "v 1 ü\n".as_bytes());
        assert_eq!(&*decoded(&little), "v 1 ü\n".as_bytes());
        assert_eq!(&*decoded(b"\xef\xbb\xbfv"), b"v");
    }

    #[test]
    fn numbers_come_in_many_forms() {
        for (text, value) in [("1", 1.0), ("+2.", 2.0), ("-.5", -0.5), ("1E2", 100.0), ("3.1e+02", 310.0)] {
            assert_eq!(number(text.as_bytes()), Some(value));
        }
        assert_eq!(number(b"-1.#INF"), Some(f32::NEG_INFINITY));
        for text in ["nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00"] {
            assert!(number(text.as_bytes()).is_some_and(f32::is_nan), "{text}");
        }
        for text in ["", "3.1+e2", "1,5", "0x10", "1e", "--1", "1.0D+05", "\u{fc}"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn words_in_errors_are_short_and_tame() {
        assert_eq!(quoted(b"a\x1b[31m"), r"'a\u{1b}[31m'");
        assert_eq!(quoted(&[b'x'; 99]), format!("'{}…'", "x".repeat(24)));
    }
}
