//! What is kept of the window from one start to the next: where its panels are, what it draws, and how large it is. A
//! small file in the user's own folder for such things; one that cannot be read is told and left out.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::apply::layer;
use super::state::{Place, State};
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::render::look::HiddenLines;
use crate::render::scene::{ColourBy, Layers};

/// The version of the file.
const VERSION: u32 = 1;
/// Heights that the timeline can have.
pub const BOTTOM: [f32; 2] = [120.0, 420.0];

/// What is kept.
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
    /// Where meshes on surfaces are shown, how covered lines are drawn, whether elements are curved.
    #[serde(default)]
    place: Place,
    #[serde(default)]
    hidden: HiddenLines,
    #[serde(default)]
    curved: bool,
    /// Size of the window in points.
    #[serde(default)]
    pub window: Option<[f32; 2]>,
    /// The docks that a person has arranged, by the room that there was.
    pub docks: Value,
}

impl Settings {
    /// Those of a window.
    pub fn of(state: &State, dark: bool, window: Option<[f32; 2]>, docks: Value) -> Settings {
        let mut layers = state.kept.layers;
        Settings {
            version: VERSION,
            dark,
            layers: std::array::from_fn(|k| *layer(&mut layers, k)),
            colour_by: state.kept.colour_by.name().to_owned(),
            speed: state.speed,
            bottom: state.bottom.round(),
            place: state.space.place,
            hidden: state.space.hidden,
            curved: state.space.curved,
            window,
            docks,
        }
    }

    /// Gives them to a window.
    pub fn give(&self, state: &mut State) {
        let mut layers = Layers::default();
        for (k, on) in self.layers.into_iter().enumerate() {
            *layer(&mut layers, k) = on;
        }
        state.kept.layers = layers;
        (state.space.place, state.space.hidden, state.space.curved) = (self.place, self.hidden, self.curved);
        state.kept.colour_by =
            ColourBy::ALL.into_iter().find(|by| by.name() == self.colour_by).unwrap_or(state.kept.colour_by);
        if self.speed.is_finite() && (0.1..=1000.0).contains(&self.speed) {
            state.speed = self.speed;
        }
        if self.bottom.is_finite() {
            state.bottom = self.bottom.clamp(BOTTOM[0], BOTTOM[1]);
        }
    }

    /// Reads them; none where there are none yet.
    ///
    /// # Errors
    /// A file that is there and cannot be read.
    pub fn read(path: &Path) -> Result<Option<Settings>, Fault> {
        let fault = |what: String| {
            Fault::new(format!("What was kept of the window cannot be read: {what}"))
                .at(path.display().to_string())
                .remedy("It is left out, and written anew when the window changes")
        };
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(fault(error.to_string())),
        };
        let settings: Settings = serde_json::from_str(&text).map_err(|error| fault(error.to_string()))?;
        if settings.version != VERSION {
            return Err(fault(format!("it is of version {}, and this quadfront knows {VERSION}", settings.version)));
        }
        Ok(Some(settings))
    }

    /// Writes them.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, path: &Path) -> Result<(), Fault> {
        let text = serde_json::to_string_pretty(self).map_err(|error| Fault::new(error.to_string()))?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| {
                Fault::new(format!("The folder cannot be made: {error}")).at(folder.display().to_string())
            })?;
        }
        save::save(path, |out| out.write_all(text.as_bytes()))
    }
}

/// Where they are kept: `XDG_STATE_HOME`, or what stands for it on this system; none where the user has no home.
pub fn path() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = |rest: &str| folder("HOME").map(|home| home.join(rest));
    let own = if cfg!(windows) {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        home("Library/Application Support")
    } else {
        folder("XDG_STATE_HOME").or_else(|| home(".local/state"))
    };
    own.map(|own| own.join("quadfront").join("window.json"))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn what_is_kept_is_read_as_it_was_written_and_nonsense_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("window.json");
        assert_eq!(Settings::read(&path).unwrap(), None);
        let mut state = State::new(Arc::new(|| {}));
        state.kept.layers.ellipses = true;
        state.kept.colour_by = ColourBy::Level;
        (state.speed, state.bottom) = (30.0, 300.0);
        (state.space.place, state.space.hidden, state.space.curved) = (Place::Both, HiddenLines::Faint, true);
        let settings = Settings::of(&state, false, Some([1280.0, 800.0]), serde_json::json!({}));
        settings.write(&path).unwrap();
        let read = Settings::read(&path).unwrap().unwrap();
        assert_eq!(read, settings);
        let mut other = State::new(Arc::new(|| {}));
        read.give(&mut other);
        assert_eq!((other.kept.layers, other.kept.colour_by), (state.kept.layers, ColourBy::Level));
        assert_eq!((other.speed, other.bottom), (30.0, 300.0));
        let space = other.space;
        assert_eq!((space.place, space.hidden, space.curved), (Place::Both, HiddenLines::Faint, true));
        // Files of before know nothing of space.
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
            assert!(told.contains("window.json") && told.contains("left out"), "{told}");
        }
    }
}
