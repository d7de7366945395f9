//! The import of a mesh file before it is converted: its options and what the mesh is like. A thread shows the effect
//! of every change (`preview`); only the latest one counts.

mod preview;

use std::path::PathBuf;
use std::sync::Arc;

pub use preview::{KINDS, Loaded, PartFacts, Shown};
use preview::{Preview, PreviewNews, Wanted};

use super::session::{Direction, Wake};
use super::state::{Progress, ViewCamera};
use crate::app::command_line::Overrides;
use crate::app::input;
/// How a mesh is imported, in the words of the command line.
pub use crate::core::case::ImportOptions;
use crate::core::case::{MeshUse, Taking};
use crate::core::fault::Fault;
use crate::core::soup::{Ignored, Weld};
use crate::core::step::{StepOptions, is_step};

/// How many changes can be undone.
const UNDO: usize = 100;

/// Units of length of files, in metres.
pub const UNITS: [(&str, f64); 4] = [("mm", 0.001), ("cm", 0.01), ("m", 1.0), ("inch", 0.0254)];

/// Whether a change is one of a drag that goes on: all changes of a drag are undone as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gesture {
    /// The drag goes on.
    Dragging,
    /// There is no drag, or it has ended.
    Done,
}

/// A mesh that is about to be converted.
pub struct Import {
    /// Its file.
    pub path: PathBuf,
    /// How it is imported.
    pub options: ImportOptions,
    /// How the parameters of its run are changed.
    pub overrides: Overrides,
    preview: Preview,
    /// The options with which the file was read.
    read_with: (Ignored, Weld, StepOptions),
    wake: Wake,
    /// The mesh with its repairs, once it has been read.
    pub loaded: Option<Arc<Loaded>>,
    /// Why it was refused; shapes are in the unit of the file.
    pub refused: Option<Fault>,
    /// The picture of it.
    pub shown: Option<Arc<Shown>>,
    /// The progress of the preview, while it is under way.
    pub progress: Option<Progress>,
    wanted: Option<Wanted>,
    /// The number of the last picture that was asked for: pictures of another import have later ones.
    pub generation: u64,
    undo: Vec<ImportOptions>,
    redo: Vec<ImportOptions>,
    /// What the last change was part of.
    pub gesture: Gesture,
    /// Where the view of it looks.
    pub view: ViewCamera,
}

impl Import {
    /// Starts to read a mesh; `generation` is at least the number of any picture before.
    pub fn begin(path: PathBuf, options: ImportOptions, generation: u64, wake: Wake) -> Import {
        Import {
            preview: Preview::of(path.clone(), options.clone(), wake.clone()),
            read_with: read_with(&options),
            wake,
            path,
            options,
            overrides: Overrides::default(),
            loaded: None,
            refused: None,
            shown: None,
            progress: None,
            wanted: None,
            generation,
            undo: Vec::new(),
            redo: Vec::new(),
            gesture: Gesture::Done,
            view: ViewCamera::default(),
        }
    }

    /// The options in the terms of `core`.
    pub fn taking(&self) -> Taking {
        // The panel lets only valid options through; those from elsewhere have been read before.
        input::taking_of(&self.path, &self.options).unwrap_or_default()
    }

    /// Whether it is a CAD file.
    pub fn is_part(&self) -> bool {
        is_step(&self.path)
    }

    /// What the mesh is used for, once it is known.
    pub fn used(&self) -> MeshUse {
        self.taking().used.unwrap_or_else(|| self.use_by_default())
    }

    /// The use by default.
    pub fn use_by_default(&self) -> MeshUse {
        match &self.loaded {
            Some(loaded) if loaded.is_plane && !self.is_part() => MeshUse::Triangles,
            _ => MeshUse::Shape,
        }
    }

    /// Whether the mesh goes through charts.
    pub fn has_charts(&self) -> bool {
        self.loaded.as_ref().is_some_and(|loaded| !loaded.is_plane) || self.used() == MeshUse::Shape
    }

    /// Whether the picture does not show the options yet.
    pub fn is_behind(&self) -> bool {
        self.loaded.is_none() || self.shown.as_ref().is_none_or(|shown| Some(&shown.wanted) != self.wanted.as_ref())
    }

    /// Whether the mesh can be converted, as far as that is known.
    pub fn is_ready(&self) -> bool {
        self.loaded.as_ref().is_some_and(|loaded| loaded.fault.is_none())
    }

    /// Shows why the mesh was refused, and looks there.
    pub fn refuse(&mut self, fault: Fault) {
        self.view.camera = None;
        self.refused = Some(fault);
    }

    /// Shows why the conversion was refused.
    pub fn refuse_conversion(&mut self, mut fault: Fault) {
        let scale = self.taking().scale;
        fault.shapes.iter_mut().flatten().for_each(|p| *p /= scale);
        self.refuse(fault);
    }

    /// With other options the mesh may not be refused.
    fn reconsider(&mut self) {
        self.refused = self.loaded.as_ref().and_then(|loaded| loaded.fault.clone());
    }

