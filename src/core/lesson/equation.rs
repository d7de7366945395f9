//! Equations: a part of TeX's notation, read strictly into a tree. What is drawn of it is a matter of
//! `render/equation`; here it is read, gets numbers of the state, and is said as text.

mod linear;
mod parser;
mod signs;

pub use signs::{Class, Sign, all as signs};

use super::value::Quantity;
use crate::core::fault::Fault;

/// An equation, as a lesson has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    tex: String,
    row: Row,
}

/// Terms one after another.
pub type Row = Vec<Term>;

/// What an equation is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// A letter, an operator, a bracket that does not grow.
    Sign(Sign),
    /// Digits, perhaps with a point.
    Digits(String),
    /// Words, upright.
    Text(String),
    /// A function by its name; its limits stand below and above it if it has such.
    Function {
        /// Its name.
        name: &'static str,
        /// Whether what stands below and above it are limits.
        has_limits: bool,
    },
    /// A number of the state that is to be put in.
    Value(Quantity),
    /// Terms in braces.
    Group(Row),
    /// A fraction.
    Fraction {
        /// The numerator.
        above: Row,
        /// The denominator.
        below: Row,
    },
    /// A root.
    Root {
        /// The third root has a 3 here, the square root nothing.
        degree: Row,
        /// What it is the root of.
        inside: Row,
    },
    /// A term with what stands at its lower and upper right, or below and above it.
    Scripts {
        /// The term.
        base: Box<Term>,
        /// Its subscript or lower limit; may be empty.
        low: Row,
        /// Its superscript or upper limit; may be empty.
        high: Row,
    },
    /// Terms between brackets that grow with them.
    Fenced {
        /// The left and the right bracket, where there is one.
        fences: [Option<char>; 2],
        /// What is between them.
        inside: Row,
    },
    /// Room, in eighteenths of the font size.
    Space(i8),
}

impl Equation {
    /// Reads what stands between the dollars.
    ///
    /// # Errors
    /// With the byte of its place: an unknown command or character, an argument or bracket that is missing.
    pub fn parse(tex: &str) -> Result<Equation, (Fault, usize)> {
        let row = parser::read(tex)?;
        Ok(Equation { tex: tex.split_whitespace().collect::<Vec<_>>().join(" "), row })
    }

    /// As it was written, in TeX's notation.
    pub fn tex(&self) -> &str {
        &self.tex
    }

    /// Its terms.
    pub fn row(&self) -> &[Term] {
        &self.row
    }

    /// As text in one line, for a terminal and for screen readers: `h_i = 1/sqrt(λ_i)`.
    pub fn text(&self) -> String {
        linear::text(&self.row)
    }

    /// The same with the numbers of a state put in.
    ///
    /// # Errors
    /// That of `number`, for a state that does not have one.
    pub(super) fn with_numbers(&self, number: impl Fn(Quantity) -> Result<String, Fault>) -> Result<Self, Fault> {
        Ok(Equation { tex: self.tex.clone(), row: put_in(&self.row, &number)? })
    }
}

type Number<'a> = &'a dyn Fn(Quantity) -> Result<String, Fault>;

fn put_in(row: &[Term], number: Number<'_>) -> Result<Row, Fault> {
    row.iter().map(|term| put_into(term, number)).collect()
}

fn put_into(term: &Term, number: Number<'_>) -> Result<Term, Fault> {
    Ok(match term {
        Term::Value(quantity) => Term::Text(number(*quantity)?),
        Term::Group(row) => Term::Group(put_in(row, number)?),
        Term::Fraction { above, below } => {
            Term::Fraction { above: put_in(above, number)?, below: put_in(below, number)? }
        }
        Term::Root { degree, inside } => {
            Term::Root { degree: put_in(degree, number)?, inside: put_in(inside, number)? }
        }
        Term::Scripts { base, low, high } => Term::Scripts {
            base: Box::new(put_into(base, number)?),
            low: put_in(low, number)?,
            high: put_in(high, number)?,
        },
        Term::Fenced { fences, inside } => Term::Fenced { fences: *fences, inside: put_in(inside, number)? },
        Term::Sign(_) | Term::Digits(_) | Term::Text(_) | Term::Function { .. } | Term::Space(_) => term.clone(),
    })
}

impl Term {
    /// What it is to its neighbours; `None` for room.
    pub fn class(&self) -> Option<Class> {
        Some(match self {
            Term::Sign(sign) => sign.class,
            Term::Function { .. } => Class::Operator,
            Term::Scripts { base, .. } => return base.class(),
            Term::Fraction { .. } | Term::Fenced { .. } => Class::Inner,
            Term::Space(_) => return None,
            Term::Digits(_) | Term::Text(_) | Term::Value(_) | Term::Group(_) | Term::Root { .. } => Class::Ordinary,
        })
    }

    /// Whether what stands at it are limits, below and above it where there is room.
    pub fn has_limits(&self) -> bool {
        match self {
            Term::Sign(sign) => sign.has_limits(),
            Term::Function { has_limits, .. } => *has_limits,
            _ => false,
        }
    }
}

/// What each term of a row is to its neighbours: a minus is no operation between two terms where there are not two of
/// them, and bars open and close in turn.
pub fn classes(row: &[Term]) -> Vec<Option<Class>> {
    let mut classes: Vec<Option<Class>> = Vec::with_capacity(row.len());
    let mut before = None;
    let mut last = None;
    let mut is_open = false;
    for (at, term) in row.iter().enumerate() {
        let mut class = term.class();
        let bar = match term {
            Term::Scripts { base, .. } => &**base,
            term => term,
        };
        if matches!(bar, Term::Sign(Sign { glyph: '|', .. })) {
            class = Some(if is_open { Class::Closing } else { Class::Opening });
            is_open = !is_open;
        }
        let has_left = !matches!(
            before,
            None | Some(Class::Binary | Class::Operator | Class::Relation | Class::Opening | Class::Punctuation)
        );
        if class == Some(Class::Binary) && !has_left {
            class = Some(Class::Ordinary);
        }
        if matches!(class, Some(Class::Relation | Class::Closing | Class::Punctuation))
            && before == Some(Class::Binary)
            && let Some(last) = last
        {
            classes[last] = Some(Class::Ordinary);
        }
        if class.is_some() {
            (before, last) = (class, Some(at));
        }
        classes.push(class);
    }
    if let (Some(Class::Binary), Some(last)) = (before, last) {
        classes[last] = Some(Class::Ordinary);
    }
    classes
}

#[cfg(test)]
mod tests;
