//! Formulas over x, y, z, u, v: text compiled once to straight-line code over a small file of numbers.
//!
//! Grammar, loosest first: `+ -`, `* /` (both from left to right), sign, `^` (from right to left, its exponent may carry a
//! sign), then numbers, names, calls and parentheses. So `-x^2` is `-(x^2)`, `2^-1` is a half and `2^3^2` is 2^9, as in
//! mathematics. Helpers are named expressions that later ones may use; what several expressions share is computed once.
//!
//! Every function is `libm`'s: the standard library's differ between systems. The crate `exmex` was tried first and
//! dropped: in it `exp(-3^2)` is `exp(9)`, `min(1, max(2, 3))` is a syntax error and `1e-3` needs a parser of one's own.
//! Deliberately absent: conditions, assignment, implied multiplication (`2x`), user functions.

use rustc_hash::FxHashMap;

use super::field::Place;
use crate::core::fault::Fault;

/// What a formula may depend on, in the order of [`Program::eval`].
pub const VARIABLES: [&str; 5] = ["x", "y", "z", "u", "v"];

/// Levels of parentheses, signs and exponents within each other that are read before a formula is refused.
const DEEPEST: usize = 200;

/// Numbers that an evaluation keeps on the stack; longer programs take a heap allocation a call.
const FILE_ON_STACK: usize = 32;

/// An operation of two operands; those of one ignore the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Op {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Min,
    Max,
    Atan2,
    Hypot,
    Neg,
    Abs,
    Sqrt,
    Exp,
    Ln,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Floor,
    Sign,
}

/// Functions by name, with how many arguments they take (`min` and `max`: at least two).
const FUNCTIONS: [(&str, Op, usize); 18] = [
    ("abs", Op::Abs, 1),
    ("acos", Op::Acos, 1),
    ("asin", Op::Asin, 1),
    ("atan", Op::Atan, 1),
    ("atan2", Op::Atan2, 2),
    ("cos", Op::Cos, 1),
    ("exp", Op::Exp, 1),
    ("floor", Op::Floor, 1),
    ("hypot", Op::Hypot, 2),
    ("ln", Op::Ln, 1),
    ("log10", Op::Log10, 1),
    ("max", Op::Max, 2),
    ("min", Op::Min, 2),
    ("pow", Op::Pow, 2),
    ("sign", Op::Sign, 1),
    ("sin", Op::Sin, 1),
    ("sqrt", Op::Sqrt, 1),
    ("tan", Op::Tan, 1),
];

const CONSTANTS: [(&str, f64); 2] = [("e", std::f64::consts::E), ("pi", std::f64::consts::PI)];

