//! Promise: `--every` draws the states that `--at` draws, each in a file with its number or all on a contact sheet with
//! their steps; the timeline and the decision of a step as figures have the numbers of the events, by an oracle that
//! reads the file of events.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use quadfront::core::record::{figure, run_file};
use serde_json::Value;

/// A conversion of few steps.
const CASE: &str = "example1 --set size_scale=2 -q";

fn run(line: &str, folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadfront")).args(line.split_whitespace()).current_dir(folder).output().unwrap()
}

fn done(line: &str, folder: &Path) {
    let output = run(line, folder);
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(0) && err.is_empty(), "{line}: {err}");
}

fn refused(line: &str, folder: &Path) -> String {
    let output = run(line, folder);
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && err.lines().count() == 1, "{line}: {err}");
    err
}

fn text(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// What is drawn, without title and run.
fn drawing(svg: &str) -> &str {
    svg.split_once("</metadata>").unwrap().1
}

/// The texts of an SVG in the order in which they are written.
fn texts(svg: &str) -> Vec<String> {
    let all = svg.split("<text ").skip(1).map(|rest| rest.split_once('>').unwrap().1.split_once("</text>").unwrap().0);
    all.map(|text| text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")).collect()
}

/// The files in a folder whose names begin so, in their order.
fn names(folder: &Path, start: &str) -> Vec<String> {
    let all = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = all.filter(|name| name.starts_with(start)).collect();
    names.sort();
    names
}

/// The events of the conversion.
fn events(folder: &Path) -> Vec<Value> {
    done(&format!("convert {CASE} --events a.jsonl"), folder);
    text(folder, "a.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// A number with thin spaces between thousands.
fn grouped(n: u64) -> String {
    if n < 1000 { n.to_string() } else { format!("{}\u{2009}{:03}", grouped(n / 1000), n % 1000) }
}

#[test]
fn a_file_for_each_so_many_quadrilaterals_is_what_their_stop_draws() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(&format!("render {CASE} --every 20 -o all.svg"), here);
    let files = names(here, "all-");
    for (k, name) in files.iter().enumerate() {
        assert_eq!(*name, format!("all-{:05}.svg", k + 1));
        let at = if k + 1 == files.len() { "end".to_owned() } else { format!("nq={}", 20 * k) };
        done(&format!("render {CASE} --at {at} -o one.svg"), here);
        assert!(drawing(&text(here, name)) == drawing(&text(here, "one.svg")), "{name}: {at}");
    }
    let last = events(here).iter().map(|event| event["nq"].as_u64().unwrap()).max().unwrap();
    assert!(files.len() as u64 >= last / 20, "{} files, {last} quadrilaterals", files.len());
    assert!(names(here, "all").len() == files.len(), "none without a number");
}

#[test]
fn a_file_for_each_step_is_the_same_bytes_as_its_stop_draws_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let formats: &[&str] = if cfg!(feature = "window") { &["svg", "pdf", "png"] } else { &["svg", "pdf"] };
    for format in formats {
        done(&format!("render {CASE} --at step=3,7 --every event --captions -o step.{format}"), here);
        let files = names(here, "step-").into_iter().filter(|name| name.ends_with(format)).collect::<Vec<_>>();
        assert_eq!(files.len(), 5, "{files:?}");
        for (step, name) in (3..).zip(&files) {
            done(&format!("render {CASE} --at step={step} --captions -o one.{format}"), here);
            assert!(
                std::fs::read(here.join(name)).unwrap() == std::fs::read(here.join(format!("one.{format}"))).unwrap()
            );
        }
    }
    let output = run("render example1 --set size_scale=2 --at nq=2,8 --every quad -o quad.svg", here);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(said, "7 files: quad-00001.svg to quad-00007.svg.\n");
}

#[test]
fn a_contact_sheet_has_each_state_with_its_step_and_is_drawn_again_from_itself() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let events = events(here);
    for (options, columns) in [("--every step=50", None), ("--every step=40 --columns 6 --ink grey", Some(6))] {
        done(&format!("render {CASE} {options} --contact-sheet -o sheet.svg"), here);
        let svg = text(here, "sheet.svg");
        let every = if columns.is_none() { 50 } else { 40 };
        let all = events.len() as u64;
        let steps: Vec<u64> = (0..all).step_by(every).chain([all]).collect();
        let named = |step: u64| {
            let nq = step.checked_sub(1).map_or(0, |k| events[k as usize]["nq"].as_u64().unwrap());
            format!("step {}, NQ {}", grouped(step), grouped(nq))
        };
        // A title that takes two rows is two texts.
        let told = texts(&svg).join(" ");
        let mut rest = told.as_str();
        for &step in &steps {
            let at = rest.find(&named(step)).unwrap_or_else(|| panic!("{options}: {} is not in {told}", named(step)));
            rest = &rest[at..];
        }
        assert_eq!(told.matches("step ").count(), steps.len());
        let run = run_file::parse(&figure::text_in(svg.as_bytes()).unwrap(), "", here).unwrap();
        assert_eq!(run.shown.unwrap().states.iter().map(|state| state.step).collect::<Vec<_>>(), steps);
        for name in ["again.svg", "again.pdf"] {
            done(&format!("render sheet.svg -q -o {name}"), here);
        }
        done("render again.pdf -q -o last.svg", here);
        assert!(svg == text(here, "again.svg") && svg == text(here, "last.svg"), "{options}");
        // Frames are equal and do not overlap: their titles stand in as many columns as there are.
        let places =
            svg.split("<text x=\"").skip(1).map(|rest| rest.split('"').next().unwrap().parse::<f64>().unwrap());
        let mut lefts: Vec<i64> = places.map(|x| (x * 10.0).round() as i64).collect();
        lefts.sort_unstable();
        let mut counts: BTreeMap<i64, usize> = BTreeMap::new();
        lefts.iter().for_each(|x| *counts.entry(*x).or_default() += 1);
        // The text of the scale bar has its own place.
        let found = counts.values().filter(|count| **count > 1).count();
        // Rows are of equal length.
        let of_equal_rows = |columns: usize| steps.len().div_ceil(steps.len().div_ceil(columns));
        let is_right = columns.is_none_or(|columns| found == of_equal_rows(columns));
        assert!(is_right && found > 1, "{options}: {counts:?}");
    }
    done(&format!("render {CASE} --at nq=5,10,20,end --contact-sheet -o few.svg"), here);
    assert_eq!(texts(&text(here, "few.svg")).iter().filter(|text| text.contains("NQ")).count(), 4);
}

#[test]
fn series_that_cannot_be_drawn_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (line, words) in [
        ("render example1 --every 5 -o -", "Several files need names"),
        ("render example1 --every 5 --plot lengths -o a.svg", "--plot"),
        ("render example1 --every 5 --at nq=1,2,3 -o a.svg", "the first and the last state"),
        ("render example1 --every 5 --at end -o a.svg", "the first and the last state"),
        ("render uniform --every event --at step=1,100000 -o a.svg", "The conversion ends"),
        ("render example1 --every event --contact-sheet -o a.svg", "more than 1\u{2009}000 frames"),
        ("render example1 --every 5 --contact-sheet --captions -o a.svg", "caption"),
        ("render example1 --contact-sheet --plot timeline -o a.svg", "A plot shows one state"),
        ("render example1 --at nq=1,2 --plot decision -o a.svg", "A plot shows one state"),
    ] {
        let told = refused(line, here);
        assert!(told.contains(words), "{line}: {told}");
    }
}

