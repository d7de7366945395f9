//! The clear text of a STEP file (ISO 10303-21): an index of its instances. Each is parsed when it is asked for, so
//! that damage where nobody looks does no harm, and memory stays within a few times the file.
//!
//! Deliberately absent: what instances mean, sections of references to other files, and schemas. Our own reader, since
//! `ruststep` 0.4 refuses empty lists, loses the place of an error and overflows its stack on deep lists
//! (docs/experiments.md, "Readers of STEP").

use crate::core::fault::Fault;
use crate::core::progress::Pace;

/// The deepest list of lists that is read; nets of control points have two levels.
const DEEPEST: usize = 16;
/// Bytes between two reports of progress.
const REPORT_EVERY: usize = 1 << 18;

/// A parameter of an instance.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    /// `$`, or `*` where it follows from another one.
    Absent,
    /// A number, integer or real.
    Number(f64),
    /// Text between quotes, as it stands in the file.
    Text(&'a [u8]),
    /// An enumeration, without its dots; `T` and `F` are true and false.
    Word(&'a str),
    /// A reference to an instance.
    Instance(u64),
    /// A list.
    List(Vec<Value<'a>>),
    /// A value with its type: `LENGTH_MEASURE(1.)`.
    Typed(&'a str, Vec<Value<'a>>),
}

/// An instance: one record, or several of a complex instance, each with its keyword.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Instance<'a> {
    /// Its number.
    pub id: u64,
    /// Keyword and parameters of each record.
    pub records: Vec<(&'a str, Vec<Value<'a>>)>,
}

impl<'a> Instance<'a> {
    /// Its keyword; of a complex instance all of them.
    pub fn keyword(&self) -> String {
        self.records.iter().map(|record| record.0).collect::<Vec<_>>().join(" ")
    }

    /// Whether one of its records has the keyword.
    pub fn is(&self, keyword: &str) -> bool {
        self.records.iter().any(|record| record.0 == keyword)
    }
}

/// An opened file.
pub(super) struct Exchange<'a> {
    name: &'a str,
    text: &'a [u8],
    /// Number and first byte after `=` of each instance, ascending by number.
    index: Vec<(u64, usize)>,
    /// The words of its FILE_SCHEMA.
    pub schema: String,
}

impl<'a> Exchange<'a> {
    /// Indexes a file; `name` is its name in messages.
    ///
    /// # Errors
    /// A file that is no STEP file, is cut off, or has two instances of a number; [`Fault::stopped`].
    pub fn open(name: &'a str, text: &'a [u8], pace: &dyn Pace) -> Result<Exchange<'a>, Fault> {
        let mut exchange = Exchange { name, text, index: Vec::new(), schema: String::new() };
        let mut reader = Reader { text, at: if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 } };
        let (mut is_first, mut has_ended, mut report_at) = (true, false, REPORT_EVERY);
        while let Some(start) = reader.statement() {
            if reader.at >= report_at {
                report_at = reader.at + REPORT_EVERY;
                if !pace.goes_on(reader.at, text.len()) {
                    return Err(Fault::stopped());
                }
            }
            let statement = &text[start..reader.at];
            if is_first && !statement.starts_with(b"ISO-10303-21") {
                return Err(exchange
                    .fault(start, "This is not a STEP file: it does not begin with ISO-10303-21")
                    .remedy(if statement.starts_with(b"PK") || statement.starts_with(b"\x1f\x8b") {
                        "It is compressed: unpack it first"
                    } else {
                        "Export the model as STEP (AP203, AP214 or AP242) in clear text"
                    }));
            }
            is_first = false;
            if let Some(rest) = statement.strip_prefix(b"#") {
                let mut own = Reader { text: rest, at: 0 };
                let id = own.digits();
                own.skip();
                match (id, own.take(b'=')) {
                    (Some(id), true) => exchange.index.push((id, start + 1 + own.at)),
                    _ => return Err(exchange.fault(start, "An instance has no number or no =").remedy(super::DAMAGED)),
                }
            } else if statement.starts_with(b"FILE_SCHEMA") {
                exchange.schema = schema(statement);
            } else if statement.starts_with(b"END-ISO-10303-21") {
                has_ended = true;
                break;
            }
        }
        pace.cancel().check()?;
        if !has_ended {
            return Err(exchange.fault(text.len(), "The file is cut off").remedy("Export it again"));
        }
        exchange.index.sort_unstable();
        if let Some(w) = exchange.index.windows(2).find(|w| w[0].0 == w[1].0) {
            return Err(exchange.fault(w[1].1, format!("#{} occurs twice", w[0].0)).remedy(super::DAMAGED));
        }
        Ok(exchange)
    }

    /// The numbers of all instances whose text begins with one of the keywords, ascending; complex ones are left out.
    pub fn of_keywords(&self, keywords: &[&str]) -> Vec<u64> {
        let is_one = |&&(_, at): &&(u64, usize)| {
            let mut reader = Reader { text: self.text, at };
            reader.skip();
            reader.word().is_some_and(|word| keywords.contains(&word))
        };
        self.index.iter().filter(is_one).map(|entry| entry.0).collect()
    }

    /// The instance of a number.
    ///
    /// # Errors
    /// One that does not exist or cannot be parsed.
    pub fn instance(&self, id: u64) -> Result<Instance<'a>, Fault> {
        let found = self.index.binary_search_by_key(&id, |entry| entry.0);
        let Ok(k) = found else {
            return Err(Fault::new(format!("#{id} does not exist")).at(self.name).remedy(super::DAMAGED));
        };
        let mut reader = Reader { text: self.text, at: self.index[k].1 };
        let wrong = |reader: &Reader<'_>| {
            self.fault(reader.at, format!("#{id} cannot be read")).remedy("Correct the line, or export the file again")
        };
        let mut records = Vec::new();
        reader.skip();
        if reader.take(b'(') {
            loop {
                reader.skip();
                if reader.take(b')') {
                    break;
                }
                let record = reader.record();
                records.push(record.ok_or_else(|| wrong(&reader))?);
            }
        } else {
            let record = reader.record();
            records.push(record.ok_or_else(|| wrong(&reader))?);
        }
        reader.skip();
        if records.is_empty() || !reader.take(b';') {
            return Err(wrong(&reader));
        }
        Ok(Instance { id, records })
    }

    /// A fault at the line of an instance.
    pub fn fault_at(&self, id: u64, what: impl Into<String>) -> Fault {
        match self.index.binary_search_by_key(&id, |entry| entry.0) {
            Ok(k) => self.fault(self.index[k].1, what),
            Err(_) => Fault::new(what).at(self.name),
        }
    }

    fn fault(&self, at: usize, what: impl Into<String>) -> Fault {
        let line = 1 + self.text[..at.min(self.text.len())].iter().filter(|&&b| b == b'\n').count();
        Fault::new(what).at(format!("{}, line {line}", self.name))
    }
}

