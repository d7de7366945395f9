use super::*;
use glam::{DVec2, DVec3};

fn place(x: f64, y: f64) -> MetricPlace {
    MetricPlace { xyz: DVec3::new(x, y, 0.5), ..MetricPlace::in_plane(DVec2::new(x, y)) }
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
    assert!(program.slots < VARIABLES.len() + program.constants.len() + 5, "registers are reused: {}", program.slots);
}

#[test]
fn an_output_may_be_a_variable_or_another_output() {
    let program = Program::compile(&[], &[("a", "y"), ("b", "x+y"), ("c", "x+y"), ("d", "(x+y)*2")]).unwrap();
    let mut out = [0.0; 4];
    program.eval(&place(1.0, 2.0), &mut out);
    assert_eq!(out, [2.0, 3.0, 3.0, 6.0]);
}

#[test]
fn a_program_with_registers_on_the_heap_gives_the_same() {
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
        ("phy*2", &["\"phy\" is unknown", "Did you mean \"phi\"?"]),
        ("sine(x)", &["\"sine\" is unknown", "Did you mean \"sin\"?"]),
        ("Pi", &["Did you mean \"pi\"?"]),
        ("log(x)", &["ln"]),
        ("zebra", &["\"zebra\" is unknown", "Known names are"]),
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
    assert!(fault(&[("x", "1")]).contains("already has a meaning"));
    assert!(fault(&[("sin", "1")]).contains("already has a meaning"));
    assert!(fault(&[("e", "1")]).contains("already has a meaning"));
    assert!(fault(&[("a", "1"), ("a", "2")]).contains("Two helper"));
    assert!(fault(&[("2a", "1")]).contains("cannot name"));
    assert!(fault(&[("", "1")]).contains("cannot name"));
    assert!(fault(&[("a", "b"), ("b", "1")]).contains("Define \"b\" before"));
    assert!(fault(&[("a", "a+1")]).contains("Define \"a\" before"));
}
