//! The parts of a lesson: a heading that says where it stands, the text, and its questions.

use super::MOST_WORDS;
use super::attributes::{self, shortened};
use super::equation::Equation;
use super::go::Go;
use super::names::Names;
use super::text::{self, Block};
use crate::core::fault::Fault;
use crate::core::kernel::spelling::suggestion;
use crate::core::question::Kind;

/// One idea of a lesson.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its heading.
    pub heading: String,
    /// Its line in the file, from 1.
    pub line: usize,
    /// Where it stands; `None`: where the part before it does, and the first one at the start.
    pub go: Option<Go>,
    /// What is framed; `None`: the whole mesh.
    pub frame: Option<Names>,
    /// What is lit; `None`: nothing.
    pub light: Option<Names>,
    /// Its text.
    pub blocks: Vec<Block>,
    /// Its questions.
    pub asks: Vec<Ask>,
}

/// A question of a lesson.
#[derive(Clone, Debug, PartialEq)]
pub struct Ask {
    /// What is asked.
    pub kind: Kind,
    /// The question in words.
    pub text: String,
    /// What it is about, where it names that.
    pub of: Option<Names>,
    /// The teacher's hint, before those that are computed.
    pub hint: Option<String>,
    /// Its line in the file, from 1.
    pub line: usize,
}

/// Reads the parts from the lines after the head; `first` is the index of the first of them.
pub(super) fn read(text: &str, first: usize, file: &str) -> Result<Vec<Part>, Fault> {
    let lines: Vec<&str> = text.lines().collect();
    let place = |index: usize| format!("{file}, line {}", index + 1);
    let mut parts: Vec<Part> = Vec::new();
    let mut at = first;
    while at < lines.len() {
        let line = lines[at].trim_end();
        let placed = |fault: Fault| fault.at(place(at));
        if line.trim().is_empty() {
            at += 1;
            continue;
        }
        if let Some(heading) = line.strip_prefix("# ") {
            parts.push(part(heading, at + 1).map_err(placed)?);
            at += 1;
            continue;
        }
        let Some(part) = parts.last_mut() else {
            return Err(Fault::new(format!("\"{}\" stands before the first part", shortened(line)))
                .at(place(at))
                .remedy("Begin a part with # and its heading"));
        };
        if line.starts_with('#') {
            return Err(Fault::new(format!("\"{}\" is no heading of a part", shortened(line)))
                .at(place(at))
                .remedy("Write one # and a blank before the heading"));
        }
        if let Some(question) = line.strip_prefix('?') {
            part.asks.push(ask(question, at + 1).map_err(placed)?);
            at += 1;
            continue;
        }
        if !part.asks.is_empty() {
            return Err(Fault::new("Text follows a question")
                .at(place(at))
                .remedy("Begin a new part with # before it"));
        }
        if line.starts_with("$$") {
            let (block, next) = equation(&lines, at).map_err(|(fault, index)| fault.at(place(index)))?;
            part.blocks.push(block);
            at = next;
            continue;
        }
        let is_other = |line: &str| line.starts_with(['#', '?']) || line.starts_with("$$");
        let end = (at + 1..lines.len()).find(|&k| is_other(lines[k])).unwrap_or(lines.len());
        let markdown = lines[at..end].join("\n");
        let blocks = text::read(&markdown).map_err(|(fault, byte)| {
            let before = markdown.as_bytes().iter().take(byte).filter(|b| **b == b'\n').count();
            fault.at(place(at + before))
        })?;
        part.blocks.extend(blocks);
        at = end;
    }
    if parts.is_empty() {
        return Err(Fault::new("The lesson has no part")
            .at(place(first.saturating_sub(1)))
            .remedy("Begin a part with # and its heading"));
    }
    parts.iter().try_for_each(|part| check(part, file))?;
    Ok(parts)
}

/// A part says something, and not too much.
fn check(part: &Part, file: &str) -> Result<(), Fault> {
    let place = format!("{file}, line {}", part.line);
    if part.blocks.is_empty() {
        return Err(Fault::new(format!("The part \"{}\" has no text", shortened(&part.heading)))
            .at(place)
            .remedy("Write a sentence under its heading"));
    }
    match text::words(&part.blocks) {
        words if words > MOST_WORDS => {
            Err(Fault::new(format!("The part \"{}\" has {words} words", shortened(&part.heading)))
                .at(place)
                .remedy(format!("Divide it: one idea a part, and at most {MOST_WORDS} words")))
        }
        _ => Ok(()),
    }
}

