//! Reading Abaqus input files.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::core::fault::Fault;
use crate::core::formats::numbering::{Numbering, sort_by_number};
use crate::core::formats::scan::{Scanner, parse_whole, shown};
use crate::core::progress::Pace;
use crate::core::soup::groups::{Listed, by_region};
use crate::core::soup::second_order::Middles;
use crate::core::soup::{Count, Group, Members, MeshFile};

/// How the nodes of an element type are read.
#[derive(Clone, Copy)]
struct Shape {
    /// Nodes on an element's data lines.
    nodes: usize,
    /// The places of its corners among them.
    corners: &'static [usize],
}

/// The shape of an Abaqus element type; `None` for one that is not read. Of elements of order 2, the corners come
/// first; of lines, the node in the middle is the second one.
fn shape_of(kind: &str) -> Option<Shape> {
    let shells = ["STRI", "S", "CPS", "CPE", "CPEG", "CAX", "M3D", "R3D", "SFM3D", "DS", "DC2D"];
    let beams = ["B2", "B3"];
    let trusses = ["T2D", "T3D", "R2D", "RAX"];
    let digit = |prefix: &str| kind.strip_prefix(prefix)?.bytes().next().filter(u8::is_ascii_digit);
    let of = |nodes: usize, corners| Some(Shape { nodes, corners });
    if let Some(nodes) = shells.into_iter().find_map(digit) {
        return match nodes {
            b'3' => of(3, &[0, 1, 2]),
            b'4' => of(4, &[0, 1, 2, 3]),
            b'6' => of(6, &[0, 1, 2]),
            b'8' => of(8, &[0, 1, 2, 3]),
            b'9' => of(9, &[0, 1, 2, 3]),
            _ => None,
        };
    }
    match (beams.into_iter().find_map(digit), trusses.into_iter().find_map(digit)) {
        (Some(b'2'), _) | (_, Some(b'3')) => of(3, &[0, 2]),
        (Some(_), _) | (_, Some(b'2')) => of(2, &[0, 1]),
        _ => None,
    }
}

/// The section of the following data lines.
enum Section {
    Nodes,
    /// Elements of this shape, and their set.
    Elements(Shape, Option<usize>),
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
    /// The names of the sets of nodes.
    of_nodes: Vec<String>,
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
/// cover all elements. Edge surfaces become groups of lines. Of elements of order 2, the corners are read. Node sets,
/// parts and everything else are ignored, and told as not read.
///
/// # Errors
/// With the line: a malformed node or element, or a node number that is used twice.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes).watched(pace);
    let mut mesh = MeshFile::default();
    let (mut node_numbers, mut triangle_numbers, mut quad_numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut nodes: Option<Numbering> = None;
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    let mut section = Section::Other;
    let mut sets = Sets::default();
    let mut middles = Middles::default();
    let mut any = false;
    // Whether the previous data line goes on.
    let mut goes_on = false;
    while let Some(line) = line(&mut s) {
        if let Some(keyword) = line.strip_prefix(b"*") {
            // Data that follow a surplus comma are no part of the keyword line.
            let is_part = |_: &[u8], next: &[u8]| next[0].is_ascii_alphabetic();
            let keyword = continued(&mut s, keyword, is_part);
            section = keyword_line(&s, &keyword, &mut sets, &mut mesh)?;
            goes_on = false;
            if matches!(section, Section::Elements(..)) && nodes.is_none() {
                nodes = Some(number(&s, &mut node_numbers, &mut mesh.points)?);
            }
            any = true;
            continue;
        }
        let line = match &section {
            Section::Elements(shape, _) => continued(&mut s, line, |so_far, next| {
                next[0] != b'*' && so_far.iter().filter(|&&b| b == b',').count() <= shape.nodes
            }),
            _ => Cow::Borrowed(line),
        };
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
            Section::Elements(shape, set) => {
                let number = whole(&s, fields.next(), "the number of an element")?;
                if let Some(set) = set {
                    sets.sets.all[*set].1.push(Run { first: number, last: number, step: 1 });
                }
                let mut of_element = [0; 9];
                for slot in &mut of_element[..shape.nodes] {
                    let node = whole(&s, fields.next(), "a node of the element")?;
                    *slot = nodes.as_ref().and_then(|nodes| nodes.index(node)).ok_or_else(|| {
                        s.fault(format!("Element {number} refers to node {node}, which does not exist"))
                    })?;
                }
                let corners: SmallVec<[u32; 4]> = shape.corners.iter().map(|&place| of_element[place]).collect();
                let others = (0..shape.nodes).filter(|place| !shape.corners.contains(place));
                middles.add(&corners, &others.map(|place| of_element[place]).collect::<SmallVec<[u32; 5]>>());
                match *corners {
                    [a, b] => mesh.lines.push([a, b]),
                    [a, b, c] => {
                        mesh.triangles.push([a, b, c]);
                        triangle_numbers.push(number);
                    }
                    [a, b, c, d, ..] => {
                        mesh.quads.push([a, b, c, d]);
                        quad_numbers.push(number);
                    }
                    _ => {}
                }
            }
            Section::Skipped(kind) => {
                match skipped.get_mut(kind) {
                    Some(count) => *count += usize::from(!goes_on),
                    None => drop(skipped.insert(kind.clone(), 1)),
                }
                goes_on = line.ends_with(b",");
            }
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
    middles.leave(&mut mesh);
    Ok(mesh)
}

/// The next line that is not a comment.
fn line<'a>(s: &mut Scanner<'a>) -> Option<&'a [u8]> {
    loop {
        let line = s.filled_line()?;
        if !line.starts_with(b"**") {
            return Some(line);
        }
    }
}

