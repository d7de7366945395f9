//! What the window knows: the run as far as it has been told, what a person has set, and what is open over the window.

mod hearing;
mod space;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

pub use space::{InSpace, Place};

use super::autosave::Autosave;
use super::figures::Figures;
use super::files::{Dialog, Watcher};
use super::import::{Import, News};
use super::measure::{Measuring, Times};
use super::mesh_out::Saving;
use super::panels::timeline::Columns;
use super::session::{Explained, Goal, Moment, Opened, Past, Session, Source, Stops, Told, Tracked, Verdict, Wake};
use glam::DVec2;

use crate::app::command_line::MeshOptions;
use crate::app::figure::another_state;
use crate::app::input;
use crate::core::case::built_in;
use crate::core::convert::phase::Phase;
use crate::core::fault::Fault;
use crate::core::formats::format::Format;
use crate::core::mesh::ids::NodeId;
use crate::core::run::breakpoint::Condition;
use crate::core::run::copies::Since;
use crate::core::run::run::{self, Bookmark, Edit, Run};
use crate::core::run::sample::Sample;
use crate::core::run::shown::{ShownState, fingerprint};
use crate::core::run::watch::Watched;
use crate::render::camera::{Bearing, Camera};
use crate::render::scene::{ColourBy, Layers, Outlined};

/// What undo takes back: all that a person sets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kept {
    /// Changed parameters.
    pub edits: Vec<Edit>,
    /// What is kept in the inspector.
    pub picked: Option<Outlined>,
    /// What is drawn.
    pub layers: Layers,
    /// What elements are coloured by.
    pub colour_by: ColourBy,
    /// Conditions to stop at, and whether they are on.
    pub breakpoints: Vec<(String, bool)>,
    /// What to stop at when it is touched, and whether that is on.
    pub watches: Vec<(Watched, bool)>,
    /// Steps that a person has marked.
    pub bookmarks: Vec<u64>,
    /// Where the panels are, where a person has moved them.
    pub layout: Option<String>,
}

/// Work that is under way.
#[derive(Clone, Debug)]
pub struct Progress {
    pub words: &'static str,
    pub done: u64,
    pub total: u64,
}

/// What the table of the front is sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrontColumn {
    Rank,
    Nodes,
    Class,
    HValue,
    Length,
    ThetaA,
    ThetaB,
    Level,
    Loop,
}

/// Everything that the window knows.
pub struct State {
    pub wake: Wake,
    pub session: Option<Session>,
    /// What was opened, for messages.
    pub source: Option<Source>,
    /// What is being opened; what is open stays until that stands.
    opening: Option<(Source, Session)>,
    /// The mesh that is about to be converted.
    pub import: Option<Import>,
    /// The last number that a picture of such a mesh had.
    pictures: u64,
    /// Looks whether the file changes.
    pub watcher: Option<Watcher>,
    /// The state of a figure that was opened, until it is reached.
    awaited: Option<ShownState>,
    /// Keeps the run, where the window was opened by a person.
    pub autosave: Option<Autosave>,
    /// Whether the notes on the case are shown.
    pub notes: bool,
    /// How figures are made, and those that are being made.
    pub figures: Figures,
    /// Meshes that are being written.
    pub saving: Vec<Saving>,
    pub opened: Option<Arc<Opened>>,
    pub moment: Option<Arc<Moment>>,
    /// Whether the invariants hold in it.
    pub verdict: Verdict,
    /// What is other in it than in the one that was drawn.
    pub changes: Since,
    /// Steps of the run, as far as they have been recorded.
    pub track: Vec<Tracked>,
    /// Invariants and figures along it.
    pub samples: Vec<Sample>,
    /// Changes with both.
    pub track_epoch: u64,
    /// Whether that is all of them.
    pub recorded: bool,
    /// The dialog for files, while it is open.
    pub dialog: Option<Dialog>,
    /// The title of the window.
    pub title: String,
    pub toggle_theme: bool,
    /// Asked of the session and not yet answered.
    pub waiting: usize,
    pub since: Option<Instant>,
    pub progress: Option<Progress>,
    pub faults: Vec<String>,
    /// What was done, for a while.
    pub notice: Option<(String, Instant)>,
    pub kept: Kept,
    pub undo: Vec<Kept>,
    pub redo: Vec<Kept>,
    pub hovered: Option<Outlined>,
    /// What a bar of a plot stands for, lit up in the views.
    pub lit: Vec<Outlined>,
    /// The camera of the view of the plane; none until a mesh is fitted to it.
    pub camera: Option<Camera>,
    /// How meshes on surfaces are shown in space.
    pub space: InSpace,
    /// Whether the view of the plane shows the whole mesh, and its size in points.
    pub fitted: bool,
    pub view_size: DVec2,
    /// Whether what is hovered was met in the view, and not in a table.
    pub hover_from_view: bool,
    /// Show the decision from near as soon as the view's size is known.
    pub look: Option<Look>,
    pub playing: Option<Instant>,
    /// Quadrilaterals a second.
    pub speed: f32,
    pub sort: (FrontColumn, bool),
    /// The classes shown in the table of the front.
    pub classes: [bool; 4],
    /// The row that the table is to show.
    pub scroll_to: Option<Outlined>,
    pub overlay: Over,
    pub field: String,
    pub breakpoint_field: String,
    /// Changes when the mesh is to be drawn in another way.
    pub style_epoch: u64,
    /// Changes when what lies over it changes.
    pub over_epoch: u64,
    pub reset_layout: bool,
    /// The docks are to be arranged as `kept.layout` says.
    pub relayout: bool,
    /// Height of the timeline with its buttons.
    pub bottom: f32,
    pub screenshot: bool,
    /// What the timeline has counted, and the row whose kinds stand apart.
    pub columns: Columns,
    pub open_lanes: Option<usize>,
    /// The steps that the timeline shows, where that is not all.
    pub timeline: Option<[f64; 2]>,
    /// Where a drag of the timeline has asked to go.
    pub seeking: Option<u64>,
    /// A parameter that is being dragged.
    pub tentative: Option<(&'static str, f64)>,
    /// How often each breakpoint is met.
    pub hits: Vec<usize>,
    /// Why the picked segment was or was not chosen, at a step.
    pub explained: Option<(u64, Arc<Explained>)>,
    /// What was asked to be explained last.
    asked: Option<(u64, [NodeId; 2])>,
    /// What became of what is picked.
    past: Option<Arc<Past>>,
    asked_past: Option<(u64, Watched)>,
    /// How long states and frames take.
    pub times: Times,
    /// Whether that is shown.
    pub show_times: bool,
    pub measuring: Option<Measuring>,
    /// Whether the graphics device is lost.
    pub is_lost: bool,
}

/// Where the main view is to look next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    Fit,
    /// As a run has kept it.
    Kept(run::Camera),
    Decision,
    At(Outlined),
    /// All of it in space, from a side.
    From(Bearing),
}

