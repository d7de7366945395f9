//! The step that changed each node and each element last: recorded along a run, looked up at any of its states. A
//! change is what a watchpoint sees ([`Appearance`](crate::core::run::Appearance)).

use std::sync::Arc;

use crate::core::mesh::{ElementId, Mesh, NodeId, Touched};

/// What a slot without anything looks like.
const ABSENT: u64 = 0;
/// Marks a slot whose last change is being looked for.
const SOUGHT: u64 = u64::MAX;

/// The slots that each step changed, step by step. Copies share their memory.
#[derive(Clone, Debug, Default)]
pub struct ChangeLog {
    /// Counts how often steps were dropped, so that what was looked up before is known to be out of date.
    edition: u64,
    nodes: Vec<Arc<Part>>,
    elements: Vec<Arc<Part>>,
}

/// The slots that consecutive steps changed.
#[derive(Clone, Debug, Default)]
struct Part {
    /// The step before its first one.
    after: u64,
    /// For each step the number of slots up to its last one.
    ends: Vec<u32>,
    slots: Vec<u32>,
}

impl Part {
    /// Its last step.
    fn until(&self) -> u64 {
        self.after + self.ends.len() as u64
    }

    /// The slots that one of its steps changed.
    fn of(&self, step: u64) -> &[u32] {
        let k = (step - self.after) as usize;
        let begin = if k > 1 { self.ends[k - 2] } else { 0 };
        &self.slots[begin as usize..self.ends[k - 1] as usize]
    }

    fn truncate(&mut self, step: u64) {
        self.ends.truncate(step.saturating_sub(self.after) as usize);
        self.slots.truncate(self.ends.last().map_or(0, |end| *end as usize));
    }
}

impl ChangeLog {
    /// Records what a step changed, each slot once.
    fn push(&mut self, step: u64, nodes: &[u32], elements: &[u32]) {
        for (parts, slots) in [(&mut self.nodes, nodes), (&mut self.elements, elements)] {
            if parts.is_empty() {
                parts.push(Arc::new(Part { after: step - 1, ..Part::default() }));
            }
            let Some(part) = parts.last_mut().map(Arc::make_mut) else { continue };
            part.slots.extend_from_slice(slots);
            part.ends.push(part.slots.len() as u32);
        }
    }

    /// Appends what later steps changed.
    pub(super) fn append(&mut self, later: ChangeLog) {
        self.nodes.extend(later.nodes);
        self.elements.extend(later.elements);
    }

    /// Drops all steps after this one.
    pub(super) fn truncate(&mut self, step: u64) {
        self.edition += 1;
        for parts in [&mut self.nodes, &mut self.elements] {
            parts.truncate(parts.partition_point(|part| part.after < step));
            if let Some(last) = parts.last_mut().filter(|last| last.until() > step) {
                Arc::make_mut(last).truncate(step);
            }
        }
    }

    /// The memory it takes, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let of = |part: &Arc<Part>| size_of::<Part>() + 4 * (part.ends.capacity() + part.slots.capacity());
        self.nodes.iter().chain(&self.elements).map(of).sum()
    }
}

/// Visits the steps from `from` to `until` (both included), backwards if so asked, with the slots that each changed,
/// until `visit` says that this is enough.
fn walk(parts: &[Arc<Part>], from: u64, until: u64, back: bool, visit: &mut dyn FnMut(u64, &[u32]) -> bool) {
    let first = parts.partition_point(|part| part.until() < from);
    let last = parts.partition_point(|part| part.after < until);
    let within = &parts[first..last.max(first)];
    let steps = |part: &Arc<Part>| (from.max(part.after + 1), until.min(part.until()));
    if back {
        for part in within.iter().rev() {
            let (low, high) = steps(part);
            if (low..=high).rev().any(|step| visit(step, part.of(step))) {
                return;
            }
        }
    } else {
        for part in within {
            let (low, high) = steps(part);
            if (low..=high).any(|step| visit(step, part.of(step))) {
                return;
            }
        }
    }
}

/// The steps of the last changes at a state. Following a run costs what the steps between two states changed.
#[derive(Clone, Debug, Default)]
pub struct LastChanges {
    edition: u64,
    step: u64,
    nodes: Vec<u64>,
    elements: Vec<u64>,
}

impl LastChanges {
    /// Goes to a state of the run, or to the last one that is recorded.
    pub fn follow(&mut self, log: &ChangeLog, step: u64) {
        let step = step.min(log.nodes.last().map_or(0, |part| part.until()));
        if self.edition != log.edition {
            *self = LastChanges { edition: log.edition, ..LastChanges::default() };
        }
        for (steps, parts) in [(&mut self.nodes, &log.nodes), (&mut self.elements, &log.elements)] {
            if step < self.step {
                go_back(steps, parts, step, self.step);
            }
            walk(parts, self.step + 1, step, false, &mut |at, slots| {
                slots.iter().for_each(|&slot| set(steps, slot, at));
                false
            });
        }
        self.step = step;
    }

