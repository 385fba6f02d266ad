//! JSON with errors that say where: the entry of a list as well as line and column.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error as _, SeqAccess, Visitor};

use super::FileError;

/// Stands between place and rule in the message of a [`serde_json::Error`], the only thing it lets through.
const PLACE_END: char = '\u{1f}';

/// What an entry of a [`Listed`] is called in errors.
pub(super) trait Entry {
    const KIND: &'static str;
}

/// A list whose errors name the entry at fault by kind and position.
#[derive(Clone, Debug)]
pub(super) struct Listed<T>(pub(super) Vec<T>);

impl<T> Default for Listed<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de> + Entry> Deserialize<'de> for Listed<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Entries(PhantomData)).map(Self)
    }
}

struct Entries<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Entry> Visitor<'de> for Entries<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list, each entry a {}", T::KIND)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut entries = Vec::new();
        loop {
            let next = list.next_element().map_err(|e| {
                A::Error::custom(format_args!("{} at position {}{PLACE_END}{e}", T::KIND, entries.len()))
            })?;
            match next {
                Some(entry) => entries.push(entry),
                None => return Ok(entries),
            }
        }
    }
}

/// Reads the whole text as one value.
///
/// Numbers become the nearest that the type holds; those beyond its range are refused, as are `NaN` and text after
/// the value.
pub(super) fn parse<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, FileError> {
    serde_json::from_str(text).map_err(|e| file_error(&e, file))
}

fn file_error(error: &serde_json::Error, file: &str) -> FileError {
    let message = error.to_string();
    let (line, column) = (error.line(), error.column());
    let message = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message);
    let mut parts: Vec<&str> = message.split(PLACE_END).collect();
    let rule = parts.pop().unwrap_or_default().to_owned();
    let place = match (parts.is_empty(), line) {
        (true, 0) => None,
        (true, _) => Some(format!("line {line}, column {column}")),
        (false, 0) => Some(parts.join(", ")),
        (false, _) => Some(format!("{} (line {line}, column {column})", parts.join(", "))),
    };
    FileError { file: file.to_owned(), place, rule }
}
