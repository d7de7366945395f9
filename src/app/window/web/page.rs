//! What the page offers to the program that runs in it (assets/web/page.js).

use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

#[wasm_bindgen(js_namespace = quadfront)]
extern "C" {
    /// Hands a file to the user, as a download.
    pub fn download(name: &str, bytes: &[u8]);

    /// Shows a state in words: the title of the page, a heading, a description, and what a lesson tells and asks.
    pub fn tell(title: &str, heading: &str, description: &str, lesson: &str);

    /// The page of the program as one file, as text.
    #[wasm_bindgen(catch)]
    pub async fn template() -> Result<JsValue, JsValue>;

    /// The name of this page among those of its address that are open.
    pub fn own() -> String;

    /// Whether the page of this name is open.
    #[wasm_bindgen(js_name = isAlive)]
    pub fn is_alive(name: &str) -> bool;

    /// What the browser keeps for pages of this address: names and texts in turn; none if it keeps nothing.
    pub fn stored() -> Option<Vec<String>>;

    /// Keeps a text under a name, or removes it. Returns what went wrong, or nothing.
    pub fn store(name: &str, text: Option<String>) -> Option<String>;
}
