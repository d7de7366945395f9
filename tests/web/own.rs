//! The browser and the server do what the other tests rely on.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::driver::{Browser, processes_with};
use crate::server::Server;
use crate::{asked_by_pages, browser, http};

/// A server of pages, each with its name, and a browser for it.
fn with_pages(pages: &[(&str, &str)]) -> Option<(tempfile::TempDir, Server, Browser)> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in pages {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let server = Server::start(folder.path());
    let browser = browser(&server)?;
    Some((folder, server, browser))
}

/// A page without a request for a picture of its own, which browsers make by themselves.
fn page(body: &str) -> String {
    format!("<!DOCTYPE html><meta charset=\"utf-8\"><link rel=\"icon\" href=\"data:,\"><body>{body}</body>")
}

#[test]
fn a_page_gets_the_keys_clicks_and_turns_that_the_driver_sends() {
    let listening = page(
        "<script>window.seen = [];
        const held = (e) => (e.ctrlKey ? 'ctrl+' : '') + (e.shiftKey ? 'shift+' : '') + (e.altKey ? 'alt+' : '');
        onkeydown = (e) => { seen.push(held(e) + e.key); e.preventDefault(); };
        onmousedown = (e) => seen.push(`${held(e)}down ${e.button} ${e.clientX},${e.clientY}`);
        onmouseup = (e) => seen.push(`up ${e.button} ${e.clientX},${e.clientY}`);
        addEventListener('wheel', (e) => {
            seen.push(`${held(e)}wheel ${e.deltaX},${e.deltaY}`);
            e.preventDefault();
        }, { passive: false });
        oncontextmenu = (e) => e.preventDefault();
        window.moves = 0;
        onmousemove = (e) => { if (e.buttons) moves += 1; };</script>",
    );
    let Some((_folder, server, browser)) = with_pages(&[("index.html", &listening)]) else { return };
    browser.goto(&server.url(""));
    let seen = |expected: Value| {
        let begin = Instant::now();
        // The wheel's event comes after the answer.
        while browser.execute("return seen", &[]) != expected && begin.elapsed() < Duration::from_secs(5) {}
        assert_eq!(browser.execute("return seen.splice(0)", &[]), expected);
    };
    browser.key(&["Right", "ctrl+shift+Left", "alt+F5", "Escape", "space", "End", "a", "shift+b"]);
    seen(json!([
        "ArrowRight",
        "ctrl+Control",
        "ctrl+shift+Shift",
        "ctrl+shift+ArrowLeft",
        "alt+Alt",
        "alt+F5",
        "Escape",
        " ",
        "End",
        "a",
        "shift+Shift",
        "shift+B"
    ]));
    browser.type_text("Zu ü");
    seen(json!(["shift+Z", "u", " ", "ü"]));
    browser.click((30, 40));
    seen(json!(["down 0 30,40", "up 0 30,40"]));
    browser.drag(2, (10, 20), (60, 80));
    seen(json!(["down 2 10,20", "up 2 60,80"]));
    assert_eq!(browser.execute("return moves >= 2", &[]), json!(true));
    browser.wheel((50, 50), (0, 120));
    seen(json!(["wheel 0,120"]));
    browser.holding("ctrl", || {
        browser.wheel((50, 50), (0, -120));
        browser.click((5, 6));
    });
    seen(json!(["ctrl+Control", "ctrl+wheel 0,-120", "ctrl+down 0 5,6", "up 0 5,6"]));
}

