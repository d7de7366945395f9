//! Where things go: files, which appear whole or not at all, and standard output.

use std::convert::Infallible;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::command_line::Destination;
use super::figure::Figure;
use crate::core::fault::Fault;
use crate::core::formats::format::{self, Format, WriteOptions};
use crate::core::formats::save;
use crate::core::soup::mesh_file::MeshFile;

/// A file, or standard output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// `-`.
    StandardOutput,
    /// Anything else.
    File(PathBuf),
}

impl FromStr for Target {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(if text == "-" { Target::StandardOutput } else { Target::File(text.into()) })
    }
}

impl Target {
    /// Refuses what could not be written, before any work is done for it.
    fn check(&self) -> Result<(), Fault> {
        let Target::File(path) = self else { return Ok(()) };
        let place = path.display().to_string();
        if path.is_dir() {
            return Err(Fault::new("This is a folder").at(place).remedy("Name a file in it"));
        }
        match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
                Err(Fault::new(format!("The folder \"{}\" does not exist", folder.display()))
                    .at(place)
                    .remedy("Make it first, or name another place"))
            }
            _ => Ok(()),
        }
    }

    /// Writes by `write`.
    pub fn write(&self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Fault> {
        match self {
            Target::File(path) => save::save(path, write),
            Target::StandardOutput => {
                let mut out = BufWriter::with_capacity(1 << 18, io::stdout().lock());
                match write(&mut out).and_then(|()| out.flush()) {
                    Ok(()) => Ok(()),
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                        // Who has closed the pipe has what is wanted; what waits to be written is not tried again.
                        let _ = out.into_parts();
                        Ok(())
                    }
                    Err(error) => Err(Fault::new(format!("It cannot be written: {error}")).at("standard output")),
                }
            }
        }
    }
}

/// A mesh's place and format.
pub(super) struct MeshTarget {
    target: Target,
    format: Format,
    options: WriteOptions,
}

impl MeshTarget {
    /// The place and format that the arguments name, if they name one.
    pub fn of(destination: &Destination) -> Result<Option<MeshTarget>, Fault> {
        let Some(target) = destination.out.clone() else { return Ok(None) };
        MeshTarget::new(target, destination.format, destination.msh2).map(Some)
    }

    /// A file, in the format of its extension.
    #[cfg(feature = "window")]
    pub fn file(path: PathBuf) -> Result<MeshTarget, Fault> {
        MeshTarget::new(Target::File(path), None, false)
    }

    fn new(target: Target, format: Option<Format>, msh2: bool) -> Result<MeshTarget, Fault> {
        let format = match (&target, format) {
            (_, Some(format)) => format,
            (Target::File(path), None) => Format::from_path(path)?,
            (Target::StandardOutput, None) => {
                return Err(Fault::new("The format is not known").at("standard output").remedy("Write --format msh"));
            }
        };
        if !format.is_written() {
            let known: Vec<String> = Format::written().map(|format| format!(".{}", format.extension())).collect();
            return Err(Fault::new(format!(
                "The format .{} is read and not written: it has no quadrilaterals",
                format.extension()
            ))
            .remedy(format!("Write one of {}", known.join(", "))));
        }
        if msh2 && format != Format::Msh {
            return Err(Fault::new("--msh2 is for .msh").remedy("Leave it out, or write a .msh"));
        }
        Ok(MeshTarget { target, format, options: WriteOptions { msh2 } })
    }

    /// Refuses a place where the metric would fall on the file that it is read from.
    pub fn spare(&self, sol: Option<&Path>) -> Result<(), Fault> {
        let (Target::File(path), Format::Medit, Some(sol)) = (&self.target, self.format, sol) else { return Ok(()) };
        let beside = path.with_extension("sol");
        let is_same = beside == sol || matches!((beside.canonicalize(), sol.canonicalize()), (Ok(a), Ok(b)) if a == b);
        if !is_same {
            return Ok(());
        }
        Err(Fault::new("The metric would be written over the file that it is read from")
            .at(sol.display().to_string())
            .remedy("Name the mesh otherwise: its metric goes to the .sol of the same name"))
    }

    /// Refuses a place that could not be written.
    #[cfg(feature = "window")]
    pub fn check(&self) -> Result<(), Fault> {
        self.target.check()
    }

    /// Whether the format is for looking at what there is besides the mesh: data of elements and points.
    pub fn shows_data(&self) -> bool {
        self.format == Format::Vtu
    }

    /// Why the metric is not written with the mesh, where it is not.
    pub fn lacks_metric(&self) -> Option<String> {
        match (&self.target, self.format) {
            (_, Format::Obj | Format::Inp | Format::Ply) => {
                Some(format!("The metric is not written: .{} has no place for it.\n", self.format.extension()))
            }
            (Target::StandardOutput, Format::Medit) => {
                Some("The metric is not written: a .mesh has it in a second file.\n".to_owned())
            }
            _ => None,
        }
    }

    /// Writes the mesh; to standard output without what Medit keeps in a second file.
    pub fn write(&self, mesh: &MeshFile) -> Result<(), Fault> {
        match &self.target {
            Target::File(path) => format::write_mesh(path, self.format, mesh, self.options),
            Target::StandardOutput => self.target.write(|out| format::write_to(out, self.format, mesh, self.options)),
        }
    }
}

/// Checks that each target can be written, that no two are the same place, and that a picture is an SVG.
///
/// Returns whether standard output is one of them: then people are told on standard error.
pub(super) fn check(targets: &[Option<&Target>], picture: Option<&Target>) -> Result<bool, Fault> {
    let all: Vec<&Target> = targets.iter().copied().flatten().chain(picture).collect();
    for (k, target) in all.iter().enumerate() {
        target.check()?;
        if all[..k].contains(target) {
            let fault = Fault::new("Two outputs have the same place");
            return Err(match target {
                Target::StandardOutput => fault.at("standard output").remedy("Name a file for one of them"),
                Target::File(path) => fault.at(path.display().to_string()).remedy("Name another file for one of them"),
            });
        }
    }
    if let Some(Target::File(path)) = picture {
        image_format(path)?;
    }
    Ok(all.contains(&&Target::StandardOutput))
}

/// What a picture is written as.
enum Image {
    Svg,
    #[cfg(feature = "window")]
    Png,
}

fn image_format(path: &Path) -> Result<Image, Fault> {
    let is = |extension: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension));
    match () {
        () if is("svg") => Ok(Image::Svg),
        #[cfg(feature = "window")]
        () if is("png") => Ok(Image::Png),
        () => {
            let known = if cfg!(feature = "window") { ".svg or .png" } else { ".svg" };
            Err(Fault::new(format!("Pictures are written as {known}"))
                .at(path.display().to_string())
                .remedy("Give the name such an extension"))
        }
    }
}

/// Writes a figure as vectors or, by the name's extension, as pixels.
pub(super) fn write_figure(target: &Target, figure: &Figure) -> Result<(), Fault> {
    let bytes = match target {
        Target::StandardOutput => figure.svg.as_bytes().to_vec(),
        Target::File(path) => match image_format(path)? {
            Image::Svg => figure.svg.as_bytes().to_vec(),
            #[cfg(feature = "window")]
            Image::Png => figure.png()?,
        },
    };
    target.write(|out| out.write_all(&bytes))
}

/// Tells people: on standard output, or on standard error where something else is written to standard output.
pub(super) fn tell(text: &str, on_standard_error: bool) {
    // Who has closed the stream does not want to know.
    let _ = if on_standard_error { write!(io::stderr(), "{text}") } else { write!(io::stdout(), "{text}") };
}
