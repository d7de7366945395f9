//! Reads TeX's notation into terms.
//!
//! ```text
//! row    = { term }
//! term   = atom { "_" argument | "^" argument | "'" }
//! atom   = character | digits | "{" row "}" | "{{" number of the state "}}" | "\" command
//! argument = character | digit | "{" row "}" | "{{" number of the state "}}" | "\" command
//! ```

use super::signs::{COMMANDS, Command, of_character};
use super::{Class, Row, Sign, Term};
use crate::core::fault::Fault;
use crate::core::kernel::spelling::suggestion;
use crate::core::lesson::attributes::shortened;
use crate::core::lesson::value::Quantity;

/// The deepest nesting: enough for a person, and a small stack.
const DEEPEST: usize = 24;

const LISTED: &str = "docs/lessons.md lists what an equation may have";

type Failed = (Fault, usize);

/// Reads an equation; a fault comes with the byte of its place.
pub(super) fn read(tex: &str) -> Result<Row, Failed> {
    let mut reading = Reading { tex, at: 0, depth: 0 };
    let row = reading.row()?;
    match reading.rest() {
        "" => Ok(row),
        rest => {
            let what = if rest.starts_with('}') { "A } closes nothing" } else { "A \\right has no \\left before it" };
            Err((Fault::new(what).remedy("Close what is open, in its order"), reading.at))
        }
    }
}

struct Reading<'t> {
    tex: &'t str,
    at: usize,
    depth: usize,
}

