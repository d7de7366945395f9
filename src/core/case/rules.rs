//! Rules of the front that a conversion chooses from: those of the paper and those in their place.

use crate::core::kernel::worded::worded;

worded! {
    /// Which front segment the next quadrilateral grows from (docs/algorithm.md, "Selection of the base segment").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Selection {
        /// The paper's table 1: classes by frontal angles, within reach of the smallest H-value.
        Table1 = "table1",
        /// The shortest physical length.
        Shortest = "shortest",
        /// The smallest frontal angle.
        SmallestAngle = "smallest_angle",
        /// Q-Morph's order: state, level, metric length.
        Level = "level",
    }
    /// All of them.
    const ALL;
    /// Its word in files and for `--set`.
    fn word;
}

worded! {
    /// What is compared with `c` times the smallest H-value (docs/algorithm.md, "The selection window").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SelectionWindow {
        /// Metric length times H: about H for unit edges, larger for long ones.
        MetricLengthTimesH = "metric_length_times_h",
        /// The H-value of eq. (6).
        HValue = "h_value",
        /// The physical length, as the paper says.
        PhysicalLength = "physical_length",
    }
    /// All of them.
    const ALL;
    /// Its word in files and for `--set`.
    fn word;
}

worded! {
    /// Over which front segments Hmin is taken (4.3.3, step i; docs/algorithm.md, "Selection of the base segment").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum HMinOver {
        /// All that stand, as the paper says; deferred ones are only not chosen.
        Front = "front",
        /// Those that are not deferred.
        Waiting = "waiting",
    }
    /// All of them.
    const ALL;
    /// Its word in files and for `--set`.
    fn word;
}

worded! {
    /// The order of the two operations of the local structural enhancement (4.3.6).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum EnhancementOrder {
        /// Swaps, and the removal of a node where there is none left.
        SwapFirst = "swap_first",
        /// As the paper says: nodes are removed before each swap.
        DeleteFirst = "delete_first",
    }
    /// All of them.
    const ALL;
    /// Its word in files and for `--set`.
    fn word;
}

worded! {
    /// The areas that weigh the elements around a node when it is smoothed (eq. 10).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SmoothingWeights {
        /// The area in the plane times the mean of `sqrt(det M)` over the nodes.
        Determinant = "determinant",
        /// As printed: by lengths in the metric and angles at the node (eqs. 10a, 10b).
        Printed = "printed",
    }
    /// All of them.
    const ALL;
    /// Its word in files and for `--set`.
    fn word;
}

worded! {
    /// Where an edge is divided (4.2.3).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum DivisionAt {
        /// Where its metric length is halved.
        MetricMiddle = "metric_middle",
        /// At its midpoint in the plane, as the paper says.
        Midpoint = "midpoint",
    }
    /// All of them.
    const ALL;
    /// Its word in files and for `--set`.
    fn word;
}

worded! {
    /// What is tried first when a quadrilateral cannot be formed (4.3.4; docs/algorithm.md, "Rescue").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FirstRescue {
        /// The sides are divided.
        Division = "division",
        /// As the paper says: the right side is replaced by its left-hand neighbour, and that by its own.
        LeftNeighbour = "left_neighbour",
    }
    /// All of them.
    const ALL;
    /// Its word in files and for `--set`.
    fn word;
}