/// What is open over the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    Nothing,
    Palette,
    Help,
    GoTo,
    Path,
    Mesh,
}

impl State {
    /// A window in which nothing is open; `wake` is called from other threads when something is to be told.
    pub fn new(wake: Wake) -> State {
        State {
            wake,
            session: None,
            source: None,
            opening: None,
            import: None,
            pictures: 0,
            watcher: None,
            awaited: None,
            autosave: None,
            notes: false,
            figures: Figures::default(),
            saving: Vec::new(),
            opened: None,
            moment: None,
            verdict: Verdict::Looking,
            changes: Since::everything(),
            track: Vec::new(),
            samples: Vec::new(),
            track_epoch: 0,
            recorded: false,
            dialog: None,
            title: String::new(),
            toggle_theme: false,
            waiting: 0,
            since: None,
            progress: None,
            faults: Vec::new(),
            notice: None,
            kept: Kept::default(),
            undo: Vec::new(),
            redo: Vec::new(),
            hovered: None,
            lit: Vec::new(),
            camera: None,
            space: InSpace::default(),
            fitted: true,
            view_size: DVec2::ZERO,
            hover_from_view: false,
            look: None,
            playing: None,
            speed: 8.0,
            sort: (FrontColumn::Rank, true),
            classes: [true; 4],
            scroll_to: None,
            overlay: Over::Nothing,
            field: String::new(),
            breakpoint_field: String::new(),
            style_epoch: 0,
            over_epoch: 0,
            reset_layout: false,
            relayout: false,
            bottom: 216.0,
            screenshot: false,
            columns: Columns::default(),
            open_lanes: None,
            timeline: None,
            seeking: None,
            tentative: None,
            hits: Vec::new(),
            explained: None,
            asked: None,
            past: None,
            asked_past: None,
            times: Times::default(),
            show_times: false,
            measuring: None,
            is_lost: false,
        }
    }

    /// Opens a case or a mesh in place of what is open, which stays until the other one stands. Of a mesh it is shown first what
    /// it is like.
    pub fn open(&mut self, source: Source) {
        if let Source::File(path) = &source
            && Format::from_path(path).is_ok()
        {
            return self.import(path.clone(), MeshOptions::default());
        }
        let is_of_import =
            matches!((&source, &self.import), (Source::Mesh(path, _), Some(import)) if *path == import.path);
        if !is_of_import {
            self.give_up_import();
        }
        let named = source.clone();
        let session = Session::open(move || read(&named), self.wake.clone());
        if self.opening.replace((source, session)).is_none() {
            self.waiting += 1;
        }
        self.since.get_or_insert_with(Instant::now);
    }

