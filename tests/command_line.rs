//! The program as a person or a script calls it: exit codes, what goes where, and one clear line for whatever is wrong.

#![allow(clippy::unwrap_used)]

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use quadfront::core::formats::Format;
use quadfront::core::formats::format::read_bytes;

fn command(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quadfront"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(arguments: &[&str], folder: &Path) -> Output {
    command(arguments, folder).output().unwrap()
}

fn run_with_input(arguments: &[&str], folder: &Path, input: &[u8]) -> Output {
    let mut child = command(arguments, folder).stdin(Stdio::piped()).spawn().unwrap();
    // A program that refuses its arguments does not read its input.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

fn said(output: &Output) -> (i32, String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

/// One quadrilateral, or where `flat` one that is not convex.
fn square_obj(flat: bool) -> String {
    let corner = if flat { "0.2 0.2" } else { "1 1" };
    format!("v 0 0 0\nv 1 0 0\nv {corner} 0\nv 0 1 0\nf 1 2 3 4\n")
}

#[test]
fn example_1_becomes_a_mesh_a_report_and_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["convert", "example1", "--out", "a.msh", "--report", "a.json", "--picture", "a.svg"];
    let (code, out, err) = said(&run(&arguments, folder.path()));
    assert_eq!((code, err.as_str()), (0, ""), "nothing but the summary where there is no terminal");
    assert!(out.starts_with("example1: ") && out.contains("1 face; valid") && out.contains("last resort"), "{out}");
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    assert_eq!(report["valid"], true);
    assert_eq!(report["mesh"]["triangles"], 0);
    let quads = report["mesh"]["quads"].as_u64().unwrap();
    assert!((200..500).contains(&quads), "{quads}");
    let resort = &report["last_resort"];
    let front = ["front_formed", "front_closed"].map(|kind| report["events"][kind].as_u64().unwrap());
    assert_eq!(resort["of"].as_u64().unwrap(), front[0] + front[1] + resort["quads"].as_u64().unwrap());
    assert!(resort["share"].as_f64().unwrap() < 0.25, "{resort}");
    assert!(report["timing"]["total"].as_f64().unwrap() > 0.0);
    assert_eq!(report["parameters"]["theta_rect"], 135);
    assert!(std::fs::read_to_string(folder.path().join("a.svg")).unwrap().ends_with("</svg>\n"));
    let (code, out, _) = said(&run(&["check", "a.msh"], folder.path()));
    assert_eq!(code, 0);
    assert!(out.contains(&format!("{quads} quadrilaterals")) && out.ends_with("sound\n"), "{out}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "nothing is left beside");
}

#[test]
fn the_readme_shows_the_summary_and_the_picture_of_today() {
    let folder = tempfile::tempdir().unwrap();
    let (code, out, _) = said(&run(&["convert", "example1", "-o", "a.msh", "--picture", "a.svg"], folder.path()));
    assert_eq!(code, 0);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let summary: Vec<&str> = out.lines().filter(|line| !line.starts_with("  time ")).collect();
    assert!(readme.contains(&summary.join("\n")), "{out}");
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    assert!(read(&folder.path().join("a.svg")) == read(&root.join("docs/example1.svg")), "docs/example1.svg is old");
}

#[test]
fn two_runs_give_the_same_bytes_but_for_the_timing() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["msh", "mesh", "vtu", "obj", "inp"];
    for name in ["a", "b"] {
        for extension in files {
            let (out, report) = (format!("{name}.{extension}"), format!("{name}.json"));
            let run = run(&["convert", "two-faces", "-q", "-o", &out, "--report", &report], folder.path());
            assert_eq!(said(&run), (0, String::new(), String::new()));
        }
    }
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    for extension in files {
        assert_eq!(bytes(&format!("a.{extension}")), bytes(&format!("b.{extension}")), "{extension}");
    }
    let report = |name: &str| {
        let mut report: serde_json::Value = serde_json::from_slice(&bytes(name)).unwrap();
        report.as_object_mut().unwrap().remove("timing").unwrap();
        report
    };
    assert_eq!(report("a.json"), report("b.json"));
}

#[test]
fn a_mesh_on_standard_output_is_not_mixed_with_the_summary() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["convert", "uniform", "--set", "size_scale=4", "-o", "-", "--format", "obj"];
    let (code, out, err) = said(&run(&arguments, folder.path()));
    assert_eq!(code, 0);
    assert!(!out.contains("quadrilaterals") && out.lines().any(|l| l.starts_with("f ")), "{out}");
    assert!(err.contains("quadrilaterals"), "{err}");
}