    /// The step that changed a node last; 0 where none did.
    pub fn of_node(&self, slot: u32) -> u64 {
        self.nodes.get(slot as usize).copied().unwrap_or(0)
    }

    /// The same for an element.
    pub fn of_element(&self, slot: u32) -> u64 {
        self.elements.get(slot as usize).copied().unwrap_or(0)
    }
}

fn set(steps: &mut Vec<u64>, slot: u32, at: u64) {
    let slot = slot as usize;
    if steps.len() <= slot {
        steps.resize(slot + 1, 0);
    }
    steps[slot] = at;
}

/// Looks up the changes before what the steps after `step` up to `now` changed.
fn go_back(steps: &mut [u64], parts: &[Arc<Part>], step: u64, now: u64) {
    let mut sought: Vec<u32> = Vec::new();
    walk(parts, step + 1, now, false, &mut |_, slots| {
        for &slot in slots {
            if std::mem::replace(&mut steps[slot as usize], SOUGHT) != SOUGHT {
                sought.push(slot);
            }
        }
        false
    });
    let mut left = sought.len();
    walk(parts, 1, step, true, &mut |at, slots| {
        for &slot in slots {
            let known = &mut steps[slot as usize];
            if *known == SOUGHT {
                *known = at;
                left -= 1;
            }
        }
        left == 0
    });
    for slot in sought {
        let known = &mut steps[slot as usize];
        if *known == SOUGHT {
            *known = 0;
        }
    }
}

/// Notices what changes during a conversion, by fingerprints of how things look.
#[derive(Clone, Debug, Default)]
pub(super) struct Changing {
    nodes: Vec<u64>,
    elements: Vec<u64>,
    /// What steps touched that may still be taken back.
    open: Touched,
    /// What may look different after a step, and what does.
    around: Touched,
    found: [Vec<u32>; 2],
}

impl Changing {
    pub fn of(mesh: &Mesh) -> Changing {
        let mut changing = Changing::default();
        mesh.nodes().for_each(|n| _ = differs(&mut changing.nodes, n.0, node(mesh, n)));
        mesh.elements().for_each(|e| _ = differs(&mut changing.elements, e.0, element(mesh, e)));
        changing
    }

    /// Notices what a step changed that touched this; `takes_back`: it may have taken back what the steps before it
    /// did since things were `settled` last.
    pub fn note(
        &mut self,
        mesh: &Mesh,
        touched: &Touched,
        step: u64,
        [settled, takes_back]: [bool; 2],
        log: &mut ChangeLog,
    ) {
        self.open.note_ids(touched.nodes(), touched.elements());
        let touched = if takes_back { &self.open } else { touched };
        let around = &mut self.around;
        around.note_ids(touched.nodes(), touched.elements());
        // A node moves the elements around it, and an element that is merged ends the live side of its nodes' edges.
        for &n in touched.nodes().iter().filter(|n| mesh.has_node(**n)) {
            mesh.elements_at(n).for_each(|e| around.note_ids(&[], &[e]));
        }
        for &e in touched.elements().iter().filter(|e| mesh.has_element(**e)) {
            mesh.corners(e).for_each(|n| around.note_ids(&[n], &[]));
        }
        let [nodes, elements] = &mut self.found;
        nodes.extend(around.nodes().iter().map(|n| n.0).filter(|&n| {
            let look = if mesh.has_node(NodeId(n)) { node(mesh, NodeId(n)) } else { ABSENT };
            differs(&mut self.nodes, n, look)
        }));
        elements.extend(around.elements().iter().map(|e| e.0).filter(|&e| {
            let look = if mesh.has_element(ElementId(e)) { element(mesh, ElementId(e)) } else { ABSENT };
            differs(&mut self.elements, e, look)
        }));
        log.push(step, nodes, elements);
        nodes.clear();
        elements.clear();
        around.clear();
        if settled {
            self.open.clear();
        }
    }
}

/// Sets how a slot looks; whether that is different.
fn differs(looks: &mut Vec<u64>, slot: u32, look: u64) -> bool {
    let slot = slot as usize;
    if looks.len() <= slot {
        looks.resize((slot + 1).next_power_of_two(), ABSENT);
    }
    std::mem::replace(&mut looks[slot], look) != look
}

/// A fingerprint of a node: its position, and its neighbours in any order, each with the element before it.
fn node(mesh: &Mesh, n: NodeId) -> u64 {
    let is_live = |e: ElementId| u64::from(mesh.is_triangle(e));
    let around = mesh.fan(n).map(|h| mixed((u64::from(mesh.target(h).0) << 1) | is_live(h.element())));
    place(mesh, n).wrapping_add(around.fold(0, u64::wrapping_add)).max(1)
}

