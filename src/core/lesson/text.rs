//! The text of a part: paragraphs, lists and equations, read strictly as a small part of Markdown. What is written bold
//! is lit; `[words](light:crossings)` lights something else; `{{theta_A}}` is a number of the state.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

use super::equation::Equation;
use super::names::Names;
use super::value::Quantity;
use crate::core::fault::Fault;

/// How a piece of text is set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Piece {
    /// As it is.
    Plain(String),
    /// With emphasis.
    Emphasis(String),
    /// As code.
    Code(String),
    /// In the colour of what the part lights.
    Lit(String),
    /// In that colour, and lighting what it names.
    Named(String, Names),
    /// A number of the state.
    Value(Quantity),
    /// A number of the state, lit as the text around it.
    LitValue(Quantity),
}

/// A block of text.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A paragraph.
    Paragraph(Vec<Piece>),
    /// An item of a list.
    Item(Vec<Piece>),
    /// An equation in TeX's notation, and what it says.
    Equation {
        /// Between the dollars.
        equation: Equation,
        /// Beside it.
        says: Vec<Piece>,
    },
}

impl Block {
    /// Its pieces of text.
    pub fn pieces(&self) -> &[Piece] {
        match self {
            Block::Paragraph(pieces) | Block::Item(pieces) | Block::Equation { says: pieces, .. } => pieces,
        }
    }
}

/// Reads Markdown into blocks, without equations; a fault comes with the byte of its place.
pub(super) fn read(markdown: &str) -> Result<Vec<Block>, (Fault, usize)> {
    let mut blocks = Vec::new();
    let mut reading = Reading::default();
    for (event, range) in Parser::new_ext(markdown, Options::empty()).into_offset_iter() {
        reading.take(event, &mut blocks).map_err(|fault| (fault, range.start))?;
    }
    Ok(blocks)
}

/// The text of the block at hand, and what it stands in.
#[derive(Default)]
struct Reading {
    pieces: Vec<Piece>,
    is_item: bool,
    bold: u32,
    emphasis: u32,
    link: Option<(Names, String)>,
}

impl Reading {
    fn take(&mut self, event: Event<'_>, blocks: &mut Vec<Block>) -> Result<(), Fault> {
        match event {
            Event::Start(Tag::Paragraph | Tag::List(None)) => {}
            Event::Start(Tag::Item) => self.is_item = true,
            Event::Start(Tag::Strong) => self.bold += 1,
            Event::Start(Tag::Emphasis) => self.emphasis += 1,
            Event::Start(Tag::Link { dest_url, .. }) => self.link = Some((target(&dest_url)?, String::new())),
            Event::End(TagEnd::Paragraph | TagEnd::Item) => self.end(blocks),
            Event::End(TagEnd::List(_)) => self.is_item = false,
            Event::End(TagEnd::Strong) => self.bold = self.bold.saturating_sub(1),
            Event::End(TagEnd::Emphasis) => self.emphasis = self.emphasis.saturating_sub(1),
            Event::End(TagEnd::Link) => {
                if let Some((names, words)) = self.link.take() {
                    self.pieces.push(Piece::Named(words, names));
                }
            }
            Event::Text(text) => self.text(&text)?,
            Event::SoftBreak | Event::HardBreak => self.text(" ")?,
            Event::Code(text) => self.pieces.push(Piece::Code(text.into_string())),
            _ => {
                return Err(Fault::new("A part has paragraphs, lists with dashes and equations, nothing else")
                    .remedy("Write it as a paragraph"));
            }
        }
        Ok(())
    }

    fn end(&mut self, blocks: &mut Vec<Block>) {
        let pieces = std::mem::take(&mut self.pieces);
        if !pieces.is_empty() {
            blocks.push(if self.is_item { Block::Item(pieces) } else { Block::Paragraph(pieces) });
        }
    }

