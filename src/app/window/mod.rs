//! The window: a stepping debugger for the merging front.
//!
//! What the user does becomes a [`Command`]. The panels read the `state` and return commands; only `state::apply` and
//! `state::hearing` change it. The run works beside the window (`session`), which never waits.

mod words;
mod icons;
mod theme;
mod equation;
mod session;
mod measure;
mod view_layer;
mod command;
mod files;
mod import;
mod pair;
mod presentation;
mod film;
mod reducing;
mod settings;
mod graphics;
mod autosave;
mod figures;
mod mesh_out;
mod page_out;
mod lists;
mod sweep;
mod study;
mod state;
mod viewport;
mod labels;
mod layout;
mod panels;
mod presses;
mod clips;
mod app;
#[cfg(not(target_arch = "wasm32"))]
mod opening;
#[cfg(target_arch = "wasm32")]
pub mod web;

pub use crate::app::command_line::Overrides;
pub use app::App;
pub use command::{Command, Rules};
pub use graphics::Lost;
pub use import::Gesture;
pub use lists::ListKind;
#[cfg(not(target_arch = "wasm32"))]
pub use opening::open;
pub use pair::{Arrangement, LinkedBy, PairCommand, Which};
pub use presentation::{Chrome, PresentationCommand, PresentationForm};
pub use session::{Direction, Goal, Source};
pub use state::SurfaceView;
pub use study::StudyCommand;
pub use sweep::{SweepCommand, SweepForm};
pub use view_layer::ViewLayer;
