//! Conditions over a table of fields, such as `kind == seamed && quad.min_angle < 30`.
//!
//! ```text
//! condition  = both { "||" both }
//! both       = one { "&&" one }
//! one        = "!" one | "(" condition ")" | field [ ("==" | "!=" | "<" | "<=" | ">" | ">=") value ]
//! value      = a number (angles in degrees) | a word
//! ```
//!
//! A comparison with a field that a row does not have is false.

use super::spelling::nearest;
use crate::core::fault::{Fault, FaultKind};

/// The type of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// A number.
    Number,
    /// An angle in degrees.
    Degrees,
    /// Yes or no: the field by itself is a condition.
    Flag,
    /// One of some words; each `short` word stands for another.
    Words {
        /// The words.
        words: &'static [&'static str],
        /// Shorter words, each with the word that it stands for.
        short: &'static [(&'static str, &'static str)],
    },
}

impl Holds {
    /// The words that a field of this type can be compared with; none for numbers.
    pub fn words(self) -> &'static [&'static str] {
        match self {
            Holds::Words { words, .. } => words,
            Holds::Flag => &["true", "false"],
            Holds::Number | Holds::Degrees => &[],
        }
    }

    /// Whether it holds numbers, which have an order.
    pub fn is_number(self) -> bool {
        matches!(self, Holds::Number | Holds::Degrees)
    }

    /// Reads a value of this type.
    fn value(self, word: &str) -> Option<Value> {
        match self {
            Holds::Number | Holds::Degrees => word.parse().ok().filter(|n: &f64| n.is_finite()).map(Value::Number),
            Holds::Flag => word.parse().ok().map(Value::Flag),
            Holds::Words { words, short } => {
                let word = short.iter().find(|(short, _)| *short == word).map_or(word, |(_, long)| *long);
                words.iter().find(|known| **known == word).map(|known| Value::Word(known))
            }
        }
    }
}

/// The value of a field, or the one that it is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number; an angle in degrees.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// One of the words of the field.
    Word(&'static str),
}

impl Value {
    /// A number, in the form that tables of fields have.
    pub fn number(number: impl Into<f64>) -> Option<Value> {
        Some(Value::Number(number.into()))
    }

    /// An angle in radians, as degrees.
    pub fn degrees(radians: f64) -> Option<Value> {
        Value::number(radians.to_degrees())
    }
}

/// A field that conditions can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub holds: Holds,
    /// Its meaning, for people who write conditions.
    pub doc: &'static str,
}

/// Makes a table of fields over rows of a type: `FIELDS`, and `VALUES`, the function that gives each of them.
macro_rules! fields {
    ($row:ty; $($name:literal: $holds:expr, $doc:literal => $of:expr;)*) => {
        /// All fields, in the order of the list that users see.
        pub const FIELDS: &[$crate::core::kernel::condition::Field] =
            &[$($crate::core::kernel::condition::Field { name: $name, holds: $holds, doc: $doc },)*];

        /// For each of [`FIELDS`], the function that gives its value.
        pub(super) const VALUES: &[fn(&$row) -> Option<$crate::core::kernel::condition::Value>] = &[$($of,)*];
    };
}

pub(crate) use fields;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comparison {
    Equal,
    Unequal,
    Less,
    AtMost,
    Greater,
    AtLeast,
}

#[derive(Clone, Debug, PartialEq)]
enum Tree {
    Any(Vec<Tree>),
    All(Vec<Tree>),
    Not(Box<Tree>),
    /// A field, by its index in the table, compared with a value.
    Compare(usize, Comparison, Value),
}

/// A parsed condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    text: String,
    tree: Tree,
}

impl Condition {
    /// Parses a condition over a table of fields.
    ///
    /// # Errors
    /// A syntax error or an unknown name, with the position of the first wrong character (from 1) and the nearest known
    /// name.
    pub fn parse(text: &str, fields: &[Field]) -> Result<Condition, Fault> {
        Condition::parsed(text, fields).map_err(|fault| fault.of_kind(FaultKind::Syntax))
    }

    fn parsed(text: &str, fields: &[Field]) -> Result<Condition, Fault> {
        let mut reader = Reader { text, fields, at: 0 };
        let tree = reader.any()?;
        reader.skip_blanks();
        if reader.at < text.len() {
            return Err(reader.fault("The condition should end here").remedy("Join conditions with && or ||"));
        }
        Ok(Condition { text: text.trim().to_owned(), tree })
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it holds for a row that gives the value of each field of the table, by index.
    pub fn holds(&self, value: impl Fn(usize) -> Option<Value>) -> bool {
        self.tree.holds(&value)
    }
}

impl Tree {
    fn holds(&self, of: &impl Fn(usize) -> Option<Value>) -> bool {
        match self {
            Tree::Any(trees) => trees.iter().any(|tree| tree.holds(of)),
            Tree::All(trees) => trees.iter().all(|tree| tree.holds(of)),
            Tree::Not(tree) => !tree.holds(of),
            Tree::Compare(field, comparison, value) => match (of(*field), value) {
                (None, _) => false,
                (Some(Value::Number(found)), Value::Number(value)) => match comparison {
                    Comparison::Equal => found == *value,
                    Comparison::Unequal => found != *value,
                    Comparison::Less => found < *value,
                    Comparison::AtMost => found <= *value,
                    Comparison::Greater => found > *value,
                    Comparison::AtLeast => found >= *value,
                },
                (Some(found), value) => (found == *value) == (*comparison == Comparison::Equal),
            },
        }
    }
}

struct Reader<'t> {
    text: &'t str,
    fields: &'t [Field],
    at: usize,
}

