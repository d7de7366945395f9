//! A lesson or a prediction as text, around the canvas of a page.

use super::Study;
use crate::core::lesson::part_text;
use crate::core::run::explain::plain;

/// What is told, asked and answered now, a paragraph a line, without marks: the part of the lesson, the question, what
/// can be answered, and the answers and hints so far.
pub fn in_words(study: &Study) -> String {
    let mut said = Vec::new();
    if let Some((lesson, part)) = study.lesson() {
        let scene = study.taught.as_ref().and_then(|taught| taught.scene.as_ref());
        if let (Some(part), Some(scene)) = (lesson.parts.get(part), scene) {
            said.push(lesson.title.clone());
            said.push(part_text(part, scene).replace("## ", ""));
        }
    }
    if let Some(posed) = study.posed() {
        said.push(format!("Question: {}", posed.text));
        let choices: Vec<&str> = posed.asked.kind.choices().iter().map(|choice| choice.words()).collect();
        if !choices.is_empty() {
            said.push(format!("Answers: {}.", choices.join("; ")));
        }
        for one in &study.tries {
            said.push(format!("{}: {}. {}", one.word(), one.answer.words(), one.judged.why.join(" ")));
        }
        for hint in study.taken_hints() {
            said.push(format!("Hint: {}", hint.text));
        }
    }
    said.extend(study.remark.clone());
    plain(&said.join("\n").replace('*', ""))
}
