//! Promise: CAD files become meshes of quadrilaterals on their exact surfaces. Files by Open CASCADE with areas,
//! volumes and points that Open CASCADE computed (`data/step/oracle.txt`, made once), files written here instance by
//! instance, and files that are damaged.
#![allow(clippy::unwrap_used)]

#[path = "../common/environment.rs"]
mod environment;
#[path = "../common/xor_shift.rs"]
mod xor_shift;

mod built;
mod damage;
mod exact;

use std::path::{Path, PathBuf};

use quadfront::Fault;
use quadfront::core::case::{Case, ImportOptions};
use quadfront::core::convert::conversion::convert;
use quadfront::core::metric::straight_quad::StraightQuad;
use quadfront::core::progress::{Nobody, Reading};
use quadfront::core::record::Export;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, MeshFile};
use quadfront::core::step::{Part, StepOptions};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/step")
}

/// The names of the files, in alphabetical order.
fn names() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let is_step = |path: &PathBuf| path.extension().is_some_and(|e| e == "step");
    let mut names: Vec<String> =
        entries.filter(is_step).map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}

fn bytes_of(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(name).with_extension("step")).unwrap()
}

fn case_of(bytes: &[u8], name: &str, options: &ImportOptions) -> Result<(Case, Part), Fault> {
    options.case_of_step(bytes, name, &format!("{name}.step"), &Reading::watched(&mut Nobody))
}

/// The mesh of a case, which is sound: quadrilaterals alone, each with a positive Jacobian.
fn mesh_of(case: &Case, name: &str, allow: Allow) -> MeshFile {
    let done = convert(case, &mut Nobody).unwrap_or_else(|fault| panic!("{name}: {fault}"));
    let mesh = Export::of(&done.mesh, &done.names).file;
    assert!(mesh.triangles.is_empty() && !mesh.quads.is_empty(), "{name}");
    let found = examine(&mesh);
    assert!(found.verdict(allow).is_ok(), "{name}: {:?}", found.verdict(allow));
    let least = mesh.quads.iter().map(|quad| jacobian(&mesh, quad)).fold(f64::INFINITY, f64::min);
    assert!(least > 0.0, "{name}: the least scaled Jacobian is {least}");
    mesh
}

fn jacobian(mesh: &MeshFile, quad: &[u32; 4]) -> f64 {
    StraightQuad(quad.map(|k| mesh.points[k as usize])).scaled_jacobian()
}

/// The area of a mesh, and the volume that it encloses; each quadrilateral as two triangles.
fn area_and_volume(mesh: &MeshFile) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for quad in &mesh.quads {
        let [a, b, c, d] = quad.map(|k| mesh.points[k as usize]);
        for [p, q, r] in [[a, b, c], [a, c, d]] {
            sums[0] += 0.5 * (q - p).cross(r - p).length();
            sums[1] += p.dot(q.cross(r)) / 6.0;
        }
    }
    sums
}

/// How many quadrilaterals each side of a mesh has: the number of sides with one, two and more.
fn sides(mesh: &MeshFile) -> [usize; 3] {
    let sides = mesh.quads.iter().flat_map(|q| (0..4).map(|k| [q[k].min(q[(k + 1) % 4]), q[k].max(q[(k + 1) % 4])]));
    let mut sides: Vec<[u32; 2]> = sides.collect();
    sides.sort_unstable();
    let mut counts = [0; 3];
    sides.chunk_by(|a, b| a == b).for_each(|same| counts[same.len().min(3) - 1] += 1);
    counts
}

fn skipping() -> ImportOptions {
    ImportOptions { step: StepOptions { skip_bad_faces: true, ..StepOptions::default() }, ..ImportOptions::default() }
}
