//! The moment at which a base is selected: an explanation of the selection is true of the front as it was then.

use crate::core::convert::{Converter, Event};
use crate::core::mesh::NodeId;
use crate::core::run::front_table::FrontTable;

/// The base of the quadrilateral under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SelectedBase {
    /// The step that selected it.
    pub step: u64,
    /// Its left node.
    pub a: NodeId,
    /// Its right node.
    pub b: NodeId,
    /// Whether the user picked it, regardless of its rank.
    pub picked: bool,
}

/// What a selection looks at: the front as it was when the base under way was selected; else the front as it is.
#[derive(Clone, Debug)]
pub struct Selecting {
    /// The front, and the parameters by which it was, or is, ordered.
    pub table: FrontTable,
    /// The base that was selected from it; none where no quadrilateral is under way.
    pub base: Option<SelectedBase>,
}

impl Selecting {
    /// The selection of a base, from the state before it and its event; `None` where the event is another one.
    pub fn of_base(before: &Converter<'_>, event: &Event) -> Option<Selecting> {
        let Event::BaseSelected { a, b, picked, .. } = *event else { return None };
        let base = SelectedBase { step: before.counts.steps + 1, a, b, picked };
        Some(Selecting { table: FrontTable::of(before), base: Some(base) })
    }

    /// The next selection, from a state in which no quadrilateral is under way; `None` in others: what they have to say
    /// about their base is no longer in them.
    pub fn next(state: &Converter<'_>) -> Option<Selecting> {
        state.phase().base().is_none().then(|| Selecting { table: FrontTable::of(state), base: None })
    }
}
