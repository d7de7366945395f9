//! The graphics device: what is asked of it, and what is done when it is lost or refuses something.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use eframe::egui_wgpu::{RenderState, WgpuConfiguration, WgpuSetup};
use eframe::wgpu;

use crate::core::fault::Fault;
use crate::render::gpu::{Painter, samples};

/// The limits of the device are those of the adapter: large meshes need large buffers.
pub fn options() -> WgpuConfiguration {
    let mut options = WgpuConfiguration::default();
    if let WgpuSetup::CreateNew(setup) = &mut options.wgpu_setup {
        setup.device_descriptor = Arc::new(|adapter| wgpu::DeviceDescriptor {
            label: Some("quadfront"),
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        });
    }
    options
}

/// What a device has told of itself.
#[derive(Default)]
struct Told {
    /// It is lost, with the reason.
    lost: Option<String>,
    /// It refused something that was not asked for rightly.
    refused: Option<String>,
    /// Where the run was saved after that.
    saved: Option<PathBuf>,
}

/// Hears when the device is lost. A lost device cannot draw any more, nor say so: the run is saved, the window closes,
/// and the program says what happened where it was started.
#[derive(Clone, Default)]
pub struct Lost(Arc<Mutex<Told>>);

impl Lost {
    /// Listens to a device. What it refuses is told in the window instead of ending the program.
    pub fn listen(&self, device: &wgpu::Device, wake: impl Fn() + Send + Sync + 'static) {
        let wake = Arc::new(wake);
        let (told, woken) = (self.0.clone(), wake.clone());
        device.set_device_lost_callback(move |_, reason| {
            if let Ok(mut told) = told.lock() {
                told.lost.get_or_insert(if reason.is_empty() { "no reason is given".to_owned() } else { reason });
            }
            woken();
        });
        let told = self.0.clone();
        device.on_uncaptured_error(Arc::new(move |error| {
            if let Ok(mut told) = told.lock() {
                told.refused.get_or_insert(error.to_string());
            }
            wake();
        }));
    }

    /// Why the device is lost, where it is.
    pub fn reason(&self) -> Option<String> {
        self.0.lock().ok()?.lost.clone()
    }

    /// What the device refused since this was asked last.
    pub fn refused(&self) -> Option<Fault> {
        let what = self.0.lock().ok()?.refused.take()?;
        let what = what.lines().next().unwrap_or_default().to_owned();
        Some(
            Fault::new(format!("The graphics driver refuses to draw: {what}"))
                .remedy("The run itself goes on; save it and start quadfront again"),
        )
    }

    /// The run was saved there.
    pub fn save_was(&self, path: Option<PathBuf>) {
        if let Ok(mut told) = self.0.lock() {
            told.saved = path;
        }
    }

    /// What to say after the window has closed for it.
    pub fn fault(&self) -> Option<Fault> {
        let told = self.0.lock().ok()?;
        let reason = told.lost.as_ref()?.trim_end_matches('.');
        let remedy = match &told.saved {
            Some(path) => format!("The run was saved; go on with it by: quadfront open {}", path.display()),
            None => "Start quadfront again".to_owned(),
        };
        Some(Fault::new(format!("The graphics device was lost ({reason})")).remedy(remedy))
    }
}

/// Makes the painter known to egui's renderer.
pub fn install_painter(render: &RenderState) {
    let painter = Painter::new(&render.device, render.target_format, samples(&render.adapter.get_info()));
    render.renderer.write().callback_resources.insert(painter);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_device_is_told_with_where_the_run_is() {
        let lost = Lost::default();
        assert!(lost.fault().is_none() && lost.reason().is_none());
        lost.0.lock().unwrap().lost = Some("driver reset".to_owned());
        lost.save_was(Some("example1-run.toml".into()));
        let told = lost.fault().unwrap().to_string();
        assert!(told.contains("driver reset") && told.contains("quadfront open example1-run.toml"), "{told}");
    }
}
