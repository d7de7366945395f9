use super::*;
use crate::core::lesson::built_in;

fn parse(tex: &str) -> Result<Equation, String> {
    Equation::parse(tex).map_err(|(fault, at)| format!("{at}: {fault}"))
}

#[test]
fn equations_are_said_in_one_line() {
    for (tex, text) in [
        (r"h_i = \frac{1}{\sqrt{\lambda_i}}", "h_i = 1/sqrt(λ_i)"),
        (r"|\theta_i - 90^\circ| \le 30^\circ", "|θ_i − 90°| ≤ 30°"),
        (r"x(C,D,P) \cdot x(C,D,Q) < 0", "x(C, D, P) · x(C, D, Q) < 0"),
        (r"P' = \frac{1}{A_T} \sum_{i=1}^{N_P} A_i C_i", "P′ = 1/A_T ∑_(i=1)^(N_P) A_i C_i"),
        (r"A_i = \frac{1}{2} l_i l_{i+1} \sin \theta_i", "A_i = 1/2 l_i l_(i+1) sin θ_i"),
        (r"\left( \frac{a+b}{2} \right)^2", "((a + b)/2)^2"),
        (r"\frac{1}{\max(\sqrt{x}, y)}", "1/max(sqrt(x), y)"),
        (r"\frac{\frac12}{3}", "(1/2)/3"),
        (r"\alpha < 180^\circ, \quad \beta = -1", "α < 180°, β = −1"),
        (r"\sqrt[3]{x_1^{12}}", "root_3(x_1^12)"),
        (r"\lambda'_{AB}\text{ if even}", "λ_AB′ if even"),
        (r"x = {{theta_A}}, {{{H}}}", "x = {{theta_A}}, {{H}}"),
        ("θ ≤ 30°", "θ ≤ 30°"),
    ] {
        assert_eq!(parse(tex).map(|equation| equation.text()), Ok(text.to_owned()), "{tex}");
    }
}

#[test]
fn signs_are_what_their_neighbours_make_of_them() {
    use Class::{Binary, Closing, Opening, Ordinary, Relation};
    let classes_of = |tex: &str| classes(parse(tex).unwrap().row()).into_iter().map(Option::unwrap).collect::<Vec<_>>();
    assert_eq!(classes_of("a - b"), [Ordinary, Binary, Ordinary]);
    assert_eq!(classes_of("- b"), [Ordinary, Ordinary]);
    assert_eq!(classes_of("a = -b"), [Ordinary, Relation, Ordinary, Ordinary]);
    assert_eq!(classes_of("a - < b -"), [Ordinary, Ordinary, Relation, Ordinary, Ordinary]);
    assert_eq!(classes_of("|-a|_2"), [Opening, Ordinary, Ordinary, Closing]);
    assert_eq!(classes_of("(-a)"), [Opening, Ordinary, Ordinary, Closing]);
}

#[test]
fn what_is_no_equation_is_refused_with_its_place() {
    for (tex, at, part) in [
        (r"x + \fraq{1}{2}", 4, r#"Did you mean "\frac"?"#),
        (r"x + \unheardof", 4, "docs/lessons.md"),
        (r"\", 0, "There is no command"),
        ("x & y", 2, "An equation has no \"&\""),
        ("a é", 2, "An equation has no \"é\""),
        ("a {b", 2, "not closed"),
        ("a } b", 2, "closes nothing"),
        (r"\left( a", 0, r"no \right"),
        (r"a \right)", 2, r"no \left"),
        (r"\left x \right)", 6, "no bracket"),
        (r"{\left( a}", 1, r"no \right"),
        (r"\frac{1}", 8, r"missing after \frac"),
        (r"\sqrt", 5, r"missing after \sqrt"),
        (r"\sqrt[3 x", 5, "not closed"),
        (r"\sqrt[\foo]{x}", 6, r"no command \foo"),
        ("x_", 2, "missing after _"),
        ("_2", 0, "stands at nothing"),
        ("x_1_2", 3, "two subscripts"),
        ("x^1^2", 3, "two superscripts"),
        (r"\quad_2", 0, "stands at a space"),
        (r"\text x", 6, "plain words"),
        ("a {{theta}}", 2, "There is no number"),
        ("a {{theta_A}", 2, "not closed"),
    ] {
        let fault = parse(tex).unwrap_err();
        assert!(fault.starts_with(&format!("{at}: ")) && fault.contains(part), "{tex}: {fault}");
    }
    for deep in ["{".repeat(100_000), r"\sqrt".repeat(100_000), r"\left(".repeat(100_000), r"\frac".repeat(100_000)] {
        assert!(parse(&deep).unwrap_err().contains("too deeply"));
    }
}

#[test]
fn numbers_of_the_state_are_put_in_wherever_they_stand() {
    let equation = parse(r"\frac{{{H}}}{\sqrt{ {{c}} }} + x_{{{H}}}^{ {{c}} } \left( {{H}} \right) { {{c}} }").unwrap();
    let number = |quantity: Quantity| match quantity {
        Quantity::H => Ok("0.55".to_owned()),
        _ => Ok("2".to_owned()),
    };
    assert_eq!(equation.with_numbers(number).unwrap().text(), "0.55/sqrt(2) + x_0.55^2 (0.55) 2");
    assert!(equation.with_numbers(|_| Err(Fault::new("none"))).is_err());
}

#[test]
fn every_equation_of_the_lessons_is_read() {
    let equations: Vec<String> = built_in::equations().iter().map(Equation::text).collect();
    // Lines that begin with dollars, counted in the files themselves.
    let texts = built_in::LESSONS.iter().map(|(_, text)| *text).chain([built_in::TEMPLATE]);
    let lines = texts.flat_map(str::lines).filter(|line| line.starts_with("$$")).count();
    assert_eq!(equations.len(), lines);
    assert!(equations.len() >= 8 && equations.iter().all(|text| !text.contains('\\')), "{equations:?}");
}

#[test]
fn the_page_on_lessons_has_every_command() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/lessons.md");
    let docs = std::fs::read_to_string(path).unwrap();
    let is_greek = |glyph: char| ('Α'..='ω').contains(&glyph);
    for (name, command) in signs::COMMANDS {
        // Greek letters are there from the first to the last.
        let is_there = match command {
            signs::Command::Sign(sign) if is_greek(sign.glyph) => true,
            _ => docs.contains(&format!("\\{name}")),
        };
        assert!(is_there, "docs/lessons.md does not tell of \\{name}");
    }
}
