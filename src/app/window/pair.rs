//! Two runs side by side: what can be done with them, and what compares them.

use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use super::command::{Command, Rules};
use super::session::{Direction, Source, Wake, words_of};
use super::state::Progress;
use crate::app::command_line::Overrides;
use crate::app::memory::{self, Beside};
use crate::app::progress::StageTimes;
use crate::app::tasks::{self, Post, Serve};
use crate::core::fault::Fault;
use crate::core::kernel::worded::worded;
use crate::core::progress::{Cancel, Need, Stage, Watch};
use crate::core::record::Report;
use crate::core::run::compare::{Did, Difference, FirstDifference, differences, first_difference};
use crate::core::run::history::BUDGET;
use crate::core::run::{History, Run};

worded! {
    /// One of two runs.
    #[derive(Default)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Which by name {
        /// The run that was open first.
        #[default]
        A = "A",
        /// The second run.
        B = "B",
    }
}

impl Which {
    /// The other one.
    pub fn other(self) -> Which {
        match self {
            Which::A => Which::B,
            Which::B => Which::A,
        }
    }
}

worded! {
    /// Where one run goes when the other one has moved.
    #[derive(Default)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum LinkedBy by name {
        /// To the same step.
        #[default]
        Step = "step",
        /// To the same number of quadrilaterals.
        Quad = "quadrilateral",
        /// To the event of the same kind and number: the 57th selection, the third seam.
        Event = "phase",
        /// Nowhere.
        Free = "nothing",
    }
}

worded! {
    /// How two runs are shown.
    #[derive(Default)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Arrangement by name {
        /// In two views with one camera.
        #[default]
        SideBySide = "Side by side",
        /// In one view, with what only one of them has outlined.
        Over = "Over each other",
    }
}

/// What can be done with two runs.
#[derive(Clone, Debug, PartialEq)]
pub enum PairCommand {
    /// Start a second run that is the same up to the current step.
    Fork,
    /// The same, with other parameters from this step on.
    ForkWith(Rules),
    /// Ask for the path of a second run.
    AskBeside,
    /// Open a second run.
    OpenBeside(Source, Box<Overrides>),
    /// Have the panels show one of the runs.
    Activate(Which),
    /// Go on with the other run.
    Switch,
    /// Link the steps of the runs in another way.
    Link(LinkedBy),
    /// Show the runs in another way.
    Show(Arrangement),
    /// Exchange the runs.
    Exchange,
    /// Close the second run.
    Close,
    /// Go to the first difference.
    ToDifference,
    /// Go to the next decision, or the one before, in which both differ although their fronts are the same there.
    SeekDifference(Direction),
    /// Do something in one of the runs.
    In(Which, Box<Command>),
}

impl PairCommand {
    /// Its name in the palette, in menus and in tooltips.
    pub fn name(&self) -> String {
        match self {
            PairCommand::Fork => "Fork at this step".into(),
            PairCommand::ForkWith(rules) => format!("Fork with all parameters of: {}", rules.name()),
            PairCommand::AskBeside => "Open a second run by path…".into(),
            PairCommand::OpenBeside(source, _) => format!("Open {} as second run", source.name()),
            PairCommand::Activate(which) => format!("Show run {} in the panels", which.name()),
            PairCommand::Switch => "Show the other run in the panels".into(),
            PairCommand::Link(LinkedBy::Free) => "Move each run by itself".into(),
            PairCommand::Link(link) => format!("Link the runs by {}", link.name()),
            PairCommand::Show(arrangement) => format!("Two runs: {}", arrangement.name().to_lowercase()),
            PairCommand::Exchange => "Exchange the two runs".into(),
            PairCommand::Close => "Close the second run".into(),
            PairCommand::ToDifference => "To the first difference of the two runs".into(),
            PairCommand::SeekDifference(Direction::Forward) => "To the next difference of the two runs".into(),
            PairCommand::SeekDifference(Direction::Back) => "To the previous difference of the two runs".into(),
            PairCommand::In(_, command) => command.name(),
        }
    }

    /// All of those that need no more than their names.
    pub fn all() -> Vec<PairCommand> {
        let mut all = vec![PairCommand::Fork];
        all.extend(Rules::ALL.map(PairCommand::ForkWith));
        all.extend([PairCommand::AskBeside, PairCommand::Switch, PairCommand::ToDifference]);
        all.extend(LinkedBy::ALL.map(PairCommand::Link));
        all.extend(Arrangement::ALL.map(PairCommand::Show));
        all.extend([PairCommand::Exchange, PairCommand::Close]);
        all
    }
}

/// What the comparison of two runs reports.
pub enum CompareNews {
    Progress(Progress),
    /// The first difference, or that the runs never differ.
    First(Option<Box<FirstDifference>>),
    /// The reports at the ends of both, with the time that each takes by itself.
    Reports(Box<[Report; 2]>),
    /// The decisions in which they differ although their fronts are the same there.
    Differences(Vec<Difference>),
    /// What both did at a difference, by its place in the list, and why.
    Told(usize, Box<[Option<Did>; 2]>),
    Fault(Fault),
}

/// The memory of each of the histories that answer questions about differences, in bytes.
const KEPT: usize = BUDGET / 8;

/// Compares two runs and then tells of their differences, until it is dropped.
pub struct Comparing {
    told: Receiver<CompareNews>,
    ask: Post<usize>,
    cancel: Cancel,
}

