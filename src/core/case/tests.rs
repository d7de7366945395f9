use super::*;
use crate::core::geometry::CurveShape;
use glam::DVec2;

fn parse(text: &str) -> Result<Case, Fault> {
    Case::parse(text, "plate", "plate.toml", Path::new("cases"))
}

const PLATE: &str = r#"version = 1
title = "Plate"
gradation = 1.3

[parameters]
size_scale = 0.5
theta_rect = 120
selection = "shortest"
layers = 2

[[curve]]
name = "frame"
kind = "polyline"
points = [[0, 0], [1, 0], [1, 1.5], [0, 1]]
closed = true

[[curve]]
name = "hole"
kind = "circle"
centre = [0.5, 0.5]
radius = 0.2
segments = 24

[[face]]
name = "plate"
outer = ["frame"]
holes = [["hole"]]

[[metric]]
kind = "formula"
let = { r = "abs(x-y)/sqrt(2)", a = "r*2" }
h1 = "0.005 + 0.15*r"
h2 = 0.25
g1 = [-1, "1"]

[[metric]]
kind = "boundary_layer"
curves = ["hole"]
first = 0.001
growth = 1.2
far = 0.1
"#;

#[test]
fn a_case_is_read_with_the_lines_of_its_parts() {
    let case = parse(PLATE).unwrap();
    assert_eq!((case.name.as_str(), case.title.as_str(), case.gradation), ("plate", "Plate", Some(1.3)));
    assert_eq!(case.parameters.text_of("theta_rect").unwrap(), "120");
    assert_eq!(case.parameters.layers, 2);
    let DomainSource::Curves { curves, faces } = &case.domain else { panic!() };
    assert_eq!(curves[1].place, "plate.toml, line 17");
    assert_eq!(curves[1].segments, Some(24));
    let CurveShape::Polyline { points, closed: true, .. } = &curves[0].shape else { panic!() };
    assert_eq!(points[2], DVec2::new(1.0, 1.5));
    assert_eq!(faces[0].holes, [["hole"]]);
    let FieldSpec::Formula { helpers, sizes, directions, place } = &case.fields[0] else { panic!() };
    let said: Vec<_> = helpers.iter().map(|h| h.0.as_str()).collect();
    assert_eq!(said, ["r", "a"], "helpers keep the order of the file");
    assert_eq!(sizes[1].as_deref(), Some("0.25"));
    assert_eq!(directions[0].as_ref().unwrap(), &["-1", "1", "0"]);
    assert_eq!(place, "plate.toml, line 29");
    let FieldSpec::BoundaryLayer { along: None, far: Some(far), .. } = case.fields[1] else { panic!() };
    assert_eq!(far, 0.1);
}

/// The fault of the plate with one part replaced.
fn refusal(from: &str, to: &str) -> String {
    assert!(PLATE.contains(from), "{from}");
    parse(&PLATE.replacen(from, to, 1)).expect_err(to).to_string()
}

#[test]
fn the_corner_angle_of_a_polyline_is_its_own_or_that_of_the_case() {
    let degrees = |of_case: &str, of_curve: &str| {
        let text = PLATE.replacen("title", &format!("{of_case}\ntitle"), 1);
        let case = parse(&text.replacen("closed = true", &format!("closed = true\n{of_curve}"), 1)).unwrap();
        let DomainSource::Curves { curves, .. } = &case.domain else { panic!() };
        let CurveShape::Polyline { corner_angle, .. } = curves[0].shape else { panic!() };
        corner_angle.to_degrees()
    };
    let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    is(degrees("", ""), 5.0);
    is(degrees("corner_angle = 12", ""), 12.0);
    is(degrees("corner_angle = 12", "corner_angle = 0"), 0.0);
    assert_eq!(
        refusal("closed = true", "closed = true\ncorner_angle = 91"),
        "plate.toml, line 16: corner_angle = 91 is not an angle from 0 to 90 degrees. Write for example \
         corner_angle = 5."
    );
    let mesh = "version = 1\ncorner_angle = 3\nmesh = \"a.msh\"";
    assert_eq!(
        parse(mesh).unwrap_err().to_string(),
        "plate.toml, line 2: The case has a mesh and a corner_angle. Remove corner_angle: it is for curves in the \
         plane."
    );
}

