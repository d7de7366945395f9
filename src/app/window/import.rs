//! A mesh file that is about to be converted: how it is taken, in the words of the command line, and what it is like.
//! Whatever a person changes is previewed by a thread (`preview`), the newest wish alone.

mod preview;

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec2;

pub use preview::{KINDS, Loaded, Shown};
use preview::{Preview, Told, Wanted};

use super::session::Wake;
use super::state::Progress;
use crate::app::command_line::MeshOptions;
use crate::app::input;
use crate::core::case::{MeshUse, Taking};
use crate::core::fault::Fault;
use crate::render::camera::Camera;

/// How many changes can be taken back.
const UNDO: usize = 100;

/// Units of length that files have, in metres.
pub const UNITS: [(&str, f64); 4] = [("mm", 0.001), ("cm", 0.01), ("m", 1.0), ("inch", 0.0254)];

/// A mesh that is about to be converted.
pub struct Import {
    /// Its file.
    pub path: PathBuf,
    /// How it is taken.
    pub options: MeshOptions,
    preview: Preview,
    /// The mesh, mended, once it is there.
    pub loaded: Option<Arc<Loaded>>,
    /// Why it was refused, with elements in the file's own unit.
    pub refused: Option<Fault>,
    /// The picture of it.
    pub shown: Option<Arc<Shown>>,
    /// How far the preview is, while it is under way.
    pub progress: Option<Progress>,
    wanted: Option<Wanted>,
    /// The last number that a picture was asked for under.
    generation: u64,
    undo: Vec<MeshOptions>,
    redo: Vec<MeshOptions>,
    /// Whether the last change was one of a drag, which is taken back as one.
    is_dragging: bool,
    /// From where it is looked at; none until it is fitted to the view.
    pub camera: Option<Camera>,
    /// Whether the view shows all of it, and the size of the view in points.
    pub fitted: bool,
    pub size: DVec2,
}

/// What becomes of an import.
pub enum News {
    /// Nothing that anybody else needs to know.
    Nothing,
    /// The mesh cannot be read.
    Refused(Fault),
}

impl Import {
    /// Begins to read a mesh; `generation` is greater than that of any picture before.
    pub fn begin(path: PathBuf, options: MeshOptions, generation: u64, wake: Wake) -> Import {
        Import {
            preview: Preview::of(path.clone(), wake),
            path,
            options,
            loaded: None,
            refused: None,
            shown: None,
            progress: None,
            wanted: None,
            generation,
            undo: Vec::new(),
            redo: Vec::new(),
            is_dragging: false,
            camera: None,
            fitted: true,
            size: DVec2::ZERO,
        }
    }

    /// Whether the last change was one of a drag that goes on.
    pub fn is_dragging(&self) -> bool {
        self.is_dragging
    }

    /// The number after which pictures of another import are numbered.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// How the mesh is taken, in the core's words.
    pub fn taking(&self) -> Taking {
        // What the panel lets through is valid; options from elsewhere have been read before.
        input::taking_of(&self.path, &self.options).unwrap_or_default()
    }

    /// What the mesh is used for, once it is known.
    pub fn used(&self) -> MeshUse {
        self.taking().used.unwrap_or_else(|| self.use_by_default())
    }

    /// The same where nobody says it.
    pub fn use_by_default(&self) -> MeshUse {
        match &self.loaded {
            Some(loaded) if loaded.is_plane => MeshUse::Triangles,
            _ => MeshUse::Shape,
        }
    }

    /// Whether the mesh goes through charts.
    pub fn has_charts(&self) -> bool {
        self.loaded.as_ref().is_some_and(|loaded| !loaded.is_plane) || self.used() == MeshUse::Shape
    }

    /// Whether the picture is not that of the options yet.
    pub fn is_behind(&self) -> bool {
        self.loaded.is_none() || self.shown.as_ref().is_none_or(|shown| Some(&shown.wanted) != self.wanted.as_ref())
    }

    /// Whether the mesh can be converted, as far as that is known.
    pub fn is_ready(&self) -> bool {
        self.loaded.as_ref().is_some_and(|loaded| loaded.fault.is_none())
    }

    /// Shows what the mesh was refused for, and looks there.
    pub fn refuse(&mut self, fault: Fault) {
        self.camera = None;
        self.refused = Some(fault);
    }