#[test]
fn cases_and_meshes_come_by_standard_input() {
    let folder = tempfile::tempdir().unwrap();
    let (_, case, _) = said(&run(&["cases", "uniform"], folder.path()));
    let arguments = ["convert", "-", "--set", "size_scale=4", "-q", "-o", "-", "--format", "msh"];
    let (code, piped, err) = said(&run_with_input(&arguments, folder.path(), case.as_bytes()));
    assert_eq!((code, err.as_str()), (0, ""));
    let named = ["convert", "uniform", "--set", "size_scale=4", "-q", "-o", "-", "--format", "msh"];
    assert_eq!(piped, said(&run(&named, folder.path())).1);
    let check = run_with_input(&["check", "-", "--from", "msh"], folder.path(), piped.as_bytes());
    assert_eq!(said(&check).0, 0);
    let render = run_with_input(&["render", "-", "--from", "msh", "-o", "-"], folder.path(), piped.as_bytes());
    assert!(said(&render).1.starts_with("<svg"));
}

#[test]
fn the_background_is_written_with_its_metric() {
    let folder = tempfile::tempdir().unwrap();
    let (code, out, _) = said(&run(&["background", "uniform", "--set", "size_scale=4", "-o", "a.mesh"], folder.path()));
    assert_eq!(code, 0);
    assert!(out.contains("triangles") && out.contains("edge length"), "{out}");
    assert!(folder.path().join("a.sol").is_file());
    let (code, out, err) = said(&run(&["check", "a.mesh"], folder.path()));
    assert_eq!(code, 1, "triangles are no quadrilaterals: {out} {err}");
    assert_eq!(said(&run(&["check", "a.mesh", "--triangles"], folder.path())).0, 0);
}

/// The values of element data, by triangles and quadrilaterals, and the number of lines in the group "front".
fn state_of(folder: &Path, name: &str) -> (Vec<f64>, usize, usize, usize) {
    let bytes = std::fs::read(folder.join(name)).unwrap();
    let mesh = read_bytes(name, &bytes, Format::Msh).unwrap();
    let live = mesh.element_data.iter().find(|data| data.name == "live").unwrap().values.clone();
    assert!(["level", "region"].iter().all(|name| mesh.element_data.iter().any(|data| data.name == *name)));
    let front = mesh.front_lines().count();
    (live, mesh.triangles.len(), mesh.quads.len(), front)
}

#[test]
fn a_conversion_stops_where_so_many_quadrilaterals_stand() {
    let folder = tempfile::tempdir().unwrap();
    let case = ["convert", "example1", "--set", "size_scale=2"];
    let at = |stop: &str, out: &str| {
        let output = run(&[&case[..], &["-q", "--at", stop, "-o", out, "--events", "a.jsonl"]].concat(), folder.path());
        assert_eq!(said(&output), (0, String::new(), String::new()));
        let events = std::fs::read_to_string(folder.path().join("a.jsonl")).unwrap();
        events.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()).collect::<Vec<_>>()
    };
    let events = at("nq=20", "a.msh");
    let (live, triangles, quads, front) = state_of(folder.path(), "a.msh");
    assert_eq!(quads, 20);
    assert!(triangles > 20 && front > 10, "{triangles} triangles, {front} front segments");
    assert!(live.iter().take(triangles).all(|l| *l == 1.0) && live.iter().skip(triangles).all(|l| *l == 0.0));
    let last = events.last().unwrap();
    assert_eq!(last["nq"], 20);
    assert!(events.iter().any(|event| event["kind"] == "formed" && event["nq"] == 20));
    assert!(!["formed", "enhanced"].map(|kind| last["kind"] == kind).contains(&true), "{last}");
    // The same place, by the number of its step.
    let step = format!("step={}", last["step"]);
    assert_eq!(at(&step, "b.msh"), events);
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("a.msh"), bytes("b.msh"));
    // Before the first step everything is live, and the front is the boundary.
    assert!(at("step=0", "c.msh").is_empty());
    let (_, _, quads, front) = state_of(folder.path(), "c.msh");
    assert_eq!(quads, 0);
    assert!(front > 0 && front.is_multiple_of(2));
    at("nq=20", "a.vtu");
    for (mesh, code) in [("a.vtu", 0), ("a.msh", 0)] {
        assert_eq!(said(&run(&["check", mesh, "--triangles", "--seams", "-q"], folder.path())).0, code, "{mesh}");
    }
    let (code, _, err) = said(&run(&[&case[..], &["--at", "nq=100000"]].concat(), folder.path()));
    assert!(code == 2 && err.contains("The conversion ends after step"), "{err}");
}

