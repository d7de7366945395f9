//! What a learner chooses from.

use crate::core::kernel::worded::worded;

worded! {
    /// What a learner chooses from.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Choice by name {
        /// Yes.
        Yes = "yes",
        /// No.
        No = "no",
        /// Class 1 of table 1.
        First = "1",
        /// Class 2.
        Second = "2",
        /// Class 3.
        Third = "3",
        /// Class 4.
        Fourth = "4",
        /// The top edge is there.
        There = "there",
        /// An edge is swapped for it.
        Swap = "swap",
        /// A node is removed for it.
        Removal = "removal",
        /// The attempt fails.
        Failure = "failure",
        /// At most theta_seam.
        Seam = "seam",
        /// Below theta_rect.
        Rectangle = "rectangle",
        /// From theta_rect to theta_revr.
        Flat = "flat",
        /// Beyond theta_revr.
        Reversal = "reversal",
    }
}

impl Choice {
    /// The class of table 1.
    pub(super) fn of_class(class: u8) -> Choice {
        match class {
            1 => Choice::First,
            2 => Choice::Second,
            3 => Choice::Third,
            _ => Choice::Fourth,
        }
    }

    /// Yes or no.
    pub(super) fn of(is: bool) -> Choice {
        if is { Choice::Yes } else { Choice::No }
    }

    /// Its words for readers.
    pub fn words(self) -> &'static str {
        match self {
            Choice::Yes => "Yes",
            Choice::No => "No",
            Choice::First => "Class 1",
            Choice::Second => "Class 2",
            Choice::Third => "Class 3",
            Choice::Fourth => "Class 4",
            Choice::There => "It is there already",
            Choice::Swap => "An edge across it is swapped",
            Choice::Removal => "A node in its way is removed",
            Choice::Failure => "It cannot be recovered",
            Choice::Seam => "Narrow enough for a seam",
            Choice::Rectangle => "Below \u{3b8}_{rect}",
            Choice::Flat => "From \u{3b8}_{rect} to \u{3b8}_{revr}",
            Choice::Reversal => "A reversal",
        }
    }
}
