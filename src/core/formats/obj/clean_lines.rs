//! The lines of an OBJ file as the crate `tobj` takes them, and what it does not keep.
//!
//! `tobj` stops at comments after a statement and at continued lines, and reads only lines that end with LF. It
//! renumbers the vertices of each group by their first use, divides by a fourth coordinate (which is a weight of
//! curves), takes the texture coordinate of the corner before where one is missing, overflows on references before the
//! first texture coordinate, and tells neither lines from faces nor where in the file an error is. So here
//!
//! - each statement becomes one line with the words that `tobj` is to read, and no others;
//! - a *roll call* comes first: polygons that name all vertices in their order, so that `tobj` numbers them as the file
//!   does;
//! - the file is one model to `tobj`: the groups, and which elements are lines, are kept beside it ([`Run`]);
//! - faces with a corner without a texture coordinate are listed, and `tobj` gets them without any;
//! - statements that are not read are counted.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, BufRead, Read, Write};

use super::statements::{Statements, words};
use crate::core::formats::scan::{parse_integer, shown};
use crate::core::soup::{EMPTY_GROUP, Group, MeshFile};

/// Statements that are not read, with what they are about.
const UNREAD: [(&[u8], &str); 9] = [
    (b"vn", "normal"),
    (b"vp", "parameters"),
    (b"p", "point"),
    (b"s", "smoothing group"),
    (b"usemtl", "material"),
    (b"mtllib", "material library"),
    (b"curv", "curve"),
    (b"curv2", "curve on a surface"),
    (b"surf", "surface"),
];

/// Keywords of such statements that are counted.
const MOST_UNREAD: usize = 50;

/// Vertices that one polygon of the roll call names.
const CALLED_AT_ONCE: usize = 1000;

/// The vertices and texture coordinates of a file, or of the part of it that has been read.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Counts {
    vertices: usize,
    textures: usize,
}

/// Elements that follow each other and belong to one group.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    /// The first of them, counted from 0 over faces and lines.
    pub first: usize,
    /// Faces, or else lines.
    pub of_faces: bool,
    /// Their group; 0 without one.
    pub tag: u32,
}

/// The lines for `tobj`, made from the statements of a file while it reads them.
pub(super) struct CleanLines<'a> {
    pub statements: Statements<'a>,
    /// The statement of the line that was read last.
    pub statement: Cow<'a, [u8]>,
    line: Vec<u8>,
    /// How much of the line has been read.
    taken: usize,
    whole: Counts,
    so_far: Counts,
    /// The number of vertices in the roll call so far, and that of its polygons.
    called: usize,
    calls: usize,
    kept: Kept,
    names: GroupNames,
    line_names: GroupNames,
    colours: usize,
    unread: Vec<(Vec<u8>, usize)>,
}

/// What `tobj` does not keep.
#[derive(Default)]
pub(super) struct Kept {
    /// The groups, and what is not read.
    pub mesh: MeshFile,
    /// The number of elements of the roll call, which come before those of the file.
    pub calls: usize,
    /// Elements in their order.
    pub runs: Vec<Run>,
    /// Faces that have no texture coordinates, by their places among the elements, ascending.
    pub untextured: Vec<usize>,
    elements: usize,
}

impl<'a> CleanLines<'a> {
    /// The lines of the file that `statements` takes apart. `to_count` takes it apart, too, since its vertices are
    /// counted first.
    pub fn new(statements: Statements<'a>, mut to_count: Statements) -> Self {
        let mut whole = Counts::default();
        while let Some(statement) = to_count.next() {
            whole.vertices += usize::from(words(&statement).next() == Some(b"v"));
            whole.textures += usize::from(words(&statement).next() == Some(b"vt"));
        }
        let [names, line_names] = [2, 1].map(|dimension| GroupNames { dimension, ..GroupNames::default() });
        CleanLines {
            statements,
            statement: Cow::Borrowed(b""),
            line: Vec::new(),
            taken: 0,
            whole,
            so_far: Counts::default(),
            called: 0,
            calls: 0,
            kept: Kept::default(),
            names,
            line_names,
            colours: 0,
            unread: Vec::new(),
        }
    }

    /// What `tobj` did not get, after it has read all.
    pub fn kept(mut self) -> Kept {
        self.tell_empty();
        let mut kept = self.kept;
        for (keyword, count) in self.unread {
            let about = UNREAD.iter().find(|unread| unread.0 == keyword).map(|unread| format!(" ({})", unread.1));
            kept.mesh.omit_many("statement", &format!("{}{}", shown(&keyword), about.unwrap_or_default()), count);
        }
        if self.colours > 0 {
            kept.mesh.omit_many("vertex", "colour", self.colours);
        }
        kept.calls = self.calls;
        kept
    }

