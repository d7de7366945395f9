//! A browser without a screen: Chromium, worked by WebDriver (W3C) through chromedriver.
//!
//! What fails panics and says what was asked. Nothing waits for ever, and all processes end with the `Browser`.

use std::fmt::Display;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::http;

/// How long chromedriver may take to start, and `until` waits.
const PATIENCE: Duration = Duration::from_secs(60);
/// How long a page may load and a script run, which the browser watches.
const LOADING: Duration = Duration::from_secs(60);
/// How long an answer of chromedriver may take: longer than what it waits for itself.
const ANSWER: Duration = Duration::from_secs(120);

/// What Chromium is started with, besides its proxy and its folder.
const ARGUMENTS: [&str; 19] = [
    "--headless",
    // Tests run as root in containers, which have little shared memory as well.
    "--no-sandbox",
    "--disable-dev-shm-usage",
    // Graphics without a card.
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    // Chromium's own conversation with its makers.
    "--no-first-run",
    "--no-default-browser-check",
    "--no-pings",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-domain-reliability",
    "--disable-client-side-phishing-detection",
    "--metrics-recording-only",
    "--disable-features=OptimizationHints,MediaRouter,Translate,AutofillServerCommunication,NetworkTimeServiceQuerying",
    "--allow-browser-signin=false",
    // Two that no flag stops are sent to nowhere: updates of parts of Chromium, and whether somebody is signed in.
    "--component-updater=url-source=data:,",
    "--gaia-url=http://signin.invalid",
];

/// Why there is no browser.
pub struct Missing(pub String);

/// chromedriver, and whatever it has started, in a folder that goes with them.
struct Driver {
    process: Child,
    folder: TempDir,
}

impl Drop for Driver {
    fn drop(&mut self) {
        self.process.kill().ok();
        self.process.wait().ok();
        // What chromedriver could not end has the name of our folder among its arguments.
        let left: Vec<String> = processes_with(self.folder.path()).iter().map(u32::to_string).collect();
        if !left.is_empty() {
            Command::new("kill").arg("-9").args(left).status().ok();
        }
    }
}

/// Processes that have a path among their arguments.
pub fn processes_with(path: &Path) -> Vec<u32> {
    let path = path.to_string_lossy();
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let ids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    ids.filter(|id: &u32| {
        // A process may end meanwhile.
        let arguments = std::fs::read(format!("/proc/{id}/cmdline")).unwrap_or_default();
        String::from_utf8_lossy(&arguments).contains(&*path)
    })
    .collect()
}

pub struct Browser {
    address: SocketAddr,
    /// The path of the session.
    session: String,
    driver: Driver,
}

impl Browser {
    /// Starts Chromium with a profile of its own. Everything it asks of anybody goes to the proxy, this machine's own
    /// addresses too.
    pub fn start(proxy: SocketAddr) -> Result<Self, Missing> {
        let folder = tempfile::tempdir().unwrap();
        let process = Command::new("chromedriver")
            .arg("--port=0")
            .env("HOME", folder.path())
            .env("TMPDIR", folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| Missing(format!("chromedriver: {error}")))?;
        let mut driver = Driver { process, folder };
        let port = port_of(&mut driver.process);
        let mut browser = Self { address: SocketAddr::from(([127, 0, 0, 1], port)), session: String::new(), driver };

        let profile = format!("--user-data-dir={}", browser.driver.folder.path().join("profile").display());
        let proxy = [format!("--proxy-server={proxy}"), "--proxy-bypass-list=<-loopback>".into(), profile];
        let arguments: Vec<&str> = ARGUMENTS.into_iter().chain(proxy.iter().map(String::as_str)).collect();
        let milliseconds = LOADING.as_millis() as u64;
        let wanted = json!({ "capabilities": { "alwaysMatch": {
            "timeouts": { "script": milliseconds, "pageLoad": milliseconds, "implicit": 0 },
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
            "goog:chromeOptions": {
                "args": arguments,
                "prefs": {
                    "download.default_directory": browser.downloads(),
                    // Several at once: a person is asked once.
                    "profile.default_content_setting_values.automatic_downloads": 1,
                    // Distributions set a page to start with, and one for new tabs, which ask their makers.
                    "session.restore_on_startup": 4,
                    "session.startup_urls": ["about:blank"],
                    "homepage": "about:blank",
                    "homepage_is_newtabpage": false,
                    "search.suggest_enabled": false,
                    "signin.allowed": false,
                },
                "perfLoggingPrefs": { "enableNetwork": true },
            },
        } } });
        match browser.ask("POST", "/session", &wanted) {
            Ok(answer) => browser.session = format!("/session/{}", answer["sessionId"].as_str().unwrap()),
            Err(said) if said.contains("cannot find Chrome binary") => return Err(Missing(said)),
            Err(said) => panic!("chromedriver started no browser: {said}"),
        }
        Ok(browser)
    }

