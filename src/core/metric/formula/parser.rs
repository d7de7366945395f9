//! The parser of formulas: from text to the graph.

use super::{CONSTANTS, DEEPEST, FUNCTIONS, Graph, Op};
use crate::core::fault::Fault;
use crate::core::kernel::spelling::suggestion;

/// Recursive descent over one expression.
pub(super) struct Parser<'a> {
    name: &'a str,
    text: &'a str,
    at: usize,
    depth: usize,
    graph: &'a mut Graph,
    names: &'a [(&'a str, u32)],
    later: &'a [&'a str],
}

impl<'a> Parser<'a> {
    pub fn parse(
        name: &'a str,
        text: &'a str,
        graph: &'a mut Graph,
        names: &'a [(&'a str, u32)],
        later: &'a [&'a str],
    ) -> Result<u32, Fault> {
        let mut parser = Parser { name, text, at: 0, depth: 0, graph, names, later };
        let value = parser.sum()?;
        match parser.peek() {
            None => Ok(value),
            Some(')') => Err(parser.syntax("a closing parenthesis has no opening one")),
            Some(_) => Err(parser.syntax("an operator is missing")),
        }
    }

    /// A syntax error at the current column.
    fn syntax(&self, what: &str) -> Fault {
        let column = self.text[..self.at].chars().count() + 1;
        Fault::new(format!("{} = \"{}\": {what} at column {column}", self.name, self.text))
    }

    /// The next character that is not white space.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Skips `wanted` if it comes next.
    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    fn sum(&mut self) -> Result<u32, Fault> {
        self.left_associative([('+', Op::Add), ('-', Op::Sub)], |parser| {
            parser.left_associative([('*', Op::Mul), ('/', Op::Div)], Parser::signed)
        })
    }

    /// Operands joined by left-associative operators.
    fn left_associative(
        &mut self,
        operators: [(char, Op); 2],
        operand: impl Fn(&mut Self) -> Result<u32, Fault>,
    ) -> Result<u32, Fault> {
        let mut value = operand(self)?;
        while let Some((_, op)) = operators.into_iter().find(|operator| self.take(operator.0)) {
            let right = operand(self)?;
            value = self.graph.result(op, value, right);
        }
        Ok(value)
    }

    /// Signs bind more loosely than powers: `-x^2` is `-(x^2)`. All recursion passes here, so depth is counted here.
    fn signed(&mut self) -> Result<u32, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.syntax("parentheses, signs or exponents are nested too deeply"));
        }
        let value = if self.take('-') {
            let value = self.signed()?;
            self.graph.result(Op::Neg, value, value)
        } else if self.take('+') {
            self.signed()?
        } else {
            let base = self.primary()?;
            if self.take('^') {
                let exponent = self.signed()?;
                self.graph.result(Op::Pow, base, exponent)
            } else {
                base
            }
        };
        self.depth -= 1;
        Ok(value)
    }

    fn primary(&mut self) -> Result<u32, Fault> {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                let value = self.sum()?;
                self.closing()?;
                Ok(value)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.named(),
            Some(c) => Err(self.syntax(&format!("a number, a name or a parenthesis is missing before '{c}'"))),
            None if self.text.trim().is_empty() => Err(Fault::new(format!("{} is an empty formula", self.name))),
            None => Err(self.syntax("an operand is missing")),
        }
    }

    fn closing(&mut self) -> Result<(), Fault> {
        if self.take(')') {
            return Ok(());
        }
        let what = match self.peek() {
            None => "a closing parenthesis is missing",
            Some(',') => "a comma is outside a list of arguments",
            Some(_) => "an operator or a closing parenthesis is missing",
        };
        Err(self.syntax(what))
    }

    fn number(&mut self) -> Result<u32, Fault> {
        let bytes = self.text.as_bytes();
        let digits = |from: usize| from + bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
        let mut end = digits(self.at);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent_end = digits(end + 1 + sign);
            if exponent_end > end + 1 + sign {
                end = exponent_end;
            }
        }
        let value: f64 = self.text[self.at..end].parse().map_err(|_| self.syntax("a number is malformed"))?;
        self.at = end;
        Ok(self.graph.constant(value))
    }

    fn named(&mut self) -> Result<u32, Fault> {
        let rest = &self.text[self.at..];
        let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let (name, start) = (&rest[..length], self.at);
        if let Some(function) = FUNCTIONS.iter().position(|f| f.0 == name) {
            self.at += length;
            let op = if name == "pow" { Op::Pow } else { Op::Call(function as u8) };
            return self.call(name, op, FUNCTIONS[function].1);
        }
        let value = self.names.iter().find(|n| n.0 == name).map(|n| n.1);
        let value = value.or_else(|| CONSTANTS.iter().find(|c| c.0 == name).map(|c| self.graph.constant(c.1)));
        let Some(value) = value else { return Err(self.unknown(name)) };
        self.at += length;
        if self.peek() == Some('(') {
            self.at = start;
            return Err(self.syntax(&format!("\"{name}\" is not a function, yet a parenthesis follows it")));
        }
        Ok(value)
    }

    fn unknown(&self, name: &str) -> Fault {
        let fault = self.syntax(&format!("the name \"{name}\" is unknown"));
        if name == "log" {
            return fault.remedy("Write ln for the natural logarithm or log10 for the decimal one");
        }
        if self.later.contains(&name) {
            return fault.remedy(format!("Define \"{name}\" before it is used"));
        }
        let known = self.names.iter().map(|n| n.0);
        let known = known.chain(FUNCTIONS.iter().map(|f| f.0)).chain(CONSTANTS.iter().map(|c| c.0));
        fault.remedy(suggestion(name, known).unwrap_or_else(|| {
            "Known names are x, y, z, u, v, pi, e, the functions and the helpers defined before".to_owned()
        }))
    }

    fn call(&mut self, name: &str, op: Op, arity: usize) -> Result<u32, Fault> {
        if !self.take('(') {
            return Err(self.syntax(&format!("the argument of {name} is not in parentheses")));
        }
        let mut arguments = vec![self.sum()?];
        while self.take(',') {
            arguments.push(self.sum()?);
        }
        self.closing()?;
        let variadic = matches!(name, "min" | "max") && arguments.len() > 2;
        if arguments.len() != arity && !variadic {
            let plural = if arity == 1 { "" } else { "s" };
            return Err(self.syntax(&format!("{name} takes {arity} argument{plural}, not {}, before", arguments.len())));
        }
        if arity == 1 {
            return Ok(self.graph.result(op, arguments[0], arguments[0]));
        }
        let mut value = arguments[0];
        for &argument in &arguments[1..] {
            value = self.graph.result(op, value, argument);
        }
        Ok(value)
    }
}
