//! Numbers of a state that a text puts in, such as `{{theta_A}}`.

use super::attributes::shortened;
use super::subject::Subject;
use crate::core::fault::Fault;
use crate::core::kernel::number::{degrees, fixed, grouped, size};
use crate::core::kernel::spelling::suggestion;
use crate::core::kernel::worded::worded;
use crate::core::mesh::NodeId;
use crate::core::run::FrontTable;
use crate::core::run::explain::{edge, segment};
use crate::core::run::front_table::Row;

worded! {
    /// A number of the state.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Quantity by name {
        /// The step.
        Step = "step",
        /// Quadrilaterals that stand.
        Quads = "NQ",
        /// Live triangles.
        Live = "live",
        /// Front segments.
        Segments = "segments",
        /// Loops of the front.
        Loops = "loops",
        /// The base, or the next one.
        Base = "base",
        /// The top edge.
        Top = "top",
        /// Node A.
        A = "A",
        /// Node B.
        B = "B",
        /// Node C.
        C = "C",
        /// Node D.
        D = "D",
        /// The class of the base, or of the next one.
        Class = "class",
        /// Its frontal angle at A.
        ThetaA = "theta_A",
        /// That at B.
        ThetaB = "theta_B",
        /// Its H-value.
        H = "H",
        /// Its metric length.
        Length = "l_AB",
        /// Its key.
        Key = "key",
        /// The smallest H-value of the front.
        HMin = "H_min",
        /// The reach, c Hmin.
        Reach = "reach",
        /// The factor c.
        C2 = "c",
        /// The bound theta_rect.
        ThetaRect = "theta_rect",
        /// The bound theta_seam.
        ThetaSeam = "theta_seam",
        /// The number of edges across the top.
        Crossings = "crossings",
    }
}

impl Quantity {
    /// Reads the name of a number; the fault has no place yet.
    pub(super) fn read(name: &str) -> Result<Quantity, Fault> {
        let name = name.trim();
        Quantity::ALL.into_iter().find(|quantity| quantity.name() == name).ok_or_else(|| {
            let known = || Quantity::ALL.iter().map(|quantity| quantity.name());
            let remedy = suggestion(name, known());
            let remedy = remedy.unwrap_or_else(|| format!("Known are {}", known().collect::<Vec<_>>().join(", ")));
            Fault::new(format!("There is no number {{{{{}}}}}", shortened(name))).remedy(remedy)
        })
    }

    /// Its text at a state; `None` where the state does not have it.
    pub(super) fn text(self, subject: &Subject) -> Option<String> {
        let Subject { state, .. } = subject;
        let letter = |k: usize| subject.corners[k].map(|node: NodeId| node.0.to_string());
        let table = || FrontTable::of(state);
        let row = |table: &FrontTable| -> Option<Row> {
            match subject.base() {
                Some([a, b]) => table.find(a, b).copied(),
                None => table.choice().copied(),
            }
        };
        let of_row = |text: &dyn Fn(&Row) -> String| row(&table()).map(|row| text(&row));
        let degrees_of = |angle: f64| format!("{}\u{b0}", degrees(angle));
        let bound = |angle: f64| Some(format!("{}\u{b0}", fixed(angle.to_degrees(), 0)));
        match self {
            Quantity::Step => Some(grouped(state.counts.steps)),
            Quantity::Quads => Some(grouped(state.standing())),
            Quantity::Live => {
                Some(grouped(state.mesh.elements().filter(|&e| state.mesh.is_triangle(e)).count() as u64))
            }
            Quantity::Segments => Some(grouped(table().rows.len() as u64)),
            Quantity::Loops => Some(grouped(table().loops.len() as u64)),
            Quantity::Base => of_row(&|row| segment([row.a, row.b])),
            Quantity::Top => Some(edge([subject.corners[2]?, subject.corners[3]?])),
            Quantity::A => letter(0),
            Quantity::B => letter(1),
            Quantity::C => letter(2),
            Quantity::D => letter(3),
            Quantity::Class => of_row(&|row| row.class.to_string()),
            Quantity::ThetaA => of_row(&|row| degrees_of(row.theta[0])),
            Quantity::ThetaB => of_row(&|row| degrees_of(row.theta[1])),
            Quantity::H => of_row(&|row| size(row.h_value)),
            Quantity::Length => of_row(&|row| fixed(row.length_metric, 3)),
            Quantity::Key => of_row(&|row| size(row.window)),
            Quantity::HMin => Some(table().h_min).filter(|h| h.is_finite()).map(size),
            Quantity::Reach => Some(table().reach()).filter(|h| h.is_finite()).map(size),
            Quantity::C2 => Some(format!("{}", state.parameters().c)),
            Quantity::ThetaRect => bound(state.parameters().theta_rect),
            Quantity::ThetaSeam => bound(state.parameters().theta_seam),
            Quantity::Crossings => state.top_crossings().map(|crossings| grouped(crossings.len() as u64)),
        }
    }
}
