//! Runs that need no file but their own, as links carry them.

use std::path::Path;

use super::inputs::InputFiles;
use super::{parse, text};
use crate::core::case::DomainSource;
use crate::core::case::table::{Source, Table};
use crate::core::fault::{Fault, FaultKind};
use crate::core::run::Run;

/// What to do where a run needs another file.
const TOGETHER: &str = "Save the run as a file, and send it with its mesh";

/// The text of a run that needs no other file, without its camera and the states of a figure.
///
/// # Errors
/// A run of a mesh, which is a file of its own.
pub fn alone(run: &Run) -> Result<String, Fault> {
    if matches!(run.case.domain, DomainSource::Mesh { .. }) {
        let fault = Fault::new("This run starts from a mesh, which is a file of its own");
        return Err(fault.of_kind(FaultKind::Mesh).remedy(TOGETHER));
    }
    let mut plain = run.clone();
    (plain.camera, plain.shown) = (None, None);
    Ok(text(&plain, &InputFiles::default(), Path::new("")))
}

/// As [`parse`], for a run that may come from anywhere: it reads no other file.
///
/// # Errors
/// Those of [`parse`], and a run that names a file.
pub fn parse_alone(text: &str, file: &str) -> Result<Run, Fault> {
    let source = Source::new(file, text);
    let document = source.parse().map_err(|fault| fault.of_kind(FaultKind::Syntax))?;
    let case = Table::document(&source, &document).get("case").and_then(|value| value.table().ok());
    let named = case.and_then(|case| ["mesh", "sol"].into_iter().find_map(|key| case.get(key)));
    match named {
        Some(value) => {
            let fault = value.fault(format!("The run names a file ({})", value.key()));
            Err(fault.of_kind(FaultKind::Syntax).remedy(TOGETHER))
        }
        None => parse(text, file, Path::new("")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::{Case, built_in};
    use crate::core::run::Camera;

    #[test]
    fn a_run_without_files_survives_and_one_with_files_is_refused_without_looking_for_them() {
        let mut run = Run::of(built_in::named("gear").unwrap().unwrap());
        run.parameters.set("c", "1.8").unwrap();
        run.camera = Some(Camera { target: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0], height: 1.0 });
        let back = parse_alone(&alone(&run).unwrap(), "link").unwrap();
        assert_eq!((back.camera, &back.parameters, &back.case.text), (None, &run.parameters, &run.case.text));

        let of_mesh = Run::of(Case::of_mesh("missing.msh".into(), None));
        assert!(alone(&of_mesh).unwrap_err().what.contains("mesh"));
        let print = "0".repeat(32);
        for key in ["mesh", "sol"] {
            let text = format!("run = 1\n[case]\nname = \"a\"\n{key} = {{ path = \"/x\", fingerprint = \"{print}\" }}");
            let fault = parse_alone(&text, "link").unwrap_err();
            assert!(fault.what.contains("names a file") && fault.place.contains("line 4"), "{fault}");
        }
        let text = "run = 1\n[case]\nname = \"a\"\ntext = \"version = 1\\nmesh = '/x.msh'\"\n";
        assert!(parse_alone(text, "link").unwrap_err().what.contains("mesh of the case is missing"));
    }
}
