//! The window: a stepping debugger for the merging front.
//!
//! What a person does becomes a [`command::Command`]; `State::apply` is the only place where one changes anything.
//! The run itself works on threads of its own (`session`), so that the window never waits.

mod words;
mod icons;
mod theme;
mod session;
mod command;
mod files;
mod autosave;
mod figures;
mod state;
mod apply;
mod viewport;
mod labels;
mod layout;
mod panels;
mod app;

use std::process::ExitCode;

use eframe::egui::{Vec2, ViewportBuilder};
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use eframe::wgpu;

use crate::core::fault::Fault;

pub use app::App;
pub use command::Command;
pub use session::{Goal, Source};

/// Opens the window on what is named, and returns when it is closed.
///
/// # Errors
/// Where there is no display or no graphics adapter.
pub fn open(source: Source) -> Result<ExitCode, Fault> {
    let mut wgpu_options = WgpuConfiguration::default();
    if let WgpuSetup::CreateNew(setup) = &mut wgpu_options.wgpu_setup {
        ask_for_what_there_is(setup);
    }
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("quadfront")
            .with_app_id("quadfront")
            .with_inner_size(Vec2::new(1600.0, 1000.0))
            .with_min_inner_size(Vec2::new(720.0, 480.0))
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options,
        persist_window: false,
        ..eframe::NativeOptions::default()
    };
    let shown = eframe::run_native(
        "quadfront",
        options,
        Box::new(|cc| Ok(Box::new(App::new(cc, Some(source)).keeping(autosave::folder())))),
    );
    shown.map_err(|error| {
        Fault::new(format!("The window cannot be opened: {}", error.to_string().trim_end_matches('.'))).remedy(
            "It needs a display and a graphics driver; on Debian: apt-get install libvulkan1 mesa-vulkan-drivers. \
             quadfront convert and quadfront render work without",
        )
    })?;
    Ok(ExitCode::SUCCESS)
}

/// The limits of the device are those of the adapter: large meshes need large buffers.
fn ask_for_what_there_is(setup: &mut WgpuSetupCreateNew) {
    setup.device_descriptor = std::sync::Arc::new(|adapter| wgpu::DeviceDescriptor {
        label: Some("quadfront"),
        required_limits: adapter.limits(),
        ..wgpu::DeviceDescriptor::default()
    });
}
