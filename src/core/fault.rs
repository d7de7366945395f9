//! What is wrong with an input, where, and what to do about it: the one error type of `core`.

use std::fmt;

use glam::DVec3;

/// Maximum number of elements shown for a fault.
const SHOWN: usize = 1000;

/// A rejection of bad input: what is wrong, where, and what to do, each as a readable phrase.
///
/// Displayed as one line: `place: what. remedy.` Bugs are assertions, never a `Fault`; a failed candidate inside the
/// converter is an event and never a `Fault`.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What is wrong, a sentence without its full stop ("The loop \"hole\" has 27 segments").
    pub what: String,
    /// Where: a file with its line, the name of a curve, a point; may be empty.
    pub place: String,
    /// What to do about it, a sentence without its full stop; may be empty.
    pub remedy: String,
    /// The elements concerned, for display, each by its corners in space: one for a point, two for an edge, three or
    /// more for a triangle or polygon.
    pub shapes: Vec<Vec<DVec3>>,
    /// Whether this is no error but a cancellation.
    pub is_stop: bool,
}

impl Fault {
    /// A fault without a place or a remedy.
    pub fn new(what: impl Into<String>) -> Self {
        Fault { what: what.into(), place: String::new(), remedy: String::new(), shapes: Vec::new(), is_stop: false }
    }

    /// The fault of cancelled work (`progress::Cancel`).
    pub fn stopped() -> Self {
        Fault { is_stop: true, ..Fault::new("The work was stopped") }
    }

    /// Adds a place; an outer place ("plate.toml, line 14") precedes an inner one.
    #[must_use]
    pub fn at(mut self, place: impl Into<String>) -> Self {
        let outer = place.into();
        self.place = if self.place.is_empty() { outer } else { format!("{outer}, {}", self.place) };
        self
    }

    /// Adds the elements concerned, by their corners, up to a maximum.
    #[must_use]
    pub fn showing(mut self, shapes: impl IntoIterator<Item = Vec<DVec3>>) -> Self {
        self.shapes.extend(shapes.into_iter().take(SHOWN));
        self
    }

    /// Adds what to do about it.
    #[must_use]
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = remedy.into();
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "{}.", self.what)?;
        if !self.remedy.is_empty() {
            write!(f, " {}.", self.remedy)?;
        }
        Ok(())
    }
}

impl std::error::Error for Fault {}
