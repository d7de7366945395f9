//! A part: the faces of a file as surfaces, curves and loops of a case.

use std::collections::{BTreeMap, BTreeSet};

use std::path::Path;

use super::exchange::Exchange;
use super::groups::Styles;
use super::products::{Bodies, bodies};
use super::sewing::Sewn;
use super::topology::{Topology, topology};
use crate::core::fault::{Fault, FaultKind};
use crate::core::geometry::{ComplexSpec, FaceSpec, SpaceCurveSpec, SurfaceFaceSpec, SurfaceSpec};
use crate::core::kernel::box_tree::extent;
use crate::core::kernel::decimal::number;
use crate::core::kernel::worded::worded;
use crate::core::metric::fitting::short_edge;
use crate::core::progress::Pace;
use crate::core::soup::{NOT_READ, times};

/// The extensions of STEP files.
pub const EXTENSIONS: [&str; 3] = ["step", "stp", "p21"];

/// Edges within this fraction of the diagonal are one, unless the file tells a larger uncertainty.
const TOLERANCE: f64 = 1e-5;
/// The largest tolerance that a file's own uncertainty may give, as a fraction of the diagonal.
const LARGEST: f64 = 1e-4;

worded! {
    /// A unit of length.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Unit by word {
        /// Millimetre.
        Millimetre = "mm",
        /// Centimetre.
        Centimetre = "cm",
        /// Metre.
        Metre = "m",
        /// Micrometre.
        Micrometre = "um",
        /// Inch.
        Inch = "in",
        /// Foot.
        Foot = "ft",
    }
}

impl Unit {
    /// Its length in metres.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Millimetre => 1e-3,
            Unit::Centimetre => 1e-2,
            Unit::Metre => 1.0,
            Unit::Micrometre => 1e-6,
            Unit::Inch => 0.0254,
            Unit::Foot => 0.3048,
        }
    }

    /// The unit of a word.
    pub fn of_word(word: &str) -> Option<Unit> {
        Unit::ALL.into_iter().find(|unit| unit.word() == word)
    }
}

/// Whether a path has the extension of a STEP file: `.step`, `.stp` or `.p21`.
pub fn is_step(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    EXTENSIONS.contains(&extension.as_str())
}

/// How a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepOptions {
    /// The unit of the coordinates; by default that of the file.
    pub unit: Option<Unit>,
    /// The distance up to which edges are one and edges lie on surfaces; by default 1e-5 of the diagonal, or what the
    /// file tells.
    pub tolerance: Option<f64>,
    /// Whether faces that cannot be taken are left out, instead of refusing the file.
    pub skip_bad_faces: bool,
}

/// A part that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its surfaces, curves and faces.
    pub spec: ComplexSpec,
    /// The diagonal of its edges' bounding box, or of its surfaces if it has no edges.
    pub diagonal: f64,
    /// The unit of its coordinates, as a word; of an unusual one its length in metres.
    pub unit: String,
    /// The schema of the file ("AP214 ...").
    pub schema: String,
    /// A length that few edges fall below: their tenth part, by number.
    pub short_edge: f64,
    /// How many bodies the faces belong to.
    pub bodies: usize,
    /// What was repaired, left out or assumed: sentences without a full stop.
    pub told: Vec<String>,
}

/// Reads a STEP file; `name` is its name in messages.
///
/// # Errors
/// With the file, the line and the number of the instance: text that is no STEP file, instances that contradict one
/// another, faces that cannot be taken (unless they are skipped), a file without faces; [`Fault::stopped`].
pub fn read(name: &str, bytes: &[u8], options: &StepOptions, pace: &dyn Pace) -> Result<Part, Fault> {
    let found = read_exchange(name, bytes, options, pace);
    pace.cancel().check().and(found.map_err(|fault| fault.of_kind(FaultKind::Syntax)))
}

