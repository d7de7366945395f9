//! Outputs: files, which appear complete or not at all, and standard output.

use std::convert::Infallible;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::command_line::Destination;
use super::figure::Figure;
use crate::core::fault::Fault;
use crate::core::formats::{Format, WriteOptions, format, save};
use crate::core::soup::MeshFile;

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
    /// Refuses a target that could not be written, before any work is done.
    fn check(&self) -> Result<(), Fault> {
        let Target::File(path) = self else { return Ok(()) };
        let place = path.display().to_string();
        if save::ON_DISK && path.is_dir() {
            return Err(Fault::new("This is a folder").at(place).remedy("Name a file in it"));
        }
        match path.parent() {
            Some(folder) if save::ON_DISK && !folder.as_os_str().is_empty() && !folder.is_dir() => {
                Err(Fault::new(format!("The folder \"{}\" does not exist", folder.display()))
                    .at(place)
                    .remedy("Create it, or name another folder"))
            }
            _ => Ok(()),
        }
    }

    /// Writes with `write`.
    pub fn write(&self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Fault> {
        match self {
            Target::File(path) => save::save(path, write),
            Target::StandardOutput => {
                let mut out = BufWriter::with_capacity(1 << 18, io::stdout().lock());
                match write(&mut out).and_then(|()| out.flush()) {
                    Ok(()) => Ok(()),
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                        // The reader closed the pipe and needs no more: discard what is buffered.
                        let _ = out.into_parts();
                        Ok(())
                    }
                    Err(error) => Err(Fault::new(format!("Cannot write: {error}")).at("standard output")),
                }
            }
        }
    }
}

/// The target and format of a mesh.
pub(super) struct MeshTarget {
    target: Target,
    format: Format,
    options: WriteOptions,
}

impl MeshTarget {
    /// The target and format that the arguments name, if any.
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
                return Err(Fault::new("The format is not known")
                    .at("standard output")
                    .remedy("Name it, for example --format msh"));
            }
        };
        if !format.is_written() {
            let known: Vec<String> = Format::written().map(|format| format!(".{}", format.extension())).collect();
            return Err(Fault::new(format!(
                "The format .{} can only be read: it has no quadrilaterals",
                format.extension()
            ))
            .remedy(format!("Use one of {}", known.join(", "))));
        }
        if msh2 && format != Format::Msh {
            return Err(Fault::new("--msh2 applies to .msh only").remedy("Leave it out, or write a .msh file"));
        }
        Ok(MeshTarget { target, format, options: WriteOptions { msh2 } })
    }

    /// Refuses a target whose metric file would overwrite the one that the metric is read from.
    pub fn spare(&self, sol: Option<&Path>) -> Result<(), Fault> {
        let (Target::File(path), Format::Medit, Some(sol)) = (&self.target, self.format, sol) else { return Ok(()) };
        let beside = path.with_extension("sol");
        let is_same = beside == sol || matches!((beside.canonicalize(), sol.canonicalize()), (Ok(a), Ok(b)) if a == b);
        if !is_same {
            return Ok(());
        }
        Err(Fault::new("The metric would overwrite the file that it is read from")
            .at(sol.display().to_string())
            .remedy("Choose another name for the mesh: its metric goes to the .sol file of the same name"))
    }

    /// Refuses a target that could not be written.
    #[cfg(feature = "window")]
    pub fn check(&self) -> Result<(), Fault> {
        self.target.check()
    }

    /// Whether the format is for viewing data of elements and points besides the mesh.
    pub fn shows_data(&self) -> bool {
        self.format == Format::Vtu
    }

    /// Why the metric is not written with the mesh; `None` where it is.
    pub fn lacks_metric(&self) -> Option<String> {
        match (&self.target, self.format) {
            (_, Format::Obj | Format::Inp | Format::Ply) => {
                Some(format!("The metric was not written: .{} cannot store it.\n", self.format.extension()))
            }
            (Target::StandardOutput, Format::Medit) => {
                Some("The metric was not written: for .mesh it goes to a second file.\n".to_owned())
            }
            _ => None,
        }
    }

    /// Writes the mesh; to standard output without the second file of Medit.
    pub fn write(&self, mesh: &MeshFile) -> Result<(), Fault> {
        match &self.target {
            Target::File(path) => format::write_mesh(path, self.format, mesh, self.options),
            Target::StandardOutput => self.target.write(|out| format::write_to(out, self.format, mesh, self.options)),
        }
    }
}

