//! What is read: a built-in case, a case file, a mesh file, standard input.

use std::io::Read;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::command_line::{MeshOptions, Source};
#[cfg(feature = "window")]
use crate::core::case::Taking;
use crate::core::case::built_in;
use crate::core::case::{self, Case};
use crate::core::convert::walk::Stop;
use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::format::{self, Format};
use crate::core::formats::save::load;
use crate::core::kernel::spelling::nearest;
use crate::core::progress::Watch;
use crate::core::record::figure;
use crate::core::record::run_file;
use crate::core::run::run::Run;
use crate::core::run::shown::Shown;
use crate::core::soup::mesh_file::MeshFile;

/// With --curvature the finest elements have the size of --mesh-size over this.
const FINEST: f64 = 100.0;

/// How messages call standard input.
const STANDARD_INPUT: &str = "standard input";

/// What an input is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputFormat {
    /// A case in TOML.
    Case,
    /// A mesh.
    Mesh(Format),
}

/// Reads `--from` where cases are possible.
pub(super) fn input_format(text: &str) -> Result<InputFormat, String> {
    if text == "toml" { Ok(InputFormat::Case) } else { mesh_format(text).map(InputFormat::Mesh) }
}

/// Reads the name of a mesh format.
pub(super) fn mesh_format(text: &str) -> Result<Format, String> {
    let known = || Format::ALL.map(Format::extension).join(", ");
    let found = Format::ALL.into_iter().find(|format| format.extension() == text);
    found.ok_or_else(|| format!("the formats of meshes are {}", known()))
}

/// Reads KEY=VALUE.
pub(super) fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) => Ok((key.trim().to_owned(), value.trim().to_owned())),
        None => Err("write KEY=VALUE, for example size_scale=0.5".to_owned()),
    }
}

/// Places to stop at, one after the other; the end is `None`.
#[derive(Clone, Debug)]
pub(super) struct Stops(pub Vec<Option<Stop>>);

/// How far a conversion goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Until {
    /// To a stop.
    Stop(Stop),
    /// To its end.
    End,
}

/// Reads nq=N, step=N or end.
pub(super) fn until(text: &str) -> Result<Until, String> {
    match text {
        "end" => Ok(Until::End),
        _ => text.parse().map(Until::Stop).map_err(|()| "write nq=100 (quadrilaterals), step=812 or end".to_owned()),
    }
}

/// Reads nq=N,N,... or step=N,N,..., ascending; the last may be `end`.
pub(super) fn stops(text: &str) -> Result<Stops, String> {
    let usage = || "write nq=100 (quadrilaterals), step=812 or end".to_owned();
    if text == "end" {
        return Ok(Stops(vec![None]));
    }
    let (kind, numbers) = text.split_once('=').ok_or_else(usage)?;
    let kind = match kind {
        "nq" => Stop::Quads,
        "step" => Stop::Step,
        _ => return Err(usage()),
    };
    let (numbers, to_the_end) = match numbers.strip_suffix(",end") {
        Some(numbers) => (numbers, true),
        None => (numbers, false),
    };
    let numbers: Vec<u64> = numbers.split(',').map(|n| n.parse().map_err(|_| usage())).collect::<Result<_, _>>()?;
    if !numbers.is_sorted() {
        return Err("write the numbers in ascending order".to_owned());
    }
    Ok(Stops(numbers.into_iter().map(|n| Some(kind(n))).chain(to_the_end.then_some(None)).collect()))
}

/// A run to work on; a mesh that came by standard input lies in a folder that goes with it.
pub(super) struct Input {
    /// The run. Its case has the parameters that are in force from step 0 on.
    pub run: Run,
    /// What is shown of it, where it came with a figure.
    pub figure: Option<Shown>,
    folder: Option<TempDir>,
}

impl Input {
    fn of(mut run: Run, folder: Option<TempDir>) -> Input {
        Input { figure: run.shown.take(), run, folder }
    }

    /// Whether a figure can carry the run: not where its mesh goes with this process.
    pub fn can_be_carried(&self) -> bool {
        self.folder.is_none()
    }
}

/// The run of the arguments, with what they set.
pub(super) fn read(source: &Source, mesh: &MeshOptions) -> Result<Input, Fault> {
    let Input { mut run, figure, folder } = read_plain(source, mesh)?;
    let parameters = &mut run.parameters;
    if source.paper {
        *parameters = parameters.read_as_paper();
    }
    if !source.faces.is_empty() {
        parameters.faces.clone_from(&source.faces);
    }
    for (key, value) in &source.set {
        parameters.set(key, value).map_err(|fault| fault.at("--set"))?;
    }
    run.case.parameters = parameters.clone();
    Ok(Input { run, figure, folder })
}

