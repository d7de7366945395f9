//! `lesson`: the lessons of the tour, and a check of one's own.

use std::path::Path;
use std::process::ExitCode;

use serde_json::{Value, json};

use super::command_line::LessonArguments;
use super::output::Target;
use super::progress::Progress;
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::core::kernel::spelling::nearest;
use crate::core::lesson::{Block, Equation, Lesson, Piece, Scene, Shown, Things, built_in, page};
use crate::core::question::Asked;
use crate::core::run::History;
use crate::core::run::explain::plain;

/// Lists the lessons of the tour, prints the template, checks a lesson and prints it, or opens it in the window.
pub(super) fn lesson(arguments: &LessonArguments) -> Result<ExitCode, Fault> {
    #[cfg(not(target_arch = "wasm32"))]
    if arguments.open {
        return super::program::open_lesson(arguments.lesson.as_deref().unwrap_or(built_in::LESSONS[0].0));
    }
    let text = match &arguments.lesson {
        _ if arguments.template => built_in::TEMPLATE.to_owned(),
        None => list(arguments.json)?,
        Some(name) => {
            let lesson = found(name)?;
            let mut progress = Progress::new(true);
            let mut history = History::open(lesson.run(), &mut progress)?;
            progress.finish();
            if arguments.json {
                format!("{:#}\n", as_json(&lesson, &mut history)?)
            } else {
                page(&lesson, &mut history, arguments.answers)?
            }
        }
    };
    Target::StandardOutput.write(|out| out.write_all(text.as_bytes()))?;
    Ok(ExitCode::SUCCESS)
}

/// A lesson of the tour by its name, or a file.
pub(super) fn found(name: &str) -> Result<Lesson, Fault> {
    if let Some(lesson) = built_in::named(name) {
        return lesson;
    }
    if name.ends_with(".md") || save::is_file(Path::new(name)) {
        return Lesson::read(Path::new(name));
    }
    let fault = Fault::new("No lesson has this name").at(name);
    Err(match nearest(name, built_in::LESSONS.iter().map(|lesson| lesson.0)) {
        Some(near) => fault.remedy(format!("The nearest is \"{near}\"; quadfront lesson lists all")),
        None => fault.remedy("quadfront lesson lists all; a file of your own ends in .md"),
    })
}

fn list(json: bool) -> Result<String, Fault> {
    let lessons: Vec<Lesson> =
        built_in::LESSONS.iter().filter_map(|(name, _)| built_in::named(name)).collect::<Result<_, _>>()?;
    if json {
        let entry = |lesson: &Lesson| {
            json!({
                "name": lesson.name,
                "title": lesson.title,
                "section": lesson.section,
                "case": lesson.case.name,
                "parts": lesson.parts.len(),
                "questions": lesson.questions(),
            })
        };
        return Ok(format!("{:#}\n", Value::from(lessons.iter().map(entry).collect::<Vec<_>>())));
    }
    let width = lessons.iter().map(|lesson| lesson.name.len()).max().unwrap_or(0);
    let line = |(lesson, number): (&Lesson, usize)| format!("{number:2}  {:width$}  {}\n", lesson.name, lesson.title);
    Ok(lessons.iter().zip(1..).map(line).collect())
}

/// A lesson for other programs: each part with its step, what it lights, its text and its questions.
fn as_json(lesson: &Lesson, history: &mut History) -> Result<Value, Fault> {
    let mut parts = Vec::new();
    for (index, part) in lesson.parts.iter().enumerate() {
        let scene = lesson.scene(index, history)?;
        let mut questions = Vec::new();
        for (ask, asked) in part.asks.iter().zip(&scene.asked) {
            history.seek(asked.step)?;
            questions.push(question(&ask.text, ask.hint.as_deref(), asked, history)?);
        }
        let Scene { step, narration, frame, light, text, equations, .. } = &scene;
        let blocks = part.blocks.iter().zip(text).zip(equations);
        let blocks: Vec<Value> = blocks.map(|((of, pieces), equation)| block(of, pieces, equation.as_ref())).collect();
        parts.push(json!({
            "heading": part.heading,
            "line": part.line,
            "step": step,
            "narration": plain(narration),
            "frame": things(frame),
            "light": things(light),
            "text": blocks,
            "questions": questions,
        }));
    }
    let rules: Vec<&str> = lesson.rules.iter().map(|rule| rule.name()).collect();
    Ok(json!({
        "name": lesson.name,
        "title": lesson.title,
        "section": lesson.section,
        "case": lesson.case.name,
        "rules": rules,
        "parts": parts,
    }))
}

fn block(block: &Block, pieces: &[Shown], equation: Option<&Equation>) -> Value {
    let pieces: Vec<Value> = pieces.iter().map(piece).collect();
    match (block, equation) {
        (_, Some(equation)) => {
            json!({ "kind": "equation", "tex": equation.tex(), "equation": equation.text(), "pieces": pieces })
        }
        (Block::Item(_), None) => json!({ "kind": "item", "pieces": pieces }),
        (_, None) => json!({ "kind": "paragraph", "pieces": pieces }),
    }
}

fn piece(shown: &Shown) -> Value {
    let style = match shown.piece {
        Piece::Plain(_) | Piece::Value(_) => "plain",
        Piece::Emphasis(_) => "emphasis",
        Piece::Code(_) => "code",
        Piece::Lit(_) | Piece::LitValue(_) | Piece::Named(..) => "lit",
    };
    json!({ "style": style, "text": plain(&shown.text), "lights": shown.lights.as_ref().map(things) })
}

fn things(things: &Things) -> Value {
    json!({
        "nodes": things.nodes,
        "edges": things.edges,
        "missing": things.missing,
        "elements": things.elements,
    })
}

fn question(text: &str, hint: Option<&str>, asked: &Asked, history: &History) -> Result<Value, Fault> {
    let state = history.state();
    let judged = asked.judge(state, asked.answer())?;
    let choices: Vec<Value> = asked.kind.choices().iter().map(|c| json!([c.name(), plain(c.words())])).collect();
    let hints = asked.hints(state).into_iter().map(|hint| hint.text);
    let hints: Vec<String> = hint.map(str::to_owned).into_iter().chain(hints).map(|hint| plain(&hint)).collect();
    Ok(json!({
        "kind": asked.kind.name(),
        "rule": asked.rule.name(),
        "text": plain(text),
        "choices": choices,
        "hints": hints,
        "answer": asked.answer().text(),
        "why": plain(&judged.why.join(" ")),
    }))
}
