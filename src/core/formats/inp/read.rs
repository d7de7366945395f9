//! Reading Abaqus input files.

use std::collections::BTreeMap;

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::core::fault::Fault;
use crate::core::formats::numbering::{Numbering, sort_by_number};
use crate::core::formats::scan::{Scanner, parse_whole, shown};
use crate::core::progress::Pace;
use crate::core::soup::groups::{Listed, by_region};
use crate::core::soup::{Count, Group, Members, MeshFile};

/// The number of corners of an Abaqus element type; 0 for a type that is skipped, `Err` for one of higher order.
fn corners_of(kind: &str) -> Result<usize, ()> {
    let shells = ["STRI", "S", "CPS", "CPE", "CPEG", "CAX", "M3D", "R3D", "SFM3D", "DS", "DC2D"];
    let lines = ["T2D", "T3D", "B2", "B3", "R2D", "RAX"];
    let digit = |prefix: &str| kind.strip_prefix(prefix)?.bytes().next().filter(u8::is_ascii_digit);
    match shells.into_iter().find_map(digit) {
        Some(b'3') => return Ok(3),
        Some(b'4') => return Ok(4),
        Some(_) => return Err(()),
        None => {}
    }
    match lines.into_iter().find_map(|prefix| Some((prefix, digit(prefix)?))) {
        None => Ok(0),
        Some((_, b'3') | ("B2" | "B3", b'2')) => Err(()),
        Some(_) => Ok(2),
    }
}

/// The section of the following data lines.
enum Section {
    Nodes,
    /// Elements with this number of corners, and their set.
    Elements(usize, Option<usize>),
    Skipped(String),
    /// The element numbers of a set; whether they are given as first, last and step (GENERATE).
    Set(usize, bool),
    /// Element edges of a surface.
    Surface(usize),
    Other,
}

/// Element sets and edge surfaces by name, in the order of the file.
#[derive(Default)]
struct Sets {
    sets: NamedLists<Run>,
    /// The sets to which sections of properties belong.
    regions: Vec<usize>,
    surfaces: NamedLists<(u64, usize)>,
}

/// Lists by name, ignoring case.
#[derive(Default)]
struct NamedLists<T> {
    all: Vec<(String, Vec<T>)>,
    known: FxHashMap<String, usize>,
}

/// The numbers from `first` to `last` in steps of `step`.
#[derive(Clone, Copy, Default)]
struct Run {
    first: u64,
    last: u64,
    step: u64,
}

