//! Files from the window: what to open, by the system's dialog or by a path, and pictures of the window.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use eframe::egui::ColorImage;

use super::session::{Moment, Source, Wake};
use crate::app::figure::{Figure, FigureOptions};
use crate::app::work::Frame;
use crate::core::convert::walk::Stop;
use crate::core::fault::Fault;
use crate::core::io::{built_in, save};
use crate::core::run::run::Run;
use crate::core::run::shown::{ShownState, fingerprint};
use crate::render::look::Layers;
use crate::render::picture::{Picture, Seen};

/// A dialog that has not answered for so long is given up.
const PATIENCE: Duration = Duration::from_secs(120);
/// An answer that comes sooner is no person's.
const HASTE: Duration = Duration::from_millis(250);

impl Source {
    /// What a name stands for: a built-in case, or else a file.
    pub fn named(name: &str) -> Source {
        match built_in::CASES.iter().any(|case| case.0 == name) {
            true => Source::BuiltIn(name.to_owned()),
            false => Source::File(PathBuf::from(name)),
        }
    }

    /// How it is called.
    pub fn name(&self) -> String {
        match self {
            Source::BuiltIn(name) => name.clone(),
            Source::File(path) => path.display().to_string(),
        }
    }
}

/// The system's dialog, on a thread of its own: it may hang where the desktop has no portal.
pub struct Dialog {
    answer: Receiver<Option<PathBuf>>,
    since: Instant,
}

/// What has become of a dialog.
pub enum Answer {
    /// Nothing yet.
    Waiting,
    /// A file.
    File(PathBuf),
    /// A person has closed it.
    Nothing,
    /// There is none, or it hangs.
    Missing,
}

impl Dialog {
    /// Opens the dialog; `wake` is called when it has answered.
    pub fn open(wake: Wake) -> Dialog {
        let (tell, answer) = channel();
        std::thread::spawn(move || {
            let dialog = rfd::FileDialog::new()
                .set_title("Open a case or a mesh")
                .add_filter("Cases and meshes", &["toml", "msh", "mesh", "vtu", "obj", "inp"]);
            // Nobody listens where the window has given it up.
            let _ = tell.send(dialog.pick_file());
            wake();
        });
        Dialog { answer, since: Instant::now() }
    }

    /// Its answer, if there is one.
    pub fn answer(&self) -> Answer {
        match self.answer.try_recv() {
            Ok(Some(path)) => Answer::File(path),
            Ok(None) if self.since.elapsed() < HASTE => Answer::Missing,
            Ok(None) => Answer::Nothing,
            Err(TryRecvError::Disconnected) => Answer::Missing,
            Err(TryRecvError::Empty) if self.since.elapsed() > PATIENCE => Answer::Missing,
            Err(TryRecvError::Empty) => Answer::Waiting,
        }
    }
}

/// A path in the working folder that is not taken: `stem.extension`, `stem-2.extension`, ...
pub fn free_path(stem: &str, extension: &str) -> PathBuf {
    let mut path = PathBuf::from(format!("{stem}.{extension}"));
    let mut number = 1;
    while path.exists() {
        number += 1;
        path = PathBuf::from(format!("{stem}-{number}.{extension}"));
    }
    path
}

/// Writes a state as a figure, as vectors and as pixels drawn from those; their names, for people.
///
/// # Errors
/// What the system says.
pub fn export(moment: &Moment, run: &Run, stem: &str) -> Result<String, Fault> {
    let options = FigureOptions::default();
    let frame = frame(moment, options.look(false).layers);
    let figure = Figure::of_run(run, &[frame], &options, true)?;
    let pixels = figure.png()?;
    let names = ["svg", "png"].map(|extension| free_path(stem, extension));
    save::save(&names[0], |out| out.write_all(figure.svg.as_bytes()))?;
    save::save(&names[1], |out| out.write_all(&pixels))?;
    Ok(format!("{} and {}", names[0].display(), names[1].display()))
}

/// The state at hand as a frame of a figure.
fn frame(moment: &Moment, layers: Layers) -> Frame {
    let Moment { mesh, parameters, phase, changed, step, .. } = moment;
    let shown = ShownState { step: *step, at: Some(Stop::Step(*step)), state: fingerprint(mesh, phase) };
    let seen = Seen { mesh, parameters, phase, changed };
    Frame { picture: Picture::of_state(&seen, layers), shown, statistics: None }
}

/// Writes a picture of the window as PNG.
///
/// # Errors
/// What the system says.
pub fn write_png(path: &Path, image: &Arc<ColorImage>) -> Result<(), Fault> {
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
    save::save(path, |out| {
        let mut encoder = png::Encoder::new(out, image.size[0] as u32, image.size[1] as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(std::io::Error::other)?;
        writer.write_image_data(&bytes).map_err(std::io::Error::other)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_a_built_in_case_or_else_a_file() {
        assert_eq!(Source::named("example1"), Source::BuiltIn("example1".to_owned()));
        assert_eq!(Source::named("plate.toml"), Source::File(PathBuf::from("plate.toml")));
    }
}