    /// Shows what a mesh is like and how it is to be taken.
    pub fn import(&mut self, path: PathBuf, options: MeshOptions) {
        self.give_up_import();
        self.stop_opening();
        self.playing = None;
        self.import = Some(Import::begin(path, options, self.pictures, self.wake.clone()));
    }

    /// Whether something is being opened.
    pub fn is_opening(&self) -> bool {
        self.opening.is_some()
    }

    /// Gives up what is being opened.
    pub fn stop_opening(&mut self) {
        if let Some((_, session)) = &self.opening {
            session.stop();
        }
    }

    /// Gives up the mesh that is about to be converted.
    pub fn give_up_import(&mut self) {
        if let Some(import) = self.import.take() {
            self.pictures = import.generation();
        }
    }

    /// Hears what the mesh that is about to be converted is like.
    pub fn look_at_import(&mut self, dark: bool) {
        let Some(import) = &mut self.import else { return };
        if let News::Refused(fault) = import.look(dark) {
            self.complain(&fault);
            self.give_up_import();
            self.keeps();
        }
    }

    /// Says that what is open stays, where something is.
    fn keeps(&mut self) {
        if let Some(opened) = &self.opened {
            self.notice(format!("The window keeps {}.", opened.case.name));
        }
    }

    /// Hears what is being opened: it takes the place of what is open, or is given up with what is wrong.
    fn hear_opening(&mut self) {
        while let Some(told) = self.opening.as_ref().and_then(|(_, session)| session.hear().next()) {
            match told {
                Told::Progress { words, done, total } => self.progress = Some(Progress { words, done, total }),
                Told::Opened(opened) => {
                    if let Some((source, session)) = self.opening.take() {
                        self.begin(source, session, opened);
                    }
                }
                Told::Fault(fault, asks) => {
                    let opening = self.opening.take();
                    match opening {
                        _ if fault.is_stop() => {}
                        Some((Source::Mesh(path, options), _)) => self.refuse(path, options, fault),
                        _ => self.complain(&fault),
                    }
                    // A mesh that is refused can be taken otherwise.
                    if self.import.is_none() {
                        self.keeps();
                    }
                    if let Some(autosave) = &mut self.autosave {
                        autosave.failed();
                    }
                    self.answered(asks);
                }
                _ => {}
            }
        }
    }

    /// Shows why a mesh was refused.
    fn refuse(&mut self, path: PathBuf, options: MeshOptions, fault: Fault) {
        if self.import.is_none() {
            self.import(path, options);
        }
        if let Some(import) = &mut self.import {
            import.refuse_conversion(fault);
        }
    }

    /// What was opened stands.
    fn begin(&mut self, source: Source, session: Session, opened: Arc<Opened>) {
        self.give_up_import();
        self.session = Some(session);
        self.watcher = match &source {
            Source::File(path) | Source::Mesh(path, _) => Some(Watcher::of(path.clone(), self.wake.clone())),
            Source::BuiltIn(_) => None,
        };
        self.notes =
            matches!(&source, Source::BuiltIn(name) if built_in::FIGURES.iter().any(|figure| figure.0 == name));
        self.source = Some(source);
        (self.opened, self.moment) = (None, None);
        self.track.clear();
        self.samples.clear();
        self.track_epoch += 1;
        (self.past, self.asked_past, self.measuring) = (None, None, None);
        (self.recorded, self.waiting) = (false, 1);
        self.since = Some(Instant::now());
        let Kept { layers, colour_by, ref layout, .. } = self.kept;
        self.kept = Kept { layers, colour_by, layout: layout.clone(), ..Kept::default() };
        self.undo.clear();
        self.redo.clear();
        self.hits.clear();
        (self.explained, self.asked, self.timeline) = (None, None, None);
        (self.camera, self.playing, self.hovered) = (None, None, None);
        self.space.begin();
        self.look = Some(opened.run.camera.map_or(Look::Fit, Look::Kept));
        self.kept.edits = opened.run.edits().to_vec();
        self.kept.bookmarks = opened.run.bookmarks.iter().map(|mark| mark.step).collect();
        self.awaited = opened.run.shown.as_ref().and_then(|shown| shown.state()).copied();
        if let Some(shown) = self.awaited
            && let Some(session) = &self.session
        {
            session.go(if shown.at.is_some() { Goal::Step(shown.step) } else { Goal::End });
            self.waiting += 1;
        }
        self.opened = Some(opened);
    }