    /// Shows what a conversion of the mesh as it is taken was refused for.
    pub fn refuse_conversion(&mut self, mut fault: Fault) {
        let scale = self.taking().scale;
        fault.shapes.iter_mut().flatten().for_each(|p| *p /= scale);
        self.refuse(fault);
    }

    /// What was refused may not be, taken otherwise.
    fn reconsider(&mut self) {
        self.refused = self.loaded.as_ref().and_then(|loaded| loaded.fault.clone());
    }

    /// Changes how the mesh is taken, so that it can be taken back.
    pub fn set(&mut self, options: MeshOptions, dragging: bool) {
        if options == self.options {
            self.is_dragging &= dragging;
            return;
        }
        let before = std::mem::replace(&mut self.options, options);
        if !(dragging && self.is_dragging) {
            self.undo.push(before);
            if self.undo.len() > UNDO {
                self.undo.remove(0);
            }
        }
        self.is_dragging = dragging;
        self.redo.clear();
        self.reconsider();
    }

    /// Takes back the last change, or does it again.
    pub fn take_back(&mut self, back: bool) {
        let (from, to) = if back { (&mut self.undo, &mut self.redo) } else { (&mut self.redo, &mut self.undo) };
        if let Some(options) = from.pop() {
            to.push(std::mem::replace(&mut self.options, options));
            self.reconsider();
        }
        self.is_dragging = false;
    }

    /// Hears what the preview tells, and asks for a picture where another one is wanted now.
    pub fn look(&mut self, dark: bool) -> News {
        let mut news = News::Nothing;
        for told in self.preview.hear() {
            match told {
                Told::Progress(progress) => self.progress = Some(progress),
                Told::Loaded(Ok(loaded)) => {
                    if let Some(fault) = &loaded.fault {
                        self.refuse(fault.clone());
                    }
                    self.loaded = Some(loaded);
                }
                Told::Loaded(Err(fault)) => news = News::Refused(fault),
                Told::Shown(shown) => self.shown = Some(shown),
                Told::Refused(fault) => self.refuse(fault),
            }
        }
        if self.loaded.is_some() {
            let taking = self.taking();
            let marks = self.refused.as_ref().map_or_else(Arc::default, |fault| fault.shapes.clone().into());
            // What is refused has no charts, or their colours would hide what it is refused for.
            let bound = (self.has_charts() && self.refused.is_none()).then(|| taking.bound());
            let wanted = Wanted { feature_angle: taking.feature_angle, bound, marks, dark };
            if self.wanted.as_ref() != Some(&wanted) {
                // Two pictures may come of it.
                self.generation += 2;
                self.wanted = Some(wanted.clone());
                self.preview.ask(wanted, self.generation);
            }
            if !self.is_behind() {
                self.progress = None;
            }
        }
        news
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_is_taken_back_as_one_and_what_follows_for_itself() {
        let mut import = Import::begin(PathBuf::from("no such.stl"), MeshOptions::default(), 0, Arc::new(|| {}));
        let angle = |degrees: f64| MeshOptions { feature_angle: Some(degrees), ..MeshOptions::default() };
        for degrees in [30.0, 31.0, 32.0] {
            import.set(angle(degrees), true);
        }
        // Let go.
        import.set(angle(32.0), false);
        import.set(angle(50.0), true);
        assert_eq!(import.taking().feature_angle, 50.0_f64.to_radians());
        let mut back = || {
            import.take_back(true);
            import.options.feature_angle
        };
        assert_eq!([back(), back(), back()], [Some(32.0), None, None]);
        import.take_back(false);
        assert_eq!(import.options.feature_angle, Some(32.0));
    }

    #[test]
    fn a_mesh_that_is_not_there_is_refused_with_its_name() {
        let mut import = Import::begin(PathBuf::from("no such.stl"), MeshOptions::default(), 0, Arc::new(|| {}));
        let begin = std::time::Instant::now();
        let fault = loop {
            if let News::Refused(fault) = import.look(true) {
                break fault;
            }
            assert!(begin.elapsed().as_secs() < 20);
            std::thread::sleep(std::time::Duration::from_millis(2));
        };
        assert!(fault.to_string().starts_with("no such.stl: There is no such file"), "{fault}");
    }
}
