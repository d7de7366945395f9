//! How the user wants a mesh to be imported, on the command line or in the window: the settings that differ from the
//! default.

use std::path::{Path, PathBuf};

use super::{Case, DomainSource, MeshSource, MeshUse, VERSION};
use crate::core::fault::Fault;
use crate::core::soup::{Ignored, Weld};
use crate::core::step::StepOptions;

/// With [`ImportOptions::curvature`], the smallest size is [`ImportOptions::mesh_size`] divided by this.
const FINEST: f64 = 100.0;

/// Settings for the import of a mesh; what is absent keeps its default ([`Taking`](super::Taking)).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// What the mesh is used for.
    pub used: Option<MeshUse>,
    /// Whether to divide one side of each border with an odd number of sides, instead of refusing the mesh.
    pub split_odd: bool,
    /// Element size in units of the scaled mesh; with `curvature` that of flat regions.
    pub mesh_size: Option<f64>,
    /// Size by curvature: the distance between chord and arc, divided by the radius. It needs `mesh_size`.
    pub curvature: Option<f64>,
    /// Folds beyond this angle are edges to keep (degrees).
    pub feature_angle: Option<f64>,
    /// Limit of the distortion of shapes where the mesh is flattened.
    pub chart_stretch: Option<f64>,
    /// Factor on all coordinates.
    pub scale: Option<f64>,
    /// Limit of the distance between a chord and its border, divided by the radius.
    pub chord: Option<f64>,
    /// The groups of the mesh that are ignored.
    pub ignore_groups: Ignored,
    /// Which points of the mesh are merged.
    pub weld: Weld,
    /// How a CAD file is read.
    pub step: StepOptions,
}

impl ImportOptions {
    /// The settings as lines of a case, each with its key.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = Vec::new();
        let mut line = |key, value: Option<String>| lines.extend(value.map(|value| (key, format!("{key} = {value}"))));
        // `{:?}` writes the decimal point that some keys require in TOML.
        let number = |value: Option<f64>| value.map(|value| format!("{value:?}"));
        line("use", self.used.map(|used| format!("\"{}\"", used.name())));
        line("split_odd", self.split_odd.then(|| "true".to_owned()));
        line("feature_angle", number(self.feature_angle));
        line("chart_stretch", number(self.chart_stretch));
        line("scale", number(self.scale));
        line("chord", number(self.chord));
        line(
            "ignore_groups",
            match &self.ignore_groups {
                Ignored::Nothing => None,
                Ignored::All => Some("true".to_owned()),
                Ignored::Named(names) => {
                    let quoted = names.iter().map(|name| toml::Value::String(name.clone()).to_string());
                    Some(format!("[{}]", quoted.collect::<Vec<_>>().join(", ")))
                }
            },
        );
        if let Weld::Within(distance) = self.weld {
            line("weld", number(Some(distance)));
        }
        if let Some(h) = self.mesh_size {
            let metric = match self.curvature {
                None => format!("[[metric]]\nkind = \"uniform\"\nh = {h:?}"),
                Some(chord) => {
                    let least = h / FINEST;
                    format!("[[metric]]\nkind = \"curvature\"\nchord = {chord:?}\nleast = {least:?}\nfar = {h:?}")
                }
            };
            lines.push(("[[metric]]", metric));
        }
        lines
    }

    /// The case of a mesh file with these settings. Where there are any, the case has a text with the same settings, so
    /// that reports, run files and figures contain them.
    ///
    /// # Errors
    /// Settings that no case can have.
    pub fn case(&self, path: PathBuf, sol: Option<PathBuf>) -> Result<Case, Fault> {
        let plain = Case::of_mesh(path.clone(), sol.clone());
        let lines: Vec<String> = self.lines().into_iter().map(|(_, line)| line).collect();
        if lines.is_empty() {
            return Ok(plain);
        }
        let quoted = |text: String| toml::Value::String(text).to_string();
        let metric =
            sol.as_deref().map_or_else(String::new, |sol| format!("sol = {}\n", quoted(sol.display().to_string())));
        let text = format!(
            "version = {VERSION}\ntitle = {}\nmesh = {}\n{metric}{}\n",
            quoted(plain.title),
            quoted(path.display().to_string()),
            lines.join("\n")
        );
        let mut case = Case::parse(&text, &plain.name, "the options", Path::new(""))?;
        // The text cannot express every path: keep the paths themselves.
        if let DomainSource::Mesh { source, .. } = &mut case.domain {
            *source = MeshSource::File { path, sol };
        }
        Ok(case)
    }
}