fn read_exchange(name: &str, bytes: &[u8], options: &StepOptions, pace: &dyn Pace) -> Result<Part, Fault> {
    let file = Exchange::open(name, bytes, pace)?;
    let bodies = bodies(&file, options.unit.map(Unit::metres))?;
    let mut topology = topology(&file, &bodies.bodies, pace)?;
    let mut told = Vec::new();
    let mut bad = std::mem::take(&mut topology.bad);
    refuse_bad(&bad, topology.faces.len(), options)?;
    if topology.faces.is_empty() && bad.is_empty() {
        return Err(no_faces(name, &bodies));
    }
    let points = topology.edges.iter().flat_map(|edge| edge.points.iter().copied());
    let (low, high) = extent(points);
    let size = if topology.edges.is_empty() { 0.0 } else { (high - low).length() };
    let uncertainty = bodies.own.uncertainty.unwrap_or(0.0) / bodies.wanted;
    let tolerance = options.tolerance.unwrap_or((TOLERANCE * size).max(uncertainty.min(LARGEST * size)));
    let sewn = topology.sew(tolerance.max(f64::MIN_POSITIVE));
    let styles = Styles::read(&file);
    let mut spec = Spec::of(&topology, &bodies, &styles);
    let mut faces = Vec::new();
    for (number, face) in topology.faces.iter().enumerate() {
        pace.cancel().check()?;
        match face.bounded_surface(&topology.edges, tolerance) {
            Ok(shape) => faces.push((number, shape)),
            Err(what) => {
                let fault = file.fault_at(face.id, format!("The face #{} {what}", face.id));
                bad.push((face.id, fault.remedy(super::SKIP)));
            }
        }
    }
    refuse_bad(&bad, faces.len(), options)?;
    for (number, shape) in faces {
        spec.take(number, shape);
    }
    if spec.complex.faces.is_empty() {
        return Err(no_faces(name, &bodies));
    }
    for (_, fault) in &bad {
        told.push(format!("left out: {}", lower(&fault.what)));
    }
    tell(&mut told, &topology, &sewn, &bodies);
    let used: BTreeSet<usize> = spec.faces.iter().map(|&number| topology.faces[number].body).collect();
    let mut complex = spec.complex;
    complex.tolerance = (tolerance > 0.0).then_some(tolerance);
    let used_edges: BTreeSet<usize> =
        topology.faces.iter().flat_map(|face| &face.loops).flatten().map(|step| step.0).collect();
    let short_edge = short_edge(used_edges.into_iter().map(|edge| topology.edges[edge].length()), size);
    let diagonal = if size > 0.0 { size } else { size_of_surfaces(&complex) };
    let bodies_used = used.len();
    Ok(Part {
        spec: complex,
        diagonal,
        short_edge,
        unit: unit_text(bodies.wanted),
        schema: file.schema.clone(),
        bodies: bodies_used,
        told,
    })
}

/// Refuses faces that cannot be taken, unless they are to be skipped and others are left.
fn refuse_bad(bad: &[(u64, Fault)], good: usize, options: &StepOptions) -> Result<(), Fault> {
    let Some((_, first)) = bad.first() else { return Ok(()) };
    if options.skip_bad_faces && good > 0 {
        return Ok(());
    }
    let mut fault = first.clone();
    if bad.len() > 1 {
        fault.what = format!("{} ({} faces cannot be taken)", fault.what, bad.len());
    }
    if good > 0 && !fault.remedy.contains("--skip-bad-faces") {
        fault.remedy = format!("{}, or leave such faces out with --skip-bad-faces", fault.remedy);
    }
    Err(fault)
}

fn no_faces(name: &str, bodies: &Bodies) -> Fault {
    let has: Vec<String> = bodies.left_out.iter().map(|(kind, count)| format!("{count} x {kind}")).collect();
    let what = if has.is_empty() {
        "The file has no faces".to_owned()
    } else {
        format!("The file has no faces on surfaces, only {}", has.join(", "))
    };
    Fault::new(what).at(name).remedy("Export the model as a boundary representation (solids or surfaces)")
}

/// What was mended and what was left out.
fn tell(told: &mut Vec<String>, topology: &Topology, sewn: &Sewn, bodies: &Bodies) {
    let mut count = |n: usize, one: &str, many: &str, rest: &str| {
        if n > 0 {
            told.push(format!("{n} {} {rest}", if n == 1 { one } else { many }));
        }
    };
    let apart = format!("joined to one that coincides, at most {} apart", number(sewn.apart));
    count(sewn.pairs, "edge was", "edges were", &apart);
    count(sewn.short, "edge was", "edges were", "left out: shorter than the tolerance");
    count(sewn.doubled, "face was", "faces were", "left out: another one coincides with it");
    count(sewn.open, "edge bounds", "edges bound", "one face only");
    let off = topology.edges.iter().map(|edge| edge.off).fold(0.0, f64::max);
    if off > 1e-3 * topology.edges.iter().map(super::topology::Edge::length).fold(0.0, f64::max) {
        told.push(format!("vertices are up to {} away from their curves", number(off)));
    }
    for (kind, n) in &bodies.left_out {
        told.push(format!("{NOT_READ}{}", times(kind, *n)));
    }
}

fn lower(what: &str) -> String {
    let mut letters = what.chars();
    letters.next().map(|first| first.to_lowercase().chain(letters).collect()).unwrap_or_default()
}

/// The word of a unit of so many metres.
fn unit_text(metres: f64) -> String {
    let known = Unit::ALL.into_iter().find(|unit| (unit.metres() / metres - 1.0).abs() < 1e-9);
    known.map_or_else(|| format!("{metres} m"), |unit| unit.word().to_owned())
}

/// The diagonal of the control points of all surfaces.
fn size_of_surfaces(spec: &ComplexSpec) -> f64 {
    let made = spec.surfaces.iter().filter_map(|surface| surface.shape.surface(&|_| None).ok());
    made.map(|surface| surface.size()).fold(0.0, f64::max) * 3.0_f64.sqrt()
}

