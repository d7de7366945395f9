//! Reading MSH: one path for text and binary, and for both versions.

use std::collections::BTreeMap;

use glam::DVec3;

use super::groups::{Grouping, group_tag};
use super::input::Input;
use super::{Shape, shape};
use crate::core::fault::Fault;
use crate::core::formats::numbering::{Numbering, sort_by_number};
use crate::core::formats::scan::{ByteOrder, Scanner, TRUNCATED, shown};
use crate::core::progress::Pace;
use crate::core::soup::second_order::Middles;
use crate::core::soup::{Count, Group, MeshFile};

/// Reads a mesh from the bytes of an MSH file; `name` is the file's name in messages.
///
/// Points and elements are sorted by their tags in the file. The tag of an element is that of its physical group, 0
/// without one; where it is in several, that of its region (`soup::groups`), and the others have it as a member. Points
/// in physical groups are members of these. Node data named "metric" with nine components becomes the metric; data with
/// one component is kept if it covers every node, or every triangle and quadrilateral.
///
/// # Errors
/// With the line: anything that is not MSH 2.x or 4.1, and parts of MSH that are not supported (elements of order 3
/// and more).
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut reader = Reader {
        input: Input { scanner: Scanner::new(name, bytes).watched(pace), binary: None },
        version: None,
        file: MeshFile::default(),
        nodes: None,
        has_elements: false,
        grouping: Grouping::default(),
        middles: Middles::default(),
        numbers: Default::default(),
        elements: None,
        skipped: BTreeMap::new(),
    };
    while let Some(line) = reader.input.scanner.line() {
        if line.is_empty() {
            continue;
        }
        let Some(section) = line.strip_prefix(b"$") else {
            return Err(reader.input.scanner.unexpected(line, "a section (\"$Nodes\", ...)"));
        };
        reader.section(section)?;
    }
    let scanner = &reader.input.scanner;
    if reader.nodes.is_none() || !reader.has_elements {
        let missing = if reader.nodes.is_none() { "$Nodes" } else { "$Elements" };
        return Err(Fault::new(format!("There is no section {missing}"))
            .at(scanner.name())
            .remedy("Save it with nodes and elements"));
    }
    reader.file.skipped = reader.skipped.into_iter().map(|(name, count)| (name.to_string(), count)).collect();
    reader.middles.leave(&mut reader.file);
    Ok(reader.file)
}

/// The two versions with different sections.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

pub(super) struct Reader<'a> {
    pub input: Input<'a>,
    version: Option<Version>,
    pub file: MeshFile,
    /// Node tags to indices, once the nodes are read.
    pub nodes: Option<Numbering>,
    has_elements: bool,
    grouping: Grouping,
    middles: Middles,
    /// Element tags of lines, triangles and quadrilaterals.
    pub numbers: [Vec<u64>; 3],
    /// Element tags to indices (triangles first), built on demand; the inner `None` means that tags are not unique.
    pub elements: Option<Option<Numbering>>,
    skipped: BTreeMap<&'static str, usize>,
}

