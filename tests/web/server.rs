//! A server of the files of one folder on 127.0.0.1, which is the browser's proxy as well: whatever the browser asks of
//! anybody is asked here, is written down, and is turned away unless it is a file of the folder.

use std::io::Write;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Component, Path};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::http;

/// How long a connection may be silent. Browsers open some that they do not use.
const SILENCE: Duration = Duration::from_secs(5);

/// What has been asked so far.
#[derive(Default)]
struct Asked {
    /// Paths of this server.
    here: Vec<String>,
    /// Hosts with their ports, or addresses, of anybody else.
    elsewhere: Vec<String>,
}

pub struct Server {
    address: SocketAddr,
    asked: Arc<Mutex<Asked>>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    pub fn start(folder: &Path) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let (asked, ends) = (Arc::<Mutex<Asked>>::default(), Arc::<AtomicBool>::default());
        let (folder, asked_there, ends_there) = (folder.to_owned(), asked.clone(), ends.clone());
        let thread = std::thread::spawn(move || {
            for stream in listener.incoming() {
                if ends_there.load(Ordering::Relaxed) {
                    break;
                }
                let (folder, asked) = (folder.clone(), asked_there.clone());
                if let Ok(stream) = stream {
                    // A connection that breaks is the browser's affair: the page then lacks a file.
                    std::thread::spawn(move || answer(stream, address, &folder, &asked).ok());
                }
            }
        });
        Self { address, asked, ends, thread: Some(thread) }
    }

    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The address of a file.
    pub fn url(&self, path: &str) -> String {
        format!("http://{}/{path}", self.address)
    }

    /// The paths that were asked of this server, in order.
    pub fn here(&self) -> Vec<String> {
        self.asked.lock().unwrap().here.clone()
    }

    /// Whom else the browser wanted to ask, in order.
    pub fn elsewhere(&self) -> Vec<String> {
        self.asked.lock().unwrap().elsewhere.clone()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        // The thread waits for a connection, and this is one.
        TcpStream::connect(self.address).ok();
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

fn answer(stream: TcpStream, own: SocketAddr, folder: &Path, asked: &Mutex<Asked>) -> std::io::Result<()> {
    stream.set_read_timeout(Some(SILENCE))?;
    stream.set_write_timeout(Some(SILENCE))?;
    let (first, _) = http::read_message(&stream)?;
    let mut words = first.split(' ');
    let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    // A proxy is given whole addresses, and `CONNECT HOST:PORT` for everything that is no plain HTTP.
    let here = match target.strip_prefix(&format!("http://{own}")) {
        Some(path) => Some(path),
        None => target.starts_with('/').then_some(target),
    };
    let Some(path) = here.filter(|_| method == "GET" || method == "HEAD") else {
        asked.lock().unwrap().elsewhere.push(target.to_owned());
        return respond(stream, "502 Bad Gateway", "text/plain", b"There is nobody else here.", method);
    };
    let path = path.split(['?', '#']).next().unwrap_or_default();
    asked.lock().unwrap().here.push(path.to_owned());
    let file = match path.trim_start_matches('/') {
        "" => "index.html",
        file => file,
    };
    let inside = Path::new(file).components().all(|part| matches!(part, Component::Normal(_)));
    match inside.then(|| std::fs::read(folder.join(file))) {
        Some(Ok(bytes)) => respond(stream, "200 OK", mime_type(&folder.join(file)), &bytes, method),
        _ => respond(stream, "404 Not Found", "text/plain", b"There is no such file.", method),
    }
}

fn respond(mut stream: TcpStream, status: &str, kind: &str, body: &[u8], method: &str) -> std::io::Result<()> {
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
         Connection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())?;
    if method != "HEAD" {
        stream.write_all(body)?;
    }
    Ok(())
}

fn mime_type(file: &Path) -> &'static str {
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("json") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("gz") => "application/gzip",
        _ => "application/octet-stream",
    }
}
