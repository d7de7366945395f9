//! The files of a reduced case: the case or run itself with a head of comments, and its mesh beside it.

use std::path::{Path, PathBuf};

use super::draft::{Draft, Size};
use super::question::{Finding, Question};
use crate::core::case::{Case, DomainSource, MeshSource};
use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::format::{read_bytes, write_mesh, write_to};
use crate::core::formats::{Format, WriteOptions, save};
use crate::core::record::run_file;
use crate::core::run::Run;

/// Formats for meshes, the ones that are easiest to read first; the first that keeps a mesh as it is gets it.
const FORMATS: [Format; 4] = [Format::Obj, Format::Medit, Format::Msh, Format::Vtu];

/// What a reduced case is written with.
#[derive(Clone, Debug)]
pub struct Written {
    path: PathBuf,
    format: Option<Format>,
    /// The name of the case that was reduced.
    from: String,
    question: String,
    before: Size,
}

impl Written {
    /// Files for the reductions of a draft: `path`, which ends in `.toml`, and its mesh beside it.
    ///
    /// # Errors
    /// Another extension.
    pub fn new(path: PathBuf, original: &Draft, question: &Question) -> Result<Written, Fault> {
        if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
            return Err(Fault::new("The smallest case is written as a case file")
                .at(path.display().to_string())
                .remedy("Use a name that ends in .toml"));
        }
        let (from, question) = (original.name.clone(), question.text().to_owned());
        Ok(Written { path, format: None, from, question, before: original.size() })
    }

    /// The case file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The same files in another folder.
    #[must_use]
    pub fn beside(&self, folder: &Path) -> Written {
        Written { path: folder.join(self.path.file_name().unwrap_or_default()), ..self.clone() }
    }

    /// The draft with its mesh as a file of some format has it, for the formats that can have it.
    pub fn drafts(&self, draft: &Draft) -> Vec<(Option<Format>, Draft)> {
        let Some(mesh) = draft.mesh() else { return vec![(None, draft.clone())] };
        let through = |format: Format| {
            let mut bytes = Vec::new();
            write_to(&mut bytes, format, mesh, WriteOptions::default()).ok()?;
            let mut read = read_bytes("mesh", &bytes, format).ok()?;
            if format == Format::Medit {
                read.metric.clone_from(&mesh.metric);
            }
            Some((Some(format), draft.with_mesh(read)))
        };
        let keeps = |format: &Format| mesh.metric.is_none() || *format != Format::Obj;
        FORMATS.into_iter().filter(keeps).filter_map(through).collect()
    }

    /// Chooses the format of the mesh.
    pub fn choose(&mut self, format: Option<Format>) {
        self.format = format;
    }

    /// Writes a draft and what it shows; `how` says how the reduction ended.
    ///
    /// # Errors
    /// As [`save::save`].
    pub fn write(&self, draft: &Draft, finding: &Finding, how: &str) -> Result<(), Fault> {
        self.write_below(&self.head(draft, finding, how), draft)
    }

    /// Writes a draft of which nothing is known yet, for another process.
    ///
    /// # Errors
    /// As [`save::save`].
    pub fn write_try(&self, draft: &Draft) -> Result<(), Fault> {
        self.write_below("", draft)
    }

    fn write_below(&self, head: &str, draft: &Draft) -> Result<(), Fault> {
        let mesh = self.format.map(|format| self.path.with_extension(format.extension()));
        if let (Some(path), Some(format), Some(mesh)) = (&mesh, self.format, draft.mesh()) {
            write_mesh(path, format, mesh, WriteOptions::default())?;
        }
        let name = mesh.as_ref().map(|path| name_of(path));
        let title = format!("Reduced from {}: {}", self.from, self.question);
        let case = draft.text(&title, name.as_deref());
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let text = if draft.edits().is_empty() {
            case
        } else {
            let mut case = Case::parse(&case, &name_of(&self.path.with_extension("")), "", folder)?;
            if let (DomainSource::Mesh { source, .. }, Some(path)) = (&mut case.domain, mesh) {
                *source = MeshSource::File { path, sol: None };
            }
            let mut run = Run::of(case);
            run.set_edits(draft.edits().to_vec());
            run_file::written_in(&run, folder)?
        };
        save::save(&self.path, |out| out.write_all(format!("{head}{text}").as_bytes()))
    }

    fn head(&self, draft: &Draft, finding: &Finding, how: &str) -> String {
        let mut lines = vec![
            format!("{} shows: {}", self.from, self.question),
            format!("This smaller case shows it too. {}.", finding.sentence),
            String::new(),
        ];
        let (name, picture) = (name_of(&self.path), name_of(&self.path.with_extension("svg")));
        lines.push(match finding.step {
            Some(step) => format!("See it: quadfront open {name}, and go to step {step} (Ctrl+G); or"),
            None => format!("See it: quadfront open {name}; or"),
        });
        lines.push(match finding.step {
            Some(step) => format!("        quadfront render {name} --at step={step} -o {picture}"),
            None => format!("        quadfront convert {name}"),
        });
        lines.push(String::new());
        lines.extend(draft.size().changes(&self.before).into_iter().map(|line| format!("  {line}")));
        lines.push(String::new());
        lines.push(how.to_owned());
        let line = |line: &String| format!("# {}", line.replace(char::is_control, " ")).trim_end().to_owned() + "\n";
        lines.iter().map(line).collect::<String>() + "\n"
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The fault of a case that does not show what is asked for.
pub fn does_not_show(name: &str, question: &Question, instead: Option<String>) -> Fault {
    let instead = instead.map_or_else(String::new, |instead| format!(". {instead}"));
    Fault::new(format!("The case does not show it: {}{instead}", question.text()))
        .of_kind(FaultKind::Other)
        .at(name)
        .remedy("Ask for what it shows")
}
