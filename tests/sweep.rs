//! Promise: each cell of a sweep is the conversion with its parameters; whatever ends a sweep, it goes on where it
//! stood; and cells that came from elsewhere make the same map.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// A case of a second or so for some dozen cells.
const CASE: &str = "example1";

fn command(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quadfront"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn said(output: &Output) -> (i32, String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

fn run(arguments: &[&str], folder: &Path) -> (i32, String, String) {
    said(&command(arguments, folder).output().unwrap())
}

/// Runs what must succeed, and returns its standard output.
fn done(arguments: &[&str], folder: &Path) -> String {
    let (code, out, err) = run(arguments, folder);
    assert_eq!(code, 0, "{arguments:?}: {err}");
    out
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// The JSON of a sweep without the times, which differ from run to run.
fn json(folder: &Path, name: &str) -> Value {
    let mut json: Value = serde_json::from_str(&read(folder, name)).unwrap();
    for cell in json["cells"].as_array_mut().unwrap() {
        if let Some(figures) = cell.get_mut("figures") {
            figures.as_object_mut().unwrap().remove("seconds").unwrap();
        }
    }
    json
}

/// The number of cells that a sweep has already; none while its file is not there.
fn known(folder: &Path, name: &str) -> usize {
    if !folder.join(name).exists() {
        return 0;
    }
    let json = json(folder, name);
    json["cells"].as_array().unwrap().iter().filter(|cell| cell.get("figures").is_some()).count()
}

/// The figures of a report, looked up in its JSON by hand.
fn oracle(report: &Value) -> BTreeMap<&'static str, f64> {
    let mesh = &report["mesh"];
    let events = |kind: &str| report["events"][kind].as_f64().unwrap();
    BTreeMap::from([
        ("quads", mesh["quads"].as_f64().unwrap()),
        ("nodes", mesh["nodes"].as_f64().unwrap()),
        ("background_triangles", report["background_triangles"].as_f64().unwrap()),
        ("irregular", mesh["irregular"]["percent"].as_f64().unwrap()),
        ("irregular_nodes", mesh["irregular"]["irregular"].as_f64().unwrap()),
        ("min_angle", mesh["metric_angles"]["min"].as_f64().unwrap()),
        ("space.max_angle", mesh["physical_angles"]["max"].as_f64().unwrap()),
        ("good_angles", 100.0 * mesh["metric_angles"]["share_60_120"].as_f64().unwrap()),
        ("length.mean", mesh["lengths"]["mean"].as_f64().unwrap()),
        ("length.deviation", mesh["lengths"]["deviation"].as_f64().unwrap()),
        ("quality.min", mesh["quality"]["min"].as_f64().unwrap()),
        ("jacobian.mean", mesh["metric_scaled_jacobian"]["mean"].as_f64().unwrap()),
        ("last_resort", report["last_resort"]["quads"].as_f64().unwrap()),
        ("steps", events("front_step")),
        ("rolled_back", events("front_rolled_back")),
    ])
}

#[test]
fn each_cell_is_the_conversion_with_its_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let own = ["--set", "theta_seam=25", "--over", "c=1.5:2.5:.5", "--over", "theta_rect=120,135"];
    let files = ["--out", "a.json", "--out", "a.csv", "--out", "a.svg", "--quiet"];
    done(&[&["sweep", CASE][..], &own, &files].concat(), folder);
    let json = json(folder, "a.json");
    let csv = read(folder, "a.csv");
    let table: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let svg = read(folder, "a.svg");
    assert_eq!((json["cells"].as_array().unwrap().len(), table.len()), (6, 7));
    for (k, (theta, c)) in [("120", "1.5"), ("120", "2"), ("120", "2.5"), ("135", "1.5"), ("135", "2"), ("135", "2.5")]
        .into_iter()
        .enumerate()
    {
        let set = [format!("c={c}"), format!("theta_rect={theta}")];
        let set = ["--set", "theta_seam=25", "--set", &set[0], "--set", &set[1]];
        let report = done(&[&["convert", CASE, "--quiet", "--report", "-"][..], &set].concat(), folder);
        let cell = &json["cells"][k];
        assert_eq!((cell["c"].to_string(), cell["theta_rect"].to_string()), (c.to_owned(), theta.to_owned()));
        let figures = oracle(&serde_json::from_str(&report).unwrap());
        for (name, value) in &figures {
            assert_eq!(cell["figures"][name].as_f64(), Some(*value), "{name} of cell {k}");
            let column = table[0].iter().position(|head| head == name).unwrap();
            assert_eq!(table[k + 1][column].parse(), Ok(*value), "{name} of cell {k}");
        }
        assert_eq!(table[k + 1][..2], [c, theta]);
        // All numbers of the picture have two decimals here.
        let tip = format!("<title>c = {c}, theta_rect = {theta}°: {:.2} %</title>", figures["irregular"]);
        assert!(svg.contains(&tip), "{tip}: {svg}");
    }
}

