//! Loading of a million triangles from each format: seconds (median of three) and the most memory while it is done,
//! beside what is asked for: 3 s, and twice the file besides the mesh. And how soon loading, mending and cutting into
//! charts end when they are told to, at the worst of some moments: 0.1 s is asked for.
#![allow(clippy::unwrap_used)]

mod meter;

use std::time::{Duration, Instant};

use glam::DVec3;
use peak_alloc::PeakAlloc;
use quadfront::core::discrete::chart::charts;
use quadfront::core::discrete::features::{ANGLE, features};
use quadfront::core::discrete::repair::repair;
use quadfront::core::discrete::{Edges, StretchBound};
use quadfront::core::fault::Fault;
use quadfront::core::formats::format::{read_mesh, read_mesh_watched, write_to};
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::progress::{Cancel, Nobody, Stage, Watch};
use quadfront::core::soup::MeshFile;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Squares along a side of the plate.
const N: u32 = 707;

fn main() {
    let mesh = plate();
    let folder = tempfile::tempdir().unwrap();
    println!("{} triangles, {} points; {}", mesh.triangles.len(), mesh.points.len(), meter::clock());
    println!("{:<12} {:>8} {:>8} {:>10} {:>14}", "format", "file", "seconds", "memory", "beyond mesh");
    for (name, format, bytes) in files(&mesh) {
        let path = folder.path().join("mesh").with_extension(format.extension());
        std::fs::write(&path, &bytes).unwrap();
        let size = bytes.len();
        drop(bytes);
        let before = MEMORY.current_usage();
        MEMORY.reset_peak_usage();
        let read = read_mesh(&path, None).unwrap();
        let peak = MEMORY.peak_usage() - before;
        assert_eq!(read.triangles.len(), mesh.triangles.len());
        let own = size_of_val(&read.points[..])
            + size_of_val(&read.triangles[..])
            + size_of_val(&read.triangle_tags[..])
            + size_of_val(&read.lines[..]);
        drop(read);
        let (_, seconds) = meter::median_of(3, || read_mesh(&path, None).unwrap());
        println!(
            "{name:<12} {:>5.0} MB {seconds:>8.2} {:>7.0} MB {:>5.2} x file",
            size as f64 / 1e6,
            peak as f64 / 1e6,
            peak.saturating_sub(own) as f64 / size as f64
        );
    }
    println!("\n{:<12} {:>8} {:>14}", "", "seconds", "ends within");
    for (name, format, bytes) in files(&mesh) {
        let path = folder.path().join("mesh").with_extension(format.extension());
        std::fs::write(&path, &bytes).unwrap();
        told(&name, None, &|watch| read_mesh_watched(&path, None, watch).map(drop));
    }
    told("repair", None, &|watch| repair(&mesh, watch).map(drop));
    let made = repair(&mesh, None, &mut Nobody).unwrap().mesh;
    // A disc of a million triangles takes minutes to be laid flat; nobody waits for its end here.
    told("charts", Some(8.0), &|watch| {
        let edges = Edges::unless(&made.triangles, &watch.cancel())?;
        charts(&made, &edges, &features(&made, &edges, ANGLE), StretchBound::default(), watch).map(drop)
    });
}

/// How long work takes (where it is not done: so long it is looked at), and how long it goes on when it is told to end,
/// at the worst of some moments.
fn told(name: &str, looked_at: Option<f64>, work: &dyn Fn(&mut dyn Watch) -> Result<(), Fault>) {
    let seconds = looked_at.unwrap_or_else(|| meter::median_of(1, || work(&mut Nobody).unwrap()).1);
    let ends = |k: u32| {
        let mut patient = Patient(Cancel::new());
        let cancel = patient.0.clone();
        let asked = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_secs_f64(seconds * (f64::from(k) + 0.5) / f64::from(MOMENTS)));
            let asked = Instant::now();
            cancel.ask();
            asked
        });
        let _ = work(&mut patient);
        let ended = Instant::now();
        // Some are done before they are asked.
        ended.saturating_duration_since(asked.join().unwrap()).as_secs_f64()
    };
    let worst = (0..MOMENTS).map(ends).fold(0.0, f64::max);
    println!("{name:<12} {seconds:>8.2} {worst:>12.3} s");
}

/// Moments at which work is told to end.
const MOMENTS: u32 = 10;

struct Patient(Cancel);

