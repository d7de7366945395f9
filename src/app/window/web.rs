//! The window in a page of a browser: how it is begun, what the page gives it, and what it hands to the page.

pub mod page;
pub mod storage;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use eframe::egui::{Context, DroppedFileHandle};
use serde_json::json;
use wasm_bindgen::JsCast;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};
use wasm_bindgen_futures::spawn_local;
use web_sys::HtmlCanvasElement;

use super::app::App;
use super::command::{Command, groups};
use super::files::main_of;
use super::session::Source;
use super::state::State;
use super::study::{Study, in_words};
use super::{autosave, graphics, settings, viewport};
use crate::app::page::Content;
use crate::core::fault::Fault;
use crate::core::formats::save::memory;
use crate::core::record::link::Link;
use crate::core::run::shown::fingerprint;

thread_local! {
    static RUNNER: RefCell<Option<eframe::WebRunner>> = const { RefCell::new(None) };
    /// What the page was told last of the state.
    static TOLD: RefCell<[String; 4]> = const { RefCell::new([const { String::new() }; 4]) };
}

/// What the page asks for before the next frame, or why it cannot be had.
static ASKED: Mutex<Vec<Result<Command, Fault>>> = Mutex::new(Vec::new());

fn ask(asked: Result<Command, Fault>) {
    ASKED.lock().unwrap_or_else(PoisonError::into_inner).push(asked);
}

/// Begins the window in a canvas. It shows what a link says, or what the page carries (JSON); where both are empty,
/// example 1.
///
/// # Errors
/// There is no canvas of this name, or no way to draw.
#[wasm_bindgen]
pub async fn start(canvas: &str, link: &str, carried: &str) -> Result<(), JsValue> {
    memory::tell(storage::keep);
    storage::load();
    let document = web_sys::window().and_then(|window| window.document());
    let canvas = document.and_then(|document| document.get_element_by_id(canvas));
    let Some(canvas) = canvas.and_then(|element| element.dyn_into::<HtmlCanvasElement>().ok()) else {
        return Err(JsValue::from_str("The page has no canvas"));
    };
    let options =
        eframe::WebOptions { wgpu_options: graphics::options(), dithering: false, ..eframe::WebOptions::default() };
    let carried: Content = serde_json::from_str(carried).unwrap_or_default();
    for (name, bytes) in carried.files {
        memory::give(Path::new(&name), STANDARD.decode(bytes).unwrap_or_default());
    }
    let first = match [link, &carried.open] {
        ["", ""] => Command::Open(Source::BuiltIn("example1".to_owned())),
        ["", open] if !Link::is_link(open) => Command::Open(Source::of_file(PathBuf::from(open))),
        ["", link] | [link, _] => Command::OpenLink(link.to_owned()),
    };
    let runner = eframe::WebRunner::new();
    let begun = runner.start(
        canvas,
        options,
        Box::new(move |cc| {
            let path = settings::path();
            let mut app = App::kept(cc, None, path, graphics::Lost::default()).keeping(autosave::folder()).cleared();
            app.apply(first);
            Ok(Box::new(app))
        }),
    );
    begun.await?;
    RUNNER.set(Some(runner));
    Ok(())
}

/// Opens what a link says.
#[wasm_bindgen(js_name = openLink)]
pub fn open_link(link: &str) {
    ask(Ok(Command::OpenLink(link.to_owned())));
    let context = RUNNER.with_borrow(|runner| Some(runner.as_ref()?.app_mut::<App>()?.state.wake()));
    if let Some(wake) = context {
        wake();
    }
}

/// The keys of the window and what they do, as JSON: pairs of texts.
#[wasm_bindgen(js_name = keysInWords)]
pub fn keys_in_words() -> String {
    let entries = groups().into_iter().flat_map(|(_, entries)| entries);
    let pairs: Vec<[String; 2]> = entries.map(|(keys, command)| [keys, command.name()]).collect();
    json!(pairs).to_string()
}

/// The state that is shown, as JSON: for tests, and for pages around this one.
#[wasm_bindgen(js_name = shownState)]
pub fn shown_state() -> String {
    let state = RUNNER.with_borrow(|runner| {
        let app = runner.as_ref()?.app_mut::<App>()?;
        Some(state_of(&app.state))
    });
    state.unwrap_or_default().to_string()
}

fn state_of(state: &State) -> serde_json::Value {
    let run = state.run();
    json!({
        "case": run.opened.as_ref().map(|opened| &opened.run.case.name),
        "busy": run.is_busy() || run.is_opening(),
        "recorded": run.recorded,
        "steps": run.track.len(),
        "step": run.moment.as_ref().map(|moment| moment.step),
        "quadrilaterals": run.moment.as_ref().map(|moment| moment.standing),
        "state": run.moment.as_ref().map(|moment| fingerprint(&moment.mesh, &moment.phase).to_string()),
        "link": state.link().and_then(|link| link.ok()?.text().ok()),
        "lesson": state.study().and_then(Study::lesson).map(|(lesson, _)| &lesson.name),
        "offer": run.autosave.as_ref().and_then(|autosave| Some(&autosave.offer()?.0.text)),
        "import": run.import.as_ref().map(|import| import.path.display().to_string()),
        "notice": state.view().notice().map(|notice| notice.0),
        "faults": &state.view().faults,
    })
}

/// What the page has asked for since the last frame.
pub fn asked() -> Vec<Result<Command, Fault>> {
    std::mem::take(&mut ASKED.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Takes in a file of the user. Returns its name among the files of this page.
pub fn take_in(name: &str, bytes: Vec<u8>) -> PathBuf {
    // The name alone: a browser tells no folder.
    let path = PathBuf::from(Path::new(name).file_name().unwrap_or_default());
    storage::keep_given(&path, &bytes);
    memory::give(&path, bytes);
    path
}

/// Reads files that were dropped on the window, and opens them.
pub fn open_dropped(files: Vec<DroppedFileHandle>, context: &Context) {
    let context = context.clone();
    spawn_local(async move {
        let mut given = Vec::new();
        for file in files {
            let name = file.path().display().to_string();
            match file.bytes_async().await {
                Ok(bytes) => given.push(take_in(&name, bytes)),
                Err(what) => ask(Err(Fault::new(format!("The browser cannot read it: {what}")).at(name))),
            }
        }
        if let Some(main) = main_of(&given) {
            ask(Ok(Command::Open(Source::of_file(main.clone()))));
        }
        context.request_repaint();
    });
}

/// Tells the page its title and the state in words, where they have changed.
pub fn tell(state: &State, title: &str) {
    let [heading, description] = viewport::in_words(state);
    let lesson = state.shown_study().map(in_words).unwrap_or_default();
    let told = [title.to_owned(), heading, description, lesson];
    TOLD.with_borrow_mut(|before| {
        if *before != told {
            page::tell(&told[0], &told[1], &told[2], &told[3]);
            *before = told;
        }
    });
}
