//! Nodes that wait to be looked at, first come first served, each waiting once at the most, under a budget of looks.
//!
//! Where a history is kept the list writes down what was taken and added, so that a step is taken back exactly: as the
//! journal does for the mesh.

use std::collections::VecDeque;

use crate::core::mesh::NodeId;

/// Nodes that wait.
#[derive(Clone, Debug)]
pub struct Worklist {
    queue: VecDeque<NodeId>,
    waits: Vec<bool>,
    /// Looks left.
    looks: usize,
    /// What changed, where it is written down.
    log: Option<Vec<Change>>,
}

#[derive(Clone, Copy, Debug)]
enum Change {
    Taken(NodeId),
    Added(NodeId),
}

/// A place in the log to which everything later can be taken back.
#[derive(Clone, Copy, Debug)]
pub struct ListMark(usize);

impl Worklist {
    /// An empty list with a budget, which writes down what changes where `recording`.
    pub fn new(looks: usize, recording: bool) -> Worklist {
        Worklist { queue: VecDeque::new(), waits: Vec::new(), looks, log: recording.then(Vec::new) }
    }

    /// Writes down from now on what changes.
    pub fn record(&mut self) {
        self.log = Some(Vec::new());
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<NodeId>() * self.queue.capacity() + self.waits.capacity() + self.log_bytes()
    }

    /// Bytes of what is written down for taking back.
    pub fn log_bytes(&self) -> usize {
        size_of::<Change>() * self.log.as_ref().map_or(0, Vec::capacity)
    }

    /// Number of nodes that wait.
    pub fn len(&self) -> usize {
        self.queue.len()
    }

    /// Adds a node at the end, where it does not wait already.
    pub fn add(&mut self, node: NodeId) {
        if self.waits.len() <= node.index() {
            self.waits.resize(node.index() + 1, false);
        }
        if !std::mem::replace(&mut self.waits[node.index()], true) {
            self.queue.push_back(node);
            self.note(Change::Added(node));
        }
    }

    /// Takes the first node; none where no node waits or the budget is spent.
    pub fn take(&mut self) -> Option<NodeId> {
        self.looks.checked_sub(1)?;
        let node = self.queue.pop_front()?;
        self.looks -= 1;
        self.waits[node.index()] = false;
        self.note(Change::Taken(node));
        Some(node)
    }

    #[inline]
    fn note(&mut self, change: Change) {
        if let Some(log) = &mut self.log {
            log.push(change);
        }
    }

    /// The present place of the log.
    pub fn mark(&self) -> ListMark {
        ListMark(self.log.as_ref().map_or(0, Vec::len))
    }

    /// Takes back everything that was done after the mark.
    pub fn take_back(&mut self, mark: ListMark) {
        let Some(log) = &mut self.log else { return };
        for change in log.drain(mark.0..).rev() {
            match change {
                Change::Taken(node) => {
                    self.queue.push_front(node);
                    self.waits[node.index()] = true;
                    self.looks += 1;
                }
                Change::Added(node) => {
                    self.queue.pop_back();
                    self.waits[node.index()] = false;
                }
            }
        }
    }

    /// Appends what the next steps depend on, little-endian.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&(self.looks as u64).to_le_bytes());
        self.queue.iter().for_each(|node| bytes.extend_from_slice(&node.0.to_le_bytes()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(list: &Worklist) -> Vec<u8> {
        let mut bytes = Vec::new();
        list.write_state(&mut bytes);
        bytes
    }

    #[test]
    fn what_was_taken_and_added_is_taken_back_in_order() {
        let mut list = Worklist::new(10, true);
        [3, 1, 2].into_iter().for_each(|n| list.add(NodeId(n)));
        let (mark, before) = (list.mark(), state(&list));
        assert_eq!([list.take(), list.take()], [Some(NodeId(3)), Some(NodeId(1))]);
        [3, 2, 7].into_iter().for_each(|n| list.add(NodeId(n)));
        assert_eq!(list.len(), 3, "a node that waits is not added again");
        list.take_back(mark);
        assert_eq!(state(&list), before);
        [3, 1, 2, 7].into_iter().for_each(|n| list.add(NodeId(n)));
        assert_eq!(list.len(), 4, "those that wait again are not added again");
    }

    #[test]
    fn nothing_is_taken_when_the_budget_is_spent() {
        let mut list = Worklist::new(1, false);
        [0, 1].into_iter().for_each(|n| list.add(NodeId(n)));
        assert_eq!([list.take(), list.take()], [Some(NodeId(0)), None]);
        assert_eq!(list.len(), 1);
    }
}
