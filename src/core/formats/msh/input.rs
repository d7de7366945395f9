//! The numbers of an MSH file, text or binary.

use crate::core::fault::Fault;
use crate::core::formats::scan::{ByteOrder, Scanner, parse_whole};

/// Reads numbers as text or binary, as declared in the header.
pub(super) struct Input<'a> {
    pub scanner: Scanner<'a>,
    pub binary: Option<ByteOrder>,
}

impl Input<'_> {
    /// A C `int`.
    pub fn int(&mut self, what: &str) -> Result<i64, Fault> {
        match self.binary {
            None => self.scanner.integer(what),
            Some(order) => self.scanner.take(order, what).map(|bytes| i32::from_le_bytes(bytes).into()),
        }
    }

    /// A tag: a non-negative `int`.
    pub fn tag(&mut self, what: &str) -> Result<u64, Fault> {
        let tag = self.int(what)?;
        u64::try_from(tag).map_err(|_| self.scanner.fault(format!("Expected {what}, found {tag}")))
    }

    /// A C `size_t`.
    pub fn size(&mut self, what: &str) -> Result<u64, Fault> {
        match self.binary {
            None => self.scanner.whole(what),
            Some(order) => self.scanner.take(order, what).map(u64::from_le_bytes),
        }
    }

    /// A finite C `double`.
    pub fn finite(&mut self, what: &str) -> Result<f64, Fault> {
        let value = self.real(what)?;
        self.scanner.must_be_finite(value, what)
    }

    /// A C `double`.
    pub fn real(&mut self, what: &str) -> Result<f64, Fault> {
        match self.binary {
            None => self.scanner.real(what),
            Some(order) => self.scanner.take(order, what).map(f64::from_le_bytes),
        }
    }

    /// `count` as an index, if the rest of the file can hold that many items of at least `text` or `binary` bytes each.
    pub fn fits(&self, count: u64, text: usize, binary: usize, what: &str) -> Result<usize, Fault> {
        self.scanner.fits(count, if self.binary.is_some() { binary } else { text }, what)
    }

    /// A count as text on its own line, as in version 2, also in binary files.
    pub fn count_line(&mut self, text: usize, binary: usize, what: &str) -> Result<usize, Fault> {
        let line = self.scanner.filled_line().unwrap_or_default();
        let count = parse_whole(line).ok_or_else(|| self.scanner.unexpected(line, what))?;
        self.fits(count, text, binary, what)
    }
}
