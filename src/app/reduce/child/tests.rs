//! Real panics, overflows and aborts, in processes that stand in for `convert`: this test program, started again.

use super::super::Reduction;
use super::*;
use crate::core::case::Case;
use crate::core::progress::Nobody;
use crate::core::reduce::{Draft, Question, Written};
use crate::core::run::Run;

/// Names the file that a process stands in to convert.
const FILE: &str = "QUADFRONT_TEST_CONVERTS";

fn stand_in(path: &Path) -> io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["--exact", "app::reduce::child::tests::stands_in_for_convert", "--ignored", "--nocapture"]);
    command.env(FILE, path);
    Ok(command)
}

#[test]
#[ignore = "the process that the other tests start"]
fn stands_in_for_convert() {
    let text = std::fs::read_to_string(std::env::var_os(FILE).unwrap()).unwrap();
    let has = |name: &str| text.contains(&format!("\"{name}\""));
    if has("sleeper") {
        std::thread::sleep(Duration::from_secs(600));
    }
    if has("deep") {
        assert_eq!(deep(0), 0);
    }
    if has("abort") {
        std::process::abort();
    }
    let places = vec![0; text.matches("[[curve]]").count()];
    if has("index") {
        assert_eq!(places[places.len() + 3], 0);
    }
    // What takes the place of the failures above once they are gone.
    assert!(!has("other"), "another panic");
}

/// As deep as the stack.
fn deep(n: u64) -> u64 {
    if n == u64::MAX { 0 } else { std::hint::black_box(deep(n + 1)) + 1 }
}

/// A plate with holes of these names.
fn plate(holes: &[&str]) -> Run {
    let mut text =
        "version = 1\ngradation = 1.5\n[[metric]]\nkind = \"uniform\"\nh = 0.3\n[[curve]]\nname = \"frame\"\n\
                    kind = \"polyline\"\nclosed = true\npoints = [[0, 0], [9, 0], [9, 1], [0, 1]]\n"
            .to_owned();
    for (i, hole) in holes.iter().enumerate() {
        text += &format!("[[curve]]\nname = \"{hole}\"\nkind = \"circle\"\nradius = 0.25\ncentre = [{i}.5, 0.5]\n");
    }
    let names: Vec<String> = holes.iter().map(|hole| format!("[\"{hole}\"]")).collect();
    text += &format!("[[face]]\nname = \"plate\"\nouter = [\"frame\"]\nholes = [{}]\n", names.join(", "));
    Run::of(Case::parse(&text, "plate", "plate.toml", Path::new("")).unwrap())
}

/// The text of the smallest case that panics.
fn reduced(run: &Run, folder: &Path) -> Result<String, Fault> {
    let question = Question::parse("panics")?;
    let original = Draft::of(run, &mut Nobody)?;
    let mut written = Written::new(folder.join("small.toml"), &original, &question)?;
    let cancel = Cancel::new();
    let work = Reduction { question: &question, run, original: &original, tries: 500, cancel, start: &stand_in };
    work.go("plate", &mut written, &mut |_| {}).0?;
    Ok(std::fs::read_to_string(written.path()).unwrap())
}

#[test]
fn a_case_that_panics_overflows_or_aborts_becomes_the_smallest_one_that_fails_in_the_same_way() {
    for (planted, said) in [
        ("index", "src/app/reduce/child/tests.rs:"),
        ("deep", "The program panics: stack overflow."),
        ("abort", "The program panics: ended by SIGABRT."),
    ] {
        if cfg!(not(unix)) && planted != "index" {
            continue;
        }
        let run = plate(&["a", "b", "other", "c", planted, "d", "e"]);
        let [one, two] = [0, 1].map(|_| {
            let folder = tempfile::tempdir().unwrap();
            reduced(&run, folder.path()).unwrap()
        });
        assert_eq!(one, two, "the same bytes twice");
        assert!(one.contains(said), "{one}");
        assert_eq!(one.contains("index out of bounds: the len is "), planted == "index", "{one}");
        let holes = ["a", "b", "other", "c", "d", "e"].map(|hole| one.contains(&format!("\"{hole}\"")));
        assert!(one.contains(&format!("[\"{planted}\"]")) && holes == [false; 6], "{one}");
        assert!(!one.contains("gradation"), "{one}");
    }
    let folder = tempfile::tempdir().unwrap();
    let fault = reduced(&plate(&["a", "b"]), folder.path()).unwrap_err();
    assert!(fault.to_string().contains("does not show it: panics"), "{fault}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_process_that_does_not_end_is_ended_when_the_work_is_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    std::fs::write(&path, "\"sleeper\"").unwrap();
    let cancel = Cancel::new();
    let asked = cancel.clone();
    let begin = std::time::Instant::now();
    let thread = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(50));
        asked.ask();
    });
    let fault = panic_of(stand_in(&path), &cancel).unwrap_err();
    thread.join().unwrap();
    assert!(fault.is_stop() && begin.elapsed() < Duration::from_secs(60), "{fault} {:?}", begin.elapsed());
}
