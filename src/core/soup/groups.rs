//! Groups that overlap: which of them divide a mesh into regions, and which are kept as lists of their members; groups
//! that are ignored.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::mesh_file::{FRONT, Members, MeshFile, tag_of};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::spelling::nearest;
use crate::core::mesh::Named;

/// Groups of a mesh that are ignored, as if its file did not have them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Ignored {
    /// No group.
    #[default]
    Nothing,
    /// All groups.
    All,
    /// The groups of these names.
    Named(Vec<String>),
}

/// A group as a file lists it.
pub(in crate::core) struct Listed {
    pub tag: u32,
    /// Its elements, ascending.
    pub elements: Vec<u32>,
    /// Whether the file uses it as a region, such as by a section of properties.
    pub used: bool,
}

/// The tag of each of `count` elements, that is its region, and the members of groups besides.
///
/// Regions are the groups that the file uses as such. Where it uses none they are all groups, but of two that overlap,
/// neither within the other, only the first. An element of several regions belongs to the smallest.
pub(in crate::core) fn by_region(groups: Vec<Listed>, count: usize, dimension: u8) -> (Vec<u32>, Vec<Members>) {
    let any_used = groups.iter().any(|group| group.used);
    let mut at: Vec<SmallVec<[u32; 2]>> = vec![SmallVec::new(); count];
    for (k, group) in groups.iter().enumerate() {
        let mut shared: FxHashMap<u32, usize> = FxHashMap::default();
        for &other in group.elements.iter().flat_map(|&e| &at[e as usize]) {
            *shared.entry(other).or_default() += 1;
        }
        let is_within =
            |(&other, n): (&u32, &usize)| *n == group.elements.len() || *n == groups[other as usize].elements.len();
        if if any_used { group.used } else { shared.iter().all(is_within) } {
            group.elements.iter().for_each(|&e| at[e as usize].push(k as u32));
        }
    }
    let smallest =
        |of: &SmallVec<[u32; 2]>| of.iter().min_by_key(|&&k| (groups[k as usize].elements.len(), k)).copied();
    let region: Vec<Option<u32>> = at.iter().map(smallest).collect();
    let mut members = Vec::new();
    for (k, group) in (0..).zip(&groups) {
        let of: Vec<u32> = group.elements.iter().copied().filter(|&e| region[e as usize] != Some(k)).collect();
        if !of.is_empty() {
            members.push(Members { dimension, tag: group.tag, of });
        }
    }
    (region.into_iter().map(|k| k.map_or(0, |k| groups[k as usize].tag)).collect(), members)
}

impl MeshFile {
    /// Removes groups: their elements belong to what other groups they are in, or to none, and points in no other group
    /// need not be kept.
    ///
    /// # Errors
    /// A name of no group.
    pub fn ignore_groups(&mut self, ignored: &Ignored) -> Result<(), Fault> {
        let gone: Vec<(u8, u32)> = match ignored {
            Ignored::Nothing => return Ok(()),
            Ignored::All => self.named_groups().into_iter().map(|(dimension, tag, _)| (dimension, tag)).collect(),
            Ignored::Named(names) => {
                let known = self.named_groups();
                let mut gone = Vec::new();
                for name in names {
                    let before = gone.len();
                    gone.extend(known.iter().filter(|group| group.2 == *name).map(|group| (group.0, group.1)));
                    if gone.len() == before {
                        let fault = Fault::new(format!("The mesh has no group \"{}\" to ignore", name.escape_debug()));
                        return Err(fault.of_kind(FaultKind::Mesh).remedy(
                            match nearest(name, known.iter().map(|group| group.2.as_str())) {
                                Some(near) => format!("The nearest name is \"{near}\""),
                                None => "Remove the name".to_owned(),
                            },
                        ));
                    }
                }
                gone
            }
        };
        self.members.retain(|members| !gone.contains(&(members.dimension, members.tag)));
        self.groups.retain(|group| !gone.contains(&(group.dimension, group.tag)));
        let mut lines = std::mem::take(&mut self.line_tags);
        self.regroup(1, &mut [&mut lines], &gone);
        self.line_tags = lines;
        let mut faces = [&mut self.triangle_tags, &mut self.quad_tags, &mut self.polygon_tags].map(std::mem::take);
        let counts = [self.triangles.len(), self.quads.len(), self.polygons.len()];
        for (tags, count) in faces.iter_mut().zip(counts) {
            tags.resize(count, 0);
        }
        let [triangles, quads, polygons] = &mut faces;
        self.regroup(2, &mut [triangles, quads, polygons], &gone);
        [self.triangle_tags, self.quad_tags, self.polygon_tags] = faces;
        self.clear_zero_tags();
        Ok(())
    }