/// Checks that each target can be written, that no two are the same, and that the extension of a picture is known.
///
/// Returns the stream for messages: standard error where standard output is one of the targets.
pub(super) fn check(targets: &[Option<&Target>], picture: Option<&Target>) -> Result<Stream, Fault> {
    let all: Vec<&Target> = targets.iter().copied().flatten().chain(picture).collect();
    for (k, target) in all.iter().enumerate() {
        target.check()?;
        if all[..k].contains(target) {
            let fault = Fault::new("Two outputs have the same target");
            return Err(match target {
                Target::StandardOutput => fault.at("standard output").remedy("Name a file for one of them"),
                Target::File(path) => fault.at(path.display().to_string()).remedy("Name another file for one of them"),
            });
        }
    }
    if let Some(Target::File(path)) = picture {
        PictureFormat::of(path)?;
    }
    Ok(if all.contains(&&Target::StandardOutput) { Stream::Error } else { Stream::Output })
}

/// The formats of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureFormat {
    /// Vectors.
    Svg,
    /// Vectors for print.
    #[cfg(not(target_arch = "wasm32"))]
    Pdf,
    /// Pixels.
    #[cfg(feature = "window")]
    Png,
}

impl PictureFormat {
    /// All formats.
    pub const ALL: &[PictureFormat] = &[
        PictureFormat::Svg,
        #[cfg(not(target_arch = "wasm32"))]
        PictureFormat::Pdf,
        #[cfg(feature = "window")]
        PictureFormat::Png,
    ];

    /// The extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            PictureFormat::Svg => "svg",
            #[cfg(not(target_arch = "wasm32"))]
            PictureFormat::Pdf => "pdf",
            #[cfg(feature = "window")]
            PictureFormat::Png => "png",
        }
    }

    /// The format that a path names by its extension.
    pub fn named(path: &Path) -> Option<PictureFormat> {
        let extension = path.extension()?;
        PictureFormat::ALL.iter().copied().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    fn of(path: &Path) -> Result<PictureFormat, Fault> {
        PictureFormat::named(path).ok_or_else(|| {
            let known: Vec<String> =
                PictureFormat::ALL.iter().map(|format| format!(".{}", format.extension())).collect();
            let (last, others) = known.split_last().map_or(("", &[][..]), |(last, others)| (last.as_str(), others));
            Fault::new(format!("Pictures are written as {} or {last} files", others.join(", ")))
                .at(path.display().to_string())
                .remedy("Use such an extension")
        })
    }
}

/// Writes a figure as vectors or pixels, according to its extension.
pub(super) fn write_figure(target: &Target, figure: &Figure) -> Result<(), Fault> {
    let format = match target {
        Target::File(path) => PictureFormat::of(path)?,
        Target::StandardOutput => PictureFormat::Svg,
    };
    let bytes = figure.bytes(format)?;
    target.write(|out| out.write_all(&bytes))
}

/// A stream for messages.
#[derive(Clone, Copy)]
pub(super) enum Stream {
    /// Standard output.
    Output,
    /// Standard error.
    Error,
}

impl Stream {
    /// Prints a message.
    pub fn print(self, text: &str) {
        // A reader that closed the stream does not want the message.
        let _ = match self {
            Stream::Output => write!(io::stdout(), "{text}"),
            Stream::Error => write!(io::stderr(), "{text}"),
        };
    }
}
