//! `quadfront-web WASM ASSETS OUT`: makes the pages of OUT from the compiled library and the template in ASSETS.
//!
//! OUT holds `index.html`, `page.js`, `quadfront.js` and `quadfront.wasm`, each also as `.gz`, for a server; and
//! `quadfront-page.html`, which needs none. It changes as a whole: when something fails, the old one stays.

mod inline;
mod join;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libdeflater::{CompressionLvl, Compressor};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [wasm, assets, out] = arguments.as_slice() else {
        eprintln!("usage: quadfront-web WASM ASSETS OUT");
        return ExitCode::from(2);
    };
    match make(wasm, assets, out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("quadfront-web: {fault}");
            ExitCode::FAILURE
        }
    }
}

/// Makes OUT.
fn make(wasm: &Path, assets: &Path, out: &Path) -> Result<(), String> {
    // Only what this tool has made is replaced.
    let is_ours = !out.exists() || out.join("quadfront.wasm").exists() || is_empty(out);
    if !is_ours {
        return Err(format!("{} is in the way: it holds something else", out.display()));
    }
    let beside = |ending: &str| {
        let mut name = out.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    let (part, old) = (beside(".part"), beside(".old"));
    remove(&part)?;
    remove(&old)?;
    fs::create_dir_all(&part).map_err(|error| at(&part, error))?;
    fill(&part, wasm, assets)?;
    if out.exists() {
        fs::rename(out, &old).map_err(|error| at(out, error))?;
    }
    fs::rename(&part, out).map_err(|error| at(&part, error))?;
    remove(&old)
}

/// Writes all files into a folder, `quadfront-page.html` last.
fn fill(folder: &Path, wasm: &Path, assets: &Path) -> Result<(), String> {
    Bindgen::new()
        .input_path(wasm)
        .out_name("quadfront")
        .web(true)
        .map_err(|error| format!("{error:#}"))?
        .typescript(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        // The page says where the program is; it may be inside.
        .omit_default_module_path(true)
        .generate(folder)
        .map_err(|error| format!("{}: {error:#}", wasm.display()))?;
    if folder.join("snippets").exists() {
        return Err("the bindings have scripts of their own (snippets), which one page cannot hold".into());
    }
    let program = read(&folder.join("quadfront_bg.wasm"))?;
    fs::remove_file(folder.join("quadfront_bg.wasm")).map_err(|error| at(folder, error))?;
    let bindings = read_text(&folder.join("quadfront.js"))?;
    let script = read_text(&assets.join("page.js"))?;
    let program_gz = gzip(&program)?;
    let page = inline::with_sizes(&read_text(&assets.join("page.html"))?, program.len(), program_gz.len())?;
    let whole = inline::whole(&page, &program_gz, &join::joined(&bindings, &script)?)?;

    for (name, bytes) in
        [("index.html", page.as_bytes()), ("page.js", script.as_bytes()), ("quadfront.js", bindings.as_bytes())]
    {
        write(&folder.join(name), bytes)?;
        write(&folder.join(format!("{name}.gz")), &gzip(bytes)?)?;
    }
    write(&folder.join("quadfront.wasm"), &program)?;
    write(&folder.join("quadfront.wasm.gz"), &program_gz)?;
    write(&folder.join("quadfront-page.html"), whole.as_bytes())
}

/// The same bytes at every time: no name and no date inside.
fn gzip(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut compressor = Compressor::new(CompressionLvl::best());
    let mut compressed = vec![0; compressor.gzip_compress_bound(bytes.len())];
    let length = compressor.gzip_compress(bytes, &mut compressed).map_err(|error| error.to_string())?;
    compressed.truncate(length);
    Ok(compressed)
}

fn is_empty(folder: &Path) -> bool {
    fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none())
}

fn remove(folder: &Path) -> Result<(), String> {
    if folder.exists() { fs::remove_dir_all(folder).map_err(|error| at(folder, error)) } else { Ok(()) }
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|error| at(path, error))
}

fn read_text(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| at(path, error))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    fs::write(path, bytes).map_err(|error| at(path, error))
}

fn at(path: &Path, error: impl std::fmt::Display) -> String {
    format!("{}: {error}", path.display())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A module that has nothing in it.
    const EMPTY: &[u8] = b"\0asm\x01\0\0\0";

    struct Folder {
        folder: tempfile::TempDir,
    }

    impl Folder {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("a.wasm"), EMPTY).unwrap();
            Self { folder }
        }

        fn at(&self, name: &str) -> PathBuf {
            self.folder.path().join(name)
        }

        fn make(&self, wasm: &str) -> Result<(), String> {
            let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/assets");
            make(&self.at(wasm), &assets, &self.at("out/web"))
        }
    }

    #[test]
    fn all_files_are_made_and_compressed_ones_hold_the_same() {
        let folder = Folder::new();
        folder.make("a.wasm").unwrap();
        let out = folder.at("out/web");
        let mut names: Vec<_> =
            fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        let plain = ["index.html", "page.js", "quadfront.js", "quadfront.wasm"];
        let mut expected: Vec<String> =
            plain.iter().flat_map(|name| [name.to_string(), format!("{name}.gz")]).collect();
        expected.push("quadfront-page.html".into());
        expected.sort();
        assert_eq!(names, expected);
        for name in plain {
            let compressed = fs::read(out.join(format!("{name}.gz"))).unwrap();
            // A head of 10 bytes without a name, and 8 bytes at the end.
            assert_eq!(compressed[..8], [0x1f, 0x8b, 8, 0, 0, 0, 0, 0]);
            let inside = &compressed[10..compressed.len() - 8];
            assert_eq!(miniz_oxide::inflate::decompress_to_vec(inside).unwrap(), fs::read(out.join(name)).unwrap());
        }
        let whole = fs::read_to_string(out.join("quadfront-page.html")).unwrap();
        assert!(whole.contains("\"default\": __wbg_init") && !whole.contains("src="), "{whole}");
        assert!(!fs::read_to_string(out.join("quadfront.js")).unwrap().contains("_bg.wasm"));
    }

    #[test]
    fn the_old_pages_stay_when_something_fails() {
        let folder = Folder::new();
        folder.make("a.wasm").unwrap();
        fs::write(folder.at("b.wasm"), "no module").unwrap();
        let fault = folder.make("b.wasm").unwrap_err();
        assert!(fault.contains("b.wasm"), "{fault}");
        assert!(folder.at("out/web/quadfront-page.html").exists());
        // What the failure has left is no obstacle.
        folder.make("a.wasm").unwrap();
        assert!(!folder.at("out/web.part").exists() && !folder.at("out/web.old").exists());
    }

    #[test]
    fn a_folder_of_somebody_else_is_not_replaced() {
        let folder = Folder::new();
        fs::create_dir_all(folder.at("out/web")).unwrap();
        folder.make("a.wasm").unwrap();
        fs::remove_file(folder.at("out/web/quadfront.wasm")).unwrap();
        let fault = folder.make("a.wasm").unwrap_err();
        assert!(fault.contains("in the way"), "{fault}");
        assert!(folder.at("out/web/page.js").exists());
    }
}
