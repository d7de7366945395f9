//! The window in a page does what it does elsewhere: the same states, worked by keys, mouse and files.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use quadfront::core::case::{ImportOptions, built_in};
use quadfront::core::progress::Nobody;
use quadfront::core::record::link::{Link, Origin};
use quadfront::core::run::shown::fingerprint;
use quadfront::core::run::{History, Run};
use serde_json::{Value, json};

use crate::driver::Browser;
use crate::server::Server;
use crate::{asked_by_pages, browser, out_web};

/// Cases with surfaces, several regions, walls, holes and given triangles, and shares of their steps in percent.
const STATES: [(&str, &[u64]); 8] = [
    ("example1", &[3, 50, 100]),
    ("example2", &[40, 100]),
    ("airfoil", &[20, 70, 100]),
    ("two-faces", &[30, 60, 100]),
    ("gear", &[50, 100]),
    ("polar-2", &[33, 100]),
    ("square-linear", &[66, 100]),
    ("wing", &[10, 55, 100]),
];

/// The page of out/web in a browser.
pub struct Page {
    pub browser: Browser,
    pub server: Server,
}

impl Page {
    /// The page with what a fragment says.
    pub fn open(fragment: &str) -> Option<Page> {
        let page = Page::after("", fragment)?;
        page.at_rest();
        Some(page)
    }

    /// The same in a browser that runs a script first; the page may not come up.
    fn after(script: &str, fragment: &str) -> Option<Page> {
        let server = Server::start(&out_web()?);
        let page = Page { browser: browser(&server)?, server };
        page.browser.run_first(script);
        page.browser.resize(1280, 800);
        page.browser.goto(&page.server.url(fragment));
        Some(page)
    }

    /// The state that is shown.
    pub fn state(&self) -> Value {
        shown(&self.browser)
    }

    /// The state once the window owes nothing.
    pub fn at_rest(&self) -> Value {
        at_rest(&self.browser)
    }

    /// Presses keys, and waits for what they lead to.
    fn press(&self, keys: &[&str]) -> Value {
        self.browser.key(keys);
        self.at_rest()
    }

    /// Does a command by its name in the palette.
    fn palette(&self, command: &str) -> Value {
        self.press(&["ctrl+p"]);
        self.browser.type_text(command);
        self.press(&["Return"])
    }

    /// Goes to what a link names.
    fn go(&self, link: &str) -> Value {
        self.browser.execute("location.hash = arguments[0]", &[json!(link)]);
        self.at_rest()
    }

    /// A file that the page hands over.
    fn download(&self, name: &str) -> Vec<u8> {
        let file = self.browser.downloads().join(name);
        let begin = Instant::now();
        while !file.exists() && begin.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(50));
        }
        std::fs::read(&file).unwrap_or_else(|error| panic!("{name}: {error}; {}", self.state()))
    }
}

/// What the window of a page, or of a frame at hand, shows.
pub fn shown(browser: &Browser) -> Value {
    let text = browser.until(
        // The cover goes when the window is there; its bar goes where that fails.
        "if (document.getElementById('cover')?.hidden) return quadfront.program.shownState();
         return document.getElementById('bar')?.hidden && document.getElementById('said').textContent",
    );
    let text = text.as_str().unwrap_or_default();
    serde_json::from_str(text).unwrap_or_else(|_| panic!("the page says: {text}"))
}

