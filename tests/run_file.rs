//! Promise: a run file is all that is needed to have a run again: the command line reads it as it reads a case, and a
//! program that is killed while it saves leaves a whole one.
#![allow(clippy::unwrap_used)]

#[path = "common/random_parameters.rs"]
mod random_parameters;
#[path = "common/xor_shift.rs"]
mod xor_shift;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use quadfront::core::case::{Parameters, built_in};
use quadfront::core::convert::EventKind;
use quadfront::core::mesh::NodeId;
use quadfront::core::progress::Nobody;
use quadfront::core::record::{Keeper, run_file};
use quadfront::core::run::{Bookmark, Edit, EditKind, History, Run, run};

/// Set for the child that saves until it is killed.
const CHILD: &str = "QUADFRONT_TEST_SAVES_TO";

fn run_of(name: &str) -> Run {
    Run::of(built_in::named(name).unwrap().unwrap())
}

fn parameter(step: u64, key: &str, value: &str) -> Edit {
    Edit { step, kind: EditKind::parameter(key, value).unwrap() }
}

/// A run with so many edits and bookmarks: its file grows with them.
fn grown(count: u64) -> Run {
    let mut run = run_of("example1");
    run.set_edits((0..count).map(|k| parameter(k, "theta_rect", &format!("{}", 100 + k % 60))).collect());
    run.bookmarks = (0..count).map(|step| Bookmark { step, note: format!("number {step} of {count}") }).collect();
    run
}

#[test]
fn parameters_and_edits_are_read_back_bit_for_bit() {
    let mut random = xor_shift::XorShift::of(17);
    for _ in 0..200 {
        let mut run = run_of("two-faces");
        random_parameters::draw(&mut run.parameters, &[], &mut random);
        run.parameters.faces = vec!["left, \"one\"".to_owned(), "right".to_owned()];
        run.parameters.layered_loops = vec!["hole".to_owned()];
        let edits = random_parameters::draw(&mut Parameters::default(), &run::OF_BACKGROUND, &mut random);
        run.set_edits(edits.iter().zip(0..).map(|((key, value), step)| parameter(step, key, value)).collect());
        let text = run_file::embedded(&run).unwrap();
        let read = run_file::parse(&text, "a.toml", Path::new("")).unwrap();
        assert_eq!(read.parameters, run.parameters, "{text}");
        assert_eq!(read.edits(), run.edits());
        let last = |run: &Run| run.parameters_at(u64::MAX).unwrap();
        assert_eq!(last(&read), last(&run));
        for (key, value) in edits {
            let mut as_typed = Parameters::default();
            as_typed.set(key, &value).unwrap();
            assert_eq!(last(&read).text_of(key), as_typed.text_of(key));
        }
    }
}

#[test]
fn a_program_killed_while_it_saves_leaves_a_whole_run() {
    if let Some(path) = std::env::var_os(CHILD) {
        let mut keeper = Keeper::new(path.into(), &grown(0)).unwrap();
        for count in 1.. {
            keeper.keep(&grown(count % 3000)).unwrap();
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = Keeper::place_beside(&folder.path().join("plate.toml"));
    let mut seen = Vec::new();
    for round in 0..12 {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "a_program_killed_while_it_saves_leaves_a_whole_run"])
            .env(CHILD, &path)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while !path.exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(20 + 17 * round));
        // On Unix this is kill -9.
        child.kill().unwrap();
        child.wait().unwrap();
        let run = run_file::read(&path).unwrap();
        let whole = grown(run.bookmarks.len() as u64);
        assert_eq!(run_file::embedded(&run), run_file::embedded(&whole));
        seen.push(run.bookmarks.len());
    }
    assert!(seen.iter().any(|&count| count > 1), "it was killed amid saving: {seen:?}");
}

#[test]
fn the_command_line_goes_the_way_of_a_run_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = run_of("example1");
    run.parameters.set("size_scale", "1.5").unwrap();
    run.set_edits(vec![parameter(100, "theta_rect", "110")]);
    // A base that the rules would not choose.
    let mut history = History::open(run.clone(), &mut Nobody).unwrap();
    history.seek(160).unwrap();
    let mesh = &history.state().mesh;
    let picked = mesh.front().map(|h| (mesh.origin(h), mesh.target(h))).last().unwrap();
    history.edit(EditKind::Base { a: picked.0, b: picked.1 }).unwrap();
    let run = history.run().clone();
    assert_eq!(run.edits().len(), 2);
    let file = folder.path().join("edited.toml");
    run_file::write(&file, &run).unwrap();
    let end = history.seek(u64::MAX).unwrap();
    let events = convert(folder.path(), &file);
    let kinds: Vec<&str> = events.lines().map(|line| between(line, "\"kind\":\"", "\"")).collect();
    assert_eq!(kinds.len() as u64, end);
    for (step, kind) in (1..).zip(kinds) {
        assert_eq!(Some(kind), history.log().kind(step).map(EventKind::name), "step {step}");
    }
    let NodeId(a) = picked.0;
    assert!(events.lines().any(|line| line.contains("\"picked\":true") && line.contains(&format!("\"a\":{a},"))));
    // A picture of it on the way, and a parameter over those of the file.
    let picture = folder.path().join("a.svg");
    let status = quadfront().args(["render", "--at", "step=170", "--quiet", "-o"]).args([&picture, &file]).status();
    assert!(status.unwrap().success() && std::fs::metadata(&picture).unwrap().len() > 1000);
    let refused = quadfront().arg("convert").arg(&file).args(["--set", "c=9999"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    // Nonsense in it is told with its line.
    std::fs::write(&file, std::fs::read_to_string(&file).unwrap().replace("theta_rect = 110", "theta_rect = 500"))
        .unwrap();
    let refused = quadfront().arg("convert").arg(&file).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(told.contains("edited.toml, line ") && told.contains("out of range"), "{told}");
}

fn quadfront() -> Command {
    Command::new(env!("CARGO_BIN_EXE_quadfront"))
}

fn convert(folder: &Path, file: &Path) -> String {
    let events = folder.join("events.jsonl");
    let status = quadfront().arg("convert").arg(file).arg("--quiet").arg("--events").arg(&events).status();
    assert!(status.unwrap().success());
    std::fs::read_to_string(events).unwrap()
}

fn between<'t>(text: &'t str, before: &str, after: &str) -> &'t str {
    let start = text.find(before).unwrap() + before.len();
    &text[start..start + text[start..].find(after).unwrap()]
}