/// Reads nodes and elements, sorted by their numbers. Element sets become groups: where those with sections of
/// properties cover all elements, they are the regions; else all that do not overlap (`soup::groups`), if the sets
/// cover all elements. Edge surfaces become groups of lines. Node sets, parts and everything else are ignored.
///
/// # Errors
/// With the line: a malformed node or element, an element of higher order, or a node number that is used twice.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes).watched(pace);
    let mut mesh = MeshFile::default();
    let (mut node_numbers, mut triangle_numbers, mut quad_numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut nodes: Option<Numbering> = None;
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    let mut section = Section::Other;
    let mut sets = Sets::default();
    let mut any = false;
    while let Some(line) = s.line() {
        if line.is_empty() || line.starts_with(b"**") {
            continue;
        }
        if let Some(keyword) = line.strip_prefix(b"*") {
            section = keyword_line(&s, keyword, &mut sets)?;
            if matches!(section, Section::Elements(..)) && nodes.is_none() {
                nodes = Some(number(&s, &mut node_numbers, &mut mesh.points)?);
            }
            any = true;
            continue;
        }
        let mut fields = line.split(|&b| b == b',').map(<[u8]>::trim_ascii);
        match &section {
            Section::Nodes => {
                if nodes.is_some() {
                    return Err(s.fault("Nodes follow elements").remedy("Put all nodes first"));
                }
                node_numbers.push(whole(&s, fields.next(), "the number of a node")?);
                let mut p = DVec3::ZERO;
                for axis in 0..3 {
                    // In Abaqus, a missing coordinate is zero.
                    p[axis] = s.coordinate(fields.next().filter(|word| !word.is_empty()).unwrap_or(b"0"))?;
                }
                mesh.points.push(p);
            }
            Section::Elements(count, set) => {
                let number = whole(&s, fields.next(), "the number of an element")?;
                if let Some(set) = set {
                    sets.sets.all[*set].1.push(Run { first: number, last: number, step: 1 });
                }
                let mut corners = [0; 4];
                for corner in &mut corners[..*count] {
                    let node = whole(&s, fields.next(), "a node of the element")?;
                    *corner = nodes.as_ref().and_then(|nodes| nodes.index(node)).ok_or_else(|| {
                        s.fault(format!("Element {number} refers to node {node}, which does not exist"))
                    })?;
                }
                match *count {
                    2 => mesh.lines.push([corners[0], corners[1]]),
                    3 => {
                        mesh.triangles.push([corners[0], corners[1], corners[2]]);
                        triangle_numbers.push(number);
                    }
                    _ => {
                        mesh.quads.push(corners);
                        quad_numbers.push(number);
                    }
                }
            }
            Section::Skipped(kind) => match skipped.get_mut(kind) {
                Some(count) => *count += 1,
                None => drop(skipped.insert(kind.clone(), 1)),
            },
            Section::Set(set, generated) => {
                // Names of other sets are ignored.
                let numbers: Vec<u64> = fields.filter_map(parse_whole).collect();
                let runs = &mut sets.sets.all[*set].1;
                match numbers[..] {
                    [first, last, ref rest @ ..] if *generated => {
                        runs.push(Run { first, last, step: rest.first().copied().unwrap_or(1) });
                    }
                    _ => runs.extend(numbers.into_iter().map(|number| Run { first: number, last: number, step: 1 })),
                }
            }
            Section::Surface(surface) => {
                let side = |word: &[u8]| match word {
                    [b'E' | b'e', k @ b'1'..=b'4'] => Some(usize::from(k - b'1')),
                    _ => None,
                };
                let [element, side] = [fields.next(), fields.next()]
                    .map(Option::unwrap_or_default)
                    .map(|word| (parse_whole(word), side(word)));
                if let (Some(element), Some(side)) = (element.0, side.1) {
                    sets.surfaces.all[*surface].1.push((element, side));
                }
            }
            Section::Other => {}
        }
    }
    if !any {
        return Err(Fault::new("There is no keyword line (*NODE, ...)")
            .at(name)
            .remedy("Check that it is an Abaqus input file"));
    }
    if nodes.is_none() {
        number(&s, &mut node_numbers, &mut mesh.points)?;
    }
    sort_by_number(&mut triangle_numbers, &mut mesh.triangles, &mut []);
    sort_by_number(&mut quad_numbers, &mut mesh.quads, &mut []);
    mesh.counting.shared = true;
    mesh.counting.points = Count::of(&node_numbers);
    (mesh.counting.triangles, mesh.counting.quads) = (Count::of(&triangle_numbers), Count::of(&quad_numbers));
    sets.into_groups(&mut mesh, &triangle_numbers, &quad_numbers);
    mesh.skipped = skipped.into_iter().collect();
    Ok(mesh)
}

impl Sets {
    /// Adds groups for the sets with triangles or quadrilaterals and for the surfaces with edges of these.
    fn into_groups(self, mesh: &mut MeshFile, triangle_numbers: &[u64], quad_numbers: &[u64]) {
        let triangles = triangle_numbers.len();
        let mut numbers: Vec<(u64, usize)> = triangle_numbers.iter().chain(quad_numbers).copied().zip(0..).collect();
        numbers.sort_unstable();
        let from = |number: u64| numbers.partition_point(|known| known.0 < number);
        let index = |number: u64| numbers.get(from(number)).filter(|known| known.0 == number).map(|known| known.1);
        // Bounds the time for runs that repeat.
        let mut left = 16 * numbers.len();
        let mut listed: Vec<Listed> = Vec::new();
        for (set, (name, runs)) in self.sets.all.iter().enumerate() {
            let mut elements: Vec<u32> = Vec::new();
            for run in runs {
                let all = numbers[from(run.first)..].iter().take_while(|known| known.0 <= run.last);
                for known in all.take(left) {
                    left -= 1;
                    if (known.0 - run.first).is_multiple_of(run.step.max(1)) {
                        elements.push(known.1 as u32);
                    }
                }
            }
            elements.sort_unstable();
            elements.dedup();
            if !elements.is_empty() {
                let tag = set as u32 + 1;
                mesh.groups.push(Group { dimension: 2, tag, name: name.clone() });
                listed.push(Listed { tag, elements, used: self.regions.contains(&set) });
            }
        }
        // Sets are regions where they cover all elements: else they are for loads, output and the like.
        let covers = |listed: &[Listed], used: bool| {
            let mut is_in = vec![false; numbers.len()];
            let elements = listed.iter().filter(|set| set.used || !used).flat_map(|set| &set.elements);
            elements.for_each(|&element| is_in[element as usize] = true);
            is_in.iter().all(|&is_in| is_in)
        };
        if !covers(&listed, true) {
            listed.iter_mut().for_each(|set| set.used = false);
        }
        let (mut tags, members) = if covers(&listed, false) {
            by_region(listed, numbers.len(), 2)
        } else {
            let members = |set: Listed| Members { dimension: 2, tag: set.tag, of: set.elements };
            (Vec::new(), listed.into_iter().map(members).collect())
        };
        mesh.members = members;
        if tags.iter().any(|tag| *tag != 0) {
            mesh.quad_tags = tags.split_off(triangles);
            mesh.triangle_tags = tags;
        }
        let lines = mesh.lines.len();
        for ((name, sides), tag) in self.surfaces.all.into_iter().zip(1..) {
            let before = mesh.lines.len();
            for (element, side) in sides.into_iter().filter_map(|(number, side)| Some((index(number)?, side))) {
                let corners = match element.checked_sub(triangles) {
                    None => &mesh.triangles[element][..],
                    Some(quad) => &mesh.quads[quad][..],
                };
                if side < corners.len() {
                    mesh.lines.push([corners[side], corners[(side + 1) % corners.len()]]);
                }
            }
            if mesh.lines.len() > before {
                mesh.line_tags.resize(before, 0);
                mesh.line_tags.resize(mesh.lines.len(), tag);
                mesh.groups.push(Group { dimension: 1, tag, name });
            }
        }
        if mesh.lines.len() == lines {
            mesh.line_tags.clear();
        }
        mesh.groups.sort_by_key(|group| (group.dimension, group.tag));
    }
}

