//! The scanner under all readers: words and numbers from a buffer of bytes, with the line number in every fault. Lines
//! end with LF, CR LF or CR.
//!
//! Nothing here allocates. A count declared by a file is checked against the remaining bytes before memory is reserved
//! for it, so that a wrong header gives an error instead of exhausting memory.

use crate::core::fault::Fault;
use crate::core::progress::Pace;

/// Bytes between two reports of progress.
const REPORT_EVERY: usize = 1 << 16;

/// The remedy for a file that ends too early.
pub const TRUNCATED: &str = "The file seems to be truncated: export it again";
/// The remedy for a file that contradicts itself.
pub const DAMAGED: &str = "The file seems to be damaged: export it again";

/// Byte order of the numbers in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// A cursor that moves forward through a buffer over words, lines or binary numbers. Given a [`Pace`], it reports
/// progress; when cancelled, it jumps to the end of the file.
#[derive(Clone)]
pub struct Scanner<'a> {
    name: &'a str,
    bytes: &'a [u8],
    at: usize,
    /// Start of the last word, line or number, for faults.
    last: usize,
    comment: Option<u8>,
    /// Whether faults give a byte offset instead of a line.
    binary: bool,
    pace: Option<&'a dyn Pace>,
    /// Length of the file in bytes.
    whole: usize,
    /// Offset of the next report of progress.
    report_at: usize,
}

