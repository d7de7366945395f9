//! What a run is made of besides its parameters.

use std::path::{Path, PathBuf};

use super::{Link, Links, text};
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::kernel::Fingerprint;
use crate::core::run::Run;

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
    let Links { mesh, sol } = Links::of(run)?;
    // A file is the same wherever it is.
    let placeless = |link: Option<Link>| link.map(|link| Link { path: PathBuf::new(), ..link });
    let links = Links { mesh: placeless(mesh), sol: placeless(sol) };
    Ok(Fingerprint::of(text(&plain, &links, Path::new("")).as_bytes()))
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
