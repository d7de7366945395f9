//! The steps that made quadrilaterals and nodes, recorded during a conversion, for files, figures and lists.

use crate::core::convert::Converter;
use crate::core::mesh::{ElementId, Mesh, NodeId, Touched};

/// The step that made each quadrilateral: the last step that turned its element into a quadrilateral, regardless of
/// later changes (as [`History::made`](super::history::History::made) defines it).
#[derive(Clone, Debug, Default)]
pub struct Births {
    steps: Vec<Option<u64>>,
    touched: Touched,
}

impl Births {
    /// For a mesh at the beginning of a conversion: its quadrilaterals were made at step 0.
    pub fn of(mesh: &Mesh) -> Births {
        let mut births = Births::default();
        mesh.elements().for_each(|e| births.see(mesh, e, 0));
        births
    }

    /// Records the quadrilaterals that the last step made. The converter must keep a history of at least that step.
    pub fn note(&mut self, converter: &Converter<'_>) {
        let mut touched = std::mem::take(&mut self.touched);
        converter.note_last_step(&mut touched);
        touched.elements().iter().for_each(|e| self.see(&converter.mesh, *e, converter.counts.steps));
        touched.clear();
        self.touched = touched;
    }

    /// The step that made a quadrilateral; `None` for other elements.
    pub fn step(&self, element: ElementId) -> Option<u64> {
        self.steps.get(element.index()).copied().flatten()
    }

    fn see(&mut self, mesh: &Mesh, element: ElementId, step: u64) {
        if self.steps.len() <= element.index() {
            self.steps.resize(element.index() + 1, None);
        }
        let known = &mut self.steps[element.index()];
        if mesh.has_element(element) && mesh.is_quad(element) {
            known.get_or_insert(step);
        } else {
            *known = None;
        }
    }
}

/// The steps at which quadrilaterals and nodes appeared, in their order; what stood at step 0 is not among them. The
/// last entry of a slot up to a step is about what stands there after it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Born {
    /// Elements that became quadrilaterals.
    pub quads: Vec<(u64, ElementId)>,
    /// Nodes.
    pub nodes: Vec<(u64, NodeId)>,
}

impl Born {
    /// Appends what appeared later.
    pub fn append(&mut self, later: &Born) {
        self.quads.extend(&later.quads);
        self.nodes.extend(&later.nodes);
    }

    /// What appeared after a step.
    #[must_use]
    pub fn after(&self, step: u64) -> Born {
        Born {
            quads: self.quads[self.quads.partition_point(|born| born.0 <= step)..].to_vec(),
            nodes: self.nodes[self.nodes.partition_point(|born| born.0 <= step)..].to_vec(),
        }
    }

    /// Drops what appeared after a step.
    pub fn truncate(&mut self, step: u64) {
        self.quads.truncate(self.quads.partition_point(|born| born.0 <= step));
        self.nodes.truncate(self.nodes.partition_point(|born| born.0 <= step));
    }

    /// The steps that made the quadrilaterals which stand after a step, by slot: 0 where nothing is recorded. Slots
    /// without a quadrilateral have some number too.
    pub fn of_quads(&self, step: u64, slots: usize) -> Vec<u64> {
        by_slot(self.quads.iter().map(|born| (born.0, born.1.index())), step, slots)
    }

    /// The same for nodes.
    pub fn of_nodes(&self, step: u64, slots: usize) -> Vec<u64> {
        by_slot(self.nodes.iter().map(|born| (born.0, born.1.index())), step, slots)
    }

    /// The memory it takes, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.quads.capacity() * size_of::<(u64, ElementId)>() + self.nodes.capacity() * size_of::<(u64, NodeId)>()
    }
}

fn by_slot(born: impl Iterator<Item = (u64, usize)>, step: u64, slots: usize) -> Vec<u64> {
    let mut steps = vec![0; slots];
    for (at, slot) in born.take_while(|born| born.0 <= step) {
        if let Some(known) = steps.get_mut(slot) {
            *known = at;
        }
    }
    steps
}

/// Notices what appears during a conversion.
#[derive(Clone, Debug, Default)]
pub(super) struct Appearing {
    quads: Vec<bool>,
    nodes: Vec<bool>,
    /// What steps touched that may still be taken back.
    open: Touched,
}

