//! What a PLY file says it holds.

use super::Refused;
use super::body::Body;
use crate::bake::read::text::{Line, Lines, quoted};

pub(super) struct Header {
    pub(super) elements: Vec<Element>,
}

pub(super) struct Element {
    pub(super) name: Vec<u8>,
    /// What the header claims.
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// Where the header names it.
    pub(super) line: u32,
}

impl Element {
    pub(super) fn has(&self, name: &[u8]) -> bool {
        self.properties.iter().any(|p| p.name == name)
    }
}

pub(super) struct Property {
    pub(super) name: Vec<u8>,
    /// Of what type a list's length is; `None` for a single value.
    pub(super) count: Option<Kind>,
    pub(super) kind: Kind,
}

/// The types of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn called(name: &[u8]) -> Option<Self> {
        match name {
            b"char" | b"int8" => Some(Self::I8),
            b"uchar" | b"uint8" => Some(Self::U8),
            b"short" | b"int16" => Some(Self::I16),
            b"ushort" | b"uint16" => Some(Self::U16),
            b"int" | b"int32" => Some(Self::I32),
            b"uint" | b"uint32" => Some(Self::U32),
            b"float" | b"float32" => Some(Self::F32),
            b"double" | b"float64" => Some(Self::F64),
            _ => None,
        }
    }
}

/// How the values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

impl Header {
    /// The header, and what follows it.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, Body<'_>), Refused> {
        let mut lines = Lines::of(bytes);
        if lines.next().is_none_or(|first| first.bytes.trim_ascii() != b"ply") {
            return Err(Refused::line(1, "it must start with 'ply'"));
        }
        let (mut header, mut encoding) = (Self { elements: Vec::new() }, None);
        while let Some(line) = lines.next() {
            let words: Vec<&[u8]> = line.words().collect();
            match words.as_slice() {
                [] | [b"comment" | b"obj_info", ..] => {}
                [b"format", rest @ ..] => encoding = Some(encoding_of(line, rest)?),
                [b"element", name, count, ..] => header.add_element(line, name, count)?,
                [b"property", rest @ ..] => header.add_property(line, rest)?,
                [b"end_header", ..] => {
                    let encoding = encoding.ok_or_else(|| Refused::whole(NO_FORMAT))?;
                    return Ok((header, Body::new(encoding, lines)));
                }
                [word, ..] => {
                    return Err(line.refused(format!("{} must be a word of a header", quoted(word))));
                }
            }
        }
        Err(Refused::whole(NO_FORMAT))
    }

    fn add_element(&mut self, line: Line<'_>, name: &[u8], count: &[u8]) -> Result<(), Refused> {
        let count = line.count_of(count, "the number of elements")?;
        self.elements.push(Element { name: name.to_vec(), count, properties: Vec::new(), line: line.number });
        Ok(())
    }

    fn add_property(&mut self, line: Line<'_>, words: &[&[u8]]) -> Result<(), Refused> {
        let kind = |word: &[u8]| {
            let rule =
                || line.refused(format!("{} must be a type, such as uchar, int or float", quoted(word)));
            Kind::called(word).ok_or_else(rule)
        };
        let (name, count, kind) = match *words {
            [b"list", length, value, name] => (name, Some(kind(length)?), kind(value)?),
            [value, name] => (name, None, kind(value)?),
            _ => {
                return Err(
                    line.refused("a property must be 'property TYPE NAME' or 'property list TYPE TYPE NAME'")
                );
            }
        };
        let element = self.elements.last_mut();
        let element =
            element.ok_or_else(|| line.refused("a property must belong to an element before it"))?;
        element.properties.push(Property { name: name.to_vec(), count, kind });
        Ok(())
    }
}

const NO_FORMAT: &str = "it must have a format before its elements and an end_header";

fn encoding_of(line: Line<'_>, words: &[&[u8]]) -> Result<Encoding, Refused> {
    match words {
        [b"ascii", b"1.0"] => Ok(Encoding::Text),
        [b"binary_little_endian", b"1.0"] => Ok(Encoding::LittleEndian),
        [b"binary_big_endian", b"1.0"] => Ok(Encoding::BigEndian),
        _ => Err(line
            .refused("its format must be ascii, binary_little_endian or binary_big_endian, of version 1.0")),
    }
}