/// The same once it has opened what it was asked for and owes no answer. What was pressed before is heard first: the
/// window takes it in with its frames, and what follows a press that opens a field with a later one.
pub fn at_rest(browser: &Browser) -> Value {
    let begin = Instant::now();
    let frames = "const done = arguments[0];
        let left = 6;
        const next = () => (left-- ? requestAnimationFrame(next) : done());
        next();";
    browser.execute_async(frames, &[]);
    loop {
        let state = shown(browser);
        if state["busy"] == json!(false) && !(state["step"].is_null() && state["import"].is_null()) {
            return state;
        }
        if begin.elapsed() > Duration::from_secs(60) {
            panic!("the window does not come to rest: {state}; the console says {:#?}", browser.console());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn history(name: &str) -> History {
    let mut history = History::open(Run::of(built_in::named(name).unwrap().unwrap()), &mut Nobody).unwrap();
    history.extend(u64::MAX);
    history
}

/// The fingerprint of a state, made on this machine.
fn fingerprint_at(history: &mut History, step: u64) -> String {
    history.seek(step).unwrap();
    let state = history.state();
    fingerprint(&state.mesh, state.phase()).to_string()
}

#[test]
fn twenty_states_of_eight_cases_are_those_of_the_program_to_the_last_bit() {
    let Some(page) = Page::open("") else { return };
    let mut compared = 0;
    for (name, shares) in STATES {
        let mut history = history(name);
        let end = history.end().unwrap();
        for share in shares {
            let step = end * share / 100;
            let state = page.go(&format!("#case={name}&step={step}"));
            assert_eq!((&state["case"], &state["step"]), (&json!(name), &json!(step)), "{state}");
            assert_eq!(state["state"], json!(fingerprint_at(&mut history, step)), "{name} at step {step}");
            compared += 1;
        }
    }
    assert_eq!(compared, 20);
}

#[test]
fn keys_wheel_and_drags_do_what_they_do_in_the_window_and_a_link_says_where_that_led() {
    let Some(page) = Page::open("#case=example1") else { return };
    let mut history = history("example1");
    assert_eq!(page.state()["step"], json!(0));
    let ten = page.press(&["shift+Right"]);
    assert_eq!(ten["quadrilaterals"], json!(10), "{ten}");
    let nine = page.press(&["Left"]);
    assert_eq!(nine["quadrilaterals"], json!(9), "{nine}");
    assert_eq!(nine["state"], json!(fingerprint_at(&mut history, nine["step"].as_u64().unwrap())));
    let end = page.press(&["End"]);
    assert_eq!(end["step"], json!(history.end().unwrap()));

    let view = |state: &Value| Link::parse(state["link"].as_str().unwrap()).unwrap().view;
    let place = (500, 300);
    assert_eq!(view(&end), None, "{end}");
    page.browser.point(place);
    page.browser.wheel(place, (0, -300));
    let nearer = view(&page.at_rest()).unwrap();
    page.browser.drag(0, place, (560, 340));
    let moved = view(&page.at_rest()).unwrap();
    assert!(moved.height == nearer.height && moved.target != nearer.target, "{nearer:?} {moved:?}");
    // A click selects what is there, and the link names it.
    page.browser.click(place);
    let state = page.at_rest();
    let link = Link::parse(state["link"].as_str().unwrap()).unwrap();
    assert!(link.selected.is_some() && link.origin == Some(Origin::Case("example1".to_owned())), "{state}");
    // Another page opens that state.
    page.browser.goto("about:blank");
    page.browser.goto(&page.server.url(state["link"].as_str().unwrap()));
    let again = page.at_rest();
    for what in ["case", "step", "state", "link"] {
        assert_eq!(again[what], state[what], "{what}");
    }
    assert_eq!(asked_by_pages(&page.server), Vec::<String>::new());
}

#[test]
fn figures_meshes_and_runs_come_as_downloads_with_the_bytes_of_the_program() {
    let Some(page) = Page::open("#case=gear") else { return };
    let end = page.press(&["End"]);
    page.press(&["ctrl+m"]);
    page.press(&["ctrl+a"]);
    page.browser.type_text("gear.msh");
    page.press(&["Return"]);
    let mesh = page.download("gear.msh");
    let folder = tempfile::tempdir().unwrap();
    let expected = folder.path().join("gear.msh");
    let converted = Command::new(env!("CARGO_BIN_EXE_quadfront"))
        .args(["convert", "gear", "--quiet", "-o"])
        .arg(&expected)
        .status()
        .unwrap();
    assert!(converted.success() && mesh == std::fs::read(&expected).unwrap(), "the meshes differ");

    page.press(&["ctrl+e"]);
    let figure = page.download(&format!("gear-step-{}.svg", end["step"]));
    assert!(figure.starts_with(b"<svg") || figure.starts_with(b"<?xml"));
    assert!(page.download(&format!("gear-step-{}.png", end["step"])).starts_with(b"\x89PNG"));
    page.press(&["ctrl+s"]);
    let run = String::from_utf8(page.download("gear-run.toml")).unwrap();
    assert!(run.starts_with("run = 1") && page.state()["faults"] == json!([]), "{run}");
}

#[test]
fn a_mesh_that_is_dropped_is_imported_and_converted() {
    let Some(page) = Page::open("#case=example1") else { return };
    let mesh = std::fs::read_to_string("tests/data/plate_hole_soup.obj").unwrap();
    drop_file(&page.browser, "plate.obj", &mesh);
    page.browser.until("return JSON.parse(quadfront.program.shownState()).import === 'plate.obj'");
    let state = page.palette("Convert the mesh");
    assert_eq!((&state["case"], &state["import"]), (&json!("plate"), &Value::Null), "{state}");
    let end = page.press(&["End"]);
    let case = ImportOptions::default().case(PathBuf::from("tests/data/plate_hole_soup.obj"), None).unwrap();
    let mut history = History::open(Run::of(case), &mut Nobody).unwrap();
    history.extend(u64::MAX);
    let expected = fingerprint_at(&mut history, end["step"].as_u64().unwrap());
    assert_eq!((&end["state"], &end["faults"]), (&json!(expected), &json!([])), "{end}");
}

/// Drops a file on the window, as a person does from a folder.
fn drop_file(browser: &Browser, name: &str, text: &str) {
    let script = "const given = new DataTransfer();
        given.items.add(new File([arguments[1]], arguments[0]));
        const canvas = document.getElementById('window');
        for (const kind of ['dragover', 'drop']) {
            canvas.dispatchEvent(new DragEvent(kind, { dataTransfer: given, bubbles: true, cancelable: true }));
        }";
    browser.execute(script, &[json!(name), json!(text)]);
}

#[test]
fn a_run_survives_that_the_page_is_loaded_again() {
    let Some(page) = Page::open("#case=example1&step=40") else { return };
    page.palette("c = 1.8");
    let changed = page.press(&["shift+Right"]);
    // It is written a moment after the change.
    let kept = "return Object.keys(localStorage).some((name) => name.endsWith('.toml'))";
    page.browser.until(kept);
    std::thread::sleep(Duration::from_secs(3));
    page.browser.goto("about:blank");
    page.browser.goto(&page.server.url(""));
    page.at_rest();
    page.browser.until("return JSON.parse(quadfront.program.shownState()).offer");
    let recovered = page.palette("Recover the unsaved run");
    for what in ["case", "step", "state"] {
        assert_eq!(recovered[what], changed[what], "{what}: {recovered}");
    }
}

#[test]
fn a_page_in_one_file_opens_from_a_disk_and_in_a_frame_and_asks_for_nothing() {
    let Some(folder) = out_web() else { return };
    let nothing = tempfile::tempdir().unwrap();
    let server = Server::start(nothing.path());
    let Some(browser) = browser(&server) else { return };
    let pages = tempfile::tempdir().unwrap();
    let lesson = written(&folder, pages.path(), &["figure-14", "--lesson"], "lesson.html");
    let run = written(&folder, pages.path(), &["gear", "--set", "c=1.8", "--at", "nq=30"], "run.html");

    browser.goto(&format!("file://{}", run.display()));
    let state = at_rest(&browser);
    assert_eq!((&state["case"], &state["quadrilaterals"]), (&json!("gear"), &json!(30)), "{state}");
    assert!(state["link"].as_str().unwrap().contains("c=1.8"), "{state}");
    browser.goto(&format!("file://{}", lesson.display()));
    let state = at_rest(&browser);
    assert_eq!((&state["case"], &state["lesson"]), (&json!("figure-14"), &json!("figure-14")), "{state}");

    let frame = "<!DOCTYPE html><link rel='icon' href='data:,'><iframe src='lesson.html' width='900' height='600'
        sandbox='allow-scripts'></iframe>";
    std::fs::write(pages.path().join("outer.html"), frame).unwrap();
    browser.goto(&format!("file://{}", pages.path().join("outer.html").display()));
    browser.frame(Some(0));
    assert_eq!(at_rest(&browser)["lesson"], json!("figure-14"));
    assert_eq!((server.here(), asked_by_pages(&server)), (vec![], vec![]));
}

/// A page that the program writes.
fn written(out_web: &Path, folder: &Path, arguments: &[&str], name: &str) -> PathBuf {
    let program = Path::new(env!("CARGO_BIN_EXE_quadfront"));
    // The program looks for it beside itself.
    std::fs::copy(out_web.join("quadfront-page.html"), program.with_file_name("quadfront-page.html")).unwrap();
    let file = folder.join(name);
    let done = Command::new(program).arg("page").args(arguments).arg("-o").arg(&file).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    file
}

#[test]
fn the_page_asks_for_its_own_files_alone() {
    let Some(page) = Page::open("#case=example1") else { return };
    page.press(&["shift+Right", "ctrl+e", "End"]);
    // Whatever is asked for later is asked for soon.
    std::thread::sleep(Duration::from_secs(2));
    let mut requests = page.browser.requests();
    requests.retain(|url| !url.starts_with("about:"));
    requests.sort();
    let files = ["", "page.js", "quadfront.js", "quadfront.wasm.gz"].map(|file| page.server.url(file));
    let plain: Vec<&str> = requests.iter().map(|url| url.split('#').next().unwrap()).collect();
    assert_eq!(plain, files);
    assert_eq!(asked_by_pages(&page.server), Vec::<String>::new());
}

#[test]
fn a_browser_that_cannot_suspend_the_program_shows_the_same() {
    let Some(page) = Page::after("delete WebAssembly.promising; delete WebAssembly.Suspending", "#case=gear") else {
        return;
    };
    page.at_rest();
    let mut history = history("gear");
    let end = history.end().unwrap();
    let state = page.press(&["End"]);
    assert_eq!((&state["step"], &state["state"]), (&json!(end), &json!(fingerprint_at(&mut history, end))));
}

#[test]
fn a_browser_without_graphics_is_told_what_is_missing() {
    let script = "HTMLCanvasElement.prototype.getContext = () => null;
        Object.defineProperty(navigator, 'gpu', { value: undefined })";
    let Some(page) = Page::after(script, "") else { return };
    page.browser.until("return document.getElementById('said').textContent.includes('cannot be opened here')");
    let said = page.browser.execute("return document.getElementById('said').textContent", &[]);
    assert!(said.as_str().unwrap().contains("neither WebGPU nor WebGL 2"), "{said}");
}

#[test]
fn around_the_canvas_the_page_says_in_words_what_is_shown() {
    let Some(page) = Page::open("#case=example1&step=12") else { return };
    let text = "return document.getElementById(arguments[0]).textContent";
    let said = |id: &str| page.browser.execute(text, &[json!(id)]);
    page.browser.until("return document.getElementById('narration').textContent");
    let heading = said("heading");
    assert!(heading.as_str().unwrap().contains("step 12"), "{heading}");
    let before = said("narration");
    assert!(before.as_str().unwrap().contains("The front has"), "{before}");
    page.press(&["ctrl+Right"]);
    page.browser.until("return document.getElementById('heading').textContent.includes('step 13')");
    assert_ne!(said("narration"), before);
    assert!(said("keys").as_str().unwrap().contains("Save the run"));
    assert_eq!(page.browser.execute("return document.title", &[]), json!("example1 – quadfront"));
    assert_eq!(said("lesson"), json!(""));
}

#[test]
fn around_the_canvas_the_page_says_what_a_lesson_tells_and_asks() {
    let Some(page) = Page::open("#lesson=figure-14") else { return };
    let said = || page.browser.execute("return document.getElementById('lesson').innerText", &[]);
    page.browser.until("return document.getElementById('lesson').textContent.includes('Step')");
    let lesson = quadfront::core::lesson::built_in::named("figure-14").unwrap().unwrap();
    let first = said();
    let first = first.as_str().unwrap();
    let paragraphs: Vec<&str> = first.split("\n\n").collect();
    assert_eq!(paragraphs[..2], [&lesson.title, &lesson.parts[0].heading], "{first}");
    // Each press leads on: to the answer of a question that is open, or to the next question or part.
    let mut all = vec![first.to_owned()];
    let knows = |all: &[String], words: &str| all.iter().any(|said| said.contains(words));
    for _ in 0..20 {
        if knows(&all, &lesson.parts[1].heading) && knows(&all, "Question: ") && knows(&all, "The answer: ") {
            assert!(!all.iter().any(|said| said.contains(['*', '#'])), "marks are not told: {all:#?}");
            return;
        }
        page.press(&["Return"]);
        all.push(said().as_str().unwrap().to_owned());
    }
    panic!("{all:#?}");
}
