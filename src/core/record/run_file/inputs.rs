//! What a run is made of besides its parameters.

use std::path::{Path, PathBuf};

use super::text;
use crate::core::case::{DomainSource, MeshSource, Parameters};
use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::metric_beside;
use crate::core::formats::save::load;
use crate::core::kernel::Fingerprint;
use crate::core::run::Run;

/// An input file of a run, outside the run file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct InputFile {
    pub path: PathBuf,
    pub fingerprint: Fingerprint,
}

/// The mesh of a run and its metric, if it has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct InputFiles {
    pub mesh: Option<InputFile>,
    pub sol: Option<InputFile>,
}

impl InputFiles {
    pub fn of(run: &Run) -> Result<InputFiles, Fault> {
        let (path, sol) = match &run.case.domain {
            DomainSource::Mesh { source: MeshSource::File { path, sol }, .. } => (path, sol),
            DomainSource::Mesh { source: MeshSource::Memory(_), .. } => {
                let fault = Fault::new("The run starts from a mesh in memory, which a run file cannot name");
                return Err(fault.of_kind(FaultKind::Mesh).remedy("Write the mesh to a file and begin from that"));
            }
            _ => return Ok(InputFiles::default()),
        };
        let input = |path: &Path| -> Result<InputFile, Fault> {
            let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
            Ok(InputFile { fingerprint: Fingerprint::of(&load(path)?), path: absolute })
        };
        let sol = sol.clone().or_else(|| metric_beside(path));
        Ok(InputFiles { mesh: Some(input(path)?), sol: sol.map(|sol| input(&sol)).transpose()? })
    }
}

/// The fingerprint of everything but the parameters that determines the states of a run: the version of the program,
/// the text of the case, the bytes of its mesh and metric files, the edits. Where these and the parameters are the
/// same, the results are.
///
/// # Errors
/// A mesh of the run that cannot be read, or is in memory only.
pub fn inputs(run: &Run) -> Result<Fingerprint, Fault> {
    let mut plain = Run::of(run.case.clone());
    plain.case.name.clear();
    plain.parameters = Parameters::default();
    plain.set_edits(run.edits().to_vec());
    let InputFiles { mesh, sol } = InputFiles::of(run)?;
    // A file is the same wherever it is.
    let placeless = |input: Option<InputFile>| input.map(|input| InputFile { path: PathBuf::new(), ..input });
    let files = InputFiles { mesh: placeless(mesh), sol: placeless(sol) };
    Ok(Fingerprint::of(text(&plain, &files, Path::new("")).as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::{Case, built_in};
    use crate::core::run::{Bookmark, Edit, EditKind};

    #[test]
    fn inputs_are_case_mesh_and_edits_and_neither_parameters_nor_names() {
        let case = || built_in::named("example1").unwrap().unwrap();
        let same = inputs(&Run::of(case())).unwrap();
        let mut run = Run::of(case());
        run.case.name = "other".to_owned();
        run.parameters.set("c", "1.5").unwrap();
        run.bookmarks.push(Bookmark { step: 3, note: "here".to_owned() });
        assert_eq!(inputs(&run).unwrap(), same);
        run.set_edits(vec![Edit { step: 9, kind: EditKind::parameter("c", "1.5").unwrap() }]);
        assert_ne!(inputs(&run).unwrap(), same);
        run = Run::of(case());
        run.case.text.push('\n');
        assert_ne!(inputs(&run).unwrap(), same);

        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str, x: u32| {
            let path = folder.path().join(name);
            std::fs::write(&path, format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\nf 1 2 3\n")).unwrap();
            inputs(&Run::of(Case::of_mesh(path, None))).unwrap()
        };
        let one = of("a.obj", 1);
        assert_eq!(of("b.obj", 1), one, "another path with the same bytes");
        assert_ne!(of("a.obj", 2), one, "the same path with other bytes");
    }
}
