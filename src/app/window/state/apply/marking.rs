//! What the user marks to come back to: breakpoints, watchpoints, bookmarks with their notes.

use super::State;
use crate::app::window::layout::Pane;
use crate::app::window::session::{Ask, Direction};
use crate::app::window::state::{Breakpoint, Watchpoint};
use crate::core::run::{Bookmark, Condition, Watched};

impl State {
    pub(super) fn add_breakpoint(&mut self, text: String) {
        let condition = text.trim().to_owned();
        if condition.is_empty() || self.document().breakpoints.iter().any(|b| b.condition == condition) {
            return;
        }
        match Condition::parse(&condition) {
            Ok(_) => self.change(|document| document.breakpoints.push(Breakpoint { condition, is_on: true })),
            Err(fault) => self.complain(&fault),
        }
    }

    pub(super) fn seek_breakpoint(&mut self, direction: Direction) {
        let stops = self.stops();
        if stops.conditions.is_empty() && stops.watched.is_empty() {
            return self.notice("No breakpoint is on: add a condition in the Breakpoints panel.".to_owned());
        }
        self.ask(Ask::Break(stops, direction));
    }

    /// Watches something, or stops watching it.
    pub(super) fn watch(&mut self, watched: Watched) {
        self.change(|document| match document.watches.iter().position(|watch| watch.watched == watched) {
            Some(k) => drop(document.watches.remove(k)),
            None => document.watches.push(Watchpoint { watched, is_on: true }),
        });
    }

    /// Sets a bookmark at the current step, or removes it.
    pub(super) fn bookmark(&mut self) {
        let Some(step) = self.run.moment.as_ref().map(|moment| moment.step) else { return };
        let is_new = self.document().bookmarks.iter().all(|mark| mark.step != step);
        if is_new {
            self.view.reveal.ask(Some(Pane::Bookmarks));
        }
        self.change(|document| match document.bookmarks.binary_search_by_key(&step, |mark| mark.step) {
            Ok(k) => drop(document.bookmarks.remove(k)),
            Err(k) => document.bookmarks.insert(k, Bookmark { step, note: String::new() }),
        });
    }

    /// Has the note on the current step written, with a bookmark if there is none.
    pub(super) fn note_here(&mut self) {
        let Some(step) = self.run.moment.as_ref().map(|moment| moment.step) else { return };
        if self.document().bookmarks.iter().all(|mark| mark.step != step) {
            self.bookmark();
        }
        self.view.reveal.ask(Some(Pane::Bookmarks));
        self.view.note.ask(step);
    }

    /// Has the session find where the breakpoints hold; switched off, one keeps its count.
    pub(in crate::app::window::state) fn count_breakpoints(&self) {
        let all = self.document().breakpoints.iter().filter_map(|b| Condition::parse(&b.condition).ok());
        if let Some(session) = &self.run.session {
            session.ask(Ask::Count(all.collect()));
        }
    }
}