#[test]
fn every_step_is_told_as_one_line_of_json_and_the_mesh_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let case = ["convert", "example1", "--set", "size_scale=2", "-q"];
    let told = ["-o", "a.msh", "--events", "-", "--report", "a.json"];
    let (code, out, err) = said(&run(&[&case[..], &told[..]].concat(), folder.path()));
    assert_eq!((code, err.as_str()), (0, ""));
    assert_eq!(said(&run(&[&case[..], &["-o", "b.msh"]].concat(), folder.path())).0, 0);
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("a.msh"), bytes("b.msh"));
    let events: Vec<serde_json::Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(events.iter().zip(1..).all(|(event, step)| event["step"] == step));
    let report: serde_json::Value = serde_json::from_slice(&bytes("a.json")).unwrap();
    let count = |kind: &str| events.iter().filter(|event| event["kind"] == kind).count();
    assert_eq!(report["events"]["front_formed"], count("formed"));
    assert_eq!(report["events"]["front_rolled_back"], count("rolled_back"));
    assert_eq!(report["events"]["front_step"], events.len());
    assert_eq!(events.last().unwrap()["nq"], report["mesh"]["quads"]);
    let base = events.iter().find(|event| event["kind"] == "base_selected").unwrap();
    assert!(base["a"].is_u64() && base["within_reach"].is_boolean());
    assert!(base["theta"][0].as_f64().unwrap() > 10.0, "degrees: {base}");
    // A conversion that cannot be made leaves no file.
    let (code, _, err) =
        said(&run(&["convert", "uniform", "--set", "max_quads=5", "--events", "c.jsonl"], folder.path()));
    assert!(code == 2 && err.lines().count() == 1 && !err.contains("conversion failed"), "{err}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "nothing is left beside");
}

#[test]
fn the_front_is_drawn_alone_and_as_a_strip() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |arguments: &[&str]| {
        let case = ["render", "example1", "--set", "size_scale=2", "-q", "-o", "-"];
        let (code, out, err) = said(&run(&[&case[..], arguments].concat(), folder.path()));
        assert_eq!((code, err.as_str()), (0, ""));
        out
    };
    let (front, base) = ("#00659C", "#AD4E00");
    let plain = draw(&[]);
    assert!(!plain.contains(front) && !plain.contains(base));
    let at = draw(&["--at", "nq=20"]);
    assert!(at.contains(front) && at.contains(base) && at.contains("at nq=20</desc>"), "front and base are shown");
    let strip = draw(&["--at", "nq=10,20"]);
    assert!(strip.contains(">(a) NQ = 10</text>") && strip.contains(">(b) NQ = 20</text>"));
    assert_eq!(strip.matches(base).count(), 2);
    let arguments = ["convert", "example1", "--set", "size_scale=2", "-q", "--at", "nq=20", "--picture", "-"];
    assert_eq!(said(&run(&arguments, folder.path())).1, at);
}

#[test]
fn the_paper_s_reading_is_one_flag_and_single_parameters_come_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        ["convert", "example1", "--paper", "--set", "size_scale=2", "--set", "c=1.5", "--report", "a.json", "-q"];
    assert_eq!(said(&run(&arguments, folder.path())), (0, String::new(), String::new()));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    let parameters = &report["parameters"];
    assert_eq!((&report["valid"], &parameters["size_scale"], &parameters["c"]), (&true.into(), &2.into(), &1.5.into()));
    assert_eq!((&parameters["bisector"], &parameters["seaming"]), (&false.into(), &true.into()));
    assert_eq!(parameters["selection_window"], "physical_length");
}