impl<'a> Scanner<'a> {
    /// A scanner at the start of `bytes` (after a byte order mark, if any); `name` is the file's name in messages.
    pub fn new(name: &'a str, bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Scanner {
            name,
            bytes,
            at,
            last: at,
            comment: None,
            binary: false,
            pace: None,
            whole: bytes.len(),
            report_at: REPORT_EVERY,
        }
    }

    /// Enables progress and cancellation.
    #[must_use]
    pub fn watched(mut self, pace: &'a dyn Pace) -> Self {
        self.pace = Some(pace);
        self
    }

    /// Reports progress when due; when cancelled, jumps to the end.
    #[inline]
    fn check_pace(&mut self) {
        if self.at >= self.report_at {
            self.report_at = self.at + REPORT_EVERY;
            if self.pace.is_some_and(|pace| !pace.goes_on(self.at, self.whole)) {
                self.at = self.bytes.len();
                self.report_at = usize::MAX;
            }
        }
    }

    /// Treats a word that starts with `mark` as a comment up to the end of its line.
    #[must_use]
    pub fn with_comments(mut self, mark: u8) -> Self {
        self.comment = Some(mark);
        self
    }

    /// From now on, faults give a byte offset instead of a line.
    pub fn set_binary(&mut self) {
        self.binary = true;
    }

    /// The file's name in messages.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Number of bytes left.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Start of the last word, line or number, for [`Scanner::fault_at`].
    pub fn mark(&self) -> usize {
        self.last
    }

    /// A fault at the last word, line or number.
    pub fn fault(&self, what: impl Into<String>) -> Fault {
        self.fault_at(self.last, what)
    }

    /// A fault at a mark. Lines are counted only here, so that reading a valid file does not pay for it.
    pub fn fault_at(&self, mark: usize, what: impl Into<String>) -> Fault {
        if self.binary {
            return Fault::new(what).at(format!("{}, byte {mark}", self.name));
        }
        let before = &self.bytes[..mark.min(self.bytes.len())];
        let ends = before.iter().zip(before.iter().skip(1).chain([&0]));
        let line = 1 + ends.filter(|(b, next)| **b == b'\n' || (**b == b'\r' && **next != b'\n')).count();
        Fault::new(what).at(format!("{}, line {line}", self.name))
    }

    /// The fault of the last word, `found` where `expected` ("a coordinate") must be.
    pub fn unexpected(&self, found: &[u8], expected: &str) -> Fault {
        self.fault(format!("Expected {expected}, found \"{}\"", shown(found)))
    }

    fn skip_space(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte.is_ascii_whitespace() {
                self.at += 1;
            } else if Some(byte) == self.comment {
                self.at += self.bytes[self.at..].iter().position(ends_line).unwrap_or(self.left());
            } else {
                break;
            }
        }
    }

    /// The next word, on this line or a later one; `None` at the end.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        self.check_pace();
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.last = self.at;
        self.at += long;
        (long > 0).then(|| &rest[..long])
    }

    /// Moves back by one byte.
    pub fn step_back(&mut self) {
        self.at -= 1;
    }

    /// The next word without moving, and so without a report of progress.
    pub fn peek(&self) -> Option<&'a [u8]> {
        Scanner { pace: None, ..self.clone() }.word()
    }

    /// The rest of this line, trimmed; moves to the next line. `None` at the end.
    pub fn line(&mut self) -> Option<&'a [u8]> {
        self.check_pace();
        if self.left() == 0 {
            return None;
        }
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(ends_line).unwrap_or(rest.len());
        self.last = self.at;
        self.at += (long + if rest[long..].starts_with(b"\r\n") { 2 } else { 1 }).min(rest.len());
        Some(rest[..long].trim_ascii())
    }

    /// The next line that is not blank, likewise.
    pub fn filled_line(&mut self) -> Option<&'a [u8]> {
        loop {
            let line = self.line()?;
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// A scanner over everything before the next `end` (or the whole rest); this scanner moves there.
    pub fn part_before(&mut self, end: u8) -> Scanner<'a> {
        let mut part = self.clone();
        let long = self.bytes[self.at..].iter().position(|&b| b == end).unwrap_or(self.left());
        self.at += long;
        part.bytes = &self.bytes[..self.at];
        part
    }

    /// Everything before the next `end`; moves past it. `None` without one.
    pub fn until(&mut self, end: u8) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(|&b| b == end)?;
        self.last = self.at;
        self.at += long + 1;
        Some(&rest[..long])
    }

    /// Moves past the next `needle`; returns whether there is one.
    pub fn skip_past(&mut self, needle: &[u8]) -> bool {
        self.check_pace();
        let Some((&first, _)) = needle.split_first() else { return true };
        let mut from = self.at;
        while let Some(step) = self.bytes[from..].iter().position(|&b| b == first) {
            if self.bytes[from + step..].starts_with(needle) {
                self.last = from + step;
                self.at = from + step + needle.len();
                return true;
            }
            from += step + 1;
        }
        false
    }

    /// The fault of a file that ends where `expected` must be.
    pub fn ended(&self, expected: &str) -> Fault {
        self.fault_at(self.bytes.len(), format!("Expected {expected}, found the end of the file")).remedy(TRUNCATED)
    }

    /// The next word, which is required.
    ///
    /// # Errors
    /// The end of the file.
    pub fn need(&mut self, what: &str) -> Result<&'a [u8], Fault> {
        self.word().ok_or_else(|| self.ended(what))
    }

    /// The next word as an integer.
    ///
    /// # Errors
    /// Another word, or the end of the file.
    pub fn integer(&mut self, what: &str) -> Result<i64, Fault> {
        let word = self.need(what)?;
        parse_integer(word).ok_or_else(|| self.unexpected(word, what))
    }

    /// The next word as a non-negative integer.
    ///
    /// # Errors
    /// Another word, or the end of the file.
    pub fn whole(&mut self, what: &str) -> Result<u64, Fault> {
        let word = self.need(what)?;
        parse_whole(word).ok_or_else(|| self.unexpected(word, what))
    }

    /// The next word as a count of items of at least `least` bytes each.
    ///
    /// # Errors
    /// As [`Scanner::whole`], and a count that the rest of the file cannot hold.
    pub fn count(&mut self, what: &str, least: usize) -> Result<usize, Fault> {
        let count = self.whole(what)?;
        self.fits(count, least, what)
    }

    /// `count` as an index, if the rest of the file can hold that many items of `least` bytes each.
    ///
    /// # Errors
    /// A count that the rest of the file cannot hold.
    pub fn fits(&self, count: u64, least: usize, what: &str) -> Result<usize, Fault> {
        // The last word of a file needs no space after it.
        let room = (self.left() as u64 + 1) / least.max(1) as u64;
        // Half-edges have 32-bit numbers, four for each element.
        if count > room || count >= 1 << 30 {
            return Err(self.fault(format!("{count} as {what} is more than the file can hold")).remedy(DAMAGED));
        }
        Ok(count as usize)
    }

    /// The next word as a number, correctly rounded, possibly infinite or NaN.
    ///
    /// # Errors
    /// Another word, or the end of the file.
    pub fn real(&mut self, what: &str) -> Result<f64, Fault> {
        let word = self.need(what)?;
        parse_real(word).ok_or_else(|| self.unexpected(word, what))
    }

    /// As [`Scanner::real`], or `None` at the end.
    ///
    /// # Errors
    /// Another word.
    pub fn real_if_any(&mut self) -> Result<Option<f64>, Fault> {
        let Some(word) = self.word() else { return Ok(None) };
        parse_real(word).map(Some).ok_or_else(|| self.unexpected(word, "a number"))
    }

    /// The next word as a finite number.
    ///
    /// # Errors
    /// Another word, a number that is not finite, or the end of the file.
    pub fn finite(&mut self, what: &str) -> Result<f64, Fault> {
        let value = self.real(what)?;
        self.must_be_finite(value, what)
    }

    /// A word of the last line as a finite coordinate.
    ///
    /// # Errors
    /// Another word, or a number that is not finite.
    pub fn coordinate(&self, word: &[u8]) -> Result<f64, Fault> {
        parse_real(word).filter(|x| x.is_finite()).ok_or_else(|| self.unexpected(word, "a coordinate"))
    }

    /// `value`, if it is finite.
    ///
    /// # Errors
    /// An infinite or NaN value.
    pub fn must_be_finite(&self, value: f64, what: &str) -> Result<f64, Fault> {
        if value.is_finite() { Ok(value) } else { Err(self.fault(format!("Expected {what}, found {value}"))) }
    }

    /// The next `N` bytes, in little-endian order.
    ///
    /// # Errors
    /// The end of the file.
    pub fn take<const N: usize>(&mut self, order: ByteOrder, what: &str) -> Result<[u8; N], Fault> {
        self.check_pace();
        let mut bytes = *self.bytes[self.at..].first_chunk::<N>().ok_or_else(|| self.ended(what))?;
        self.last = self.at;
        self.at += N;
        if order == ByteOrder::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

fn ends_line(byte: &u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// A word of a file for a message: at most 40 characters, without control characters.
pub fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(160)]);
    let mut out: String = text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect();
    if text.chars().count() > 40 || word.len() > 160 {
        out.push_str("...");
    }
    out
}