#[test]
fn a_tolerance_is_a_positive_length() {
    let text = PLATE.replacen("title", "tolerance = 1e-6\ntitle", 1);
    assert_eq!((parse(PLATE).unwrap().tolerance, parse(&text).unwrap().tolerance), (None, Some(1e-6)));
    assert!(refusal("title", "tolerance = 0\ntitle").contains("tolerance = 0 is not greater than 0"));
}

#[test]
fn angles_with_a_unit_and_numbers_in_quotes_are_refused() {
    assert_eq!(
        refusal("theta_rect = 120", "theta_rect = \"135deg\""),
        "plate.toml, line 7: theta_rect = \"135deg\" is not a number. Write degrees without a unit: theta_rect = 135."
    );
    assert_eq!(
        refusal("size_scale = 0.5", "size_scale = \"0.5\""),
        "plate.toml, line 6: size_scale = \"0.5\" is not a number. Write it without quotes: size_scale = 0.5."
    );
}

#[test]
fn refusals_say_what_where_and_what_to_do() {
    let refusals = [
        ("version = 1\n", ""),
        ("version = 1", "version = 2"),
        ("title", "titel"),
        ("gradation = 1.3", "gradation = 1"),
        ("gradation = 1.3", "symmetry = \"z\""),
        ("gradation = 1.3", "symmetry = true"),
        ("size_scale", "size_skale"),
        ("layers = 2", "layers = 2.5"),
        ("selection = \"shortest\"", "selection = \"longest\""),
        ("selection = \"shortest\"", "selection = [1, 2]"),
        ("[[curve]]\nname = \"frame\"", "[[curves]]\nname = \"frame\""),
        ("name = \"frame\"", "name = \"\""),
        ("\"polyline\"", "\"poly\""),
        ("[1, 1.5]", "[1, 1.5, 2]"),
        ("[1, 1.5]", "[1, \"1.5\"]"),
        ("[1, 1.5]", "[1, nan]"),
        ("closed = true", "closed = 1"),
        ("radius = 0.2", "radius = -0.2"),
        ("radius = 0.2", "radius = inf"),
        ("radius = 0.2", ""),
        ("radius = 0.2", "radius = 0.2\nradius = 0.3"),
        ("segments = 24", "segments = 0"),
        ("segments = 24", "segments = 99999999999999999999"),
        ("outer = [\"frame\"]", "outer = [\"frime\"]"),
        ("outer = [\"frame\"]", "outer = []"),
        ("[[\"hole\"]]", "[\"hole\"]"),
        ("h1 = ", "h3 = "),
        ("h2 = 0.25", "h2 = true"),
        ("h2 = 0.25", ""),
        ("[-1, \"1\"]", "[1]"),
        ("growth = 1.2", "growth = 0.9"),
        ("far = 0.1", "far = 1e-5"),
        ("title = \"Plate\"", "title = \"Plate\"\nmesh = \"plate.msh\""),
        ("title = \"Plate\"", "title = \"Plate\"\nsol = \"plate.sol\""),
        ("title = \"Plate\"", "title = Plate"),
    ];
    let said: Vec<_> = refusals.iter().map(|(from, to)| refusal(from, to)).collect();
    for line in &said {
        assert!(line.starts_with("plate.toml, line ") && !line.contains('\n'), "{line}");
    }
    insta::assert_snapshot!(said.join("\n"));
}

