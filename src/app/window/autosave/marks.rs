//! What a person has set in the window beside the run: breakpoints, watchpoints and the step that is shown, kept beside
//! the autosaved run.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::app::window::state::{Breakpoint, Watchpoint};
use crate::core::fault::Fault;
use crate::core::formats::save::{load_text, save};
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::Watched;

/// Breakpoints, watchpoints and the step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marks {
    pub step: u64,
    pub breakpoints: Vec<Breakpoint>,
    pub watches: Vec<Watchpoint>,
}

/// The same in a file.
#[derive(Default, Serialize, Deserialize)]
struct Written {
    step: u64,
    breakpoints: Vec<(String, bool)>,
    watches: Vec<(Thing, bool)>,
}

/// Something that is watched, by its numbers.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Thing {
    Node(u32),
    Edge(u32, u32),
    Element(u32),
}

impl Marks {
    /// Reads marks; none where there is no file or where it has another form: the run itself does not depend on it.
    pub(super) fn read(path: &Path) -> Marks {
        let text = load_text(path).unwrap_or_default();
        let Written { step, breakpoints, watches } = serde_json::from_str(&text).unwrap_or_default();
        let watched = |thing| match thing {
            Thing::Node(n) => Watched::Node(NodeId(n)),
            Thing::Edge(a, b) => Watched::Edge(NodeId(a), NodeId(b)),
            Thing::Element(e) => Watched::Element(ElementId(e)),
        };
        Marks {
            step,
            breakpoints: breakpoints.into_iter().map(|(condition, is_on)| Breakpoint { condition, is_on }).collect(),
            watches: watches.into_iter().map(|(thing, is_on)| Watchpoint { watched: watched(thing), is_on }).collect(),
        }
    }

    /// Writes them, atomically.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write(&self, path: &Path) -> Result<(), Fault> {
        let thing = |watched| match watched {
            Watched::Node(n) => Thing::Node(n.0),
            Watched::Edge(a, b) => Thing::Edge(a.0, b.0),
            Watched::Element(e) => Thing::Element(e.0),
        };
        let written = Written {
            step: self.step,
            breakpoints: self.breakpoints.iter().map(|b| (b.condition.clone(), b.is_on)).collect(),
            watches: self.watches.iter().map(|watch| (thing(watch.watched), watch.is_on)).collect(),
        };
        let text = serde_json::to_string(&written).map_err(|error| Fault::new(error.to_string()))?;
        save(path, |out| out.write_all(text.as_bytes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_read_as_they_were_written_and_a_bad_file_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("0.json");
        let watch = |watched| Watchpoint { watched, is_on: false };
        let marks = Marks {
            step: 90,
            breakpoints: vec![Breakpoint { condition: "nq == 3".to_owned(), is_on: true }],
            watches: [Watched::Node(NodeId(1)), Watched::Edge(NodeId(2), NodeId(3)), Watched::Element(ElementId(4))]
                .map(watch)
                .to_vec(),
        };
        marks.write(&path).unwrap();
        assert_eq!(Marks::read(&path), marks);
        std::fs::write(&path, "{").unwrap();
        assert_eq!(Marks::read(&path), Marks::default());
        assert_eq!(Marks::read(&folder.path().join("none")), Marks::default());
    }
}