impl Watch for Patient {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}

    fn cancel(&self) -> Cancel {
        self.0.clone()
    }
}

fn plate() -> MeshFile {
    let mut mesh = MeshFile::default();
    for k in 0..(N + 1) * (N + 1) {
        let (x, y) = (f64::from(k % (N + 1)) / f64::from(N), f64::from(k / (N + 1)) / f64::from(N));
        // In single precision, as most files are.
        let p = DVec3::new(x, y, 0.1 * libm::sin(6.0 * x) * libm::cos(5.0 * y));
        mesh.points.push(p.as_vec3().as_dvec3());
    }
    for k in 0..N * N {
        let a = k % N + k / N * (N + 1);
        mesh.triangles.extend([[a, a + 1, a + N + 2], [a, a + N + 2, a + N + 1]]);
    }
    mesh
}

/// The mesh in all formats.
fn files(mesh: &MeshFile) -> impl Iterator<Item = (String, Format, Vec<u8>)> + '_ {
    let written = [false, true].into_iter().flat_map(|msh2| Format::written().map(move |format| (format, msh2)));
    let written = written.filter(|(format, msh2)| !msh2 || *format == Format::Msh).map(|(format, msh2)| {
        let mut bytes = Vec::new();
        write_to(&mut bytes, format, mesh, WriteOptions { msh2 }).unwrap();
        (format!("{}{}", format.extension(), if msh2 { " 2.2" } else { "" }), format, bytes)
    });
    type Written = fn(&MeshFile) -> Vec<u8>;
    let others: [(&str, Format, Written); 4] = [
        ("stl binary", Format::Stl, stl_binary),
        ("stl text", Format::Stl, stl_text),
        ("ply binary", Format::Ply, ply_binary),
        ("glb", Format::Glb, glb),
    ];
    written.chain(others.into_iter().map(|(name, format, make)| (name.to_owned(), format, make(mesh))))
}

fn single(p: DVec3) -> [u8; 12] {
    let mut bytes = [0; 12];
    for (k, x) in p.as_vec3().to_array().into_iter().enumerate() {
        bytes[4 * k..4 * k + 4].copy_from_slice(&x.to_le_bytes());
    }
    bytes
}

fn stl_binary(mesh: &MeshFile) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for t in &mesh.triangles {
        bytes.extend([0; 12]);
        t.iter().for_each(|&k| bytes.extend(single(mesh.points[k as usize])));
        bytes.extend([0; 2]);
    }
    bytes
}

fn stl_text(mesh: &MeshFile) -> Vec<u8> {
    let mut text = String::from("solid plate\n");
    for t in &mesh.triangles {
        text.push_str("facet normal 0 0 1\nouter loop\n");
        for p in t.map(|k| mesh.points[k as usize].as_vec3()) {
            text.push_str(&format!("vertex {} {} {}\n", p.x, p.y, p.z));
        }
        text.push_str("endloop\nendfacet\n");
    }
    text.push_str("endsolid plate\n");
    text.into_bytes()
}

fn ply_binary(mesh: &MeshFile) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.points.len(),
        mesh.triangles.len()
    )
    .into_bytes();
    mesh.points.iter().for_each(|&p| bytes.extend(single(p)));
    for t in &mesh.triangles {
        bytes.push(3);
        t.iter().for_each(|k| bytes.extend(k.to_le_bytes()));
    }
    bytes
}

fn glb(mesh: &MeshFile) -> Vec<u8> {
    let (points, corners) = (mesh.points.len(), 3 * mesh.triangles.len());
    let [first, second] = [12 * points, 4 * corners];
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "buffers":[{{"byteLength":{}}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{first}}},{{"buffer":0,"byteOffset":{first},"byteLength":{second}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{points},"type":"VEC3","min":[0,0,-1],"max":[1,1,1]}},
        {{"bufferView":1,"componentType":5125,"count":{corners},"type":"SCALAR"}}]}}"#,
        first + second
    )
    .into_bytes();
    while json.len() % 4 != 0 {
        json.push(b' ');
    }
    let mut bytes = b"glTF".to_vec();
    let all = 12 + 8 + json.len() + 8 + first + second;
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((all as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend(((first + second) as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    mesh.points.iter().for_each(|&p| bytes.extend(single(p)));
    mesh.triangles.as_flattened().iter().for_each(|k| bytes.extend(k.to_le_bytes()));
    bytes
}
