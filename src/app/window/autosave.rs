//! Autosaves the run: each window has a file of its own in the user's state folder, which is removed once nothing is
//! unsaved. After a crash, the next start offers to recover the run.
//!
//! A window holds its file as long as it is open, and releases it however it ends. So two windows never take each
//! other's runs, and a run that nobody holds was abandoned.

mod marks;
mod slot;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use web_time::Instant;

pub use marks::Marks;
pub use slot::{Offer, folder};
use slot::{RunSlot, left_behind};

use super::files::work;
use super::import::ImportOptions;
use super::session::{Opened, Source, Wake};
use super::state::{Breakpoint, Watchpoint};
use crate::app::tasks::{self, Ended, Post, Rest, Serve};
use crate::core::fault::Fault;
use crate::core::record::Keeper;
use crate::core::run::{Bookmark, Camera, Edit, Run};

/// How long to wait after a failure before the next attempt.
const AGAIN: Duration = Duration::from_secs(10);
/// How often a moving camera and the step are saved.
const PLACE: Duration = Duration::from_secs(2);

enum Ask {
    Keep(Box<(Run, Marks)>),
    Forget,
}

/// What writes, so that the window does not wait for a disk.
struct Saver {
    ask: Option<Post<Ask>>,
    told: Receiver<Fault>,
    ended: Option<Ended>,
}

impl Saver {
    fn new(folder: PathBuf, slot: Option<RunSlot>, wake: Wake) -> Saver {
        let (tell, told) = channel();
        let work = Work { folder, slot, keeper: None, pending: None, complained: false, tell, wake };
        let (ask, ended) = tasks::serve(move |_| Some(work));
        Saver { ask: Some(ask), told, ended: Some(ended) }
    }

    fn ask(&self, ask: Ask) {
        if let Some(post) = &self.ask {
            post.send(ask);
        }
    }
}

impl Drop for Saver {
    fn drop(&mut self) {
        self.ask = None;
        // The last request is on the disk before the window is gone.
        if let Some(ended) = self.ended.take() {
            ended.wait();
        }
    }
}

struct Work {
    folder: PathBuf,
    slot: Option<RunSlot>,
    keeper: Option<Keeper>,
    /// The run that could not be written, and when that was tried last.
    pending: Option<(Instant, Box<(Run, Marks)>)>,
    complained: bool,
    tell: Sender<Fault>,
    wake: Wake,
}

impl Serve<Ask> for Work {
    fn hear(&mut self, first: Ask, later: &Receiver<Ask>) -> ControlFlow<()> {
        // Of several requests only the last one counts.
        match later.try_iter().last().unwrap_or(first) {
            Ask::Forget => {
                (self.keeper, self.pending) = (None, None);
                if let Some(slot) = self.slot.take() {
                    slot.remove();
                }
            }
            Ask::Keep(run) => self.try_to_keep(run),
        }
        ControlFlow::Continue(())
    }

    /// Tries again what could not be written.
    fn rest(&mut self) -> Rest {
        match self.pending.as_ref().map(|pending| pending.0.elapsed()) {
            None => return Rest::Asleep,
            Some(since) if since < AGAIN => return Rest::For(AGAIN - since),
            Some(_) => {}
        }
        if let Some((_, run)) = self.pending.take() {
            self.try_to_keep(run);
        }
        Rest::Busy
    }
}

impl Work {
    fn try_to_keep(&mut self, run: Box<(Run, Marks)>) {
        self.pending = None;
        let Err(fault) = self.keep(&run) else {
            self.complained = false;
            return;
        };
        if !std::mem::replace(&mut self.complained, true) {
            // Nobody listens while the window is being closed.
            let _ = self.tell.send(fault);
            (self.wake)();
        }
        self.pending = Some((Instant::now(), run));
    }

    fn keep(&mut self, (run, marks): &(Run, Marks)) -> Result<(), Fault> {
        let slot = self.slot.take().map_or_else(|| RunSlot::new(&self.folder), Ok)?;
        let slot = self.slot.insert(slot);
        let keeper = self.keeper.take().map_or_else(|| Keeper::new(slot.path.clone(), run), Ok)?;
        let beside = slot.marks();
        let kept = self.keeper.insert(keeper).keep(run).and_then(|_| match *marks == Marks::read(&beside) {
            true => Ok(()),
            false => marks.write(&beside),
        });
        kept.map_err(|mut fault| {
            fault.what = format!("The run cannot be autosaved: {}", fault.what);
            fault.remedy += "; autosave tries again, and Ctrl+S saves the run elsewhere";
            fault
        })
    }
}

