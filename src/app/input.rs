//! Inputs: built-in cases, case files, run files, meshes, figures, standard input.

use std::io::Read;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

#[cfg(feature = "window")]
use super::command_line::Overrides;
use super::command_line::Source;
use crate::core::case::{Case, ImportOptions, MeshUse, built_in};
#[cfg(feature = "window")]
use crate::core::case::{DomainSource, Taking};
use crate::core::convert::Stop;
use crate::core::fault::{Fault, FaultKind};
#[cfg(feature = "window")]
use crate::core::formats::save::load_watched;
use crate::core::formats::save::{self, load};
use crate::core::formats::{Format, format};
use crate::core::kernel::spelling::nearest;
use crate::core::progress::{Nobody, Reading, Watch};
use crate::core::question::Series;
use crate::core::record::{figure, run_file};
use crate::core::run::{Run, Shown};
use crate::core::soup::{MeshFile, Weld};
#[cfg(feature = "window")]
use crate::core::step::Part;
use crate::core::step::{self, Unit};

/// The name of standard input in messages.
const STANDARD_INPUT: &str = "standard input";

/// The format of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InputFormat {
    /// A case in TOML.
    Case,
    /// A mesh.
    Mesh(Format),
    /// A CAD file.
    Step,
}

impl InputFormat {
    /// Its name, as [`input_format`] takes it.
    pub fn word(self) -> &'static str {
        match self {
            InputFormat::Case => "toml",
            InputFormat::Step => "step",
            InputFormat::Mesh(format) => format.extension(),
        }
    }
}

/// Parses `--from` where cases are possible.
pub(super) fn input_format(text: &str) -> Result<InputFormat, String> {
    match text {
        "toml" => Ok(InputFormat::Case),
        "step" => Ok(InputFormat::Step),
        _ => mesh_format(text).map(InputFormat::Mesh),
    }
}

/// Parses the name of a mesh format.
pub(super) fn mesh_format(text: &str) -> Result<Format, String> {
    let known = || Format::ALL.map(Format::extension).join(", ");
    let found = Format::ALL.into_iter().find(|format| format.extension() == text);
    found.ok_or_else(|| format!("the mesh formats are {}", known()))
}

/// Parses `--unit`.
pub(super) fn unit(text: &str) -> Result<Unit, String> {
    Unit::of_word(text).ok_or_else(|| format!("write one of {}", Unit::ALL.map(Unit::word).join(", ")))
}

/// Parses a length.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let found: Option<f64> = text.parse().ok().filter(|length: &f64| length.is_finite() && *length > 0.0);
    found.ok_or_else(|| "write a positive number".to_owned())
}

/// Parses `--weld`.
pub(super) fn weld(text: &str) -> Result<Weld, String> {
    let distance = || text.parse().ok().filter(|far: &f64| far.is_finite() && *far >= 0.0).map(Weld::Within);
    let found = if text == Weld::AUTO { Some(Weld::Auto) } else { distance() };
    found.ok_or_else(|| "write a distance, 0 or auto".to_owned())
}

/// Parses `--predict`.
pub(super) fn series(text: &str) -> Result<Series, String> {
    text.parse().map_err(|fault: Fault| fault.to_string())
}

/// Parses `--use`.
pub(super) fn mesh_use(text: &str) -> Result<MeshUse, String> {
    MeshUse::named(text).ok_or_else(|| "write triangles or shape".to_owned())
}

/// Parses KEY=VALUE.
pub(super) fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) => Ok((key.trim().to_owned(), value.trim().to_owned())),
        None => Err("write KEY=VALUE, for example size_scale=0.5".to_owned()),
    }
}

/// Stops in ascending order; `None` is the end.
#[derive(Clone, Debug)]
pub(super) struct Stops(pub Vec<Option<Stop>>);

/// Where a conversion ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Until {
    /// At a stop.
    Stop(Stop),
    /// At its end.
    End,
}

/// Parses nq=N, step=N or end.
pub(super) fn until(text: &str) -> Result<Until, String> {
    match text {
        "end" => Ok(Until::End),
        _ => text.parse().map(Until::Stop).map_err(|()| "write nq=100 (quadrilaterals), step=812 or end".to_owned()),
    }
}

/// Parses nq=N,N,... or step=N,N,... in ascending order; the last may be `end`.
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

/// A run to work on. A mesh from standard input is stored in a temporary folder that lives as long as the input.
pub(super) struct Input {
    /// The run. Its case has the parameters in force from step 0 on.
    pub run: Run,
    /// What the figure shows, where the run comes from a figure.
    pub figure: Option<Shown>,
    folder: Option<TempDir>,
}

