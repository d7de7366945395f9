//! The numbers of an MSH file, from text or from binary.

use crate::core::fault::Fault;
use crate::core::formats::scan::{ByteOrder, Scanner, parse_integer, shown};

/// Numbers from text or from binary, by what the header says.
pub(super) struct Input<'a> {
    pub scanner: Scanner<'a>,
    pub binary: Option<ByteOrder>,
}

impl Input<'_> {
    /// A C `int`.
    pub fn int(&mut self, what: &str) -> Result<i64, Fault> {
        match self.binary {
            None => self.scanner.integer(what),
            Some(order) => self.scanner.binary_i32(order, what).map(i64::from),
        }
    }

    /// A tag: an `int` that is not negative.
    pub fn tag(&mut self, what: &str) -> Result<u64, Fault> {
        let tag = self.int(what)?;
        u64::try_from(tag).map_err(|_| self.scanner.fault(format!("{tag} stands where {what} is expected")))
    }

    /// A C `size_t`.
    pub fn size(&mut self, what: &str) -> Result<u64, Fault> {
        match self.binary {
            None => self.scanner.whole(what),
            Some(order) => self.scanner.binary_u64(order, what),
        }
    }

    /// A C `double`, which must be finite.
    pub fn finite(&mut self, what: &str) -> Result<f64, Fault> {
        let value = self.real(what)?;
        self.scanner.must_be_finite(value, what)
    }

    pub fn real(&mut self, what: &str) -> Result<f64, Fault> {
        match self.binary {
            None => self.scanner.real(what),
            Some(order) => self.scanner.binary_f64(order, what),
        }
    }

    /// Whether `count` things can still come: of `text` bytes at least in text, of `binary` bytes in binary.
    pub fn fits(&self, count: u64, text: usize, binary: usize, what: &str) -> Result<usize, Fault> {
        self.scanner.fits(count, if self.binary.is_some() { binary } else { text }, what)
    }

    /// The count that stands in text on a line of its own, in binary files of version 2 too.
    pub fn count_line(&mut self, text: usize, binary: usize, what: &str) -> Result<usize, Fault> {
        let line = self.scanner.line().unwrap_or_default();
        let count = parse_integer(line).and_then(|count| u64::try_from(count).ok());
        let Some(count) = count else {
            return Err(self.scanner.fault(format!("\"{}\" stands where {what} is expected", shown(line))));
        };
        self.fits(count, text, binary, what)
    }
}
