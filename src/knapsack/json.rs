//! Instances as JSON: `{"budget": B, "classes": [[[cost, benefit], …], …]}`, optionally with `"format": "lod-knapsack"`
//! and `"version": 1`.

use std::error::Error;
use std::fmt;
use std::io::Read;

use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};

use super::instance::InstanceBuilder;
use super::{Instance, InstanceError, Item};

const FORMAT: &str = "lod-knapsack";
const VERSION: u64 = 1;

impl Instance {
    /// Parses one JSON instance and nothing after it.
    ///
    /// Errors give line and column and, inside `classes`, the class and the item, counted from 0. Unknown or repeated
    /// keys are errors. Items are checked as they are read, so the first broken one ends the reading.
    pub fn from_json(text: &str) -> Result<Self, InstanceJsonError> {
        Self::parse(serde_json::Deserializer::from_str(text))
    }

    /// [`Instance::from_json`] from a reader, such as a file; wrap it in a `BufReader`.
    pub fn read_json(reader: impl Read) -> Result<Self, InstanceJsonError> {
        Self::parse(serde_json::Deserializer::from_reader(reader))
    }

    fn parse<'a, R: serde_json::de::Read<'a>>(
        mut json: serde_json::Deserializer<R>,
    ) -> Result<Self, InstanceJsonError> {
        let (budget, builder) = json.deserialize_map(Document)?;
        json.end()?;
        Ok(builder.finish(budget)?)
    }
}

/// Why a text is no instance. It has no name; [`Instance::read`] puts the file's before it.
#[derive(Debug)]
#[non_exhaustive]
pub enum InstanceJsonError {
    /// The text is not an instance; says where and, inside `classes`, in which class and item.
    Json(serde_json::Error),
    /// The text is an instance that breaks a rule on the whole.
    Instance(InstanceError),
}

impl fmt::Display for InstanceJsonError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Json(error) => write!(out, "{error}"),
            Self::Instance(error) => write!(out, "{error}"),
        }
    }
}

impl Error for InstanceJsonError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Json(error) => Some(error),
            Self::Instance(error) => Some(error),
        }
    }
}

impl From<serde_json::Error> for InstanceJsonError {
    fn from(error: serde_json::Error) -> Self {
        Self::Json(error)
    }
}

impl From<InstanceError> for InstanceJsonError {
    fn from(error: InstanceError) -> Self {
        Self::Instance(error)
    }
}

/// The outer object.
struct Document;

impl<'de> Visitor<'de> for Document {
    type Value = (f64, InstanceBuilder);

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object with \"budget\" and \"classes\"")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let (mut budget, mut classes, mut format, mut version) = (None, None, None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "budget" => fill(&mut budget, "budget", map.next_value::<f64>().map_err(within("budget")))?,
                "classes" => fill(&mut classes, "classes", map.next_value_seed(Classes))?,
                "format" => {
                    fill(&mut format, "format", map.next_value::<String>().map_err(within("format")))?
                }
                "version" => {
                    fill(&mut version, "version", map.next_value::<u64>().map_err(within("version")))?
                }
                _ => {
                    return Err(de::Error::unknown_field(&key, &["budget", "classes", "format", "version"]));
                }
            }
        }
        if let Some(format) = format.filter(|format| format != FORMAT) {
            return Err(de::Error::custom(format_args!("format must be \"{FORMAT}\", but is {format:?}")));
        }
        if let Some(version) = version.filter(|&version| version != VERSION) {
            return Err(de::Error::custom(format_args!("version must be {VERSION}, but is {version}")));
        }
        let budget = budget.ok_or_else(|| de::Error::missing_field("budget"))?;
        Ok((budget, classes.ok_or_else(|| de::Error::missing_field("classes"))?))
    }
}

/// Stores the value of a key that must not repeat.
fn fill<V, E: de::Error>(slot: &mut Option<V>, key: &'static str, value: Result<V, E>) -> Result<(), E> {
    match slot.replace(value?) {
        Some(_) => Err(E::duplicate_field(key)),
        None => Ok(()),
    }
}

