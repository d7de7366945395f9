//! Readers of what is written, made from the formats' own documents and of nothing of ours: they know no more of a
//! format than a mesh of lines, triangles and quadrilaterals needs, and take every departure from it for a failure.
//!
//! Gmsh's reference manual, "MSH file format version 2 (Legacy)"; Frey, "Medit: an interactive mesh visualization
//! software" (INRIA RT-0253, 2001); Abaqus's keyword reference, NODE, ELEMENT, ELSET and SURFACE.

use std::collections::BTreeMap;

/// A mesh as a reader sees it: points by index, faces and lines each with the name (or number) of its group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    pub points: Vec<[f64; 3]>,
    pub lines: Vec<([u32; 2], String)>,
    pub faces: Vec<(Vec<u32>, String)>,
}

impl Seen {
    /// Takes an element by its corners.
    pub fn add(&mut self, corners: &[u32], group: &str) {
        match *corners {
            [a, b] => self.lines.push(([a, b], group.to_owned())),
            _ => self.faces.push((corners.to_vec(), group.to_owned())),
        }
    }
}

fn number<T: std::str::FromStr>(word: &str) -> T {
    word.parse().unwrap_or_else(|_| panic!("\"{word}\" is no such number"))
}

/// The lines between `$Section` and `$EndSection`.
fn section<'t>(text: &'t str, name: &str) -> Vec<&'t str> {
    let (_, rest) = text.split_once(&format!("${name}\n")).unwrap();
    rest.split_once(&format!("$End{name}")).unwrap().0.lines().collect()
}

/// The names of the physical groups of an MSH file, by dimension and tag.
pub fn physical_names(text: &str) -> BTreeMap<(i32, i32), String> {
    let lines = section(text, "PhysicalNames");
    assert_eq!(number::<usize>(lines[0]) + 1, lines.len());
    let named = |line: &&str| {
        let (head, name) = line.split_once('"').unwrap();
        let [dimension, tag] = *head.split(' ').filter(|word| !word.is_empty()).collect::<Vec<_>>() else { panic!() };
        ((number(dimension), number(tag)), name.strip_suffix('"').unwrap().to_owned())
    };
    lines[1..].iter().map(named).collect()
}

/// MSH 2.2 as text.
pub fn msh_2(text: &str) -> Seen {
    assert_eq!(section(text, "MeshFormat"), ["2.2 0 8"]);
    let names = physical_names(text);
    let mut seen = Seen::default();
    let nodes = section(text, "Nodes");
    assert_eq!(number::<usize>(nodes[0]) + 1, nodes.len());
    let mut at: BTreeMap<u64, u32> = BTreeMap::new();
    for line in &nodes[1..] {
        let [tag, x, y, z] = *line.split(' ').collect::<Vec<_>>() else { panic!("{line}") };
        at.insert(number(tag), seen.points.len() as u32);
        seen.points.push([x, y, z].map(number));
    }
    let elements = section(text, "Elements");
    assert_eq!(number::<usize>(elements[0]) + 1, elements.len());
    for line in &elements[1..] {
        let words: Vec<&str> = line.split(' ').collect();
        // elm-number elm-type number-of-tags < tag > ... node-number-list; the first tag is the physical entity.
        let tags: usize = number(words[2]);
        assert!(tags >= 2);
        let (dimension, count) = match words[1] {
            "1" => (1, 2),
            "2" => (2, 3),
            "3" => (2, 4),
            other => panic!("element type {other}"),
        };
        let corners: Vec<u32> = words[3 + tags..].iter().map(|word| at[&number::<u64>(word)]).collect();
        assert_eq!(corners.len(), count);
        let group = names.get(&(dimension, number(words[3]))).map_or("", |name| name.as_str());
        seen.add(&corners, group);
    }
    seen
}

/// Medit's text format; groups are references.
pub fn medit(text: &str) -> Seen {
    let mut words = text.split_ascii_whitespace();
    assert_eq!([words.next(), words.next()], [Some("MeshVersionFormatted"), Some("2")]);
    assert_eq!(words.next(), Some("Dimension"));
    let dimension: usize = number(words.next().unwrap());
    let mut seen = Seen::default();
    loop {
        let corners = match words.next().unwrap() {
            "Vertices" => {
                for _ in 0..number::<usize>(words.next().unwrap()) {
                    let mut p = [0.0; 3];
                    p[..dimension].iter_mut().for_each(|x| *x = number(words.next().unwrap()));
                    words.next().unwrap();
                    seen.points.push(p);
                }
                continue;
            }
            "Edges" => 2,
            "Triangles" => 3,
            "Quadrilaterals" => 4,
            "End" => break,
            other => panic!("keyword {other}"),
        };
        for _ in 0..number::<usize>(words.next().unwrap()) {
            let corners: Vec<u32> = (0..corners).map(|_| number::<u32>(words.next().unwrap()) - 1).collect();
            seen.add(&corners, words.next().unwrap());
        }
    }
    assert_eq!(words.next(), None);
    seen
}

/// Medit's metric: the components of each vertex.
pub fn sol(text: &str) -> Vec<Vec<f64>> {
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    let ["MeshVersionFormatted", "2", "Dimension", dimension, "SolAtVertices", count, "1", "3", ref rest @ .., "End"] =
        words[..]
    else {
        panic!("{text}")
    };
    let components = if dimension == "2" { 3 } else { 6 };
    assert_eq!(rest.len(), components * number::<usize>(count));
    rest.chunks(components).map(|tensor| tensor.iter().map(|word| number(word)).collect()).collect()
}

/// An input file of Abaqus: shells, their sets, and surfaces of their edges, which are the lines.
pub fn abaqus(text: &str) -> Seen {
    let mut seen = Seen::default();
    let mut at: BTreeMap<u64, u32> = BTreeMap::new();
    let mut elements: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
    let mut sets: BTreeMap<u64, String> = BTreeMap::new();
    let mut keyword: Vec<&str> = Vec::new();
    for line in text.lines() {
        if let Some(line) = line.strip_prefix('*') {
            keyword = line.split(", ").collect();
            continue;
        }
        let fields: Vec<&str> = line.split(", ").collect();
        match keyword[..] {
            ["NODE"] => {
                let [tag, x, y, z] = *fields else { panic!("{line}") };
                at.insert(number(tag), seen.points.len() as u32);
                seen.points.push([x, y, z].map(number));
            }
            ["ELEMENT", kind] => {
                assert_eq!(fields.len() - 1, if kind == "TYPE=S3" { 3 } else { 4 }, "{kind}");
                elements.insert(number(fields[0]), fields[1..].iter().map(|word| at[&number::<u64>(word)]).collect());
            }
            ["ELSET", name] => {
                let name = name.strip_prefix("ELSET=").unwrap();
                assert!(fields.len() <= 16 && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'));
                fields.iter().for_each(|word| drop(sets.insert(number(word), name.to_owned())));
            }
            ["SURFACE", "TYPE=ELEMENT", name] => {
                let corners = &elements[&number::<u64>(fields[0])];
                let side: usize = number(fields[1].strip_prefix('E').unwrap());
                let ends = [corners[side - 1], corners[side % corners.len()]];
                seen.lines.push((ends, name.strip_prefix("NAME=").unwrap().to_owned()));
            }
            ["HEADING"] | ["NSET", _] => {}
            _ => panic!("{keyword:?}"),
        }
    }
    for (number, corners) in elements {
        let group = sets.get(&number).cloned().unwrap_or_default();
        seen.faces.push((corners, group));
    }
    seen
}
