//! Run files: a run as a small TOML file from which everything else can be reproduced. Read as strictly as case files.
//!
//! ```toml
//! run = 1                        # version of run files
//! program = "quadfront 0.1.0"    # the program that wrote it, for information
//!
//! [case]
//! name = "plate"
//! text = '''...'''               # the case file itself; absent for a mesh without one
//! weld = "auto"                  # which points of its mesh are merged; where neither this nor the text says, none
//! mesh = { path = "plate.msh", fingerprint = "6c62..." }   # its mesh; likewise sol
//!
//! [parameters]                   # those that differ from the case's
//! c = 1.8
//!
//! [[edit]]
//! step = 812
//! theta_rect = 120               # or base = [17, 18]: the next base segment, by its nodes A and B
//!
//! [[bookmark]]
//! step = 900
//! note = "the **sliver**"         # Markdown
//!
//! [camera]
//! target = [0.5, 0.5, 0]
//! turn = [0, 0, 0, 1]
//! height = 1.2
//!
//! [figure]                       # in the metadata of figures: the states shown, and the drawing options
//! drawn = ["--ink=grey"]
//! state = [{ step = 812, at = "nq=100", fingerprint = "9c1f..." }]
//! ```

mod alone;
mod figure;
mod inputs;
mod welding;

use std::fmt::Write;
use std::path::{Path, PathBuf};

pub use alone::{alone, parse_alone};
pub use figure::MOST_STATES;
pub use inputs::inputs;
use inputs::{InputFile, InputFiles};
use toml::de::DeTable;

use crate::core::case::table::{Source, Table, Value};
use crate::core::case::{Case, DomainSource, MeshSource, ParameterKind, Parameters, set_parameters};
use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::save::{load, save};
use crate::core::kernel::{Fingerprint, Shortest};
use crate::core::mesh::NodeId;
use crate::core::run::{Bookmark, Camera, Edit, EditKind, Run};

/// The supported version of run files.
pub const VERSION: u32 = 1;

/// Whether a text is a run file: it has the key `run`.
pub fn is_run(text: &str) -> bool {
    DeTable::parse(text).is_ok_and(|document| document.get_ref().contains_key("run"))
}

/// Reads a run file.
///
/// # Errors
/// Those of reading the file, and of [`parse`].
pub fn read(path: &Path) -> Result<Run, Fault> {
    let place = path.display().to_string();
    let bytes = load(path)?;
    let text = String::from_utf8(bytes)
        .map_err(|_| Fault::new("The file is not text").of_kind(FaultKind::Syntax).at(place.clone()))?;
    parse(&text, &place, path.parent().unwrap_or(Path::new("")))
}

/// Parses the text of a run file; `file` is its name in messages, and mesh paths are relative to `folder`.
///
/// # Errors
/// With file and line: text that is not TOML, an unsupported version, unknown or missing keys, values of the wrong type
/// or out of range; and a mesh that is missing or has changed.
pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Run, Fault> {
    parsed(text, file, folder).map_err(|fault| fault.of_kind(FaultKind::Syntax))
}

fn parsed(text: &str, file: &str, folder: &Path) -> Result<Run, Fault> {
    let source = Source::new(file, text);
    let document = source.parse()?;
    let table = Table::document(&source, &document);
    let version = table.need("run", "1")?;
    match version.count(1, u32::MAX)? {
        VERSION => {}
        newer => {
            return Err(version
                .fault(format!("run = {newer} is newer than this program supports"))
                .remedy("Use a newer quadfront"));
        }
    }
    table.only(&["run", "program", "case", "parameters", "edit", "bookmark", "camera", "figure"])?;
    table.get("program").map(|value| value.text()).transpose()?;
    let case = case(&table.need("case", "{ name = \"...\" }")?.table()?, file, folder)?;
    let mut run = Run::of(case);
    if let Some(value) = table.get("parameters") {
        set_parameters(&mut run.parameters, &value.table()?)?;
    }
    let mut edits = Vec::new();
    for table in table.tables("edit")? {
        edits.extend(edits_of(&table)?);
    }
    run.set_edits(edits);
    for table in table.tables("bookmark")? {
        table.only(&["step", "note"])?;
        let note = table.get("note").map(|value| value.text()).transpose()?.unwrap_or_default().to_owned();
        run.bookmarks.push(Bookmark { step: step(&table)?, note });
    }
    run.bookmarks.sort_by_key(|bookmark| bookmark.step);
    run.camera = table.get("camera").map(|value| camera(&value.table()?)).transpose()?;
    run.shown = table.get("figure").map(|value| figure::shown(&value.table()?)).transpose()?;
    Ok(run)
}