    /// Where a figure has brought the window to another state than the one that it shows, says so.
    fn compare(&mut self, moment: &Moment) {
        let is_there =
            |shown: &ShownState| shown.step == moment.step || shown.at.is_none() && moment.phase == Phase::Done;
        let Some(shown) = self.awaited.filter(|_| self.waiting == 0) else { return };
        self.awaited = None;
        if !is_there(&shown) || fingerprint(&moment.mesh, &moment.phase) != shown.state {
            let name = self.source.as_ref().map_or_else(String::new, Source::name);
            self.complain(&another_state(&name, shown.step));
        }
    }

    /// Whether the session still owes an answer.
    pub fn is_busy(&self) -> bool {
        self.waiting > 0
    }

    /// Tells a fault; it stays until it is closed.
    pub fn complain(&mut self, fault: &Fault) {
        let text = fault.to_string();
        if !self.faults.contains(&text) {
            self.faults.push(text);
        }
    }

    /// Tells that something was done.
    pub fn notice(&mut self, text: String) {
        self.notice = Some((text, Instant::now()));
    }

    /// The run is another from now on.
    pub fn run_changed(&mut self) {
        self.recorded = false;
        if let Some(session) = &self.session {
            session.set_edits(self.kept.edits.clone());
            self.waiting += 1;
            self.since.get_or_insert_with(Instant::now);
        }
    }

    /// Something in a panel is pointed at, and stands out in the view.
    pub fn hover(&mut self, what: Option<Outlined>) {
        if self.hovered != what {
            self.hovered = what;
            self.hover_from_view = true;
            self.over_epoch += 1;
        }
    }

    /// The breakpoints and watchpoints that are on.
    pub fn stops(&self) -> Stops {
        let on = self.kept.breakpoints.iter().filter(|b| b.1);
        Stops {
            conditions: on.filter_map(|b| Condition::parse(&b.0).ok()).collect(),
            watched: self.kept.watches.iter().filter(|w| w.1).map(|w| w.0).collect(),
        }
    }

    /// The front segment or edge that is picked, from A to B.
    pub fn picked_segment(&self) -> Option<[NodeId; 2]> {
        match self.kept.picked {
            Some(Outlined::Edge(ends)) => Some(ends),
            _ => None,
        }
    }

    /// The step at which each element was last made, where that is what elements are coloured by.
    pub fn births(&self, by: ColourBy, moment: &Moment) -> Vec<u64> {
        let mut births = vec![0; moment.mesh.element_slots()];
        if by == ColourBy::Birth {
            let steps = self.track.iter().take(moment.step as usize).zip(1..);
            for (&(element, _), step) in steps.filter_map(|(step, k)| Some((step.formed.as_ref()?, k))) {
                if let Some(birth) = births.get_mut(element.index()) {
                    *birth = step;
                }
            }
        }
        births
    }

    /// The run with everything that a person has changed.
    pub fn run(&self) -> Option<Run> {
        let mut run = self.opened.as_ref()?.run.clone();
        run.shown = None;
        run.set_edits(self.kept.edits.clone());
        let name = |step: u64| run.bookmarks.iter().find(|mark| mark.step == step).map(|mark| mark.name.clone());
        let marks = self.kept.bookmarks.iter();
        let marks = marks.map(|step| Bookmark { step: *step, name: name(*step).unwrap_or_default() });
        run.bookmarks = marks.collect();
        run.camera = self.kept_camera().or(run.camera);
        Some(run)
    }

    /// Whether the mesh lies on surfaces, and is shown in space.
    pub fn is_in_space(&self) -> bool {
        self.space.place != Place::Plane && self.moment.as_ref().is_some_and(|moment| moment.mesh.ground().is_some())
    }

    /// The camera of the main view, where it does not show all from where it did at first.
    fn kept_camera(&self) -> Option<run::Camera> {
        if self.is_in_space() {
            let moved = self.space.camera.filter(|_| !self.space.fitted);
            return moved.map(|camera| camera.kept(self.space.size));
        }
        self.camera.filter(|_| !self.fitted).map(|camera| camera.kept(self.view_size))
    }

    /// The value of a parameter at the step at hand.
    pub fn parameter(&self, key: &str) -> Option<String> {
        self.moment.as_ref()?.parameters.text_of(key)
    }
}

/// Reads what is to be opened.
fn read(source: &Source) -> Result<Run, Fault> {
    match source {
        Source::BuiltIn(name) => match built_in::named(name) {
            Some(case) => case.map(Run::of),
            None => Err(Fault::new("There is no built-in case of this name").at(name.clone())),
        },
        Source::File(path) => input::run_of(path, &MeshOptions::default()),
        Source::Mesh(path, options) => input::run_of(path, options),
    }
}
