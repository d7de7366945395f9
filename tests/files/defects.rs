//! Every defect in every format: what becomes of it, by files that are written here, number by number.

use std::fmt::Write as _;
use std::time::Instant;

use glam::DVec3;
use quadfront::core::discrete::repair::repair;
use quadfront::core::discrete::{Census, Edges};
use quadfront::core::formats::Format;
use quadfront::core::formats::format::read_bytes;
use quadfront::core::progress::{Cancel, Nobody};
use quadfront::core::soup::Weld;

use super::xor_shift::XorShift;

/// Points and triangles as they are written: numbers may be none, and indices point nowhere.
#[derive(Clone, Default)]
struct Plain {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// The ways to write it. Those of single precision have corners of their own (STL), or points (glTF).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Obj,
    StlText,
    StlBinary,
    PlyText,
    PlyBinary,
    Msh2,
    Msh4,
    Medit,
    Vtu,
    Inp,
    Gltf,
    Glb,
}

impl Way {
    const ALL: [Way; 12] = [
        Way::Obj,
        Way::StlText,
        Way::StlBinary,
        Way::PlyText,
        Way::PlyBinary,
        Way::Msh2,
        Way::Msh4,
        Way::Medit,
        Way::Vtu,
        Way::Inp,
        Way::Gltf,
        Way::Glb,
    ];

    fn format(self) -> Format {
        match self {
            Way::Obj => Format::Obj,
            Way::StlText | Way::StlBinary => Format::Stl,
            Way::PlyText | Way::PlyBinary => Format::Ply,
            Way::Msh2 | Way::Msh4 => Format::Msh,
            Way::Medit => Format::Medit,
            Way::Vtu => Format::Vtu,
            Way::Inp => Format::Inp,
            Way::Gltf => Format::Gltf,
            Way::Glb => Format::Glb,
        }
    }

    fn is_stl(self) -> bool {
        self.format() == Format::Stl
    }
}

const BASE64: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn base64(bytes: &[u8]) -> String {
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        let letter = |k: usize| char::from(BASE64[(bits >> (18 - 6 * k)) as usize & 63]);
        (0..4).for_each(|k| text.push(if k <= three.len() { letter(k) } else { '=' }));
    }
    text
}

impl Plain {
    /// A plate of `n` by `m` squares, from `x` on, bent up.
    fn plate(n: usize, m: usize, x: f64) -> Plain {
        let mut plain = Plain::default();
        for k in 0..(n + 1) * (m + 1) {
            let at = x + (k % (n + 1)) as f64 / n as f64;
            plain.points.push(DVec3::new(at, (k / (n + 1)) as f64 / m as f64, 0.25 * at * at));
        }
        for k in 0..n * m {
            let a = (k % n + k / n * (n + 1)) as u32;
            let above = a + n as u32 + 1;
            plain.triangles.extend([[a, a + 1, above + 1], [a, above + 1, above]]);
        }
        plain
    }