impl Input {
    fn of(mut run: Run, folder: Option<TempDir>) -> Input {
        Input { figure: run.shown.take(), run, folder }
    }

    /// Whether a figure can embed the run: not where its mesh is in a temporary folder.
    pub fn can_be_embedded(&self) -> bool {
        self.folder.is_none()
    }
}

/// The run that the arguments name, with the parameters they set.
pub(super) fn read(source: &Source, mesh: &ImportOptions) -> Result<Input, Fault> {
    let Input { mut run, figure, folder } = read_plain(source, mesh)?;
    source.overrides.apply(&mut run, "--set")?;
    Ok(Input { run, figure, folder })
}

/// Refuses what the window should not be opened for: a missing file, options that do not fit. What is wrong within a
/// file is for the window to show.
#[cfg(feature = "window")]
pub(super) fn check(input: &str, mesh: &ImportOptions, overrides: &Overrides) -> Result<(), Fault> {
    let is_part = step::is_step(Path::new(input)) && save::is_file(Path::new(input));
    if is_part && mesh.check_for_step().is_ok() {
        // The window reads it, with progress.
        return Ok(());
    }
    match run_of(Path::new(input), mesh, &Overrides::default()) {
        Err(_) if mesh.lines().is_empty() && save::is_file(Path::new(input)) => Ok(()),
        Err(fault) => Err(fault),
        Ok(mut run) => overrides.apply(&mut run, "--set"),
    }
}

/// The run of a file: a case, a mesh, a run file, or a figure with an embedded run.
#[cfg(feature = "window")]
pub(super) fn run_of(path: &Path, mesh: &ImportOptions, overrides: &Overrides) -> Result<Run, Fault> {
    let input = path.display().to_string();
    if input == "-" {
        return Err(Fault::new("The window cannot open standard input")
            .at(input)
            .remedy("Name a case, a mesh or a run file"));
    }
    let source = Source { input, overrides: overrides.clone(), quiet: true, ..Source::default() };
    let mut input = read(&source, mesh)?;
    input.run.shown = input.figure;
    Ok(input.run)
}

fn read_plain(source: &Source, mesh: &ImportOptions) -> Result<Input, Fault> {
    let name = source.input.as_str();
    let alone = |case| Input::of(Run::of(case), None);
    let run = match kind(name, source.from)? {
        Kind::BuiltIn => Run::of(built_in::named(name).expect("it was found by its name")?),
        Kind::StandardInput(InputFormat::Case) => {
            case_or_run(&standard_input()?, "case", STANDARD_INPUT, Path::new(""))?
        }
        Kind::StandardInput(InputFormat::Step) => {
            return Ok(alone(step_case(&standard_input()?, "standard-input", STANDARD_INPUT, mesh)?));
        }
        Kind::StandardInput(InputFormat::Mesh(format)) => {
            // `core` reads meshes from files; the name of the file appears in messages.
            let refuse = |error: std::io::Error| {
                Fault::new(format!("Cannot store the mesh in a temporary file: {error}")).at(STANDARD_INPUT)
            };
            let folder = tempfile::tempdir().map_err(refuse)?;
            let path = folder.path().join("standard-input").with_extension(format.extension());
            std::fs::write(&path, standard_input()?).map_err(refuse)?;
            let run = Run::of(mesh.case(path, source.sol.clone())?);
            return Ok(Input::of(run, Some(folder)));
        }
        Kind::File(path, InputFormat::Mesh(_)) => return Ok(alone(mesh.case(path, source.sol.clone())?)),
        Kind::File(path, InputFormat::Step) => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            return Ok(alone(step_case(&load(&path)?, &stem, name, mesh)?));
        }
        Kind::Figure(path) => figure::read(&path)?,
        Kind::File(path, InputFormat::Case) => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            case_or_run(&load(&path)?, &stem, name, path.parent().unwrap_or(Path::new("")))?
        }
    };
    if source.sol.is_some() {
        return Err(Fault::new("--sol applies to meshes, and this is a case")
            .at(name)
            .remedy("Write mesh = \"...\" and sol = \"...\" in the case, or leave --sol out"));
    }
    if let Some((key, _)) = mesh.lines().first() {
        let option = match *key {
            "[[metric]]" => "--mesh-size".to_owned(),
            key => format!("--{}", key.replace('_', "-")),
        };
        return Err(Fault::new(format!("{option} applies to meshes, and this is a case"))
            .at(name)
            .remedy(format!("Write {key} in the case, or leave {option} out")));
    }
    Ok(Input::of(run, None))
}

