//! Promise: long work tells how far it is, and ends soon when it is told to, with nothing but that to say.
#![allow(clippy::unwrap_used)]

#[path = "common/grid.rs"]
mod grid;

use grid::grid;
use quadfront::core::case::{Case, DomainSource, built_in};
use quadfront::core::convert::background;
use quadfront::core::convert::conversion;
use quadfront::core::discrete::Edges;
use quadfront::core::discrete::features::{ANGLE, features};
use quadfront::core::discrete::repair::repair;
use quadfront::core::formats::format::{read_mesh, read_mesh_watched, write_to};
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::progress::{Cancel, Nobody, Stage, Watch};
use quadfront::core::soup::MeshFile;

/// Writes down what it is told, and asks for the end as soon as it has been told so much.
#[derive(Default)]
struct Witness {
    told: Vec<(Stage, u64, u64)>,
    cancel: Cancel,
    after: Option<usize>,
}

impl Witness {
    fn who_ends_it(after: usize) -> Witness {
        Witness { cancel: Cancel::new(), after: Some(after), ..Witness::default() }
    }
}

impl Watch for Witness {
    fn tell(&mut self, stage: Stage, done: u64, total: u64) {
        self.told.push((stage, done, total));
        if self.after == Some(self.told.len()) {
            self.cancel.ask();
        }
    }

    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }
}

/// A wavy plate of `2 n^2` triangles, with coordinates of single precision.
fn plate(n: u32) -> MeshFile {
    let mut mesh = grid(n, |x, y| 0.1 * libm::sin(6.0 * x) * libm::cos(5.0 * y));
    mesh.points.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    mesh
}

fn stl(mesh: &MeshFile) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for t in &mesh.triangles {
        bytes.extend([0; 12]);
        for k in t {
            mesh.points[*k as usize].to_array().iter().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn every_format_tells_how_far_it_is_and_ends_when_it_is_told_to() {
    let mesh = plate(60);
    let folder = tempfile::tempdir().unwrap();
    let written = Format::written().map(|format| {
        let mut bytes = Vec::new();
        write_to(&mut bytes, format, &mesh, WriteOptions::default()).unwrap();
        (format, bytes)
    });
    for (format, bytes) in written.chain([(Format::Stl, stl(&mesh))]) {
        let path = folder.path().join("plate").with_extension(format.extension());
        std::fs::write(&path, &bytes).unwrap();
        let mut witness = Witness::default();
        let read = read_mesh_watched(&path, None, &mut witness).unwrap();
        assert_eq!(read, read_mesh(&path, None).unwrap(), "watched or not");
        let size = bytes.len() as u64;
        let told: Vec<u64> = witness.told.iter().map(|told| told.1).collect();
        assert!(witness.told.iter().all(|&(stage, _, total)| (stage, total) == (Stage::Read, size)), "{format:?}");
        assert!(told.is_sorted() && told[told.len() - 1] > size / 2, "{format:?}: {told:?}");
        for after in 1..=told.len() {
            let mut witness = Witness::who_ends_it(after);
            let fault = read_mesh_watched(&path, None, &mut witness).unwrap_err();
            assert!(fault.is_stop(), "{format:?} after {after}: {fault}");
            assert!(witness.told.len() <= after + 1, "{format:?} goes on for {}", witness.told.len() - after);
        }
    }
}

#[test]
fn a_metric_beside_the_mesh_is_part_of_what_can_be_ended() {
    let mut mesh = plate(60);
    mesh.metric = Some(vec![quadfront::core::kernel::Metric3::isotropic(0.1); mesh.points.len()]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.mesh");
    quadfront::core::formats::format::write_mesh(&path, Format::Medit, &mesh, WriteOptions::default()).unwrap();
    let mut witness = Witness::default();
    assert!(read_mesh_watched(&path, None, &mut witness).unwrap().metric.is_some());
    for after in 1..=witness.told.len() {
        assert!(read_mesh_watched(&path, None, &mut Witness::who_ends_it(after)).unwrap_err().is_stop());
    }
}

#[test]
fn mending_and_charts_are_told_and_can_be_ended_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.stl");
    let mut mesh = plate(16);
    mesh.points.iter_mut().for_each(|p| p.z *= 8.0);
    std::fs::write(&path, stl(&mesh)).unwrap();
    let mut case = Case::of_mesh(path, None);
    // So many charts that there is something to be told.
    if let DomainSource::Mesh { taking, .. } = &mut case.domain {
        taking.chart_stretch = 1.1;
    }
    let mut witness = Witness::default();
    let made = background(&case, &mut witness).unwrap();
    let of = |wanted: Stage| witness.told.iter().filter(move |told| told.0 == wanted).map(|told| told.1);
    assert_eq!(of(Stage::Repair).count(), 9);
    assert!(of(Stage::Chart).count() > 3 && of(Stage::Chart).is_sorted(), "{:?}", witness.told);
    let mut stages: Vec<Stage> = witness.told.iter().map(|told| told.0).collect();
    stages.dedup();
    assert!(stages.is_sorted(), "{stages:?}");
    // The same, watched by somebody who lets it end.
    let again = background(&case, &mut Witness::who_ends_it(usize::MAX)).unwrap();
    assert_eq!(again.mesh.element_count(), made.mesh.element_count());
    for after in (1..=witness.told.len()).step_by(3) {
        let fault = background(&case, &mut Witness::who_ends_it(after)).unwrap_err();
        assert!(fault.is_stop() && fault.place.is_empty(), "after {after}: {fault}");
    }
}

#[test]
fn work_that_is_ended_before_it_begins_does_nothing() {
    let cancel = Cancel::new();
    cancel.ask();
    let mut witness = Witness { cancel, ..Witness::default() };
    assert!(repair(&plate(4), &mut witness).unwrap_err().is_stop());
    let mesh = repair(&plate(4), None, &mut Nobody).unwrap().mesh;
    let edges = Edges::of(&mesh.triangles);
    let found = features(&mesh, &edges, ANGLE);
    let charts = quadfront::core::discrete::chart::charts(&mesh, &edges, &found, Default::default(), &mut witness);
    assert!(charts.unwrap_err().is_stop());
}

#[test]
fn faces_at_the_same_time_are_told_of_while_they_are_converted() {
    let mut case = built_in::named("example6").unwrap().unwrap();
    case.parameters.size_scale = 1.0;
    let mut witness = Witness::default();
    let converted = conversion::convert(&case, &mut witness).unwrap();
    let faces = converted.names.faces.len();
    let told: Vec<u64> = witness.told.iter().filter(|told| told.0 == Stage::Convert).map(|told| told.1).collect();
    assert!(told.len() > 2 * faces + 2, "{} times for {faces} faces", told.len());
    assert!(told.is_sorted(), "{told:?}");
    let before = witness.told.iter().position(|told| told.0 == Stage::Convert).unwrap();
    let ended = conversion::convert(&case, &mut Witness::who_ends_it(before + 4));
    assert!(ended.unwrap_err().is_stop());
}
