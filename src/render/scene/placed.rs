//! Lists in which every item keeps its slot, and which record the last change of each stretch, so that a reader can
//! pick what is newer than what it has.

use super::Line;

/// Number of slots in a stretch.
pub const STRETCH: usize = 64;

const NOWHERE: u32 = u32::MAX;

/// A list whose stretches record the generation of their last change.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Placed<T> {
    items: Vec<T>,
    changed: Vec<u64>,
}

impl<T: Copy + PartialEq> Placed<T> {
    /// All items.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// The generation of the last change.
    pub fn newest(&self) -> u64 {
        self.changed.iter().copied().max().unwrap_or_default()
    }

    /// The stretches changed after a generation, as starts and ends; neighbours are joined.
    pub fn newer_than(&self, generation: u64) -> Vec<[usize; 2]> {
        let mut found: Vec<[usize; 2]> = Vec::new();
        for (k, _) in self.changed.iter().enumerate().filter(|(_, changed)| **changed > generation) {
            let (start, end) = (k * STRETCH, ((k + 1) * STRETCH).min(self.items.len()));
            match found.last_mut() {
                Some(last) if last[1] == start => last[1] = end,
                _ => found.push([start, end]),
            }
        }
        found
    }

    /// Puts an item into a slot.
    pub fn set(&mut self, place: usize, item: T, generation: u64) {
        if self.items[place] != item {
            self.items[place] = item;
            self.changed[place / STRETCH] = generation;
        }
    }

    /// Resizes the list, with `empty` in new slots.
    pub fn resize(&mut self, length: usize, empty: T, generation: u64) {
        let first = self.items.len() / STRETCH;
        if length > self.items.len() {
            self.items.resize(length, empty);
            self.changed.resize(length.div_ceil(STRETCH), generation);
            self.changed[first..].fill(generation);
        } else {
            self.items.truncate(length);
            self.changed.truncate(length.div_ceil(STRETCH));
        }
    }

    /// Replaces all items; equal ones do not count as changed.
    pub fn replace(&mut self, items: &[T], generation: u64) {
        self.items.truncate(items.len());
        self.changed.truncate(items.len().div_ceil(STRETCH));
        for (k, item) in items.iter().enumerate() {
            if k < self.items.len() {
                self.set(k, *item, generation);
                continue;
            }
            self.items.push(*item);
            match self.changed.get_mut(k / STRETCH) {
                Some(changed) => *changed = generation,
                None => self.changed.push(generation),
            }
        }
    }
}

/// The slot in a list of the edge of each half-edge.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    /// By half-edge; `NOWHERE` where it has none.
    place: Vec<u32>,
    /// Free slots.
    free: Vec<u32>,
    /// Lines per slot, minus one: an edge that is drawn curved is a chain of lines.
    more: usize,
}

impl Places {
    /// Slots for chains of this many lines.
    pub fn of_chains(lines: usize) -> Places {
        Places { more: lines.saturating_sub(1), ..Places::default() }
    }

    /// Resizes to this many half-edges; edges of removed half-edges free their slots.
    pub fn resize(&mut self, slots: usize, list: &mut Placed<Line>, generation: u64) {
        for slot in slots..self.place.len() {
            self.put(slot, &[], list, generation);
        }
        self.place.resize(slots, NOWHERE);
    }

    /// Puts the edge of a half-edge where it has its place, or into one that is free; takes it away where it is none.
    pub fn put(&mut self, slot: usize, lines: &[Line], list: &mut Placed<Line>, generation: u64) {
        let length = self.more + 1;
        let mut place = self.place[slot];
        if place == NOWHERE {
            if lines.is_empty() {
                return;
            }
            place = self.free.pop().unwrap_or_else(|| {
                list.resize(list.items.len() + length, Line::default(), generation);
                (list.items.len() / length) as u32 - 1
            });
            self.place[slot] = place;
        } else if lines.is_empty() {
            self.free.push(place);
            self.place[slot] = NOWHERE;
        }
        for k in 0..length {
            list.set(place as usize * length + k, lines.get(k).copied().unwrap_or_default(), generation);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_stretches_that_differ_are_newer_and_neighbours_go_together() {
        let mut list = Placed::default();
        let mut items: Vec<u32> = (0..1000).collect();
        list.replace(&items, 1);
        assert_eq!(list.newer_than(0), [[0, 1000]]);
        list.replace(&items, 2);
        assert!(list.newer_than(1).is_empty());
        for k in [3, 64, 900] {
            items[k] = 7;
        }
        list.replace(&items, 3);
        assert_eq!(list.newer_than(2), [[0, 128], [896, 960]]);
        list.set(999, 5, 4);
        list.resize(1001, 0, 4);
        assert_eq!(list.newer_than(3), [[960, 1001]]);
        list.resize(10, 0, 5);
        assert!(list.newer_than(4).is_empty());
        assert_eq!(list.items().len(), 10);
    }

    #[test]
    fn an_edge_keeps_its_place_and_one_that_goes_leaves_it_to_the_next() {
        let (mut places, mut list) = (Places::default(), Placed::default());
        let line = |width| [Line { width, colour: 1, ..Line::default() }];
        places.resize(8, &mut list, 1);
        for slot in [0, 2, 5] {
            places.put(slot, &line(slot as f32), &mut list, 1);
        }
        places.put(2, &[], &mut list, 2);
        places.put(7, &line(7.0), &mut list, 2);
        let widths: Vec<f32> = list.items().iter().map(|line| line.width).collect();
        assert_eq!(widths, [0.0, 7.0, 5.0]);
        places.resize(4, &mut list, 3);
        assert_eq!(list.items().iter().filter(|line| line.colour != 0).count(), 1);
    }
}
