//! The statements of an OBJ file, a line each: without comments, with the lines that continue them (`\`), whatever ends
//! its lines.

use std::borrow::Cow;

use crate::core::fault::Fault;
use crate::core::formats::scan::{Scanner, shown};

/// The words of a statement: its keyword, then what follows.
pub(super) fn words(statement: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    statement.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Takes an OBJ file apart.
#[derive(Clone)]
pub(super) struct Statements<'a> {
    scanner: Scanner<'a>,
    /// Where the current statement begins.
    mark: usize,
}

impl<'a> Statements<'a> {
    pub fn new(scanner: Scanner<'a>) -> Statements<'a> {
        Statements { scanner, mark: 0 }
    }

    /// The next line with its continuations, without comments; possibly empty. `None` at the end.
    pub fn next(&mut self) -> Option<Cow<'a, [u8]>> {
        let line = without_comment(self.scanner.line()?);
        self.mark = self.scanner.mark();
        let Some(mut part) = line.strip_suffix(b"\\") else { return Some(Cow::Borrowed(line)) };
        let mut whole = part.to_vec();
        while let Some(line) = self.scanner.line().map(without_comment) {
            part = line.strip_suffix(b"\\").unwrap_or(line);
            // Words do not go on in the next line.
            whole.push(b' ');
            whole.extend(part);
            if part.len() == line.len() {
                break;
            }
        }
        Some(Cow::Owned(whole))
    }

    /// Where the current statement begins, for [`Statements::fault_at`].
    pub fn mark(&self) -> usize {
        self.mark
    }

    /// A fault at a mark.
    pub fn fault_at(&self, mark: usize, what: impl Into<String>) -> Fault {
        self.scanner.fault_at(mark, what)
    }

    /// The fault of a word of the current statement, `found` where `expected` ("a coordinate") must be.
    pub fn unexpected(&self, found: &[u8], expected: &str) -> Fault {
        self.fault_at(self.mark, format!("Expected {expected}, found \"{}\"", shown(found)))
    }
}

/// A line up to the first word that begins with `#`.
fn without_comment(line: &[u8]) -> &[u8] {
    let mut from = 0;
    while let Some(step) = line[from..].iter().position(|&b| b == b'#') {
        let at = from + step;
        if at == 0 || line[at - 1].is_ascii_whitespace() {
            return line[..at].trim_ascii_end();
        }
        from = at + 1;
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_go_on_in_further_lines_and_end_before_comments() {
        let text = b"f 1 \\\n 2 \\\r\n\\\n3 # last\n\n# f \\\ng part#2 \\";
        let mut statements = Statements::new(Scanner::new("a", text));
        let mut next = || statements.next().map(|line| String::from_utf8(line.into_owned()).unwrap());
        assert_eq!(next().as_deref(), Some("f 1  2   3"));
        assert_eq!([next(), next()].map(Option::unwrap), ["", ""]);
        assert_eq!(next().as_deref(), Some("g part#2 "));
        assert_eq!(next(), None);
        assert_eq!(statements.fault_at(statements.mark(), "Odd").to_string(), "a, line 7: Odd.");
    }
}