#[test]
fn scripts_answer_with_values_and_their_faults_are_told() {
    let Some((_folder, server, browser)) = with_pages(&[("index.html", &page("<p id='p'>text</p>"))]) else { return };
    browser.goto(&server.url(""));
    assert_eq!(
        browser.execute("return [arguments[0] + 1, p.textContent, null]", &[json!(2)]),
        json!([3, "text", null])
    );
    let later = "const done = arguments[arguments.length - 1]; setTimeout(() => done(arguments[0] * 2), 50)";
    assert_eq!(browser.execute_async(later, &[json!(21)]), json!(42));
    let fault = browser.try_execute("throw new Error('on purpose')", &[]).unwrap_err();
    assert!(fault.contains("on purpose"), "{fault}");
    browser.execute("setTimeout(() => window.there = 'soon', 100)", &[]);
    assert_eq!(browser.until("return window.there"), json!("soon"));
    let begin = Instant::now();
    assert_eq!(browser.until_within("return window.never", Duration::from_millis(200)), Err(Value::Null));
    assert!(begin.elapsed() < Duration::from_secs(10));
    browser.execute("console.error('a fault of the page')", &[]);
    let console = browser.console();
    assert!(console.len() == 1 && console[0].contains("SEVERE") && console[0].contains("a fault of"), "{console:?}");
}

#[test]
fn the_page_has_the_size_that_is_asked_for_and_graphics() {
    let blue = page("<style>body { background: rgb(0, 0, 255); margin: 0 }</style>");
    let Some((folder, server, browser)) = with_pages(&[("index.html", &blue)]) else { return };
    browser.goto(&server.url(""));
    for (width, height) in [(1280, 800), (600, 500)] {
        browser.resize(width, height);
        let file = folder.path().join("picture.png");
        browser.screenshot(&file);
        let png = std::fs::read(file).unwrap();
        // The size stands in the first part of a PNG.
        let number = |at: usize| i64::from(u32::from_be_bytes(png[at..at + 4].try_into().unwrap()));
        assert_eq!((&png[1..4], number(16), number(20)), (&b"PNG"[..], width, height));
    }
    let graphics =
        "const gl = document.createElement('canvas').getContext('webgl2'); return gl && gl.getParameter(gl.VERSION)";
    let version = browser.execute(graphics, &[]);
    assert!(version.as_str().is_some_and(|version| version.starts_with("WebGL 2")), "{version}");
}

#[test]
fn frames_are_entered_and_left_and_downloads_arrive() {
    let outer = page("<iframe src='inner.html' sandbox='allow-scripts'></iframe>");
    let inner = page("<p>inside</p>");
    let Some((_folder, server, browser)) = with_pages(&[("index.html", &outer), ("inner.html", &inner)]) else {
        return;
    };
    browser.goto(&server.url(""));
    browser.frame(Some(0));
    assert_eq!(browser.until("return document.querySelector('p')?.textContent"), json!("inside"));
    browser.frame(None);
    assert_eq!(browser.execute("return document.querySelector('p')", &[]), Value::Null);

    let save = "const a = document.createElement('a'); a.download = 'saved.txt';
        a.href = URL.createObjectURL(new Blob(['kept'])); a.click()";
    browser.execute(save, &[]);
    let file = browser.downloads().join("saved.txt");
    let begin = Instant::now();
    while !file.exists() && begin.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(std::fs::read_to_string(file).unwrap(), "kept");
}