    fn and(mut self, other: Plain) -> Plain {
        let n = self.points.len() as u32;
        self.points.extend(other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|k| k + n)));
        self
    }

    fn torn(&self, noise: f64) -> Plain {
        let mut random = XorShift::of(5);
        let mut moved =
            |p: DVec3| p + DVec3::from_array([(); 3].map(|()| noise * (random.below(2001) as f64 / 1e3 - 1.0)));
        let points = self.triangles.as_flattened().iter().map(|&k| moved(self.points[k as usize])).collect();
        Plain { points, triangles: (0..self.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect() }
    }

    fn triangle(mut self, t: [u32; 3]) -> Plain {
        self.triangles.push(t);
        self
    }

    fn point(mut self, p: [f64; 3]) -> Plain {
        self.points.push(DVec3::from_array(p));
        self
    }

    fn moved(mut self, k: usize, to: [f64; 3]) -> Plain {
        self.points[k] = DVec3::from_array(to);
        self
    }

    fn rows(&self, before: impl Fn(usize) -> String, after: &str) -> String {
        let row = |(k, p): (usize, &DVec3)| format!("{}{:?} {:?} {:?}{after}\n", before(k), p.x, p.y, p.z);
        self.points.iter().enumerate().map(row).collect()
    }

    fn lines(&self, before: impl Fn(usize) -> String, first: u32, separator: &str, after: &str) -> String {
        let row = |(k, t): (usize, &[u32; 3])| {
            let corners = t.map(|k| (k + first).to_string()).join(separator);
            format!("{}{corners}{after}\n", before(k))
        };
        self.triangles.iter().enumerate().map(row).collect()
    }

    /// Positions and indices as glTF has them, with the table of the buffer at `uri`.
    fn gltf(&self, uri: impl Fn(&[u8]) -> String) -> (String, Vec<u8>) {
        let mut bytes: Vec<u8> = Vec::new();
        self.points.iter().flat_map(|p| p.as_vec3().to_array()).for_each(|x| bytes.extend(x.to_le_bytes()));
        let places = bytes.len();
        self.triangles.as_flattened().iter().for_each(|k| bytes.extend(k.to_le_bytes()));
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3","min":[-9,-9,-9],"max":[9,9,9]}},
{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{places}}},
{{"buffer":0,"byteOffset":{places},"byteLength":{}}}],"buffers":[{{{}"byteLength":{}}}]}}"#,
            self.points.len(),
            3 * self.triangles.len(),
            bytes.len() - places,
            uri(&bytes),
            bytes.len()
        );
        (json, bytes)
    }

    fn written(&self, way: Way) -> Vec<u8> {
        let (n, m) = (self.points.len(), self.triangles.len());
        let none = |_: usize| String::new();
        let at = |k: u32| self.points.get(k as usize).copied().unwrap_or(DVec3::NAN);
        let mut text = String::new();
        match way {
            Way::Obj => text = self.rows(|_| "v ".into(), "") + &self.lines(|_| "f ".into(), 1, " ", ""),
            Way::StlText => {
                text.push_str("solid s\n");
                for t in &self.triangles {
                    text.push_str("facet normal 0 0 0\nouter loop\n");
                    t.iter().for_each(|&k| writeln!(text, "vertex {:?} {:?} {:?}", at(k).x, at(k).y, at(k).z).unwrap());
                    text.push_str("endloop\nendfacet\n");
                }
                text.push_str("endsolid s\n");
            }
            Way::StlBinary => {
                let mut bytes = vec![b' '; 80];
                bytes.extend((m as u32).to_le_bytes());
                for t in &self.triangles {
                    bytes.extend([0; 12]);
                    t.iter().flat_map(|&k| at(k).as_vec3().to_array()).for_each(|x| bytes.extend(x.to_le_bytes()));
                    bytes.extend([0; 2]);
                }
                return bytes;
            }
            Way::PlyText | Way::PlyBinary => {
                let kind = if way == Way::PlyText { "ascii" } else { "binary_little_endian" };
                let xyz = "property double x\nproperty double y\nproperty double z";
                let list = "property list uchar uint vertex_indices";
                text = format!(
                    "ply\nformat {kind} 1.0\nelement vertex {n}\n{xyz}\nelement face {m}\n{list}\nend_header\n"
                );
                if way == Way::PlyBinary {
                    let mut bytes = text.into_bytes();
                    self.points.iter().flat_map(|p| p.to_array()).for_each(|x| bytes.extend(x.to_le_bytes()));
                    for t in &self.triangles {
                        bytes.push(3);
                        t.iter().for_each(|k| bytes.extend(k.to_le_bytes()));
                    }
                    return bytes;
                }
                text += &(self.rows(none, "") + &self.lines(|_| "3 ".into(), 0, " ", ""));
            }
            Way::Msh2 => {
                let nodes = self.rows(|k| format!("{} ", k + 1), "");
                let elements = self.lines(|k| format!("{} 2 0 ", k + 1), 1, " ", "");
                text = format!(
                    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{n}\n{nodes}$EndNodes\n\
                     $Elements\n{m}\n{elements}$EndElements\n"
                );
            }
            Way::Msh4 => {
                let numbers: String = (1..=n).map(|k| format!("{k}\n")).collect();
                let nodes = format!("1 {n} 1 {n}\n2 1 0 {n}\n{numbers}{}", self.rows(none, ""));
                let elements = format!("1 {m} 1 {m}\n2 1 2 {m}\n{}", self.lines(|k| format!("{} ", k + 1), 1, " ", ""));
                text = format!(
                    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n\
                     $Elements\n{elements}$EndElements\n"
                );
            }
            Way::Medit => {
                let (vertices, triangles) = (self.rows(none, " 0"), self.lines(none, 1, " ", " 0"));
                text = format!(
                    "MeshVersionFormatted 2\nDimension 3\nVertices\n{n}\n{vertices}Triangles\n{m}\n{triangles}End\n"
                );
            }
            Way::Vtu => {
                let ends: String = (1..=m).map(|k| format!("{} ", 3 * k)).collect();
                let array = |name: &str, kind: &str, of: &str| {
                    format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">\n{of}</DataArray>\n")
                };
                let points = format!(
                    "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n{}</DataArray>\n",
                    self.rows(none, "")
                );
                let cells = array("connectivity", "Int64", &self.lines(none, 0, " ", ""))
                    + &array("offsets", "Int64", &ends)
                    + &array("types", "UInt8", &"5 ".repeat(m));
                text = format!(
                    "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">\n<UnstructuredGrid>\n\
                     <Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{m}\">\n<Points>\n{points}</Points>\n\
                     <Cells>\n{cells}</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
                );
            }
            Way::Inp => {
                let nodes: String = self.rows(|k| format!("{} ", k + 1), "").replace(' ', ", ");
                let elements = self.lines(|k| format!("{}, ", k + 1), 1, ", ", "");
                text = format!("*NODE\n{nodes}*ELEMENT, TYPE=S3\n{elements}");
            }
            Way::Gltf => {
                text =
                    self.gltf(|bytes| format!("\"uri\":\"data:application/octet-stream;base64,{}\",", base64(bytes))).0;
            }
            Way::Glb => {
                let (json, buffer) = self.gltf(|_| String::new());
                let json = format!("{json}{}", " ".repeat((4 - json.len() % 4) % 4));
                let mut bytes = Vec::from(*b"glTF");
                let whole = 12 + 8 + json.len() + 8 + buffer.len();
                [2, whole as u32, json.len() as u32].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
                bytes.extend(b"JSON");
                bytes.extend(json.as_bytes());
                bytes.extend((buffer.len() as u32).to_le_bytes());
                bytes.extend(b"BIN\0");
                bytes.extend(buffer);
                return bytes;
            }
        }
        text.into_bytes()
    }
}