/// The run of a file: a case or a mesh from its beginning, a run file, or what a figure carries.
#[cfg(feature = "window")]
pub(super) fn run_of(path: &Path, mesh: &MeshOptions) -> Result<Run, Fault> {
    let input = path.display().to_string();
    if input == "-" {
        return Err(Fault::new("The window opens files").at(input).remedy("Name a case, a mesh or a run file"));
    }
    let source = Source { input, quiet: true, ..Source::default() };
    let mut input = read(&source, mesh)?;
    input.run.shown = input.figure;
    Ok(input.run)
}

fn read_plain(source: &Source, mesh: &MeshOptions) -> Result<Input, Fault> {
    let name = source.input.as_str();
    let alone = |case| Input::of(Run::of(case), None);
    let run = match kind(name, source.from)? {
        Kind::BuiltIn => Run::of(built_in::named(name).expect("it was found by its name")?),
        Kind::StandardInput(InputFormat::Case) => {
            case_or_run(&standard_input()?, "case", STANDARD_INPUT, Path::new(""))?
        }
        Kind::StandardInput(InputFormat::Mesh(format)) => {
            // Meshes are read by path in `core`; the file's name is what its messages will say.
            let refuse = |error: std::io::Error| Fault::new(format!("It cannot be kept: {error}")).at(STANDARD_INPUT);
            let folder = tempfile::tempdir().map_err(refuse)?;
            let path = folder.path().join("standard-input").with_extension(format.extension());
            std::fs::write(&path, standard_input()?).map_err(refuse)?;
            let run = Run::of(mesh_case(path, source, mesh)?);
            return Ok(Input::of(run, Some(folder)));
        }
        Kind::File(path, InputFormat::Mesh(_)) => return Ok(alone(mesh_case(path, source, mesh)?)),
        Kind::Figure(path) => figure::read(&path)?,
        Kind::File(path, InputFormat::Case) => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            case_or_run(&load(&path)?, &stem, name, path.parent().unwrap_or(Path::new("")))?
        }
    };
    if source.sol.is_some() {
        return Err(Fault::new("--sol goes with a mesh, and this is a case")
            .at(name)
            .remedy("Write mesh = \"...\" and sol = \"...\" in the case, or leave --sol out"));
    }
    if let Some((option, key)) = mesh_words(mesh).first().map(|word| (word.option, word.key)) {
        return Err(Fault::new(format!("{option} goes with a mesh, and this is a case"))
            .at(name)
            .remedy(format!("Write {key} in the case, or leave {option} out")));
    }
    Ok(Input::of(run, None))
}

/// How the options say that a mesh is taken.
///
/// # Errors
/// Options that no case could have.
#[cfg(feature = "window")]
pub(super) fn taking_of(path: &Path, options: &MeshOptions) -> Result<Taking, Fault> {
    match mesh_case(path.to_path_buf(), &Source::default(), options)?.domain {
        case::DomainSource::Mesh { taking, .. } => Ok(taking),
        _ => Ok(Taking::default()),
    }
}

/// An option for meshes, as the line of a case that says the same.
struct MeshWord {
    option: &'static str,
    key: &'static str,
    line: String,
}

/// What the options say of how a mesh is used.
fn mesh_words(options: &MeshOptions) -> Vec<MeshWord> {
    let mut words = Vec::new();
    let mut word = |option, key, value: Option<String>| {
        words.extend(value.map(|value| MeshWord { option, key, line: format!("{key} = {value}") }));
    };
    // In every case TOML needs a point in what may not be whole.
    let number = |value: Option<f64>| value.map(|value| format!("{value:?}"));
    word("--use", "use", options.used.as_ref().map(|word| format!("\"{word}\"")));
    word("--split-odd", "split_odd", options.split_odd.then(|| "true".to_owned()));
    word("--feature-angle", "feature_angle", number(options.feature_angle));
    word("--chart-stretch", "chart_stretch", number(options.chart_stretch));
    word("--scale", "scale", number(options.scale));
    if let Some(h) = options.mesh_size {
        let line = match options.curvature {
            None => format!("[[metric]]\nkind = \"uniform\"\nh = {h:?}"),
            Some(chord) => {
                let least = h / FINEST;
                format!("[[metric]]\nkind = \"curvature\"\nchord = {chord:?}\nleast = {least:?}\nfar = {h:?}")
            }
        };
        words.push(MeshWord { option: "--mesh-size", key: "[[metric]]", line });
    }
    words
}