impl<'t> Reading<'t> {
    fn rest(&self) -> &'t str {
        &self.tex[self.at..]
    }

    /// The next character that is not blank.
    fn peek(&mut self) -> Option<char> {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
        self.rest().chars().next()
    }

    /// Passes over a text that stands next.
    fn take(&mut self, text: &str) -> bool {
        let is_there = self.rest().starts_with(text);
        self.at += if is_there { text.len() } else { 0 };
        is_there
    }

    /// Terms up to a closing brace, a `\right` or the end.
    fn row(&mut self) -> Result<Row, Failed> {
        let mut row = Row::new();
        while let Some(c) = self.peek() {
            if c == '}' || self.is_at_right() {
                break;
            }
            let term = self.term()?;
            row.push(term);
        }
        Ok(row)
    }

    fn is_at_right(&self) -> bool {
        self.rest().strip_prefix("\\right").is_some_and(|after| !after.starts_with(|c: char| c.is_ascii_alphabetic()))
    }

    /// An atom and what stands at it.
    fn term(&mut self) -> Result<Term, Failed> {
        let from = self.at;
        let base = match self.peek() {
            Some('_' | '^' | '\'') => {
                let what = "A subscript, a superscript or a prime stands at nothing";
                return Err((Fault::new(what).remedy("Write what it belongs to before it, or {}"), self.at));
            }
            _ => self.atom(false)?,
        };
        let (mut low, mut high, mut primes) = (None, None, 0);
        while let Some(c) = self.peek() {
            let here = self.at;
            match c {
                '\'' => {
                    self.at += 1;
                    primes += 1;
                }
                '_' | '^' => {
                    self.at += 1;
                    let script = self.argument(&c.to_string())?;
                    let (kept, name) = if c == '_' { (&mut low, "subscript") } else { (&mut high, "superscript") };
                    if kept.replace(script).is_some() {
                        let fault = Fault::new(format!("A term has two {name}s")).remedy("Write both in one {}");
                        return Err((fault, here));
                    }
                }
                _ => break,
            }
        }
        let prime = Term::Sign(Sign { glyph: '′', class: Class::Ordinary });
        let mut above: Row = std::iter::repeat_n(prime, primes).collect();
        above.extend(high.unwrap_or_default());
        let below = low.unwrap_or_default();
        if matches!(base, Term::Space(_)) && !(above.is_empty() && below.is_empty()) {
            let fault = Fault::new("A subscript or a superscript stands at a space");
            return Err((fault.remedy("Write what it belongs to before it"), from));
        }
        Ok(match below.is_empty() && above.is_empty() {
            true => base,
            false => Term::Scripts { base: Box::new(base), low: below, high: above },
        })
    }

    /// What stands in braces after a command, or the next atom.
    fn argument(&mut self, of: &str) -> Result<Row, Failed> {
        let missing = |at| {
            let remedy = format!("Write for example {}", example(of));
            Err((Fault::new(format!("Something is missing after {of}")).remedy(remedy), at))
        };
        match self.peek() {
            None | Some('}' | '_' | '^' | '\'') => missing(self.at),
            Some(_) if self.is_at_right() => missing(self.at),
            Some(_) => match self.atom(true)? {
                Term::Group(row) => Ok(row),
                term => Ok(vec![term]),
            },
        }
    }

    /// A term without what stands at it; `is_one` takes a single digit of several.
    fn atom(&mut self, is_one: bool) -> Result<Term, Failed> {
        // Whatever nests comes through here.
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err((Fault::new("The equation is nested too deeply").remedy("Write it in several"), self.at));
        }
        let atom = self.one_atom(is_one)?;
        self.depth -= 1;
        Ok(atom)
    }

    fn one_atom(&mut self, is_one: bool) -> Result<Term, Failed> {
        let from = self.at;
        let Some(c) = self.peek() else { return Err((Fault::new("The equation ends early").remedy(LISTED), from)) };
        let rest = self.rest();
        // The first of three braces is one by itself.
        if rest.starts_with("{{") && !rest.starts_with("{{{") {
            return self.value();
        }
        match c {
            '{' => {
                let row = self.in_braces()?;
                Ok(Term::Group(row))
            }
            '\\' => self.command(),
            '0'..='9' => {
                let is_part = |(at, c): &(usize, char)| {
                    c.is_ascii_digit() || (*c == '.' && rest[at + 1..].starts_with(|next: char| next.is_ascii_digit()))
                };
                let most = if is_one { 1 } else { usize::MAX };
                let digits: String = rest.char_indices().take_while(is_part).take(most).map(|(_, c)| c).collect();
                self.at += digits.len();
                Ok(Term::Digits(digits))
            }
            c => {
                let sign = of_character(c).ok_or_else(|| {
                    let what = format!("An equation has no \"{}\"", c.escape_debug());
                    (Fault::new(what).remedy(LISTED), self.at)
                })?;
                self.at += c.len_utf8();
                Ok(Term::Sign(sign))
            }
        }
    }

    /// `{ row }`.
    fn in_braces(&mut self) -> Result<Row, Failed> {
        let open = self.at;
        self.at += 1;
        let row = self.row()?;
        if self.take("}") {
            return Ok(row);
        }
        Err((Fault::new("A { is not closed").remedy("Close each { with a }"), open))
    }

    /// `{{ number }}`.
    fn value(&mut self) -> Result<Term, Failed> {
        let from = self.at;
        let Some((name, _)) = self.rest()[2..].split_once("}}") else {
            let remedy = "Write for example {{theta_A}}, or one brace for a group";
            return Err((Fault::new("A {{ is not closed").remedy(remedy), from));
        };
        self.at += name.len() + 4;
        Quantity::read(name).map(Term::Value).map_err(|fault| (fault, from))
    }

    /// `\command`, with its arguments.
    fn command(&mut self) -> Result<Term, Failed> {
        let from = self.at;
        let after = &self.rest()[1..];
        let letters = after.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(after.len());
        let length = if letters > 0 { letters } else { after.chars().next().map_or(0, char::len_utf8) };
        let name = &after[..length];
        let Some((name, command)) = COMMANDS.iter().find(|(known, _)| *known == name) else {
            return Err((unknown(name), from));
        };
        self.at += 1 + length;
        let written = format!("\\{name}");
        Ok(match *command {
            Command::Sign(sign) => Term::Sign(sign),
            Command::Function { has_limits } => Term::Function { name, has_limits },
            Command::Space(room) => Term::Space(room),
            Command::Fraction => Term::Fraction { above: self.argument(&written)?, below: self.argument(&written)? },
            Command::Root => {
                let degree = self.degree()?;
                Term::Root { degree, inside: self.argument(&written)? }
            }
            Command::Text => self.words(&written)?,
            Command::Left => self.fenced(from)?,
            Command::Right => return Err((Fault::new("A \\right has no \\left before it").remedy(LISTED), from)),
        })
    }

    /// `[3]` after `\sqrt`.
    fn degree(&mut self) -> Result<Row, Failed> {
        if self.peek() != Some('[') {
            return Ok(Row::new());
        }
        let open = self.at;
        let Some(end) = self.rest().find(']') else {
            return Err((Fault::new("A [ is not closed").remedy("Write for example \\sqrt[3]{x}"), open));
        };
        let degree = read(&self.rest()[1..end]).map_err(|(fault, at)| (fault, open + 1 + at))?;
        self.at += end + 1;
        Ok(degree)
    }

    /// `{words}`, as they are.
    fn words(&mut self, of: &str) -> Result<Term, Failed> {
        let open = self.peek();
        let from = self.at;
        let words = self.rest().strip_prefix('{').and_then(|rest| rest.split_once('}')).map(|(words, _)| words);
        let example = format!("Write for example {}", example(of));
        match (open, words) {
            (Some('{'), Some(words)) if !words.contains(['{', '\\']) => {
                self.at += words.len() + 2;
                Ok(Term::Text(words.split_whitespace().collect::<Vec<_>>().join(" ")))
            }
            _ => Err((Fault::new(format!("After {of} plain words stand in braces")).remedy(example), from)),
        }
    }

    /// `( row \right)`, after `\left`.
    fn fenced(&mut self, from: usize) -> Result<Term, Failed> {
        let left = self.fence("\\left")?;
        let inside = self.row()?;
        if !self.take("\\right") {
            return Err((Fault::new("A \\left has no \\right after it").remedy("Write \\left( x \\right)"), from));
        }
        let right = self.fence("\\right")?;
        Ok(Term::Fenced { fences: [left, right], inside })
    }

    /// The bracket after `\left` or `\right`.
    fn fence(&mut self, of: &str) -> Result<Option<char>, Failed> {
        self.peek();
        for (text, fence) in [(".", None), ("\\{", Some('{')), ("\\}", Some('}'))] {
            if self.take(text) {
                return Ok(fence);
            }
        }
        match self.rest().chars().next().filter(|c| "()[]|".contains(*c)) {
            Some(c) => {
                self.at += 1;
                Ok(Some(c))
            }
            None => {
                let remedy = "Write one of ( ) [ ] \\{ \\} | or a point for none";
                Err((Fault::new(format!("There is no bracket after {of}")).remedy(remedy), self.at))
            }
        }
    }
}

fn example(of: &str) -> &'static str {
    match of {
        "_" => "\\theta_i or \\theta_{AB}",
        "^" => "x^2 or x^{12}",
        "\\frac" => "\\frac{1}{2}",
        "\\sqrt" => "\\sqrt{x}",
        _ => "\\text{if}",
    }
}

fn unknown(name: &str) -> Fault {
    let fault = Fault::new(format!("There is no command \\{}", shortened(name)));
    let known = || COMMANDS.iter().map(|(known, _)| *known).filter(|known| known.len() > 1);
    let near = suggestion(name, known()).map(|text| text.replacen('"', "\"\\", 1));
    fault.remedy(near.unwrap_or_else(|| LISTED.to_owned()))
}