#[test]
fn switches_are_read_from_a_case_file() {
    let folder = tempfile::tempdir().unwrap();
    let (_, case, _) = said(&run(&["cases", "uniform"], folder.path()));
    let switches = "\n[parameters]\nsize_scale = 4\nseaming = false\npost_processing = false\n";
    assert!(!case.contains("[parameters]"));
    std::fs::write(folder.path().join("a.toml"), case.clone() + switches).unwrap();
    let (code, _, err) = said(&run(&["convert", "a.toml", "-q", "--report", "-"], folder.path()));
    assert_eq!((code, err.as_str()), (0, ""));
    std::fs::write(folder.path().join("b.toml"), case + "\n[parameters]\nseaming = \"no\"\n").unwrap();
    let (code, _, err) = said(&run(&["convert", "b.toml"], folder.path()));
    assert!(code == 2 && err.contains("Write seaming = true or seaming = false"), "{err}");
}

#[test]
fn an_invalid_result_is_reported_and_not_written() {
    let folder = tempfile::tempdir().unwrap();
    // Four quadrilaterals on a whole sphere fold over it.
    let line = ["convert", "sphere", "--set", "size_scale=8", "-o", "a.obj", "--report", "a.json"];
    let (code, out, err) = said(&run(&line, folder.path()));
    assert_eq!(code, 1, "{err}");
    assert!(
        out.contains("NOT VALID")
            && err.contains("is invalid")
            && err.contains("other sizes")
            && err.contains("No mesh was written"),
        "{out}{err}"
    );
    assert!(folder.path().join("a.json").is_file() && !folder.path().join("a.obj").exists());
}

#[test]
fn an_invalid_mesh_is_exit_1_and_an_unreadable_one_exit_2() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("good.obj"), square_obj(false)).unwrap();
    std::fs::write(folder.path().join("bad.obj"), square_obj(true)).unwrap();
    std::fs::write(folder.path().join("broken.obj"), "v 0 0\nf 1 2 3\n").unwrap();
    assert_eq!(said(&run(&["check", "good.obj"], folder.path())).0, 0);
    let (code, _, err) = said(&run(&["check", "bad.obj", "--report", "bad.json"], folder.path()));
    assert_eq!(code, 1);
    assert!(err.starts_with("error: bad.obj: ") && err.lines().count() == 1, "{err}");
    assert!(folder.path().join("bad.json").is_file());
    assert_eq!(said(&run(&["check", "broken.obj"], folder.path())).0, 2);
    assert_eq!(said(&run(&["check", "example1"], folder.path())).0, 2);
}

#[test]
fn what_a_mesh_file_has_and_the_result_does_not_carry_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let text = "MeshVersionFormatted 2\nDimension 3\nVertices 5\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n\
                Triangles 2\n1 2 3 0\n1 3 4 0\nTetrahedra 2\n1 2 3 5 0\n1 3 4 5 0\nEnd\n";
    std::fs::write(folder.path().join("a.mesh"), text).unwrap();
    let told = "not read: tetrahedron (2 times)";
    for line in [["convert", "a.mesh", "--report", "a.json"].as_slice(), &["background", "a.mesh"]] {
        let (code, out, err) = said(&run(line, folder.path()));
        assert_eq!(code, 0, "{err}");
        assert!(out.contains("  not read         tetrahedron (2 times)\n"), "{out}");
    }
    let (_, out, _) = said(&run(&["check", "a.mesh", "--report", "b.json"], folder.path()));
    assert!(out.contains(&format!("{told}\n")), "{out}");
    for (report, key) in [("a.json", "repairs"), ("b.json", "not_read")] {
        let text = std::fs::read_to_string(folder.path().join(report)).unwrap();
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert!(report[key].as_array().unwrap().contains(&told.into()), "{text}");
    }
}

