//! The graphics device: its options, and what happens when it is lost or reports an error.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use eframe::egui_wgpu::{RenderState, WgpuConfiguration, WgpuSetup};
use eframe::wgpu;

use crate::core::fault::Fault;
use crate::render::gpu::{Painter, is_software};

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

/// What a device has reported.
#[derive(Default)]
struct DeviceStatus {
    /// It is lost, with the reason.
    lost: Option<String>,
    /// An error of the device.
    refused: Option<String>,
    /// Where the run was saved after the loss.
    saved: Option<PathBuf>,
}

/// Notices when the device is lost. A lost device cannot draw any more, not even a message: the run is saved, the
/// window closes, and the program prints what happened.
#[derive(Clone, Default)]
pub struct Lost(Arc<Mutex<DeviceStatus>>);

impl Lost {
    /// Listens to a device. Its errors are shown in the window and do not end the program.
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

    /// Why the device is lost, if it is.
    pub fn reason(&self) -> Option<String> {
        self.0.lock().ok()?.lost.clone()
    }

    /// The first error of the device since the last call.
    pub fn refused(&self) -> Option<Fault> {
        let what = self.0.lock().ok()?.refused.take()?;
        let what = what.lines().next().unwrap_or_default().to_owned();
        Some(
            Fault::new(format!("The graphics driver reports an error: {what}"))
                .remedy("The run itself is not affected; save it and start quadfront again"),
        )
    }

    /// The run was saved there.
    pub fn save_was(&self, path: Option<PathBuf>) {
        if let Ok(mut told) = self.0.lock() {
            told.saved = path;
        }
    }

    /// The message after the window has closed because of the loss.
    pub fn fault(&self) -> Option<Fault> {
        let told = self.0.lock().ok()?;
        let reason = told.lost.as_ref()?.trim_end_matches('.');
        let remedy = match &told.saved {
            Some(path) => format!("The run was saved; continue with: quadfront open {}", path.display()),
            None => "Start quadfront again".to_owned(),
        };
        Some(Fault::new(format!("The graphics device was lost ({reason})")).remedy(remedy))
    }
}

/// Installs the painter in egui's renderer.
pub fn install_painter(render: &RenderState) {
    let painter = Painter::new(&render.device, render.target_format, is_software(&render.adapter.get_info()));
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
