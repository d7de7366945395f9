//! A sweep as commands for a shell: one for each cell.

use std::path::Path;

use crate::app::command_line::SweepArguments;
use crate::core::record::sweep::Sweep;

/// The longest name of a file made of keys and values.
const LONGEST: usize = 120;

/// One command for each cell: a sweep with this cell alone, written to a JSON file in a folder.
pub(super) fn commands(arguments: &SweepArguments, sweep: &Sweep, program: &str, folder: &Path) -> Vec<String> {
    let mut common = vec![program.to_owned(), "sweep".to_owned()];
    common.extend(arguments.source.words());
    common.extend(arguments.mesh.words());
    let of_cell = |cell: usize| {
        let mut words = common.clone();
        for (key, value) in sweep.values(cell) {
            words.extend(["--over".to_owned(), format!("{key}={value}")]);
        }
        let file = folder.join(file_name(sweep, cell)).display().to_string();
        words.extend(["--quiet".to_owned(), "--out".to_owned(), file]);
        words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
    };
    (0..sweep.cells().len()).map(of_cell).collect()
}

/// The name of the file of a cell: its keys and values where they can stand in a name, else its number.
fn file_name(sweep: &Sweep, cell: usize) -> String {
    let parts: Vec<_> = sweep.values(cell).into_iter().map(|(key, value)| format!("{key}={value}")).collect();
    let name = parts.join(",");
    let is_plain = name.len() <= LONGEST && name.chars().all(|c| c.is_ascii_alphanumeric() || "=.,_-".contains(c));
    if is_plain { format!("{name}.json") } else { format!("cell-{}.json", cell + 1) }
}

/// A word as a POSIX shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || "_./:=,+@%-".contains(c));
    if is_plain { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_change_them() {
        for (word, written) in [
            ("c=1.5", "c=1.5"),
            ("./a_b/c-d.toml", "./a_b/c-d.toml"),
            ("my case.toml", "'my case.toml'"),
            ("it's", "'it'\\''s'"),
            ("$HOME;*", "'$HOME;*'"),
            ("", "''"),
            ("~", "'~'"),
        ] {
            assert_eq!(quoted(word), written);
        }
    }
}
