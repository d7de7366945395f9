//! Promise: the pages of `make web` work in a browser, and ask nobody for anything but their own files. What tests
//! that: a browser, a server that is its proxy as well, and the proof that a request to anybody else would be seen.
//!
//! Where Chromium, chromedriver or out/web is missing, tests that need it do nothing; where `QUADFRONT_NEEDS_BROWSER`
//! is set, as by `make test`, that is a failure.
#![allow(clippy::unwrap_used)]

mod driver;
mod http;
mod own;
mod server;
mod window;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Duration;

use driver::Browser;
use server::Server;

/// A browser whose proxy is the server.
fn browser(server: &Server) -> Option<Browser> {
    match Browser::start(server.address()) {
        Ok(browser) => Some(browser),
        Err(missing) => {
            skip(&missing.0);
            None
        }
    }
}

/// Whom pages wanted to ask, by what the proxy was asked for: everybody but those whom Chromium asks by itself, with an
/// empty page. Its flags leave one, which nobody has; a version that has new ones is no fault of the pages.
fn asked_by_pages(server: &Server) -> Vec<String> {
    static OWN: OnceLock<BTreeSet<String>> = OnceLock::new();
    let own = OWN.get_or_init(|| {
        let nothing = tempfile::tempdir().unwrap();
        let server = Server::start(nothing.path());
        if let Some(browser) = browser(&server) {
            browser.goto("about:blank");
            // What it asks at its start, it asks within two or three seconds.
            std::thread::sleep(Duration::from_secs(5));
        }
        server.elsewhere().iter().map(|target| host(target)).collect()
    });
    server.elsewhere().into_iter().filter(|target| !own.contains(&host(target))).collect()
}

/// The host, with its port, of what a proxy is asked for.
fn host(target: &str) -> String {
    let target = target.split_once("://").map_or(target, |(_, rest)| rest);
    target.split('/').next().unwrap_or_default().to_owned()
}

/// The folder that `make web` makes.
fn out_web() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("out/web");
    if folder.join("quadfront-page.html").exists() {
        Some(folder)
    } else {
        skip("out/web is not made");
        None
    }
}

fn skip(why: &str) {
    assert!(std::env::var_os("QUADFRONT_NEEDS_BROWSER").is_none(), "{why}");
    eprintln!("{why}: nothing was tested");
}
