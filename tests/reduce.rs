//! `quadfront reduce`: planted failures become cases of a few curves or triangles that still show them. Curves and
//! triangles are counted by readers of the test, and verdicts are those of the ordinary commands.

#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadfront")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Reduces a case twice, in folders of their own, to the same bytes. Returns the folder of the smaller case, which is
/// `small.toml`, and the files in it.
fn reduced(folder: &Path, case: &str, condition: &str) -> (PathBuf, Vec<(String, Vec<u8>)>) {
    let made = ["one", "two"].map(|name| {
        let own = folder.join(name);
        fs::create_dir(&own).unwrap();
        let input = folder.join(case).display().to_string();
        let output = run(&own, &["reduce", &input, "--while", condition, "-o", "small.toml"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let mut files: Vec<_> = fs::read_dir(&own)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap()))
            .collect();
        files.sort();
        (own, files)
    });
    assert!(made[0].1 == made[1].1, "the same bytes twice");
    let [first, _] = made;
    first
}

/// The number of tables `[[key]]` in a case.
fn count(case: &str, key: &str) -> usize {
    let table: toml::Table = case.parse().unwrap();
    table.get(key).and_then(toml::Value::as_array).map_or(0, Vec::len)
}

/// A plate with 144 holes: circles, and one with a notch of 14.5 degrees.
fn plate_with_a_notch() -> String {
    let mut case = String::from(
        "version = 1\ngradation = 1.5\n[parameters]\ntheta_rect = 130\nc = 1.9\n\
         [[metric]]\nkind = \"uniform\"\nh = 0.3\n\
         [[metric]]\nkind = \"distance\"\ncurves = [\"frame\", \"hole 3\"]\nfirst = 0.2\ngrowth = 1.2\nfar = 0.5\n\
         [[curve]]\nname = \"frame\"\nkind = \"polyline\"\nclosed = true\n\
         points = [[0, 0], [6, 0], [12, 0], [12, 12], [0, 12]]\n",
    );
    let mut holes = Vec::new();
    for i in 0..144 {
        let (x, y) = (f64::from(i % 12) + 0.5, f64::from(i / 12) + 0.5);
        let shape = if i == 55 {
            let corners =
                [(-0.3, -0.3), (0.35, -0.3), (0.35, 0.3), (-0.3, 0.3), (-0.3, 0.07), (0.25, 0.0), (-0.3, -0.07)];
            let corners: Vec<_> = corners.iter().map(|(a, b)| format!("[{}, {}]", x + a, y + b)).collect();
            format!("kind = \"polyline\"\nclosed = true\npoints = [{}]", corners.join(", "))
        } else {
            format!("kind = \"circle\"\nradius = 0.25\ncentre = [{x}, {y}]")
        };
        write!(case, "[[curve]]\nname = \"hole {i}\"\n{shape}\n").unwrap();
        holes.push(format!("[\"hole {i}\"]"));
    }
    case + &format!("[[face]]\nname = \"plate\"\nouter = [\"frame\"]\nholes = [{}]\n", holes.join(", "))
}

#[test]
fn a_plate_of_many_holes_becomes_the_hole_with_the_notch() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plate.toml"), plate_with_a_notch()).unwrap();
    let (own, files) = reduced(folder.path(), "plate.toml", "min_angle < 20");
    assert_eq!(files.len(), 1);
    let case = text(&files[0].1);
    assert!(20 * count(&case, "curve") < 145, "{case}");
    assert_eq!((count(&case, "metric"), count(&case, "parameters")), (1, 0), "{case}");
    assert!(case.starts_with("# plate shows: min_angle < 20\n") && case.contains("145 curves -> "), "{case}");
    let output = run(&own, &["convert", "small.toml", "--report", "small.json", "--quiet"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&fs::read(own.join("small.json")).unwrap()).unwrap();
    assert!(report["mesh"]["metric_angles"]["min"].as_f64().unwrap() < 20.0);
}

/// A square of triangles, 50 by 50 squares cut along their diagonals, with one point moved.
fn square_with_a_point_moved(by: [f64; 2]) -> String {
    const N: usize = 50;
    let mut obj = String::new();
    for k in 0..(N + 1) * (N + 1) {
        let [x, y] = [k % (N + 1), k / (N + 1)].map(|i| i as f64 / N as f64);
        let [dx, dy] = if k == 25 * (N + 1) + 20 { by } else { [0.0; 2] };
        writeln!(obj, "v {} {} 0", x + dx, y + dy).unwrap();
    }
    for k in 0..N * N {
        let a = k / N * (N + 1) + k % N + 1;
        writeln!(obj, "f {a} {} {}\nf {a} {} {}", a + 1, a + N + 2, a + N + 2, a + N + 1).unwrap();
    }
    obj
}

/// The number of faces of an OBJ.
fn faces(obj: &str) -> usize {
    obj.lines().filter(|line| line.starts_with("f ")).count()
}

