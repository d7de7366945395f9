//! A lesson as text: each part with its step, what was done there, its words, equations and questions.

use std::fmt::Write;

use super::scene::{Scene, Shown};
use super::text::{Block, Piece};
use super::{Lesson, Part};
use crate::core::fault::Fault;
use crate::core::kernel::number::{counted, grouped};
use crate::core::question::Asked;
use crate::core::run::History;
use crate::core::run::explain::{edge, plain};

use super::things::Things;

/// A lesson as text; with `answers` each question has its answer and the reason.
///
/// # Errors
/// As [`Lesson::scene`].
pub fn page(lesson: &Lesson, history: &mut History, answers: bool) -> Result<String, Fault> {
    let mut page = String::new();
    let section = if lesson.section.is_empty() { String::new() } else { format!(" ({})", lesson.section) };
    // Writing to a String cannot fail.
    let _ = writeln!(page, "{}{section}", lesson.title);
    let counts = [(lesson.parts.len(), "part"), (lesson.questions(), "question")];
    let [parts, questions] = counts.map(|(n, one)| counted(n as u64, one));
    let _ = writeln!(page, "Case {}: {parts}, {questions}", lesson.case.name);
    for (index, part) in lesson.parts.iter().enumerate() {
        let scene = lesson.scene(index, history)?;
        page += &part_text(part, &scene);
        for (ask, asked) in part.asks.iter().zip(&scene.asked) {
            page += &question(&ask.text, ask.hint.as_deref(), asked, history, answers)?;
        }
    }
    Ok(page)
}

/// A part of a lesson as text, without its questions: its step, what was done there, its words and equations.
pub fn part_text(part: &Part, scene: &Scene) -> String {
    let mut text = format!("\n## {}\n", part.heading);
    let _ = writeln!(text, "Step {}: {}", grouped(scene.step), plain(&scene.narration));
    for (what, things) in [("Framed", &scene.frame), ("Lit", &scene.light)] {
        if !things.is_empty() {
            let _ = writeln!(text, "{what}: {}", listed(things));
        }
    }
    for ((block, pieces), equation) in part.blocks.iter().zip(&scene.text).zip(&scene.equations) {
        // Pieces that are lit one after another are one.
        let words = pieces.iter().map(words).collect::<String>().replace("**", "");
        let words = plain(&words);
        let _ = match (block, equation) {
            (_, Some(equation)) => writeln!(text, "{}", format!("\n    {}    {words}", equation.text()).trim_end()),
            (Block::Item(_), None) => writeln!(text, "- {words}"),
            (_, None) => writeln!(text, "\n{words}"),
        };
    }
    text
}

/// A piece of text, what is lit between stars.
fn words(shown: &Shown) -> String {
    match shown.piece {
        Piece::Lit(_) | Piece::LitValue(_) | Piece::Named(..) => format!("*{}*", shown.text),
        _ => shown.text.clone(),
    }
}

fn question(
    text: &str,
    hint: Option<&str>,
    asked: &Asked,
    history: &mut History,
    answers: bool,
) -> Result<String, Fault> {
    let mut said = format!("\n? {}\n", plain(text));
    let choices: Vec<String> = asked.kind.choices().iter().map(|choice| plain(choice.words())).collect();
    if !choices.is_empty() {
        let _ = writeln!(said, "  {}", choices.join(" / "));
    }
    // The questions of a part are asked at one state.
    history.seek(asked.step)?;
    let hints = asked.hints(history.state());
    for hint in hint.into_iter().map(str::to_owned).chain(hints.into_iter().map(|hint| hint.text)) {
        let _ = writeln!(said, "  hint: {}", plain(&hint));
    }
    if answers {
        let judged = asked.judge(history.state(), asked.answer())?;
        let _ = writeln!(said, "  answer: {}. {}", plain(&asked.answer().words()), plain(&judged.why.join(" ")));
    }
    Ok(said)
}

/// Things by their numbers, the first few of each kind.
fn listed(things: &Things) -> String {
    const MOST: usize = 8;
    let some = |texts: Vec<String>, one: &str| {
        let rest = texts.len().saturating_sub(MOST);
        let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
        let first = texts.into_iter().take(MOST).collect::<Vec<_>>().join(", ");
        (!first.is_empty()).then(|| format!("{one} {first}{more}"))
    };
    let lines = |ends: &[[crate::core::mesh::NodeId; 2]]| ends.iter().map(|ends| edge(*ends)).collect();
    let kinds = [
        some(things.nodes.iter().map(|n| n.0.to_string()).collect(), "nodes"),
        some(lines(&things.edges), "edges"),
        some(lines(&things.missing), "lines"),
        some(things.elements.iter().map(|e| e.0.to_string()).collect(), "elements"),
    ];
    kinds.into_iter().flatten().collect::<Vec<_>>().join("; ")
}
