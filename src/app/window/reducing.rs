//! The reduction of the run to the smallest case in which a breakpoint is still met, beside the window.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::files::free_path;
use super::session::Wake;
use crate::app::reduce::{Reduction, child};
use crate::app::tasks;
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::core::kernel::number::counted;
use crate::core::progress::Cancel;
use crate::core::reduce::{Draft, Question, Written};
use crate::core::run::Run;

/// The largest number of tries.
const TRIES: u64 = 5000;

enum News {
    Progress(String),
    Done(Result<String, Fault>),
}

/// A reduction, under way or ended.
pub struct Reducing {
    /// What the smaller case must still show.
    pub condition: String,
    /// The file of the smallest case.
    pub path: PathBuf,
    /// How far it is, or what came of it.
    pub told: String,
    /// Whether the file has a smaller case.
    pub is_done: bool,
    news: Option<Receiver<News>>,
    cancel: Cancel,
}

impl Reducing {
    /// Begins to reduce a run, in the working folder; `wake` is called when there is something to hear.
    pub fn begin(run: Run, condition: String, wake: Wake) -> Reducing {
        let path = free_path(&format!("{}-small", run.case.name), "toml");
        let (tell, news) = channel();
        let cancel = Cancel::new();
        let (text, file, stop) = (condition.clone(), path.clone(), cancel.clone());
        tasks::work(move || {
            let said = |news| {
                // Nobody listens once it has been stopped.
                let _ = tell.send(news);
                wake();
            };
            let done = reduce(&run, &text, file, stop, &mut |text| said(News::Progress(text)));
            said(News::Done(done));
        });
        let told = "Looking at the case as it is".to_owned();
        Reducing { condition, path, told, is_done: false, news: Some(news), cancel }
    }

    /// Whether it is under way.
    pub fn is_running(&self) -> bool {
        self.news.is_some()
    }

    /// Stops it; the smallest case so far stays in its file.
    pub fn stop(&mut self) {
        self.cancel.ask();
        self.news = None;
        self.is_done = save::is_file(&self.path);
        self.told = if self.is_done { "Stopped: the smallest case so far".to_owned() } else { "Stopped".to_owned() };
    }

    /// Takes in what it reports. Returns why it failed, if it did.
    pub fn hear(&mut self) -> Option<Fault> {
        loop {
            match self.news.as_ref()?.try_recv() {
                Ok(News::Progress(text)) => self.told = text,
                Ok(News::Done(Ok(text))) => (self.told, self.is_done, self.news) = (text, true, None),
                Ok(News::Done(Err(fault))) => {
                    (self.told, self.news) = ("It could not be reduced".to_owned(), None);
                    return Some(fault);
                }
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => self.news = None,
            }
        }
    }
}

impl Drop for Reducing {
    fn drop(&mut self) {
        self.cancel.ask();
    }
}

/// Reduces a run. Returns what came of it.
fn reduce(
    run: &Run,
    condition: &str,
    path: PathBuf,
    cancel: Cancel,
    tell: &mut dyn FnMut(String),
) -> Result<String, Fault> {
    let question = Question::parse(condition)?;
    let original = Draft::of(run, &mut cancel.clone())?;
    let mut written = Written::new(path, &original, &question)?;
    let start = &child::convert;
    let work = Reduction { question: &question, run, original: &original, tries: TRIES, cancel, start };
    let reduced = work.go(&run.case.name, &mut written, tell).0?;
    let lines = reduced.draft.size().changes(&original.size());
    Ok(format!("{}. {} tried; {}", reduced.finding.sentence, counted(reduced.tests, "smaller case"), lines.join(", ")))
}