fn case(table: &Table<'_>, file: &str, folder: &Path) -> Result<Case, Fault> {
    table.only(&["name", "text", "split_odd", "weld", "mesh", "sol"])?;
    let name = table.need("name", "\"plate\"")?.text()?;
    let mesh = table.get("mesh").map(|value| input_file(&value, folder)).transpose()?;
    let sol = table.get("sol").map(|value| input_file(&value, folder)).transpose()?;
    let mut case = match (table.get("text"), &mesh) {
        (Some(text), _) => Case::parse(text.text()?, name, &format!("{file}, its case"), folder)?,
        (None, Some(mesh)) => Case { name: name.to_owned(), ..Case::of_mesh(mesh.clone(), None) },
        (None, None) => return Err(table.fault("The case has neither text nor mesh").remedy("Add one of them")),
    };
    match (&mut case.domain, mesh) {
        (DomainSource::Mesh { source, .. }, Some(path)) => *source = MeshSource::File { path, sol },
        (DomainSource::Mesh { .. }, None) => {
            return Err(table.fault("The mesh of the case is missing").remedy("Add mesh = { path = \"...\", ... }"));
        }
        (_, Some(_)) => return Err(table.fault("The case has no mesh").remedy("Remove mesh and sol")),
        (_, None) => {}
    }
    if let Some(value) = table.get("split_odd") {
        case.split_odd = value.flag()?;
    }
    welding::set(&mut case, table)?;
    Ok(case)
}

/// The path of a file, which must be unchanged.
fn input_file(value: &Value<'_>, folder: &Path) -> Result<PathBuf, Fault> {
    let table = value.table()?;
    table.only(&["path", "fingerprint"])?;
    let path = folder.join(table.need("path", "\"plate.msh\"")?.text()?);
    let fingerprint = table.need("fingerprint", "\"...\"")?;
    let recorded: Fingerprint = fingerprint
        .text()?
        .parse()
        .map_err(|()| fingerprint.fault("The fingerprint is not 32 hexadecimal digits").remedy("Save the run again"))?;
    let found = Fingerprint::of(&load(&path).map_err(|fault| fault.at(value.place()))?);
    if found != recorded {
        return Err(Fault::new("The file has changed since the run was saved")
            .at(path.display().to_string())
            .at(value.place())
            .remedy("Restore the old file, or start a new run from this one"));
    }
    Ok(path)
}

fn step(table: &Table<'_>) -> Result<u64, Fault> {
    table.need("step", "812")?.count(0, u32::MAX).map(u64::from)
}

/// The edits of one table: the base and all parameters.
fn edits_of(table: &Table<'_>) -> Result<Vec<Edit>, Fault> {
    let mut known = vec!["step", "base"];
    known.extend(Parameters::KEYS);
    table.only(&known)?;
    let step = step(table)?;
    let mut edits = Vec::new();
    for entry in table.entries() {
        let kind = match entry.key() {
            "step" => continue,
            "base" => {
                let nodes = entry.list()?;
                let [a, b] = nodes.as_slice() else { return Err(entry.wrong("a pair of nodes", "base = [17, 18]")) };
                EditKind::Base { a: NodeId(a.count(0, u32::MAX - 1)?), b: NodeId(b.count(0, u32::MAX - 1)?) }
            }
            key => EditKind::parameter(key, &entry.parameter_text()).map_err(|fault| fault.at(entry.place()))?,
        };
        edits.push(Edit { step, kind });
    }
    if edits.is_empty() {
        return Err(table.fault("The edit changes nothing").remedy("Add a parameter, or base = [A, B]"));
    }
    Ok(edits)
}