/// The changes of a run that are saved.
#[derive(Clone, Debug, PartialEq)]
struct Changes {
    edits: Vec<Edit>,
    bookmarks: Vec<Bookmark>,
    breakpoints: Vec<Breakpoint>,
    watches: Vec<Watchpoint>,
}

impl Changes {
    fn of(run: &Run, marks: &Marks) -> Changes {
        Changes {
            edits: run.edits().to_vec(),
            bookmarks: run.bookmarks.clone(),
            breakpoints: marks.breakpoints.clone(),
            watches: marks.watches.clone(),
        }
    }
}

/// Where the window is: its camera and its step.
type Place = (Option<Camera>, u64);

/// Autosaves the run of a window, and offers abandoned runs.
pub struct Autosave {
    folder: PathBuf,
    wake: Wake,
    saver: Saver,
    offers: Vec<Offer>,
    scan: Receiver<Vec<Offer>>,
    /// The run that is autosaved, as it was opened.
    opened: Option<Arc<Opened>>,
    /// Its changes when it was opened or last saved by the user; none for a recovered run.
    saved: Option<Changes>,
    /// What is on the disk, and since when.
    kept: Option<(Changes, Place, Instant)>,
    /// The offer that is being opened.
    opening: Option<Offer>,
}

impl Autosave {
    /// Autosaves runs in a folder, and searches it for abandoned runs in the background.
    pub fn new(folder: PathBuf, wake: Wake) -> Autosave {
        let saver = Saver::new(folder.clone(), None, wake.clone());
        let scan = scan(&folder, &wake);
        Autosave { folder, wake, saver, offers: Vec::new(), scan, opened: None, saved: None, kept: None, opening: None }
    }

    /// Autosaves a second run of this window, and offers nothing.
    pub fn beside(&self) -> Autosave {
        let (folder, wake) = (self.folder.clone(), self.wake.clone());
        let saver = Saver::new(folder.clone(), None, wake.clone());
        let scan = channel().1;
        Autosave { folder, wake, saver, offers: Vec::new(), scan, opened: None, saved: None, kept: None, opening: None }
    }

    /// Exchanges what is offered with another one.
    pub fn swap_offers(&mut self, other: &mut Autosave) {
        std::mem::swap(&mut self.offers, &mut other.offers);
        std::mem::swap(&mut self.scan, &mut other.scan);
    }

    /// Searches again for abandoned runs.
    pub fn search(&mut self) {
        self.scan = scan(&self.folder, &self.wake);
    }

    /// The run on offer, and how many more there are.
    pub fn offer(&self) -> Option<(&Offer, usize)> {
        self.offers.first().map(|offer| (offer, self.offers.len() - 1))
    }

    /// Accepts the offer. Returns what to open.
    pub fn take(&mut self) -> Option<Source> {
        if self.offers.is_empty() {
            return None;
        }
        // If another one is still being opened, it is offered again.
        let offer = self.offers.remove(0);
        let source = Source::File(offer.slot.path.clone());
        self.offers.extend(self.opening.replace(offer));
        Some(source)
    }

    /// Discards the offer.
    pub fn discard(&mut self) {
        if !self.offers.is_empty() {
            self.offers.remove(0).slot.remove();
        }
    }

    /// What was set in the window of the run that is being recovered from `source`; none for other sources.
    pub fn recovered(&self, source: &Source) -> Option<&Marks> {
        self.opening.as_ref().filter(|offer| *source == Source::File(offer.slot.path.clone())).map(|offer| &offer.marks)
    }

    /// The user has saved the run as it is.
    pub fn saved(&mut self, run: &Run, marks: &Marks) {
        self.saved = Some(Changes::of(run, marks));
    }

    /// Saves the window's run if it has changed. Returns what went wrong, and when to look again.
    pub fn look(
        &mut self,
        opened: Option<&Arc<Opened>>,
        source: Option<&Source>,
        run: impl Fn() -> Option<(Run, Marks)>,
    ) -> (Vec<Fault>, Option<Duration>) {
        if let Ok(found) = self.scan.try_recv() {
            self.offers.extend(found);
        }
        let faults = self.saver.told.try_iter().collect();
        let Some(opened) = opened else { return (faults, None) };
        if self.opened.as_ref().is_none_or(|old| !Arc::ptr_eq(old, opened)) {
            self.begin(opened, source);
        }
        let Some((run, marks)) = run() else { return (faults, None) };
        let (now, place) = (Changes::of(&run, &marks), (run.camera, marks.step));
        if self.saved.as_ref() == Some(&now) {
            if self.kept.take().is_some() {
                self.saver.ask(Ask::Forget);
            }
            return (faults, None);
        }
        if let Some((changes, before, since)) = &self.kept
            && *changes == now
        {
            if *before == place {
                return (faults, None);
            }
            // A moving camera is not written at every frame, nor the step while playing.
            if let Some(left) = PLACE.checked_sub(since.elapsed()).filter(|left| !left.is_zero()) {
                return (faults, Some(left));
            }
        }
        self.kept = Some((now, place, Instant::now()));
        self.saver.ask(Ask::Keep(Box::new((run, marks))));
        (faults, None)
    }

