//! The columns of the tables of elements and nodes, and how their rows are named and found.

use crate::app::window::lists::{ListKind, Lister, Lists};
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::words;
use crate::core::kernel::condition::Value;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::{ElementRow, NodeRow, Row, Steps};
use crate::render::scene::Outlined;

/// The heading of a column.
#[derive(Clone, Copy, Debug)]
pub struct Head {
    /// The field, by its index.
    pub field: usize,
    pub name: &'static str,
    /// Its space and unit.
    pub unit: &'static str,
    /// In points.
    pub width: f32,
    pub decimals: Decimals,
}

impl Head {
    /// Its name with space and unit.
    pub fn whole(&self) -> String {
        if self.unit.is_empty() { self.name.to_owned() } else { format!("{}, {}", self.name, self.unit) }
    }
}

/// How a number is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decimals {
    Whole,
    Fixed(usize),
    /// A size in units of the case.
    Size,
}

/// Something that has a table.
pub trait Described: Row + Send + 'static {
    const KIND: ListKind;
    /// The index of the field by which the table is sorted at first.
    const FIRST: usize;
    /// The name of the field for a condition, and what it shows while it is empty.
    const FILTER: &'static str;
    const HINT: &'static str;

    fn heads(moment: &Moment) -> Vec<Head>;
    fn lister(lists: &Lists) -> &Lister<Self>;
    /// The steps of birth by slot.
    fn born(state: &State, moment: &Moment) -> Vec<u64>;
    fn row(moment: &Moment, slot: u32, steps: Steps) -> Option<Self>;
    fn outlined(slot: u32) -> Outlined;
    fn slot(what: Outlined) -> Option<u32>;
    /// Its name for screen readers.
    fn name(&self) -> String;
}

/// The width of a size or a coordinate such as −1.25e−16.
const SIZE: f32 = 65.0;

const ELEMENTS: [(&str, &str, &str, f32, Decimals); 18] = [
    ("id", "number", "", 50.0, Decimals::Whole),
    ("quad", "kind", "", 36.0, Decimals::Whole),
    ("quality", "quality", "metric", 47.0, Decimals::Fixed(3)),
    ("min_angle", "angle min", "metric °", 58.0, Decimals::Fixed(1)),
    ("max_angle", "angle max", "metric °", 60.0, Decimals::Fixed(1)),
    ("born", "step of", "birth", 52.0, Decimals::Whole),
    ("changed", "last", "change", 52.0, Decimals::Whole),
    ("level", "level", "", 34.0, Decimals::Whole),
    ("jacobian", "Jacobian", "metric", 54.0, Decimals::Fixed(3)),
    ("area", "area", "metric", 44.0, Decimals::Fixed(2)),
    ("length.min", "side min", "metric", 54.0, Decimals::Fixed(2)),
    ("length.max", "side max", "metric", 56.0, Decimals::Fixed(2)),
    ("space.min_angle", "angle min", "space °", 58.0, Decimals::Fixed(1)),
    ("space.max_angle", "angle max", "space °", 60.0, Decimals::Fixed(1)),
    ("space.jacobian", "Jacobian", "space", 54.0, Decimals::Fixed(3)),
    ("space.area", "area", "space", SIZE, Decimals::Size),
    ("space.length.min", "side min", "space", SIZE, Decimals::Size),
    ("space.length.max", "side max", "space", SIZE, Decimals::Size),
];

const NODES: [(&str, &str, &str, f32, Decimals); 8] = [
    ("id", "number", "", 50.0, Decimals::Whole),
    ("valence", "valence", "edges", 48.0, Decimals::Whole),
    ("irregular", "irregular", "", 54.0, Decimals::Whole),
    ("place", "place", "", 60.0, Decimals::Whole),
    ("born", "step of", "birth", 52.0, Decimals::Whole),
    ("changed", "last", "change", 52.0, Decimals::Whole),
    ("x", "x", "space", SIZE, Decimals::Size),
    ("y", "y", "space", SIZE, Decimals::Size),
];