    /// Changes how the mesh is imported; undo takes it back.
    pub fn set(&mut self, options: ImportOptions, gesture: Gesture) {
        let goes_on = [gesture, self.gesture] == [Gesture::Dragging; 2];
        if options == self.options {
            // A drag begins with its first change.
            self.gesture = if goes_on { Gesture::Dragging } else { Gesture::Done };
            return;
        }
        let before = std::mem::replace(&mut self.options, options);
        self.gesture = gesture;
        if !goes_on {
            self.undo.push(before);
            if self.undo.len() > UNDO {
                self.undo.remove(0);
            }
        }
        self.redo.clear();
        self.reconsider();
    }

    /// Undoes or redoes a change.
    pub fn take_back(&mut self, direction: Direction) {
        let (from, to) = match direction {
            Direction::Back => (&mut self.undo, &mut self.redo),
            Direction::Forward => (&mut self.redo, &mut self.undo),
        };
        if let Some(options) = from.pop() {
            to.push(std::mem::replace(&mut self.options, options));
            self.reconsider();
        }
        self.gesture = Gesture::Done;
    }

    /// Takes in what the preview reports, and asks for another picture if the options have changed. Returns why the
    /// mesh cannot be read, if that has turned out.
    pub fn look(&mut self, dark: bool) -> Option<Fault> {
        if self.read_with != read_with(&self.options) {
            // The repair depends on the groups and on what is merged, and a part on its unit.
            self.read_with = read_with(&self.options);
            self.preview = Preview::of(self.path.clone(), self.options.clone(), self.wake.clone());
            (self.loaded, self.shown, self.wanted, self.refused) = (None, None, None, None);
        }
        let mut unreadable = None;
        for told in self.preview.hear() {
            match told {
                PreviewNews::Progress(progress) => self.progress = Some(progress),
                PreviewNews::Loaded(Ok(loaded)) => {
                    if let Some(fault) = &loaded.fault {
                        self.refuse(fault.clone());
                    }
                    self.loaded = Some(loaded);
                }
                PreviewNews::Loaded(Err(fault)) => unreadable = Some(fault),
                PreviewNews::Shown(shown) => self.shown = Some(shown),
                PreviewNews::Refused(fault) => self.refuse(fault),
            }
        }
        if self.loaded.is_some() {
            let taking = self.taking();
            let marks = self.refused.as_ref().map_or_else(Arc::default, |fault| fault.shapes.clone().into());
            // The colours of charts would hide the elements for which a mesh is refused.
            let bound = (self.has_charts() && self.refused.is_none()).then(|| taking.bound());
            // The edges of a part are those between its faces.
            let feature_angle = if self.is_part() { std::f64::consts::PI } else { taking.feature_angle };
            let wanted = Wanted { feature_angle, bound, marks, dark };
            if self.wanted.as_ref() != Some(&wanted) {
                // Up to two pictures will be made.
                self.generation += 2;
                self.wanted = Some(wanted.clone());
                self.preview.ask(wanted, self.generation);
            }
            if !self.is_behind() {
                self.progress = None;
            }
        }
        unreadable
    }
}

/// The options that a file is read with.
fn read_with(options: &ImportOptions) -> (Ignored, Weld, StepOptions) {
    (options.ignore_groups.clone(), options.weld.before_scaling(options.scale.unwrap_or(1.0)), options.step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_is_taken_back_as_one_and_what_follows_for_itself() {
        let mut import = Import::begin(PathBuf::from("no such.stl"), ImportOptions::default(), 0, Arc::new(|| {}));
        let angle = |degrees: f64| ImportOptions { feature_angle: Some(degrees), ..ImportOptions::default() };
        for degrees in [30.0, 31.0, 32.0] {
            import.set(angle(degrees), Gesture::Dragging);
        }
        // Let go.
        import.set(angle(32.0), Gesture::Done);
        import.set(angle(50.0), Gesture::Dragging);
        assert_eq!(import.taking().feature_angle, 50.0_f64.to_radians());
        let mut back = || {
            import.take_back(Direction::Back);
            import.options.feature_angle
        };
        assert_eq!([back(), back(), back()], [Some(32.0), None, None]);
        import.take_back(Direction::Forward);
        assert_eq!(import.options.feature_angle, Some(32.0));
    }

    #[test]
    fn a_mesh_that_is_not_there_is_refused_with_its_name() {
        let mut import = Import::begin(PathBuf::from("no such.stl"), ImportOptions::default(), 0, Arc::new(|| {}));
        let begin = std::time::Instant::now();
        let fault = loop {
            if let Some(fault) = import.look(true) {
                break fault;
            }
            assert!(begin.elapsed().as_secs() < 20);
            std::thread::sleep(std::time::Duration::from_millis(2));
        };
        assert!(fault.to_string().starts_with("no such.stl: No such file"), "{fault}");
    }
}