/// The kinds of events in each lane, by the words of the file of events.
const LANES: [(&str, &[&str]); 5] = [
    ("quad formed", &["formed"]),
    ("swap", &["side_swapped", "top_swapped", "enhanced"]),
    ("divide, delete", &["side_divided", "node_removed"]),
    (
        "seam, close, finish",
        &[
            "seamed",
            "transition_seamed",
            "split",
            "closed",
            "matched",
            "patched",
            "last_resort",
            "cleaned",
            "refilled",
            "row_laid",
            "swept",
        ],
    ),
    ("rolled back", &["rolled_back", "deferred", "second_pass", "seam_refused", "split_refused"]),
];

#[test]
fn the_timeline_has_the_counts_of_the_events_and_the_values_of_its_step() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let events = events(here);
    for (at, step) in [("end", events.len()), ("step=100", 100)] {
        done(&format!("render {CASE} --at {at} --plot timeline -o time.svg"), here);
        let svg = text(here, "time.svg");
        let told = texts(&svg);
        let value = |name: &str| {
            let at = told.iter().position(|text| text == name).unwrap_or_else(|| panic!("{name}: {told:?}"));
            told[at + 1].clone()
        };
        for (name, kinds) in LANES {
            let count = events.iter().filter(|event| kinds.contains(&event["kind"].as_str().unwrap())).count();
            assert_eq!(value(name), grouped(count as u64), "{name}");
        }
        let formed = events[..step].iter().filter(|event| event["kind"] == "formed");
        let worst = formed.map(|event| event["quality"].as_f64().unwrap()).fold(f64::INFINITY, f64::min);
        assert_eq!(value("worst quality, metric"), format!("{worst:.2}"), "{at}");
        assert_eq!(value("invariants"), "hold");
        // The mesh of that state: its triangles, and its front as a group of lines.
        done(&format!("convert {CASE} --at {at} -o state.msh --msh2"), here);
        let elements = text(here, "state.msh");
        let elements = elements.split_once("$Elements\n").unwrap().1.split_once("$EndElements").unwrap().0;
        let of_kind = |kind: &str| elements.lines().filter(|line| line.split(' ').nth(1) == Some(kind)).count() as u64;
        assert_eq!(value("live triangles"), grouped(of_kind("2")), "{at}");
        let nq = events[step - 1]["nq"].as_u64().unwrap();
        let all = events.len() as u64;
        let last = events.last().unwrap()["nq"].as_u64().unwrap();
        let heading = format!("{} steps, {} quadrilaterals", grouped(all), grouped(last));
        let now = format!("; values at step {}, {} quadrilaterals", grouped(step as u64), grouped(nq));
        assert_eq!(told[0], if at == "end" { heading } else { heading + &now });
        if at == "end" {
            assert_eq!([value("front length"), value("loops")], ["0", "0"]);
        }
        // As many dots of quality as quadrilaterals were formed: lines without length.
        let dots = svg.split("<path").filter(|path| path.contains("stroke-linecap=\"round\"")).collect::<Vec<_>>();
        let count = events.iter().filter(|event| event["kind"] == "formed").count();
        assert_eq!(dots.iter().map(|path| path.matches('M').count()).sum::<usize>(), count);
        done("render time.svg -q -o again.svg", here);
        done("render time.svg -q -o time.pdf", here);
        done("render time.pdf -q -o last.svg", here);
        assert!(svg == text(here, "again.svg") && svg == text(here, "last.svg"), "{at}");
    }
}

