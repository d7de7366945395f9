//! Numbers and words out of a buffer of bytes, with the line in every complaint: what all readers stand on.
//!
//! Nothing here allocates. A count that a file announces is checked against the bytes that are left before anybody
//! makes room for it, so that a lying header costs an error and not the memory.

use crate::core::fault::Fault;
use crate::core::progress::Pace;

/// How often a reader tells how far it is, in bytes.
const TELL: usize = 1 << 16;

/// How the numbers of a binary file are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// A place in a buffer, moving forward over words, lines or binary numbers. Where it is watched it tells how far it is; told to end
/// it stands at the end of the file, and whoever watches knows why.
#[derive(Clone)]
pub struct Scanner<'a> {
    name: &'a str,
    bytes: &'a [u8],
    at: usize,
    /// Where the last word, line or number began: complaints name its line.
    last: usize,
    comment: Option<u8>,
    /// Whether there are no lines to speak of.
    binary: bool,
    pace: Option<&'a dyn Pace>,
    /// The length of the whole file.
    whole: usize,
    /// Where it tells next.
    tell: usize,
}

impl<'a> Scanner<'a> {
    /// A scanner at the start of `bytes` (after a byte order mark, if there is one); `name` is how messages call it.
    pub fn new(name: &'a str, bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Scanner { name, bytes, at, last: at, comment: None, binary: false, pace: None, whole: bytes.len(), tell: TELL }
    }

    /// The same scanner, watched.
    #[must_use]
    pub fn watched(mut self, pace: &'a dyn Pace) -> Self {
        self.pace = Some(pace);
        self
    }

    /// Tells how far it is, now and then.
    #[inline]
    fn go_on(&mut self) {
        if self.at >= self.tell {
            self.tell = self.at + TELL;
            if self.pace.is_some_and(|pace| !pace.goes_on(self.at, self.whole)) {
                self.at = self.bytes.len();
            }
        }
    }

    /// The same scanner, to which words that begin with `mark` are comments up to the end of their line.
    #[must_use]
    pub fn with_comments(mut self, mark: u8) -> Self {
        self.comment = Some(mark);
        self
    }

    /// From now on complaints count bytes instead of lines.
    pub fn set_binary(&mut self) {
        self.binary = true;
    }

    /// How messages call the file.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// How many bytes are left.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Where the last word, line or number began, for [`Scanner::fault_at`].
    pub fn mark(&self) -> usize {
        self.last
    }

    /// A complaint about the last word, line or number.
    pub fn fault(&self, what: impl Into<String>) -> Fault {
        self.fault_at(self.last, what)
    }

    /// A complaint about what stands at a mark. Lines are counted only now: who reads a good file pays nothing.
    pub fn fault_at(&self, mark: usize, what: impl Into<String>) -> Fault {
        if self.binary {
            return Fault::new(what).at(format!("{}, byte {mark}", self.name));
        }
        let line = 1 + self.bytes[..mark.min(self.bytes.len())].iter().filter(|&&b| b == b'\n').count();
        Fault::new(what).at(format!("{}, line {line}", self.name))
    }