/// What is to become of a file.
#[derive(Debug)]
enum Outcome {
    /// It is read, and repaired to so many nodes, triangles and pieces; these words are told.
    Made([usize; 3], &'static [&'static str]),
    /// It is refused; the message has all of these.
    Refused(&'static [&'static str]),
}
use Outcome::{Made, Refused};

/// Reads, merges and repairs; or the message with which the file is refused.
fn made(way: Way, bytes: &[u8]) -> Result<([usize; 3], Vec<String>), String> {
    let name = format!("odd.{}", way.format().extension());
    let mut file = read_bytes(&name, bytes, way.format()).map_err(|fault| fault.to_string())?;
    let welded = file.weld(Weld::Auto, &Cancel::default()).map_err(|fault| fault.to_string())?;
    let mut told = Vec::new();
    welded.report(&mut told);
    let found = repair(&file, welded.tolerance, &mut Nobody).map_err(|fault| fault.at(name).to_string())?;
    told.extend(found.repairs);
    let census = Census::of(&found.mesh, &Edges::of(&found.mesh.triangles));
    Ok(([census.nodes, census.triangles, census.components], told))
}

fn holds(what: &str, way: Way, bytes: &[u8], expected: &Outcome) -> Result<(), String> {
    let begin = Instant::now();
    let found = made(way, bytes);
    assert!(begin.elapsed().as_secs() < 10, "{what}, {way:?} takes too long");
    let is_it = match (expected, &found) {
        (Made(counts, words), Ok((own, told))) => {
            counts == own
                && told.len() == words.len()
                && told.iter().zip(*words).all(|(told, word)| told.contains(word))
        }
        (Refused(words), Err(fault)) => words.iter().all(|word| fault.contains(word)) && fault.contains("odd."),
        _ => false,
    };
    if is_it { Ok(()) } else { Err(format!("{what}, {way:?}: {expected:?}, but {found:?}")) }
}

const HUNG: &str = "6 hanging points were joined to the mesh";
const MERGED: &str = "3 coincident points were merged";
/// Of 96 corners, 25 are left.
const TORN: &str = "71 near points of borders were merged into others";

/// Whether the format has triangles with corners of their own, in single precision, which its reader merges.
fn has_own_corners(way: Way) -> bool {
    way.is_stl() || matches!(way, Way::Gltf | Way::Glb)
}