#[test]
fn whatever_is_wrong_is_one_line_with_exit_2() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| std::fs::write(folder.path().join(name), text).unwrap();
    write("unknown.toml", b"version = 1\ntitel = \"A\"\n");
    write("binary.toml", &[0xff, 0xfe, 0x00]);
    write("empty.toml", b"");
    write("odd.md", b"+++\ntitle = \"T\"\ncase = \"figure-5\"\n+++\n# One {goo: \"end\"}\nText.\n");
    write("empty.msh", b"");
    write("noise.msh", b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 99999999999999 1 1\n");
    std::fs::create_dir(folder.path().join("folder.toml")).unwrap();
    let lines: [(&[&str], &str); 22] = [
        (&["convert", "exampel1"], "nearest built-in case is \"example1\""),
        (&["convert", "unknown.toml"], "unknown.toml, line 2: The key \"titel\" is not known"),
        (&["convert", "binary.toml"], "not text"),
        (&["convert", "empty.toml"], "version"),
        (&["convert", "folder.toml"], "folder"),
        (&["convert", "nothing.toml"], "No such file"),
        (&["convert", "nothing.msh"], "No such file"),
        (&["convert", "empty.msh"], "empty"),
        (&["convert", "noise.msh"], "noise.msh"),
        (&["convert", "uniform", "-o", "a.png"], ".png"),
        (&["convert", "uniform", "-o", "nowhere/a.msh"], "\"nowhere\" does not exist"),
        (&["convert", "uniform", "-o", "-"], "--format"),
        (&["convert", "uniform", "-o", "a.obj", "--msh2"], "--msh2"),
        (&["convert", "uniform", "-o", "a.msh", "--report", "a.msh"], "same target"),
        (&["convert", "uniform", "--picture", "a.jpg"], ".svg"),
        (&["convert", "uniform", "--sol", "a.sol"], "--sol"),
        (&["convert", "uniform", "--set", "theta_rect=135deg"], "Write degrees without a unit: theta_rect = 135"),
        (&["convert", "uniform", "--set", "size=1"], "size_scale"),
        (&["convert", "uniform", "--report", "a", "--events", "a"], "same target"),
        (&["cases", "gaer"], "\"gear\""),
        (&["lesson", "figur-4"], "\"figure-4\""),
        (&["lesson", "odd.md"], "odd.md, line 5: There is no attribute \"goo\""),
    ];
    for (arguments, words) in lines {
        let (code, out, err) = said(&run(arguments, folder.path()));
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {err}");
        assert!(err.starts_with("error: ") && err.lines().count() == 1 && err.contains(words), "{arguments:?}: {err}");
    }
}

#[test]
fn usage_that_is_not_understood_is_exit_2_and_help_is_not() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["conwert"][..], &["convert"], &["convert", "uniform", "--set", "c"], &[]] {
        let (code, out, err) = said(&run(arguments, folder.path()));
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {err}");
    }
    let (code, out, _) = said(&run(&["--help"], folder.path()));
    assert!(code == 0 && out.contains("Exit codes: 0 success; 1"), "{out}");
}

#[test]
fn every_built_in_case_is_listed_with_its_title() {
    let folder = tempfile::tempdir().unwrap();
    let (_, list, _) = said(&run(&["cases"], folder.path()));
    let (_, json, _) = said(&run(&["cases", "--json"], folder.path()));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let names: Vec<_> = json.as_array().unwrap().iter().map(|case| case["name"].as_str().unwrap()).collect();
    let lines: Vec<_> = list.lines().filter(|line| line.contains("  ")).collect();
    assert_eq!(names.len(), lines.len());
    assert!(names.iter().zip(lines).all(|(name, line)| line.starts_with(name)));
    let (cases, figures) = list.split_once("Figures of the paper").unwrap();
    assert!(!cases.contains("figure-") && figures.contains("figure-19"), "{list}");
}