impl<'t> Reader<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    fn fault(&self, what: impl Into<String>) -> Fault {
        self.fault_at(self.at, what)
    }

    fn fault_at(&self, at: usize, what: impl Into<String>) -> Fault {
        Fault::new(what).at(format!("position {}", self.text[..at].chars().count() + 1))
    }

    fn take(&mut self, sign: &str) -> bool {
        self.skip_blanks();
        let found = self.rest().starts_with(sign);
        if found {
            self.at += sign.len();
        }
        found
    }

    fn any(&mut self) -> Result<Tree, Fault> {
        let mut trees = vec![self.all()?];
        while self.take("||") {
            trees.push(self.all()?);
        }
        Ok(if trees.len() == 1 { trees.remove(0) } else { Tree::Any(trees) })
    }

    fn all(&mut self) -> Result<Tree, Fault> {
        let mut trees = vec![self.one()?];
        while self.take("&&") {
            trees.push(self.one()?);
        }
        Ok(if trees.len() == 1 { trees.remove(0) } else { Tree::All(trees) })
    }

    fn one(&mut self) -> Result<Tree, Fault> {
        // Many signs nest deeply: limit the depth before the recursion exhausts the stack.
        let mut negated = 0;
        while !self.rest_starts_with("!=") && self.take("!") {
            negated += 1;
        }
        let tree = if self.take("(") {
            let depth = self.text[..self.at].matches('(').count() - self.text[..self.at].matches(')').count();
            if depth > 100 {
                return Err(self.fault("The parentheses are nested too deeply").remedy("Simplify the condition"));
            }
            let tree = self.any()?;
            if !self.take(")") {
                return Err(self.fault("A parenthesis is not closed").remedy("Write ) here"));
            }
            tree
        } else {
            self.comparison()?
        };
        Ok(if negated % 2 == 1 { Tree::Not(Box::new(tree)) } else { tree })
    }

    fn rest_starts_with(&mut self, sign: &str) -> bool {
        self.skip_blanks();
        self.rest().starts_with(sign)
    }

    fn comparison(&mut self) -> Result<Tree, Fault> {
        self.skip_blanks();
        let start = self.at;
        let name = self.word();
        if name.is_empty() {
            let what = if self.rest().is_empty() { "The condition ends here" } else { "A field was expected here" };
            let example = self.fields.first().map_or_else(String::new, example);
            return Err(self.fault(what).remedy(format!("Write for example {example}")));
        }
        let Some(field) = self.fields.iter().position(|field| field.name == name) else {
            let fault = self.fault_at(start, format!("The field \"{name}\" does not exist"));
            let known = self.fields.iter().map(|field| field.name);
            return Err(match nearest(name, known.clone()) {
                Some(near) => fault.remedy(format!("The nearest known field is \"{near}\"")),
                None => fault.remedy(format!("Use one of: {}", known.collect::<Vec<_>>().join(", "))),
            });
        };
        let holds = self.fields[field].holds;
        let signs = [
            ("==", Comparison::Equal),
            ("!=", Comparison::Unequal),
            ("<=", Comparison::AtMost),
            (">=", Comparison::AtLeast),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        self.skip_blanks();
        let sign = self.at;
        let Some((_, comparison)) = signs.into_iter().find(|(sign, _)| self.take(sign)) else {
            if holds == Holds::Flag {
                return Ok(Tree::Compare(field, Comparison::Equal, Value::Flag(true)));
            }
            let example = example(&self.fields[field]);
            return Err(self.fault("A comparison is missing").remedy(format!("Write for example {example}")));
        };
        if !holds.is_number() && !matches!(comparison, Comparison::Equal | Comparison::Unequal) {
            return Err(self.fault_at(sign, format!("{name} has no order")).remedy("Compare it with == or !="));
        }
        self.value(name, holds).map(|value| Tree::Compare(field, comparison, value))
    }

    fn value(&mut self, name: &str, holds: Holds) -> Result<Value, Fault> {
        self.skip_blanks();
        let start = self.at;
        let quoted = self.take("\"");
        let word = self.word();
        if quoted && !self.take("\"") {
            return Err(self.fault("A quotation mark is missing").remedy("Words need no quotation marks"));
        }
        holds.value(word).ok_or_else(|| {
            if holds.is_number() {
                let unit = if holds == Holds::Degrees { " of degrees, without a unit" } else { "" };
                let fault = self.fault_at(start, format!("{name} is compared with a number"));
                return fault.remedy(format!("Write a number{unit}"));
            }
            let fault = self.fault_at(start, format!("{name} is never \"{word}\""));
            match nearest(word, holds.words().iter().copied()) {
                Some(near) => fault.remedy(format!("The nearest known word is \"{near}\"")),
                None => fault.remedy(format!("Use one of: {}", holds.words().join(", "))),
            }
        })
    }

    fn word(&mut self) -> &'t str {
        self.skip_blanks();
        let rest = self.rest();
        let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+');
        let end = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }
}

/// A condition on a field, for messages.
fn example(field: &Field) -> String {
    let name = field.name;
    field.holds.words().first().map_or_else(|| format!("{name} < 30"), |word| format!("{name} == {word}"))
}