#[test]
fn every_defect_of_a_mesh_has_its_outcome_in_every_format() {
    let plate = || Plain::plate(4, 4, 0.0);
    let mut wrong: Vec<String> = Vec::new();
    let mut row = |what: &str, plain: &Plain, expected: &dyn Fn(Way) -> Option<Outcome>| {
        for way in Way::ALL {
            if let Some(expected) = expected(way) {
                wrong.extend(holds(what, way, &plain.written(way), &expected).err());
            }
        }
    };
    row("nothing", &plate(), &|_| Some(Made([25, 32, 1], &[])));
    row("torn by noise", &plate().torn(1e-6), &|way| {
        // Single precision has merged some of them.
        Some(Made([25, 32, 1], if has_own_corners(way) { &["near points of borders were merged"] } else { &[TORN] }))
    });
    let two = plate().and(Plain::plate(4, 6, 1.0));
    // Common corners and the middle; two and four nodes hang. What has no indices has merged the corners.
    row("sides with unlike nodes", &two, &|way| {
        Some(Made([25 + 35 - 3, 32 + 48 + 6, 1], if has_own_corners(way) { &[HUNG] } else { &[MERGED, HUNG] }))
    });
    let number = |words: &'static [&'static str]| move |_: Way| Some(Refused(words));
    row("no number", &plate().moved(7, [0.5, f64::NAN, 0.0]), &number(&[]));
    row("an infinite number", &plate().moved(7, [0.5, f64::INFINITY, 0.0]), &number(&[]));
    row("a point too far away", &plate().moved(7, [0.5, 1e31, 0.0]), &|way| {
        // Measured by that point, the others of glTF are one.
        let is_gltf = matches!(way, Way::Gltf | Way::Glb);
        Some(Refused(if is_gltf { &["no triangles"] } else { &["1e31", "1e30"] }))
    });
    // By its number in the file, and with its line where there are lines.
    row("a corner that is not there", &plate().triangle([0, 1, 999]), &|way| match way {
        Way::StlText | Way::StlBinary => None,
        Way::Obj | Way::Msh2 | Way::Msh4 | Way::Medit | Way::Inp => Some(Refused(&["1000", ", line "])),
        _ => Some(Refused(&["999"])),
    });
    row("a triangle twice", &plate().triangle([0, 1, 6]), &|_| {
        Some(Made([25, 32, 1], &["1 duplicate triangle was removed"]))
    });
    row("a triangle twice, the other way round", &plate().triangle([1, 0, 6]), &|_| {
        Some(Made([25, 32, 1], &["1 duplicate triangle was removed"]))
    });
    row("a triangle without area", &plate().triangle([0, 5, 10]), &|_| {
        Some(Made([25, 32, 1], &["1 degenerate triangle was removed"]))
    });
    row("a triangle of one point", &plate().triangle([3, 3, 3]), &|way| {
        // In glTF, strips turn by such triangles.
        let is_gltf = matches!(way, Way::Gltf | Way::Glb);
        Some(Made([25, 32, 1], if is_gltf { &[] } else { &["1 degenerate triangle was removed"] }))
    });
    row("a point of nothing", &plate().point([2.0, 2.0, 2.0]), &|way| {
        Some(Made([25, 32, 1], if way.is_stl() { &[] } else { &["1 unused point was removed"] }))
    });
    row("no triangles", &Plain { triangles: Vec::new(), ..plate() }, &|_| Some(Refused(&[])));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn counts_beyond_the_file_are_refused_before_they_take_memory_and_what_is_cut_off_is_told() {
    let plate = Plain::plate(4, 4, 0.0);
    let mut wrong: Vec<String> = Vec::new();
    for way in Way::ALL {
        let bytes = plate.written(way);
        // Each number that counts points or triangles, made huge.
        for (count, huge) in [("25", "4000000000"), ("32", "4000000000"), ("75", "4000000000"), ("96", "4000000000")] {
            let text = String::from_utf8_lossy(&bytes).into_owned();
            if way == Way::StlBinary {
                let mut bytes = bytes.clone();
                bytes[80..84].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
                wrong.extend(holds("a huge count", way, &bytes, &Refused(&[])).err());
                break;
            }
            let counts = match way {
                Way::PlyText | Way::PlyBinary => {
                    [format!("element vertex {count}\n"), format!("element face {count}\n")]
                }
                Way::Msh2 | Way::Medit => [format!("\n{count}\n"), String::from("?")],
                Way::Msh4 => [format!("\n2 1 0 {count}\n"), format!("\n2 1 2 {count}\n")],
                // The totals of VTK are not needed: the arrays have their lengths.
                Way::Gltf => [format!("\"count\":{count},"), String::from("?")],
                _ => continue,
            };
            for header in counts.iter().filter(|header| text.contains(*header)) {
                let at = bytes.windows(header.len()).position(|own| own == header.as_bytes()).unwrap();
                let longer = header.replace(count, huge);
                let bytes = [&bytes[..at], longer.as_bytes(), &bytes[at + header.len()..]].concat();
                wrong.extend(holds(header.trim(), way, &bytes, &Refused(&[])).err());
            }
        }
        wrong.extend(holds("nothing", way, b"", &Refused(&["empty"])).err());
        wrong.extend(holds("blanks", way, b" \n\r\n ", &Refused(&["empty"])).err());
        // Under every other name: refused with the name, without a panic.
        let is_gltf = |way: Way| matches!(way, Way::Gltf | Way::Glb);
        for other in Way::ALL.into_iter().filter(|other| other.format() != way.format()) {
            // Both forms of glTF say themselves which they are.
            if is_gltf(way) && is_gltf(other) {
                continue;
            }
            if let Ok(found) = made(other, &bytes) {
                wrong.push(format!("{way:?} is read as {other:?}: {found:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
