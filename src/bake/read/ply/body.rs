//! The values of a PLY file, one after the other.

use super::Refused;
use super::header::{Element, Encoding, Kind, Property};
use crate::bake::read::text::{Line, Lines, double, quoted};

/// What follows the header.
pub(super) struct Body<'a> {
    encoding: Encoding,
    lines: Lines<'a>,
    bytes: &'a [u8],
    /// The first line with more values than the header says.
    extra: Option<u32>,
}

/// The values of an element that are still to come.
pub(super) struct Values<'v, 'a> {
    encoding: Encoding,
    words: Option<Words<'a>>,
    bytes: &'v mut &'a [u8],
}

/// The words of a line.
struct Words<'a>(Box<dyn Iterator<Item = &'a [u8]> + 'a>);

/// An element ends before its last value does.
const CUT_OFF: &str = "it is cut off";

impl<'a> Body<'a> {
    pub(super) fn new(encoding: Encoding, lines: Lines<'a>) -> Self {
        Self { encoding, bytes: lines.rest(), lines, extra: None }
    }

    /// What a face's number counts.
    pub(super) fn element(&self) -> &'static str {
        if self.encoding == Encoding::Text { "line" } else { "face" }
    }

    /// The first line with more values than its element has.
    pub(super) fn extra(&self) -> Option<u32> {
        self.extra
    }

    /// Calls `read` for every element of the kind that the file has, with its values and its line or number. Elements
    /// without properties take no place, and are passed over however many there are.
    pub(super) fn each(
        &mut self,
        element: &Element,
        mut read: impl FnMut(&mut Values<'_, 'a>, u32) -> Result<(), String>,
    ) -> Result<(), Refused> {
        if element.properties.is_empty() {
            return Ok(());
        }
        for index in 0..element.count {
            match self.encoding {
                Encoding::Text => self.read_line(element, index, &mut read)?,
                _ => self.read_binary(element, index, &mut read)?,
            }
        }
        Ok(())
    }

    fn read_line(
        &mut self,
        element: &Element,
        index: u64,
        read: &mut impl FnMut(&mut Values<'_, 'a>, u32) -> Result<(), String>,
    ) -> Result<(), Refused> {
        let Some(line) = self.lines.find(|line| !line.bytes.trim_ascii().is_empty()) else {
            let (name, count) = (String::from_utf8_lossy(&element.name), element.count);
            let rule = format!("{CUT_OFF}: {name} {index} of {count} must be here");
            return Err(Refused::line(self.lines.number().saturating_add(1), rule));
        };
        let mut values =
            Values { encoding: self.encoding, words: Some(Words::of(line)), bytes: &mut self.bytes };
        read(&mut values, line.number).map_err(|rule| line.refused(rule))?;
        if self.extra.is_none() && values.word().is_some() {
            self.extra = Some(line.number);
        }
        Ok(())
    }

    fn read_binary(
        &mut self,
        element: &Element,
        index: u64,
        read: &mut impl FnMut(&mut Values<'_, 'a>, u32) -> Result<(), String>,
    ) -> Result<(), Refused> {
        let mut values = Values { encoding: self.encoding, words: None, bytes: &mut self.bytes };
        read(&mut values, u32::try_from(index).unwrap_or(u32::MAX)).map_err(|rule| {
            let said =
                if rule == CUT_OFF { format!(": its header says {}", element.count) } else { String::new() };
            Refused::at(format!("{} {index}", String::from_utf8_lossy(&element.name)), rule + &said)
        })
    }
}

impl<'a> Words<'a> {
    fn of(line: Line<'a>) -> Self {
        Self(Box::new(line.words()))
    }
}

impl<'a> Values<'_, 'a> {
    /// Calls `take` with the value, or with each of the list.
    pub(super) fn property(&mut self, property: &Property, mut take: impl FnMut(f64)) -> Result<(), String> {
        let Some(kind) = property.count else {
            take(self.value(property.kind, property)?);
            return Ok(());
        };
        let length = self.value(kind, property)?;
        if length.fract() != 0.0 || length < 0.0 {
            let name = quoted(&property.name);
            return Err(format!("the length of {name} must be a count, not {length}"));
        }
        let mut left = length;
        while left > 0.0 {
            take(self.value(property.kind, property)?);
            left -= 1.0;
        }
        Ok(())
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        self.words.as_mut()?.0.next()
    }

    fn value(&mut self, kind: Kind, property: &Property) -> Result<f64, String> {
        if self.words.is_none() {
            return self.binary(kind).ok_or_else(|| CUT_OFF.to_owned());
        }
        let word = self.word();
        let word =
            word.ok_or_else(|| format!("it must have another value for {}", quoted(&property.name)))?;
        double(word).ok_or_else(|| format!("{} must be a number", quoted(word)))
    }

    fn binary(&mut self, kind: Kind) -> Option<f64> {
        Some(match kind {
            Kind::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Kind::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Kind::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Kind::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Kind::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Kind::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Kind::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Kind::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes, least significant first.
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&(mut taken), rest) = self.bytes.split_first_chunk::<N>()?;
        *self.bytes = rest;
        if self.encoding == Encoding::BigEndian {
            taken.reverse();
        }
        Some(taken)
    }
}
