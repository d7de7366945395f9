//! What the user has set up: the part that undo covers, and settings that outlast the run.

use serde::{Deserialize, Serialize};

use crate::app::window::figures::FigureForm;
use crate::app::window::presentation::PresentationForm;
use crate::app::window::session::Direction;
use crate::app::window::study::Learned;
use crate::app::window::sweep::SweepForm;
use crate::core::kernel::worded::worded;
use crate::core::run::{Bookmark, Edit, Watched};
use crate::render::look::HiddenLines;
use crate::render::scene::{ColourBy, Form, Layers, Outlined};

/// How many changes can be undone.
const UNDO: usize = 200;

/// What the user has set up. A small file keeps the layers, the colours, the speed, the surface style and what is swept
/// from one start to the next (`settings`).
pub struct Workspace {
    pub document: Document,
    /// Quadrilaterals a second while playing.
    pub speed: f32,
    /// Whether the camera goes where the decision is.
    pub follows: bool,
    /// How presentations are shown.
    pub presentation: PresentationForm,
    /// How meshes on surfaces are shown.
    pub surfaces: SurfaceStyle,
    /// How figures are made.
    pub figure: FigureForm,
    /// What is swept.
    pub sweep: SweepForm,
    /// What was learnt.
    pub learned: Learned,
    undo: Vec<Change>,
    redo: Vec<Change>,
    /// The step whose note was changed last: what is typed there is undone as one change.
    noted: Option<u64>,
}

/// Everything that undo covers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Changes of the run: parameters and choices of a base.
    pub edits: Vec<Edit>,
    /// The selection, which the inspector shows.
    pub picked: Option<Outlined>,
    /// What is drawn.
    pub layers: Layers,
    /// What elements are coloured by.
    pub colour_by: ColourBy,
    pub breakpoints: Vec<Breakpoint>,
    pub watches: Vec<Watchpoint>,
    /// The bookmarked steps with their notes, in order.
    pub bookmarks: Vec<Bookmark>,
    /// Where the panels are, once the user has moved them.
    pub layout: Option<String>,
}

/// A change that can be undone or redone.
#[derive(Clone, Debug)]
struct Change {
    /// The document beyond it.
    document: Document,
    /// The selection on this side of it. Stops select as well, without a change: what was selected since stays, unless
    /// the change was one of the selection.
    picked: Option<Outlined>,
}

/// A condition to stop at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Breakpoint {
    pub condition: String,
    pub is_on: bool,
}

/// Something to stop at when it is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watchpoint {
    pub watched: Watched,
    pub is_on: bool,
}

/// How meshes on surfaces are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurfaceStyle {
    pub view: SurfaceView,
    /// How hidden lines are drawn.
    pub hidden: HiddenLines,
    /// Whether elements follow the surface between their nodes.
    pub curved: bool,
}

impl SurfaceStyle {
    /// How the scene in space is laid out.
    pub fn form(&self) -> Form {
        if self.curved { Form::Curved } else { Form::Flat }
    }
}

worded! {
    /// Where the main view shows a mesh on surfaces.
    #[derive(Default, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SurfaceView by name {
        /// In space.
        #[default]
        Space = "Show in space",
        /// In space, with the plane beside it.
        Both = "Show in space and in the plane",
        /// In its parametric plane.
        Plane = "Show in the parametric plane",
    }
}

impl SurfaceView {
    /// From the plane to space, and from anything else to the plane.
    pub fn toggled(self) -> SurfaceView {
        if self == SurfaceView::Plane { SurfaceView::Space } else { SurfaceView::Plane }
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Workspace {
            document: Document::default(),
            speed: 8.0,
            follows: false,
            presentation: PresentationForm::default(),
            surfaces: SurfaceStyle::default(),
            figure: FigureForm::default(),
            sweep: SweepForm::default(),
            learned: Learned::default(),
            undo: Vec::new(),
            redo: Vec::new(),
            noted: None,
        }
    }
}

impl Workspace {
    /// Another run has been opened: how the mesh is shown stays, and nothing can be undone.
    pub(super) fn begin(&mut self, edits: Vec<Edit>, bookmarks: Vec<Bookmark>) {
        let Document { layers, colour_by, ref layout, .. } = self.document;
        self.document = Document { edits, bookmarks, layers, colour_by, layout: layout.clone(), ..Document::default() };
        self.undo.clear();
        self.redo.clear();
        if self.surfaces.view == SurfaceView::Plane {
            self.surfaces.view = SurfaceView::Space;
        }
    }