#[test]
fn lessons_are_listed_printed_and_checked() {
    let folder = tempfile::tempdir().unwrap();
    let (_, list, _) = said(&run(&["lesson", "--list"], folder.path()));
    let (_, json, _) = said(&run(&["lesson", "--json"], folder.path()));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(list.lines().count(), json.as_array().unwrap().len());
    assert_eq!(said(&run(&["lesson"], folder.path())).1, list);
    let (_, template, _) = said(&run(&["lesson", "--template"], folder.path()));
    std::fs::write(folder.path().join("mine.md"), template).unwrap();
    let (code, page, err) = said(&run(&["lesson", "mine.md", "--answers"], folder.path()));
    assert!(code == 0 && page.contains("answer: 0\u{2013}6.") && page.contains("Step 1: Segment 0"), "{page}{err}");
    let (_, hidden, _) = said(&run(&["lesson", "mine.md"], folder.path()));
    assert!(!hidden.contains("answer:") && hidden.contains("? Which edge becomes the left side?"), "{hidden}");
    let (_, json, _) = said(&run(&["lesson", "mine.md", "--json"], folder.path()));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let question = &json["parts"][0]["questions"][0];
    assert_eq!((question["kind"].as_str(), question["answer"].as_str()), (Some("edge"), Some("0-6")));
    assert_eq!(json["parts"][0]["light"]["edges"][0], serde_json::json!([0, 1]));
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_no_half_written_file() {
    use std::time::Duration;

    let folder = tempfile::tempdir().unwrap();
    // Too long a work to be done before it is stopped.
    let arguments = ["convert", "uniform", "--set", "size_scale=0.02", "-o", "a.msh"];
    let child = command(&arguments, folder.path()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_of_a_mesh_that_came_by_standard_input() {
    use std::fmt::Write as _;
    use std::time::{Duration, Instant};

    let (folder, kept) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let n = 300;
    let mut obj = String::new();
    for k in 0..(n + 1) * (n + 1) {
        let (x, y) = (k % (n + 1), k / (n + 1));
        writeln!(obj, "v {x} {y} {}", 5.0 * libm::sin(0.1 * f64::from(x)) * libm::sin(0.1 * f64::from(y))).unwrap();
    }
    for k in 0..n * n {
        let a = k % n + k / n * (n + 1) + 1;
        writeln!(obj, "f {a} {} {}\nf {a} {} {}", a + 1, a + n + 2, a + n + 2, a + n + 1).unwrap();
    }
    let mut child = command(&["convert", "-", "--from", "obj", "-o", "a.msh"], folder.path())
        .env("TMPDIR", kept.path())
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(obj.as_bytes()).unwrap();
    let begin = Instant::now();
    while std::fs::read_dir(kept.path()).unwrap().count() == 0 {
        assert!(begin.elapsed() < Duration::from_secs(30));
        std::thread::sleep(Duration::from_millis(5));
    }
    // It is read or laid flat by now, for some seconds still.
    std::thread::sleep(Duration::from_millis(400));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr), (Some(130), Vec::new()));
    for left in [folder.path(), kept.path()] {
        assert_eq!(std::fs::read_dir(left).unwrap().count(), 0);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["convert", "uniform", "--set", "size_scale=4", "-o", "/dev/full", "--format", "msh"];
    let (code, _, err) = said(&run(&arguments, folder.path()));
    assert_eq!(code, 2);
    assert!(err.contains("The disk is full") && err.lines().count() == 1, "{err}");
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let arguments = ["convert", "uniform", "--set", "size_scale=4", "-o", "-", "--format", "msh"];
    let output = command(&arguments, folder.path()).stdout(full).output().unwrap();
    let (code, _, err) = said(&output);
    assert!(code == 2 && err.starts_with("error: standard output: "), "{err}");
}

/// Two squares of two triangles each that share a corner.
const PINCHED: &str =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\nf 1 2 3\nf 1 3 4\nf 3 5 6\nf 3 6 7\n";

#[test]
fn parts_that_share_a_node_only_come_apart_and_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pinched.obj"), PINCHED).unwrap();
    let (code, _, err) = said(&run(&["convert", "pinched.obj", "-q", "-o", "quads.obj"], folder.path()));
    assert_eq!((code, err.as_str()), (0, ""));
    let (code, _, err) = said(&run(&["check", "quads.obj", "-q", "--seams"], folder.path()));
    assert_eq!((code, err.as_str()), (0, ""));
}

#[test]
fn a_metric_that_fails_between_the_nodes_of_a_given_mesh_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mesh.obj"), PINCHED).unwrap();
    let case = "version = 1\nmesh = \"mesh.obj\"\n[[metric]]\nkind = \"formula\"\nh1 = \"hypot(x - 2/3, y - 1/3)\"\n";
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    let (code, _, err) = said(&run(&["convert", "case.toml", "-q", "-o", "quads.obj"], folder.path()));
    assert!(code == 2 && err.starts_with("error: (0.66") && err.contains("h1 = 0 is not positive"), "{err}");
}