#[test]
fn a_mesh_of_thousands_of_triangles_becomes_those_around_the_flaw() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = square_with_a_point_moved([0.05, 0.003]);
    assert_eq!(faces(&mesh), 5000);
    fs::write(folder.path().join("square.obj"), mesh).unwrap();
    let (own, files) = reduced(folder.path(), "square.obj", "is refused");
    let names: Vec<_> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["small.obj", "small.toml"]);
    let small = text(&files[0].1);
    assert!(faces(&small) <= 4 && small.lines().filter(|line| line.starts_with("v ")).count() <= 6, "{small}");
    let [before, after] = [("..", "square.obj"), (".", "small.toml")].map(|(folder, name)| {
        let output = run(&own.join(folder), &["convert", name]);
        assert_eq!(output.status.code(), Some(2));
        text(&output.stderr)
    });
    assert!(
        before.contains("overlap: they lie on the same side of an edge")
            && after.contains("overlap: they lie on the same")
    );
}

#[test]
fn a_mesh_keeps_the_triangles_that_make_a_bad_quadrilateral() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("square.obj"), square_with_a_point_moved([0.0195, 0.0])).unwrap();
    let (own, files) = reduced(folder.path(), "square.obj", "kind == formed && quad.quality < 0.9");
    assert!(20 * faces(&text(&files[0].1)) < 5000);
    let case = text(&files[1].1);
    let step: u64 = case.split("--at step=").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let output = run(&own, &["convert", "small.toml", "--events", "-", "--quiet"]);
    let events = text(&output.stdout);
    let event = |line: &str| serde_json::from_str::<Value>(line).unwrap();
    let found = events.lines().map(event).find(|event| event["step"].as_u64() == Some(step)).unwrap();
    assert!(found["kind"] == "formed" && found["quality"].as_f64().unwrap() < 0.9, "{found}");
}

/// Thirty plates side by side; the hole of one of them floats above its plate.
fn plates() -> String {
    let mut case = String::from("version = 1\n[[metric]]\nkind = \"uniform\"\nh = 0.4\n");
    for i in 0..30 {
        let z = if i == 17 { 0.3 } else { 0.0 };
        write!(
            case,
            "[[surface]]\nname = \"plane {i}\"\nkind = \"plane\"\ncorner = [{i}, 0, 0]\nu = [1, 0, 0]\nv = [0, 1, 0]\n\
             [[curve]]\nname = \"hole {i}\"\nkind = \"circle\"\ncentre = [{}, 0.5, {z}]\nradius = 0.2\n\
             [[face]]\nname = \"plate {i}\"\nsurface = \"plane {i}\"\nholes = [[\"hole {i}\"]]\n",
            f64::from(i) + 0.5
        )
        .unwrap();
    }
    case
}

#[test]
fn a_case_of_many_faces_becomes_the_one_that_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plates.toml"), plates()).unwrap();
    let (own, files) = reduced(folder.path(), "plates.toml", "is refused");
    let case = text(&files[0].1);
    assert_eq!(["surface", "face", "curve"].map(|key| count(&case, key)), [1, 1, 1], "{case}");
    assert!(case.contains("plate 17") && case.contains("30 faces -> 1"), "{case}");
    let output = run(&own, &["convert", "small.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("\"hole 17\" does not lie on the surface"), "{}", text(&output.stderr));
}

/// A run of a plate with these edits.
fn plate_run(edits: &str) -> String {
    let case = "version = 1\n[[metric]]\nkind = \"uniform\"\nh = 0.2\n[[curve]]\nname = \"o\"\nkind = \"polyline\"\n\
                closed = true\npoints = [[0, 0], [2, 0], [2, 1], [0, 1]]\n[[face]]\nname = \"f\"\nouter = [\"o\"]\n";
    format!("run = 1\n[case]\nname = \"plate\"\ntext = '''\n{case}'''\n{edits}")
}

/// The first event of a run that a test is after, and how many there are before it that form quadrilaterals.
fn first_event(folder: &Path, kind: &str) -> (Value, usize) {
    let output = run(folder, &["convert", "small.toml", "--events", "-", "--quiet"]);
    let events: Vec<Value> = text(&output.stdout).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let at = events.iter().position(|event| event["kind"] == kind).unwrap();
    (events[at].clone(), events[..at].iter().filter(|event| event["kind"] == "formed").count())
}

#[test]
fn edits_that_do_not_matter_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let edits = "[[edit]]\nstep = 3\nc = 1.5\n[[edit]]\nstep = 5\nselection = \"level\"\n\
                 [[edit]]\nstep = 9\ntheta_rect = 120\n";
    fs::write(folder.path().join("plate.run.toml"), plate_run(edits)).unwrap();
    let (own, files) = reduced(folder.path(), "plate.run.toml", "kind == formed");
    let small = text(&files[0].1);
    assert!(!small.contains("[[edit]]") && small.contains("3 edits -> 0"), "{small}");
    assert!(run(&own, &["convert", "small.toml", "--quiet"]).status.success());
}

