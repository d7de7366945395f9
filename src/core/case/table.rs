//! The tables of case files and run files, read strictly: every fault has file and line; an unknown key names the
//! nearest known one.

use glam::DVec2;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::core::case::parameters::{ParameterKind, Parameters, unknown_key};
use crate::core::fault::Fault;
use crate::core::kernel::spelling::nearest;

/// The text that tables and values point into, with the name that messages give it.
pub(in crate::core) struct Source<'a> {
    /// Name of the file for messages.
    file: &'a str,
    /// Its whole text.
    text: &'a str,
    /// The bytes at which its lines end, ascending.
    ends: Vec<usize>,
}

impl<'a> Source<'a> {
    /// A text, and the name that messages give it.
    pub fn new(file: &'a str, text: &'a str) -> Source<'a> {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
        Source { file, text, ends }
    }

    /// The place of a byte of the text: `plate.toml, line 14`.
    pub fn place(&self, byte: usize) -> String {
        let line = 1 + self.ends.partition_point(|end| *end < byte);
        format!("{}, line {line}", self.file)
    }

    /// Parses the text as TOML.
    pub fn parse(&self) -> Result<Spanned<DeTable<'_>>, Fault> {
        DeTable::parse(self.text).map_err(|error| {
            let place = error.span().map_or(self.file.to_owned(), |span| self.place(span.start));
            Fault::new(format!("This is not TOML: {}", error.message().replace('\n', ", "))).at(place)
        })
    }
}

/// One table, with its place.
#[derive(Clone, Copy)]
pub(in crate::core) struct Table<'a> {
    source: &'a Source<'a>,
    table: &'a DeTable<'a>,
    start: usize,
}

/// One value under its key.
#[derive(Clone)]
pub(in crate::core) struct Value<'a> {
    source: &'a Source<'a>,
    key: String,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Table<'a> {
    /// The whole document.
    pub fn document(source: &'a Source<'a>, table: &'a Spanned<DeTable<'a>>) -> Self {
        Table { source, table: table.get_ref(), start: 0 }
    }

    /// File and line of the table.
    pub fn place(&self) -> String {
        self.source.place(self.start)
    }

    /// A fault placed at this table.
    pub fn fault(&self, what: impl Into<String>) -> Fault {
        Fault::new(what).at(self.place())
    }

    /// Rejects the first key in the file that is not in `known`.
    pub fn only(&self, known: &[&str]) -> Result<(), Fault> {
        let unknown = self.table.keys().filter(|k| !known.contains(&k.get_ref().as_ref()));
        match unknown.min_by_key(|k| k.span().start) {
            None => Ok(()),
            Some(key) => Err(unknown_key(key.get_ref(), known).at(self.source.place(key.span().start))),
        }
    }

    /// The value of an optional key.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        let value = self.table.get(key)?;
        Some(Value { source: self.source, key: key.to_owned(), value })
    }

    /// The value of a required key.
    pub fn need(&self, key: &str, example: &str) -> Result<Value<'a>, Fault> {
        self.get(key).ok_or_else(|| {
            self.fault(format!("The key \"{key}\" is missing")).remedy(format!("Write for example {key} = {example}"))
        })
    }

    /// Keys and values in the order of the file.
    pub fn entries(&self) -> Vec<Value<'a>> {
        let mut entries: Vec<_> = self.table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let value = |(key, value): (&Spanned<toml::de::DeString<'a>>, &'a Spanned<DeValue<'a>>)| Value {
            source: self.source,
            key: key.get_ref().clone().into_owned(),
            value,
        };
        entries.into_iter().map(value).collect()
    }

    /// The tables of `[[key]]`; empty if absent.
    pub fn tables(&self, key: &str) -> Result<Vec<Table<'a>>, Fault> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let wrong = || value.wrong("a list of tables", &format!("[[{key}]]"));
        let array = value.value.get_ref().as_array().ok_or_else(wrong)?;
        let tables = array.iter().map(|entry| {
            let table = entry.get_ref().as_table().ok_or_else(wrong)?;
            Ok(Table { source: self.source, table, start: entry.span().start })
        });
        tables.collect()
    }
}

impl<'a> Value<'a> {
    /// Its key, in lists with the index ("points[2]").
    pub fn key(&self) -> &str {
        &self.key
    }

    /// File and line of the value.
    pub fn place(&self) -> String {
        self.source.place(self.value.span().start)
    }

    /// A fault placed at this value.
    pub fn fault(&self, what: impl Into<String>) -> Fault {
        Fault::new(what).at(self.place())
    }

    /// The value as written, shortened for a message.
    pub fn written(&self) -> String {
        let text = self.source.text.get(self.value.span()).unwrap_or_default();
        let mut words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        if words.chars().count() > 40 {
            words = words.chars().take(37).chain("...".chars()).collect();
        }
        words
    }

    /// The fault of a value that is not `what`.
    pub fn wrong(&self, what: &str, example: &str) -> Fault {
        self.fault(format!("{} = {} is not {what}", self.key, self.written()))
            .remedy(format!("Write for example {example}"))
    }

