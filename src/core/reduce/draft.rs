//! A case, its mesh and the edits of its run, as the reduction changes them; and their size.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use super::document::{Keys, Node};
use crate::core::case::{Case, DomainSource, MeshSource, ParameterKind, Parameters, Taking, VERSION};
use crate::core::fault::Fault;
use crate::core::formats::format::read_mesh_watched;
use crate::core::kernel::Fingerprint;
use crate::core::kernel::number::{counted, grouped};
use crate::core::progress::Watch;
use crate::core::run::{Edit, Run};
use crate::core::soup::{MeshFile, Weld};

/// A case that can be made smaller.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    pub(super) name: String,
    pub(super) keys: Keys,
    /// The mesh of the case, where it has one.
    pub(super) mesh: Option<Arc<MeshFile>>,
    /// The edits of the run, by step.
    pub(super) edits: Vec<Edit>,
}

impl Draft {
    /// The case of a run with the parameters and edits of the run; a mesh is read into memory.
    ///
    /// # Errors
    /// A mesh that cannot be read.
    pub fn of(run: &Run, watch: &mut dyn Watch) -> Result<Draft, Fault> {
        let case = &run.case;
        let text = if case.text.is_empty() { format!("version = {VERSION}") } else { case.text.clone() };
        let mut keys = Keys::parse(&text, &case.name)?;
        for key in ["title", "notes", "parameters", "split_odd", "sol"] {
            keys.remove(key);
        }
        if case.split_odd {
            keys.set("split_odd", Node::Bare("true".to_owned()));
        }
        // The text of an old run does not say that no points are merged.
        if let DomainSource::Mesh { taking: Taking { weld: Weld::Within(distance), .. }, .. } = case.domain {
            keys.set("weld", Node::Bare(format!("{distance:?}")));
        }
        let parameters = Keys(changed_parameters(&run.parameters));
        if !parameters.0.is_empty() {
            keys.set("parameters", Node::Table(parameters));
        }
        let mesh = match &case.domain {
            DomainSource::Mesh { source: MeshSource::Memory(mesh), .. } => Some(Arc::clone(mesh)),
            DomainSource::Mesh { source: MeshSource::File { path, sol }, .. } => {
                Some(Arc::new(read_mesh_watched(path, sol.as_deref(), watch)?))
            }
            _ => None,
        };
        Ok(Draft { name: case.name.clone(), keys, mesh, edits: run.edits().to_vec() })
    }

    /// The run of the draft, with its mesh in memory.
    ///
    /// # Errors
    /// A reduction that went too far: the text is no case any more.
    pub fn run(&self) -> Result<Run, Fault> {
        let mut keys = self.keys.clone();
        if self.mesh.is_some() {
            keys.set("mesh", Node::Text(self.name.clone()));
        }
        let mut case = Case::parse(&keys.written(), &self.name, &self.name, Path::new(""))?;
        if let (DomainSource::Mesh { source, .. }, Some(mesh)) = (&mut case.domain, &self.mesh) {
            *source = MeshSource::Memory(Arc::clone(mesh));
        }
        let mut run = Run::of(case);
        run.set_edits(self.edits.clone());
        Ok(run)
    }

    /// The mesh of the case, where it has one.
    pub fn mesh(&self) -> Option<&MeshFile> {
        self.mesh.as_deref()
    }

    /// The same draft with another mesh.
    #[must_use]
    pub fn with_mesh(&self, mesh: MeshFile) -> Draft {
        Draft { mesh: Some(Arc::new(mesh)), ..self.clone() }
    }

    /// The text of the case, with `title` and, for one with a mesh, the path of the file that has it.
    pub fn text(&self, title: &str, mesh: Option<&str>) -> String {
        let mut keys = Keys::default();
        keys.set("version", Node::Bare(VERSION.to_string()));
        keys.set("title", Node::Text(title.to_owned()));
        if let Some(mesh) = mesh {
            keys.set("mesh", Node::Text(mesh.to_owned()));
        }
        self.keys.0.iter().filter(|(key, _)| key != "version" && key != "mesh").for_each(|(key, node)| {
            keys.set(key, node.clone());
        });
        keys.written()
    }