const ON_SURFACES: [(&str, &str, &str, f32, Decimals); 3] = [
    ("z", "z", "space", SIZE, Decimals::Size),
    ("u", "u", "parametric", SIZE, Decimals::Size),
    ("v", "v", "parametric", SIZE, Decimals::Size),
];

const FACE: (&str, &str, &str, f32, Decimals) = ("face", "face", "", 34.0, Decimals::Whole);

fn head<R: Row>((field, name, unit, width, decimals): (&str, &'static str, &'static str, f32, Decimals)) -> Head {
    let field = R::FIELDS.iter().position(|known| known.name == field).unwrap_or(0);
    Head { field, name, unit, width, decimals }
}

impl Described for ElementRow {
    const KIND: ListKind = ListKind::Elements;
    const FIRST: usize = 3;
    const FILTER: &'static str = "Filter of elements";
    const HINT: &'static str = "filter, e.g. quality < .3 && level > 2";

    fn heads(_: &Moment) -> Vec<Head> {
        ELEMENTS.into_iter().chain([FACE]).map(head::<ElementRow>).collect()
    }

    fn lister(lists: &Lists) -> &Lister<ElementRow> {
        &lists.elements
    }

    fn born(state: &State, moment: &Moment) -> Vec<u64> {
        state.run().born.of_quads(moment.step, moment.mesh.element_slots())
    }

    fn row(moment: &Moment, slot: u32, steps: Steps) -> Option<ElementRow> {
        ElementRow::of(&moment.mesh, ElementId(slot), steps)
    }

    fn outlined(slot: u32) -> Outlined {
        Outlined::Element(ElementId(slot))
    }

    fn slot(what: Outlined) -> Option<u32> {
        if let Outlined::Element(e) = what { Some(e.0) } else { None }
    }

    fn name(&self) -> String {
        format!("{} {}", if self.is_live { "Triangle" } else { "Quadrilateral" }, self.element.0)
    }
}

impl Described for NodeRow {
    const KIND: ListKind = ListKind::Nodes;
    const FIRST: usize = 0;
    const FILTER: &'static str = "Filter of nodes";
    const HINT: &'static str = "filter, e.g. irregular && place == inside";

    fn heads(moment: &Moment) -> Vec<Head> {
        let on_surfaces = if moment.mesh.embedding().is_some() { &ON_SURFACES[..] } else { &[] };
        NODES.into_iter().chain(on_surfaces.iter().copied()).chain([FACE]).map(head::<NodeRow>).collect()
    }

    fn lister(lists: &Lists) -> &Lister<NodeRow> {
        &lists.nodes
    }

    fn born(state: &State, moment: &Moment) -> Vec<u64> {
        state.run().born.of_nodes(moment.step, moment.mesh.node_slots())
    }

    fn row(moment: &Moment, slot: u32, steps: Steps) -> Option<NodeRow> {
        NodeRow::of(&moment.mesh, NodeId(slot), steps)
    }

    fn outlined(slot: u32) -> Outlined {
        Outlined::Node(NodeId(slot))
    }

    fn slot(what: Outlined) -> Option<u32> {
        if let Outlined::Node(n) = what { Some(n.0) } else { None }
    }

    fn name(&self) -> String {
        format!("Node {}", self.node.0)
    }
}

/// A value of a row as the table shows it.
pub fn text<R: Row>(row: &R, field: usize, decimals: Decimals) -> String {
    match row.value(field) {
        None => words::UNDEFINED.to_owned(),
        Some(Value::Number(number)) => match decimals {
            Decimals::Whole => words::grouped(number as u64),
            Decimals::Fixed(decimals) => words::fixed(number, decimals),
            Decimals::Size => words::size(number),
        },
        Some(Value::Flag(flag)) if R::FIELDS[field].name == "quad" => (if flag { "quad" } else { "tri" }).to_owned(),
        Some(Value::Flag(flag)) => (if flag { "yes" } else { "" }).to_owned(),
        Some(Value::Word(word)) => word.to_owned(),
    }
}