    /// The fault of a name that is not among the `known` ones of its kind.
    pub fn unknown<'n>(&self, kind: &str, name: &str, known: impl Iterator<Item = &'n str>) -> Fault {
        let fault = self.fault(format!("There is no {kind} \"{}\"", name.escape_debug()));
        match nearest(name, known) {
            Some(near) => fault.remedy(format!("The nearest name is \"{near}\"")),
            None => fault.remedy(format!("Add it as [[{kind}]]")),
        }
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64, Fault> {
        let number = match self.value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64),
            _ => None,
        };
        number.filter(|n| n.is_finite()).ok_or_else(|| self.wrong("a number", &format!("{} = 0.5", self.key)))
    }

    /// A positive number.
    pub fn positive(&self) -> Result<f64, Fault> {
        let number = self.number()?;
        if number > 0.0 { Ok(number) } else { Err(self.wrong("greater than 0", &format!("{} = 0.5", self.key))) }
    }

    /// An angle in radians, given in degrees.
    pub fn degrees(&self) -> Result<f64, Fault> {
        let number = self.number().map_err(|_| {
            self.fault(format!("{} = {} is not a number", self.key, self.written()))
                .remedy(format!("Write degrees without a unit: {} = 90", self.key))
        })?;
        Ok(number.to_radians())
    }

    /// An integer from `least` to `most`.
    pub fn count(&self, least: u32, most: u32) -> Result<u32, Fault> {
        let number = match self.value.get_ref() {
            DeValue::Integer(integer) => u32::from_str_radix(integer.as_str(), integer.radix()).ok(),
            _ => None,
        };
        number.filter(|n| (least..=most).contains(n)).ok_or_else(|| {
            self.wrong(&format!("a whole number from {least} to {most}"), &format!("{} = {least}", self.key))
        })
    }

    /// true or false.
    pub fn flag(&self) -> Result<bool, Fault> {
        self.value.get_ref().as_bool().ok_or_else(|| self.wrong("true or false", &format!("{} = true", self.key)))
    }

    /// A text.
    pub fn text(&self) -> Result<&'a str, Fault> {
        self.value.get_ref().as_str().ok_or_else(|| self.wrong("a text", &format!("{} = \"...\"", self.key)))
    }

    /// A formula: a text, or a number as its own formula.
    pub fn formula(&self) -> Result<String, Fault> {
        match self.value.get_ref() {
            DeValue::String(text) => Ok(text.clone().into_owned()),
            _ => self.number().map(|n| n.to_string()).map_err(|_| {
                self.wrong("a formula", &format!("{} = \"0.1 + 0.05*x\", or {} = 0.1", self.key, self.key))
            }),
        }
    }

    /// The text for [`Parameters::set`]: numbers as written; strings without quotes for parameters that are words, and
    /// with quotes (which it rejects) for numbers.
    pub fn parameter_text(&self) -> String {
        match self.value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().to_owned(),
            DeValue::Float(float) => float.as_str().to_owned(),
            DeValue::String(text) if matches!(Parameters::kind_of(&self.key), Some(ParameterKind::Word(_))) => {
                text.clone().into_owned()
            }
            _ => self.written(),
        }
    }

    /// The values of a list.
    pub fn list(&self) -> Result<Vec<Value<'a>>, Fault> {
        let array = self.value.get_ref().as_array();
        let array = array.ok_or_else(|| self.wrong("a list", &format!("{} = [..., ...]", self.key)))?;
        let entry = |(i, value): (usize, &'a Spanned<DeValue<'a>>)| Value {
            source: self.source,
            key: format!("{}[{i}]", self.key),
            value,
        };
        Ok(array.iter().enumerate().map(entry).collect())
    }

    /// A list of texts.
    pub fn texts(&self) -> Result<Vec<String>, Fault> {
        let wrong = |_| self.wrong("a list of names", &format!("{} = [\"a\", \"b\"]", self.key));
        let list = self.list().map_err(wrong)?;
        list.iter().map(|v| v.text().map(str::to_owned)).collect()
    }

    /// A list of numbers.
    pub fn numbers(&self) -> Result<Vec<f64>, Fault> {
        self.list()?.iter().map(Value::number).collect()
    }

    /// A point: a list of two numbers.
    pub fn point(&self) -> Result<DVec2, Fault> {
        let wrong = || self.wrong("a point", &format!("{} = [0.5, 1.0]", self.key));
        let numbers = self.list().map_err(|_| wrong())?;
        match numbers.as_slice() {
            [x, y] => Ok(DVec2::new(x.number()?, y.number()?)),
            _ => Err(wrong()),
        }
    }

    /// A list of points.
    pub fn points(&self) -> Result<Vec<DVec2>, Fault> {
        self.list()?.iter().map(Value::point).collect()
    }

    /// A table.
    pub fn table(&self) -> Result<Table<'a>, Fault> {
        let table = self.value.get_ref().as_table();
        let table = table.ok_or_else(|| self.wrong("a table", &format!("[{}]", self.key)))?;
        Ok(Table { source: self.source, table, start: self.value.span().start })
    }
}