#[test]
fn an_arc_keeps_its_sense_and_a_full_turn_is_exact() {
    let arc = |from: &str, to: &str| -> Result<(f64, f64), Fault> {
        let text = format!("kind = \"arc\"\ncentre = [0.5, 0.5]\nfrom_angle = {from}\nto_angle = {to}");
        let case = parse(&PLATE.replacen("kind = \"circle\"\ncentre = [0.5, 0.5]", &text, 1))?;
        let DomainSource::Curves { curves, .. } = case.domain else { panic!() };
        match curves[1].shape {
            CurveShape::Arc { from_angle, to_angle, .. } => Ok((from_angle, to_angle)),
            _ => panic!(),
        }
    };
    assert_eq!(arc("0", "360").unwrap(), (0.0, std::f64::consts::TAU));
    assert_eq!(arc("90", "-90").unwrap(), (std::f64::consts::FRAC_PI_2, -std::f64::consts::FRAC_PI_2));
    assert!(arc("10", "10").is_err() && arc("0", "361").is_err());
    assert!(arc("\"0deg\"", "90").unwrap_err().to_string().contains("Write degrees without a unit"));
}

#[test]
fn mesh_paths_are_relative_to_the_case() {
    let case = parse("version = 1\nmesh = \"plate.msh\"\nsol = \"../plate.sol\"").unwrap();
    let DomainSource::Mesh { source: MeshSource::File { path, sol }, .. } = case.domain else { panic!() };
    assert_eq!(path, Path::new("cases/plate.msh"));
    assert_eq!(sol.unwrap(), Path::new("cases/../plate.sol"));
    assert_eq!(case.title, "plate");
}

#[test]
fn files_that_are_not_cases_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let fault = Case::read(folder.path()).unwrap_err();
    assert_eq!(fault.what, "This is a folder");
    let fault = Case::read(&folder.path().join("nothing.toml")).unwrap_err();
    assert!(fault.place.ends_with("nothing.toml") && fault.what.contains("No such file"), "{fault}");
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, [b'v', 0xff, 0xfe]).unwrap();
    assert_eq!(Case::read(&binary).unwrap_err().what, "The file is not text (byte 1)");
    let fault = Case::from_bytes(b"", "empty", "empty.toml", Path::new("")).unwrap_err();
    assert!(fault.what.contains("version"), "{fault}");
}

#[test]
fn deep_nesting_is_refused_and_does_not_overflow_the_stack() {
    let fault = parse(&format!("version = 1\nnotes = {}", "[".repeat(200_000))).unwrap_err();
    assert!(fault.what.contains("not TOML"), "{fault}");
}

#[test]
fn damaged_cases_are_read_or_refused_and_never_panic() {
    let pieces = ["[", "]", "\"", "=", "\n", "{", "}", "-", "nan", "1e999", "0x", "'''", "[[curve]]\n", "\u{fe}", ","];
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % n as u64) as usize
    };
    let mut refused = 0;
    for round in 0..1500 {
        let (name, text) = crate::core::case::built_in::CASES[round % crate::core::case::built_in::CASES.len()];
        let mut characters: Vec<char> = text.chars().collect();
        for _ in 0..=random(3) {
            let at = random(characters.len());
            match random(3) {
                0 => drop(characters.drain(at..(at + 1 + random(12)).min(characters.len()))),
                1 => drop(characters.splice(at..at, pieces[random(pieces.len())].chars())),
                _ => characters.truncate(at.max(1)),
            }
        }
        let damaged: String = characters.into_iter().collect();
        if let Err(fault) = Case::parse(&damaged, name, "damaged.toml", Path::new("")) {
            refused += 1;
            assert!(fault.place.starts_with("damaged.toml") && !fault.what.is_empty(), "{fault}");
        }
    }
    assert!(refused > 500, "{refused}");
}

/// A case with a background over the unit square.
fn with_background(elements: &str) -> String {
    format!(
        "version = 1\n[background]\npoints = [[0, 0], [1, 0], [1, 1], [0, 1]]\n{elements}\n\
         [[metric]]\nkind = \"uniform\"\nh = 1\n"
    )
}

