//! Typed access to the parameters of instances; every fault names the instance, its keyword and its line.

use super::DAMAGED;
use super::exchange::{Exchange, Instance, Value};
use super::text::decoded;
use crate::core::fault::Fault;

/// An instance together with its file.
pub(super) struct Entity<'m, 'a> {
    pub file: &'m Exchange<'a>,
    pub instance: Instance<'a>,
}

impl<'a> Exchange<'a> {
    /// The instance of a number, for access to its parameters.
    ///
    /// # Errors
    /// Those of [`Exchange::instance`].
    pub fn entity(&self, id: u64) -> Result<Entity<'_, 'a>, Fault> {
        Ok(Entity { file: self, instance: self.instance(id)? })
    }
}

impl<'a> Entity<'_, 'a> {
    /// Its number.
    pub fn id(&self) -> u64 {
        self.instance.id
    }

    /// Whether one of its records has the keyword.
    pub fn is(&self, keyword: &str) -> bool {
        self.instance.is(keyword)
    }

    /// The keyword of its first record.
    pub fn keyword(&self) -> &'a str {
        self.instance.records[0].0
    }

    /// The parameters of its first record.
    pub fn first(&self) -> Fields<'_, 'a> {
        self.of_record(0)
    }

    /// The parameters of the record with the keyword, if there is one.
    pub fn record(&self, keyword: &str) -> Option<Fields<'_, 'a>> {
        let k = self.instance.records.iter().position(|record| record.0 == keyword)?;
        Some(self.of_record(k))
    }

    fn of_record(&self, k: usize) -> Fields<'_, 'a> {
        let (keyword, values) = &self.instance.records[k];
        Fields { file: self.file, id: self.instance.id, keyword, values }
    }

    /// The parameters of the record with the keyword.
    ///
    /// # Errors
    /// An instance without it.
    pub fn fields(&self, keyword: &str) -> Result<Fields<'_, 'a>, Fault> {
        self.record(keyword).ok_or_else(|| self.unexpected(&format!("a {keyword}")))
    }

    /// The fault of an instance that stands where another kind should.
    pub fn unexpected(&self, expected: &str) -> Fault {
        let what = format!("#{} is a {}, not {expected}", self.id(), self.instance.keyword());
        self.file.fault_at(self.id(), what).remedy(DAMAGED)
    }

    /// A fault about it: "The cone #12" and the rest of the sentence.
    pub fn fault(&self, what: impl Into<String>) -> Fault {
        self.file.fault_at(self.id(), what)
    }
}

/// The parameters of a record.
#[derive(Clone, Copy)]
pub(super) struct Fields<'v, 'a> {
    file: &'v Exchange<'a>,
    id: u64,
    keyword: &'a str,
    values: &'v [Value<'a>],
}

impl<'v, 'a> Fields<'v, 'a> {
    fn wrong(&self, i: usize, expected: &str) -> Fault {
        let what = format!("Parameter {} of #{}, {}, is not {expected}", i + 1, self.id, self.keyword);
        self.file.fault_at(self.id, what).remedy(DAMAGED)
    }

    /// A fault about the instance: what is said after its number and keyword.
    pub fn refused(&self, what: &str) -> Fault {
        self.file.fault_at(self.id, format!("#{}, {}, {what}", self.id, self.keyword)).remedy(DAMAGED)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// The same from the parameter `from` on.
    pub fn from(self, from: usize) -> Self {
        Fields { values: self.values.get(from..).unwrap_or_default(), ..self }
    }

    /// Whether a parameter is given.
    pub fn has(&self, i: usize) -> bool {
        !matches!(self.values.get(i), None | Some(Value::Absent))
    }

    /// A finite number; that of a value with its type as well.
    pub fn number(&self, i: usize) -> Result<f64, Fault> {
        self.values.get(i).and_then(number).ok_or_else(|| self.wrong(i, "a number"))
    }

    /// A whole number from 0 to a billion.
    pub fn count(&self, i: usize) -> Result<usize, Fault> {
        let found = self.number(i)?;
        if (0.0..=1e9).contains(&found) && found.fract() == 0.0 {
            Ok(found as usize)
        } else {
            Err(self.wrong(i, "a whole number"))
        }
    }

    /// `.T.` or `.F.`.
    pub fn flag(&self, i: usize) -> Result<bool, Fault> {
        match self.values.get(i) {
            Some(Value::Word("T" | "TRUE")) => Ok(true),
            Some(Value::Word("F" | "FALSE")) => Ok(false),
            _ => Err(self.wrong(i, ".T. or .F.")),
        }
    }

    /// The word of an enumeration, if the parameter is one.
    pub fn word(&self, i: usize) -> Option<&'a str> {
        match self.values.get(i) {
            Some(Value::Word(word)) => Some(word),
            _ => None,
        }
    }