/// Puts a place before an error's message; serde_json keeps the line and column at its end apart.
fn within<E: de::Error>(place: impl fmt::Display) -> impl FnOnce(E) -> E {
    move |error| E::custom(format_args!("{place}: {error}"))
}

/// The array of classes.
struct Classes;

impl<'de> DeserializeSeed<'de> for Classes {
    type Value = InstanceBuilder;

    fn deserialize<D: Deserializer<'de>>(self, json: D) -> Result<Self::Value, D::Error> {
        json.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Classes {
    type Value = InstanceBuilder;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an array of classes, each an array of [cost, benefit]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut classes: A) -> Result<Self::Value, A::Error> {
        let mut builder = InstanceBuilder::default();
        while classes.next_element_seed(Class(&mut builder))?.is_some() {
            builder.close_class().map_err(de::Error::custom)?;
        }
        Ok(builder)
    }
}

/// One class: an array of items that go into the builder.
struct Class<'a>(&'a mut InstanceBuilder);

impl<'de> DeserializeSeed<'de> for Class<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, json: D) -> Result<(), D::Error> {
        let class = self.0.class();
        json.deserialize_seq(self).map_err(|error| place_once(class, error))
    }
}

/// Names the class, unless the error already does.
fn place_once<E: de::Error>(class: usize, error: E) -> E {
    if error.to_string().starts_with("class ") { error } else { within(format_args!("class {class}"))(error) }
}

impl<'de> Visitor<'de> for Class<'_> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a class: an array of [cost, benefit]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        loop {
            let (class, index) = (self.0.class(), self.0.item());
            let read =
                items.next_element_seed(Pair).map_err(within(format_args!("class {class}, item {index}")))?;
            let Some(item) = read else { return Ok(()) };
            self.0.push(item).map_err(de::Error::custom)?;
        }
    }
}

/// One item: exactly two numbers.
struct Pair;

impl<'de> DeserializeSeed<'de> for Pair {
    type Value = Item;

