//! What the window knows, in four parts: the run, what the user has set up, what is seen, and the frame at hand.
//!
//! The whole window reads it; two modules change it. [`apply`] does what the user asks for, [`hearing`] takes in what
//! worker threads report. The parts of [`State`] are private to this module and the two below it, so the compiler holds
//! everybody else to that.

mod log;
mod pair;
mod run_state;
mod workspace;
mod view_state;
mod apply;
mod hearing;

pub use pair::{Pair, ShownDifference};
use run_state::Opening;
pub use run_state::{Lookup, Missing, Progress, RunState};
pub use view_state::{FrameState, Look, Overlay, ViewCamera, ViewKind, ViewState};
pub use workspace::{Breakpoint, Document, SurfaceStyle, SurfaceView, Watchpoint, Workspace};

use super::autosave::Marks;
use super::film::FilmWork;
use super::presentation::Chrome;
use super::reducing::Reducing;
use super::session::{Moment, Posed, Stops, Wake};
use super::study::Study;
use super::sweep::SweepWork;
use crate::core::case::Parameters;
use crate::core::mesh::NodeId;
use crate::core::question::Series;
use crate::core::record::link::Link;
use crate::core::run::{Condition, Run, Watched, run};
use crate::render::scene::{ColourBy, Outlined};

/// Everything that the window knows.
pub struct State {
    /// Has the next frame drawn; called from any thread.
    wake: Wake,
    run: RunState,
    workspace: Workspace,
    view: ViewState,
    frame: FrameState,
    /// The sweep, which outlasts the run that it was begun with.
    sweep: Option<SweepWork>,
    /// The film of the window, once there is one.
    film: Option<FilmWork>,
    /// The reduction of the run, once there is one.
    reducing: Option<Reducing>,
    /// The pair that this run is the first one of.
    pair: Option<Pair>,
    /// Whether it is the second run of a pair.
    is_second: bool,
    /// The lesson or the prediction that is under way.
    study: Option<Study>,
    /// What begins once the run that is being opened is there.
    wanted: Option<Wanted>,
}

/// What begins with a run that is being opened.
enum Wanted {
    /// A part of its lesson.
    Part(usize),
    /// A prediction.
    Series(Series),
    /// What a link says of its run.
    Linked(Box<Link>),
}

impl State {
    /// A window in which nothing is open; `wake` is called from other threads when they have something to report.
    pub fn new(wake: Wake, workspace: Workspace) -> State {
        State {
            wake,
            run: RunState::default(),
            workspace,
            view: ViewState::default(),
            frame: FrameState::default(),
            sweep: None,
            film: None,
            reducing: None,
            pair: None,
            is_second: false,
            study: None,
            wanted: None,
        }
    }

    /// Called from other threads, it has the next frame drawn.
    pub fn wake(&self) -> Wake {
        self.wake.clone()
    }

    /// The run and the work on it.
    pub fn run(&self) -> &RunState {
        &self.run
    }

    /// What the user has set up.
    pub fn workspace(&self) -> &Workspace {
        &self.workspace
    }

    /// The part of that which undo covers.
    pub fn document(&self) -> &Document {
        &self.workspace.document
    }

    /// What is seen.
    pub fn view(&self) -> &ViewState {
        &self.view
    }

    /// The reduction of the run, once there is one.
    pub fn reducing(&self) -> Option<&Reducing> {
        self.reducing.as_ref()
    }

    /// The film of the window, once there is one.
    pub fn film(&self) -> Option<&FilmWork> {
        self.film.as_ref()
    }

    /// The lesson or the prediction that is under way.
    pub fn study(&self) -> Option<&Study> {
        self.study.as_ref()
    }

    /// The same, while the window shows it and not the panels.
    pub fn shown_study(&self) -> Option<&Study> {
        let is_alone = self.pair.is_none() && self.chrome() == Chrome::Panels && self.run.import.is_none();
        self.study.as_ref().filter(|study| is_alone && !study.explores)
    }

    /// The question that waits for an answer at the current state.
    pub fn open_question(&self) -> Option<&Posed> {
        self.study_at().and_then(|(study, step)| study.open_question(step))
    }

    /// The study that is shown, and the step of the current state.
    fn study_at(&self) -> Option<(&Study, u64)> {
        self.shown_study().zip(self.run.moment.as_ref().map(|moment| moment.step))
    }

    /// Whether classes and H-values would give an answer away.
    pub fn hides_classes(&self) -> bool {
        self.study_at().is_some_and(|(study, step)| study.hides_classes(step))
    }