#[test]
fn the_same_sweep_gives_the_same_bytes_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, jobs) in [("a", "1"), ("b", "4")] {
        let files = ["json", "csv", "svg"].map(|extension| format!("{name}.{extension}"));
        let outs: Vec<&str> = files.iter().flat_map(|file| ["-o", file]).collect();
        let over = ["--over", "c=1.5:2.5:.5", "--over", "selection=table1,level", "--jobs", jobs, "--show", "quads"];
        done(&[&["sweep", CASE, "-q"][..], &over, &outs].concat(), folder);
    }
    assert_eq!(json(folder, "a.json"), json(folder, "b.json"));
    for extension in ["csv", "svg"] {
        assert!(read(folder, &format!("a.{extension}")) == read(folder, &format!("b.{extension}")), "{extension}");
    }
    assert!(!read(folder, "a.csv").contains("seconds"));
    // The time is in a table where it is asked for.
    done(&["sweep", CASE, "-q", "--over", "c=2", "--show", "quads", "--show", "seconds", "-o", "c.csv"], folder);
    assert!(read(folder, "c.csv").contains(",seconds,"));
}

/// Starts a sweep of many cells, and waits until it has some of them.
fn started(folder: &Path, outs: &[&str]) -> Child {
    let over = ["--over", "c=1.5:3:.25", "--over", "theta_rect=110:150:5", "--jobs", "1"];
    let child = command(&[&["sweep", CASE][..], &over, outs].concat(), folder).spawn().unwrap();
    let begin = Instant::now();
    while known(folder, "a.json") < 3 {
        assert!(begin.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
#[cfg(unix)]
fn a_killed_sweep_goes_on_where_it_stood() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut child = started(folder, &["-o", "a.json"]);
    // This is kill -9.
    child.kill().unwrap();
    child.wait().unwrap();
    let count = known(folder, "a.json");
    assert!((3..63).contains(&count), "{count}");
    // A cell that is there is not converted again: this one has a number that no conversion gives.
    let text = read(folder, "a.json");
    let at = text.find("\"quads\":").unwrap() + "\"quads\":".len();
    let end = at + text[at..].find(',').unwrap();
    std::fs::write(folder.join("a.json"), format!("{}123456{}", &text[..at], &text[end..])).unwrap();
    let again = ["sweep", CASE, "--over", "c=1.5:3:.25", "--over", "theta_rect=110:150:5", "-o", "a.json"];
    let (code, out, err) = run(&again, folder);
    assert_eq!((code, err), (0, format!("a.json has {count} of 63 cells already: they are kept.\n")), "{out}");
    assert_eq!(known(folder, "a.json"), 63);
    let after = read(folder, "a.json");
    assert!(after.contains("\"quads\":123456,"));
    let whole = format!("{}{}{}", &text[..at], &text[at..end], &after[at + "123456".len()..]);
    std::fs::write(folder.join("a.json"), whole).unwrap();
    done(&["sweep", CASE, "--over", "c=1.5:3:.25", "--over", "theta_rect=110:150:5", "-q", "-o", "b.json"], folder);
    assert_eq!(json(folder, "a.json"), json(folder, "b.json"), "as if it had never been killed");

    // A larger sweep takes over the cells that it has in common, one of another case none.
    let larger = ["sweep", CASE, "--over", "theta_rect=110,115,120", "--over", "c=1.25:2:.25", "-o", "a.json"];
    let (code, _, err) = run(&larger, folder);
    assert_eq!((code, err.as_str()), (0, "a.json has 9 of 12 cells already: they are kept.\n"));
    let other = ["sweep", CASE, "--set", "theta_seam=25", "--over", "c=1.5,2", "-o", "a.json"];
    let (code, _, err) = run(&other, folder);
    assert_eq!((code, err.as_str()), (0, "a.json has no cell of this sweep and is begun anew.\n"));
    let (code, _, err) = run(&["sweep", "gear", "--over", "c=1.5,2", "-o", "a.json"], folder);
    assert_eq!((code, err.as_str()), (0, "a.json is begun anew: it is of another case, mesh or edits.\n"));
    assert_eq!(known(folder, "a.json"), 2);
    // What is no sweep is not written over.
    std::fs::write(folder.join("a.json"), "{\"a\": 1}").unwrap();
    let (code, _, err) = run(&["sweep", CASE, "--over", "c=1.5,2", "-o", "a.json"], folder);
    assert!(code == 2 && err.contains("a.json: This file is no sweep and is not written over. Remove it"), "{err}");
    assert_eq!(read(folder, "a.json"), "{\"a\": 1}");
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_a_sweep_at_once_and_keeps_what_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let child = started(folder, &["-o", "a.json", "-o", "a.csv", "-o", "a.svg"]);
    let begin = Instant::now();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    // A tenth of a second, and what a busy machine adds to it; the program is ended by force after half a second.
    assert!(begin.elapsed() < Duration::from_millis(400), "{:?}", begin.elapsed());
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(130), &b""[..]));
    let count = known(folder, "a.json");
    assert!((3..63).contains(&count), "{count}");
    // The files are written one after another: the last cell may be in the first of them only.
    let rows = read(folder, "a.csv").lines().filter(|line| !line.contains(",,,,")).count() - 1;
    let tips = read(folder, "a.svg").matches(" %</title>").count();
    assert!((count - 1..=count).contains(&rows) && (count - 1..=count).contains(&tips), "{count}, {rows}, {tips}");
    assert!(read(folder, "a.svg").contains("not computed: "));
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 3, "nothing is left beside");
}