impl Comparing {
    /// Begins to compare two runs; `wake` is called when there is something to hear.
    pub fn begin(runs: [Run; 2], wake: Wake) -> Comparing {
        let (tell, told) = channel();
        let cancel = Cancel::new();
        let voice = Voice { tell, wake, cancel: cancel.clone() };
        let (ask, _) = tasks::serve(move |_| match compare(runs, &voice) {
            Ok((histories, differences)) => Some(Differing { histories, differences, voice }),
            Err(fault) => {
                voice.complain(fault);
                None
            }
        });
        Comparing { told, ask, cancel }
    }

    /// Asks what both did at a difference, by its place in the list.
    pub fn ask(&self, difference: usize) {
        self.ask.send(difference);
    }

    /// The next report, if there is one.
    pub fn hear(&self) -> Result<CompareNews, TryRecvError> {
        self.told.try_recv()
    }
}

impl Drop for Comparing {
    fn drop(&mut self) {
        self.cancel.ask();
    }
}

/// Reports to the window.
struct Voice {
    tell: Sender<CompareNews>,
    wake: Wake,
    cancel: Cancel,
}

impl Voice {
    fn say(&self, news: CompareNews) {
        // Nobody listens once another comparison has begun.
        let _ = self.tell.send(news);
        (self.wake)();
    }

    fn complain(&self, fault: Fault) {
        if !fault.is_stop() {
            self.say(CompareNews::Fault(fault));
        }
    }

    fn watch(&self) -> CompareWatch<'_> {
        CompareWatch { voice: self, times: StageTimes::default() }
    }
}

/// Two runs that have been compared.
struct Differing {
    histories: [History; 2],
    differences: Vec<Difference>,
    voice: Voice,
}

impl Serve<usize> for Differing {
    /// Tells what both did at a difference.
    fn hear(&mut self, k: usize, _: &Receiver<usize>) -> ControlFlow<()> {
        let Some(difference) = self.differences.get(k) else { return ControlFlow::Continue(()) };
        let [a, b] = &mut self.histories;
        match difference.told([a, b]) {
            Ok(told) => {
                self.voice.say(CompareNews::Told(k, Box::new(told)));
                ControlFlow::Continue(())
            }
            Err(fault) => {
                self.voice.complain(fault);
                ControlFlow::Break(())
            }
        }
    }
}

/// Compares two runs. Returns their histories, and the decisions in which they differ.
fn compare([a, b]: [Run; 2], voice: &Voice) -> Result<([History; 2], Vec<Difference>), Fault> {
    let mut watch = voice.watch();
    let backgrounds = [a.background(&mut watch)?, b.background(&mut watch)?];
    let [mut a, mut b] = [History::of(a, &backgrounds[0], KEPT)?, History::of(b, &backgrounds[1], KEPT)?];
    let first = first_difference([&mut a, &mut b], &mut watch)?;
    let parting = first.as_ref().map(|first| first.step);
    voice.say(CompareNews::First(first.map(Box::new)));
    let report = |run: &Run| {
        let mut watch = voice.watch();
        let mut report = crate::app::compare::report(run, &mut watch)?;
        report.timing = watch.times.finish();
        Ok::<_, Fault>(report)
    };
    voice.say(CompareNews::Reports(Box::new([report(a.run())?, report(b.run())?])));
    let differences = match parting {
        Some(step) => differences([&mut a, &mut b], step, &mut watch)?,
        None => Vec::new(),
    };
    voice.say(CompareNews::Differences(differences.clone()));
    Ok(([a, b], differences))
}

/// Reports the progress of a comparison, and measures the time of its stages.
struct CompareWatch<'a> {
    voice: &'a Voice,
    times: StageTimes,
}

impl Watch for CompareWatch<'_> {
    fn tell(&mut self, stage: Stage, done: u64, total: u64) {
        if self.times.begin(stage) {
            self.voice.say(CompareNews::Progress(Progress { words: words_of(stage), done, total }));
        }
    }

    fn cancel(&self) -> Cancel {
        self.voice.cancel.clone()
    }

    fn allow(&mut self, need: &Need) -> Result<(), Fault> {
        memory::allow(need, Beside::States(2))
    }
}

impl Command {
    /// Whether it is for the window, or for the first of two runs, whose style the second one follows.
    pub fn is_of_the_window(&self) -> bool {
        matches!(
            self,
            Command::Open(_)
                | Command::OpenWith(..)
                | Command::OpenLink(_)
                | Command::CopyLink
                | Command::OpenDialog
                | Command::OpenPath
                | Command::OpenKept
                | Command::DiscardKept
                | Command::Import
                | Command::SetImport(..)
                | Command::Convert
                | Command::CancelImport
                | Command::GoTo
                | Command::Palette
                | Command::Help
                | Command::CloseOverlay
                | Command::CloseFault(_)
                | Command::SaveMesh
                | Command::Sweep(_)
                | Command::Screenshot
                | Command::SetFigure(_)
                | Command::Film(_)
                | Command::Reveal(_)
                | Command::Arrange(_)
                | Command::ResetLayout
                | Command::ToggleTheme
                | Command::ToggleFollow
                | Command::Presentation(_)
                | Command::Measure
                | Command::ShowTimes
                | Command::Speed(_)
                | Command::Layer(_)
                | Command::ColourBy(_)
                | Command::SurfaceView(_)
                | Command::TogglePlane
                | Command::ToggleSplit
                | Command::HiddenLines
                | Command::ToggleCurved
        )
    }
}