    /// Opens an address and waits until it has loaded.
    pub fn goto(&self, url: &str) {
        self.command("POST", "/url", &json!({ "url": url }));
    }

    /// Has every page run a script before its own.
    pub fn run_first(&self, script: &str) {
        let given = json!({ "cmd": "Page.addScriptToEvaluateOnNewDocument", "params": { "source": script } });
        self.command("POST", "/goog/cdp/execute", &given);
    }

    /// What the body of a function returns in the page; its arguments are `arguments[0]` and so on.
    pub fn execute(&self, script: &str, arguments: &[Value]) -> Value {
        self.try_execute(script, arguments).unwrap_or_else(|said| panic!("{script}: {said}"))
    }

    /// As `execute`; what the script throws is the error.
    pub fn try_execute(&self, script: &str, arguments: &[Value]) -> Result<Value, String> {
        self.ask("POST", &format!("{}/execute/sync", self.session), &json!({ "script": script, "args": arguments }))
    }

    /// What a script gives to its last argument, a function.
    pub fn execute_async(&self, script: &str, arguments: &[Value]) -> Value {
        self.command("POST", "/execute/async", &json!({ "script": script, "args": arguments }))
    }

    /// Waits until the body of a function returns something true, which is returned.
    pub fn until(&self, script: &str) -> Value {
        self.until_within(script, PATIENCE).unwrap_or_else(|last| {
            panic!("waited in vain until: {script}; it is {last}; the console says {:#?}", self.console())
        })
    }