#[test]
fn the_decision_of_a_step_has_the_candidates_of_its_event_and_the_front_of_its_selection() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let events = events(here);
    let wanted =
        ["base_selected", "side_is_front", "side_chosen", "side_swapped", "top_swapped", "formed", "rolled_back"];
    for kind in wanted {
        let step = events.iter().rposition(|event| event["kind"] == kind).unwrap() + 1;
        let event = &events[step - 1];
        done(&format!("render {CASE} --at step={step} --plot decision --size 150mm -o a.svg"), here);
        let svg = text(here, "a.svg");
        let told = texts(&svg);
        assert_eq!(told[0], format!("example1: step {}, NQ {}", grouped(step as u64), event["nq"]), "{kind}");
        let all = told.join(" ");
        assert!(all.contains(event["text"].as_str().unwrap()), "{kind}: {all}");
        let candidates = event["candidates"]["edges"].as_array().map_or(&[][..], Vec::as_slice);
        let shows_them = kind.starts_with("side") || kind == "rolled_back";
        for candidate in candidates.iter().filter(|_| shows_them) {
            let number = |key: &str, decimals: usize| format!("{:.decimals$}", candidate[key].as_f64().unwrap());
            let row = [number("angle", 1), number("deviation", 1), number("length", 2)];
            let node = format!("\u{2013}{}", candidate["node"]);
            let has = |k: usize| told[k].ends_with(&node) && told[k + 1..].starts_with(&row);
            assert!((0..told.len()).any(has), "{kind}, step {step}: {row:?} of node {node} in {told:?}");
        }
        if kind.starts_with("side") {
            assert_eq!(all.matches("chosen").count(), 1, "{all}");
        }
        if kind == "base_selected" {
            let segment = format!("{} \u{2192} {}", event["a"], event["b"]);
            let at = told.iter().rposition(|text| *text == segment).unwrap();
            let theta = event["theta"].as_array().unwrap();
            let [a, b] = [0, 1].map(|k| format!("{:.1}", theta[k].as_f64().unwrap()));
            assert_eq!(told[at - 1], "1", "its rank");
            assert_eq!(told[at + 1], event["class"].to_string());
            assert_eq!(told[at + 3], format!("{:.2}", event["length_metric"].as_f64().unwrap()));
            assert_eq!(told[at + 5..at + 7], [a, b]);
        }
        done("render a.svg -q -o again.svg", here);
        assert!(svg == text(here, "again.svg"), "{kind}");
    }
    done(&format!("render {CASE} --at step=0 --plot decision -o a.pdf"), here);
    assert!(figure::text_in(&std::fs::read(here.join("a.pdf")).unwrap()).is_ok());
}