#[test]
#[cfg(unix)]
fn a_pipe_that_is_closed_early_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in
        [&["convert", "gear", "-o", "-", "--format", "msh"][..], &["convert", "gear", "--events", "-"], &["cases"]]
    {
        let mut child = command(arguments, folder.path()).spawn().unwrap();
        drop(child.stdout.take());
        let (code, _, err) = said(&child.wait_with_output().unwrap());
        assert_eq!(code, 0, "{arguments:?}: {err}");
        assert!(!err.contains("error"), "{arguments:?}: {err}");
    }
}

#[test]
fn a_metric_that_is_not_written_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    for (name, reported) in [("a.obj", true), ("a.inp", true), ("a.mesh", false), ("a.msh", false), ("a.vtu", false)] {
        let (code, _, err) = said(&run(&["background", "gear", "-o", name], folder.path()));
        assert_eq!((code, err.contains("The metric was not written")), (0, reported), "{name}: {err}");
        assert_eq!(err.lines().count(), usize::from(reported), "{err}");
    }
}

#[test]
fn a_metric_is_not_written_over_the_one_that_was_read() {
    let folder = tempfile::tempdir().unwrap();
    said(&run(&["background", "gear", "-o", "a.mesh"], folder.path()));
    let before = std::fs::read(folder.path().join("a.sol")).unwrap();
    std::fs::rename(folder.path().join("a.mesh"), folder.path().join("b.mesh")).unwrap();
    let arguments = ["background", "b.mesh", "--sol", "a.sol", "-o", "./a.mesh"];
    let (code, _, err) = said(&run(&arguments, folder.path()));
    assert_eq!(code, 2);
    assert!(err.contains("a.sol") && err.contains("overwrite the file"), "{err}");
    assert_eq!(std::fs::read(folder.path().join("a.sol")).unwrap(), before);
}

#[test]
fn comparing_names_the_first_difference_and_its_exit_code_says_whether_there_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let (code, out, _) = said(&run(&["compare", "example4", "--with", "c=1.5", "--quiet"], folder.path()));
    assert_eq!(code, 1, "{out}");
    assert!(out.starts_with("A: example4 with c = 2\nB: example4 with c = 1.5\nfirst difference: step "), "{out}");
    assert!(out.contains("\n  A: ") && out.contains("\n  B: ") && out.contains("\n  quadrilaterals "), "{out}");
    // The same in JSON, with the reports of both.
    let (code, json, _) = said(&run(&["compare", "example4", "--with", "c=1.5", "--quiet", "--json"], folder.path()));
    assert_eq!(code, 1);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let step = json["first_difference"]["step"].as_u64().unwrap();
    assert!(out.contains(&format!("first difference: step {step} (")), "{out}");
    for (k, c) in [2.0, 1.5].into_iter().enumerate() {
        let did = &json["first_difference"]["did"][k];
        assert!(did["event"]["kind"].is_string() && did["why"].is_array(), "{did}");
        assert!(out.contains(did["text"].as_str().unwrap()), "{did}");
        assert_eq!(json["reports"][k]["parameters"]["c"].as_f64(), Some(c));
        let set = format!("c={c}");
        let arguments = ["convert", "example4", "--set", &set, "--quiet", "--report", "-"];
        let (_, report, _) = said(&run(&arguments, folder.path()));
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(json["reports"][k]["mesh"], report["mesh"]);
    }
    // A case and its own file are the same run; another size differs from the beginning.
    let (_, case, _) = said(&run(&["cases", "example4"], folder.path()));
    std::fs::write(folder.path().join("own.toml"), case).unwrap();
    let (code, out, _) = said(&run(&["compare", "example4", "own.toml", "--quiet"], folder.path()));
    assert_eq!(code, 0, "{out}");
    assert!(out.starts_with("A: example4\nB: own.toml\nno difference: "), "{out}");
    let (code, out, _) = said(&run(&["compare", "example4", "--with", "size_scale=0.9", "--quiet"], folder.path()));
    assert_eq!(code, 1);
    assert!(out.contains("first difference: step 0 (the background meshes differ)\n"), "{out}");
    // Nothing to compare with, and a parameter that does not exist.
    for arguments in [&["compare", "example4"][..], &["compare", "example4", "--with", "k=2"]] {
        let (code, out, error) = said(&run(arguments, folder.path()));
        assert_eq!((code, out.as_str()), (2, ""), "{error}");
        assert!(error.starts_with("error: "), "{error}");
    }
}

