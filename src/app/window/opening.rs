//! The window on a desktop.

use std::process::ExitCode;
use std::time::Instant;

use eframe::egui::{Vec2, ViewportBuilder};

use super::{App, Command, autosave, graphics, settings};
use crate::core::fault::Fault;

/// The largest window in points: egui's textures end there.
const LARGEST: f32 = 8192.0;

/// Opens the window, does there what is asked for first, and returns when it is closed.
///
/// # Errors
/// Where there is no display or no graphics adapter, or where the graphics device is lost.
pub fn open(first: Vec<Command>) -> Result<ExitCode, Fault> {
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
            first.into_iter().for_each(|command| app.apply(command));
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
