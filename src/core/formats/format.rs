//! The mesh formats, and the entry points for reading and writing meshes.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::gltf;
use super::inp;
use super::medit;
use super::msh;
use super::obj;
use super::ply;
use super::save::{self, load_watched};
use super::stl;
use super::vtu;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::worded::worded;
use crate::core::progress::{Nobody, Pace, Reading, Watch};
use crate::core::soup::MeshFile;

worded! {
    /// A mesh format, with the extension of its files, without the dot. The writable ones come first.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[non_exhaustive]
    pub enum Format by extension {
        /// Gmsh, `.msh`.
        Msh = "msh",
        /// Medit, `.mesh`, with the metric in a `.sol` file of the same name.
        Medit = "mesh",
        /// VTK XML, `.vtu`.
        Vtu = "vtu",
        /// Wavefront, `.obj`.
        Obj = "obj",
        /// Abaqus, `.inp`.
        Inp = "inp",
        /// Stanford, `.ply`.
        Ply = "ply",
        /// Stereolithography, `.stl`; read only, since it has no quadrilaterals.
        Stl = "stl",
        /// Khronos glTF, `.gltf`; read only, likewise.
        Gltf = "gltf",
        /// Binary glTF, `.glb`; read only.
        Glb = "glb",
    }
}

/// Options for writing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// Writes Gmsh's version 2.2 instead of 4.1.
    pub msh2: bool,
}

impl Format {
    /// The writable formats: those with quadrilaterals.
    pub fn written() -> impl Iterator<Item = Format> {
        Format::ALL.into_iter().filter(|format| format.is_written())
    }

    /// Whether it can be written.
    pub fn is_written(self) -> bool {
        !matches!(self, Format::Stl | Format::Gltf | Format::Glb)
    }

    /// The format of a file by its extension, ignoring case.
    ///
    /// # Errors
    /// An unknown or missing extension: the fault lists the known ones.
    pub fn from_path(path: &Path) -> Result<Format, Fault> {
        Format::of_extension(path).map_err(|fault| fault.of_kind(FaultKind::Syntax))
    }

    fn of_extension(path: &Path) -> Result<Format, Fault> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        if let Some(&format) = Format::ALL.iter().find(|format| format.extension() == extension) {
            return Ok(format);
        }
        let place = path.display().to_string();
        if extension == "meshb" || extension == "solb" {
            let text = &extension[..extension.len() - 1];
            return Err(Fault::new("Medit's binary format is not supported")
                .at(place)
                .remedy(format!("Use the text format, .{text}")));
        }
        let known: Vec<String> = Format::ALL.iter().map(|format| format!(".{}", format.extension())).collect();
        let what = if extension.is_empty() {
            "The file name has no extension, so its format is unknown".to_string()
        } else {
            format!("Unknown format \".{extension}\"")
        };
        Err(Fault::new(what).at(place).remedy(format!("Use one of {}", known.join(", "))))
    }
}

/// The file with the metric of a mesh, where none is named: for a `.mesh` the `.sol` of the same name in the same
/// folder, if it exists.
pub fn metric_beside(path: &Path) -> Option<PathBuf> {
    let is_medit = Format::from_path(path).is_ok_and(|format| format == Format::Medit);
    Some(path.with_extension("sol")).filter(|sol| is_medit && save::is_file(sol))
}

/// Reads a mesh in the format of its extension. The metric comes from the file `sol` if given, for a mesh of any
/// format; otherwise from the one [beside it](metric_beside).
///
/// # Errors
/// A fault with file, line and remedy.
pub fn read_mesh(path: &Path, sol: Option<&Path>) -> Result<MeshFile, Fault> {
    read_mesh_watched(path, sol, &mut Nobody)
}

/// As [`read_mesh`], with progress and cancellation.
///
/// # Errors
/// As [`read_mesh`], and [`Fault::stopped`].
pub fn read_mesh_watched(path: &Path, sol: Option<&Path>, watch: &mut dyn Watch) -> Result<MeshFile, Fault> {
    let pace = Reading::watched(watch);
    let format = Format::from_path(path)?;
    let bytes = load_watched(path, &pace)?;
    let mut mesh = read_in(&path.display().to_string(), &bytes, format, path.parent(), &pace)?;
    if let Some(sol) = sol.map(Path::to_path_buf).or_else(|| metric_beside(path)) {
        let bytes = load_watched(&sol, &pace)?;
        let metric = medit::read_metric_watched(&sol.display().to_string(), &bytes, mesh.points.len(), &pace);
        mesh.metric = Some(metric.map_err(|fault| fault.of_kind(FaultKind::Syntax))?);
    }
    mesh.drop_middles();
    Ok(mesh)
}

/// Reads a mesh from bytes; `name` is the file's name in messages.
///
/// # Errors
/// A fault with name, line and remedy.
pub fn read_bytes(name: &str, bytes: &[u8], format: Format) -> Result<MeshFile, Fault> {
    let mut mesh = read_in(name, bytes, format, None, &Reading::watched(&mut Nobody))?;
    mesh.drop_middles();
    Ok(mesh)
}

/// As [`read_bytes`]; `folder` holds the files that the mesh refers to.
fn read_in(
    name: &str,
    bytes: &[u8],
    format: Format,
    folder: Option<&Path>,
    pace: &dyn Pace,
) -> Result<MeshFile, Fault> {
    if bytes.trim_ascii().is_empty() {
        return Err(Fault::new("The file is empty").of_kind(FaultKind::Syntax).at(name).remedy("Export it again"));
    }
    let read = match format {
        Format::Msh => msh::read(name, bytes, pace),
        Format::Medit => medit::read(name, bytes, pace),
        Format::Vtu => vtu::read(name, bytes, pace),
        Format::Obj => obj::read(name, bytes, pace),
        Format::Inp => inp::read(name, bytes, pace),
        Format::Ply => ply::read(name, bytes, pace),
        Format::Stl => stl::read(name, bytes, pace),
        Format::Gltf | Format::Glb => gltf::read(name, bytes, folder, pace),
    };
    // A cancelled reader saw only part of the file, and may have reported that as a fault.
    pace.cancel().check().and(read.map_err(|fault| fault.of_kind(FaultKind::Syntax)))
}

/// Writes a mesh to a stream. Medit's metric, a separate file, is not written.
///
/// # Errors
/// Those of `out`, and a format that cannot be written.
pub fn write_to(out: &mut dyn Write, format: Format, mesh: &MeshFile, options: WriteOptions) -> io::Result<()> {
    match format {
        Format::Msh => msh::write(out, mesh, if options.msh2 { msh::Version::V2 } else { msh::Version::V4 }),
        Format::Medit => medit::write(out, mesh),
        Format::Vtu => vtu::write(out, mesh),
        Format::Obj => obj::write(out, mesh),
        Format::Inp => inp::write(out, mesh),
        Format::Ply => ply::write(out, mesh),
        Format::Stl | Format::Gltf | Format::Glb => Err(io::Error::other("it has no quadrilaterals")),
    }
}

/// Writes a mesh to a file, atomically; for Medit, also the metric to the `.sol` of the same name.
///
/// # Errors
/// A fault with the file and the reason.
pub fn write_mesh(path: &Path, format: Format, mesh: &MeshFile, options: WriteOptions) -> Result<(), Fault> {
    save::save(path, |out| write_to(out, format, mesh, options))?;
    if let (Format::Medit, Some(metric)) = (format, &mesh.metric) {
        save::save(&path.with_extension("sol"), |out| medit::write_metric(out, mesh, metric))?;
    }
    Ok(())
}