#[test]
fn a_run_is_compared_with_a_finished_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (file, set) in [("own.vtu", "c=2"), ("own.msh", "c=2"), ("other.vtu", "whole_below=0")] {
        let (code, _, error) = said(&run(&["convert", "example1", "-q", "--set", set, "-o", file], folder));
        assert_eq!(code, 0, "{error}");
    }
    let (code, text, _) = said(&run(&["compare", "example1", "own.msh", "-q"], folder));
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("no difference: both have the same quadrilaterals\n"), "{text}");
    assert!(text.contains(" in both, 0 only in A, 0 only in B\n"), "{text}");
    // The figures of both are the same, of the run and of the file.
    for head in ["quadrilaterals", "irregular nodes", "angles, metric", "edge length", "scaled Jacobian"] {
        let line = text.lines().find(|line| line.trim_start().starts_with(head)).unwrap();
        let cells: Vec<&str> = line.trim_start()[head.len()..].split("  ").map(str::trim).collect();
        let cells: Vec<&str> = cells.into_iter().filter(|cell| !cell.is_empty()).collect();
        assert!(cells.len() == 2 && cells[0] == cells[1], "{line}");
    }
    // The step is the first that made a quadrilateral of the one file which the other one does not have: each corner
    // within a tenth in the metric there.
    let read = |name: &str| read_bytes(name, &std::fs::read(folder.join(name)).unwrap(), Format::Vtu).unwrap();
    let (own, other) = (read("own.vtu"), read("other.vtu"));
    let metric = own.metric.as_ref().unwrap();
    let is_near = |a: u32, b: u32| {
        let (m, d) = (metric[a as usize], other.points[b as usize] - own.points[a as usize]);
        m.xx * d.x * d.x + 2.0 * m.xy * d.x * d.y + m.yy * d.y * d.y <= 0.1 * 0.1
    };
    let has_partner = |quad: &&[u32; 4]| {
        other.quads.iter().any(|partner| quad.iter().all(|a| partner.iter().any(|b| is_near(*a, *b))))
    };
    let steps = &own.element_data.iter().find(|data| data.name == "step").unwrap().values;
    let missing = own.quads.iter().zip(steps).filter(|(quad, _)| !has_partner(quad));
    let step = missing.map(|(_, step)| *step as u64).min().unwrap();
    let both = own.quads.iter().filter(has_partner).count();
    let (code, text, _) = said(&run(&["compare", "example1", "other.vtu", "-q"], folder));
    assert_eq!(code, 1);
    assert!(text.contains(&format!("\nfirst difference: step {step} (")), "{step}: {text}");
    let counts = format!(" in both, {} only in A, {} only in B\n", own.quads.len() - both, other.quads.len() - both);
    assert!(text.contains(&format!("\n{both} quadrilateral")) && text.contains(&counts), "{both}, {counts}: {text}");
    let (_, json, _) = said(&run(&["compare", "example1", "other.vtu", "-q", "--json"], folder));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["comparison"]["first_difference"]["step"], step);
    assert_eq!(json["report"]["mesh"]["quads"], own.quads.len());
    assert!(both > 100 && step > 100, "{both}, {step}");
    let (code, _, error) = said(&run(&["compare", "example1", "other.vtu", "--with", "c=2"], folder));
    assert!(code == 2 && error.contains("A finished mesh has no parameters"), "{error}");
}