/// The case in the making.
struct Spec<'t> {
    topology: &'t Topology,
    complex: ComplexSpec,
    /// By edge: its name, once it is a curve.
    curves: BTreeMap<usize, String>,
    /// The names of edges and faces, by number.
    edge_names: Vec<String>,
    face_names: Vec<String>,
    /// The groups of each face.
    groups: Vec<Vec<String>>,
    /// The faces that were taken.
    faces: Vec<usize>,
}

impl<'t> Spec<'t> {
    fn of(topology: &'t Topology, bodies: &Bodies, styles: &Styles) -> Spec<'t> {
        let edges = topology.edges.iter().map(|edge| (edge.name.as_str(), edge.id, edge.body));
        let faces = topology.faces.iter().map(|face| (face.name.as_str(), face.id, face.body));
        let body_names = body_names(bodies);
        let groups = topology.faces.iter().map(|face| {
            let mut groups: Vec<String> = Some(face.name.clone()).filter(|name| !name.is_empty()).into_iter().collect();
            groups.extend((bodies.bodies.len() > 1).then(|| body_names[face.body].clone()));
            groups.extend(styles.groups(&face.owners));
            groups
        });
        let groups = groups.collect();
        Spec {
            topology,
            complex: ComplexSpec::default(),
            curves: BTreeMap::new(),
            edge_names: names("edge", edges),
            face_names: names("face", faces),
            groups,
            faces: Vec::new(),
        }
    }

    /// Adds a face with its surface and its curves.
    fn take(&mut self, number: usize, shape: crate::core::geometry::SurfaceShape) {
        let face = &self.topology.faces[number];
        let name = self.face_names[number].clone();
        let loops = face.loops.iter().map(|steps| {
            let step = |&(edge, forward): &(usize, bool)| (self.edge_names[edge].clone(), forward);
            steps.iter().map(step).collect()
        });
        let loops: Vec<Vec<(String, bool)>> = loops.collect();
        for &(edge, _) in face.loops.iter().flatten() {
            if self.curves.contains_key(&edge) {
                continue;
            }
            let name = self.edge_names[edge].clone();
            self.curves.insert(edge, name.clone());
            let shape = self.topology.edges[edge].shape.clone();
            self.complex.curves.push(SpaceCurveSpec { name, shape, segments: None, place: String::new() });
        }
        let groups = self.groups[number].iter().filter(|group| **group != name).cloned().collect();
        self.complex.surfaces.push(SurfaceSpec { name: name.clone(), shape, place: String::new() });
        let spec = FaceSpec {
            name: name.clone(),
            outer: Vec::new(),
            holes: Vec::new(),
            cracks: Vec::new(),
            repeated: Vec::new(),
            groups,
            place: String::new(),
        };
        self.complex.faces.push(SurfaceFaceSpec { surface: name, face: spec, loops, reversed: face.reversed });
        self.faces.push(number);
    }
}

/// A name for each instance: its own one if no other has it, else its kind and number; parts that stand several times
/// are told apart by the number of their body.
fn names<'n>(kind: &str, all: impl Iterator<Item = (&'n str, u64, usize)> + Clone) -> Vec<String> {
    let mut of_name: BTreeMap<&str, usize> = BTreeMap::new();
    let mut of_id: BTreeMap<u64, usize> = BTreeMap::new();
    for (name, id, _) in all.clone() {
        *of_name.entry(name).or_default() += 1;
        *of_id.entry(id).or_default() += 1;
    }
    let mut used: BTreeSet<String> = BTreeSet::new();
    let name = |(name, id, body): (&str, u64, usize)| {
        let plain: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        // A minus would mean the other direction, a colon an edge of a whole surface.
        let is_usable = !plain.is_empty() && !plain.starts_with('-') && !plain.contains(": ");
        let mut found = match of_name[name] {
            1 if is_usable => plain,
            _ if is_usable && kind == "face" => format!("{plain} #{id}"),
            _ => format!("{kind} #{id}"),
        };
        if of_id[&id] > 1 {
            found = format!("{found} in body {}", body + 1);
        }
        while !used.insert(found.clone()) {
            found.push('\'');
        }
        found
    };
    all.map(name).collect()
}

/// A name for each body, each once.
fn body_names(bodies: &Bodies) -> Vec<String> {
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    bodies.bodies.iter().for_each(|body| *count.entry(&body.name).or_default() += 1);
    let name = |(k, body): (usize, &super::products::Body)| match (body.name.as_str(), count[body.name.as_str()]) {
        ("", _) => format!("body {}", k + 1),
        (name, 1) => name.to_owned(),
        (name, _) => format!("{name} (body {})", k + 1),
    };
    bodies.bodies.iter().enumerate().map(name).collect()
}