#[test]
#[cfg(unix)]
fn commands_for_cells_run_as_they_are_and_their_files_make_the_same_map() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("it's my case.toml"), done(&["cases", CASE], folder)).unwrap();
    let over = ["--over", "c=1.5,2", "--over", "theta_rect=120:130:5", "--set", "theta_seam=25"];
    let sweep = [&["sweep", "it's my case.toml"][..], &over].concat();
    let lines = done(&[&sweep[..], &["--list=the cells"]].concat(), folder);
    assert_eq!(lines.lines().count(), 6, "{lines}");
    for (k, line) in lines.lines().enumerate() {
        assert!(line.contains("--quiet"), "{line}");
        // The last one is not run.
        if k < 5 {
            let output = Command::new("sh").args(["-c", line]).current_dir(folder).output().unwrap();
            assert_eq!(said(&output), (0, String::new(), String::new()), "{line}");
        }
    }
    assert_eq!(std::fs::read_dir(folder.join("the cells")).unwrap().count(), 5);
    assert!(folder.join("the cells/c=1.5,theta_rect=120.json").is_file());
    let collect = [&sweep[..], &["--collect", "the cells", "-o", "a.json", "-o", "a.svg", "-o", "a.csv"]].concat();
    let (code, out, err) = run(&collect, folder);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.contains("5 of 6 cells over c and theta_rect") && out.contains("missing        1 cell\n"), "{out}");
    assert!(read(folder, "a.svg").contains("not computed: 1 cell"));
    // What is foreign is left out and said.
    std::fs::write(folder.join("the cells/other.json"), "{}").unwrap();
    done(&["sweep", "gear", "--over", "c=2", "-q", "-o", "the cells/gear.json"], folder);
    let (_, _, err) = run(&collect, folder);
    assert!(err.contains("other.json is left out: it is no sweep.\n"), "{err}");
    assert!(err.contains("gear.json is left out: it is of another case, mesh or edits.\n"), "{err}");
    // With the last cell it is the sweep of one command; and a sweep goes on from what was collected.
    done(&[&sweep[..], &["-q", "-o", "b.json", "-o", "b.svg", "-o", "b.csv"]].concat(), folder);
    let (_, _, err) = run(&[&sweep[..], &["-o", "a.json", "-o", "a.svg", "-o", "a.csv"]].concat(), folder);
    assert_eq!(err, "a.json has 5 of 6 cells already: they are kept.\n");
    assert_eq!(json(folder, "a.json"), json(folder, "b.json"));
    assert!(read(folder, "a.svg") == read(folder, "b.svg") && read(folder, "a.csv") == read(folder, "b.csv"));
}