    fn deserialize<D: Deserializer<'de>>(self, json: D) -> Result<Item, D::Error> {
        json.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Pair {
    type Value = Item;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("[cost, benefit], two numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut pair: A) -> Result<Item, A::Error> {
        let cost = pair.next_element()?.ok_or_else(|| de::Error::invalid_length(0, &self))?;
        let benefit = pair.next_element()?.ok_or_else(|| de::Error::invalid_length(1, &self))?;
        match pair.next_element::<de::IgnoredAny>()? {
            None => Ok(Item { cost, benefit }),
            Some(_) => Err(de::Error::custom("more than two numbers, expected [cost, benefit]")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn error(text: &str) -> String {
        match Instance::from_json(text) {
            Ok(instance) => panic!("{text} was read as {instance:?}"),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn an_instance_is_read() -> Result<(), InstanceJsonError> {
        let text = r#"{"format": "lod-knapsack", "version": 1, "budget": 2.5, "classes": [[[1, 2], [3e0, 4]], [[0, 0.1]]]}"#;
        let expected = Instance::new(
            2.5,
            [&[(1.0, 2.0), (3.0, 4.0)].map(Item::from)[..], &[(0.0, 0.1)].map(Item::from)],
        )?;
        assert_eq!(Instance::from_json(text)?, expected);
        assert_eq!(Instance::read_json(text.as_bytes())?, expected);
        assert!(Instance::from_json(r#"{"classes": [], "budget": 0}"#)?.is_empty());
        Ok(())
    }

    #[test]
    fn errors_name_place_and_rule() {
        for (text, words) in [
            ("", &["EOF", "line 1"][..]),
            ("[]", &["budget", "line 1"]),
            (r#"{"budget": 1}"#, &["missing", "classes"]),
            (r#"{"classes": []}"#, &["missing", "budget"]),
            (r#"{"budget": 1, "budget": 2, "classes": []}"#, &["duplicate", "budget", "column"]),
            (r#"{"budget": 1, "classes": [], "colour": 3}"#, &["unknown", "colour", "column"]),
            (r#"{"budget": 1, "classes": []} x"#, &["trailing", "column 30"]),
            (r#"{"budget": "1", "classes": []}"#, &["budget", "string", "column"]),
            (r#"{"budget": -1, "classes": []}"#, &["budget", "negative", "-1"]),
            (r#"{"budget": 1e999, "classes": []}"#, &["budget", "out of range", "column"]),
            (r#"{"budget": 1, "version": 2, "classes": []}"#, &["version", "1", "2"]),
            (r#"{"budget": 1, "format": "png", "classes": []}"#, &["format", "png"]),
            (r#"{"budget": 1, "classes": {}}"#, &["array of classes", "column"]),
            (r#"{"budget": 1, "classes": [3]}"#, &["class 0", "array", "column"]),
            (r#"{"budget": 1, "classes": [[[1, 1]], []]}"#, &["class 1", "empty", "column"]),
            (r#"{"budget": 1, "classes": [[[1, 1], 4]]}"#, &["class 0, item 1", "[cost, benefit]", "column"]),
            (r#"{"budget": 1, "classes": [[[1]]]}"#, &["class 0, item 0", "length 1", "column"]),
            (r#"{"budget": 1, "classes": [[[1, 2, 3]]]}"#, &["class 0, item 0", "two numbers", "column"]),
            (
                "{\"budget\": 1, \"classes\": [\n[[1, 2]], [[1, true]]]}",
                &["class 1, item 0", "boolean", "line 2"],
            ),
            (r#"{"budget": 1, "classes": [[[1, NaN]]]}"#, &["class 0, item 0", "column"]),
            (r#"{"budget": 1, "classes": [[[1, null]]]}"#, &["class 0, item 0", "null", "column"]),
            (
                r#"{"budget": 1, "classes": [[[1, 2]], [[1, 2], [1e999, 2]]]}"#,
                &["class 1, item 1", "out of range", "column"],
            ),
            (
                r#"{"budget": 1, "classes": [[[1, 2]], [[1, -2]]]}"#,
                &["class 1, item 0", "benefit", "-2", "column"],
            ),
            (r#"{"budget": 1, "classes": [[[1, 2]], [[1, "#, &["class 1, item 0", "EOF", "line 1"]),
        ] {
            let message = error(text);
            assert!(words.iter().all(|word| message.contains(word)), "{text}\n{message}");
        }
    }

    #[test]
    fn deep_nesting_is_refused_at_the_first_wrong_level() {
        let text = format!(r#"{{"budget": 1, "classes": {}"#, "[".repeat(1_000_000));
        assert!(error(&text).contains("class 0, item 0"));
        let skipped = format!(r#"{{"budget": 1, "classes": [[[1, 2, {}"#, "[".repeat(1_000_000));
        assert!(error(&skipped).contains("class 0, item 0"));
    }

    proptest! {
        #[test]
        fn a_truncated_text_is_an_error_not_a_panic(cut in 0usize..60) {
            let text = r#"{"budget": 1, "classes": [[[1, 2], [3, 4.5]], [[0.25, 1e3]]]}"#;
            prop_assert!(Instance::from_json(&text[..cut]).is_err());
        }

        #[test]
        fn any_text_is_read_or_refused(text in r#"[\[\]{},:0-9eE.+\-" budgetclasses]{0,60}"#) {
            let _ = Instance::from_json(&text);
        }

        #[test]
        fn numbers_survive_a_round_trip(cost in 0.0f64..1e300, benefit in 0.0f64..1e-300) {
            let text = format!(r#"{{"budget": {cost:?}, "classes": [[[{cost:?}, {benefit:?}]]]}}"#);
            let instance = Instance::from_json(&text).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert_eq!(instance.class(0)[0], Item { cost, benefit });
        }
    }
}