    /// The edits of the run.
    pub fn edits(&self) -> &[Edit] {
        &self.edits
    }

    pub(super) fn fingerprint(&self) -> Fingerprint {
        let mut text = format!("{}{:?}", self.keys.written(), self.edits);
        if let Some(mesh) = &self.mesh {
            text += &format!("{:?}", [&mesh.points.len(), &mesh.lines.len()]);
            text += &format!("{:?}{:?}{:?}{:?}", mesh.points, mesh.triangles, mesh.quads, mesh.polygons);
        }
        Fingerprint::of(text.as_bytes())
    }

    /// How much there is of everything.
    pub fn size(&self) -> Size {
        let count = |key: &str| self.keys.list(key).len();
        let corners = |table: &Keys| table.list("points").len();
        let faces = || self.keys.tables("face");
        let elements = |mesh: &MeshFile| mesh.triangles.len() + mesh.quads.len() + mesh.polygons.len();
        let background = match self.keys.get("background") {
            Some(Node::Table(background)) => background.list("triangles").len() + background.list("quads").len(),
            _ => 0,
        };
        let parameters = match self.keys.get("parameters") {
            Some(Node::Table(parameters)) => parameters.0.len(),
            _ => 0,
        };
        Size([
            ("surface", count("surface")),
            ("face", count("face")),
            ("hole", faces().map(|face| face.list("holes").len()).sum()),
            ("line inside", faces().map(|face| face.list("cracks").len() + face.list("repeated").len()).sum()),
            ("curve", count("curve")),
            ("point of curves", self.keys.tables("curve").map(corners).sum()),
            ("element", self.mesh.as_deref().map_or(background, elements)),
            ("metric", count("metric")),
            ("parameter", parameters),
            ("option", super::OPTIONS.iter().filter(|key| self.keys.has(key)).count()),
            ("edit", self.edits.len()),
        ])
    }
}

/// The parameters that differ from the default.
pub(super) fn changed_parameters(parameters: &Parameters) -> Vec<(String, Node)> {
    let usual = Parameters::default();
    let changed = Parameters::KEYS.iter().filter(|key| parameters.text_of(key) != usual.text_of(key));
    let value = |key: &str| match (key, Parameters::kind_of(key)) {
        ("layered_loops", _) => Node::names(&parameters.layered_loops),
        ("faces", _) => Node::names(&parameters.faces),
        (_, Some(ParameterKind::Word(_))) => Node::Text(parameters.text_of(key).unwrap_or_default()),
        _ => Node::Bare(parameters.text_of(key).unwrap_or_default()),
    };
    changed.map(|key| ((*key).to_owned(), value(key))).collect()
}

/// How much there is of everything in a case: what, and how many.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Size([(&'static str, usize); 11]);

impl Size {
    /// What there was before or is now, with both counts.
    pub fn beside(&self, before: &Size) -> Vec<(&'static str, usize, usize)> {
        let both = before.0.iter().zip(&self.0).map(|(before, now)| (now.0, before.1, now.1));
        both.filter(|(_, before, now)| before + now > 0).collect()
    }

    /// The change of each count, a line each: `120 holes -> 1`.
    pub fn changes(&self, before: &Size) -> Vec<String> {
        let line = |(what, before, now): (&'static str, usize, usize)| {
            let all = plural(before, what);
            if before == now { format!("{all}, all kept") } else { format!("{all} -> {}", grouped(now as u64)) }
        };
        self.beside(before).into_iter().map(line).collect()
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<_> = self.0.iter().filter(|(_, n)| *n > 0).map(|(what, n)| plural(*n, what)).collect();
        f.write_str(&parts.join(", "))
    }
}

fn plural(n: usize, what: &str) -> String {
    match what.split_once(' ') {
        Some((first, rest)) => format!("{} {rest}", counted(n as u64, first)),
        None => counted(n as u64, what),
    }
}
