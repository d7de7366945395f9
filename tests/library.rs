//! Promise: other programs can use the library. A mesh in memory converts to the same bytes as the same mesh in a file,
//! faults are told apart by their kinds, and a pool of threads that the caller has taken up is no obstacle.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use quadfront::glam::DVec2;
use quadfront::{
    Cancel, Case, Converter, DomainSource, EventKind, Export, Fault, FaultKind, FieldSpec, Format, MeshFile, MeshUse,
    Metric2, Metric3, Nobody, Parameters, Run, Stage, Taking, Watch, WriteOptions, background, built_in, convert,
    read_mesh, read_mesh_bytes, write_mesh, write_mesh_to, write_run,
};

/// The points of a square of 8 by 8 cells, at (0, 0) to (1, 1).
fn square() -> impl Iterator<Item = [f64; 2]> + Clone {
    (0..81).map(|k| [f64::from(k % 9) / 8.0, f64::from(k / 9) / 8.0])
}

/// Two triangles for each of its cells.
fn halves() -> impl Iterator<Item = [u32; 3]> {
    let corners = (0..64).map(|cell| 9 * (cell / 8) + cell % 8);
    corners.flat_map(|a| [[a, a + 1, a + 10], [a, a + 10, a + 9]])
}

fn plate() -> MeshFile {
    MeshFile::in_plane(square(), halves())
}

/// The square bent in space.
fn shell() -> MeshFile {
    MeshFile::in_space(square().map(|[x, y]| [x, y, 0.4 * x * x]), halves())
}

/// The quadrilaterals of a case as a file.
fn converted(case: &Case) -> Vec<u8> {
    let converted = convert(case, &mut Nobody).unwrap();
    let file = Export::of(&converted.mesh, &converted.names).file;
    assert!(file.triangles.is_empty() && file.quads.len() > 20, "{}: {}", case.name, file.quads.len());
    let mut bytes = Vec::new();
    write_mesh_to(&mut bytes, Format::Msh, &file, WriteOptions::default()).unwrap();
    bytes
}

/// A mesh as a file, and its metric, where it has one, as another.
fn in_file(mesh: &MeshFile, folder: &Path) -> Case {
    let (path, sol) = (folder.join("plate.msh"), folder.join("metric.sol"));
    write_mesh(&path, Format::Msh, mesh, WriteOptions { msh2: true }).unwrap();
    if mesh.metric.is_none() {
        return Case::of_mesh(path, None);
    }
    write_mesh(&folder.join("metric.mesh"), Format::Medit, mesh, WriteOptions::default()).unwrap();
    Case::of_mesh(path, Some(sol))
}

fn used_for(case: Case, used: MeshUse) -> Case {
    case.with_taking(Taking { used: Some(used), ..Taking::default() })
}

#[test]
fn a_mesh_in_memory_converts_to_the_same_bytes_as_the_same_mesh_in_a_file() {
    let tensors = square().map(|[x, y]| Metric2::from_sizes([0.04 + 0.1 * x, 0.16], DVec2::new(1.0, y)).unwrap());
    let sizes = square().map(|[x, _]| 0.08 + 0.1 * x);
    let in_two = plate().with_region("left", (0..128).filter(|k| k / 2 % 8 < 4)).unwrap();
    let in_two = in_two.with_region("right", (0..128).filter(|k| k / 2 % 8 >= 4)).unwrap();
    let with_line = in_two.with_line("wire", (0..8).map(|k| [36 + k, 37 + k]));
    let along = [0.05, 0.2, 0.2];
    let in_space = square().map(|[x, _]| {
        let g = [[1.0, 0.0, 0.8 * x], [0.0, 1.0, 0.0], [-0.8 * x, 0.0, 1.0]];
        Metric3::from_sizes(along, g.map(Into::into)).unwrap()
    });
    for (name, mesh, used) in [
        ("plane", plate(), MeshUse::Triangles),
        ("plane, tensors", plate().with_plane_metric(tensors), MeshUse::Shape),
        ("plane, sizes", plate().with_sizes(sizes.clone()).unwrap(), MeshUse::Shape),
        ("plane, groups", with_line, MeshUse::Triangles),
        ("space", shell(), MeshUse::Triangles),
        ("space, sizes", shell().with_sizes(sizes).unwrap(), MeshUse::Shape),
        ("space, tensors", shell().with_metric(in_space), MeshUse::Shape),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let from_file = converted(&used_for(in_file(&mesh, folder.path()), used));
        let from_memory = converted(&used_for(Case::of_mesh_in_memory("plate", mesh), used));
        assert!(from_file == from_memory, "{name}");
    }
}

#[test]
fn quadrilaterals_in_memory_are_cut_as_those_of_a_file() {
    let mut mesh = plate();
    mesh.quads = vec![[0, 1, 10, 9]];
    mesh.triangles.drain(..2);
    let folder = tempfile::tempdir().unwrap();
    let case = in_file(&mesh, folder.path());
    assert!(converted(&case) == converted(&Case::of_mesh_in_memory("plate", mesh)));
}

#[test]
fn regions_and_lines_in_memory_keep_their_names() {
    let mesh = plate().with_region("left", 0..64).unwrap().with_line("wire", (0..8).map(|k| [k, k + 1]));
    let converted = convert(&Case::of_mesh_in_memory("plate", mesh), &mut Nobody).unwrap();
    let names: Vec<_> = converted.names.faces.iter().map(|face| face.name.as_str()).collect();
    assert_eq!(names, ["region 0", "left"]);
    assert_eq!(converted.names.lines[0].name, "wire");
}

