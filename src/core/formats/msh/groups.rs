//! The physical groups of an MSH file: an entity may be in several.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::core::soup::groups::{Listed, by_region};
use crate::core::soup::{Members, MeshFile};

/// Tags from here on stand for several physical groups while a file is read: those of a file are below.
const SEVERAL: u32 = 1 << 31;

/// The groups of a file while it is read.
#[derive(Default)]
pub(super) struct Grouping {
    /// Version 4: the physical groups of an entity, by dimension and tag.
    physical: FxHashMap<(i64, i64), SmallVec<[u32; 2]>>,
    /// Those of elements that are in several, whose tag is an index into it above [`SEVERAL`].
    several: Vec<SmallVec<[u32; 2]>>,
    /// The points of point elements, with their tags.
    pub points: Vec<(u32, u32)>,
}

/// The tag of a group, if it is one.
pub(super) fn group_tag(tag: u64) -> Option<u32> {
    u32::try_from(tag).ok().filter(|&tag| tag < SEVERAL)
}

impl Grouping {
    /// Adds an entity to a group.
    pub fn add(&mut self, entity: (i64, i64), group: u64) {
        if let Some(group) = group_tag(group) {
            let known = self.physical.entry(entity).or_default();
            if !known.contains(&group) {
                known.push(group);
            }
        }
    }

    /// The tag of the elements of an entity, for [`Grouping::assign`].
    pub fn tag(&mut self, entity: (i64, i64)) -> u32 {
        match self.physical.get(&entity) {
            None => 0,
            Some(groups) if groups.len() == 1 => groups[0],
            Some(groups) => {
                self.several.push(groups.clone());
                SEVERAL + self.several.len() as u32 - 1
            }
        }
    }

    /// Adds the group of the last element where it `is_again` the next one: version 2 lists an element of several
    /// groups once for each. Returns whether that is so, and not one that is there twice in the same group.
    pub fn takes(&mut self, is_again: bool, tags: &mut [u32], group: u32) -> bool {
        let Some(tag) = tags.last_mut().filter(|_| is_again && group != 0) else { return false };
        let mut groups = self.groups(*tag);
        if groups.is_empty() || groups.contains(&group) {
            return false;
        }
        groups.push(group);
        if self.several.last() != Some(&groups) {
            self.several.push(groups);
        }
        *tag = SEVERAL + self.several.len() as u32 - 1;
        true
    }

    /// The groups that a tag stands for.
    fn groups(&self, tag: u32) -> SmallVec<[u32; 2]> {
        match tag.checked_sub(SEVERAL) {
            Some(k) => self.several[k as usize].clone(),
            None => (tag > 0).then_some(tag).into_iter().collect(),
        }
    }

    /// Assigns elements in several groups to regions, and points to their groups.
    pub fn assign(self, file: &mut MeshFile) {
        let groups = |tag: u32| self.groups(tag);
        let MeshFile { line_tags, triangle_tags, quad_tags, members, .. } = file;
        let mut points: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &(point, tag) in &self.points {
            groups(tag).into_iter().for_each(|group| points.entry(group).or_default().push(point));
        }
        for (tag, mut of) in points {
            of.sort_unstable();
            of.dedup();
            members.push(Members { dimension: 0, tag, of });
        }
        for (dimension, kinds) in [(1, vec![line_tags]), (2, vec![triangle_tags, quad_tags])] {
            let all: Vec<u32> = kinds.iter().flat_map(|tags| tags.iter().copied()).collect();
            if all.iter().all(|&tag| tag < SEVERAL) {
                continue;
            }
            let mut lists: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
            for (element, &tag) in (0..).zip(&all) {
                groups(tag).into_iter().for_each(|group| lists.entry(group).or_default().push(element));
            }
            let listed = lists.into_iter().map(|(tag, elements)| Listed { tag, elements, used: false }).collect();
            let (tags, further) = by_region(listed, all.len(), dimension);
            members.extend(further);
            kinds.into_iter().flatten().zip(tags).for_each(|(own, tag)| *own = tag);
        }
    }
}