impl Reader<'_> {
    fn fault(&self, what: impl Into<String>) -> Fault {
        self.input.scanner.fault(what)
    }

    fn section(&mut self, section: &[u8]) -> Result<(), Fault> {
        if section == b"MeshFormat" {
            self.format()?;
            return self.end(section);
        }
        let Some(version) = self.version else {
            if section == b"Comments" {
                return self.skip(section);
            }
            return Err(self
                .fault(format!("The section \"${}\" precedes $MeshFormat", shown(section)))
                .remedy("Save it as MSH 2.2 or 4.1"));
        };
        match (section, version) {
            (b"PhysicalNames", _) => self.physical_names()?,
            (b"Entities", Version::Four) => self.entities()?,
            (b"Nodes", _) => self.nodes(version)?,
            (b"Elements", _) => self.elements(version)?,
            (b"ParametricNodes", _) => {
                let fault = self.fault("Nodes with parametric coordinates are not supported in this version");
                return Err(fault.remedy("Save it without them (in Gmsh: Mesh.SaveParametric = 0), or as MSH 4.1"));
            }
            (b"NodeData" | b"ElementData", _) if self.has_elements => return self.data(section),
            (b"Comments", _) => return self.skip(section),
            _ => {
                self.file.omit("section", &format!("${}", shown(section)));
                return self.skip(section);
            }
        }
        self.end(section)
    }

    /// Moves past a section that is not read.
    pub fn skip(&mut self, section: &[u8]) -> Result<(), Fault> {
        let start = self.input.scanner.mark();
        let end = [b"$End", section].concat();
        if !self.input.scanner.skip_past(&end) {
            let what = format!("The section \"${}\" has no end", shown(section));
            return Err(self.input.scanner.fault_at(start, what).remedy(TRUNCATED));
        }
        self.input.scanner.line();
        Ok(())
    }

    /// Reads the end of a section.
    pub fn end(&mut self, section: &[u8]) -> Result<(), Fault> {
        let end = format!("$End{}", shown(section));
        let word = self.input.scanner.need(&end)?;
        if word != end.as_bytes() {
            return Err(self
                .input
                .scanner
                .unexpected(word, &end)
                .remedy("The counts of this section do not match its contents"));
        }
        self.input.scanner.line();
        Ok(())
    }

    fn format(&mut self) -> Result<(), Fault> {
        let scanner = &mut self.input.scanner;
        if self.version.is_some() {
            return Err(scanner.fault("There are two sections $MeshFormat"));
        }
        let version = scanner.need("a version")?;
        self.version = Some(match version {
            b"4.1" => Version::Four,
            b"2" | b"2.0" | b"2.1" | b"2.2" => Version::Two,
            _ => {
                let what = format!("MSH version {} is not supported", shown(version));
                return Err(scanner.fault(what).remedy("Save it as MSH 4.1 or 2.2"));
            }
        });
        let binary = scanner.whole("the file type (0 text, 1 binary)")?;
        let size = scanner.whole("the size of a number")?;
        scanner.line();
        if binary > 1 || size != 8 {
            return Err(scanner.fault(format!("File type {binary} with numbers of {size} bytes is not supported")));
        }
        if binary == 1 {
            scanner.set_binary();
            self.input.binary = match i32::from_le_bytes(scanner.take(ByteOrder::Little, "the byte order")?) {
                1 => Some(ByteOrder::Little),
                0x0100_0000 => Some(ByteOrder::Big),
                other => return Err(scanner.fault(format!("The byte order mark is {other} instead of 1"))),
            };
        }
        Ok(())
    }

    fn physical_names(&mut self) -> Result<(), Fault> {
        let scanner = &mut self.input.scanner;
        let count = scanner.count("a number of names", 6)?;
        for _ in 0..count {
            let dimension = scanner.whole("a dimension")?;
            let tag = scanner.whole("a physical tag")?;
            let name = scanner.line().unwrap_or_default();
            let name = name.strip_prefix(b"\"").and_then(|name| name.strip_suffix(b"\"")).unwrap_or(name);
            let Ok(tag) = u32::try_from(tag) else {
                return Err(scanner.fault(format!("The physical tag {tag} is too large")));
            };
            let name = String::from_utf8_lossy(name).into_owned();
            if dimension >= 3 {
                self.file.omit("group of volumes", &format!("\"{name}\""));
            } else {
                self.file.groups.push(Group { dimension: dimension as u8, tag, name });
            }
        }
        Ok(())
    }

    /// Version 4: the physical groups of the entities.
    fn entities(&mut self) -> Result<(), Fault> {
        let mut counts = [0; 4];
        for count in &mut counts {
            let read = self.input.size("a number of entities")?;
            *count = self.input.fits(read, 10, 36, "a number of entities")?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = self.input.int("the tag of an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    self.input.real("the box of an entity")?;
                }
                let groups = self.input.size("a number of physical tags")?;
                for _ in 0..self.input.fits(groups, 2, 4, "a number of physical tags")? {
                    // The sign is the orientation of the entity in the group.
                    let group = self.input.int("a physical tag")?.unsigned_abs();
                    self.grouping.add((dimension, tag), group);
                }
                if dimension > 0 {
                    let bounds = self.input.size("a number of bounding entities")?;
                    for _ in 0..self.input.fits(bounds, 2, 4, "a number of bounding entities")? {
                        self.input.int("the tag of a bounding entity")?;
                    }
                }
            }
        }
        Ok(())
    }

    fn nodes(&mut self, version: Version) -> Result<(), Fault> {
        let start = self.input.scanner.mark();
        if self.nodes.is_some() {
            return Err(self.fault("There are two sections $Nodes").remedy("Save it unpartitioned, as one mesh"));
        }
        let mut numbers = Vec::new();
        match version {
            Version::Two => {
                let count = self.input.count_line(8, 28, "a number of nodes")?;
                numbers.reserve_exact(count);
                self.file.points.reserve_exact(count);
                for _ in 0..count {
                    numbers.push(self.input.tag("the number of a node")?);
                    self.point()?;
                }
            }
            Version::Four => {
                let blocks = self.input.size("a number of blocks")?;
                let total = self.input.size("a number of nodes")?;
                let total = self.input.fits(total, 8, 32, "a number of nodes")?;
                self.input.size("the smallest node tag")?;
                self.input.size("the largest node tag")?;
                numbers.reserve_exact(total);
                self.file.points.reserve_exact(total);
                for _ in 0..blocks {
                    self.node_block(total, &mut numbers)?;
                }
                if numbers.len() != total {
                    let what = format!("The section declares {total} nodes but contains {}", numbers.len());
                    return Err(self.input.scanner.fault_at(start, what));
                }
            }
        }
        sort_by_number(&mut numbers, &mut self.file.points, &mut []);
        self.file.counting.points = Count::of(&numbers);
        let numbering = Numbering::new(&numbers)
            .map_err(|number| self.input.scanner.fault_at(start, format!("The node number {number} is used twice")))?;
        self.nodes = Some(numbering);
        Ok(())
    }

    fn node_block(&mut self, total: usize, numbers: &mut Vec<u64>) -> Result<(), Fault> {
        let dimension = self.input.int("the dimension of a block")?;
        self.input.int("the entity of a block")?;
        let parametric = self.input.int("0 or 1 (parametric)")? != 0;
        let count = self.input.size("a number of nodes")?;
        let count = self.input.fits(count, 8, 32, "a number of nodes")?;
        if numbers.len() + count > total {
            return Err(self.fault(format!("The section contains more than the declared {total} nodes")));
        }
        for _ in 0..count {
            numbers.push(self.input.size("the tag of a node")?);
        }
        for _ in 0..count {
            self.point()?;
            for _ in 0..if parametric { dimension.clamp(0, 3) } else { 0 } {
                self.input.real("a parametric coordinate")?;
            }
        }
        Ok(())
    }

    fn point(&mut self) -> Result<(), Fault> {
        let x = self.input.finite("a coordinate")?;
        let y = self.input.finite("a coordinate")?;
        let z = self.input.finite("a coordinate")?;
        self.file.points.push(DVec3::new(x, y, z));
        Ok(())
    }

    fn elements(&mut self, version: Version) -> Result<(), Fault> {
        if self.has_elements || self.nodes.is_none() {
            let what = if self.has_elements { "There are two sections $Elements" } else { "$Elements precedes $Nodes" };
            return Err(self.fault(what).remedy("Save it unpartitioned, as one mesh"));
        }
        let start = self.input.scanner.mark();
        let mut found = 0u64;
        let total = match (version, self.input.binary) {
            (Version::Two, None) => {
                let total = self.input.count_line(8, 8, "a number of elements")? as u64;
                while found < total {
                    let number = self.input.tag("the number of an element")?;
                    let kind = self.input.int("an element type")?;
                    let group = self.tags_of_version_2(None)?;
                    self.element(kind, number, group)?;
                    found += 1;
                }
                total
            }
            (Version::Two, Some(_)) => {
                let total = self.input.count_line(8, 8, "a number of elements")? as u64;
                while found < total {
                    let kind = self.input.int("an element type")?;
                    let count = self.input.tag("a number of elements")?;
                    let tags = self.input.tag("a number of tags")?;
                    for _ in 0..self.input.fits(count, 8, 8, "a number of elements")? {
                        let number = self.input.tag("the number of an element")?;
                        let group = self.tags_of_version_2(Some(tags))?;
                        self.element(kind, number, group)?;
                    }
                    found += count;
                }
                total
            }
            (Version::Four, _) => {
                let blocks = self.input.size("a number of blocks")?;
                let total = self.input.size("a number of elements")?;
                self.input.size("the smallest element tag")?;
                self.input.size("the largest element tag")?;
                for _ in 0..blocks {
                    let dimension = self.input.int("the dimension of a block")?;
                    let entity = self.input.int("the entity of a block")?;
                    let group = self.grouping.tag((dimension, entity));
                    let kind = self.input.int("an element type")?;
                    let count = self.input.size("a number of elements")?;
                    for _ in 0..self.input.fits(count, 4, 16, "a number of elements")? {
                        let number = self.input.size("the tag of an element")?;
                        self.element(kind, number, group)?;
                    }
                    found += count;
                }
                total
            }
        };
        if found != total {
            let what = format!("The section declares {total} elements but contains {found}");
            return Err(self.input.scanner.fault_at(start, what));
        }
        let [lines, triangles, quads] = &mut self.numbers;
        let file = &mut self.file;
        sort_by_number(lines, &mut file.lines, &mut file.line_tags);
        sort_by_number(triangles, &mut file.triangles, &mut file.triangle_tags);
        sort_by_number(quads, &mut file.quads, &mut file.quad_tags);
        file.counting.shared = true;
        (file.counting.triangles, file.counting.quads) = (Count::of(triangles), Count::of(quads));
        std::mem::take(&mut self.grouping).assign(&mut self.file);
        self.file.clear_zero_tags();
        self.has_elements = true;
        Ok(())
    }

    /// Reads the tags of an element of version 2; returns the first, its physical group. Their number, unless known
    /// from the block, precedes them.
    fn tags_of_version_2(&mut self, known: Option<u64>) -> Result<u32, Fault> {
        let count = match known {
            Some(count) => count,
            None => self.input.tag("a number of tags")?,
        };
        let mut group = 0;
        for place in 0..self.input.fits(count, 2, 4, "a number of tags")? {
            let tag = self.input.int("a tag")?.unsigned_abs();
            if place == 0 {
                group = group_tag(tag).unwrap_or(0);
            }
        }
        Ok(group)
    }

    fn element(&mut self, kind: i64, number: u64, group: u32) -> Result<(), Fault> {
        let Some(shape) = shape(kind) else {
            return Err(self.fault(format!("Unknown element type {kind}")));
        };
        let lists_again = self.version == Some(Version::Two);
        match shape {
            Shape::Point => {
                let [point] = self.corners()?;
                self.grouping.points.push((point, group));
            }
            Shape::Line(others) => {
                let corners = self.corners()?;
                self.others(&corners, others)?;
                let MeshFile { lines, line_tags, .. } = &mut self.file;
                if !self.grouping.takes(lists_again && lines.last() == Some(&corners), line_tags, group) {
                    lines.push(corners);
                    line_tags.push(group);
                    self.numbers[0].push(number);
                }
            }
            Shape::Triangle(others) => {
                let corners = self.corners()?;
                self.others(&corners, others)?;
                let MeshFile { triangles, triangle_tags, .. } = &mut self.file;
                if !self.grouping.takes(lists_again && triangles.last() == Some(&corners), triangle_tags, group) {
                    triangles.push(corners);
                    triangle_tags.push(group);
                    self.numbers[1].push(number);
                }
            }
            Shape::Quad(others) => {
                let corners = self.corners()?;
                self.others(&corners, others)?;
                let MeshFile { quads, quad_tags, .. } = &mut self.file;
                if !self.grouping.takes(lists_again && quads.last() == Some(&corners), quad_tags, group) {
                    quads.push(corners);
                    quad_tags.push(group);
                    self.numbers[2].push(number);
                }
            }
            Shape::HigherOrder => {
                return Err(self
                    .fault(format!("Elements of order 3 or more (type {kind}) are not supported"))
                    .remedy("Save the mesh with elements of order 1 or 2 (in Gmsh: Mesh.ElementOrder = 2)"));
            }
            Shape::Volume(name, nodes) => {
                for _ in 0..nodes {
                    self.node()?;
                }
                *self.skipped.entry(name).or_default() += 1;
            }
        }
        Ok(())
    }

    fn corners<const N: usize>(&mut self) -> Result<[u32; N], Fault> {
        let mut corners = [0; N];
        for corner in &mut corners {
            *corner = self.node()?;
        }
        Ok(corners)
    }

    /// Reads the nodes of an element of order 2 after its corners.
    fn others(&mut self, corners: &[u32], count: usize) -> Result<(), Fault> {
        let mut nodes = [0; 5];
        for node in &mut nodes[..count] {
            *node = self.node()?;
        }
        self.middles.add(corners, &nodes[..count]);
        Ok(())
    }

    /// The index of a node of an element.
    fn node(&mut self) -> Result<u32, Fault> {
        let tag = match self.version {
            Some(Version::Four) => self.input.size("the tag of a node")?,
            _ => self.input.tag("the number of a node")?,
        };
        match self.nodes.as_ref().and_then(|nodes| nodes.index(tag)) {
            Some(index) => Ok(index),
            None => Err(self.fault(format!("An element refers to node {tag}, which does not exist"))),
        }
    }
}