impl Appearing {
    pub fn of(mesh: &Mesh) -> Appearing {
        let mut appearing = Appearing::default();
        let mut nothing = Born::default();
        mesh.elements().for_each(|e| appearing.element(mesh, e, 0, &mut nothing));
        mesh.nodes().for_each(|n| appearing.node(mesh, n, 0, &mut nothing));
        appearing
    }

    /// Notices what a step made that touched this. Until it is `settled`, a later step may take it back.
    pub fn note(&mut self, mesh: &Mesh, touched: &Touched, step: u64, settled: bool, born: &mut Born) {
        let mut open = std::mem::take(&mut self.open);
        open.note_ids(touched.nodes(), touched.elements());
        open.elements().iter().for_each(|&e| self.element(mesh, e, step, born));
        open.nodes().iter().for_each(|&n| self.node(mesh, n, step, born));
        if settled {
            open.clear();
        }
        self.open = open;
    }

    fn element(&mut self, mesh: &Mesh, e: ElementId, step: u64, born: &mut Born) {
        if turns(&mut self.quads, e.index(), mesh.has_element(e) && mesh.is_quad(e)) {
            born.quads.push((step, e));
        }
    }

    fn node(&mut self, mesh: &Mesh, n: NodeId, step: u64, born: &mut Born) {
        if turns(&mut self.nodes, n.index(), mesh.has_node(n)) {
            born.nodes.push((step, n));
        }
    }
}

/// Sets a flag; whether it turns from false to true.
fn turns(flags: &mut Vec<bool>, index: usize, flag: bool) -> bool {
    if flags.len() <= index {
        flags.resize((index + 1).next_power_of_two(), false);
    }
    let before = std::mem::replace(&mut flags[index], flag);
    flag && !before
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::convert::Phase;
    use crate::core::progress::Nobody;
    use crate::core::run::history::{BUDGET, History};
    use crate::core::run::run::Run;

    #[test]
    fn births_are_the_steps_that_a_history_finds() {
        let mut run = Run::of(built_in::named("two-faces").unwrap().unwrap());
        run.parameters.size_scale *= 2.0;
        let background = run.background(&mut Nobody).unwrap();
        let mut history = History::of(run.clone(), &background, BUDGET).unwrap();
        history.seek(u64::MAX).unwrap();
        let mut converter = run.start(&background).unwrap();
        converter.keep_history();
        let mut births = Births::of(&converter.mesh);
        while *converter.phase() != Phase::Done {
            converter.step().unwrap();
            births.note(&converter);
            converter.shorten_history(1);
        }
        let quads: Vec<_> = converter.mesh.elements().collect();
        assert!(quads.len() > 20, "{}", quads.len());
        for e in quads {
            assert_eq!(births.step(e), history.made(e).unwrap(), "{e:?}");
        }
    }

    #[test]
    fn what_is_born_is_recorded_as_a_history_finds_it_at_any_step() {
        let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
        run.parameters.size_scale = 2.0;
        let mut history = History::open(run, &mut Nobody).unwrap();
        history.seek(u64::MAX).unwrap();
        let end = history.step();
        for step in [0, 40, 41, 42, 43, end / 3, end / 2, end / 2 + 1, end - 7, end] {
            history.seek(step).unwrap();
            let mesh = history.state().mesh.without_journal();
            let steps = history.log().born().of_quads(step, mesh.element_slots());
            for e in mesh.elements().filter(|e| mesh.is_quad(*e)) {
                assert_eq!(Some(steps[e.index()]), history.made(e).unwrap(), "{e:?} at step {step}");
            }
            // A node is born where it last began to exist.
            let steps = history.log().born().of_nodes(step, mesh.node_slots());
            for n in mesh.nodes().filter(|n| n.0 % 5 == 0 || n.0 > mesh.node_slots() as u32 - 20) {
                let expected = steps[n.index()];
                let exists = |history: &mut History, step| {
                    history.seek(step).unwrap();
                    history.state().mesh.has_node(n)
                };
                assert!(exists(&mut history, expected), "{n:?} at step {step}");
                assert!(expected == 0 || !exists(&mut history, expected - 1), "{n:?} at step {step}");
                let later = (1..6).map(|k| expected + k * (step - expected) / 6);
                assert!(later.into_iter().all(|step| exists(&mut history, step)), "{n:?} at step {step}");
            }
        }
    }
}