impl Op {
    #[inline]
    fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Op::Add => a + b,
            Op::Sub => a - b,
            Op::Mul => a * b,
            Op::Div => a / b,
            Op::Pow => libm::pow(a, b),
            // Unlike f64::min and max these hand a NaN on, so that it is refused and not hidden.
            Op::Min => {
                if a.is_nan() || a < b {
                    a
                } else {
                    b
                }
            }
            Op::Max => {
                if a.is_nan() || a > b {
                    a
                } else {
                    b
                }
            }
            Op::Atan2 => libm::atan2(a, b),
            Op::Hypot => libm::hypot(a, b),
            Op::Neg => -a,
            Op::Abs => a.abs(),
            Op::Sqrt => a.sqrt(),
            Op::Exp => libm::exp(a),
            Op::Ln => libm::log(a),
            Op::Log10 => libm::log10(a),
            Op::Sin => libm::sin(a),
            Op::Cos => libm::cos(a),
            Op::Tan => libm::tan(a),
            Op::Asin => libm::asin(a),
            Op::Acos => libm::acos(a),
            Op::Atan => libm::atan(a),
            Op::Floor => a.floor(),
            Op::Sign => {
                if a > 0.0 {
                    1.0
                } else if a < 0.0 {
                    -1.0
                } else {
                    a
                }
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Instruction {
    op: Op,
    a: u32,
    b: u32,
    out: u32,
}

/// Compiled formulas: several outputs over the same variables and helpers.
#[derive(Clone, Debug)]
pub struct Program {
    /// Length of the file: variables, then constants, then intermediate results.
    slots: usize,
    constants: Vec<f64>,
    code: Vec<Instruction>,
    outputs: Vec<u32>,
}

impl Program {
    /// Compiles `outputs` (name and expression each) with the `helpers` that they may use; a helper may use those before it.
    ///
    /// # Errors
    /// A syntax error with the expression and the column; an unknown name with the nearest known one; a helper whose name is
    /// taken. The fault has no place yet.
    pub fn compile(helpers: &[(String, String)], outputs: &[(&str, &str)]) -> Result<Program, Fault> {
        let mut graph = Graph::default();
        let mut names: Vec<(&str, u32)> = Vec::new();
        for (i, name) in VARIABLES.iter().enumerate() {
            graph.nodes.push(Node::Variable);
            names.push((name, i as u32));
        }
        for (i, (name, text)) in helpers.iter().enumerate() {
            check_helper_name(name, &names)?;
            let later: Vec<&str> = helpers[i..].iter().map(|h| h.0.as_str()).collect();
            let value = Parser::parse(name, text, &mut graph, &names, &later)?;
            names.push((name, value));
        }
        let mut values = Vec::with_capacity(outputs.len());
        for (name, text) in outputs {
            values.push(Parser::parse(name, text, &mut graph, &names, &[])?);
        }
        Ok(graph.emit(&values))
    }

    /// How many outputs there are.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// The value of an output that depends on no variable.
    pub fn constant(&self, output: usize) -> Option<f64> {
        let slot = *self.outputs.get(output)? as usize;
        self.constants.get(slot.checked_sub(VARIABLES.len())?).copied()
    }

    /// Evaluates all outputs at a place, in their order, into the first places of `out`. Values may be NaN or infinite.
    ///
    /// # Panics
    /// When `out` is shorter than [`Program::outputs`].
    #[inline]
    pub fn eval(&self, place: &Place, out: &mut [f64]) {
        let mut on_stack = [0.0; FILE_ON_STACK];
        let mut on_heap = Vec::new();
        let file: &mut [f64] = if self.slots <= FILE_ON_STACK {
            &mut on_stack
        } else {
            on_heap.resize(self.slots, 0.0);
            &mut on_heap
        };
        let n = VARIABLES.len();
        file[..n].copy_from_slice(&[place.xyz.x, place.xyz.y, place.xyz.z, place.uv.x, place.uv.y]);
        file[n..n + self.constants.len()].copy_from_slice(&self.constants);
        for i in &self.code {
            file[i.out as usize] = i.op.apply(file[i.a as usize], file[i.b as usize]);
        }
        for (value, &slot) in out[..self.outputs.len()].iter_mut().zip(&self.outputs) {
            *value = file[slot as usize];
        }
    }
}

/// A helper's name is an identifier that means nothing yet.
fn check_helper_name(name: &str, names: &[(&str, u32)]) -> Result<(), Fault> {
    let mut letters = name.chars();
    let starts_well = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if !starts_well || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(Fault::new(format!("\"{name}\" cannot name a helper expression"))
            .remedy("Use letters, digits and underscores, a letter first"));
    }
    let of_the_language = FUNCTIONS.iter().any(|f| f.0 == name) || CONSTANTS.iter().any(|c| c.0 == name);
    if of_the_language || VARIABLES.contains(&name) {
        return Err(Fault::new(format!("A helper expression is named \"{name}\", which has a meaning already"))
            .remedy("Give it another name"));
    }
    if names.iter().any(|n| n.0 == name) {
        return Err(
            Fault::new(format!("Two helper expressions are named \"{name}\"")).remedy("Give one of them another name")
        );
    }
    Ok(())
}

/// A value of the graph; ids are positions, operands come before their uses.
#[derive(Clone, Copy)]
enum Node {
    Variable,
    Constant(f64),
    Result(Op, u32, u32),
}

/// The expressions as a graph in which equal subexpressions are one node and constants are folded.
#[derive(Default)]
struct Graph {
    nodes: Vec<Node>,
    constants: FxHashMap<u64, u32>,
    results: FxHashMap<(Op, u32, u32), u32>,
}

impl Graph {
    fn constant(&mut self, value: f64) -> u32 {
        let nodes = &mut self.nodes;
        *self.constants.entry(value.to_bits()).or_insert_with(|| {
            nodes.push(Node::Constant(value));
            nodes.len() as u32 - 1
        })
    }

    fn result(&mut self, op: Op, a: u32, b: u32) -> u32 {
        let (node_a, node_b) = (self.nodes[a as usize], self.nodes[b as usize]);
        if let (Node::Constant(va), Node::Constant(vb)) = (node_a, node_b) {
            return self.constant(op.apply(va, vb));
        }
        if let (Op::Pow, Node::Constant(exponent)) = (op, node_b) {
            // Squares and cubes are most powers in sizes, and a product is ten times as quick as a general power.
            if exponent == 2.0 {
                return self.result(Op::Mul, a, a);
            }
            if exponent == 3.0 {
                let square = self.result(Op::Mul, a, a);
                return self.result(Op::Mul, square, a);
            }
        }
        let nodes = &mut self.nodes;
        *self.results.entry((op, a, b)).or_insert_with(|| {
            nodes.push(Node::Result(op, a, b));
            nodes.len() as u32 - 1
        })
    }

