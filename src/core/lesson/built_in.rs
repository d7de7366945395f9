//! The lessons of the tour: the files of `assets/lessons`, in their order, and the template for teachers.

use std::path::Path;

use super::Lesson;
use crate::core::fault::Fault;

/// A lesson to begin with, for teachers.
pub const TEMPLATE: &str = include_str!("../../../assets/lessons/template.md");

macro_rules! lessons {
    ($($name:literal),* $(,)?) => {
        /// Name and text of each, in the order of the tour.
        pub const LESSONS: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../assets/lessons/", $name, ".md")))),*];
    };
}

lessons![
    "figure-4",
    "figure-9",
    "figure-11",
    "figure-12",
    "figure-13",
    "figure-3",
    "figure-5",
    "figure-6",
    "figure-7",
    "figure-8",
    "side-edges",
    "figure-14",
    "figure-15",
    "figure-10",
    "figure-16",
    "figure-17",
    "figure-18",
    "figure-19",
    "parity",
    "example1",
    "predict",
];

/// The lesson of the tour with this name, if any.
///
/// # Errors
/// None in practice: a test parses all of them.
pub fn named(name: &str) -> Option<Result<Lesson, Fault>> {
    let (name, text) = LESSONS.iter().find(|lesson| lesson.0 == name)?;
    Some(Lesson::parse(text, name, &format!("{name}.md"), Path::new("")))
}

/// The title of a lesson of the tour; none where there is no such lesson.
pub fn title(name: &str) -> Option<&'static str> {
    let (_, text) = LESSONS.iter().find(|lesson| lesson.0 == name)?;
    text.lines().find_map(|line| line.strip_prefix("title = \"")?.split('"').next())
}

/// Every equation of the tour and the template.
#[cfg(test)]
pub(crate) fn equations() -> Vec<super::Equation> {
    let lessons = LESSONS.iter().filter_map(|(name, _)| named(name)?.ok());
    let template = Lesson::parse(TEMPLATE, "template", "template.md", Path::new(""));
    let parts = lessons.chain(template).flat_map(|lesson| lesson.parts);
    let of_block = |block| match block {
        super::Block::Equation { equation, .. } => Some(equation),
        super::Block::Paragraph(_) | super::Block::Item(_) => None,
    };
    parts.flat_map(|part| part.blocks).filter_map(of_block).collect()
}
