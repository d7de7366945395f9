//! What a file has and the mesh made of it does not carry, in words.

use super::mesh_file::{ELEMENT_ID, Group, MeshFile, NODE_ID, Omitted};

/// How the words of [`MeshFile::not_read`] begin.
pub const NOT_READ: &str = "not read: ";

/// Kinds of content that readers of several formats leave out.
pub(in crate::core) const POINT_DATA: &str = "point data";
/// Likewise.
pub(in crate::core) const CELL_DATA: &str = "cell data";
/// Likewise.
pub(in crate::core) const EMPTY_GROUP: &str = "group without members:";

/// Kinds, and names of a kind, that are listed; the others are counted.
const LISTED: [usize; 2] = [10, 5];
/// Names of a kind that are kept, so that no file makes the list long.
const KEPT: usize = 50;

impl MeshFile {
    /// Notes that something of the file is not read, by its kind and name.
    pub(in crate::core) fn omit(&mut self, kind: &str, name: &str) {
        self.omit_many(kind, name, 1);
    }

    /// Likewise, for something that is there `count` times.
    pub(in crate::core) fn omit_many(&mut self, kind: &str, name: &str, count: usize) {
        note(&mut self.omitted, kind, name, count);
    }

    /// A phrase for each kind of content that the result of a conversion does not carry, such as "not read: tetrahedron
    /// (12 times)": elements, then what the reader has left out, data at points and elements, and groups without
    /// members. Of many kinds or names, the first ones and how many more there are.
    pub fn not_read(&self) -> Vec<String> {
        let mut omitted = self.omitted.clone();
        // Ids belong to the run that wrote them.
        let is_id = |name: &str| name == ELEMENT_ID || name.starts_with(NODE_ID);
        for (kind, data) in [(POINT_DATA, &self.point_data), (CELL_DATA, &self.element_data)] {
            let names = data.iter().map(|data| data.name.as_str()).filter(|name| !is_id(name));
            names.for_each(|name| note(&mut omitted, kind, name, 1));
        }
        let middles = self.second_order.sides.len() + self.second_order.centres.len();
        if middles > 0 {
            note(&mut omitted, "mid-side node", "of an element of order 2", middles);
        }
        self.empty_groups().iter().for_each(|name| note(&mut omitted, EMPTY_GROUP, name, 1));
        let mut kinds: Vec<String> = self.skipped.iter().map(|(kind, count)| times(kind, *count)).collect();
        kinds.extend(omitted.iter().map(listing));
        let more = kinds.len().saturating_sub(LISTED[0]);
        kinds.truncate(LISTED[0]);
        if more > 0 {
            kinds.push(if more == 1 { "1 more kind".to_owned() } else { format!("{more} more kinds") });
        }
        kinds.into_iter().map(|kind| format!("{NOT_READ}{kind}")).collect()
    }

    /// The names of the groups that no point, line or element is in.
    fn empty_groups(&self) -> Vec<String> {
        let used = self.groups_in_use();
        let is_empty = |group: &&Group| used.binary_search(&(group.dimension, group.tag)).is_err();
        self.groups.iter().filter(is_empty).map(|group| format!("\"{}\"", group.name)).collect()
    }
}

/// "tetrahedron (12 times)", or what it is alone where it is there once.
pub(in crate::core) fn times(what: &str, count: usize) -> String {
    if count == 1 { what.to_owned() } else { format!("{what} ({count} times)") }
}

/// "keyword *STEP, *STATIC and *OUTPUT (4 times)"; of many names, the first ones and how many more there are.
fn listing(Omitted { kind, names }: &Omitted) -> String {
    let listed: Vec<String> = names.iter().take(LISTED[1]).map(|(name, count)| times(name, *count)).collect();
    match (&listed[..], names.len() - listed.len()) {
        ([], _) => kind.clone(),
        ([name], 0) => format!("{kind} {name}"),
        ([first @ .., last], 0) => format!("{kind} {} and {last}", first.join(", ")),
        (listed, _) if names.len() == KEPT => format!("{kind} {} and many more", listed.join(", ")),
        (listed, more) => format!("{kind} {} and {more} more", listed.join(", ")),
    }
}

/// Adds to what is left out.
fn note(omitted: &mut Vec<Omitted>, kind: &str, name: &str, count: usize) {
    let at = omitted.iter().position(|known| known.kind == kind).unwrap_or(omitted.len());
    if at == omitted.len() {
        omitted.push(Omitted { kind: kind.to_owned(), names: Vec::new() });
    }
    let names = &mut omitted[at].names;
    let name: String = name.chars().filter(|c| !c.is_control()).take(40).collect();
    match names.iter().position(|known| known.0 == name) {
        Some(at) => names[at].1 += count,
        None if names.len() < KEPT => names.push((name, count)),
        None => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::soup::{Data, Members};

    #[test]
    fn what_is_not_read_is_told_by_kind_and_never_at_length() {
        let mut mesh =
            MeshFile { skipped: vec![("tetrahedron".into(), 12), ("prism".into(), 1)], ..Default::default() };
        assert_eq!(mesh.not_read(), ["not read: tetrahedron (12 times)", "not read: prism"]);
        mesh.skipped = (0..30).map(|k| (format!("kind {k}"), 2)).collect();
        let told = mesh.not_read();
        assert_eq!((told.len(), told[10].as_str()), (11, "not read: 20 more kinds"));
    }

    #[test]
    fn what_is_left_out_is_told_with_its_names() {
        let mut mesh = MeshFile::default();
        mesh.omit("keyword", "*STEP");
        assert_eq!(mesh.not_read(), ["not read: keyword *STEP"]);
        mesh.omit("keyword", "*ELASTIC");
        mesh.omit("keyword", "*STEP");
        assert_eq!(mesh.not_read(), ["not read: keyword *STEP (2 times) and *ELASTIC"]);
        (0..8).for_each(|k| mesh.omit("node set", &format!("N{k}")));
        assert_eq!(mesh.not_read()[1], "not read: node set N0, N1, N2, N3, N4 and 3 more");
        (0..100_000).for_each(|k| mesh.omit("node set", &format!("M{k}")));
        assert_eq!(mesh.omitted[1].names.len(), KEPT);
        assert_eq!(mesh.not_read()[1], "not read: node set N0, N1, N2, N3, N4 and many more");
    }

    #[test]
    fn data_and_groups_without_members_are_told() {
        let group = |dimension, tag, name: &str| Group { dimension, tag, name: name.into() };
        let mesh = MeshFile {
            triangles: vec![[0, 1, 2]; 2],
            triangle_tags: vec![1, 1],
            groups: vec![
                group(0, 1, "pin"),
                group(0, 2, "hole"),
                group(1, 1, "rim"),
                group(2, 1, "a"),
                group(2, 2, "b"),
            ],
            members: vec![Members { dimension: 0, tag: 1, of: vec![0] }, Members { dimension: 2, tag: 2, of: vec![1] }],
            point_data: ["node_id_2", "heat"].map(|name| Data { name: name.into(), values: vec![] }).to_vec(),
            element_data: vec![Data { name: "element_id".into(), values: vec![] }],
            ..Default::default()
        };
        assert_eq!(
            mesh.not_read(),
            ["not read: point data heat", "not read: group without members: \"hole\" and \"rim\""]
        );
    }
}
