//! Work beside the window. On a machine it is done by threads. A browser gives a page one thread: there each piece of
//! work is a task that gives way to the page from time to time.

#[cfg(not(target_arch = "wasm32"))]
mod threads;
#[cfg(not(target_arch = "wasm32"))]
use threads as platform;
#[cfg(target_arch = "wasm32")]
pub(super) mod web;
#[cfg(target_arch = "wasm32")]
use web as platform;

use std::ops::ControlFlow;
use std::sync::mpsc::Receiver;
use std::time::Duration;

pub(super) use platform::{Ended, Post, give_turns, hear_within, serve, work};

/// Something that answers messages, one after the other.
pub(super) trait Serve<M> {
    /// Does what a message asks for; `later` has those that came after it. Whether it goes on.
    fn hear(&mut self, message: M, later: &Receiver<M>) -> ControlFlow<()>;

    /// Called while there is no message: does what can wait, and returns when to be called again.
    fn rest(&mut self) -> Rest {
        Rest::Asleep
    }
}

/// When a server is called again, where no message comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rest {
    /// At once.
    Busy,
    /// After a while.
    For(Duration),
    /// Not before a message comes.
    Asleep,
}