    /// A text without white space at its ends; empty if none is given.
    pub fn text(&self, i: usize) -> String {
        match self.values.get(i) {
            Some(Value::Text(raw)) => decoded(raw).trim().to_owned(),
            _ => String::new(),
        }
    }

    /// A reference.
    pub fn instance(&self, i: usize) -> Result<u64, Fault> {
        match self.values.get(i) {
            Some(Value::Instance(id)) => Ok(*id),
            _ => Err(self.wrong(i, "a reference")),
        }
    }

    fn list(&self, i: usize) -> Result<&'v [Value<'a>], Fault> {
        match self.values.get(i) {
            Some(Value::List(list)) => Ok(list),
            _ => Err(self.wrong(i, "a list")),
        }
    }

    /// A list of references.
    pub fn instances(&self, i: usize) -> Result<Vec<u64>, Fault> {
        self.references(i, self.list(i)?)
    }

    fn references(&self, i: usize, list: &[Value<'a>]) -> Result<Vec<u64>, Fault> {
        let one = |value: &Value<'a>| if let Value::Instance(id) = value { Some(*id) } else { None };
        list.iter().map(one).collect::<Option<_>>().ok_or_else(|| self.wrong(i, "a list of references"))
    }

    /// A list of finite numbers.
    pub fn numbers(&self, i: usize) -> Result<Vec<f64>, Fault> {
        let found = self.list(i)?.iter().map(number).collect::<Option<_>>();
        found.ok_or_else(|| self.wrong(i, "a list of numbers"))
    }

    /// The rows of a list of lists.
    fn rows(&self, i: usize) -> Result<Vec<&'v [Value<'a>]>, Fault> {
        let one = |value: &'v Value<'a>| if let Value::List(row) = value { Some(&row[..]) } else { None };
        let found = self.list(i)?.iter().map(one).collect::<Option<Vec<_>>>();
        found.ok_or_else(|| self.wrong(i, "a list of lists"))
    }

    /// A list of lists of references.
    pub fn rows_of_instances(&self, i: usize) -> Result<Vec<Vec<u64>>, Fault> {
        self.rows(i)?.into_iter().map(|row| self.references(i, row)).collect()
    }

    /// A list of lists of finite numbers.
    pub fn rows_of_numbers(&self, i: usize) -> Result<Vec<Vec<f64>>, Fault> {
        let one = |row: &[Value<'a>]| row.iter().map(number).collect::<Option<Vec<f64>>>();
        let found = self.rows(i)?.into_iter().map(one).collect::<Option<_>>();
        found.ok_or_else(|| self.wrong(i, "a list of lists of numbers"))
    }

    /// All references in it, also in lists.
    pub fn all_instances(&self) -> Vec<u64> {
        fn walk(value: &Value<'_>, found: &mut Vec<u64>) {
            match value {
                Value::Instance(id) => found.push(*id),
                Value::List(list) | Value::Typed(_, list) => list.iter().for_each(|value| walk(value, found)),
                _ => {}
            }
        }
        let mut found = Vec::new();
        self.values.iter().for_each(|value| walk(value, &mut found));
        found
    }
}

fn number(value: &Value<'_>) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number).filter(|number| number.is_finite()),
        Value::Typed(_, list) => match &list[..] {
            [Value::Number(number)] => Some(*number).filter(|number| number.is_finite()),
            _ => None,
        },
        _ => None,
    }
}