    fn skip_space(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte.is_ascii_whitespace() {
                self.at += 1;
            } else if Some(byte) == self.comment {
                self.at += self.bytes[self.at..].iter().position(|&b| b == b'\n').unwrap_or(self.left());
            } else {
                break;
            }
        }
    }

    /// The next word, on this line or a later one.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        self.go_on();
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.last = self.at;
        self.at += long;
        (long > 0).then(|| &rest[..long])
    }

    /// The next word without moving.
    pub fn peek(&self) -> Option<&'a [u8]> {
        self.clone().word()
    }

    /// The rest of this line, without the space around it, and on to the next one; `None` at the end.
    pub fn line(&mut self) -> Option<&'a [u8]> {
        self.go_on();
        if self.left() == 0 {
            return None;
        }
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.last = self.at;
        self.at += (long + 1).min(rest.len());
        Some(rest[..long].trim_ascii())
    }

    /// A scanner over what stands before the next `end` (or all of the rest), which is where this one goes.
    pub fn part_before(&mut self, end: u8) -> Scanner<'a> {
        let mut part = self.clone();
        let long = self.bytes[self.at..].iter().position(|&b| b == end).unwrap_or(self.left());
        self.at += long;
        part.bytes = &self.bytes[..self.at];
        part
    }

    /// What stands before the next `end`, and on behind it; `None` when there is none.
    pub fn until(&mut self, end: u8) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let long = rest.iter().position(|&b| b == end)?;
        self.last = self.at;
        self.at += long + 1;
        Some(&rest[..long])
    }

    /// Moves behind the next `needle`; says whether there was one.
    pub fn skip_past(&mut self, needle: &[u8]) -> bool {
        self.go_on();
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

    fn ended(&self, what: &str) -> Fault {
        self.fault_at(self.bytes.len(), format!("The file ends where {what} is expected"))
            .remedy("It seems to be cut off: write it again")
    }

    fn unlike(&self, word: &[u8], what: &str) -> Fault {
        self.fault(format!("\"{}\" stands where {what} is expected", shown(word)))
    }

    /// The next word, which must be there.
    ///
    /// # Errors
    /// At the end of the file.
    pub fn need(&mut self, what: &str) -> Result<&'a [u8], Fault> {
        self.word().ok_or_else(|| self.ended(what))
    }

    /// The next word as an integer.
    ///
    /// # Errors
    /// When it is none, or at the end.
    pub fn integer(&mut self, what: &str) -> Result<i64, Fault> {
        let word = self.need(what)?;
        parse_integer(word).ok_or_else(|| self.unlike(word, what))
    }

    /// The next word as a number of things or a tag, not negative.
    ///
    /// # Errors
    /// When it is none, or at the end.
    pub fn whole(&mut self, what: &str) -> Result<u64, Fault> {
        let word = self.need(what)?;
        parse_integer(word).and_then(|n| u64::try_from(n).ok()).ok_or_else(|| self.unlike(word, what))
    }

    /// The next word as a count of things that take `least` bytes each, at least.
    ///
    /// # Errors
    /// When that is more than the file has left.
    pub fn count(&mut self, what: &str, least: usize) -> Result<usize, Fault> {
        let count = self.whole(what)?;
        self.fits(count, least, what)
    }

    /// `count` as an index, if so many things of `least` bytes each can still come.
    ///
    /// # Errors
    /// When that is more than the file has left.
    pub fn fits(&self, count: u64, least: usize, what: &str) -> Result<usize, Fault> {
        // The last word of a file needs no space behind it.
        let room = (self.left() as u64 + 1) / least.max(1) as u64;
        // Half-edges are numbered by 32 bits, four to an element.
        if count > room || count >= 1 << 30 {
            return Err(self
                .fault(format!("{count} as {what} is more than the file can hold"))
                .remedy("It is cut off or damaged: write it again"));
        }
        Ok(count as usize)
    }

    /// The next word as a number of any kind, exactly rounded.
    ///
    /// # Errors
    /// When it is none, or at the end.
    pub fn real(&mut self, what: &str) -> Result<f64, Fault> {
        let word = self.need(what)?;
        parse_real(word).ok_or_else(|| self.unlike(word, what))
    }

    /// The next word as a number of any kind, where there is one.
    ///
    /// # Errors
    /// When it is no number.
    pub fn real_if_any(&mut self) -> Result<Option<f64>, Fault> {
        let Some(word) = self.word() else { return Ok(None) };
        parse_real(word).map(Some).ok_or_else(|| self.unlike(word, "a number"))
    }

    /// The next word as a finite number.
    ///
    /// # Errors
    /// When it is none, not finite, or at the end.
    pub fn finite(&mut self, what: &str) -> Result<f64, Fault> {
        let value = self.real(what)?;
        self.must_be_finite(value, what)
    }

    /// `value` back, unless it is infinite or not a number.
    ///
    /// # Errors
    /// When it is.
    pub fn must_be_finite(&self, value: f64, what: &str) -> Result<f64, Fault> {
        if value.is_finite() { Ok(value) } else { Err(self.fault(format!("{value} stands where {what} is expected"))) }
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Fault> {
        self.go_on();
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(chunk) => {
                self.last = self.at;
                self.at += N;
                Ok(*chunk)
            }
            None => Err(self.ended(what)),
        }
    }

    /// The next four bytes as an integer.
    ///
    /// # Errors
    /// At the end.
    pub fn binary_i32(&mut self, order: ByteOrder, what: &str) -> Result<i32, Fault> {
        let bytes = self.take(what)?;
        Ok(if order == ByteOrder::Little { i32::from_le_bytes(bytes) } else { i32::from_be_bytes(bytes) })
    }

    /// The next eight bytes as a number that is not negative.
    ///
    /// # Errors
    /// At the end.
    pub fn binary_u64(&mut self, order: ByteOrder, what: &str) -> Result<u64, Fault> {
        let bytes = self.take(what)?;
        Ok(if order == ByteOrder::Little { u64::from_le_bytes(bytes) } else { u64::from_be_bytes(bytes) })
    }

    /// The next eight bytes as a real number.
    ///
    /// # Errors
    /// At the end.
    pub fn binary_f64(&mut self, order: ByteOrder, what: &str) -> Result<f64, Fault> {
        let bytes = self.take(what)?;
        Ok(if order == ByteOrder::Little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    }
}