    /// The run on offer could not be opened: it is offered again.
    pub fn failed(&mut self) {
        self.offers.extend(self.opening.take());
    }

    /// The window has opened another run. The file of the one before stays and is offered, if it had unsaved changes.
    fn begin(&mut self, opened: &Arc<Opened>, source: Option<&Source>) {
        let is_it = |offer: &Offer| source == Some(&Source::File(offer.slot.path.clone()));
        let adopted = self.opening.take_if(|offer| is_it(offer));
        let was_unsaved = self.kept.take().is_some();
        // How a mesh was imported is stored nowhere but in the run.
        let was_taken = matches!(source, Some(Source::Mesh(_, options)) if *options != ImportOptions::default());
        let is_unsaved = adopted.is_some() || was_taken;
        self.saved = (!is_unsaved).then(|| Changes::of(&opened.run, &Marks::default()));
        let slot = adopted.map(|offer| offer.slot);
        // The old one ends first and releases its lock.
        drop(std::mem::replace(&mut self.saver, Saver::new(self.folder.clone(), slot, self.wake.clone())));
        if was_unsaved {
            self.search();
        }
        self.opened = Some(opened.clone());
    }
}

/// Searches for abandoned runs beside the window.
fn scan(folder: &Path, wake: &Wake) -> Receiver<Vec<Offer>> {
    let folder = folder.to_path_buf();
    work(wake.clone(), move || left_behind(&folder))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::run::EditKind;

    fn run(edits: u64) -> (Run, Marks) {
        let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
        run.set_edits((0..edits).map(|step| Edit { step, kind: EditKind::parameter("c", "1.5").unwrap() }).collect());
        (run, Marks::default())
    }

    fn saver(folder: &Path) -> Saver {
        Saver::new(folder.to_path_buf(), None, Arc::new(|| {}))
    }

    #[test]
    fn a_run_that_is_held_is_not_offered_and_one_that_was_left_is() {
        let folder = tempfile::tempdir().unwrap();
        let first = saver(folder.path());
        let second = saver(folder.path());
        first.ask(Ask::Keep(Box::new(run(3))));
        second.ask(Ask::Keep(Box::new(run(1))));
        let begin = Instant::now();
        while std::fs::read_dir(folder.path()).unwrap().count() < 4 {
            assert!(begin.elapsed() < Duration::from_secs(20));
            std::thread::sleep(Duration::from_millis(2));
        }
        assert!(left_behind(folder.path()).is_empty(), "both windows live");
        drop(first);
        // A child of another test may hold the lock for a moment, between its fork and its start.
        let mut offers = left_behind(folder.path());
        while offers.is_empty() && begin.elapsed() < Duration::from_secs(20) {
            std::thread::sleep(Duration::from_millis(2));
            offers = left_behind(folder.path());
        }
        assert_eq!(offers.len(), 1);
        assert_eq!(offers[0].text, "An unsaved run of example1 with 3 edits from a moment ago can be recovered.");
        assert!(left_behind(folder.path()).is_empty(), "whoever offers it holds it");
        drop(offers);
        second.ask(Ask::Forget);
        drop(second);
        assert_eq!(left_behind(folder.path()).len(), 1, "the second one was forgotten");
    }

    #[test]
    fn what_is_no_run_is_offered_with_what_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("7-0.toml"), "run = 1\n[case").unwrap();
        let offers = left_behind(folder.path());
        assert!(!offers[0].opens && offers[0].text.contains("not TOML"), "{}", offers[0].text);
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_cannot_be_written_is_told_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let saver = saver(&file.join("runs"));
        for edits in 0..3 {
            saver.ask(Ask::Keep(Box::new(run(edits))));
            std::thread::sleep(Duration::from_millis(30));
        }
        let told = saver.told.recv_timeout(Duration::from_secs(20)).unwrap();
        assert!(told.what.contains("cannot be autosaved") && told.remedy.contains("Ctrl+S"), "{told}");
        assert!(saver.told.recv_timeout(Duration::from_millis(100)).is_err());
    }
}
