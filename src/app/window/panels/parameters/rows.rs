//! The rows of the panel: every parameter that can change at a step, in groups, and those that belong to the case.

use crate::core::case::Parameters;
use crate::core::kernel::Shortest;

/// A group of parameters.
pub struct Group {
    pub name: &'static str,
    pub rows: &'static [Row],
}

/// A parameter in the panel.
pub struct Row {
    pub key: &'static str,
    /// Its name in the panel.
    pub name: &'static str,
    pub kind: Kind,
    /// What it does, with its source.
    pub tip: &'static str,
}

/// How a parameter is set.
pub enum Kind {
    /// By a slider with this range, wider where the value is outside, and a field: decimals of a drag, unit.
    Number([f64; 2], usize, &'static str),
    /// By a list of words with their names.
    Choice(&'static [(&'static str, &'static str)]),
    /// By a check box.
    Switch,
}

use Kind::{Choice, Number, Switch};

const fn row(key: &'static str, name: &'static str, kind: Kind, tip: &'static str) -> Row {
    Row { key, name, kind, tip }
}

/// Every parameter that can change at a step.
pub const GROUPS: [Group; 5] = [
    Group {
        name: "Selection",
        rows: &[
            row(
                "selection",
                "select by",
                Choice(&[
                    ("table1", "table 1 (paper)"),
                    ("shortest", "shortest segment"),
                    ("smallest_angle", "smallest frontal angle"),
                    ("level", "by rows, as in Q-Morph"),
                ]),
                "Which front segment the next quadrilateral grows from (4.3.3, table 1).",
            ),
            row(
                "selection_window",
                "compare",
                Choice(&[
                    ("metric_length_times_h", "metric length × H"),
                    ("h_value", "H-value (eq. 6)"),
                    ("physical_length", "length in space (paper)"),
                ]),
                "What must be below c Hmin for a segment to be within reach (4.3.3, steps ii and iii).",
            ),
            row(
                "h_min_over",
                "Hmin over",
                Choice(&[("front", "the whole front (paper)"), ("waiting", "segments not deferred")]),
                "The segments over which Hmin, the smallest H-value, is taken (4.3.3, step i).",
            ),
            row(
                "c",
                "factor c",
                Number([0.5, 4.0], 2, ""),
                "The factor of Hmin in steps ii and iii of the selection (4.3.3). The paper allows 1.5 to 2.0 and used \
                 2.0.",
            ),
            row(
                "theta_rect",
                "θ rect",
                Number([90.0, 180.0], 1, "°"),
                "Below this frontal angle the neighbouring front segment is the side edge (4.3.4, ii), and the segment is \
                 of a lower class (table 1, fig. 12).",
            ),
            row(
                "layers",
                "offset rows",
                Number([0.0, 20.0], 0, ""),
                "Rows of quadrilaterals that are made along the boundary before any other segment is chosen (4.3.3, point \
                 3, boundary offsetting).",
            ),
        ],
    },
    Group {
        name: "Sides and top",
        rows: &[
            row(
                "bisector",
                "aim sides at the bisector",
                Switch,
                "Aim a side edge at the bisector of a frontal angle up to 225°. Off: always at the right angle (4.3.4, \
                 iii, eq. 8).",
            ),
            row(
                "side_deviation",
                "deviation",
                Number([0.0, 90.0], 1, "°"),
                "The largest deviation of an existing edge from the direction that a side aims at (4.3.4, iii, eq. 8).",
            ),
            row(
                "side_split",
                "divide over",
                Number([1.0, 4.0], 2, "×"),
                "A live side edge longer than this times the base, in the metric, is divided (4.3.4, vi).",
            ),
            row(
                "whole_below",
                "but not below",
                Number([0.0, 2.0], 2, ""),
                "A side edge shorter than this in the metric is not divided. The paper has no such limit (4.3.4, vi).",
            ),
            row(
                "division_at",
                "divide at",
                Choice(&[("metric_middle", "half the metric length"), ("midpoint", "the midpoint (paper)")]),
                "Where an edge is divided (4.2.3).",
            ),
            row(
                "first_rescue",
                "on failure",
                Choice(&[("division", "divide the sides"), ("left_neighbour", "left neighbour (paper)")]),
                "What is tried first when a quadrilateral cannot be formed: dividing its sides, or replacing the right \
                 side by its left-hand neighbour (4.3.4, last part of \"Definition of top edge\").",
            ),
            row(
                "top_smoothing",
                "smooth around the left top",
                Switch,
                "After each swap for the top edge, smooth around its left node C (4.3.4, top edge, v).",
            ),
        ],
    },
    Group {
        name: "Around each quad",
        rows: &[
            row(
                "placement",
                "place new top nodes",
                Switch,
                "Place the new top nodes of each quadrilateral by rules of this program. Off: they move only as other \
                 nodes do (4.3.6, eq. 9).",
            ),
            row("smoothing", "smooth", Switch, "Smooth the nodes around each new quadrilateral (4.3.6, eq. 9)."),
            row(
                "smooth_joined",
                "smooth joined nodes too",
                Switch,
                "Smooth also the nodes that only dead elements join to the new quadrilateral: the second of three groups \
                 (4.3.6, local mesh smoothing).",
            ),
            row(
                "smoothing_weights",
                "weights",
                Choice(&[("determinant", "mean of √det M"), ("printed", "as printed (paper)")]),
                "The areas that weigh the elements around a node: area in the plane times the mean of √det M, or lengths \
                 and angles as in eqs. 10a and 10b (4.3.6).",
            ),
            row(
                "enhancement",
                "enhance",
                Switch,
                "Swap edges and delete nodes around each new quadrilateral (4.3.6, local structural enhancement).",
            ),
            row(
                "enhancement_order",
                "order",
                Choice(&[("swap_first", "swap, then delete"), ("delete_first", "delete, then swap (paper)")]),
                "The order of the two operations of the enhancement (4.3.6, local structural enhancement, i and ii).",
            ),
        ],
    },
    Group {
        name: "Seams and splits",
        rows: &[
            row("seaming", "close small corners", Switch, "Seam small frontal angles (4.3.6, fig. 18)."),
            row(
                "theta_seam",
                "θ seam",
                Number([0.0, 90.0], 1, "°"),
                "At or below this frontal angle a front corner is closed by a seam (4.3.6). Figure 12 has 45°, the text \
                 30°.",
            ),
            row(
                "seam_widening",
                "widening",
                Number([1.0, 3.0], 2, "×"),
                "The shorter the segments around a corner, the wider it may be and still be closed: up to θ seam times \
                 this, at most 90°. The paper does not widen (4.3.6).",
            ),
            row(
                "splitting",
                "split at slender triangles",
                Switch,
                "Split the front at slender triangles beside a new quadrilateral (4.3.6, fig. 19).",
            ),
            row(
                "eps1",
                "ε₁, area below",
                Number([0.0, 1.0], 3, ""),
                "A triangle is slender if its area in the metric is below this (4.3.6, front splitting, ii b) and its \
                 ratio above ε₂.",
            ),
            row(
                "eps2",
                "ε₂, ratio above",
                Number([1.0, 20.0], 2, ""),
                "A triangle is slender if its ratio of width to height in the metric is above this (4.3.6, front \
                 splitting, ii c) and its area below ε₁.",
            ),
            row(
                "theta_revr",
                "θ revr",
                Number([180.0, 360.0], 1, "°"),
                "Above this frontal angle a corner is called a reversal (fig. 12). It is for display only: the mesh does \
                 not depend on it.",
            ),
        ],
    },
    Group {
        name: "End",
        rows: &[
            row(
                "post_processing",
                "clean up and smooth at the end",
                Switch,
                "Clean up and smooth the whole mesh at the end (4.3.7).",
            ),
            row(
                "clean_up",
                "clean up by",
                Choice(&[("search", "a search, by an energy"), ("traditional", "traditional operations (paper)")]),
                "How the structure of the whole mesh is changed: by a search for single changes and sequences, judged by \
                 an energy, or by the traditional operations that the paper names (2.7, 4.3.7).",
            ),
        ],
    },
];

/// A parameter that belongs to the case: its background mesh is made with it.
pub struct CaseRow {
    pub key: &'static str,
    pub name: &'static str,
    pub tip: &'static str,
}

/// The parameters that cannot change at a step.
pub const OF_CASE: [CaseRow; 4] = [
    CaseRow { key: "size_scale", name: "size scale", tip: "The factor for all target sizes." },
    CaseRow {
        key: "layered_loops",
        name: "layered loops",
        tip: "Curves on whose loops rows are offset, separated by commas. Empty: all loops.",
    },
    CaseRow { key: "faces", name: "only faces", tip: "Faces to convert, separated by semicolons. Empty: all faces." },
    CaseRow {
        key: "max_quads",
        name: "max. quads",
        tip: "A mesh that would need more quadrilaterals is rejected before memory is allocated for it.",
    },
];

impl Row {
    /// Its tip: what it does, its key, its default, the paper's value and the values that it takes.
    pub fn tip(&self) -> String {
        tip(self.key, self.tip)
    }
}

impl CaseRow {
    /// Its tip, with the reason why it cannot change at a step.
    pub fn tip(&self) -> String {
        let why = "It belongs to the background mesh and cannot change at a step: Enter opens the run again with the \
                   new value, without its changes. Ctrl+S saves them first.";
        format!("{}\n{why}", tip(self.key, self.tip))
    }
}

fn tip(key: &str, what: &str) -> String {
    let value = |parameters: Parameters| match parameters.text_of(key) {
        Some(text) if text.is_empty() => "empty".to_owned(),
        text => text.unwrap_or_default(),
    };
    let range = Parameters::kind_of(key).and_then(|kind| kind.limits());
    let range =
        range.map_or_else(String::new, |[least, most]| format!(", from {} to {}", Shortest(least), Shortest(most)));
    // What belongs to the case is not the paper's.
    let paper = match OF_CASE.iter().any(|row| row.key == key) {
        true => String::new(),
        false => format!(", paper {}", value(Parameters::paper())),
    };
    format!("{what}\n{key}: default {}{paper}{range}", value(Parameters::default()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::ParameterKind;
    use crate::core::run::run::OF_BACKGROUND;

    #[test]
    fn every_parameter_has_a_row_or_belongs_to_the_case() {
        let rows = GROUPS.iter().flat_map(|group| group.rows);
        let mut keys: Vec<&str> = rows.map(|row| row.key).chain(OF_CASE.iter().map(|row| row.key)).collect();
        keys.sort_unstable();
        let mut all = Parameters::KEYS.to_vec();
        all.sort_unstable();
        assert_eq!(keys, all);
        assert_eq!(OF_CASE.map(|row| row.key), OF_BACKGROUND);
    }

    #[test]
    fn every_row_offers_all_values_of_its_parameter() {
        for row in GROUPS.iter().flat_map(|group| group.rows) {
            let (tip, kind) = (row.tip(), Parameters::kind_of(row.key).unwrap());
            match (&row.kind, &kind) {
                (Number([low, high], ..), kind) => {
                    let [least, most] = kind.limits().unwrap();
                    assert!(least <= *low && low < high && *high <= most, "{}", row.key);
                }
                (Choice(words), ParameterKind::Word(all)) => {
                    assert_eq!(&words.iter().map(|word| word.0).collect::<Vec<_>>(), all);
                    // What is called the paper's is the paper's.
                    let paper = Parameters::paper().text_of(row.key).unwrap();
                    let named: Vec<&str> =
                        words.iter().filter(|word| word.1.ends_with("(paper)")).map(|word| word.0).collect();
                    assert_eq!(named, [paper], "{}", row.key);
                }
                (Switch, ParameterKind::Flag) => {}
                _ => panic!("{} has another kind: {kind:?}", row.key),
            }
            assert!(tip.contains('(') && tip.contains(", paper "), "{tip}");
        }
        let tip = OF_CASE[1].tip();
        assert!(tip.contains("layered_loops: default empty\n"), "{tip}");
    }
}
