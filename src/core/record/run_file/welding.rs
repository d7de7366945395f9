//! Which points of a mesh are merged, as run files say it. Those from before points were merged say nothing, and give
//! what they gave: silence means none, although a case that is silent means [`Weld::Auto`].

use std::path::Path;

use crate::core::case::table::{Source, Table};
use crate::core::case::{Case, DomainSource, taking};
use crate::core::fault::Fault;
use crate::core::soup::Weld;

/// What silence means.
const UNSAID: Weld = Weld::Within(0.0);

/// Sets what the table of the case says, or else the text of the case.
pub(super) fn set(case: &mut Case, table: &Table<'_>) -> Result<(), Fault> {
    let in_text = in_text(&case.text);
    if let DomainSource::Mesh { taking, .. } = &mut case.domain {
        let said = table.get("weld").map(|value| taking::weld(&value)).transpose()?;
        taking.weld = said.or(in_text).unwrap_or(UNSAID);
    }
    Ok(())
}

/// The line that says it; empty where the text of the case does, or where silence is right.
pub(super) fn line(case: &Case) -> String {
    match &case.domain {
        DomainSource::Mesh { taking, .. } if taking.weld != in_text(&case.text).unwrap_or(UNSAID) => {
            match taking.weld {
                Weld::Auto => format!("weld = \"{}\"\n", Weld::AUTO),
                Weld::Within(distance) => format!("weld = {distance:?}\n"),
            }
        }
        _ => String::new(),
    }
}

/// What the text of a case says itself.
fn in_text(text: &str) -> Option<Weld> {
    let source = Source::new("", text);
    let document = source.parse().ok()?;
    let is_said = Table::document(&source, &document).get("weld").is_some();
    match Case::parse(text, "", "", Path::new("")).ok()?.domain {
        DomainSource::Mesh { taking, .. } if is_said => Some(taking.weld),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{parse, written_in};
    use super::*;
    use crate::core::case::{ImportOptions, MeshSource};
    use crate::core::run::Run;

    fn weld(case: &Case) -> Weld {
        match &case.domain {
            DomainSource::Mesh { source: MeshSource::File { .. }, taking } => taking.weld,
            _ => panic!("no mesh"),
        }
    }

    #[test]
    fn what_is_merged_survives_and_the_silence_of_an_old_run_file_means_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        for how in [Weld::Auto, Weld::Within(0.25), Weld::Within(0.0)] {
            // Without a text, and with one that says nothing of it but where that is needed.
            for scale in [None, Some(2.0)] {
                let options = ImportOptions { weld: how, scale, ..ImportOptions::default() };
                let run = Run::of(options.case(path.clone(), None).unwrap());
                assert_eq!(weld(&run.case), how);
                let text = written_in(&run, folder.path()).unwrap();
                let back = parse(&text, "a.run.toml", folder.path()).unwrap();
                assert_eq!(weld(&back.case), how, "{text}");
                // A file from before has no such line.
                let old: String =
                    text.lines().filter(|line| !line.starts_with("weld")).map(|l| format!("{l}\n")).collect();
                assert_eq!(weld(&parse(&old, "old.toml", folder.path()).unwrap().case), UNSAID, "{old}");
            }
        }
        let text = format!("run = 1\n[case]\nname = \"a\"\nweld = \"on\"\ntext = \"version = 1\\nmesh = 'a.obj'\"\n");
        assert!(parse(&text, "a.toml", folder.path()).is_err());
    }
}