fn camera(table: &Table<'_>) -> Result<Camera, Fault> {
    table.only(&["target", "turn", "height"])?;
    let target = table.need("target", "[0, 0, 0]")?;
    let turn = table.need("turn", "[0, 0, 0, 1]")?;
    let height = table.need("height", "1")?;
    let camera = Camera {
        target: target
            .numbers()?
            .try_into()
            .map_err(|_| target.wrong("a list of three numbers", "target = [0, 0, 0]"))?,
        turn: turn.numbers()?.try_into().map_err(|_| turn.wrong("a list of four numbers", "turn = [0, 0, 0, 1]"))?,
        height: height.number()?,
    };
    if camera.height <= 0.0 {
        return Err(height.wrong("positive", "height = 1"));
    }
    Ok(camera)
}

/// Keeps a run file up to date: reads the input files once, and writes only changes.
#[derive(Debug)]
pub struct Keeper {
    path: PathBuf,
    files: InputFiles,
    written: String,
}

impl Keeper {
    /// A keeper of a run in the file `path`; writes nothing yet.
    ///
    /// # Errors
    /// A mesh of the run that cannot be read.
    pub fn new(path: PathBuf, run: &Run) -> Result<Keeper, Fault> {
        Ok(Keeper { path, files: InputFiles::of(run)?, written: String::new() })
    }

