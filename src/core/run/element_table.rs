//! The table of the elements of a state: their measures, for lists that are sorted and filtered.

use super::explain::ElementFacts;
use super::history::Changes;
use super::last_changes::LastChanges;
use super::listing::{Listed, Row, Steps, fields};
use crate::core::kernel::condition::Holds::{Degrees, Flag, Number};
use crate::core::kernel::condition::{Field, Value};
use crate::core::mesh::{ElementId, Mesh};

/// An element with its measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementRow {
    /// Its id.
    pub element: ElementId,
    /// True for a live triangle, false for a dead quadrilateral.
    pub is_live: bool,
    /// Quality, 0 to 1, in the metric (docs/algorithm.md, "Quality").
    pub quality: f64,
    /// Smallest and largest angle in the metrics of its nodes, degrees.
    pub angles_metric: [f64; 2],
    /// Smallest and largest angle between straight sides in space, degrees.
    pub angles_space: [f64; 2],
    /// Area in the metric.
    pub area_metric: f64,
    /// Area in space.
    pub area_space: f64,
    /// Its shortest and its longest side in the metric.
    pub lengths_metric: [f64; 2],
    /// Its shortest and its longest side in space.
    pub lengths_space: [f64; 2],
    /// Scaled Jacobian in the metric; `None` for a triangle.
    pub jacobian_metric: Option<f64>,
    /// Scaled Jacobian in space, in the tangent plane of each corner; `None` for a triangle.
    pub jacobian_space: Option<f64>,
    /// Rows from the boundary; 0 for a triangle.
    pub level: u16,
    /// Its face, from 1.
    pub face: u32,
    /// The step that made the quadrilateral; 0 where it was given, `None` for a triangle.
    pub born: Option<u64>,
    /// The last step that moved or changed it; 0 where none did.
    pub changed: u64,
}

fields! {
    ElementRow;
    "id": Number, "number of the element" => |e| Value::number(e.element.0);
    "triangle": Flag, "it is a live triangle" => |e| Some(Value::Flag(e.is_live));
    "quad": Flag, "it is a dead quadrilateral" => |e| Some(Value::Flag(!e.is_live));
    "quality": Number, "quality in the metric, 0 to 1" => |e| Value::number(e.quality);
    "min_angle": Degrees, "smallest angle in the metric" => |e| Value::number(e.angles_metric[0]);
    "max_angle": Degrees, "largest angle in the metric" => |e| Value::number(e.angles_metric[1]);
    "space.min_angle": Degrees, "smallest angle in space, between straight sides" =>
        |e| Value::number(e.angles_space[0]);
    "space.max_angle": Degrees, "largest angle in space, between straight sides" =>
        |e| Value::number(e.angles_space[1]);
    "jacobian": Number, "scaled Jacobian in the metric: the smallest sine of a corner, quadrilaterals only" =>
        |e| e.jacobian_metric.and_then(Value::number);
    "space.jacobian": Number, "scaled Jacobian in space, quadrilaterals only" =>
        |e| e.jacobian_space.and_then(Value::number);
    "area": Number, "area in the metric; 1 is a unit square" => |e| Value::number(e.area_metric);
    "space.area": Number, "area in space, in square units of the case" => |e| Value::number(e.area_space);
    "length.min": Number, "shortest side in the metric" => |e| Value::number(e.lengths_metric[0]);
    "length.max": Number, "longest side in the metric" => |e| Value::number(e.lengths_metric[1]);
    "space.length.min": Number, "shortest side in space, in units of the case" => |e| Value::number(e.lengths_space[0]);
    "space.length.max": Number, "longest side in space, in units of the case" => |e| Value::number(e.lengths_space[1]);
    "level": Number, "row of a quadrilateral, counted from the boundary" =>
        |e| (!e.is_live).then(|| Value::Number(e.level.into()));
    "face": Number, "face of the case, from 1" => |e| Value::number(e.face);
    "born": Number, "step that made the quadrilateral; 0 where it was given" =>
        |e| e.born.map(|step| Value::Number(step as f64));
    "changed": Number, "last step that moved or changed it; 0 where none did" =>
        |e| Value::number(e.changed as f64);
}

impl ElementRow {
    /// Measures an element that these steps made and changed; `None` where it does not exist.
    pub fn of(mesh: &Mesh, element: ElementId, steps: Steps) -> Option<ElementRow> {
        let facts = ElementFacts::of(mesh, element)?;
        let [jacobian_metric, jacobian_space] = facts.jacobians.map_or([None; 2], |pair| pair.map(Some));
        Some(ElementRow {
            element,
            is_live: facts.is_live,
            quality: facts.quality,
            angles_metric: extremes(&facts.angles_metric),
            angles_space: extremes(&facts.angles_physical),
            area_metric: facts.area_metric,
            area_space: facts.area,
            lengths_metric: extremes(&facts.lengths_metric),
            lengths_space: extremes(&facts.lengths_physical),
            jacobian_metric,
            jacobian_space,
            level: facts.level,
            face: facts.region + 1,
            born: (!facts.is_live).then_some(steps.born),
            changed: steps.changed,
        })
    }
}

/// The smallest and the largest of some values.
fn extremes(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| [low.min(value), high.max(value)])
}

impl Row for ElementRow {
    const FIELDS: &'static [Field] = FIELDS;

    fn value(&self, field: usize) -> Option<Value> {
        VALUES[field](self)
    }

    fn slots(mesh: &Mesh) -> usize {
        mesh.element_slots()
    }

    fn measure(mesh: &Mesh, slot: u32) -> Option<ElementRow> {
        ElementRow::of(mesh, ElementId(slot), Steps::default())
    }

    fn set_steps(&mut self, steps: Steps) {
        self.born = (!self.is_live).then_some(steps.born);
        self.changed = steps.changed;
    }

    fn last_change(changes: &LastChanges, slot: u32) -> u64 {
        changes.of_element(slot)
    }

    fn touched(mesh: &Mesh, changes: &Changes, touch: &mut dyn FnMut(u32)) {
        let Changes::Some { nodes, elements } = changes else { return };
        elements.iter().for_each(|e| touch(e.0));
        for &node in nodes.iter().filter(|&&node| mesh.has_node(node)) {
            mesh.elements_at(node).for_each(|e| touch(e.0));
        }
    }
}

/// The elements of a state, kept up to date.
pub type ElementTable = Listed<ElementRow>;