    /// Takes over how meshes and figures look in another one. Returns whether layers or colours have changed.
    pub(super) fn look_like(&mut self, other: &Workspace) -> bool {
        (self.surfaces, self.speed) = (other.surfaces, other.speed);
        if self.figure != other.figure {
            self.figure = other.figure.clone();
        }
        let (to, from) = (&mut self.document, &other.document);
        let is_new = (to.layers, to.colour_by) != (from.layers, from.colour_by);
        (to.layers, to.colour_by) = (from.layers, from.colour_by);
        is_new
    }

    /// Exchanges the documents of two runs with all that can be undone. The arrangement of the panels is that of the
    /// window and stays.
    pub(super) fn exchange(&mut self, other: &mut Workspace) {
        std::mem::swap(&mut self.document, &mut other.document);
        std::mem::swap(&mut self.document.layout, &mut other.document.layout);
        std::mem::swap(&mut self.undo, &mut other.undo);
        std::mem::swap(&mut self.redo, &mut other.redo);
        std::mem::swap(&mut self.noted, &mut other.noted);
        for workspace in [self, other] {
            let layout = &workspace.document.layout;
            let changes = workspace.undo.iter_mut().chain(&mut workspace.redo);
            changes.for_each(|change| change.document.layout.clone_from(layout));
        }
    }

    /// Changes the document so that undo takes it back. Returns the document as it was before, if there is a
    /// difference.
    pub(super) fn change(&mut self, change: impl FnOnce(&mut Document)) -> Option<Document> {
        let before = self.document.clone();
        change(&mut self.document);
        if self.document == before {
            return None;
        }
        self.noted = None;
        self.undo.push(Change { document: before.clone(), picked: self.document.picked });
        if self.undo.len() > UNDO {
            self.undo.remove(0);
        }
        self.redo.clear();
        Some(before)
    }

    /// Selects what the run has come upon: not a change of the user's, so that undo does not take it back. Returns the
    /// document as it was before, if there is a difference.
    pub(super) fn come_upon(&mut self, what: Outlined) -> Option<Document> {
        let before = self.document.clone();
        self.document.picked = Some(what);
        (self.document != before).then_some(before)
    }

    /// Changes the note on a bookmarked step. What is typed in one go is one change.
    pub(super) fn write_note(&mut self, step: u64, note: String) {
        let Ok(k) = self.document.bookmarks.binary_search_by_key(&step, |mark| mark.step) else { return };
        if self.noted == Some(step) {
            self.document.bookmarks[k].note = note;
        } else if self.change(|document| document.bookmarks[k].note = note).is_some() {
            self.noted = Some(step);
        }
    }

    /// Undoes or redoes a change. Returns the document as it was before, if there was anything to undo or redo.
    pub(super) fn take_back(&mut self, direction: Direction) -> Option<Document> {
        let (from, to) = match direction {
            Direction::Back => (&mut self.undo, &mut self.redo),
            Direction::Forward => (&mut self.redo, &mut self.undo),
        };
        let Change { mut document, picked } = from.pop()?;
        let mut there = self.document.clone();
        if document.picked == picked {
            document.picked = self.document.picked;
        } else {
            // The change was a selection: what a stop has selected since is not what it led to.
            there.picked = picked;
        }
        self.noted = None;
        to.push(Change { document: there, picked: document.picked });
        Some(std::mem::replace(&mut self.document, document))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::NodeId;

    fn node(n: u32) -> Option<Outlined> {
        Some(Outlined::Node(NodeId(n)))
    }

    fn stop(workspace: &mut Workspace, n: u32) {
        workspace.come_upon(Outlined::Node(NodeId(n)));
    }

    #[test]
    fn what_a_stop_selects_is_neither_undone_nor_lost_when_something_else_is() {
        let mut all = Workspace::default();
        stop(&mut all, 1);
        assert!(all.take_back(Direction::Back).is_none(), "nothing that the user did");
        all.change(|document| document.colour_by = ColourBy::Level);
        stop(&mut all, 2);
        all.take_back(Direction::Back).unwrap();
        assert_eq!((all.document.colour_by, all.document.picked), (ColourBy::default(), node(2)));
        stop(&mut all, 3);
        all.take_back(Direction::Forward).unwrap();
        assert_eq!((all.document.colour_by, all.document.picked), (ColourBy::Level, node(3)));
        // A selection of the user's is undone to what was selected before, and redone.
        all.change(|document| document.picked = node(9));
        stop(&mut all, 4);
        all.take_back(Direction::Back).unwrap();
        assert_eq!(all.document.picked, node(3));
        all.take_back(Direction::Forward).unwrap();
        assert_eq!(all.document.picked, node(9));
    }
}