fn fault_of(case: &Case) -> Fault {
    background(case, &mut Nobody).unwrap_err()
}

#[test]
fn faults_of_a_mesh_in_memory_name_the_mesh_and_its_indices() {
    let mut mesh = plate();
    mesh.triangles[3] = [0, 1, 99];
    let told = fault_of(&Case::of_mesh_in_memory("plate", mesh)).to_string();
    assert!(told.starts_with("the mesh \"plate\": The triangle of index 3 uses point 99"), "{told}");
    let mut mesh = shell();
    mesh.points[7].x = f64::NAN;
    let told = fault_of(&Case::of_mesh_in_memory("shell", mesh)).to_string();
    assert!(told.starts_with("the mesh \"shell\": Point 7 is at (NaN"), "{told}");
}

fn case(text: &str) -> Case {
    Case::parse(text, "case", "case.toml", Path::new("")).unwrap()
}

const SQUARE: &str = "version = 1\n[[curve]]\nname = \"side\"\nkind = \"polyline\"\n\
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]\n[[face]]\nname = \"face\"\nouter = [\"side\"]\n[[metric]]\n";

/// Asks for an end at once.
struct Impatient;

impl Watch for Impatient {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}

    fn cancel(&self) -> Cancel {
        let cancel = Cancel::new();
        cancel.ask();
        cancel
    }
}

#[test]
fn every_kind_of_fault_comes_out() {
    let uniform = case(&format!("{SQUARE}kind = \"uniform\"\nh = 0.25"));
    let nowhere = case(
        &SQUARE.replace("[0, 1], [0, 0]]", "[0, 1]]").replace("[[metric]]", "[[metric]]\nkind = \"uniform\"\nh = 1"),
    );
    let negative = case(&format!("{SQUARE}kind = \"formula\"\nh1 = \"x - 0.5\""));
    let mut endless = uniform.clone();
    endless.fields = vec![FieldSpec::Uniform { h: 1e-6 }];
    let mut unnamed = uniform.clone();
    unnamed.parameters.faces = vec!["lid".to_owned()];
    let in_memory = Case::of_mesh_in_memory("plate", plate());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.toml");
    let mut doubled = plate();
    doubled.triangles.extend([[0, 1, 20], [0, 1, 30]]);
    for (kind, fault) in [
        (FaultKind::Io, read_mesh("nothing.msh".as_ref(), None).unwrap_err()),
        (FaultKind::Io, Case::read("nothing.toml".as_ref()).unwrap_err()),
        (FaultKind::Io, write_mesh(folder.path(), Format::Msh, &plate(), WriteOptions::default()).unwrap_err()),
        (FaultKind::Io, fault_of(&Case::of_mesh("nothing.msh".into(), None))),
        (FaultKind::Syntax, read_mesh_bytes("a.obj", b"v 0 zero 0", Format::Obj).unwrap_err()),
        (FaultKind::Syntax, read_mesh_bytes("a.obj", b"", Format::Obj).unwrap_err()),
        (FaultKind::Syntax, read_mesh("mesh.step".as_ref(), None).unwrap_err()),
        (FaultKind::Syntax, Case::parse("version = ", "a", "a.toml", Path::new("")).unwrap_err()),
        (FaultKind::Syntax, Case::parse("version = 1\nmesch = 1", "a", "a.toml", Path::new("")).unwrap_err()),
        (FaultKind::Geometry, fault_of(&nowhere)),
        (FaultKind::Metric, fault_of(&negative)),
        (FaultKind::Metric, plate().with_sizes([0.0]).unwrap_err()),
        (FaultKind::Mesh, fault_of(&Case::of_mesh_in_memory("doubled", doubled))),
        (FaultKind::Mesh, write_run(&file, &Run::of(in_memory)).unwrap_err()),
        (FaultKind::Parameter, Parameters::default().set("c", "9999").unwrap_err()),
        (FaultKind::Parameter, Parameters::default().set("see", "1").unwrap_err()),
        (FaultKind::Parameter, fault_of(&unnamed)),
        (FaultKind::Limit, fault_of(&endless)),
        (FaultKind::Stopped, convert(&uniform, &mut Impatient).unwrap_err()),
        (FaultKind::Other, Fault::new("Something else")),
    ] {
        assert_eq!(fault.kind(), kind, "{fault}");
        assert_eq!(fault.is_stop(), kind == FaultKind::Stopped, "{fault}");
    }
    assert!(!file.exists() && matches!(uniform.domain, DomainSource::Curves { .. }));
}

#[test]
fn faces_are_converted_in_a_pool_whose_only_thread_waits_for_them() {
    let mut case = built_in::named("branching").unwrap().unwrap();
    case.parameters.size_scale = 2.0;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let in_pool = pool.install(|| converted(&case));
    assert!(in_pool == converted(&case));
}

#[test]
fn a_state_is_reached_step_by_step() {
    let case = built_in::named("example1").unwrap().unwrap();
    let start = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(start.mesh, &start.sizing, case.parameters.clone());
    let first = converter.step().unwrap();
    assert_eq!((first.kind(), converter.counts.steps), (EventKind::BaseSelected, 1));
}