    /// The autosave file of the run file `path`.
    pub fn place_beside(path: &Path) -> PathBuf {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        path.with_file_name(format!(".{name}.autosave.toml"))
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the run if it has changed since the last call, atomically; returns whether it did.
    ///
    /// # Errors
    /// As [`save`]: the old file is unchanged, and the next call tries again.
    pub fn keep(&mut self, run: &Run) -> Result<bool, Fault> {
        let text = text(run, &self.files, self.path.parent().unwrap_or(Path::new("")));
        if text == self.written {
            return Ok(false);
        }
        save(&self.path, |out| out.write_all(text.as_bytes()))?;
        self.written = text;
        Ok(true)
    }
}

/// Saves a run.
///
/// # Errors
/// As [`save`], and a mesh of the run that cannot be read.
pub fn write(path: &Path, run: &Run) -> Result<(), Fault> {
    Keeper::new(path.to_path_buf(), run)?.keep(run).map(drop)
}

/// The text of a run for the metadata of figures, with absolute paths of meshes.
///
/// # Errors
/// A mesh of the run that cannot be read.
pub fn embedded(run: &Run) -> Result<String, Fault> {
    Ok(text(run, &InputFiles::of(run)?, Path::new("")))
}

/// As [`embedded`], also in its errors, for a file in a folder: with paths of meshes relative to it.
pub fn written_in(run: &Run, folder: &Path) -> Result<String, Fault> {
    Ok(text(run, &InputFiles::of(run)?, folder))
}

fn text(run: &Run, files: &InputFiles, folder: &Path) -> String {
    let mut text = format!(
        "run = {VERSION}\nprogram = \"{} {}\"\n\n[case]\nname = {}\n",
        env!("CARGO_PKG_NAME"),
        env!("CARGO_PKG_VERSION"),
        quoted(&run.case.name)
    );
    let mut line = |what: std::fmt::Arguments<'_>| text.write_fmt(what).expect("a text takes what it is given");
    if !run.case.text.is_empty() {
        line(format_args!("text = {}\n", block(&run.case.text)));
    }
    let own = Case::parse(&run.case.text, "", "", Path::new("")).ok();
    if run.case.split_odd != own.as_ref().is_some_and(|case| case.split_odd) {
        line(format_args!("split_odd = {}\n", run.case.split_odd));
    }
    line(format_args!("{}", welding::line(&run.case)));
    let folder = std::path::absolute(folder).ok();
    for (key, input) in [("mesh", &files.mesh), ("sol", &files.sol)] {
        let Some(InputFile { path, fingerprint }) = input else { continue };
        // A relative path, where possible, lets both files be moved together.
        let near = folder.as_ref().and_then(|folder| path.strip_prefix(folder).ok());
        let path = near.unwrap_or(path).to_string_lossy();
        line(format_args!("{key} = {{ path = {}, fingerprint = \"{fingerprint}\" }}\n", quoted(&path)));
    }
    let usual = own.map_or_else(Parameters::default, |case| case.parameters);
    let differ = |key: &&&str| run.parameters.text_of(key) != usual.text_of(key);
    for (i, key) in Parameters::KEYS.iter().filter(differ).enumerate() {
        if i == 0 {
            line(format_args!("\n[parameters]\n"));
        }
        let value = match *key {
            "layered_loops" => list(&run.parameters.layered_loops),
            "faces" => list(&run.parameters.faces),
            key => parameter(key, &run.parameters.text_of(key).unwrap_or_default()),
        };
        line(format_args!("{key} = {value}\n"));
    }
    for Edit { step, kind } in run.edits() {
        line(format_args!("\n[[edit]]\nstep = {step}\n"));
        match kind {
            EditKind::Parameter { key, value } => line(format_args!("{key} = {}\n", parameter(key, value))),
            EditKind::Base { a, b } => line(format_args!("base = [{}, {}]\n", a.0, b.0)),
        }
    }
    for Bookmark { step, note } in &run.bookmarks {
        line(format_args!("\n[[bookmark]]\nstep = {step}\n"));
        if !note.is_empty() {
            line(format_args!("note = {}\n", quoted(note)));
        }
    }
    if let Some(Camera { target, turn, height }) = run.camera {
        let list = |numbers: &[f64]| numbers.iter().map(|&x| Shortest(x).to_string()).collect::<Vec<_>>().join(", ");
        let (target, turn) = (list(&target), list(&turn));
        line(format_args!("\n[camera]\ntarget = [{target}]\nturn = [{turn}]\nheight = {}\n", Shortest(height)));
    }
    if let Some(shown) = &run.shown {
        line(format_args!("\n{}", figure::text(shown)));
    }
    text
}

/// The value of a parameter in a file; words are quoted.
fn parameter(key: &str, value: &str) -> String {
    if let Some(ParameterKind::Word(_)) = Parameters::kind_of(key) { quoted(value) } else { value.to_owned() }
}

/// A list of names.
fn list(names: &[String]) -> String {
    format!("[{}]", names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", "))
}

/// Whether a character needs no escape in TOML and in XML (figures embed their run).
fn is_plain(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{FFFE}' | '\u{FFFF}')
}