/// A fingerprint of an element: its nodes with their positions.
fn element(mesh: &Mesh, e: ElementId) -> u64 {
    let corners = mesh.corners(e);
    corners.fold(1, |look: u64, n| mixed(look ^ mixed(u64::from(n.0)).wrapping_add(place(mesh, n)))).max(1)
}

fn place(mesh: &Mesh, n: NodeId) -> u64 {
    let uv = mesh.uv(n);
    mixed(uv.x.to_bits() ^ mixed(uv.y.to_bits()))
}

/// Mixes the bits of a number (splitmix64).
fn mixed(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::history::History;
    use crate::core::run::run::Run;
    use crate::core::run::watch::{Appearance, Watched};

    /// How everything looks in a state.
    fn looks(mesh: &Mesh) -> [Vec<Appearance>; 2] {
        let nodes = (0..mesh.node_slots() as u32).map(|n| Appearance::at(mesh, Watched::Node(NodeId(n))));
        let elements = (0..mesh.element_slots() as u32).map(|e| Appearance::at(mesh, Watched::Element(ElementId(e))));
        [nodes.collect(), elements.collect()]
    }

    #[test]
    fn the_last_changes_are_those_that_comparing_whole_states_finds_at_any_step() {
        for (name, scale) in [("example1", 2.5), ("two-faces", 2.0)] {
            let mut run = Run::of(built_in::named(name).unwrap().unwrap());
            run.parameters.size_scale *= scale;
            let mut history = History::open(run, &mut Nobody).unwrap();
            history.extend(u64::MAX);
            let end = history.end().unwrap();
            let stops = [0, 1, 2, 3, 40, end / 3, end / 3 + 1, end / 2, end - 1, end];
            // By comparing whole states, one step after the other.
            let mut expected = Vec::new();
            let mut before = looks(&history.state().mesh);
            let mut last = before.clone().map(|looks| vec![0; looks.len()]);
            let absent = Appearance::Absent;
            for step in 0..=end {
                history.seek(step).unwrap();
                let now = looks(&history.state().mesh);
                for ((last, before), now) in last.iter_mut().zip(&before).zip(&now) {
                    last.resize(last.len().max(now.len()), 0);
                    for (slot, last) in last.iter_mut().enumerate() {
                        let [was, is] = [before, now].map(|looks| looks.get(slot).unwrap_or(&absent));
                        if was != is {
                            *last = step;
                        }
                    }
                }
                before = now;
                if stops.contains(&step) {
                    expected.push((step, last.clone()));
                }
            }
            // Forwards, back and across.
            let mut changes = LastChanges::default();
            let order = (0..stops.len()).chain((0..stops.len()).rev()).chain([7, 2, 9, 4, 5, 4]);
            for (step, [nodes, elements]) in order.map(|k| &expected[k]) {
                history.seek(*step).unwrap();
                changes.follow(history.log().changes(), *step);
                let mesh = &history.state().mesh;
                for n in mesh.nodes() {
                    assert_eq!(changes.of_node(n.0), nodes[n.index()], "{name}: {n:?} at step {step}");
                }
                for e in mesh.elements() {
                    assert_eq!(changes.of_element(e.0), elements[e.index()], "{name}: {e:?} at step {step}");
                }
            }
            // The same as the window's links say.
            history.seek(end / 2).unwrap();
            changes.follow(history.log().changes(), end / 2);
            for n in history.state().mesh.nodes().step_by(11) {
                let told = history.touches(Watched::Node(n), 1).unwrap().pop().unwrap_or(0);
                assert_eq!(changes.of_node(n.0), told, "{name}: {n:?}");
            }
        }
    }

    #[test]
    fn a_log_that_was_cut_and_goes_on_is_looked_up_anew() {
        let mut log = ChangeLog::default();
        for step in 1..=10 {
            log.push(step, &[step as u32 % 3], &[0]);
        }
        let mut later = ChangeLog::default();
        later.push(11, &[5], &[]);
        log.append(later);
        let mut changes = LastChanges::default();
        let nodes = |changes: &LastChanges| [0, 1, 2, 5].map(|slot| changes.of_node(slot));
        changes.follow(&log, 11);
        assert_eq!((nodes(&changes), changes.of_element(0)), ([9, 10, 8, 11], 10));
        changes.follow(&log, 2);
        assert_eq!((nodes(&changes), changes.of_element(0)), ([0, 1, 2, 0], 2));
        changes.follow(&log, 11);
        log.truncate(7);
        log.push(8, &[7], &[]);
        changes.follow(&log, 8);
        assert_eq!((nodes(&changes), changes.of_node(7), changes.of_element(0)), ([6, 7, 5, 0], 8, 7));
        log.truncate(0);
        changes.follow(&log, 0);
        assert_eq!(nodes(&changes), [0; 4]);
    }
}