#[test]
fn a_choice_of_a_base_that_matters_stays_and_moves_to_the_first_step_at_which_it_does() {
    let folder = tempfile::tempdir().unwrap();
    // The segment is never on the front, so that the choice is lost.
    let edits = "[[edit]]\nstep = 3\nc = 1.5\n[[edit]]\nstep = 40\nbase = [900, 901]\n\
                 [[edit]]\nstep = 90\ntheta_rect = 120\n";
    fs::write(folder.path().join("plate.run.toml"), plate_run(edits)).unwrap();
    let (own, files) = reduced(folder.path(), "plate.run.toml", "kind == pick_lost && nq >= 3");
    let small = text(&files[0].1);
    let run_file: toml::Table = small.parse().unwrap();
    let [edit] = run_file["edit"].as_array().unwrap().as_slice() else { panic!("{small}") };
    let step = edit["step"].as_integer().unwrap();
    assert!(small.contains("3 edits -> 1") && edit["base"].as_array().unwrap().len() == 2, "{small}");
    let (lost, formed) = first_event(&own, "pick_lost");
    assert!(formed >= 3 && (1..40).contains(&step) && lost["step"].as_i64().unwrap() > step, "{small}");
    // One step earlier it would be lost too early.
    let earlier = small.replace(&format!("step = {step}\nbase"), &format!("step = {}\nbase", step - 1));
    assert_ne!(earlier, small);
    fs::write(own.join("small.toml"), earlier).unwrap();
    assert!(first_event(&own, "pick_lost").1 < 3);
}

#[test]
fn a_changed_parameter_that_matters_becomes_one_of_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let edits = "[[edit]]\nstep = 3\nc = 1.5\n[[edit]]\nstep = 20\ntheta_rect = 90\n\
                 [[edit]]\nstep = 90\nselection = \"level\"\n";
    fs::write(folder.path().join("plate.run.toml"), plate_run(edits)).unwrap();
    let (own, files) = reduced(folder.path(), "plate.run.toml", "kind == rolled_back");
    let small = text(&files[0].1);
    assert!(small.contains("3 edits -> 0") && small.contains("0 parameters -> 1"), "{small}");
    assert!(small.contains("[parameters]\ntheta_rect = 90"), "{small}");
    first_event(&own, "rolled_back");
    // Without it nothing is rolled back.
    fs::write(own.join("small.toml"), small.replace("theta_rect = 90", "")).unwrap();
    let output = run(&own, &["convert", "small.toml", "--events", "-", "--quiet"]);
    assert!(output.status.success() && !text(&output.stdout).contains("rolled_back"), "{small}");
}

/// The panic is planted by the environment alone: no thread can have a stack of this size, and faces are converted on
/// threads where there are two.
#[cfg(unix)]
#[test]
fn a_case_that_panics_becomes_the_smallest_one_that_panics_at_the_same_place() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plates.toml"), plates().replace(", 0.3]", ", 0]")).unwrap();
    let program = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_quadfront"));
        command.current_dir(folder.path()).args(arguments).env("RUST_MIN_STACK", (1_u64 << 62).to_string());
        command.output().unwrap()
    };
    let [one, two] = ["one.toml", "two.toml"].map(|name| {
        let output = program(&["reduce", "plates.toml", "--while", "panics", "-o", name]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(!text(&output.stderr).contains("panicked"), "tries say nothing: {}", text(&output.stderr));
        fs::read_to_string(folder.path().join(name)).unwrap()
    });
    assert_eq!(one.replace("one.", "two."), two, "the same bytes twice");
    assert_eq!(["surface", "face", "curve"].map(|key| count(&one, key)), [2, 2, 0], "{one}");
    let said = one.split_once("The program panics at ").unwrap().1.split_once(": ").unwrap().0;
    assert!(said.starts_with("rayon-core-") && said.contains("/src/registry.rs:"), "{said}");
    let output = program(&["convert", "one.toml"]);
    assert_eq!(output.status.code(), Some(101));
    assert!(text(&output.stderr).contains(&format!("/{said}:")), "{}", text(&output.stderr));
    let harmless = run(folder.path(), &["convert", "one.toml", "--quiet"]);
    assert!(harmless.status.success(), "{}", text(&harmless.stderr));
}

#[test]
fn what_is_not_shown_and_what_is_not_known_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let message = |condition: &str| {
        let output = run(folder.path(), &["reduce", "example1", "--while", condition, "-o", "small.toml"]);
        assert_eq!(output.status.code(), Some(2));
        text(&output.stderr)
    };
    assert!(message("min_angle < 5").contains("does not show it: min_angle < 5. The run ends with min_angle = "));
    assert!(message("is refused").contains("converted to a valid mesh"));
    assert!(
        message("quad.min_angel < 5").contains("position 1")
            && message("quad.min_angel < 5").contains("quad.min_angle")
    );
    assert!(message("last_resrt > 0").contains("\"last_resort\""));
    assert!(message("last_resort > 0 && kind == seamed").contains("is about a step"));
    assert!(message("panics").contains("does not show it"));
    assert!(message("exit 1").contains("does not show it: exit 1. The case is converted to a valid mesh"));
    assert!(!folder.path().join("small.toml").exists());
}