    /// Whether the candidates that the step before refused would hide what a lesson speaks of.
    pub fn hides_candidates(&self) -> bool {
        self.study_at().is_some_and(|(study, step)| study.is_about(step))
    }

    /// What is lit because the pointer is on words, or because a lesson speaks of it.
    pub fn spoken(&self) -> Vec<Outlined> {
        match &self.frame.pointed[..] {
            [] => self.study_at().map_or_else(Vec::new, |(study, step)| study.lit(step)),
            pointed => pointed.to_vec(),
        }
    }

    /// Whether the keys of the window step by operation.
    pub fn steps_by_operation(&self) -> bool {
        let opened = self.run.opened.as_ref();
        opened.is_some_and(|opened| Study::steps_by_operation(&opened.run.case.name))
    }

    /// The sweep of the window, once there is one.
    pub fn sweep(&self) -> Option<&SweepWork> {
        self.sweep.as_ref()
    }

    /// What is around the views. An import has the panels of its own.
    pub fn chrome(&self) -> Chrome {
        if self.run.import.is_some() { Chrome::Panels } else { self.view.chrome }
    }

    /// What holds for the frame at hand only.
    pub fn frame(&self) -> &FrameState {
        &self.frame
    }

    /// The breakpoints and watchpoints that are on.
    pub fn stops(&self) -> Stops {
        let conditions = self.document().breakpoints.iter().filter(|breakpoint| breakpoint.is_on);
        let watches = self.document().watches.iter().filter(|watch| watch.is_on);
        Stops {
            conditions: conditions.filter_map(|breakpoint| Condition::parse(&breakpoint.condition).ok()).collect(),
            watched: watches.map(|watch| watch.watched).collect(),
        }
    }

    /// The front segment or edge that is selected, from A to B.
    pub fn picked_segment(&self) -> Option<[NodeId; 2]> {
        match self.document().picked {
            Some(Outlined::Edge(ends)) => Some(ends),
            _ => None,
        }
    }

    /// The step that made each quadrilateral, by slot, where elements are coloured by it.
    pub fn births(&self, by: ColourBy, moment: &Moment) -> Vec<u64> {
        let slots = moment.mesh.element_slots();
        if by == ColourBy::Birth { self.run.born.of_quads(moment.step, slots) } else { vec![0; slots] }
    }

    /// The run with all changes of the user.
    pub fn current_run(&self) -> Option<Run> {
        let mut run = self.run.opened.as_ref()?.run.clone();
        run.shown = None;
        run.set_edits(self.document().edits.clone());
        run.bookmarks.clone_from(&self.document().bookmarks);
        run.camera = self.moved_camera().or(run.camera);
        Some(run)
    }

    /// What the user has set beside the run.
    fn marks(&self) -> Marks {
        let Document { breakpoints, watches, .. } = self.document();
        let step = self.run.moment.as_ref().map_or(0, |moment| moment.step);
        Marks { step, breakpoints: breakpoints.clone(), watches: watches.clone() }
    }

    /// Whether the mesh lies on surfaces and is shown in space.
    pub fn is_in_space(&self) -> bool {
        let on_surfaces = self.run.moment.as_ref().is_some_and(|moment| moment.mesh.embedding().is_some());
        self.workspace.surfaces.view != SurfaceView::Plane && on_surfaces
    }

    /// The camera of the main view, unless it shows the whole mesh from where it did at first.
    fn moved_camera(&self) -> Option<run::Camera> {
        let view = if self.is_in_space() { self.view.space } else { self.view.plane };
        view.camera.filter(|_| !view.is_fitted).map(|camera| camera.kept(view.size))
    }

    /// The value of a parameter at the current step.
    pub fn parameter(&self, key: &str) -> Option<String> {
        self.run.moment.as_ref()?.parameters.text_of(key)
    }

    /// Parameters of the case, before any edit.
    pub fn parameters_of_case(&self) -> Option<&Parameters> {
        self.run.opened.as_ref().map(|opened| &opened.run.case.parameters)
    }
}

/// What a selection is to the run.
pub fn watched(what: Outlined) -> Watched {
    match what {
        Outlined::Node(node) => Watched::Node(node),
        Outlined::Edge([a, b]) => Watched::Edge(a.min(b), a.max(b)),
        Outlined::Element(element) => Watched::Element(element),
    }
}

/// Something that is watched or found, as the views know it.
pub fn outlined(watched: Watched) -> Outlined {
    match watched {
        Watched::Node(node) => Outlined::Node(node),
        Watched::Edge(a, b) => Outlined::Edge([a, b]),
        Watched::Element(element) => Outlined::Element(element),
    }
}
