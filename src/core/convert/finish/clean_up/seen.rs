//! A set of ids that is emptied at once.

/// Ids that were seen.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen {
    stamps: Vec<u32>,
    stamp: u32,
}

impl Seen {
    /// Empties it, and makes room for ids below `slots`.
    pub fn clear(&mut self, slots: usize) {
        if self.stamp == u32::MAX {
            self.stamps.fill(0);
            self.stamp = 0;
        }
        self.stamp += 1;
        if self.stamps.len() < slots {
            self.stamps.resize(slots, 0);
        }
    }

    /// Adds an id; false where it was in.
    #[inline]
    pub fn add(&mut self, id: usize) -> bool {
        std::mem::replace(&mut self.stamps[id], self.stamp) != self.stamp
    }

    /// Whether an id is in.
    #[inline]
    pub fn has(&self, id: usize) -> bool {
        self.stamps[id] == self.stamp
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<u32>() * self.stamps.capacity()
    }
}