/// How a mesh is taken with these options.
///
/// # Errors
/// Options that no case can have.
#[cfg(feature = "window")]
pub(super) fn taking_of(path: &Path, options: &ImportOptions) -> Result<Taking, Fault> {
    match options.case(path.to_path_buf(), None)?.domain {
        DomainSource::Mesh { taking, .. } => Ok(taking),
        _ => Ok(Taking::default()),
    }
}

/// The run of a TOML file: a case or a run file.
fn case_or_run(bytes: &[u8], name: &str, file: &str, folder: &Path) -> Result<Run, Fault> {
    match std::str::from_utf8(bytes) {
        Ok(text) if run_file::is_run(text) => run_file::parse(text, file, folder),
        _ => Case::from_bytes(bytes, name, file, folder).map(Run::of),
    }
}

/// The mesh of a file or of standard input; `None` where the input is a case or a figure.
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
    if save::ON_DISK && path.is_dir() {
        return Err(Fault::new("This is a folder").at(name).remedy("Name a file in it"));
    }
    if let Some(format) = from {
        if let InputFormat::Mesh(format) = format
            && Format::from_path(&path).ok() != Some(format)
        {
            return Err(Fault::new(format!("The file name does not end in .{}", format.extension()))
                .at(name)
                .remedy("--from applies to standard input; the extension of a file determines its format"));
        }
        return Ok(Kind::File(path, format));
    }
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return Ok(Kind::File(path, InputFormat::Case));
    }
    if step::is_step(&path) {
        return Ok(Kind::File(path, InputFormat::Step));
    }
    if figure::is_figure(&path) {
        return Ok(Kind::Figure(path));
    }
    match Format::from_path(&path) {
        Ok(format) => Ok(Kind::File(path, InputFormat::Mesh(format))),
        Err(_) if !save::is_file(&path) => {
            let fault = Fault::new("Neither a built-in case nor a file has this name").at(name);
            Err(match nearest(name, built_in::all().map(|case| case.0)) {
                Some(near) => {
                    fault.remedy(format!("The nearest built-in case is \"{near}\"; quadfront cases lists all"))
                }
                None => fault.remedy("quadfront cases lists the built-in cases"),
            })
        }
        Err(mut fault) => {
            fault.remedy += ", .toml for cases, and .svg, .png and .pdf for figures with an embedded run";
            Err(fault)
        }
    }
}

/// The case and the part of a STEP file.
#[cfg(feature = "window")]
pub(super) fn read_step(path: &Path, options: &ImportOptions, watch: &mut dyn Watch) -> Result<(Case, Part), Fault> {
    let pace = Reading::watched(watch);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    options.case_of_step(&load_watched(path, &pace)?, &stem, &path.display().to_string(), &pace)
}

/// The case of a STEP file.
pub(super) fn step_case(bytes: &[u8], name: &str, place: &str, options: &ImportOptions) -> Result<Case, Fault> {
    options.case_of_step(bytes, name, place, &Reading::watched(&mut Nobody)).map(|read| read.0)
}

fn standard_input() -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    std::io::stdin()
        .lock()
        .read_to_end(&mut bytes)
        .map_err(|error| Fault::new(format!("Cannot read: {error}")).of_kind(FaultKind::Io).at(STANDARD_INPUT))?;
    Ok(bytes)
}

#[cfg(all(test, feature = "window"))]
mod tests {
    use super::*;

    #[test]
    fn the_window_opens_for_a_broken_file_but_not_for_a_missing_one_or_unsuitable_options() {
        let folder = tempfile::tempdir().unwrap();
        let broken = folder.path().join("broken.toml");
        std::fs::write(&broken, "version = 1\n[[curve]]\nname =\n").unwrap();
        let none = Overrides::default();
        let plain = ImportOptions::default();
        let broken = broken.to_str().unwrap();
        assert_eq!(check(broken, &plain, &none), Ok(()));
        assert_eq!(check("example1", &plain, &none), Ok(()));
        assert!(check("missing.toml", &plain, &none).is_err());
        let unknown = Overrides { set: vec![("k".to_owned(), "2".to_owned())], ..Overrides::default() };
        assert!(check("example1", &plain, &unknown).is_err());
        let scaled = ImportOptions { scale: Some(2.0), ..ImportOptions::default() };
        assert!(check(broken, &scaled, &none).is_err() && check("example1", &scaled, &none).is_err());
    }
}
