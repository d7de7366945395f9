//! The command line and the window: they tie `core` and `render` together.
// A page has no command line: what only that uses is left out there.
#![cfg_attr(target_arch = "wasm32", allow(dead_code))]

mod command_line;
mod input;
mod memory;
mod output;
mod progress;
mod work;
#[cfg(feature = "window")]
mod tasks;
mod figure;
mod convert;
mod check;
mod cases;
mod lesson;
mod compare;
mod reduce;
mod sweep;
mod render;
mod notes;
mod page;
#[cfg(feature = "window")]
mod film;
#[cfg(feature = "window")]
pub mod window;
#[cfg(not(target_arch = "wasm32"))]
mod program;

#[cfg(not(target_arch = "wasm32"))]
pub use program::run;

use std::io::{self, Write};

use crate::core::fault::Fault;

/// A mesh that was checked or converted is not valid, or runs that were compared differ.
const FALLS_SHORT: u8 = 1;

/// Reports a fault as one line on standard error.
fn complain(fault: &Fault) {
    let line: String = fault.to_string().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    // A closed standard error leaves nowhere to report to.
    let _ = writeln!(io::stderr(), "error: {line}");
}
