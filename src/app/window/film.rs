//! The film of the window: of the run that is open, as the panel for figures says, made beside the window.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use web_time::Instant;

use super::figures;
use super::files::free_path;
use super::session::Wake;
use super::state::State;
use crate::app::film::{self, FilmOptions};
use crate::app::memory::{self, Beside};
use crate::app::output::Target;
use crate::app::progress;
use crate::app::tasks;
use crate::core::fault::Fault;
use crate::core::kernel::number::grouped;
use crate::core::progress::{Cancel, Need, Stage, Watch};
use crate::render::film::FilmFormat;

/// The shortest time between two reports of progress.
const PACE: Duration = Duration::from_millis(50);

/// What can be done with films.
#[derive(Clone, Debug, PartialEq)]
pub enum FilmCommand {
    /// Make one and save it.
    Save(FilmFormat),
    /// Stop making it.
    Stop,
}

impl FilmCommand {
    /// Its name in the palette and for screen readers.
    pub fn name(&self) -> &'static str {
        match self {
            FilmCommand::Save(FilmFormat::Gif) => "Save the film as GIF",
            FilmCommand::Save(FilmFormat::Apng) => "Save the film as animated PNG",
            FilmCommand::Stop => "Stop the film",
        }
    }
}

/// Which film is made, as the user has set it; texts as the command line takes them.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmForm {
    /// The first frame.
    pub from: String,
    /// The last frame.
    pub to: String,
    /// From one frame to the next.
    pub every: String,
    /// Frames a second.
    pub rate: f64,
    /// Whether the camera follows the decisions.
    pub follows: bool,
    /// Whether each frame has its narration below.
    pub captions: bool,
    /// Whether it plays once only.
    pub once: bool,
}

impl Default for FilmForm {
    fn default() -> Self {
        FilmForm {
            from: "nq=0".to_owned(),
            to: "end".to_owned(),
            every: "quad".to_owned(),
            rate: 10.0,
            follows: false,
            captions: true,
            once: false,
        }
    }
}

impl FilmForm {
    /// The same as options of the command line.
    ///
    /// # Errors
    /// A text that has no meaning.
    pub(in crate::app) fn options(&self) -> Result<FilmOptions, Fault> {
        let FilmForm { from, to, every, rate, follows, captions: _, once } = self;
        FilmOptions::from_words(&[
            format!("--from={}", from.trim()),
            format!("--to={}", to.trim()),
            format!("--every={}", every.trim()),
            format!("--rate={rate}"),
            format!("--camera={}", if *follows { "follow" } else { "fixed" }),
            format!("--loop={}", if *once { "once" } else { "forever" }),
        ])
    }
}

enum News {
    Progress(Stage, u64, u64),
    Done(Result<String, Fault>),
}

/// A film, under way or made.
pub struct FilmWork {
    /// Its file.
    pub path: PathBuf,
    /// How far it is, or what came of it.
    pub told: String,
    /// The share of it that is done.
    pub share: f32,
    news: Option<Receiver<News>>,
    cancel: Cancel,
}

impl FilmWork {
    /// Begins the film that the panel describes; nothing where no run is open. `wake` is called when there is something
    /// to hear.
    ///
    /// # Errors
    /// If the form has no meaning.
    pub fn begin(state: &State, format: FilmFormat, wake: Wake) -> Result<Option<FilmWork>, Fault> {
        let Some(run) = state.current_run() else { return Ok(None) };
        let form = &state.workspace().figure;
        let (film, figure) = (form.film.options()?, figures::options_of_film(state)?);
        let path = path(state, format);
        let (tell, news) = channel();
        let cancel = Cancel::new();
        let (target, mut teller) = (
            Target::File(path.clone()),
            Teller { tell: tell.clone(), wake: wake.clone(), cancel: cancel.clone(), last: None },
        );
        tasks::work(move || {
            let done = film::make(&run, &film, &figure, &target, &mut teller);
            // Nobody listens once it has been stopped.
            let _ = tell.send(News::Done(done.map(|made| made.text())));
            wake();
        });
        let told = "Beginning".to_owned();
        Ok(Some(FilmWork { path, told, share: 0.0, news: Some(news), cancel }))
    }

    /// Whether it is under way.
    pub fn is_running(&self) -> bool {
        self.news.is_some()
    }

    /// Stops it; nothing of it stays.
    pub fn stop(&mut self) {
        if self.news.take().is_some() {
            self.cancel.ask();
            (self.told, self.share) = ("Stopped: no film was saved.".to_owned(), 0.0);
        }
    }

    /// Takes in what it reports. Returns the message when it is done, or why it failed.
    pub fn hear(&mut self) -> Option<Result<String, Fault>> {
        loop {
            match self.news.as_ref()?.try_recv() {
                Ok(News::Progress(stage, done, all)) => {
                    self.share = if stage == Stage::Draw { done as f32 / all.max(1) as f32 } else { 0.0 };
                    self.told = match stage {
                        Stage::Draw => format!("Frame {} of {}", grouped(done), grouped(all)),
                        stage => progress::words(stage).to_owned(),
                    };
                }
                Ok(News::Done(done)) => {
                    (self.news, self.share) = (None, 0.0);
                    self.told = match &done {
                        Ok(text) => text.clone(),
                        Err(_) => "The film could not be made.".to_owned(),
                    };
                    let path = self.path.display();
                    return Some(done.map(|text| format!("The film was saved as {path}: {text}")));
                }
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => self.news = None,
            }
        }
    }
}

impl Drop for FilmWork {
    fn drop(&mut self) {
        self.cancel.ask();
    }
}

/// The file of the next film.
pub fn path(state: &State, format: FilmFormat) -> PathBuf {
    free_path(&figures::stem(state), format.extension())
}

/// Reports the progress of a film to the window.
struct Teller {
    tell: Sender<News>,
    wake: Wake,
    cancel: Cancel,
    last: Option<(Stage, Instant)>,
}

impl Watch for Teller {
    fn tell(&mut self, stage: Stage, done: u64, total: u64) {
        if self.last.is_some_and(|(last, when)| last == stage && when.elapsed() < PACE) {
            return;
        }
        self.last = Some((stage, Instant::now()));
        // Nobody listens once it has been stopped.
        let _ = self.tell.send(News::Progress(stage, done, total));
        (self.wake)();
    }

    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    fn allow(&mut self, need: &Need) -> Result<(), Fault> {
        memory::allow(need, Beside::States(1))
    }
}