#[test]
fn a_case_may_contain_a_small_background() {
    let parse = |elements| Case::parse(&with_background(elements), "a", "a.toml", Path::new(""));
    let case = parse("triangles = []\nquads = [[0, 1, 2, 3]]").unwrap();
    let DomainSource::Elements { points, triangles, quads } = case.domain else { panic!() };
    assert_eq!((points.len(), triangles.len(), quads), (4, 0, vec![[0, 1, 2, 3]]));
    for (elements, said) in [
        ("triangles = [[0, 1, 4]]", "a.toml, line 4: triangles[0][2] = 4 is not a whole number from 0 to 3"),
        ("triangles = [[0, 1]]", "a.toml, line 4: triangles[0] = [0, 1] is not a list of 3 points by number"),
        ("quads = []", "The key \"triangles\" is missing"),
        ("triangles = []\nmesh = \"a\"", "The key \"mesh\" is not known"),
    ] {
        let fault = parse(elements).unwrap_err().to_string();
        assert!(fault.contains(said), "{fault}");
    }
    let both = with_background("triangles = []").replace("version = 1", "version = 1\nmesh = \"a.msh\"");
    let fault = Case::parse(&both, "a", "a.toml", Path::new("")).unwrap_err().to_string();
    assert!(fault.contains("The case has a background and a mesh. Remove either background or mesh"), "{fault}");
}

#[test]
fn an_invalid_background_in_a_case_is_refused() {
    for (elements, said) in [
        ("triangles = []\nquads = [[0, 3, 2, 1]]", "quads[0] is not strictly convex and anticlockwise"),
        ("triangles = [[0, 1, 2]]", "an all-quad mesh needs an even count"),
        ("triangles = [[0, 1, 2], [0, 3, 2]]", "The background needs a repair: 1 clockwise triangle"),
        ("triangles = [[0, 1, 2], [0, 1, 3]]", "overlap"),
    ] {
        let case = Case::parse(&with_background(elements), "a", "a.toml", Path::new("")).unwrap();
        let fault = crate::core::convert::background(&case, &mut crate::core::progress::Nobody).unwrap_err();
        assert!(fault.to_string().contains(said), "{fault}");
    }
}

#[test]
fn loops_with_layers_are_a_list_of_names() {
    let parse = |value: &str| {
        let text = "version = 1\nmesh = \"a.msh\"\n[parameters]\nlayered_loops = ";
        Case::parse(&format!("{text}{value}\n"), "a", "a.toml", Path::new(""))
    };
    let long = "a name that is much longer than a message would show";
    let names = parse(&format!("[\"hole\", \"{long}\"]")).unwrap().parameters.layered_loops;
    assert_eq!(names, ["hole", long]);
    assert!(parse("[]").unwrap().parameters.layered_loops.is_empty());
    for (wrong, said) in [("\"hole\"", " = \"hole\" is not a list of names"), ("[1]", "[0] = 1 is not a text")] {
        let fault = parse(wrong).unwrap_err().to_string();
        assert!(fault.contains(&format!("a.toml, line 4: layered_loops{said}")), "{fault}");
    }
}

#[test]
fn every_parameter_can_be_written_in_a_case_file_with_its_word_in_quotes() {
    for parameters in [Parameters::default(), Parameters::default().read_as_paper()] {
        let mut text = PLATE.split("[parameters]").next().unwrap().to_owned() + "[parameters]\n";
        for key in Parameters::KEYS {
            let value = parameters.text_of(key).unwrap();
            text += &match key {
                "layered_loops" | "faces" => format!("{key} = []\n"),
                _ if value.parse::<f64>().is_ok() || value.parse::<bool>().is_ok() => format!("{key} = {value}\n"),
                _ => format!("{key} = \"{value}\"\n"),
            };
        }
        text += &PLATE[PLATE.find("[[curve]]").unwrap()..];
        assert_eq!(parse(&text).unwrap().parameters, parameters);
    }
}