    /// Code for what `outputs` need, slots being given back after their last use.
    fn emit(&self, outputs: &[u32]) -> Program {
        const KEPT: u32 = u32::MAX;
        // The last node that reads each node; None: nothing needs it.
        let mut last_use: Vec<Option<u32>> = vec![None; self.nodes.len()];
        for &o in outputs {
            last_use[o as usize] = Some(KEPT);
        }
        for (i, node) in self.nodes.iter().enumerate().rev() {
            if let (Some(_), Node::Result(_, a, b)) = (last_use[i], *node) {
                for operand in [a, b] {
                    let last = &mut last_use[operand as usize];
                    *last = Some(last.map_or(i as u32, |l| l.max(i as u32)));
                }
            }
        }
        let mut slot = vec![0u32; self.nodes.len()];
        let mut constants = Vec::new();
        for (i, node) in self.nodes.iter().enumerate() {
            match *node {
                Node::Variable => slot[i] = i as u32,
                Node::Constant(value) if last_use[i].is_some() => {
                    slot[i] = (VARIABLES.len() + constants.len()) as u32;
                    constants.push(value);
                }
                _ => {}
            }
        }
        let mut slots = VARIABLES.len() + constants.len();
        let mut free: Vec<u32> = Vec::new();
        let mut code = Vec::new();
        for (i, node) in self.nodes.iter().enumerate() {
            let (Some(_), Node::Result(op, a, b)) = (last_use[i], *node) else { continue };
            for (k, operand) in [a, b].into_iter().enumerate() {
                let is_result = matches!(self.nodes[operand as usize], Node::Result(..));
                if is_result && last_use[operand as usize] == Some(i as u32) && (k == 0 || b != a) {
                    free.push(slot[operand as usize]);
                }
            }
            slot[i] = free.pop().unwrap_or_else(|| {
                slots += 1;
                slots as u32 - 1
            });
            code.push(Instruction { op, a: slot[a as usize], b: slot[b as usize], out: slot[i] });
        }
        Program { slots, constants, code, outputs: outputs.iter().map(|&o| slot[o as usize]).collect() }
    }
}

/// Recursive descent over one expression.
struct Parser<'a> {
    name: &'a str,
    text: &'a str,
    at: usize,
    depth: usize,
    graph: &'a mut Graph,
    names: &'a [(&'a str, u32)],
    later: &'a [&'a str],
}