/// Sorts the points by their numbers, which must be unique.
fn number(s: &Scanner, numbers: &mut [u64], points: &mut [DVec3]) -> Result<Numbering, Fault> {
    sort_by_number(numbers, points, &mut []);
    Numbering::new(numbers).map_err(|number| {
        s.fault(format!("The node number {number} is used twice above"))
            .remedy("Parts and instances are not supported: save one flat mesh")
    })
}

fn whole(s: &Scanner, field: Option<&[u8]>, what: &str) -> Result<u64, Fault> {
    let word = field.unwrap_or_default();
    parse_whole(word).ok_or_else(|| s.unexpected(word, what))
}

/// The section that a keyword line begins.
fn keyword_line(s: &Scanner, line: &[u8], sets: &mut Sets) -> Result<Section, Fault> {
    let text = String::from_utf8_lossy(line);
    let mut parts = text.split(',').map(str::trim);
    let keyword = parts.next().unwrap_or_default().to_ascii_uppercase();
    let options: Vec<(String, &str)> = parts
        .map(|part| part.split_once('=').unwrap_or((part, "")))
        .map(|(key, value)| (key.trim().to_ascii_uppercase(), value.trim().trim_matches('"')))
        .collect();
    let option = |key: &str| options.iter().find(|option| option.0 == key).map(|option| option.1);
    match keyword.as_str() {
        "NODE" => Ok(Section::Nodes),
        "ELEMENT" => {
            let kind = option("TYPE").filter(|kind| !kind.is_empty()).ok_or_else(|| s.fault("*ELEMENT has no TYPE"))?;
            let kind = shown(kind.to_ascii_uppercase().as_bytes());
            match corners_of(&kind) {
                Ok(0) => Ok(Section::Skipped(format!("element {kind}"))),
                Ok(count) => Ok(Section::Elements(count, option("ELSET").map(|name| sets.sets.index(name)))),
                Err(()) => Err(s
                    .fault(format!("Elements of type {kind} are not supported"))
                    .remedy("Save the mesh with elements of order 1 (S3, S4)")),
            }
        }
        "ELSET" => Ok(match option("ELSET") {
            Some(name) => Section::Set(sets.sets.index(name), option("GENERATE").is_some()),
            None => Section::Other,
        }),
        section if section.ends_with(" SECTION") => {
            let set = option("ELSET").map(|name| sets.sets.index(name));
            sets.regions.extend(set);
            Ok(Section::Other)
        }
        // The default type is ELEMENT.
        "SURFACE" => Ok(match (option("NAME"), option("TYPE")) {
            (Some(name), kind) if kind.is_none_or(|kind| kind.eq_ignore_ascii_case("ELEMENT")) => {
                Section::Surface(sets.surfaces.index(name))
            }
            _ => Section::Other,
        }),
        _ => Ok(Section::Other),
    }
}

impl<T> NamedLists<T> {
    /// The index of a list, which is added if the name is new.
    fn index(&mut self, name: &str) -> usize {
        let new = self.all.len();
        let index = *self.known.entry(name.to_ascii_uppercase()).or_insert(new);
        if index == new {
            self.all.push((name.to_owned(), Vec::new()));
        }
        index
    }
}