    /// Assigns the elements with these tags, kind after kind, to regions again, without the groups that are gone.
    fn regroup(&mut self, dimension: u8, tags: &mut [&mut Vec<u32>], gone: &[(u8, u32)]) {
        let all: Vec<u32> = tags.iter().flat_map(|tags| tags.iter().copied()).collect();
        if !all.iter().any(|&tag| gone.contains(&(dimension, tag))) {
            return;
        }
        let mut lists: BTreeMap<u32, Listed> = BTreeMap::new();
        for (element, &tag) in (0..).zip(&all).filter(|(_, tag)| **tag != 0 && !gone.contains(&(dimension, **tag))) {
            let list = lists.entry(tag).or_insert_with(|| Listed { tag, elements: Vec::new(), used: true });
            list.elements.push(element);
        }
        for Members { tag, of, .. } in self.members.iter().filter(|members| members.dimension == dimension) {
            let list = lists.entry(*tag).or_insert_with(|| Listed { tag: *tag, elements: Vec::new(), used: false });
            list.elements.extend(of);
            list.elements.sort_unstable();
        }
        self.members.retain(|members| members.dimension != dimension);
        let (new, members) = by_region(lists.into_values().collect(), all.len(), dimension);
        self.members.extend(members);
        let mut new = new.into_iter();
        for tag in tags.iter_mut().flat_map(|tags| tags.iter_mut()) {
            *tag = new.next().unwrap_or(0);
        }
    }

    /// The points that are kept, each with its group, if it is in one; a point of several groups is listed for each.
    pub(in crate::core) fn hard_points(&self) -> Vec<(u32, Option<Named>)> {
        let points = self.members.iter().filter(|members| members.dimension == 0);
        let named = |tag: u32| (tag != 0).then(|| self.named(0, tag));
        points.flat_map(|members| members.of.iter().map(move |&k| (k, named(members.tag)))).collect()
    }

    /// Dimension, tag and name of every group: also of those that the file gives no name.
    fn named_groups(&self) -> Vec<(u8, u32, String)> {
        let front = |group: &(u8, u32)| group.0 == 1 && self.group_name(1, group.1) == Some(FRONT);
        let name = |(dimension, tag): (u8, u32)| (dimension, tag, self.named(dimension, tag).name);
        self.groups_in_use().into_iter().filter(|group| !front(group)).map(name).collect()
    }

