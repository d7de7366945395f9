//! Settings that outlast the window: where its panels are, what it draws and sweeps, and how large it is, in a small
//! file in the user's state folder. A file that cannot be read is reported and ignored.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::layout::{Layout, TIMELINE_HEIGHTS};
use super::presentation::PresentationForm;
use super::state::{Document, SurfaceStyle, SurfaceView, Workspace};
use super::study::Learned;
use super::sweep::SweepForm;
use super::view_layer::ViewLayer;
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::core::record::report::figures::Figure;
use crate::render::look::HiddenLines;
use crate::render::scene::{ColourBy, Layers};

/// The version of the file.
const VERSION: u32 = 1;

/// The settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    version: u32,
    /// Whether the window is dark.
    pub dark: bool,
    /// Layers by their digits.
    layers: [bool; 9],
    colour_by: String,
    /// Quadrilaterals a second while playing.
    speed: f32,
    /// Height of the timeline with its buttons, in points.
    bottom: f32,
    /// Where meshes on surfaces are shown, how hidden lines are drawn, whether elements are curved.
    #[serde(default)]
    place: SurfaceView,
    #[serde(default)]
    hidden: HiddenLines,
    #[serde(default)]
    curved: bool,
    /// Whether presentations have a spotlight, and a camera that follows.
    #[serde(default = "presented")]
    presented: [bool; 2],
    /// Size of the window in points.
    #[serde(default)]
    pub window: Option<[f32; 2]>,
    /// How the user has arranged the docks, by the room for columns.
    pub docks: Value,
    /// What is swept.
    #[serde(default)]
    sweep: Option<KeptSweep>,
    /// What was learnt.
    #[serde(default, skip_serializing_if = "Learned::is_nothing")]
    learned: Learned,
}

/// How presentations are shown where older settings do not say.
fn presented() -> [bool; 2] {
    let PresentationForm { spotlight, follows } = PresentationForm::default();
    [spotlight, follows]
}

/// What is swept, by names. Those that another quadfront does not have are left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct KeptSweep {
    axes: [(Option<String>, String); 2],
    figure: String,
}

impl KeptSweep {
    fn of(form: &SweepForm) -> KeptSweep {
        let axes = form.axes.clone().map(|(key, values)| (key.map(str::to_owned), values));
        KeptSweep { axes, figure: form.figure.to_owned() }
    }

    /// The form; an axis whose key is unknown is the usual one.
    fn form(&self) -> SweepForm {
        let mut form = SweepForm::default();
        for (k, (own, (key, values))) in form.axes.iter_mut().zip(&self.axes).enumerate() {
            let known = key.as_ref().and_then(|key| Parameters::KEYS.into_iter().find(|known| known == key));
            // Only the second axis may be without a key.
            if known.is_some() || key.is_none() && k == 1 {
                *own = (known, values.clone());
            }
        }
        form.figure = Figure::named(&self.figure).map_or(form.figure, |figure| figure.name);
        form
    }
}

impl Settings {
    /// The settings of a window of this size in points.
    pub fn of(workspace: &Workspace, layout: &Layout, dark: bool, window: Option<[f32; 2]>) -> Settings {
        let SurfaceStyle { view, hidden, curved } = workspace.surfaces;
        Settings {
            version: VERSION,
            dark,
            layers: ViewLayer::ALL.map(|layer| layer.is_on(workspace.document.layers)),
            colour_by: workspace.document.colour_by.name().to_owned(),
            speed: workspace.speed,
            bottom: layout.timeline_height,
            place: view,
            hidden,
            curved,
            presented: [workspace.presentation.spotlight, workspace.presentation.follows],
            window,
            docks: layout.arranged(),
            sweep: (workspace.sweep != SweepForm::default()).then(|| KeptSweep::of(&workspace.sweep)),
            learned: workspace.learned.clone(),
        }
    }

    /// A workspace as it was left.
    pub fn workspace(&self) -> Workspace {
        let mut workspace = Workspace::default();
        let Document { layers, colour_by, .. } = &mut workspace.document;
        *layers = Layers::default();
        for (layer, on) in ViewLayer::ALL.into_iter().zip(self.layers) {
            *layer.switch(layers) = on;
        }
        *colour_by = ColourBy::ALL.into_iter().find(|by| by.name() == self.colour_by).unwrap_or(*colour_by);
        workspace.surfaces = SurfaceStyle { view: self.place, hidden: self.hidden, curved: self.curved };
        if self.speed.is_finite() && (0.1..=1000.0).contains(&self.speed) {
            workspace.speed = self.speed;
        }
        let [spotlight, follows] = self.presented;
        workspace.presentation = PresentationForm { spotlight, follows };
        workspace.sweep = self.sweep.as_ref().map_or_else(SweepForm::default, KeptSweep::form);
        workspace.learned = self.learned.clone();
        workspace
    }

    /// The docks as they were left.
    pub fn layout(&self) -> Layout {
        let mut layout = Layout::default();
        layout.arrange(Some(&self.docks));
        if self.bottom.is_finite() {
            layout.timeline_height = self.bottom.clamp(TIMELINE_HEIGHTS[0], TIMELINE_HEIGHTS[1]);
        }
        layout
    }