/// The case of a mesh. Where options say how it is used it gets a text that says the same, so that reports, run files and figures
/// tell it.
fn mesh_case(path: PathBuf, source: &Source, options: &MeshOptions) -> Result<Case, Fault> {
    let words = mesh_words(options);
    let plain = Case::of_mesh(path.clone(), source.sol.clone());
    if words.is_empty() {
        return Ok(plain);
    }
    let quoted = |path: &Path| toml::Value::String(path.display().to_string()).to_string();
    let sol = source.sol.as_ref().map_or_else(String::new, |sol| format!("sol = {}\n", quoted(sol)));
    let lines: Vec<String> = words.into_iter().map(|word| word.line).collect();
    let text = format!(
        "version = {}\ntitle = {}\nmesh = {}\n{sol}{}\n",
        case::VERSION,
        toml::Value::String(plain.title.clone()),
        quoted(&path),
        lines.join("\n")
    );
    let mut case = Case::parse(&text, &plain.name, "the options", Path::new(""))?;
    // A path that is no text stays what it is.
    if let case::DomainSource::Mesh { source: own, .. } = &mut case.domain {
        *own = case::MeshSource::File { path, sol: source.sol.clone() };
    }
    Ok(case)
}

/// The run of a TOML file: a case from its beginning, or a run file.
fn case_or_run(bytes: &[u8], name: &str, file: &str, folder: &Path) -> Result<Run, Fault> {
    match std::str::from_utf8(bytes) {
        Ok(text) if run_file::is_run(text) => run_file::parse(text, file, folder),
        _ => Case::from_bytes(bytes, name, file, folder).map(Run::of),
    }
}

/// The mesh of a file or of standard input as it is; `None` where the input is a case.
pub(super) fn read_mesh(
    name: &str,
    from: Option<InputFormat>,
    watch: &mut dyn Watch,
) -> Result<Option<MeshFile>, Fault> {
    match kind(name, from)? {
        Kind::StandardInput(InputFormat::Mesh(format)) => {
            format::read_bytes(STANDARD_INPUT, &standard_input()?, format).map(Some)
        }
        Kind::File(path, InputFormat::Mesh(_)) => format::read_mesh_watched(&path, None, watch).map(Some),
        _ => Ok(None),
    }
}

enum Kind {
    BuiltIn,
    StandardInput(InputFormat),
    File(PathBuf, InputFormat),
    Figure(PathBuf),
}

fn kind(name: &str, from: Option<InputFormat>) -> Result<Kind, Fault> {
    if name == "-" {
        return Ok(Kind::StandardInput(from.unwrap_or(InputFormat::Case)));
    }
    if from.is_none() && built_in::all().any(|case| case.0 == name) {
        return Ok(Kind::BuiltIn);
    }
    let path = PathBuf::from(name);
    if path.is_dir() {
        return Err(Fault::new("This is a folder").at(name).remedy("Name a file in it"));
    }
    if let Some(format) = from {
        if let InputFormat::Mesh(format) = format
            && Format::from_path(&path).ok() != Some(format)
        {
            return Err(Fault::new(format!("The name does not end in .{}", format.extension()))
                .at(name)
                .remedy("--from is for standard input; files are read by their extension"));
        }
        return Ok(Kind::File(path, format));
    }
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return Ok(Kind::File(path, InputFormat::Case));
    }
    if figure::is_figure(&path) {
        return Ok(Kind::Figure(path));
    }
    match Format::from_path(&path) {
        Ok(format) => Ok(Kind::File(path, InputFormat::Mesh(format))),
        Err(_) if !path.exists() => {
            let fault = Fault::new("There is neither a built-in case nor a file of this name").at(name);
            Err(match nearest(name, built_in::all().map(|case| case.0)) {
                Some(near) => {
                    fault.remedy(format!("The nearest built-in case is \"{near}\"; quadfront cases lists all"))
                }
                None => fault.remedy("quadfront cases lists the built-in ones"),
            })
        }
        Err(mut fault) => {
            fault.remedy += ", .toml for cases, and .svg and .png for figures that carry their run";
            Err(fault)
        }
    }
}

fn standard_input() -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    std::io::stdin()
        .lock()
        .read_to_end(&mut bytes)
        .map_err(|error| Fault::new(format!("It cannot be read: {error}")).of_kind(FaultKind::Io).at(STANDARD_INPUT))?;
    Ok(bytes)
}
