//! What a file has and the mesh made of it does not carry, in words.

use super::mesh_file::{Data, Group, MeshFile, Omitted};

/// How the words of [`MeshFile::not_read`] begin.
pub const NOT_READ: &str = "not read: ";

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
        let at = self.omitted.iter().position(|known| known.kind == kind).unwrap_or(self.omitted.len());
        if at == self.omitted.len() {
            self.omitted.push(Omitted { kind: kind.to_owned(), names: Vec::new() });
        }
        let names = &mut self.omitted[at].names;
        let name: String = name.chars().filter(|c| !c.is_control()).take(40).collect();
        match names.iter().position(|known| known.0 == name) {
            Some(at) => names[at].1 += count,
            None if names.len() < KEPT => names.push((name, count)),
            None => {}
        }
    }

    /// A phrase for each kind of content that the result of a conversion does not carry, such as "not read: tetrahedron
    /// (12 times)": elements, then what the reader has left out, data at points and elements, and groups without
    /// members. Of many kinds or names, the first ones and how many more there are.
    pub fn not_read(&self) -> Vec<String> {
        let mut kinds: Vec<String> = self.skipped.iter().map(|(kind, count)| times(kind, *count)).collect();
        kinds.extend(self.omitted.iter().map(|Omitted { kind, names }| {
            let names: Vec<String> = names.iter().map(|(name, count)| times(name, *count)).collect();
            listing(kind, &names)
        }));
        let mut unused = |kind: &str, names: Vec<String>| {
            if !names.is_empty() {
                kinds.push(listing(kind, &names));
            }
        };
        let names = |data: &[Data]| data.iter().map(|data| data.name.clone()).collect();
        unused("point data", names(&self.point_data));
        unused("cell data", names(&self.element_data));
        unused("group without members:", self.empty_groups());
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
fn times(what: &str, count: usize) -> String {
    if count == 1 { what.to_owned() } else { format!("{what} ({count} times)") }
}

/// "keyword *STEP, *STATIC and *OUTPUT (4 times)"; of many names, the first ones and how many more there are.
fn listing(kind: &str, names: &[String]) -> String {
    let listed = &names[..names.len().min(LISTED[1])];
    match (listed, names.len() - listed.len()) {
        ([], _) => kind.to_owned(),
        ([first @ .., last], 0) if !first.is_empty() => format!("{kind} {} and {last}", first.join(", ")),
        (listed, 0) => format!("{kind} {}", listed.join(", ")),
        (listed, _) if names.len() == KEPT => format!("{kind} {} and many more", listed.join(", ")),
        (listed, more) => format!("{kind} {} and {more} more", listed.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::soup::Members;

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
            point_data: vec![Data { name: "heat".into(), values: vec![] }],
            ..Default::default()
        };
        assert_eq!(
            mesh.not_read(),
            ["not read: point data heat", "not read: group without members: \"hole\" and \"rim\""]
        );
    }
}
