//! Why a file was refused, in one shape for every reader.

use std::fmt;

/// Why a file was refused. Displayed as `FILE: PLACE: RULE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileError {
    /// The file, as the caller named it.
    pub file: String,
    /// The object, table, node, mesh, line … at fault; `None` where it is the whole file.
    pub place: Option<String>,
    /// The rule it breaks.
    pub rule: String,
}

impl FileError {
    /// The file as a whole breaks `rule`.
    pub fn whole(file: impl Into<String>, rule: impl Into<String>) -> Self {
        Self { file: file.into(), place: None, rule: rule.into() }
    }

    /// Something in the file breaks `rule`.
    pub fn at(file: impl Into<String>, place: impl Into<String>, rule: impl Into<String>) -> Self {
        Self { file: file.into(), place: Some(place.into()), rule: rule.into() }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file)?;
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.rule)
    }
}

impl std::error::Error for FileError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_left_out_where_there_is_none() {
        assert_eq!(FileError::whole("a.json", "is empty").to_string(), "a.json: is empty");
        assert_eq!(FileError::at("a.csv", "line 3", "no time").to_string(), "a.csv: line 3: no time");
    }
}