/// A word of a file, fit for a message: at most 40 characters, nothing that a terminal would act on.
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
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, word),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0i64;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value.checked_mul(10)?.checked_add(i64::from(digit - b'0'))?;
    }
    Some(if negative { -value } else { value })
}

/// A real number, correctly rounded, or `None`.
pub fn parse_real(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complaint_names_the_file_and_the_line_of_the_word() {
        let mut s = Scanner::new("a.msh", b"one\n\n  two 3x\n");
        s.word();
        s.word();
        let fault = s.integer("a count").unwrap_err();
        assert_eq!(fault.to_string(), "a.msh, line 3: \"3x\" stands where a count is expected.");
        assert!(s.real("a number").unwrap_err().to_string().contains("line 4: The file ends"));
    }

    #[test]
    fn a_count_that_the_file_cannot_hold_is_refused_before_anything_is_made() {
        let mut s = Scanner::new("a", b"18446744073709551615 1 2 3");
        assert!(s.count("a number of nodes", 2).is_err());
        let mut s = Scanner::new("a", b"4 1 2 3");
        assert!(s.count("a number of nodes", 2).is_err());
        let mut s = Scanner::new("a", b"3 1 2 3");
        assert_eq!(s.count("a number of nodes", 2).unwrap(), 3);
    }

    #[test]
    fn numbers_come_back_to_the_last_bit_and_infinite_ones_are_refused() {
        let mut s = Scanner::new("a", b"0.1 1e-300 -2.2250738585072014e-308 nan 1e999");
        assert_eq!(s.finite("x").unwrap().to_bits(), 0.1f64.to_bits());
        assert_eq!(s.finite("x").unwrap().to_bits(), 1e-300f64.to_bits());
        assert_eq!(s.finite("x").unwrap().to_bits(), (-2.2250738585072014e-308f64).to_bits());
        assert!(s.finite("x").is_err());
        assert!(s.finite("x").is_err());
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
    fn binary_numbers_are_read_in_both_orders() {
        let mut s = Scanner::new("a", &[1, 0, 0, 0, 0, 0, 0, 1, 9]);
        assert_eq!(s.binary_i32(ByteOrder::Little, "x").unwrap(), 1);
        assert_eq!(s.binary_i32(ByteOrder::Big, "x").unwrap(), 1);
        assert!(s.binary_f64(ByteOrder::Big, "x").is_err());
    }
}
