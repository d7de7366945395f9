//! Everything that can be done in the window, as a value: menus, keys, panels, the palette and tests all use it.

mod keys;
mod name;
mod rules;

pub use keys::{Purpose, groups, keys, keys_in, keys_of_study};

pub use rules::Rules;

use super::figures::{FigureForm, Formats};
use super::film::FilmCommand;
use super::import::{Gesture, ImportOptions};
use super::layout::Pane;
use super::lists::ListKind;
use super::pair::PairCommand;
use super::presentation::{Chrome, PresentationCommand};
use super::session::{Direction, Goal, Source};
use super::state::{SurfaceView, ViewCamera, ViewKind};
use super::study::StudyCommand;
use super::sweep::SweepCommand;
use super::view_layer::ViewLayer;
use crate::app::command_line::Overrides;
use crate::core::case::built_in;
use crate::core::convert::EventKind;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::{Query, Watched};
use crate::render::camera::Bearing;
use crate::render::scene::{ColourBy, Outlined};

/// What the user asks for, and what a panel or a view asks for by itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Go to another step.
    Go(Goal),
    /// Go where a text says: to a step, or to something by number or coordinates.
    GoToText(String),
    /// Go to the next breakpoint, or to the one before.
    ToBreakpoint(Direction),
    /// Play, or stop playing.
    Play,
    /// Quadrilaterals a second while playing.
    Speed(f32),
    /// Stop what is under way.
    Stop,
    /// The pointer is on something in this frame.
    Hover(Outlined),
    /// Select something for the inspector.
    Pick(Option<Outlined>),
    /// Show something in the middle of the view.
    Show(Outlined),
    /// Light something up in the views, with a notice that says what.
    LightUp(Vec<Outlined>, String),
    /// Go back to the step that touched something last.
    LastTouch(Outlined),
    /// Go to the step that made a node, or the quadrilateral of an element.
    Made(Outlined),
    /// Ask why a segment of the front was or was not chosen.
    Explain([NodeId; 2]),
    /// Ask what the steps from one to another did, a sentence each.
    TellTranscript(u64, u64),
    /// Ask for the history of something.
    TellPast(Watched),
    /// Ask for the decision chain of a quadrilateral.
    TellChain(ElementId),
    /// Select a quadrilateral and show its decision chain in the inspector.
    ShowChain(ElementId),
    /// Go to the step of the decision chain that cost the selected quadrilateral most quality.
    ToLargestLoss,
    /// Make a list of elements or nodes.
    List(ListKind, Query),
    /// Copy such a list as comma-separated values.
    CopyList(ListKind, Query),
    /// Select something and bring it into view.
    Find(Outlined),
    /// Select the quadrilateral of the lowest quality and bring it into view.
    FindWorst,
    /// Watch something, or stop watching it.
    Watch(Outlined),
    /// Switch a watchpoint on or off.
    SwitchWatch(usize),
    /// Fit the whole mesh to the view.
    Fit,
    /// Show the base segment in the middle, from near.
    ShowDecision,
    /// Let the camera go where the decision is, or stay.
    ToggleFollow,
    /// Look at the mesh in space from there.
    LookFrom(Bearing),
    /// A view looks elsewhere.
    MoveCamera(ViewKind, ViewCamera),
    /// Show meshes on surfaces there.
    SurfaceView(SurfaceView),
    /// Switch between the plane and space.
    TogglePlane,
    /// Show the plane beside space, or space alone.
    ToggleSplit,
    /// The next way to draw hidden lines.
    HiddenLines,
    /// Switch between curved and flat elements.
    ToggleCurved,
    /// Change a parameter from this step on.
    Set(&'static str, String),
    /// Have the selection choose this front segment, from A to B: a change of the run.
    ChooseBase([NodeId; 2]),
    /// Reset all parameters to those of the case.
    ResetParameters,
    /// Set all parameters that can change at a step from this one on.
    SetRules(Rules),
    /// Open the run again with another value of a parameter that belongs to its case.
    SetForCase(&'static str, String),
    /// Switch a layer on or off.
    Layer(ViewLayer),
    /// Colour elements by something.
    ColourBy(ColourBy),
    /// Switch between the dark and the light theme.
    ToggleTheme,
    /// Add a breakpoint.
    AddBreakpoint(String),
    /// Switch a breakpoint on or off.
    SwitchBreakpoint(usize),
    /// Remove a breakpoint.
    RemoveBreakpoint(usize),
    /// Find the smallest case in which a breakpoint is still met.
    Reduce(usize),
    /// Stop that.
    StopReducing,
    /// Set a bookmark at this step, or remove it.
    Bookmark,
    /// Bookmark this step, if it is not, and write the note on it.
    NoteHere,
    /// Change the note on a bookmarked step.
    WriteNote(u64, String),
    /// Remove the bookmark of a step.
    RemoveBookmark(u64),
    /// Export the notes on all bookmarked steps as one page.
    ExportNotes,
    /// Open a case or a mesh.
    Open(Source),
    /// Open a case or a mesh with its parameters changed.
    OpenWith(Source, Box<Overrides>),
    /// Show again how the mesh that is open was imported, to change it.
    Import,
    /// Change how the mesh that is about to be converted is imported.
    SetImport(Box<ImportOptions>, Gesture),
    /// Convert it.
    Convert,
    /// Stop the conversion, or else give up the mesh.
    CancelImport,
    /// Ask for a file with the system's dialog.
    OpenDialog,
    /// Show the field for a path.
    OpenPath,
    /// Show the field for a step or a number of quadrilaterals.
    GoTo,
    /// Show the field for what is looked for by number or coordinates.
    FindField,
    /// Go to a step, and select something there and bring it into view.
    FindAt(u64, Outlined),
    /// Save a picture of the window.
    Screenshot,
    /// Save a figure of the state, as the panel for figures says.
    Export,
    /// Show or hide the panel for figures.
    Figures,
    /// Change how figures are made.
    SetFigure(Box<FigureForm>),
    /// Ask for the folder of figures with the system's dialog.
    ChooseFolder,
    /// Save a figure as the panel for figures says, in these formats.
    SaveFigure(Formats),
    /// Make a film as the panel for figures says, or stop that.
    Film(FilmCommand),
    /// Open the file again.
    Reopen,
    /// Show or hide the notes on the case.
    Notes,
    /// Open the autosaved run that is offered.
    OpenKept,
    /// Discard the autosaved run that is offered.
    DiscardKept,
    /// Open the state that a link names.
    OpenLink(String),
    /// Copy a link that names this state, with what is selected and seen.
    CopyLink,
    /// Save what is shown as a page with the program inside.
    SavePage,
    /// Save the run: the case with all changes.
    SaveRun,
    /// Ask where to save the current mesh.
    SaveMesh,
    /// Save the current mesh to a path.
    SaveMeshAs(String),
    /// Sweep parameters.
    Sweep(SweepCommand),
    /// Undo the last change.
    Undo,
    /// Redo it.
    Redo,
    /// Show all commands by name.
    Palette,
    /// Show all keys.
    Help,
    /// Close what is open over the window.
    CloseOverlay,
    /// Close a message.
    CloseFault(usize),
    /// Show or hide the log of all messages.
    Messages,
    /// Show a panel in its tabs.
    Reveal(Pane),
    /// The user has arranged the panels like this.
    Arrange(String),
    /// Move all panels back to their first places.
    ResetLayout,
    /// Step forward and back, and tell how long states and frames take.
    Measure,
    /// Show or hide how long states and frames take.
    ShowTimes,
    /// Close what is open over the window, or clear the selection.
    Escape,
    /// Do something with two runs.
    Pair(PairCommand),
    /// Learn.
    Study(StudyCommand),
    /// Begin, end or change a presentation.
    Presentation(PresentationCommand),
}

/// Kinds of events that one can go to.
pub const KINDS: [EventKind; 13] = [
    EventKind::BaseSelected,
    EventKind::SideSwapped,
    EventKind::SideDivided,
    EventKind::TopSwapped,
    EventKind::NodeRemoved,
    EventKind::Formed,
    EventKind::RolledBack,
    EventKind::Deferred,
    EventKind::Enhanced,
    EventKind::Seamed,
    EventKind::Split,
    EventKind::Closed,
    EventKind::LastResort,
];

impl Command {
    /// Its key as text, if it has one.
    pub fn key(&self) -> Option<String> {
        if *self == Command::Help {
            return Some("?".into());
        }
        let mut all = keys().into_iter().chain(keys_in(Chrome::Presentation));
        all.find(|k| k.2 == *self).map(|(modifiers, key, _)| keys::text(modifiers, key))
    }

    /// Its name with its key, for tooltips.
    pub fn tip(&self) -> String {
        match self.key() {
            Some(key) => format!("{}  ({key})", self.name()),
            None => self.name(),
        }
    }

    /// Whether its key repeats while it is held.
    pub fn repeats(&self) -> bool {
        matches!(self, Command::Go(Goal::Steps(_) | Goal::Quads(_)) | Command::Undo | Command::Redo)
    }

    /// Whether it says only what the pointer is on, in either of two runs.
    pub fn is_hover(&self) -> bool {
        match self {
            Command::Pair(PairCommand::In(_, command)) => command.is_hover(),
            command => matches!(command, Command::Hover(_) | Command::Study(StudyCommand::PointAt(_))),
        }
    }

    /// Whether it is about the state that is shown, and so waits while the session is on the way to another one: keys
    /// that are pressed one after another mean the same on every machine.
    pub fn is_about_the_state(&self) -> bool {
        matches!(
            self,
            Command::FindWorst
                | Command::ToLargestLoss
                | Command::Bookmark
                | Command::NoteHere
                | Command::CopyLink
                | Command::SavePage
                | Command::Export
                | Command::Pair(PairCommand::Fork | PairCommand::ForkWith(_))
        )
    }

    /// Whether it opens a field, which gets the focus.
    pub fn opens_a_field(&self) -> bool {
        matches!(
            self,
            Command::Palette
                | Command::GoTo
                | Command::FindField
                | Command::OpenPath
                | Command::SaveMesh
                | Command::NoteHere
                | Command::Pair(PairCommand::AskBeside)
                | Command::Sweep(SweepCommand::Save)
        )
    }

    /// Whether it works while a mesh is about to be converted. What belongs to a run has to wait until there is one,
    /// unless a panel asked for it by itself in the frame in which the import began.
    pub fn fits_import(&self) -> bool {
        if let Command::Pair(PairCommand::In(_, command)) = self {
            return command.fits_import();
        }
        matches!(
            self,
            Command::Hover(_)
                | Command::Explain(_)
                | Command::TellTranscript(..)
                | Command::TellPast(_)
                | Command::TellChain(_)
                | Command::List(..)
                | Command::MoveCamera(..)
                | Command::SetFigure(_)
                | Command::CloseOverlay
                | Command::CloseFault(_)
                | Command::Messages
                | Command::Arrange(_)
                | Command::SetImport(..)
                | Command::Convert
                | Command::CancelImport
                | Command::Escape
                | Command::Stop
                | Command::Film(FilmCommand::Stop)
                | Command::Sweep(SweepCommand::Stop | SweepCommand::Set(_))
                | Command::Fit
                | Command::LookFrom(_)
                | Command::HiddenLines
                | Command::ToggleTheme
                | Command::Open(_)
                | Command::OpenWith(..)
                | Command::OpenLink(_)
                | Command::OpenDialog
                | Command::OpenPath
                | Command::OpenKept
                | Command::DiscardKept
                | Command::Undo
                | Command::Redo
                | Command::Palette
                | Command::Help
                | Command::Screenshot
                | Command::Study(
                    StudyCommand::Open(_)
                        | StudyCommand::Resume
                        | StudyCommand::PredictSeries(_)
                        | StudyCommand::PointAt(_)
                )
        )
    }

    /// All commands that need no more than their names.
    pub fn all() -> Vec<Command> {
        let mut all: Vec<Command> = keys().into_iter().map(|k| k.2).collect();
        all.extend([
            Command::Help,
            Command::OpenDialog,
            Command::ResetParameters,
            Command::ResetLayout,
            Command::Import,
            Command::Notes,
            Command::ExportNotes,
            Command::Messages,
            Command::ChooseFolder,
            Command::ShowTimes,
            Command::Measure,
        ]);
        all.extend(Pane::ALL.map(Command::Reveal));
        all.extend(SweepCommand::ALL.map(Command::Sweep));
        all.extend(Rules::ALL.map(Command::SetRules));
        all.extend(StudyCommand::all().into_iter().map(Command::Study));
        all.extend(PresentationCommand::ALL.map(Command::Presentation));
        all.extend(PairCommand::all().into_iter().map(Command::Pair));
        all.extend(SurfaceView::ALL.map(Command::SurfaceView));
        all.extend(ColourBy::ALL.map(Command::ColourBy));
        all.extend(KINDS.iter().flat_map(|&kind| Direction::BOTH.map(|way| Command::Go(Goal::Kind(kind, way)))));
        all.extend(built_in::all().map(|case| Command::Open(Source::BuiltIn(case.0.to_owned()))));
        let mut seen: Vec<String> = Vec::new();
        all.retain(|command| {
            let name = command.name();
            let new = !seen.contains(&name);
            seen.push(name);
            new
        });
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_name_of_its_own_and_tells_its_key() {
        let all = Command::all();
        assert!(all.len() > 60);
        assert_eq!(Command::Go(Goal::Steps(1)).tip(), "Step forward (operation)  (Ctrl+Right)");
        assert_eq!(Command::ToBreakpoint(Direction::Back).tip(), "Back to a breakpoint  (Alt+F5)");
        assert_eq!(Command::Layer(ViewLayer::Front).tip(), "Layer: front  (3)");
    }
}