impl<'a> Parser<'a> {
    fn parse(
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

    /// A syntax error at the present column.
    fn syntax(&self, what: &str) -> Fault {
        let column = self.text[..self.at].chars().count() + 1;
        Fault::new(format!("{} = \"{}\": {what} at column {column}", self.name, self.text))
    }

    /// The next character that is not white.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Steps over `wanted` if it comes next.
    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    fn sum(&mut self) -> Result<u32, Fault> {
        let mut value = self.product()?;
        loop {
            let op = match self.peek() {
                Some('+') => Op::Add,
                Some('-') => Op::Sub,
                _ => return Ok(value),
            };
            self.at += 1;
            let right = self.product()?;
            value = self.graph.result(op, value, right);
        }
    }

    fn product(&mut self) -> Result<u32, Fault> {
        let mut value = self.signed()?;
        loop {
            let op = match self.peek() {
                Some('*') => Op::Mul,
                Some('/') => Op::Div,
                _ => return Ok(value),
            };
            self.at += 1;
            let right = self.signed()?;
            value = self.graph.result(op, value, right);
        }
    }

    /// Signs bind more loosely than powers: `-x^2` is `-(x^2)`. All recursion passes here, so depth is counted here.
    fn signed(&mut self) -> Result<u32, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.syntax("parentheses, signs or exponents are too deep within each other"));
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
            None => Err(self.syntax("something is missing")),
        }
    }

    fn closing(&mut self) -> Result<(), Fault> {
        if self.take(')') {
            return Ok(());
        }
        let what = match self.peek() {
            None => "a closing parenthesis is missing",
            Some(',') => "a comma stands where there is no function's list of arguments",
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
        if let Some(&(_, op, arity)) = FUNCTIONS.iter().find(|f| f.0 == name) {
            self.at += length;
            return self.call(name, op, arity);
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
        let nearest = known
            .map(|k| (strsim::damerau_levenshtein(&name.to_lowercase(), &k.to_lowercase()), k))
            .min_by_key(|&(distance, _)| distance);
        match nearest {
            Some((distance, k)) if distance <= 2 && distance < name.chars().count() => {
                fault.remedy(format!("Is \"{k}\" meant?"))
            }
            _ => fault.remedy("Known are x, y, z, u, v, pi, e, the functions and the helpers defined before"),
        }
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
        let variadic = matches!(op, Op::Min | Op::Max) && arguments.len() > 2;
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};

    fn place(x: f64, y: f64) -> Place {
        Place { xyz: DVec3::new(x, y, 0.5), uv: DVec2::new(x, y) }
    }

    fn value(text: &str, x: f64, y: f64) -> f64 {
        let program = Program::compile(&[], &[("h1", text)]).expect(text);
        let mut out = [0.0];
        program.eval(&place(x, y), &mut out);
        out[0]
    }

    fn refusal(text: &str) -> String {
        Program::compile(&[("phi".into(), "x+1".into())], &[("h1", text)]).expect_err(text).to_string()
    }

    #[test]
    fn precedence_is_that_of_mathematics() {
        for (text, expected) in [
            ("-x^2", -9.0),
            ("(-x)^2", 9.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("2*-x", -6.0),
            ("8/4/2", 1.0),
            ("8/4*2", 4.0),
            ("1-2-3", -4.0),
            ("1-(2-3)", 2.0),
            ("-x-y", -5.0),
            ("--x", 3.0),
            ("+x", 3.0),
            ("2*x^2", 18.0),
            ("-2^-2", -0.25),
            ("x^3", 27.0),
            ("x^y", 9.0),
            ("pow(x, y)", 9.0),
            ("2 ^ 0.5 ^ 2 - pow(2, 0.25)", 0.0),
        ] {
            assert_eq!(value(text, 3.0, 2.0), expected, "{text}");
        }
    }

    #[test]
    fn numbers_may_carry_exponents() {
        assert_eq!(value("1e-3", 0.0, 0.0), 1e-3);
        assert_eq!(value("2.5E+2+.5+1.", 0.0, 0.0), 251.5);
        assert_eq!(value("1e3-1", 0.0, 0.0), 999.0);
        assert_eq!(value("2*e", 0.0, 0.0), 2.0 * std::f64::consts::E);
    }

    #[test]
    fn functions_are_those_of_libm() {
        for (text, expected) in [
            ("exp(x)", libm::exp(0.7)),
            ("ln(x)", libm::log(0.7)),
            ("log10(x)", libm::log10(0.7)),
            ("sin(x)+cos(x)+tan(x)", libm::sin(0.7) + libm::cos(0.7) + libm::tan(0.7)),
            ("asin(x)", libm::asin(0.7)),
            ("acos(x)", libm::acos(0.7)),
            ("atan(x)", libm::atan(0.7)),
            ("atan2(x, y)", libm::atan2(0.7, -0.2)),
            ("hypot(x, y)", libm::hypot(0.7, -0.2)),
            ("floor(y)", -1.0),
            ("sign(y)*sign(x) + sign(0)", -1.0),
            ("abs(y)", 0.2),
            ("sqrt(x)", 0.7f64.sqrt()),
            ("min(x, y, -3)", -3.0),
            ("max(1, min(x, max(y, 2)))", 1.0),
            ("pi + u + v + z", std::f64::consts::PI + 0.7 + -0.2 + 0.5),
            ("\t x\n*\r\n2", 1.4),
        ] {
            assert_eq!(value(text, 0.7, -0.2), expected, "{text}");
        }
    }

    #[test]
    fn a_nan_is_not_hidden_by_min_or_max() {
        for text in ["min(sqrt(x), 1)", "min(1, sqrt(x))", "max(sqrt(x), 1)", "max(1, sqrt(x))"] {
            assert!(value(text, -1.0, 0.0).is_nan(), "{text}");
        }
    }

    #[test]
    fn helpers_are_shared_and_computed_once() {
        let helpers = [("r".into(), "abs(x-y)/sqrt(2)".into()), ("h".into(), "0.005+0.15*r".into())];
        let program = Program::compile(&helpers, &[("h1", "h"), ("h2", "15*h*exp(-5.5*r)"), ("unit", "1/1")]).unwrap();
        let mut out = [0.0; 3];
        program.eval(&place(0.9, 0.3), &mut out);
        let r = (0.9f64 - 0.3).abs() / 2f64.sqrt();
        let h = 0.005 + 0.15 * r;
        assert_eq!(out, [h, 15.0 * h * libm::exp(-5.5 * r), 1.0]);
        // x-y, abs, /, *, +, 15*h, -5.5*r, exp, *: nothing twice.
        assert_eq!(program.code.len(), 9);
        assert_eq!(program.constant(0), None);
        assert_eq!(program.constant(2), Some(1.0));
        assert_eq!(program.constant(3), None);
        assert!(
            program.slots < VARIABLES.len() + program.constants.len() + 5,
            "slots are given back: {}",
            program.slots
        );
    }

    #[test]
    fn an_output_may_be_a_variable_or_another_output() {
        let program = Program::compile(&[], &[("a", "y"), ("b", "x+y"), ("c", "x+y"), ("d", "(x+y)*2")]).unwrap();
        let mut out = [0.0; 4];
        program.eval(&place(1.0, 2.0), &mut out);
        assert_eq!(out, [2.0, 3.0, 3.0, 6.0]);
    }

    #[test]
    fn a_program_larger_than_the_stack_file_gives_the_same() {
        let many: Vec<String> = (0..100).map(|i| format!("{i}.25*x^{i}.5")).collect();
        let expected = (0..100).fold(0.0, |sum, i| {
            let (i, exponent) = (f64::from(i) + 0.25, f64::from(i) + 0.5);
            sum + i * libm::pow(0.5, exponent)
        });
        let sum = many.join("+");
        assert_eq!(value(&sum, 0.5, 0.0), expected);
    }

    #[test]
    fn errors_name_the_formula_the_column_and_the_remedy() {
        for (text, parts) in [
            ("", &["h1", "empty"][..]),
            ("  ", &["empty"]),
            ("x+", &["h1 = \"x+\"", "missing", "column 3"]),
            ("(x", &["closing parenthesis is missing", "column 3"]),
            ("x)", &["no opening one", "column 2"]),
            ("2x", &["an operator is missing", "column 2"]),
            ("2 3", &["an operator is missing", "column 3"]),
            ("sin x", &["sin is not in parentheses"]),
            ("x(2)", &["\"x\" is not a function"]),
            ("phy*2", &["\"phy\" is unknown", "Is \"phi\" meant?"]),
            ("sine(x)", &["\"sine\" is unknown", "Is \"sin\" meant?"]),
            ("Pi", &["Is \"pi\" meant?"]),
            ("log(x)", &["ln"]),
            ("zebra", &["\"zebra\" is unknown", "Known are"]),
            ("atan2(x)", &["atan2 takes 2 arguments, not 1"]),
            ("min(x)", &["min takes 2 arguments, not 1"]),
            ("sin(x, y)", &["sin takes 1 argument, not 2"]),
            ("(x, y)", &["comma"]),
            ("1.5.2", &["an operator is missing"]),
            (".", &["number is malformed"]),
            ("x ** 2", &["before '*'", "column 4"]),
            ("x; y", &["an operator is missing"]),
            ("é", &["\"é\" is unknown"]),
            ("x + €", &["before '€'", "column 5"]),
        ] {
            let message = refusal(text);
            for part in parts {
                assert!(message.contains(part), "{text}: {message}");
            }
        }
        let deep = format!("{}x{}", "(".repeat(100_000), ")".repeat(100_000));
        assert!(refusal(&deep).contains("too deep"));
        assert!(refusal(&"-".repeat(100_000)).contains("too deep"));
    }

    #[test]
    fn helpers_with_bad_names_or_out_of_order_are_refused() {
        let fault = |helpers: &[(&str, &str)]| {
            let helpers: Vec<_> = helpers.iter().map(|h| (h.0.to_string(), h.1.to_string())).collect();
            Program::compile(&helpers, &[("h1", "1")]).expect_err("bad helper").to_string()
        };
        assert!(fault(&[("x", "1")]).contains("has a meaning already"));
        assert!(fault(&[("sin", "1")]).contains("has a meaning already"));
        assert!(fault(&[("e", "1")]).contains("has a meaning already"));
        assert!(fault(&[("a", "1"), ("a", "2")]).contains("Two helper"));
        assert!(fault(&[("2a", "1")]).contains("cannot name"));
        assert!(fault(&[("", "1")]).contains("cannot name"));
        assert!(fault(&[("a", "b"), ("b", "1")]).contains("Define \"b\" before"));
        assert!(fault(&[("a", "a+1")]).contains("Define \"a\" before"));
    }
}