    fn text(&mut self, text: &str) -> Result<(), Fault> {
        if let Some((_, words)) = &mut self.link {
            words.push_str(text);
            return Ok(());
        }
        let mut rest = text;
        while let Some((before, after)) = rest.split_once("{{") {
            let Some((name, after)) = after.split_once("}}") else { break };
            self.plain(before);
            let quantity = Quantity::read(name)?;
            self.pieces.push(if self.bold > 0 { Piece::LitValue(quantity) } else { Piece::Value(quantity) });
            rest = after;
        }
        self.plain(rest);
        Ok(())
    }

    /// Text in the style at hand, joined with what is before it in the same style.
    fn plain(&mut self, text: &str) {
        if text.is_empty() {
            return;
        }
        let (bold, emphasis) = (self.bold > 0, self.emphasis > 0);
        match (self.pieces.last_mut(), bold, emphasis) {
            (Some(Piece::Lit(words)), true, _)
            | (Some(Piece::Emphasis(words)), false, true)
            | (Some(Piece::Plain(words)), false, false) => words.push_str(text),
            (_, true, _) => self.pieces.push(Piece::Lit(text.to_owned())),
            (_, false, true) => self.pieces.push(Piece::Emphasis(text.to_owned())),
            (_, false, false) => self.pieces.push(Piece::Plain(text.to_owned())),
        }
    }
}

/// What a link lights.
fn target(url: &str) -> Result<Names, Fault> {
    let example = "Write for example [three edges](light:crossings)";
    let names = url
        .strip_prefix("light:")
        .ok_or_else(|| Fault::new("A link in a lesson lights something, and leads nowhere").remedy(example))?;
    Names::parse(&names.replace("%20", " "))
}

/// The words of some blocks, as a reader counts them: equations are not words.
pub(super) fn words(blocks: &[Block]) -> usize {
    let text_of = |piece: &Piece| match piece {
        Piece::Plain(text) | Piece::Emphasis(text) | Piece::Code(text) | Piece::Lit(text) => text.clone(),
        Piece::Named(text, _) => text.clone(),
        Piece::Value(_) | Piece::LitValue(_) => "0".to_owned(),
    };
    let is_text = |block: &&Block| !matches!(block, Block::Equation { .. });
    let texts = blocks.iter().filter(is_text).map(|block| block.pieces().iter().map(text_of).collect::<String>());
    texts.map(|text| text.split_whitespace().filter(|word| word.chars().any(char::is_alphanumeric)).count()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_part_of_markdown_is_read_and_the_rest_is_refused() {
        let plain = |text: &str| Piece::Plain(text.to_owned());
        let blocks = read("The H_{min} of\n**three edges** is *here* and `c`.\n\n- [A](light:A) is {{theta_A}}\n- b\n");
        let expected = vec![
            Block::Paragraph(vec![
                plain("The H_{min} of "),
                Piece::Lit("three edges".to_owned()),
                plain(" is "),
                Piece::Emphasis("here".to_owned()),
                plain(" and "),
                Piece::Code("c".to_owned()),
                plain("."),
            ]),
            Block::Item(vec![
                Piece::Named("A".to_owned(), Names::parse("A").unwrap()),
                plain(" is "),
                Piece::Value(Quantity::ThetaA),
            ]),
            Block::Item(vec![plain("b")]),
        ];
        assert_eq!(blocks.map_err(|(fault, _)| fault), Ok(expected));
        for text in
            ["<b>x</b>", "![a](b)", "```\nx\n```", "> x", "1. x", "---", "[a](https://b.c)", "{{theta}}", "[a](light:)"]
        {
            assert!(read(text).is_err(), "{text}");
        }
        let (_, at) = read("a\n\nb <i>").unwrap_err();
        assert_eq!(at, 5);
    }

    #[test]
    fn words_are_counted_without_signs_and_equations() {
        let mut blocks = read("A \u{2192} B, of {{NQ}} **two {{step}} words**.").unwrap();
        blocks.push(Block::Equation { equation: Equation::parse("a b c").unwrap(), says: Vec::new() });
        assert_eq!(words(&blocks), 7);
    }
}