/// The first schema of a FILE_SCHEMA statement.
fn schema(statement: &[u8]) -> String {
    let first = statement.split(|&b| b == b'\'').nth(1).unwrap_or_default();
    String::from_utf8_lossy(first).trim().to_owned()
}

/// A cursor.
struct Reader<'a> {
    text: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Moves past a byte, if it is next.
    fn take(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        self.at += usize::from(is_next);
        is_next
    }

    /// Moves past white space and comments.
    fn skip(&mut self) {
        loop {
            match self.peek() {
                Some(b) if b.is_ascii_whitespace() || b == 0 => self.at += 1,
                Some(b'/') if self.text.get(self.at + 1) == Some(&b'*') => self.comment(),
                // Print control directives.
                Some(b'\\') if matches!(self.text.get(self.at + 1..self.at + 3), Some(b"N\\" | b"F\\")) => self.at += 3,
                _ => return,
            }
        }
    }

    fn comment(&mut self) {
        let rest = &self.text[self.at + 2..];
        let end = rest.windows(2).position(|w| w == b"*/").map_or(rest.len(), |end| end + 2);
        self.at = (self.at + 2 + end).min(self.text.len());
    }

    /// Moves past the next statement and its semicolon; returns its first byte. `None` without a further one.
    fn statement(&mut self) -> Option<usize> {
        self.skip();
        let start = self.at;
        while let Some(byte) = self.peek() {
            self.at += 1;
            match byte {
                b';' => return Some(start),
                b'\'' | b'"' => {
                    let rest = &self.text[self.at..];
                    self.at += rest.iter().position(|&b| b == byte).map_or(rest.len(), |end| end + 1);
                }
                b'/' if self.peek() == Some(b'*') => {
                    self.at -= 1;
                    self.comment();
                }
                _ => {}
            }
        }
        None
    }

    fn digits(&mut self) -> Option<u64> {
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_digit()) {
            self.at += 1;
        }
        std::str::from_utf8(&self.text[start..self.at]).ok()?.parse().ok()
    }

    /// A keyword or the word of an enumeration.
    fn word(&mut self) -> Option<&'a str> {
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'!') {
            self.at += 1;
        }
        std::str::from_utf8(&self.text[start..self.at]).ok().filter(|word| !word.is_empty())
    }

    fn record(&mut self) -> Option<(&'a str, Vec<Value<'a>>)> {
        let keyword = self.word()?;
        self.skip();
        if !self.take(b'(') {
            return None;
        }
        Some((keyword, self.values(DEEPEST)?))
    }

    /// Values up to the closing parenthesis.
    fn values(&mut self, depth: usize) -> Option<Vec<Value<'a>>> {
        let mut values = Vec::new();
        self.skip();
        if self.take(b')') {
            return Some(values);
        }
        loop {
            self.skip();
            values.push(self.value(depth.checked_sub(1)?)?);
            self.skip();
            if self.take(b')') {
                return Some(values);
            }
            if !self.take(b',') {
                return None;
            }
        }
    }

    fn value(&mut self, depth: usize) -> Option<Value<'a>> {
        match self.peek()? {
            b'$' | b'*' => {
                self.at += 1;
                Some(Value::Absent)
            }
            b'#' => {
                self.at += 1;
                self.digits().map(Value::Instance)
            }
            b'(' => {
                self.at += 1;
                self.values(depth).map(Value::List)
            }
            b'.' if !self.text.get(self.at + 1).is_some_and(u8::is_ascii_digit) => {
                self.at += 1;
                let word = self.word()?;
                self.take(b'.').then_some(Value::Word(word))
            }
            quote @ (b'\'' | b'"') => {
                self.at += 1;
                let start = self.at;
                loop {
                    let rest = &self.text[self.at..];
                    self.at += rest.iter().position(|&b| b == quote)? + 1;
                    // A doubled quote stands for one.
                    if !self.take(quote) {
                        return Some(Value::Text(&self.text[start..self.at - 1]));
                    }
                }
            }
            b if b.is_ascii_alphabetic() || b == b'!' => {
                let word = self.word()?;
                self.skip();
                if !self.take(b'(') {
                    return None;
                }
                Some(Value::Typed(word, self.values(depth)?))
            }
            _ => {
                let start = self.at;
                while self.peek().is_some_and(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.')) {
                    self.at += 1;
                }
                std::str::from_utf8(&self.text[start..self.at]).ok()?.parse().ok().map(Value::Number)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::progress::{Nobody, Reading};

    fn opened(data: &str, then: impl FnOnce(Result<Exchange<'_>, Fault>)) {
        let text = format!("ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AP214 {{ 1 0 }}'));\nENDSEC;\nDATA;\n{data}");
        then(Exchange::open("part.step", text.as_bytes(), &Reading::watched(&mut Nobody)));
    }

    const END: &str = "ENDSEC;\nEND-ISO-10303-21;\n";

    #[test]
    fn instances_are_parsed_with_all_kinds_of_values() {
        let data = "#2 = A('it''s; /* no */',#1,.T.,$,*,(1,-2.5E-3,()),LENGTH_MEASURE(1.)); /* ; #7=B(); */\n\
                    #1=(B(1.)C('')\n/* between */D());";
        opened(&format!("{data}{END}"), |exchange| {
            let exchange = exchange.unwrap();
            assert_eq!((exchange.index.len(), exchange.schema.as_str()), (2, "AP214 { 1 0 }"));
            let a = exchange.instance(2).unwrap();
            let list = Value::List(vec![Value::Number(1.0), Value::Number(-2.5e-3), Value::List(Vec::new())]);
            let expected = [
                Value::Text(b"it''s; /* no */"),
                Value::Instance(1),
                Value::Word("T"),
                Value::Absent,
                Value::Absent,
                list,
                Value::Typed("LENGTH_MEASURE", vec![Value::Number(1.0)]),
            ];
            assert_eq!(a.records[0].1, expected);
            let complex = exchange.instance(1).unwrap();
            assert_eq!(complex.keyword(), "B C D");
            assert!(complex.is("D") && complex.records[0].1 == [Value::Number(1.0)]);
            assert_eq!(exchange.of_keywords(&["A"]), [2]);
            assert!(exchange.instance(3).unwrap_err().to_string().contains("#3 does not exist"));
        });
    }

    #[test]
    fn damage_is_refused_with_its_line_and_only_where_it_is_looked_at() {
        opened(&format!("#1=A(1);\n#2=B((1);\n{END}"), |exchange| {
            let exchange = exchange.unwrap();
            assert!(exchange.instance(1).is_ok());
            assert!(exchange.instance(2).unwrap_err().to_string().contains("part.step, line 7: #2 cannot be read"));
        });
        let refusal = |data: &str| {
            let mut said = String::new();
            opened(data, |exchange| said = exchange.err().unwrap().to_string());
            said
        };
        assert!(refusal("#1=A(1);\n#2=B(").contains("cut off"));
        assert!(refusal(&format!("#1=A(1);\n#1=B(2);{END}")).contains("#1 occurs twice"));
        assert!(refusal(&format!("# 1=A(1);{END}")).contains("no number"));
        let deep = format!("#1=A({}{});{END}", "(".repeat(100_000), ")".repeat(100_000));
        opened(&deep, |exchange| assert!(exchange.unwrap().instance(1).is_err()));
        let other = Exchange::open("x", b"solid;", &Reading::watched(&mut Nobody));
        assert!(other.err().unwrap().to_string().contains("not a STEP file"));
    }
}
