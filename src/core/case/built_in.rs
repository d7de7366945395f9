//! The built-in cases: the files of `assets/cases`, compiled into the program, and the figures of the paper as small
//! meshes that show one operation each.

use std::path::Path;

use super::Case;
use crate::core::fault::Fault;

macro_rules! cases {
    ($list:ident, $folder:literal, $($name:literal),* $(,)?) => {
        /// Name and text of each, in the order of the list.
        pub const $list: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../assets/cases/", $folder, $name, ".toml")))),*];
    };
}

cases![
    CASES,
    "",
    "example1",
    "example2",
    "example2-half",
    "example3",
    "example4",
    "example5",
    "example6",
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
    "sphere",
    "cone",
    "torus",
    "saddle",
    "wing",
    "branching",
];

cases![
    FIGURES,
    "figures/",
    "figure-3",
    "figure-4",
    "figure-5",
    "figure-6",
    "figure-7",
    "figure-8",
    "figure-11",
    "figure-12",
    "figure-13",
    "figure-14",
    "figure-16",
    "figure-17",
    "figure-18",
    "figure-19",
    "top-smoothing",
    "transition-seam",
];

/// Names and texts of all cases, figures last.
pub fn all() -> impl Iterator<Item = (&'static str, &'static str)> {
    CASES.iter().chain(FIGURES).copied()
}

/// The title of a built-in case; none where there is no such case.
pub fn title(name: &str) -> Option<&'static str> {
    let (_, text) = all().find(|case| case.0 == name)?;
    text.lines().find_map(|line| line.strip_prefix("title = \"")?.split('"').next())
}

/// The built-in case or figure of a name, if any.
///
/// # Errors
/// None in practice: a test parses all of them.
pub fn named(name: &str) -> Option<Result<Case, Fault>> {
    let (name, text) = all().find(|case| case.0 == name)?;
    Some(Case::parse(text, name, &format!("{name}.toml"), Path::new("")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_case_parses_and_has_a_title_and_notes() {
        for (name, _) in all() {
            let case = named(name).unwrap().unwrap();
            assert_eq!(case.name, name);
            assert_eq!(title(name), Some(case.title.as_str()));
            assert!(case.title != name && !case.notes.is_empty(), "{name}");
        }
    }

    #[test]
    fn every_file_of_the_folder_is_built_in() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/cases");
        let files = [folder.join("figures"), folder].map(|folder| std::fs::read_dir(folder).unwrap());
        for entry in files.into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                let name = path.file_stem().unwrap().to_str().unwrap();
                assert!(named(name).is_some(), "{name}");
            }
        }
    }
}
