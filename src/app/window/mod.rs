//! The window: a stepping debugger for the merging front.
//!
//! What the user does becomes a [`Command`]. The panels read the `state` and return commands; only `state::apply` and
//! `state::hearing` change it. The run works on threads of its own (`session`), so that the window never waits.

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
mod lists;
mod sweep;
mod study;
mod state;
mod viewport;
mod labels;
mod layout;
mod panels;
mod presses;
mod app;

use std::process::ExitCode;
use std::time::Instant;

use eframe::egui::{Vec2, ViewportBuilder};

use crate::core::fault::Fault;
use crate::core::question::Series;

pub use crate::app::command_line::Overrides;
pub use app::App;
pub use command::{Command, Rules};
pub use graphics::Lost;
pub use import::Gesture;
pub use lists::ListKind;
pub use pair::{Arrangement, LinkedBy, PairCommand, Which};
pub use presentation::{Chrome, PresentationCommand, PresentationForm};
pub use session::{Direction, Goal, Source};
pub use state::SurfaceView;
pub use study::StudyCommand;
pub use sweep::{SweepCommand, SweepForm};
pub use view_layer::ViewLayer;

/// The largest window in points: egui's textures end there.
const LARGEST: f32 = 8192.0;

/// Opens the window on what is named, with its parameters changed, asks the questions of a series there, and returns
/// when it is closed.
///
/// # Errors
/// Where there is no display or no graphics adapter, or where the graphics device is lost.
pub fn open(source: Source, overrides: Overrides, predict: Option<Series>) -> Result<ExitCode, Fault> {
    let started = Instant::now();
    let path = settings::path();
    let kept = path.as_deref().and_then(|path| settings::Settings::read(path).ok().flatten());
    let size = kept.and_then(|kept| kept.window).map_or(Vec2::new(1600.0, 1000.0), Vec2::from);
    let least = Vec2::new(720.0, 480.0);
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("quadfront")
            .with_app_id("quadfront")
            .with_inner_size(size.clamp(least, Vec2::splat(LARGEST)))
            .with_min_inner_size(least)
            .with_max_inner_size(Vec2::splat(LARGEST))
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: graphics::options(),
        persist_window: false,
        // Large even colours need none, and it is paid for at every pixel.
        dithering: false,
        ..eframe::NativeOptions::default()
    };
    let lost = graphics::Lost::default();
    let watch = lost.clone();
    let shown = eframe::run_native(
        "quadfront",
        options,
        Box::new(move |cc| {
            let mut app = App::kept(cc, None, path, watch).keeping(autosave::folder());
            app.apply(Command::OpenWith(source, Box::new(overrides)));
            if let Some(series) = predict {
                app.apply(Command::Study(StudyCommand::PredictSeries(series)));
            }
            Ok(Box::new(app.cleared().started(started)))
        }),
    );
    shown.map_err(|error| {
        let what = match &error {
            eframe::Error::WinitEventLoop(_) | eframe::Error::Winit(_) => "there is no display".to_owned(),
            eframe::Error::Wgpu(_) => {
                format!("there is no graphics adapter ({})", error.to_string().trim_end_matches('.'))
            }
            _ => error.to_string().trim_end_matches('.').to_owned(),
        };
        Fault::new(format!("The window cannot be opened: {what}")).remedy(
            "It needs a display and a graphics driver; on Debian: apt-get install libvulkan1 mesa-vulkan-drivers. \
             quadfront convert and quadfront render work without",
        )
    })?;
    lost.fault().map_or(Ok(ExitCode::SUCCESS), Err)
}