    /// As `until`, for so long at most; the error is what the function returned last.
    pub fn until_within(&self, script: &str, patience: Duration) -> Result<Value, Value> {
        let begin = Instant::now();
        loop {
            let value = self.execute(script, &[]);
            if !matches!(&value, Value::Null | Value::Bool(false)) && value != json!(0) && value != json!("") {
                return Ok(value);
            }
            if begin.elapsed() > patience {
                return Err(value);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Writes what the window shows as PNG.
    pub fn screenshot(&self, path: &Path) {
        let picture = self.command("GET", "/screenshot", &Value::Null);
        std::fs::write(path, BASE64_STANDARD.decode(picture.as_str().unwrap()).unwrap()).unwrap();
    }

    /// Presses keys one after another, each with what is held meanwhile: `ctrl+shift+Right`. Names are xdotool's.
    pub fn key(&self, keys: &[&str]) {
        let mut actions = Vec::new();
        for combination in keys {
            let codes: Vec<String> = combination.split('+').map(key_code).collect();
            actions.extend(codes.iter().map(|code| json!({ "type": "keyDown", "value": code })));
            actions.extend(codes.iter().rev().map(|code| json!({ "type": "keyUp", "value": code })));
        }
        self.act(json!({ "type": "key", "id": "keyboard", "actions": actions }));
    }

    /// Types a text.
    pub fn type_text(&self, text: &str) {
        let press = |c: char| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": c.to_string() }));
        let actions: Vec<Value> = text.chars().flat_map(press).collect();
        self.act(json!({ "type": "key", "id": "keyboard", "actions": actions }));
    }

    /// Does something while a key is held.
    pub fn holding(&self, key: &str, work: impl FnOnce()) {
        let act = |kind| {
            let action = json!({ "type": kind, "value": key_code(key) });
            self.act(json!({ "type": "key", "id": "keyboard", "actions": [action] }));
        };
        act("keyDown");
        work();
        act("keyUp");
    }

    /// Points at a place.
    pub fn point(&self, (x, y): (i64, i64)) {
        self.pointer(vec![json!({ "type": "pointerMove", "x": x, "y": y, "duration": 0 })]);
    }

    /// Clicks at a place of the window, or of the frame at hand, in points.
    pub fn click(&self, (x, y): (i64, i64)) {
        self.pointer(vec![
            json!({ "type": "pointerMove", "x": x, "y": y, "duration": 0 }),
            json!({ "type": "pointerDown", "button": 0 }),
            json!({ "type": "pointerUp", "button": 0 }),
        ]);
    }

    /// Drags with a button (0 left, 1 middle, 2 right), not in one leap.
    pub fn drag(&self, button: u8, (x, y): (i64, i64), (to_x, to_y): (i64, i64)) {
        let between = ((x + to_x) / 2, (y + to_y) / 2);
        self.pointer(vec![
            json!({ "type": "pointerMove", "x": x, "y": y, "duration": 0 }),
            json!({ "type": "pointerDown", "button": button }),
            json!({ "type": "pointerMove", "x": between.0, "y": between.1, "duration": 50 }),
            json!({ "type": "pointerMove", "x": to_x, "y": to_y, "duration": 50 }),
            json!({ "type": "pointerUp", "button": button }),
        ]);
    }

    /// Turns the wheel at a place.
    pub fn wheel(&self, (x, y): (i64, i64), (delta_x, delta_y): (i64, i64)) {
        let turn = json!({
            "type": "scroll", "x": x, "y": y, "deltaX": delta_x, "deltaY": delta_y, "origin": "viewport", "duration": 0,
        });
        self.act(json!({ "type": "wheel", "id": "wheel", "actions": [turn] }));
    }

    fn pointer(&self, actions: Vec<Value>) {
        self.act(json!({
            "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions,
        }));
    }

    fn act(&self, source: Value) {
        self.command("POST", "/actions", &json!({ "actions": [source] }));
    }

    /// Gives the page a size, in points: the window's is larger by its frame.
    pub fn resize(&self, width: i64, height: i64) {
        let frame = self.execute("return [outerWidth - innerWidth, outerHeight - innerHeight]", &[]);
        let (width_of_frame, height_of_frame) = (frame[0].as_i64().unwrap(), frame[1].as_i64().unwrap());
        let size = json!({ "width": width + width_of_frame, "height": height + height_of_frame });
        self.command("POST", "/window/rect", &size);
        self.until(&format!("return innerWidth === {width} && innerHeight === {height}"));
    }

    /// What follows concerns a frame of the page at hand, or with `None` the page itself.
    pub fn frame(&self, index: Option<usize>) {
        self.command("POST", "/frame", &json!({ "id": index }));
    }

    /// Where the page's downloads go.
    pub fn downloads(&self) -> PathBuf {
        self.driver.folder.path().join("downloads")
    }

    /// The folder of this browser, which its processes name.
    pub fn folder(&self) -> &Path {
        self.driver.folder.path()
    }

    /// What the page has written to its console since this was asked last, with what it could not load.
    pub fn console(&self) -> Vec<String> {
        let entries = self.log("browser");
        let lines = entries.iter().map(|entry| {
            format!(
                "{}: {}",
                entry["level"].as_str().unwrap_or_default(),
                entry["message"].as_str().unwrap_or_default()
            )
        });
        lines.collect()
    }

    /// The addresses that pages have asked for since this was asked last, their own included. What needs nobody, such
    /// as `data:` and `blob:`, is left out. Chromium's own requests belong to no page, and so do those that a worker
    /// makes: the proxy sees both.
    pub fn requests(&self) -> Vec<String> {
        let entries = self.log("performance");
        let urls = entries.iter().filter_map(|entry| {
            let message: Value = serde_json::from_str(entry["message"].as_str()?).ok()?;
            let (method, given) = (message["message"]["method"].as_str()?, &message["message"]["params"]);
            let url = match method {
                "Network.requestWillBeSent" => given["request"]["url"].as_str()?,
                "Network.webSocketCreated" | "Network.webTransportCreated" => given["url"].as_str()?,
                _ => return None,
            };
            let needs_nobody = ["data:", "blob:", "about:"].iter().any(|scheme| url.starts_with(scheme));
            (!needs_nobody).then(|| url.to_owned())
        });
        urls.collect()
    }

    fn log(&self, kind: &str) -> Vec<Value> {
        self.command("POST", "/se/log", &json!({ "type": kind })).as_array().unwrap().clone()
    }

    /// A command of the session.
    fn command(&self, method: &str, path: &str, given: &Value) -> Value {
        self.ask(method, &format!("{}{path}", self.session), given)
            .unwrap_or_else(|said| panic!("{method} {path} {given}: {said}"))
    }

    fn ask(&self, method: &str, path: &str, given: &Value) -> Result<Value, String> {
        let body = if given.is_null() { Vec::new() } else { given.to_string().into_bytes() };
        let (status, answer) = http::ask(self.address, method, path, &body, ANSWER).map_err(in_words)?;
        let mut answer: Value = serde_json::from_slice(&answer).map_err(in_words)?;
        let value = answer["value"].take();
        if status == 200 { Ok(value) } else { Err(value["message"].as_str().unwrap_or_default().to_owned()) }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Closes the windows; what is left after that ends with the driver.
        http::ask(self.address, "DELETE", &self.session, b"", Duration::from_secs(10)).ok();
    }
}

fn in_words(fault: impl Display) -> String {
    format!("chromedriver does not answer: {fault}")
}

/// The port that chromedriver has taken, which it prints.
fn port_of(process: &mut Child) -> u16 {
    let output = BufReader::new(process.stdout.take().unwrap());
    let (sender, receiver) = mpsc::channel();
    // The thread ends with the output, so with the process.
    std::thread::spawn(move || {
        for line in output.lines().map_while(Result::ok) {
            let port = line.split_once("successfully on port ").map(|(_, port)| port.trim_end_matches('.').parse());
            if let Some(Ok(port)) = port {
                sender.send(port).ok();
            }
        }
    });
    receiver.recv_timeout(PATIENCE).expect("chromedriver says no port")
}

/// The character that WebDriver has for a key.
fn key_code(name: &str) -> String {
    let code = match name {
        "ctrl" => '\u{e009}',
        "shift" => '\u{e008}',
        "alt" => '\u{e00a}',
        "super" => '\u{e03d}',
        "BackSpace" => '\u{e003}',
        "Tab" => '\u{e004}',
        "Return" => '\u{e007}',
        "Escape" => '\u{e00c}',
        "space" => ' ',
        "Prior" => '\u{e00e}',
        "Next" => '\u{e00f}',
        "End" => '\u{e010}',
        "Home" => '\u{e011}',
        "Left" => '\u{e012}',
        "Up" => '\u{e013}',
        "Right" => '\u{e014}',
        "Down" => '\u{e015}',
        "Insert" => '\u{e016}',
        "Delete" => '\u{e017}',
        _ => match name.strip_prefix('F').and_then(|number| number.parse::<u32>().ok()) {
            Some(number @ 1..=12) => char::from_u32(0xe030 + number).unwrap(),
            _ => {
                let mut letters = name.chars();
                match (letters.next(), letters.next()) {
                    (Some(letter), None) => letter,
                    _ => panic!("there is no key {name}"),
                }
            }
        },
    };
    code.to_string()
}