#[test]
fn all_processes_end_with_the_browser() {
    let Some((_folder, server, browser)) = with_pages(&[("index.html", &page(""))]) else { return };
    browser.goto(&server.url(""));
    let folder = browser.folder().to_owned();
    assert!(!processes_with(&folder).is_empty());
    drop(browser);
    let begin = Instant::now();
    while !processes_with(&folder).is_empty() && begin.elapsed() < Duration::from_secs(5) {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(processes_with(&folder), Vec::<u32>::new());
    assert!(!folder.exists());
}

#[test]
fn a_page_that_asks_nobody_is_seen_to_ask_nobody() {
    let Some((_folder, server, browser)) = with_pages(&[("index.html", &page(""))]) else { return };
    browser.goto("about:blank");
    assert_eq!(browser.requests(), Vec::<String>::new());
    browser.goto(&server.url(""));
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(browser.requests(), [server.url("")]);
    assert_eq!((server.here(), asked_by_pages(&server)), (vec!["/".to_owned()], vec![]));
}

/// A way out of a page: what is in it, what the log says, and what the proxy is asked for.
const WAYS_OUT: [(&str, Option<&str>, &str); 8] = [
    ("<script>fetch('http://a.test/x').catch(() => 0)</script>", Some("http://a.test/x"), "http://a.test/x"),
    ("<script>fetch('https://b.test/x').catch(() => 0)</script>", Some("https://b.test/x"), "b.test:443"),
    ("<img src='http://c.test/x.png'>", Some("http://c.test/x.png"), "http://c.test/x.png"),
    ("<script>new WebSocket('ws://d.test/x')</script>", Some("ws://d.test/x"), "d.test:80"),
    ("<iframe src='http://e.test/x'></iframe>", Some("http://e.test/x"), "http://e.test/x"),
    // The log is the page's and not the worker's.
    (
        "<script>new Worker(URL.createObjectURL(new Blob(['fetch(\"http://f.test/x\")'])))</script>",
        None,
        "http://f.test/x",
    ),
    ("<link rel='preconnect' href='https://g.test'>", None, "g.test:443"),
    // Another server of this machine.
    (
        "<script>fetch('http://127.0.0.1:8999/x').catch(() => 0)</script>",
        Some("http://127.0.0.1:8999/x"),
        "http://127.0.0.1:8999/x",
    ),
];

#[test]
fn whatever_a_page_asks_of_others_is_seen() {
    let pages: Vec<String> = WAYS_OUT.iter().map(|(body, ..)| page(body)).collect();
    let names: Vec<String> = (0..pages.len()).map(|k| format!("{k}.html")).collect();
    let files: Vec<(&str, &str)> = names.iter().zip(&pages).map(|(name, page)| (&name[..], &page[..])).collect();
    let Some((folder, server, browser)) = with_pages(&files) else { return };
    for (name, (body, in_log, at_proxy)) in names.iter().zip(WAYS_OUT) {
        // From a server, and from a file.
        for url in [server.url(name), format!("file://{}/{name}", folder.path().display())] {
            let before = asked_by_pages(&server).len();
            browser.goto(&url);
            let begin = Instant::now();
            while asked_by_pages(&server).len() == before && begin.elapsed() < Duration::from_secs(10) {
                std::thread::sleep(Duration::from_millis(20));
            }
            let asked = asked_by_pages(&server).split_off(before);
            assert!(asked.iter().all(|target| target == at_proxy) && !asked.is_empty(), "{body}: {asked:?}");
            let requests = browser.requests();
            assert_eq!(requests[0], url);
            assert_eq!(requests.get(1).map(String::as_str), in_log, "{body}: {requests:?}");
        }
    }
}

#[test]
fn the_server_gives_the_files_of_its_folder_and_no_others() {
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("folder");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(outer.path().join("secret.txt"), "secret").unwrap();
    std::fs::write(folder.join("index.html"), "<p>").unwrap();
    std::fs::write(folder.join("a.wasm"), [0, 1, 2]).unwrap();
    let server = Server::start(&folder);
    let ask = |method: &str, target: &str| {
        let (status, body) = http::ask(server.address(), method, target, b"", Duration::from_secs(5)).unwrap();
        (status, body.len())
    };
    assert_eq!(ask("GET", "/"), (200, 3));
    assert_eq!(ask("GET", "/a.wasm?x#y"), (200, 3));
    assert_eq!(ask("GET", &server.url("a.wasm")), (200, 3));
    assert_eq!(ask("GET", "/b.wasm").0, 404);
    assert_eq!(ask("GET", "/../secret.txt").0, 404);
    assert_eq!(ask("GET", "//etc/passwd").0, 404);
    assert_eq!(ask("GET", "http://a.test/x").0, 502);
    assert_eq!(ask("CONNECT", "b.test:443").0, 502);
    assert_eq!(ask("POST", "/a.wasm").0, 502);
    assert_eq!(server.here(), ["/", "/a.wasm", "/a.wasm", "/b.wasm", "/../secret.txt", "//etc/passwd"]);
    assert_eq!(server.elsewhere(), ["http://a.test/x", "b.test:443", "/a.wasm"]);
}