#[test]
fn a_refused_cell_is_not_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let over = ["--over", "faces=left,middle,right", "--over", "c=2"];
    let files = ["-o", "a.json", "-o", "a.csv", "-o", "a.svg"];
    let out = done(&[&["sweep", "two-faces"][..], &over, &files].concat(), folder);
    assert!(out.contains("refused        1 cell; faces = middle, c = 2: There is no face \"middle\""), "{out}");
    let json = json(folder, "a.json");
    let has = |k: usize, key: &str| json["cells"][k].get(key).is_some();
    assert!(has(0, "figures") && has(2, "figures") && !has(1, "figures"));
    assert!(json["cells"][1]["refused"].as_str().unwrap().starts_with("There is no face \"middle\""), "{json}");
    assert!(read(folder, "a.csv").lines().nth(2).unwrap().contains("There is no face \"\"middle\"\""));
    assert!(read(folder, "a.svg").contains("<title>faces = middle, c = 2: refused. There is no face"));
    // Without a file, the figure is printed as a table.
    let out = done(&[&["sweep", "two-faces", "-q"][..], &over].concat(), folder);
    let lines: Vec<&str> = out.lines().map(str::trim).collect();
    assert!(lines.len() == 2 && lines[0].starts_with("c \\ faces") && lines[1].contains("refused"), "{out}");
}

#[test]
fn what_is_wrong_is_said_in_one_line_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (arguments, error) in [
        (&["--over", "k=1:2:1"][..], "--over, k=1:2:1: The key \"k\" is not known. Known here: size_scale, c,"),
        (&["--over", "c=1:2"], "--over, c=1:2: A range has three numbers. Write KEY=FROM:TO:STEP or"),
        (&["--over", "c=0:2:1"], "--over, c=0:2:1: c = 0 is out of range. It may be from 0.5 to 1000."),
        (&["--over", "c=1:2:.5", "--over", "c=3"], "--over: c is swept twice. Name two different keys."),
        (&["--over", "c=1", "--over", "layers=1", "--over", "eps1=0"], "--over: A sweep has one axis or two, not 3."),
        (
            &["--over", "c=1:2:.01", "--over", "theta_rect=100:150:.5"],
            "--over: The sweep has 10201 cells; it may have 10000. Take larger steps or fewer values.",
        ),
        (&["-o", "a.txt"], "a.txt: A sweep is not written in this format. Name a file that ends in .svg,"),
        (&["-o", "-"], "standard output: The format is not known. Name files, such as -o sweep.csv;"),
        (&["-o", "no/a.svg"], "no/a.svg: The folder \"no\" does not exist. Create it, or name another folder."),
        (&["-o", "a.svg", "-o", "a.svg"], "a.svg: Two outputs have the same target. Name another file"),
        (&["--collect", "no"], "no: The folder cannot be read: "),
    ] {
        let (code, out, err) = run(&[&["sweep", CASE][..], arguments].concat(), folder);
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}");
        assert!(err.starts_with(&format!("error: {error}")) && err.lines().count() == 1, "{arguments:?}: {err}");
    }
    let (code, _, err) = run(&["sweep", CASE, "--show", "iregular"], folder);
    assert!(code == 2 && err.contains("irregular"), "{err}");
    let (code, _, err) = run(&["sweep", "-", "--list"], folder);
    assert!(code == 2 && !err.is_empty(), "{err}");
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 0);
}
