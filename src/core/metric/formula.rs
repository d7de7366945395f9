//! Formulas over x, y, z, u, v: text compiled once to straight-line code over a small register file.
//!
//! Operators by increasing precedence: `+ -`, `* /` (both left-associative), sign, `^` (right-associative, its exponent
//! may have a sign), then numbers, names, calls and parentheses. So `-x^2` is `-(x^2)`, `2^-1` is a half and `2^3^2` is
//! 2^9, as in mathematics. Helpers are named expressions that later ones may use; common subexpressions are computed
//! once.
//!
//! All functions come from `libm`, since those of the standard library differ between systems. The crate `exmex` does
//! not suffice: in it `exp(-3^2)` is `exp(9)`, and `min(1, max(2, 3))` is a syntax error. There are no conditions,
//! assignments, implied multiplications (`2x`) or user-defined functions.

mod parser;

use rustc_hash::FxHashMap;

use super::place::MetricPlace;
use crate::core::fault::Fault;
use parser::Parser;

/// The variables of a formula, in the order of [`Program::eval`].
pub const VARIABLES: [&str; 5] = ["x", "y", "z", "u", "v"];

/// The largest nesting depth of parentheses, signs and exponents.
const DEEPEST: usize = 200;

/// The number of registers on the stack; longer programs allocate on the heap in each call.
const FILE_ON_STACK: usize = 32;

/// An operation on two operands; unary ones ignore the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Op {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Neg,
    /// A function, by its place in [`FUNCTIONS`].
    Call(u8),
}

/// A function of a formula: its name, its number of arguments (`min` and `max`: at least two), its value.
type Function = (&'static str, usize, fn(f64, f64) -> f64);

/// All functions. Unlike `f64::min` and `max`, those here propagate NaN, so that it is refused and not hidden.
const FUNCTIONS: [Function; 18] = [
    ("abs", 1, |a, _| a.abs()),
    ("acos", 1, |a, _| libm::acos(a)),
    ("asin", 1, |a, _| libm::asin(a)),
    ("atan", 1, |a, _| libm::atan(a)),
    ("atan2", 2, libm::atan2),
    ("cos", 1, |a, _| libm::cos(a)),
    ("exp", 1, |a, _| libm::exp(a)),
    ("floor", 1, |a, _| a.floor()),
    ("hypot", 2, libm::hypot),
    ("ln", 1, |a, _| libm::log(a)),
    ("log10", 1, |a, _| libm::log10(a)),
    ("max", 2, |a, b| if a.is_nan() || a > b { a } else { b }),
    ("min", 2, |a, b| if a.is_nan() || a < b { a } else { b }),
    ("pow", 2, libm::pow),
    ("sign", 1, |a, _| if a == 0.0 { a } else { a.signum() }),
    ("sin", 1, |a, _| libm::sin(a)),
    ("sqrt", 1, |a, _| a.sqrt()),
    ("tan", 1, |a, _| libm::tan(a)),
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
            Op::Neg => -a,
            Op::Call(function) => FUNCTIONS[usize::from(function)].2(a, b),
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
    /// Length of the register file: variables, then constants, then intermediate results.
    slots: usize,
    constants: Vec<f64>,
    /// The file before the first instruction, where it fits on the stack.
    first: Box<[f64; FILE_ON_STACK]>,
    code: Vec<Instruction>,
    outputs: Vec<u32>,
}

impl Program {
    /// Compiles `outputs` (name, expression) with the `helpers` that they may use; a helper may use those before it.
    ///
    /// # Errors
    /// A syntax error with the expression and the column; an unknown name with a suggestion; a helper whose name is
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
        let value = |(name, text): &(&str, &str)| Parser::parse(name, text, &mut graph, &names, &[]);
        let values = outputs.iter().map(value).collect::<Result<Vec<u32>, Fault>>()?;
        Ok(graph.emit(&values))
    }

    /// The value of an output that does not depend on variables.
    pub fn constant(&self, output: usize) -> Option<f64> {
        let slot = *self.outputs.get(output)? as usize;
        self.constants.get(slot.checked_sub(VARIABLES.len())?).copied()
    }

    /// Evaluates all outputs at a point, in order, into the first elements of `out`. Values may be NaN or infinite.
    ///
    /// # Panics
    /// When `out` is shorter than [`Program::outputs`].
    #[inline]
    pub fn eval(&self, place: &MetricPlace, out: &mut [f64]) {
        let variables = [place.xyz.x, place.xyz.y, place.xyz.z, place.uv.x, place.uv.y];
        if self.slots > FILE_ON_STACK {
            return self.eval_on_heap(variables, out);
        }
        let mut file = *self.first;
        file[..VARIABLES.len()].copy_from_slice(&variables);
        // Every index is within the file; the remainder tells the compiler so.
        let at = |slot: u32| slot as usize % FILE_ON_STACK;
        for i in &self.code {
            file[at(i.out)] = i.op.apply(file[at(i.a)], file[at(i.b)]);
        }
        for (value, &slot) in out[..self.outputs.len()].iter_mut().zip(&self.outputs) {
            *value = file[at(slot)];
        }
    }

    #[cold]
    fn eval_on_heap(&self, variables: [f64; VARIABLES.len()], out: &mut [f64]) {
        let mut file = Vec::with_capacity(self.slots);
        file.extend_from_slice(&variables);
        file.extend_from_slice(&self.constants);
        file.resize(self.slots, 0.0);
        for i in &self.code {
            file[i.out as usize] = i.op.apply(file[i.a as usize], file[i.b as usize]);
        }
        for (value, &slot) in out[..self.outputs.len()].iter_mut().zip(&self.outputs) {
            *value = file[slot as usize];
        }
    }
}

/// Checks that the name of a helper is an identifier without another meaning.
fn check_helper_name(name: &str, names: &[(&str, u32)]) -> Result<(), Fault> {
    let mut letters = name.chars();
    let starts_well = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if !starts_well || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(Fault::new(format!("\"{name}\" cannot name a helper expression"))
            .remedy("Use letters, digits and underscores, beginning with a letter"));
    }
    let of_the_language = FUNCTIONS.iter().any(|f| f.0 == name) || CONSTANTS.iter().any(|c| c.0 == name);
    if of_the_language || VARIABLES.contains(&name) {
        return Err(Fault::new(format!("A helper expression is named \"{name}\", which already has a meaning"))
            .remedy("Give it another name"));
    }
    if names.iter().any(|n| n.0 == name) {
        return Err(
            Fault::new(format!("Two helper expressions are named \"{name}\"")).remedy("Give one of them another name")
        );
    }
    Ok(())
}

/// A node of the graph; ids are indices, and operands come before their uses.
#[derive(Clone, Copy)]
enum Node {
    Variable,
    Constant(f64),
    Result(Op, u32, u32),
}

/// The expressions as a graph with common subexpressions merged and constants folded.
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
            // Most powers in size formulas are squares and cubes, and a product is ten times as fast as a general
            // power.
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

    /// The code that computes `outputs`; registers are reused after their last use.
    fn emit(&self, outputs: &[u32]) -> Program {
        const KEPT: u32 = u32::MAX;
        // The last node that reads each node; None if no output needs it.
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
        let mut first = Box::new([0.0; FILE_ON_STACK]);
        first.iter_mut().skip(VARIABLES.len()).zip(&constants).for_each(|(slot, constant)| *slot = *constant);
        Program { slots, constants, first, code, outputs: outputs.iter().map(|&o| slot[o as usize]).collect() }
    }
}

#[cfg(test)]
mod tests;
