//! The built-in cases: the files of `assets/cases`, carried inside the program.

use std::path::Path;

use super::case::Case;
use crate::core::fault::Fault;

macro_rules! cases {
    ($($name:literal),* $(,)?) => {
        /// Name and text of each, in the order in which they are listed.
        pub const CASES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../assets/cases/", $name, ".toml")))),*];
    };
}

cases![
    "example1",
    "square-linear",
    "polar-1",
    "polar-2",
    "uniform",
    "graded-plate",
    "crack",
    "repeated-line",
    "two-faces",
    "gear",
    "airfoil",
];

/// The built-in case of a name; `None` where there is none.
///
/// # Errors
/// None that a test has not seen: all of them parse.
pub fn named(name: &str) -> Option<Result<Case, Fault>> {
    let (name, text) = CASES.iter().find(|case| case.0 == name)?;
    Some(Case::parse(text, name, &format!("{name}.toml"), Path::new("")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_case_parses_and_has_a_title_and_notes() {
        for (name, _) in CASES {
            let case = named(name).unwrap().unwrap();
            assert_eq!(case.name, *name);
            assert!(case.title != *name && !case.notes.is_empty(), "{name}");
        }
    }

    #[test]
    fn every_file_of_the_folder_is_built_in() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/cases");
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                let name = path.file_stem().unwrap().to_str().unwrap();
                assert!(named(name).is_some(), "{name}");
            }
        }
    }
}
