//! Case files: geometry, metric and parameters as one TOML file, strict and versioned; documented in
//! `assets/cases/README.md`. Deliberately absent: geometric checks (`geometry::domain`) and checks of formulas
//! (`metric::formula`).

mod parameters;
mod rules;
mod symmetry;
pub(in crate::core) mod table;
mod geometry;
mod surfaces;
mod elements;
mod metric;
mod points;
pub(in crate::core) mod taking;
mod import_options;
mod step_part;
pub mod built_in;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec2;

pub use import_options::ImportOptions;
pub use parameters::{ParameterKind, Parameters};
pub use rules::{
    CleanUpBy, DivisionAt, EnhancementOrder, FirstRescue, HMinOver, Selection, SelectionWindow, SmoothingWeights,
};
pub use symmetry::Symmetry;
use table::{Source, Table};
pub use taking::{MeshSource, MeshUse, Taking};

use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::save::load;
use crate::core::geometry::{ComplexSpec, CurveSpec, FaceSpec, PointSpec, ShapeLimits};
use crate::core::metric::FieldSpec;
use crate::core::soup::{Ignored, MeshFile};

/// The supported version of case files.
pub const VERSION: u32 = 1;

/// The source of a case's domain.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum DomainSource {
    /// Plane curves and the faces that they bound.
    Curves {
        /// All curves.
        curves: Vec<CurveSpec>,
        /// All faces, at least one.
        faces: Vec<FaceSpec>,
    },
    /// Surfaces, curves on them and the faces that they bound.
    Surfaces(ComplexSpec),
    /// A small background mesh in the case itself: the fixtures of the paper's figures.
    Elements {
        /// Coordinates of its points.
        points: Vec<DVec2>,
        /// Live triangles, by zero-based point index.
        triangles: Vec<[u32; 3]>,
        /// Existing quadrilaterals, likewise.
        quads: Vec<[u32; 4]>,
    },
    /// A triangle mesh.
    Mesh {
        /// Where it is.
        source: MeshSource,
        /// How it is used.
        taking: Taking,
    },
}

/// A case: the complete input of a conversion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Case {
    /// Short name: the file name without its extension.
    pub name: String,
    /// One line for display; by default, the name.
    pub title: String,
    /// Free text: origin of the case, and which parts follow the paper.
    pub notes: String,
    /// Parameters, with defaults for those not in the file.
    pub parameters: Parameters,
    /// Source of the domain.
    pub domain: DomainSource,
    /// Hard points: places in the plane that become nodes.
    pub points: Vec<PointSpec>,
    /// Metric fields, intersected; empty only for a mesh, which then uses its own metric.
    pub fields: Vec<FieldSpec>,
    /// Bound of the metric's gradation (docs/algorithm.md, "Gradation"), greater than 1; `None`: not bounded.
    pub gradation: Option<f64>,
    /// The distance up to which ends of plane curves and points of their polylines are one; by default a billionth of
    /// the domain.
    pub tolerance: Option<f64>,
    /// The largest distance of a chord from a curve, as a fraction of the radius.
    pub chord: f64,
    /// The least number of segments of a smooth closed curve.
    pub least_segments: u32,
    /// Whether the domain is its own mirror image, so that the mesh is to be too (docs/algorithm.md, "Symmetry").
    pub symmetry: Option<Symmetry>,
    /// Whether a boundary with a fixed odd number of segments may get one more; otherwise it is rejected.
    pub split_odd: bool,
    /// The groups of its mesh that are ignored.
    pub ignore_groups: Ignored,
    /// The text of the file, for reports; empty for a mesh without a case file.
    pub text: String,
    /// What was mended or left out when it was made of a CAD file: sentences without a full stop.
    pub told: Vec<String>,
}