    /// Makes the next line; leaves it empty at the end of the file.
    fn make_line(&mut self) -> io::Result<()> {
        self.line.clear();
        self.taken = 0;
        if self.whole.vertices > 0 && self.called < self.whole.vertices.max(self.whole.textures) {
            return self.call();
        }
        while self.line.is_empty() {
            let Some(statement) = self.statements.next() else { break };
            self.statement = statement;
            let statement = self.statement.clone();
            let mut words = words(&statement);
            match words.next() {
                Some(b"v") => {
                    self.so_far.vertices += 1;
                    self.write("v", words.clone().take(3))?;
                    self.colours += usize::from(words.nth(5).is_some());
                }
                Some(b"vt") => {
                    self.so_far.textures += 1;
                    // A malformed coordinate has no faces.
                    let coordinate = |word: Option<&'_ [u8]>| {
                        let number = word.and_then(|word| std::str::from_utf8(word).ok()?.parse::<f64>().ok());
                        number.unwrap_or(f64::NAN)
                    };
                    writeln!(self.line, "vt {} {}", coordinate(words.next()), coordinate(words.next()))?;
                }
                Some(b"f") => self.write_face(words)?,
                Some(b"l") => {
                    self.enter(false);
                    self.write("l", words.map(|word| word.split(|&b| b == b'/').next().unwrap_or_default()))?;
                }
                // A group within an object overrides it; a face in several groups belongs to the first.
                Some(b"g" | b"o") => {
                    self.tell_empty();
                    self.names.next = words.next().map(|name| String::from_utf8_lossy(name).into_owned());
                    self.line_names.next.clone_from(&self.names.next);
                    words.for_each(|further| self.kept.mesh.omit("further name of a group", &shown(further)));
                }
                Some(keyword) => match self.unread.iter().position(|known| known.0 == keyword) {
                    Some(at) => self.unread[at].1 += 1,
                    None if self.unread.len() < MOST_UNREAD => self.unread.push((keyword.to_vec(), 1)),
                    None => {}
                },
                None => {}
            }
        }
        Ok(())
    }

    /// The next polygon of the roll call.
    fn call(&mut self) -> io::Result<()> {
        self.calls += 1;
        self.line.push(b'f');
        let all = self.whole.vertices.max(self.whole.textures);
        for number in self.called + 1..=all.min(self.called + CALLED_AT_ONCE) {
            write!(self.line, " {}", number.min(self.whole.vertices))?;
            if self.whole.textures > 0 {
                write!(self.line, "/{}", number.min(self.whole.textures))?;
            }
            self.called = number;
        }
        self.line.push(b'\n');
        Ok(())
    }

    /// Writes a face, with texture coordinates if all its corners have one.
    fn write_face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]> + Clone) -> io::Result<()> {
        let element = self.kept.elements;
        self.enter(true);
        let parts = |word: &'w [u8]| {
            let mut parts = word.split(|&b| b == b'/');
            (parts.next().unwrap_or_default(), parts.next().unwrap_or_default())
        };
        let exists = |texture: &[u8]| {
            parse_integer(texture).is_some_and(|number| match usize::try_from(number) {
                Ok(number) => (1..=self.whole.textures).contains(&number),
                Err(_) => number.unsigned_abs() <= self.so_far.textures as u64,
            })
        };
        if self.whole.textures > 0 && words.clone().all(|word| exists(parts(word).1)) {
            return self.write("f", words.map(|word| &word[..parts(word).0.len() + 1 + parts(word).1.len()]));
        }
        if self.whole.textures > 0 {
            self.kept.untextured.push(element);
        }
        self.write("f", words.map(|word| parts(word).0))
    }

    fn write<'w>(&mut self, keyword: &str, words: impl Iterator<Item = &'w [u8]>) -> io::Result<()> {
        self.line.extend(keyword.bytes());
        for word in words {
            self.line.push(b' ');
            self.line.extend(word);
        }
        self.line.push(b'\n');
        Ok(())
    }

    /// Counts an element of the current group.
    fn enter(&mut self, of_faces: bool) {
        let names = if of_faces { &mut self.names } else { &mut self.line_names };
        let run = Run { first: self.kept.elements, of_faces, tag: names.tag(&mut self.kept.mesh) };
        self.kept.elements += 1;
        if self.kept.runs.last().is_none_or(|last| (last.of_faces, last.tag) != (of_faces, run.tag)) {
            self.kept.runs.push(run);
        }
    }

    /// Tells of a group that ends without any face or line.
    fn tell_empty(&mut self) {
        if let (Some(name), Some(_)) = (&self.names.next, &self.line_names.next)
            && ![&self.names, &self.line_names].iter().any(|names| names.tags.contains_key(name))
        {
            self.kept.mesh.omit(EMPTY_GROUP, &format!("\"{}\"", shown(name.as_bytes())));
        }
    }
}

impl Read for CleanLines<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut line = self.fill_buf()?;
        let count = line.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for CleanLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken == self.line.len() {
            self.make_line()?;
        }
        Ok(&self.line[self.taken..])
    }

    fn consume(&mut self, count: usize) {
        self.taken += count;
    }
}

/// The groups of faces, or of lines, in the order of their first members.
#[derive(Default)]
struct GroupNames {
    dimension: u8,
    tags: BTreeMap<String, u32>,
    /// The group of the following elements, until the first of them is read.
    next: Option<String>,
    current: u32,
}

impl GroupNames {
    /// The tag of the next face or line; adds its group to the mesh if this is its first member.
    fn tag(&mut self, mesh: &mut MeshFile) -> u32 {
        if let Some(name) = self.next.take() {
            let new = self.tags.len() as u32 + 1;
            self.current = *self.tags.entry(name.clone()).or_insert(new);
            if self.current == new {
                mesh.groups.push(Group { dimension: self.dimension, tag: new, name });
            }
        }
        self.current
    }
}
