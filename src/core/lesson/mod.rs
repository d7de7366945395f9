//! Lessons: a text beside a run, in parts that each stand at a state, light what they speak of and ask what comes next.
//! A lesson is a file that teachers write (docs/lessons.md); the tour is made of such files. Here they are read,
//! strictly, and resolved against a run; nothing here draws.
//!
//! | what | where |
//! |---|---|
//! | a lesson as its file has it | [`Lesson`], [`Part`], [`Ask`] |
//! | its text | [`Block`], [`Piece`], [`Quantity`] |
//! | its equations, as trees | [`Equation`], [`equation`] |
//! | where a part stands | [`Go`] |
//! | what it frames and lights | [`Names`], [`Things`] |
//! | a part at its state, with its questions | [`Scene`] |
//! | a lesson as text | [`page()`] |
//! | the decisions that led to a state | [`decisions`] |
//! | the lessons of the tour | [`built_in`] |

mod attributes;
mod names;
mod go;
mod subject;
mod value;
pub mod equation;
mod text;
mod head;
mod parts;
mod things;
mod scene;
mod page;
pub mod built_in;

use std::path::{Path, PathBuf};

pub use equation::Equation;
pub use go::Go;
pub use names::{Letter, Name, Names, Point, Set};
pub use page::{page, part_text};
pub use parts::{Ask, Part};
pub use scene::{Decision, Scene, Shown, decisions};
pub use text::{Block, Piece};
pub use things::Things;
pub use value::Quantity;

use crate::core::case::Case;
use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::save::load;
use crate::core::question::Rule;
use crate::core::run::Run;

/// The most words that a part may have.
pub const MOST_WORDS: usize = 60;

/// A lesson, as its file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Lesson {
    /// Short name: the file name without its extension.
    pub name: String,
    /// Its title.
    pub title: String,
    /// The section of the paper that it is about; may be empty.
    pub section: String,
    /// The case that it shows, with its parameters.
    pub case: Case,
    /// The file of the case, from the folder of the lesson; `None` for a built-in case.
    pub case_file: Option<PathBuf>,
    /// The rules that it is about.
    pub rules: Vec<Rule>,
    /// Its parts, at least one.
    pub parts: Vec<Part>,
    /// The name of the file, for messages.
    pub file: String,
}

impl Lesson {
    /// Reads a lesson file; a case that it names by a path is relative to it.
    ///
    /// # Errors
    /// Those of reading the file, and of [`Lesson::parse`].
    pub fn read(path: &Path) -> Result<Lesson, Fault> {
        let file = path.display().to_string();
        let bytes = load(path)?;
        let text = std::str::from_utf8(&bytes).map_err(|error| {
            Fault::new(format!("The file is not text (byte {})", error.valid_up_to()))
                .of_kind(FaultKind::Syntax)
                .at(&file)
                .remedy("Give a lesson; docs/lessons.md says how one is written")
        })?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Lesson::parse(text, &name, &file, path.parent().unwrap_or(Path::new("")))
    }

    /// Parses the text of a lesson `name`; `file` is its name in messages, and the path of a case is relative to
    /// `folder`.
    ///
    /// # Errors
    /// With file and line: a head that is not TOML, unknown or missing keys and names, a part that is too long, a text
    /// that is no lesson.
    pub fn parse(text: &str, name: &str, file: &str, folder: &Path) -> Result<Lesson, Fault> {
        let read = || {
            let text = text.strip_prefix('\u{feff}').unwrap_or(text);
            let (head, first_line) = head::split(text, file)?;
            let head = head::read(head, file, folder)?;
            let parts = parts::read(text, first_line, file)?;
            Ok((head, parts))
        };
        let (head, parts) = read().map_err(|fault: Fault| fault.of_kind(FaultKind::Syntax))?;
        let head::Head { title, section, case, case_file, rules } = head;
        let (name, file) = (name.to_owned(), file.to_owned());
        Ok(Lesson { name, title, section, case, case_file, rules, parts, file })
    }

    /// The run that it shows.
    pub fn run(&self) -> Run {
        Run::of(self.case.clone())
    }

    /// Its questions, counted.
    pub fn questions(&self) -> usize {
        self.parts.iter().map(|part| part.asks.len()).sum()
    }
}
