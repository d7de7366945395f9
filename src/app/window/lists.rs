//! The lists of elements and nodes: measured, filtered and sorted beside the window, for the panels that are in
//! sight. A table follows what changes, so that a step costs little even where a mesh is large.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Duration;

use web_time::Instant;

use super::session::Wake;
use crate::app::tasks;
use crate::core::kernel::worded::worded;
use crate::core::mesh::Mesh;
use crate::core::run::copies::Since;
use crate::core::run::{ChangeLog, Changes, ElementRow, LastChanges, Listed, Listing, NodeRow, Query, Row, Steps, csv};

worded! {
    /// A list.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ListKind by name {
        /// The elements.
        Elements = "element",
        /// The nodes.
        Nodes = "node",
    }
}

/// What a list shows of a state.
pub struct Shown {
    /// The number of the state.
    state: u64,
    query: Query,
    pub listing: Listing,
    /// How long it took to measure, filter and sort.
    pub took: Duration,
}

/// What is to be done with a table.
struct Work {
    mesh: Arc<Mesh>,
    changes: Changes,
    recorded: RecordedSteps,
    query: Query,
    /// Whether the list is wanted as text.
    as_text: bool,
}

/// What a run has recorded of the steps that made and changed things, for one of its states.
pub struct RecordedSteps {
    pub step: u64,
    /// The steps of birth by slot.
    pub born: Vec<u64>,
    pub changes: ChangeLog,
}

/// A table, and the last changes in the state that it shows.
struct Table<R> {
    rows: Listed<R>,
    changes: LastChanges,
}

impl<R: Row> Default for Table<R> {
    fn default() -> Self {
        Table { rows: Listed::default(), changes: LastChanges::default() }
    }
}

/// What has been done.
struct Done<R> {
    table: Table<R>,
    shown: Shown,
    text: Option<String>,
}

/// One of the lists.
pub struct Lister<R> {
    /// What has changed since the table followed last.
    since: Since,
    /// The table, while nothing is done with it.
    table: Option<Table<R>>,
    under_way: Option<Receiver<Done<R>>>,
    shown: Option<Arc<Shown>>,
    /// The list as text, and how often one was asked for.
    text: (u64, Arc<str>),
}

impl<R> Default for Lister<R> {
    fn default() -> Self {
        Lister { since: Since::everything(), table: None, under_way: None, shown: None, text: (0, Arc::from("")) }
    }
}

impl<R: Row + Send + 'static> Lister<R> {
    /// What is shown: of the current state and by the last query, or of those before while work is under way.
    pub fn shown(&self) -> Option<&Arc<Shown>> {
        self.shown.as_ref()
    }

    /// The list as text, unless its receiver has taken it before.
    pub fn take_text(&self, last: &mut u64) -> Option<Arc<str>> {
        (std::mem::replace(last, self.text.0) != self.text.0).then(|| Arc::clone(&self.text.1))
    }

    fn wants(&self, state: u64, query: &Query) -> bool {
        self.under_way.is_none()
            && self.shown.as_ref().is_none_or(|shown| shown.state != state || shown.query != *query)
    }

    fn start(&mut self, state: u64, work: Work, wake: Wake) {
        let mut table = self.table.take().unwrap_or_default();
        let (tell, told) = channel();
        self.under_way = Some(told);
        tasks::work(move || {
            let begin = Instant::now();
            let Work { mesh, changes, recorded, query, as_text } = work;
            let Table { rows, changes: last } = &mut table;
            last.follow(&recorded.changes, recorded.step);
            rows.follow(&mesh, &changes, |slot| Steps {
                born: recorded.born.get(slot as usize).copied().unwrap_or(0),
                changed: R::last_change(last, slot),
            });
            drop(mesh);
            let listing = rows.list(&query);
            let text = as_text.then(|| csv(listing.slots.iter().filter_map(|&slot| rows.row(slot))));
            let shown = Shown { state, query, listing, took: begin.elapsed() };
            // The run may have been closed meanwhile.
            let _ = tell.send(Done { table, shown, text });
            wake();
        });
    }

    fn hear(&mut self) {
        let Some(told) = &self.under_way else { return };
        match told.try_recv() {
            Ok(Done { table, shown, text }) => {
                (self.table, self.shown, self.under_way) = (Some(table), Some(Arc::new(shown)), None);
                if let Some(text) = text {
                    self.text = (self.text.0 + 1, Arc::from(text));
                }
            }
            Err(TryRecvError::Empty) => {}
            // Work that has failed took its table along: the next one measures everything.
            Err(TryRecvError::Disconnected) => (self.since, self.under_way) = (Since::everything(), None),
        }
    }
}

/// All lists of a run.
#[derive(Default)]
pub struct Lists {
    pub elements: Lister<ElementRow>,
    pub nodes: Lister<NodeRow>,
    /// The number of the current state.
    state: u64,
}

impl Lists {
    /// Whether a list of the current state by this query is still to be made.
    pub fn wants(&self, kind: ListKind, query: &Query) -> bool {
        match kind {
            ListKind::Elements => self.elements.wants(self.state, query),
            ListKind::Nodes => self.nodes.wants(self.state, query),
        }
    }

    /// Takes in the changes that lead to another state.
    pub fn note(&mut self, changes: &Changes, mesh: &Mesh) {
        self.state += 1;
        self.elements.since.note(changes, mesh.element_slots());
        self.nodes.since.note(changes, mesh.element_slots());
    }

    /// Makes a list of the current state, unless one is being made; `as_text` for the clipboard too.
    pub fn make(
        &mut self,
        kind: ListKind,
        query: Query,
        as_text: bool,
        mesh: Arc<Mesh>,
        recorded: RecordedSteps,
        wake: Wake,
    ) {
        let state = self.state;
        match kind {
            ListKind::Elements if self.elements.under_way.is_none() => {
                let changes = self.elements.since.take();
                self.elements.start(state, Work { mesh, changes, recorded, query, as_text }, wake);
            }
            ListKind::Nodes if self.nodes.under_way.is_none() => {
                let changes = self.nodes.since.take();
                self.nodes.start(state, Work { mesh, changes, recorded, query, as_text }, wake);
            }
            _ => {}
        }
    }

    /// Takes in what threads have done.
    pub fn hear(&mut self) {
        self.elements.hear();
        self.nodes.hear();
    }
}