impl Case {
    /// Reads a case file; mesh paths are relative to it.
    ///
    /// # Errors
    /// Those of reading the file, and of [`Case::parse`].
    pub fn read(path: &Path) -> Result<Case, Fault> {
        let place = path.display().to_string();
        let bytes = load(path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let folder = path.parent().unwrap_or(Path::new(""));
        Case::from_bytes(&bytes, &name, &place, folder)
    }

    /// A case from the bytes of a file: see [`Case::parse`].
    ///
    /// # Errors
    /// Bytes that are not UTF-8, and those of [`Case::parse`].
    pub fn from_bytes(bytes: &[u8], name: &str, file: &str, folder: &Path) -> Result<Case, Fault> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            Fault::new(format!("The file is not text (byte {})", error.valid_up_to()))
                .of_kind(FaultKind::Syntax)
                .at(file)
                .remedy("Give a TOML case file; meshes are recognised by their extension")
        })?;
        Case::parse(text, name, file, folder)
    }

    /// Parses the text of a case `name`; `file` is its name in messages, and mesh paths are relative to `folder`.
    ///
    /// # Errors
    /// With file and line: text that is not TOML, an unsupported version, unknown or missing keys, values of the wrong
    /// type or out of range, unknown names.
    pub fn parse(text: &str, name: &str, file: &str, folder: &Path) -> Result<Case, Fault> {
        Case::parsed(text, name, file, folder).map_err(|fault| fault.of_kind(FaultKind::Syntax))
    }

    fn parsed(text: &str, name: &str, file: &str, folder: &Path) -> Result<Case, Fault> {
        // Some editors write a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source::new(file, text);
        let remedy = |fault: Fault| fault.remedy("See assets/cases/README.md for the format of a case");
        let document = source.parse().map_err(remedy)?;
        let table = Table::document(&source, &document);
        check_version(&table)?;
        table.only(&[
            "version",
            "title",
            "notes",
            "parameters",
            "gradation",
            "corner_angle",
            "tolerance",
            "chord",
            "least_segments",
            "symmetry",
            "split_odd",
            "ignore_groups",
            "surface",
            "curve",
            "face",
            "point",
            "metric",
            "background",
            "mesh",
            "sol",
            "use",
            "feature_angle",
            "chart_stretch",
            "scale",
            "weld",
        ])?;
        let word = |key| table.get(key).map(|v| v.text()).transpose();
        let domain = domain(&table, folder)?;
        let curves = match &domain {
            DomainSource::Curves { curves, .. } => geometry::Names::of(curves.iter().map(|c| c.name.as_str())),
            DomainSource::Surfaces(spec) => geometry::Names::of(spec.curves.iter().map(|c| c.name.as_str())),
            DomainSource::Elements { .. } | DomainSource::Mesh { .. } => geometry::Names::of(std::iter::empty()),
        };
        let fields = metric::fields(&table, &curves)?;
        let points = points::points(&table)?;
        if let (Some(value), false) = (table.get("point"), matches!(domain, DomainSource::Curves { .. })) {
            return Err(value
                .fault("[[point]] is for curves in the plane")
                .remedy("In a mesh, the points in its groups are kept (docs/files.md)"));
        }
        check_fields(&table, &domain, &fields)?;
        Ok(Case {
            name: name.to_owned(),
            title: word("title")?.unwrap_or(name).to_owned(),
            notes: word("notes")?.unwrap_or_default().trim().to_owned(),
            parameters: parameters(&table)?,
            gradation: gradation(&table)?,
            tolerance: table.get("tolerance").map(|value| value.positive()).transpose()?,
            chord: chord(&table)?,
            least_segments: least_segments(&table)?,
            symmetry: symmetry::symmetry(&table)?,
            split_odd: table.get("split_odd").map_or(Ok(false), |v| v.flag())?,
            ignore_groups: table.get("ignore_groups").map_or(Ok(Ignored::Nothing), |v| taking::ignored(&v))?,
            domain,
            points,
            fields,
            text: text.to_owned(),
            told: Vec::new(),
        })
    }

    /// The case of a mesh file without a case file: default parameters, and the metric of `sol` or of its triangles.
    pub fn of_mesh(path: PathBuf, sol: Option<PathBuf>) -> Case {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let title = format!("Mesh {}", path.file_name().unwrap_or_default().to_string_lossy());
        Case::of_source(name, title, MeshSource::File { path, sol })
    }

    /// A case of a mesh in memory, called `name`: default parameters, and the metric of its points, or else the metric
    /// of its own triangles. The same mesh in a file converts to the same quadrilaterals.
    pub fn of_mesh_in_memory(name: impl Into<String>, mesh: impl Into<Arc<MeshFile>>) -> Case {
        let name = name.into();
        let title = format!("Mesh {name}");
        Case::of_source(name, title, MeshSource::Memory(mesh.into()))
    }

    /// The case with these import options; without effect on a case that has no mesh.
    #[must_use]
    pub fn with_taking(mut self, new: Taking) -> Case {
        if let DomainSource::Mesh { taking, .. } = &mut self.domain {
            *taking = new;
        }
        self
    }

    fn of_source(name: String, title: String, source: MeshSource) -> Case {
        Case {
            name,
            title,
            notes: String::new(),
            parameters: Parameters::default(),
            domain: DomainSource::Mesh { source, taking: Taking::default() },
            points: Vec::new(),
            fields: Vec::new(),
            gradation: None,
            tolerance: None,
            chord: ShapeLimits::CHORD,
            least_segments: ShapeLimits::LEAST_SEGMENTS,
            symmetry: None,
            split_odd: false,
            ignore_groups: Ignored::Nothing,
            text: String::new(),
            told: Vec::new(),
        }
    }
}

fn check_version(table: &Table<'_>) -> Result<(), Fault> {
    let value = table.get("version").ok_or_else(|| {
        table.fault("The version of the case format is missing").remedy("Begin the file with version = 1")
    })?;
    match value.count(1, u32::MAX)? {
        VERSION => Ok(()),
        newer => Err(value
            .fault(format!("version = {newer} is newer than this program supports"))
            .remedy(format!("Use a newer quadfront, or convert the case to version {VERSION}"))),
    }
}