/// A line with the lines that continue it: while it ends with a comma and `is_part` says so of the next line.
fn continued<'a>(s: &mut Scanner<'a>, line: &'a [u8], is_part: impl Fn(&[u8], &[u8]) -> bool) -> Cow<'a, [u8]> {
    let mut whole = Cow::Borrowed(line);
    while whole.ends_with(b",") {
        let mut ahead = s.clone();
        let Some(next) = self::line(&mut ahead).filter(|next| is_part(&whole, next)) else { break };
        whole.to_mut().extend(next);
        *s = ahead;
    }
    whole
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
            if elements.is_empty() {
                mesh.omit("set without triangles and quadrilaterals:", name);
            } else {
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
        // The nodes of lines may be a set besides.
        for name in self.of_nodes.iter().filter(|name| !self.surfaces.known.contains_key(&name.to_ascii_uppercase())) {
            mesh.omit("node set", name);
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
            } else {
                mesh.omit("surface", &name);
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
fn keyword_line(s: &Scanner, line: &[u8], sets: &mut Sets, mesh: &mut MeshFile) -> Result<Section, Fault> {
    let text = String::from_utf8_lossy(line);
    let mut parts = text.split(',').map(str::trim);
    let keyword = parts.next().unwrap_or_default().to_ascii_uppercase();
    let options: Vec<(String, &str)> = parts
        .map(|part| part.split_once('=').unwrap_or((part, "")))
        .map(|(key, value)| (key.trim().to_ascii_uppercase(), value.trim().trim_matches('"')))
        .collect();
    let option = |key: &str| options.iter().find(|option| option.0 == key).map(|option| option.1);
    match keyword.as_str() {
        "NODE" => {
            sets.of_nodes.extend(option("NSET").map(str::to_owned));
            Ok(Section::Nodes)
        }
        "ELEMENT" => {
            let kind = option("TYPE").filter(|kind| !kind.is_empty()).ok_or_else(|| s.fault("*ELEMENT has no TYPE"))?;
            let kind = shown(kind.to_ascii_uppercase().as_bytes());
            Ok(match shape_of(&kind) {
                None => Section::Skipped(format!("element {kind}")),
                Some(shape) => Section::Elements(shape, option("ELSET").map(|name| sets.sets.index(name))),
            })
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
            (name, _) => {
                mesh.omit("surface", name.unwrap_or("without a name"));
                Section::Other
            }
        }),
        "NSET" => {
            sets.of_nodes.extend(option("NSET").map(str::to_owned));
            Ok(Section::Other)
        }
        "HEADING" | "PREPRINT" => Ok(Section::Other),
        other => {
            if !other.starts_with("END ") {
                mesh.omit("keyword", &format!("*{other}"));
            }
            Ok(Section::Other)
        }
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