    /// Dimension and tag of every group that has members, ascending.
    pub(super) fn groups_in_use(&self) -> Vec<(u8, u32)> {
        let faces = [&self.triangle_tags, &self.quad_tags, &self.polygon_tags].into_iter().flatten();
        let tags = self.line_tags.iter().map(|&tag| (1, tag)).chain(faces.map(|&tag| (2, tag)));
        let members = self.members.iter().map(|members| (members.dimension, members.tag));
        let mut all: Vec<(u8, u32)> = tags.chain(members).filter(|group| group.1 != 0).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// A group with its name: that of the file, or what it is and its tag.
    pub(in crate::core) fn named(&self, dimension: u8, tag: u32) -> Named {
        let kind = ["point", "line", "region"][usize::from(dimension.min(2))];
        let name = self.group_name(dimension, tag).map_or_else(|| format!("{kind} {tag}"), str::to_owned);
        Named::tagged(name, tag)
    }

    /// The groups of lines, and for each line the index of its group: `None` for lines without a tag and for the
    /// merging front of an intermediate state, which is no feature of the shape. Lines of one group that are in
    /// different further groups have different indices with one name.
    pub fn line_groups(&self) -> (Vec<Named>, Vec<Option<u32>>) {
        let keys = self.line_keys();
        let known = distinct(&keys);
        let index = |key: &LineKey| known.binary_search(key).ok().map(|k| k as u32);
        (known.iter().map(|key| self.named(1, key[0])).collect(), keys.iter().map(index).collect())
    }

    /// The further groups of lines, each with the indices of [`MeshFile::line_groups`] that are in it.
    pub(in crate::core) fn further_lines(&self) -> Vec<(Named, Vec<u32>)> {
        let further: Vec<u32> = self.members.iter().filter(|m| m.dimension == 1).map(|m| m.tag).collect();
        if further.is_empty() {
            return Vec::new();
        }
        let known = distinct(&self.line_keys());
        let of = |tag: u32| (0..).zip(&known).filter(|(_, key)| key[1..].contains(&tag)).map(|(k, _)| k).collect();
        further.into_iter().map(|tag| (self.named(1, tag), of(tag))).collect()
    }

    /// The tags of the groups of each line, the first one first.
    fn line_keys(&self) -> Vec<LineKey> {
        let is_group = |tag: u32| tag > 0 && self.group_name(1, tag) != Some(FRONT);
        let first = |i: usize| Some(tag_of(&self.line_tags, i)).filter(|&tag| is_group(tag));
        let mut keys: Vec<LineKey> = (0..self.lines.len()).map(|i| first(i).into_iter().collect()).collect();
        for Members { tag, of, .. } in self.members.iter().filter(|m| m.dimension == 1 && is_group(m.tag)) {
            for &i in of {
                if let Some(key) = keys.get_mut(i as usize) {
                    key.push(*tag);
                }
            }
        }
        keys
    }
}

type LineKey = SmallVec<[u32; 2]>;

/// The distinct keys that are not empty, ascending.
fn distinct(keys: &[LineKey]) -> Vec<LineKey> {
    let mut known: Vec<LineKey> = keys.iter().filter(|key| !key.is_empty()).cloned().collect();
    known.sort_unstable();
    known.dedup();
    known
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::soup::Group;

    fn listed(tag: u32, elements: &[u32], used: bool) -> Listed {
        Listed { tag, elements: elements.to_vec(), used }
    }

    fn members(tag: u32, of: &[u32]) -> Members {
        Members { dimension: 2, tag, of: of.to_vec() }
    }

    #[test]
    fn nested_groups_are_regions_and_one_that_overlaps_is_a_list() {
        let nested = vec![listed(1, &[0, 1, 2, 3], false), listed(2, &[2, 3], false)];
        assert_eq!(by_region(nested, 4, 2), (vec![1, 1, 2, 2], vec![members(1, &[2, 3])]));
        let overlapping = vec![listed(1, &[0, 1], false), listed(2, &[1, 2, 3], false)];
        assert_eq!(by_region(overlapping, 4, 2), (vec![1, 1, 0, 0], vec![members(2, &[1, 2, 3])]));
    }

    #[test]
    fn where_a_file_says_what_its_regions_are_no_other_group_cuts() {
        let groups = vec![listed(1, &[0, 1, 2, 3], true), listed(2, &[1], false), listed(3, &[3], true)];
        assert_eq!(by_region(groups, 4, 2), (vec![1, 1, 1, 3], vec![members(1, &[3]), members(2, &[1])]));
    }

    #[test]
    fn ignored_groups_leave_their_elements_to_other_groups() {
        let group = |dimension, tag, name: &str| Group { dimension, tag, name: name.to_owned() };
        let mesh = MeshFile {
            triangles: vec![[0, 1, 2]; 3],
            triangle_tags: vec![1, 2, 3],
            lines: vec![[0, 1]],
            line_tags: vec![4],
            groups: vec![group(1, 4, "rim"), group(2, 1, "steel"), group(2, 2, "load")],
            members: vec![members(1, &[1])],
            ..MeshFile::default()
        };
        let without = |names: &[&str]| {
            let mut mesh = mesh.clone();
            let ignored = Ignored::Named(names.iter().map(|name| (*name).to_owned()).collect());
            mesh.ignore_groups(&ignored).map(|()| (mesh.triangle_tags, mesh.line_tags, mesh.members.len()))
        };
        assert_eq!(without(&["load"]), Ok((vec![1, 1, 3], vec![4], 0)));
        assert_eq!(without(&["rim", "region 3"]), Ok((vec![1, 2, 0], vec![], 1)));
        assert!(without(&["laod"]).unwrap_err().to_string().contains("The nearest name is \"load\""));
        let mut all = mesh.clone();
        all.ignore_groups(&Ignored::All).unwrap();
        assert_eq!((all.triangle_tags, all.line_tags, all.groups, all.members), (vec![], vec![], vec![], vec![]));
    }

    #[test]
    fn lines_of_two_groups_are_lines_of_their_own_with_the_name_of_the_first() {
        let mesh = MeshFile {
            lines: vec![[0, 1], [1, 2], [2, 3]],
            line_tags: vec![4, 4, 0],
            members: vec![Members { dimension: 1, tag: 9, of: vec![1] }],
            ..MeshFile::default()
        };
        let (names, of) = mesh.line_groups();
        assert_eq!(names.iter().map(|named| named.name.as_str()).collect::<Vec<_>>(), ["line 4", "line 4"]);
        assert_eq!(of, [Some(0), Some(1), None]);
        assert_eq!(mesh.further_lines(), [(Named::tagged("line 9", 9), vec![1])]);
    }
}