fn part(heading: &str, line: usize) -> Result<Part, Fault> {
    let (heading, attributes) = attributes::split(heading, &["go", "frame", "light"])?;
    if heading.is_empty() {
        return Err(Fault::new("The heading is empty").remedy("Write for example # The edge C-D is not there yet"));
    }
    let mut part = Part {
        heading: heading.to_owned(),
        line,
        go: None,
        frame: None,
        light: None,
        blocks: Vec::new(),
        asks: Vec::new(),
    };
    for attribute in attributes {
        match attribute.key {
            "go" => part.go = Some(Go::parse(&attribute.value)?),
            "frame" => part.frame = Some(Names::parse(&attribute.value)?),
            _ => part.light = Some(Names::parse(&attribute.value)?),
        }
    }
    Ok(part)
}

fn ask(line: &str, at: usize) -> Result<Ask, Fault> {
    let (text, attributes) = attributes::split(line, &["answer", "hint", "of"])?;
    let (name, text) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let kind = Kind::named(name).ok_or_else(|| {
        let names = || Kind::ALL.iter().map(|kind| kind.name());
        let known = || format!("Kinds are {}", names().collect::<Vec<_>>().join(", "));
        let fault = Fault::new(format!("There is no kind of question \"{}\"", shortened(name)));
        fault.remedy(suggestion(name, names()).unwrap_or_else(known))
    })?;
    let text = if text.trim().is_empty() { kind.words() } else { text.trim() };
    let mut ask = Ask { kind, text: text.to_owned(), of: None, hint: None, line: at };
    for attribute in attributes {
        match attribute.key {
            "answer" => answer(kind, &attribute.value)?,
            "hint" => ask.hint = Some(attribute.value),
            _ => ask.of = Some(Names::parse(&attribute.value)?),
        }
    }
    match (kind.names_its_subject(), ask.of.is_some()) {
        (true, false) => Err(Fault::new(format!("A question of the kind {name} says what it is about"))
            .remedy("Write for example {of: \"7-4\"}")),
        (false, true) => {
            Err(Fault::new(format!("A question of the kind {name} is about the next step")).remedy("Leave \"of\" out"))
        }
        _ => Ok(ask),
    }
}

/// Where the answer comes from: it is never in the file.
fn answer(kind: Kind, text: &str) -> Result<(), Fault> {
    let right = if kind.is_of_state() { "state" } else { "event" };
    if text == right {
        return Ok(());
    }
    let from = if kind.is_of_state() { "the state" } else { "the event that follows" };
    Err(Fault::new(format!("answer: \"{}\" is not where this answer comes from", shortened(text)))
        .remedy(format!("Write answer: \"{right}\": a question of the kind {} is answered by {from}", kind.name())))
}

/// An equation between double dollars, and what it says; also the index of the line after it. The fault comes with the
/// index of its line.
fn equation(lines: &[&str], first: usize) -> Result<(Block, usize), (Fault, usize)> {
    let mut tex = lines[first][2..].to_owned();
    let mut at = first;
    let rest = loop {
        if let Some((before, after)) = tex.split_once("$$") {
            let after = after.to_owned();
            tex = before.to_owned();
            break after;
        }
        at += 1;
        match lines.get(at) {
            Some(line) if !line.trim().is_empty() => {
                tex.push('\n');
                tex.push_str(line);
            }
            _ => {
                let fault =
                    Fault::new("The equation has no end").remedy("Write $$ after it, before the next blank line");
                return Err((fault, first));
            }
        }
    };
    if tex.trim().is_empty() {
        return Err((Fault::new("The equation is empty").remedy("Write it between $$ and $$"), first));
    }
    let equation = Equation::parse(&tex).map_err(|(fault, byte)| {
        let before = tex.as_bytes().iter().take(byte).filter(|b| **b == b'\n').count();
        (fault, first + before)
    })?;
    let says = text::read(rest.trim()).map_err(|(fault, _)| (fault, at))?;
    let says = match &says[..] {
        [] => Vec::new(),
        [Block::Paragraph(pieces)] => pieces.clone(),
        _ => {
            let fault = Fault::new("What an equation says is one line of text").remedy("Write a paragraph below it");
            return Err((fault, at));
        }
    };
    Ok((Block::Equation { equation, says }, at + 1))
}
