//! Files: names and dialogs to open them, a watcher of the file that is open, and pictures of the window.

#[cfg(not(target_arch = "wasm32"))]
mod dialog;
#[cfg(target_arch = "wasm32")]
#[path = "files/web_dialog.rs"]
mod dialog;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Duration;

use eframe::egui::ColorImage;

use super::import::ImportOptions;
use super::session::{Source, Wake};
use crate::app::command_line::Overrides;
use crate::app::{input, tasks};
use crate::core::case::built_in;
use crate::core::fault::Fault;
use crate::core::formats::{Format, save};
use crate::core::record::figure::{self, KEYWORD};
use crate::core::step;

pub use dialog::Dialog;

/// How often the watcher looks at its file.
const LOOK: Duration = Duration::from_millis(700);

impl Source {
    /// The source that a name stands for: a built-in case, or else a file, which may be a lesson.
    pub fn named(name: &str) -> Source {
        match built_in::all().any(|case| case.0 == name) {
            true => Source::BuiltIn(name.to_owned()),
            false => Source::of_file(PathBuf::from(name)),
        }
    }

    /// The source in a file: a lesson, by the extension of its name, or anything else.
    pub fn of_file(path: PathBuf) -> Source {
        let is_lesson = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("md"));
        // A name that is no text cannot be that of a lesson.
        match path.to_str().filter(|_| is_lesson) {
            Some(name) => Source::Lesson(name.to_owned()),
            None => Source::File(path),
        }
    }

    /// Its name.
    pub fn name(&self) -> String {
        match self {
            Source::BuiltIn(name) | Source::Lesson(name) => name.clone(),
            Source::File(path) | Source::Mesh(path, _) => path.display().to_string(),
            Source::Linked(_) => "the run of a link".to_owned(),
        }
    }
}

/// A file that is being written: what to tell the user when it is done, or what went wrong.
pub type Writing = Receiver<Result<String, Fault>>;

/// Does some work beside the window. It calls `wake` when it has answered.
pub fn work<T: Send + 'static>(wake: Wake, work: impl FnOnce() -> T + Send + 'static) -> Receiver<T> {
    let (tell, told) = channel();
    tasks::work(move || {
        // Nobody listens once the window has been closed or has given the work up.
        let _ = tell.send(work());
        wake();
    });
    told
}

/// Takes the answers that have come. Receivers that have answered, or never will, are dropped.
pub fn answers<T>(waiting: &mut Vec<Receiver<T>>) -> Vec<T> {
    let mut answers = Vec::new();
    waiting.retain(|receiver| match receiver.try_recv() {
        Ok(answer) => {
            answers.push(answer);
            false
        }
        Err(error) => error == TryRecvError::Empty,
    });
    answers
}

/// Extensions of files that can be opened.
fn extensions() -> Vec<&'static str> {
    let meshes = Format::ALL.into_iter().map(Format::extension);
    ["toml", "md"].into_iter().chain(figure::EXTENSIONS).chain(meshes).chain(step::EXTENSIONS).collect()
}

/// Of files that were given together the one to open: a case, or else the first that can be opened by itself.
#[cfg(any(test, target_arch = "wasm32"))]
pub fn main_of(given: &[PathBuf]) -> Option<&PathBuf> {
    let has = |path: &PathBuf, known: &[&str]| {
        path.extension().is_some_and(|own| known.iter().any(|one| own.eq_ignore_ascii_case(one)))
    };
    let known = extensions();
    let first = |known: &[&str]| given.iter().find(|path| has(path, known));
    first(&["toml", "md"]).or_else(|| first(&known)).or(given.first())
}

/// The answer of a dialog.
pub enum Answer {
    /// Nothing yet.
    Waiting,
    /// A file.
    File(PathBuf),
    /// The user has closed it.
    Nothing,
    /// There is none, or it hangs.
    Missing,
}

/// A path in the working folder that is free: `stem.extension`, `stem-2.extension`, ...
pub fn free_path(stem: &str, extension: &str) -> PathBuf {
    let mut path = PathBuf::from(format!("{stem}.{extension}"));
    let mut number = 1;
    while save::is_file(&path) {
        number += 1;
        path = PathBuf::from(format!("{stem}-{number}.{extension}"));
    }
    path
}

/// Watches a file for changes on a thread of its own.
pub struct Watcher {
    news: Receiver<Result<String, Fault>>,
    gone: Arc<AtomicBool>,
}

impl Watcher {
    /// Starts to watch a file; `wake` is called when it has changed.
    pub fn of(path: PathBuf, wake: Wake) -> Watcher {
        let (tell, news) = channel();
        let gone = Arc::new(AtomicBool::new(false));
        let given_up = gone.clone();
        let state = move |path: &Path| std::fs::metadata(path).and_then(|meta| Ok((meta.modified()?, meta.len()))).ok();
        let mut before = state(&path);
        std::thread::spawn(move || {
            while !given_up.load(Ordering::Relaxed) {
                std::thread::sleep(LOOK);
                let now = state(&path);
                if now == before {
                    continue;
                }
                before = now;
                // If it cannot be read any more, nothing is lost, and the message says so.
                let read = input::run_of(&path, &ImportOptions::default(), &Overrides::default())
                    .map(|_| path.display().to_string())
                    .map_err(|fault| {
                        let remedy =
                            if fault.remedy.is_empty() { String::new() } else { format!("{}. ", fault.remedy) };
                        fault.remedy(format!("{remedy}The window keeps the run that is open"))
                    });
                if tell.send(read).is_err() {
                    return;
                }
                wake();
            }
        });
        Watcher { news, gone }
    }

    /// The latest change: the name of the file, or what is wrong with it now.
    pub fn news(&self) -> Option<Result<String, Fault>> {
        self.news.try_iter().last()
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        self.gone.store(true, Ordering::Relaxed);
    }
}

/// Writes a picture of the window as PNG, with the text of the run that it shows.
///
/// # Errors
/// What the system says.
pub fn write_png(path: &Path, image: &Arc<ColorImage>, run: Option<String>) -> Result<(), Fault> {
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
    save::save(path, |out| {
        let mut encoder = png::Encoder::new(out, image.size[0] as u32, image.size[1] as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        if let Some(run) = run {
            encoder.add_itxt_chunk(KEYWORD.to_owned(), run).map_err(std::io::Error::other)?;
        }
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
        assert_eq!(Source::named("figure-14"), Source::BuiltIn("figure-14".to_owned()));
        assert_eq!(Source::named("plate.toml"), Source::File(PathBuf::from("plate.toml")));
    }

    #[test]
    fn of_files_given_together_a_case_is_opened_or_what_can_be_by_itself() {
        let main = |names: &[&str]| {
            let given: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
            main_of(&given).map(|path| path.display().to_string())
        };
        assert_eq!(main(&["a.sol", "a.mesh"]).as_deref(), Some("a.mesh"));
        assert_eq!(main(&["part.OBJ", "case.toml"]).as_deref(), Some("case.toml"));
        assert_eq!(main(&["plate.bin", "plate.gltf"]).as_deref(), Some("plate.gltf"));
        assert_eq!(main(&["notes.txt"]).as_deref(), Some("notes.txt"));
        assert_eq!(main(&[]), None);
    }
}
