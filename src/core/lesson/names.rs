//! Names of what a lesson frames, lights or asks about: nodes and edges by number, the paper's letters A, B, C and D,
//! and sets that the state knows.
//!
//! ```text
//! names = name { ( "," | " " ) name }
//! name  = set | point | point "-" point | ("quad" | "triangle" | "element") number | ("class" | "level") number
//! point = number | "A" | "B" | "C" | "D"
//! ```

use super::attributes::shortened;
use crate::core::fault::Fault;
use crate::core::kernel::spelling::suggestion;
use crate::core::kernel::worded::worded;
use crate::core::mesh::{ElementId, NodeId};

worded! {
    /// A corner of the quadrilateral under way, or of the last one, in the paper's letters.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Letter by name {
        /// The left node of the base.
        A = "A",
        /// Its right node.
        B = "B",
        /// The left top.
        C = "C",
        /// The right top.
        D = "D",
    }
}

worded! {
    /// A set that the state knows.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Set by name {
        /// The base.
        Base = "base",
        /// The left side.
        Left = "left",
        /// The right side.
        Right = "right",
        /// Both sides, as far as they are known.
        Sides = "sides",
        /// The top edge, whether or not it is there.
        Top = "top",
        /// The edges across the top.
        Crossings = "crossings",
        /// The candidates for the side at hand.
        Candidates = "candidates",
        /// What the last step changed.
        Changed = "changed",
        /// All front segments.
        Front = "front",
        /// The loop of the base, or of the last quadrilateral.
        Loop = "loop",
        /// The edges of the boundary.
        Boundary = "boundary",
        /// The live triangles.
        Live = "live",
        /// The dead quadrilaterals.
        Dead = "dead",
        /// The last quadrilateral.
        New = "new",
        /// What the next step is about.
        Next = "next",
        /// The segments of the seam at hand.
        Corner = "corner",
        /// The slender triangles at the last quadrilateral.
        Slender = "slender",
        /// Nodes without the regular number of elements.
        Irregular = "irregular",
    }
}

/// A node, by number or by letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Point {
    /// By number.
    Node(NodeId),
    /// By letter.
    Letter(Letter),
}

/// A name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// A node.
    Point(Point),
    /// An edge by its ends.
    Edge([Point; 2]),
    /// An element.
    Element(ElementId),
    /// Front segments of a class of table 1.
    Class(u8),
    /// Quadrilaterals of a row from the boundary.
    Level(u16),
    /// A set.
    Set(Set),
}

/// Some names, as they are written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// The names.
    pub names: Vec<Name>,
    /// Their text.
    pub text: String,
}

/// Words that a number follows.
const NUMBERED: [&str; 6] = ["quad", "triangle", "element", "node", "class", "level"];

impl Names {
    /// Reads names; the fault has no place yet.
    ///
    /// # Errors
    /// An unknown name, or none.
    pub fn parse(text: &str) -> Result<Names, Fault> {
        let example = "Write for example base, C D, 12-40 or class 2";
        let mut names = Vec::new();
        let mut words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        while let Some(word) = words.next() {
            let unknown = || {
                let sets = Set::ALL.iter().map(|set| set.name()).chain(NUMBERED);
                let remedy = suggestion(&word.to_lowercase(), sets).unwrap_or_else(|| example.to_owned());
                Fault::new(format!("There is nothing called \"{}\"", shortened(word))).remedy(remedy)
            };
            // A word and its number may be written together: class2.
            let digits = word.find(|c: char| c.is_ascii_digit()).unwrap_or(word.len());
            let (head, tail) = word.split_at(digits);
            if NUMBERED.contains(&head) {
                let number = if tail.is_empty() { words.next() } else { Some(tail) };
                let number = number.and_then(|number| number.parse::<u32>().ok());
                let number = number
                    .ok_or_else(|| Fault::new(format!("A number is missing after \"{head}\"")).remedy(example))?;
                names.push(numbered(head, number).ok_or_else(unknown)?);
                continue;
            }
            let name = match word.split_once(['-', '\u{2013}']) {
                Some((from, to)) => point(from).zip(point(to)).map(|(from, to)| Name::Edge([from, to])),
                None => point(word).map(Name::Point).or_else(|| set(word).map(Name::Set)),
            };
            names.push(name.ok_or_else(unknown)?);
        }
        if names.is_empty() {
            return Err(Fault::new("Nothing is named").remedy(example));
        }
        Ok(Names { names, text: text.trim().to_owned() })
    }
}

fn numbered(word: &str, number: u32) -> Option<Name> {
    Some(match word {
        "node" => Name::Point(Point::Node(NodeId(number))),
        "class" => Name::Class(u8::try_from(number).ok().filter(|class| (1..=4).contains(class))?),
        "level" => Name::Level(u16::try_from(number).ok()?),
        _ => Name::Element(ElementId(number)),
    })
}

fn set(word: &str) -> Option<Set> {
    Set::ALL.into_iter().find(|set| set.name() == word)
}

fn point(word: &str) -> Option<Point> {
    let letter = Letter::ALL.into_iter().find(|letter| letter.name() == word).map(Point::Letter);
    letter.or_else(|| word.parse().ok().map(|n| Point::Node(NodeId(n))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_however_they_are_written() {
        let node = |n| Point::Node(NodeId(n));
        let names = |text: &str| Names::parse(text).unwrap().names;
        assert_eq!(names("C D"), [Name::Point(Point::Letter(Letter::C)), Name::Point(Point::Letter(Letter::D))]);
        assert_eq!(
            names("base, A-B"),
            [Name::Set(Set::Base), Name::Edge([Point::Letter(Letter::A), Point::Letter(Letter::B)])]
        );
        assert_eq!(
            names("12 12-40 node 3"),
            [Name::Point(node(12)), Name::Edge([node(12), node(40)]), Name::Point(node(3))]
        );
        assert_eq!(names("class 2,class3"), [Name::Class(2), Name::Class(3)]);
        assert_eq!(names("triangle 4 quad7"), [Name::Element(ElementId(4)), Name::Element(ElementId(7))]);
        for text in ["", ",", "class", "class 5", "class x", "E", "1-", "-", "quad -1", "99999999999"] {
            assert!(Names::parse(text).is_err(), "{text}");
        }
        let fault = Names::parse("crossing").unwrap_err().to_string();
        assert!(fault.contains("Did you mean \"crossings\"?"), "{fault}");
    }
}
