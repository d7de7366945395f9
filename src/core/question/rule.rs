//! The rules of the paper that questions and lessons are about.

use crate::core::kernel::worded::worded;

worded! {
    /// A rule that a learner may know or miss.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Rule by name {
        /// What is live and what is dead (4.1.2).
        LiveAndDead = "live-and-dead",
        /// The front and its data (4.3.2).
        Front = "front",
        /// The classes of frontal angles (fig. 12).
        Angles = "angles",
        /// The H-value (eq. 6).
        HValue = "h-value",
        /// The order of table 1.
        Table1 = "table-1",
        /// From a base to a quadrilateral (4.3.4).
        Formation = "formation",
        /// The elementary operations (4.2).
        Operators = "operators",
        /// Side edges (4.3.4).
        SideEdges = "side-edges",
        /// The top edge (4.3.4).
        TopEdge = "top-edge",
        /// What the front is after a quadrilateral (4.3.5).
        Update = "update",
        /// Rows from the boundary (4.3.3).
        Levels = "levels",
        /// Enhancement of the structure (4.3.6).
        Enhancement = "enhancement",
        /// Smoothing (4.3.6).
        Smoothing = "smoothing",
        /// Seams (4.3.6).
        Seams = "seams",
        /// Splitting of the front (4.3.6).
        Splitting = "splitting",
        /// Loops are even.
        Parity = "parity",
    }
}

impl Rule {
    /// The rule of this name.
    pub fn named(name: &str) -> Option<Rule> {
        Rule::ALL.into_iter().find(|rule| rule.name() == name)
    }

    /// Its name for readers.
    pub fn words(self) -> &'static str {
        match self {
            Rule::LiveAndDead => "Live and dead",
            Rule::Front => "The front",
            Rule::Angles => "Frontal angles",
            Rule::HValue => "H-value",
            Rule::Table1 => "Table 1",
            Rule::Formation => "Formation",
            Rule::Operators => "Operators",
            Rule::SideEdges => "Side edges",
            Rule::TopEdge => "Top edge",
            Rule::Update => "Update of the front",
            Rule::Levels => "Rows",
            Rule::Enhancement => "Enhancement",
            Rule::Smoothing => "Smoothing",
            Rule::Seams => "Seams",
            Rule::Splitting => "Splitting",
            Rule::Parity => "Even loops",
        }
    }
}