/// A quoted string on one line.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            c if !is_plain(c) => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A multi-line literal string, or if that is impossible, a quoted one.
fn block(text: &str) -> String {
    let plain = |c: char| c == '\n' || c == '\t' || is_plain(c);
    if text.contains("'''") || text.ends_with('\'') || !text.chars().all(plain) {
        return quoted(text);
    }
    format!("'''\n{text}'''")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;

    fn run() -> Run {
        let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
        run.parameters.set("c", "1.8").unwrap();
        run.parameters.set("selection", "level").unwrap();
        let parameter = |step, key, value| Edit { step, kind: EditKind::parameter(key, value).unwrap() };
        run.set_edits(vec![
            parameter(812, "theta_rect", "120"),
            Edit { step: 900, kind: EditKind::Base { a: NodeId(17), b: NodeId(18) } },
            parameter(812, "selection", "table1"),
        ]);
        run.bookmarks.push(Bookmark { step: 900, note: "the \"sliver\"\n\\".to_owned() });
        run.camera = Some(Camera { target: [0.5, 1e-9, 0.0], turn: [0.0, 0.0, 0.0, 1.0], height: 1.25 });
        run
    }

    /// Whether two runs are equal, except for the places in their cases.
    fn same(a: &Run, b: &Run) -> bool {
        let plain = |run: &Run| (run.parameters.clone(), run.edits().to_vec(), run.bookmarks.clone(), run.camera);
        plain(a) == plain(b) && (&a.case.text, &a.case.name) == (&b.case.text, &b.case.name)
    }

    #[test]
    fn a_run_survives_a_round_trip() {
        for name in built_in::CASES {
            let run = Run::of(built_in::named(name.0).unwrap().unwrap());
            assert!(same(&parse(&embedded(&run).unwrap(), "a.toml", Path::new("")).unwrap(), &run));
        }
        let run = run();
        let text = embedded(&run).unwrap();
        assert!(is_run(&text) && !is_run(&run.case.text));
        assert!(same(&parse(&text, "a.toml", Path::new("")).unwrap(), &run), "{text}");
        let mut odd = run;
        odd.case.text.push_str("# it's '''odd''' \u{1}");
        odd.case.split_odd = true;
        let text = embedded(&odd).unwrap();
        let read = parse(&text.replace("\\u0001", ""), "a.toml", Path::new("")).unwrap();
        assert!(read.case.split_odd && read.case.text.ends_with("'''odd''' "));
    }

    #[test]
    fn a_bad_run_file_is_reported_with_its_line() {
        let good = embedded(&run()).unwrap();
        let line = |what: &str| 1 + good[..good.find(what).unwrap()].matches('\n').count();
        for (from, to, what) in [
            ("run = 1", "run = 2", "newer"),
            ("theta_rect = 120", "theta_rekt = 120", "theta_rect"),
            ("theta_rect = 120", "theta_rect = 300", "out of range"),
            ("theta_rect = 120", "size_scale = 0.5", "background"),
            ("base = [17, 18]", "base = [17]", "a pair of nodes"),
            ("base = [17, 18]", "", "changes nothing"),
            ("turn = [0, 0, 0, 1]", "turn = [0, 0, 1]", "four numbers"),
            ("height = 1.25", "height = 0", "positive"),
            ("[camera]", "[kamera]", "camera"),
            ("step = 900\nnote", "step = -900\nnote", "whole number"),
        ] {
            let fault = parse(&good.replace(from, to), "a.toml", Path::new("")).unwrap_err();
            assert!(fault.to_string().contains(what), "{to}: {fault}");
            assert!(fault.place.starts_with("a.toml, line "), "{to}: {fault}");
            if !to.is_empty() && !to.starts_with("step") {
                assert!(fault.place.starts_with(&format!("a.toml, line {}", line(from))), "{to}: {fault}");
            }
        }
        assert!(parse("run = 1", "a.toml", Path::new("")).unwrap_err().what.contains("\"case\" is missing"));
        let fault = parse("run = 1\ncase = { name = \"a\" }", "a.toml", Path::new("")).unwrap_err();
        assert!(fault.what.contains("neither text nor mesh"), "{fault}");
    }

    #[test]
    fn a_mesh_is_recorded_by_path_and_fingerprint_and_must_be_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = folder.path().join("two.obj");
        std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n").unwrap();
        let path = folder.path().join("two.toml");
        let run = Run::of(Case::of_mesh(mesh.clone(), None));
        let mut keeper = Keeper::new(path.clone(), &run).unwrap();
        assert!(keeper.keep(&run).unwrap());
        assert!(!keeper.keep(&run).unwrap(), "nothing has changed");
        assert!(std::fs::read_to_string(&path).unwrap().contains("path = \"two.obj\""));
        let back = read(&path).unwrap();
        assert_eq!((back.case.domain, back.case.name), (run.case.domain, run.case.name));
        std::fs::write(&mesh, "v 0 0 0\nv 2 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n").unwrap();
        assert!(read(&path).unwrap_err().what.contains("has changed"));
        std::fs::remove_file(&mesh).unwrap();
        assert!(read(&path).unwrap_err().what.contains("No such file"));
    }
}
