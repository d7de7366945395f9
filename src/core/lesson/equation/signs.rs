//! The signs and commands of equations.

/// What a term is to its neighbours: it decides the room between them, as in TeX.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// A letter or a number.
    Ordinary,
    /// A function, a sum.
    Operator,
    /// An operation between two terms.
    Binary,
    /// Equal, less.
    Relation,
    /// A bracket that opens.
    Opening,
    /// A bracket that closes.
    Closing,
    /// A comma.
    Punctuation,
    /// A fraction, terms in brackets that grow.
    Inner,
}

/// A single character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sign {
    /// The character.
    pub glyph: char,
    /// What it is to its neighbours.
    pub class: Class,
}

impl Sign {
    /// Whether it is written in italics: a variable, by a letter.
    pub fn is_slanted(self) -> bool {
        self.class == Class::Ordinary && (self.glyph.is_ascii_alphabetic() || ('α'..='ω').contains(&self.glyph))
    }

    /// Whether it is larger where there is room.
    pub fn is_large(self) -> bool {
        self.class == Class::Operator
    }

    /// Whether fonts have it raised already, so that it is no smaller and no higher as a superscript.
    pub fn is_raised(self) -> bool {
        matches!(self.glyph, '°' | '′')
    }

    /// Whether what stands at it are limits.
    pub(super) fn has_limits(self) -> bool {
        matches!(self.glyph, '∑' | '∏')
    }
}

/// What a command makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Command {
    Sign(Sign),
    Function { has_limits: bool },
    Fraction,
    Root,
    Text,
    Left,
    Right,
    Space(i8),
}

const fn sign(glyph: char, class: Class) -> Command {
    Command::Sign(Sign { glyph, class })
}

const fn letter(glyph: char) -> Command {
    sign(glyph, Class::Ordinary)
}

const FUNCTION: Command = Command::Function { has_limits: false };
const WITH_LIMITS: Command = Command::Function { has_limits: true };

/// Every command; docs/lessons.md has the same. All of their characters are in the fonts of the window.
pub(super) const COMMANDS: [(&str, Command); 97] = [
    ("frac", Command::Fraction),
    ("sqrt", Command::Root),
    ("left", Command::Left),
    ("right", Command::Right),
    ("text", Command::Text),
    ("mathrm", Command::Text),
    (",", Command::Space(3)),
    (":", Command::Space(4)),
    (";", Command::Space(5)),
    ("!", Command::Space(-3)),
    (" ", Command::Space(6)),
    ("quad", Command::Space(18)),
    ("qquad", Command::Space(36)),
    ("alpha", letter('α')),
    ("beta", letter('β')),
    ("gamma", letter('γ')),
    ("delta", letter('δ')),
    ("epsilon", letter('ε')),
    ("varepsilon", letter('ε')),
    ("zeta", letter('ζ')),
    ("eta", letter('η')),
    ("theta", letter('θ')),
    ("iota", letter('ι')),
    ("kappa", letter('κ')),
    ("lambda", letter('λ')),
    ("mu", letter('μ')),
    ("nu", letter('ν')),
    ("xi", letter('ξ')),
    ("pi", letter('π')),
    ("rho", letter('ρ')),
    ("sigma", letter('σ')),
    ("tau", letter('τ')),
    ("upsilon", letter('υ')),
    ("phi", letter('φ')),
    ("varphi", letter('φ')),
    ("chi", letter('χ')),
    ("psi", letter('ψ')),
    ("omega", letter('ω')),
    ("Gamma", letter('Γ')),
    ("Delta", letter('Δ')),
    ("Theta", letter('Θ')),
    ("Lambda", letter('Λ')),
    ("Xi", letter('Ξ')),
    ("Pi", letter('Π')),
    ("Sigma", letter('Σ')),
    ("Phi", letter('Φ')),
    ("Psi", letter('Ψ')),
    ("Omega", letter('Ω')),
    ("infty", letter('∞')),
    ("partial", letter('∂')),
    ("prime", letter('′')),
    ("ldots", sign('…', Class::Inner)),
    ("dots", sign('…', Class::Inner)),
    ("sum", sign('∑', Class::Operator)),
    ("prod", sign('∏', Class::Operator)),
    ("int", sign('∫', Class::Operator)),
    ("cdot", sign('·', Class::Binary)),
    ("times", sign('×', Class::Binary)),
    ("div", sign('÷', Class::Binary)),
    ("pm", sign('±', Class::Binary)),
    ("circ", sign('°', Class::Ordinary)),
    ("le", sign('≤', Class::Relation)),
    ("leq", sign('≤', Class::Relation)),
    ("ge", sign('≥', Class::Relation)),
    ("geq", sign('≥', Class::Relation)),
    ("lt", sign('<', Class::Relation)),
    ("gt", sign('>', Class::Relation)),
    ("ne", sign('≠', Class::Relation)),
    ("neq", sign('≠', Class::Relation)),
    ("approx", sign('≈', Class::Relation)),
    ("to", sign('→', Class::Relation)),
    ("rightarrow", sign('→', Class::Relation)),
    ("leftarrow", sign('←', Class::Relation)),
    ("{", sign('{', Class::Opening)),
    ("}", sign('}', Class::Closing)),
    ("%", letter('%')),
    ("arccos", FUNCTION),
    ("arcsin", FUNCTION),
    ("arctan", FUNCTION),
    ("cos", FUNCTION),
    ("cosh", FUNCTION),
    ("cot", FUNCTION),
    ("exp", FUNCTION),
    ("ln", FUNCTION),
    ("log", FUNCTION),
    ("sin", FUNCTION),
    ("sinh", FUNCTION),
    ("tan", FUNCTION),
    ("tanh", FUNCTION),
    ("arg", FUNCTION),
    ("det", WITH_LIMITS),
    ("dim", FUNCTION),
    ("lim", WITH_LIMITS),
    ("max", WITH_LIMITS),
    ("min", WITH_LIMITS),
    ("sup", WITH_LIMITS),
    ("inf", WITH_LIMITS),
];

/// The sign that a character stands for by itself; `None` for one that equations do not have.
pub(super) fn of_character(c: char) -> Option<Sign> {
    let class = match c {
        'a'..='z' | 'A'..='Z' | '!' | '?' | '.' | '/' | '|' | '°' => Class::Ordinary,
        '+' | '-' | '*' => Class::Binary,
        '=' | '<' | '>' | ':' => Class::Relation,
        '(' | '[' => Class::Opening,
        ')' | ']' => Class::Closing,
        ',' | ';' => Class::Punctuation,
        _ => {
            return COMMANDS.iter().find_map(|(_, command)| match command {
                Command::Sign(sign) if sign.glyph == c => Some(*sign),
                _ => None,
            });
        }
    };
    // The typographic minus is as wide as a plus; the star of a keyboard stands too high.
    let glyph = match c {
        '-' => '−',
        '*' => '·',
        c => c,
    };
    Some(Sign { glyph, class })
}

/// Every sign that an equation can have.
pub fn all() -> impl Iterator<Item = Sign> {
    let of_keyboard = (' '..='~').filter_map(of_character);
    of_keyboard.chain(COMMANDS.iter().filter_map(|(_, command)| match command {
        Command::Sign(sign) => Some(*sign),
        _ => None,
    }))
}