fn domain(table: &Table<'_>, folder: &Path) -> Result<DomainSource, Fault> {
    let file = |key| {
        let value = table.get(key);
        value.map(|v| v.text().map(|name| folder.join(name))).transpose()
    };
    let alone = |own: &str, others: &[&str]| match others.iter().find_map(|key| table.get(key)) {
        None => Ok(()),
        Some(value) => {
            let key = value.key();
            let named =
                if ["surface", "curve", "face"].contains(&key) { format!("every [[{key}]]") } else { key.to_owned() };
            let fault = value.fault(format!("The case has a {own} and a {key}"));
            Err(fault.remedy(format!("Remove either {own} or {named}")))
        }
    };
    let only_curves = |own: &str, keys: &[&str]| match keys.iter().find_map(|key| table.get(key)) {
        None => Ok(()),
        Some(value) => {
            let fault = value.fault(format!("The case has a {own} and a {}", value.key()));
            Err(fault.remedy(format!("Remove {}: it is for curves in the plane", value.key())))
        }
    };
    if let Some(value) = table.get("background") {
        only_curves("background", &["corner_angle", "tolerance"])?;
        alone("background", &["surface", "curve", "face", "mesh", "sol", "chord", "least_segments"])?;
        return elements::elements(&value.table()?);
    }
    if let Some(path) = file("mesh")? {
        only_curves("mesh", &["corner_angle", "tolerance"])?;
        alone("mesh", &["surface", "curve", "face"])?;
        let source = MeshSource::File { path, sol: file("sol")? };
        return Ok(DomainSource::Mesh { source, taking: taking::taking(table)? });
    }
    for key in ["sol", "use", "feature_angle", "chart_stretch", "scale", "ignore_groups", "weld"] {
        if let Some(value) = table.get(key) {
            return Err(value.fault(format!("{key} is given without mesh")).remedy("Write mesh = \"...\" too"));
        }
    }
    if table.get("surface").is_some() {
        let complex = surfaces::complex(table)?;
        if complex.faces.is_empty() {
            return Err(table.fault("The case has no face").remedy("Add [[face]] with a name and a surface"));
        }
        return Ok(DomainSource::Surfaces(complex));
    }
    let curves = geometry::curves(table)?;
    let faces = geometry::faces(table, &curves)?;
    if faces.is_empty() {
        return Err(table.fault("The case has no face").remedy("Add [[curve]] and [[face]], or mesh = \"...\""));
    }
    Ok(DomainSource::Curves { curves, faces })
}

fn check_fields(table: &Table<'_>, domain: &DomainSource, fields: &[FieldSpec]) -> Result<(), Fault> {
    match domain {
        DomainSource::Curves { .. } | DomainSource::Surfaces(_) | DomainSource::Elements { .. }
            if fields.iter().all(|field| matches!(field, FieldSpec::Gap { .. })) =>
        {
            Err(table
                .fault("The case has no metric")
                .remedy("Add [[metric]] with, for example, kind = \"uniform\" and h = 0.1"))
        }
        DomainSource::Mesh { source: MeshSource::File { sol: Some(_), .. }, .. } if !fields.is_empty() => {
            Err(table.fault("The case has both sol and [[metric]]").remedy("Remove one of them"))
        }
        _ => Ok(()),
    }
}

fn parameters(table: &Table<'_>) -> Result<Parameters, Fault> {
    let mut parameters = Parameters::default();
    if let Some(value) = table.get("parameters") {
        set_parameters(&mut parameters, &value.table()?)?;
    }
    Ok(parameters)
}

/// Sets the parameters of a table.
pub(in crate::core) fn set_parameters(parameters: &mut Parameters, table: &Table<'_>) -> Result<(), Fault> {
    table.only(&Parameters::KEYS)?;
    for entry in table.entries() {
        match entry.key() {
            "layered_loops" => parameters.layered_loops = entry.texts()?,
            "faces" => parameters.faces = entry.texts()?,
            key => parameters.set(key, &entry.parameter_text()).map_err(|fault| fault.at(entry.place()))?,
        }
    }
    Ok(())
}

fn chord(table: &Table<'_>) -> Result<f64, Fault> {
    let Some(value) = table.get("chord") else { return Ok(ShapeLimits::CHORD) };
    let chord = value.number()?;
    if (1e-6..=1.0).contains(&chord) { Ok(chord) } else { Err(value.wrong("a number from 1e-6 to 1", "chord = 0.1")) }
}

fn least_segments(table: &Table<'_>) -> Result<u32, Fault> {
    table.get("least_segments").map_or(Ok(ShapeLimits::LEAST_SEGMENTS), |value| value.count(3, 10_000))
}

fn gradation(table: &Table<'_>) -> Result<Option<f64>, Fault> {
    let Some(value) = table.get("gradation") else { return Ok(None) };
    let bound = value.number()?;
    if bound > 1.0 && bound <= 100.0 {
        Ok(Some(bound))
    } else {
        Err(value.wrong("greater than 1 and at most 100", "gradation = 1.3"))
    }
}

#[cfg(test)]
mod tests;
