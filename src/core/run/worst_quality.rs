//! The quadrilateral of the lowest quality in the current state, at a cost that depends on what changes.

use super::history::Changes;
use crate::core::mesh::{ElementId, Mesh};

/// Number of elements that share a minimum.
const CHUNK: usize = 128;

/// The qualities of all quadrilaterals, kept up to date.
#[derive(Clone, Debug, Default)]
pub struct WorstQuality {
    /// By slot; infinite where there is no quadrilateral.
    values: Vec<f64>,
    /// The place of the lowest value of each chunk.
    lowest: Vec<usize>,
    stale: Vec<bool>,
}

impl WorstQuality {
    /// Measures again what has changed since the last call.
    pub fn follow(&mut self, mesh: &Mesh, changes: &Changes) {
        let slots = mesh.element_slots();
        let chunks = slots.div_ceil(CHUNK);
        if slots < self.values.len() {
            // A chunk that lost slots at its end may have lost its lowest value.
            self.stale.truncate(chunks);
            self.stale.last_mut().into_iter().for_each(|stale| *stale = true);
        }
        self.values.resize(slots, f64::INFINITY);
        self.lowest.resize(chunks, 0);
        self.stale.resize(chunks, true);
        match changes {
            Changes::Everything => (0..slots as u32).for_each(|slot| self.measure(mesh, ElementId(slot))),
            Changes::Some { nodes, elements } => {
                elements.iter().for_each(|&e| self.measure(mesh, e));
                for &node in nodes.iter().filter(|&&node| mesh.has_node(node)) {
                    mesh.elements_at(node).for_each(|e| self.measure(mesh, e));
                }
            }
        }
    }

    fn measure(&mut self, mesh: &Mesh, e: ElementId) {
        let Some(value) = self.values.get_mut(e.index()) else { return };
        *value = if mesh.has_element(e) && mesh.is_quad(e) { mesh.quality(e) } else { f64::INFINITY };
        self.stale[e.index() / CHUNK] = true;
    }

    /// The quadrilateral of the lowest quality, with its quality; the first of several.
    pub fn worst(&mut self) -> Option<(ElementId, f64)> {
        let values = &self.values;
        let lower = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        for (chunk, lowest) in self.lowest.iter_mut().enumerate() {
            if std::mem::take(&mut self.stale[chunk]) {
                let places = chunk * CHUNK..values.len().min((chunk + 1) * CHUNK);
                *lowest = places.min_by(lower).unwrap_or(0);
            }
        }
        let place = self.lowest.iter().copied().min_by(lower)?;
        values[place].is_finite().then(|| (ElementId(place as u32), values[place]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::History;
    use crate::core::run::history::BUDGET;
    use crate::core::run::run::Run;

    #[test]
    fn the_worst_quadrilateral_is_that_of_the_whole_mesh_wherever_one_goes() {
        let run = Run::of(built_in::named("two-faces").unwrap().unwrap());
        let background = run.background(&mut Nobody).unwrap();
        let mut history = History::of(run, &background, BUDGET).unwrap();
        history.seek(u64::MAX).unwrap();
        let end = history.step();
        let mut kept = WorstQuality::default();
        history.seek(0).unwrap();
        kept.follow(&history.state().mesh, &Changes::Everything);
        history.take_changes();
        assert_eq!(kept.worst(), None);
        let steps = (1..end).step_by(7).chain((1..end).rev().step_by(11)).chain([end, 3, end / 2, end]);
        for step in steps {
            history.seek(step).unwrap();
            let changes = history.take_changes();
            let mesh = &history.state().mesh;
            kept.follow(mesh, &changes);
            let all = mesh.elements().filter(|&e| mesh.is_quad(e)).map(|e| (e, mesh.quality(e)));
            let expected = all.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            assert_eq!(kept.worst(), expected, "step {step}");
        }
    }
}