    /// Reads the settings; none if there is no file yet.
    ///
    /// # Errors
    /// If there is a file and it cannot be read.
    pub fn read(path: &Path) -> Result<Option<Settings>, Fault> {
        let fault = |what: String| {
            Fault::new(format!("The settings of the window cannot be read: {what}"))
                .at(path.display().to_string())
                .remedy("They are ignored, and written again when the window changes")
        };
        let text = match save::load_text(path) {
            Ok(text) => text,
            Err(_) if !save::exists(path) => return Ok(None),
            Err(error) => return Err(fault(error.what)),
        };
        let settings: Settings = serde_json::from_str(&text).map_err(|error| fault(error.to_string()))?;
        if settings.version != VERSION {
            return Err(fault(format!("they have version {}, and this quadfront reads {VERSION}", settings.version)));
        }
        Ok(Some(settings))
    }

    /// Writes the settings.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, path: &Path) -> Result<(), Fault> {
        let text = serde_json::to_string_pretty(self).map_err(|error| Fault::new(error.to_string()))?;
        if let Some(folder) = path.parent() {
            save::make_folder(folder).map_err(|error| {
                Fault::new(format!("The folder cannot be created: {error}")).at(folder.display().to_string())
            })?;
        }
        save::save(path, |out| out.write_all(text.as_bytes()))
    }
}

/// The path of the file; none if the user has no home.
pub fn path() -> Option<PathBuf> {
    state_folder().map(|own| own.join("window.json"))
}

/// The user's folder for state, in the storage of the browser; none if that keeps nothing.
#[cfg(target_arch = "wasm32")]
pub fn state_folder() -> Option<PathBuf> {
    super::web::page::stored().map(|_| PathBuf::from("state"))
}

/// The user's folder for state: in `XDG_STATE_HOME` or this system's equivalent; none if the user has no home.
#[cfg(not(target_arch = "wasm32"))]
pub fn state_folder() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = |rest: &str| folder("HOME").map(|home| home.join(rest));
    let own = if cfg!(windows) {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        home("Library/Application Support")
    } else {
        folder("XDG_STATE_HOME").or_else(|| home(".local/state"))
    };
    own.map(|own| own.join("quadfront"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_swept_by_names_that_are_gone_is_as_usual() {
        let usual = SweepForm::default();
        let axis = |key: &str| (Some(key.to_owned()), "7".to_owned());
        let kept = |axes, figure: &str| KeptSweep { axes, figure: figure.to_owned() }.form();
        let form = kept([axis("no_such_key"), axis("c")], "quality.mean");
        assert_eq!((&form.axes[0], &form.axes[1]), (&usual.axes[0], &(Some("c"), "7".to_owned())));
        assert_eq!(form.figure, "quality.mean");
        assert_eq!(kept([axis("c"), axis("theta_rect")], "no such figure").figure, usual.figure);
        // The first axis always has a key.
        assert_eq!(kept([(None, "7".to_owned()), axis("c")], "quality.mean").axes[0], usual.axes[0]);
    }

    #[test]
    fn what_is_kept_is_read_as_it_was_written_and_nonsense_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("window.json");
        assert_eq!(Settings::read(&path).unwrap(), None);
        let (mut workspace, mut layout) = (Workspace::default(), Layout::default());
        workspace.document.layers.ellipses = true;
        workspace.document.colour_by = ColourBy::Level;
        (workspace.speed, layout.timeline_height) = (30.0, 300.0);
        workspace.surfaces = SurfaceStyle { view: SurfaceView::Both, hidden: HiddenLines::Faint, curved: true };
        workspace.sweep =
            SweepForm { axes: [(Some("c"), "1.5,2".to_owned()), (None, "1:2:.5".to_owned())], figure: "min_angle" };
        workspace.presentation.spotlight = false;
        let settings = Settings::of(&workspace, &layout, false, Some([1280.0, 800.0]));
        settings.write(&path).unwrap();
        let read = Settings::read(&path).unwrap().unwrap();
        assert_eq!(read, settings);
        let other = read.workspace();
        assert_eq!(other.document, workspace.document);
        assert_eq!((other.speed, other.surfaces, other.sweep), (30.0, workspace.surfaces, workspace.sweep));
        assert_eq!(other.presentation, PresentationForm { spotlight: false, follows: true });
        assert_eq!(read.layout().timeline_height, 300.0);
        // Older files have no settings for space.
        let text = std::fs::read_to_string(&path).unwrap();
        let old: String =
            text.lines().filter(|line| !line.contains("\"hidden\"")).map(|line| format!("{line}\n")).collect();
        std::fs::write(&path, &old).unwrap();
        assert!(old.len() < text.len() && Settings::read(&path).unwrap().is_some());
        std::fs::write(&path, &text).unwrap();
        for bad in
            ["", "{}", "[1]", "{\"version\": 1", &std::fs::read_to_string(&path).unwrap().replace(": 1,", ": 99,")]
        {
            std::fs::write(&path, bad).unwrap();
            let told = Settings::read(&path).unwrap_err().to_string();
            assert!(told.contains("window.json") && told.contains("ignored"), "{told}");
        }
    }
}