/// A decimal integer with an optional sign, or `None`.
pub fn parse_integer(word: &[u8]) -> Option<i64> {
    // Without the least number, which has no absolute value.
    std::str::from_utf8(word).ok()?.parse().ok().filter(|&value| value != i64::MIN)
}

/// A non-negative decimal integer, or `None`.
pub fn parse_whole(word: &[u8]) -> Option<u64> {
    parse_integer(word).and_then(|value| u64::try_from(value).ok())
}

/// A real number, correctly rounded, or `None`.
pub fn parse_real(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_names_the_file_and_the_line_of_the_word() {
        let mut s = Scanner::new("a.msh", b"one\n\n  two 3x\n");
        s.word();
        s.word();
        let fault = s.integer("a count").unwrap_err();
        assert_eq!(fault.to_string(), "a.msh, line 3: Expected a count, found \"3x\".");
        assert!(s.real("a number").unwrap_err().to_string().contains("line 4: Expected a number, found the end"));
    }

    #[test]
    fn a_count_that_the_file_cannot_hold_is_refused() {
        let count = |text: &str| Scanner::new("a", text.as_bytes()).count("a number of nodes", 2).ok();
        assert_eq!(["18446744073709551615 1 2 3", "4 1 2 3", "3 1 2 3"].map(count), [None, None, Some(3)]);
    }

    #[test]
    fn numbers_are_read_exactly_and_infinite_ones_are_refused() {
        let mut s = Scanner::new("a", b"0.1 1e-300 -2.2250738585072014e-308 nan 1e999");
        for expected in [0.1f64, 1e-300, -2.2250738585072014e-308] {
            assert_eq!(s.finite("x").unwrap().to_bits(), expected.to_bits());
        }
        assert!(s.finite("x").is_err() && s.finite("x").is_err());
    }

    #[test]
    fn lines_words_and_comments_follow_each_other() {
        let mut s = Scanner::new("a", b"\xef\xbb\xbfa # b c\r\nd \"e f\" \n$End\nx").with_comments(b'#');
        assert_eq!(s.word(), Some(&b"a"[..]));
        assert_eq!(s.word(), Some(&b"d"[..]));
        assert_eq!(s.line(), Some(&b"\"e f\""[..]));
        assert!(s.skip_past(b"$End"));
        assert_eq!(s.line(), Some(&b""[..]));
        assert_eq!(s.peek(), Some(&b"x"[..]));
        assert_eq!(s.line(), Some(&b"x"[..]));
        assert_eq!(s.line(), None);
    }

    #[test]
    fn lines_end_with_lf_cr_or_both() {
        for end in ["\n", "\r\n", "\r"] {
            let text = ["one # two", "", "# three", "4x", ""].join(end);
            let mut s = Scanner::new("a", text.as_bytes());
            assert_eq!(s.line(), Some(&b"one # two"[..]));
            assert_eq!(s.line(), Some(&b""[..]));
            let mut s = Scanner::new("a", text.as_bytes()).with_comments(b'#');
            assert_eq!(s.word(), Some(&b"one"[..]));
            assert!(s.integer("a count").unwrap_err().to_string().starts_with("a, line 4: "), "{end:?}");
            assert_eq!(s.word(), None);
        }
    }

    #[test]
    fn binary_numbers_are_read_in_both_orders() {
        let mut s = Scanner::new("a", &[1, 0, 0, 0, 0, 0, 0, 1, 9]);
        assert_eq!(s.take(ByteOrder::Little, "x").map(i32::from_le_bytes), Ok(1));
        assert_eq!(s.take(ByteOrder::Big, "x").map(i32::from_le_bytes), Ok(1));
        assert!(s.take(ByteOrder::Big, "x").map(f64::from_le_bytes).is_err());
    }
}
