//! What is wrong with an input, where, and what to do about it: the one error type of `core`.

use std::fmt;

use glam::DVec3;

/// Maximum number of elements shown for a fault.
const SHOWN: usize = 1000;

/// What a fault is about, for programs that act on it; people read the message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FaultKind {
    /// A file or stream cannot be read or written.
    Io,
    /// A file or text is not in its format, or its format is unknown.
    Syntax,
    /// Curves, faces or surfaces do not make a domain, or their boundary cannot be divided.
    Geometry,
    /// A metric field cannot be compiled, or is not positive and finite everywhere.
    Metric,
    /// A mesh that was given cannot be converted.
    Mesh,
    /// A parameter is unknown or out of range, or names something that does not exist.
    Parameter,
    /// The sizes ask for more elements than `max_quads` allows, or than there is memory for.
    Limit,
    /// Nothing is wrong: the work was told to end ([`Cancel`](super::progress::Cancel)).
    Stopped,
    /// None of these.
    #[default]
    Other,
}

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
    kind: FaultKind,
}

impl Fault {
    /// A fault without a place, a remedy or a kind yet.
    pub fn new(what: impl Into<String>) -> Self {
        let kind = FaultKind::default();
        Fault { what: what.into(), place: String::new(), remedy: String::new(), shapes: Vec::new(), kind }
    }

    /// The fault of cancelled work (`progress::Cancel`).
    pub fn stopped() -> Self {
        Fault::new("The work was stopped").of_kind(FaultKind::Stopped)
    }

    /// What it is about.
    pub fn kind(&self) -> FaultKind {
        self.kind
    }

    /// Whether nothing is wrong: somebody has asked for the work to end.
    pub fn is_stop(&self) -> bool {
        self.kind == FaultKind::Stopped
    }

    /// The same fault of a kind. One that has a kind keeps it: what found the fault knows better than what called it.
    #[must_use]
    pub fn of_kind(mut self, kind: FaultKind) -> Self {
        if self.kind == FaultKind::Other {
            self.kind = kind;
        }
        self
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
