//! Rules of the front that a conversion chooses from: those of the paper and those in their place.

use crate::core::kernel::worded::worded;

worded! {
    /// Which front segment the next quadrilateral grows from (docs/algorithm.md, "Selection of the base segment").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Selection by word {
        /// The paper's table 1: classes by frontal angles, within reach of the smallest H-value.
        Table1 = "table1",
        /// The shortest physical length (4.3.3, rule 1).
        Shortest = "shortest",
        /// The smallest sum of both frontal angles (4.3.3, rule 2).
        SmallestAngle = "smallest_angle",
        /// Q-Morph's order: state, level, metric length.
        Level = "level",
    }
}

worded! {
    /// What is compared with `c` times the smallest H-value (docs/algorithm.md, "The selection window").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SelectionWindow by word {
        /// Metric length times H: about H for unit edges, larger for long ones.
        MetricLengthTimesH = "metric_length_times_h",
        /// The H-value of eq. (6).
        HValue = "h_value",
        /// The physical length: the paper says only "length".
        PhysicalLength = "physical_length",
    }
}

worded! {
    /// Over which front segments Hmin is taken (4.3.3, step i; docs/algorithm.md, "Selection of the base segment").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum HMinOver by word {
        /// All that stand, as the paper says; deferred ones are only not chosen.
        Front = "front",
        /// Those that are not deferred.
        Waiting = "waiting",
    }
}

worded! {
    /// The order of the two operations of the local structural enhancement (4.3.6).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum EnhancementOrder by word {
        /// Swaps, and the removal of a node where there is none left.
        SwapFirst = "swap_first",
        /// As the paper says: nodes are removed before each swap.
        DeleteFirst = "delete_first",
    }
}

worded! {
    /// How the structure of the whole mesh is cleaned up (4.3.7; docs/algorithm.md, "Clean-up").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CleanUpBy by word {
        /// Changes of a few elements, then cavities that are filled anew, judged by an energy.
        Search = "search",
        /// The traditional operations that the paper names, one at a time, judged by the valences.
        Traditional = "traditional",
    }
}

worded! {
    /// The areas that weigh the elements around a node when it is smoothed (eq. 10).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SmoothingWeights by word {
        /// The area in the plane times the mean of `sqrt(det M)` over the nodes.
        Determinant = "determinant",
        /// As printed: by lengths in the metric and angles at the node (eqs. 10a, 10b).
        Printed = "printed",
    }
}

worded! {
    /// Where an edge is divided (4.2.3).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum DivisionAt by word {
        /// Where its metric length is halved.
        MetricMiddle = "metric_middle",
        /// At its midpoint in the plane, as the paper says.
        Midpoint = "midpoint",
    }
}

worded! {
    /// What is tried first when a quadrilateral cannot be formed (4.3.4; docs/algorithm.md, "Rescue").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FirstRescue by word {
        /// The sides are divided.
        Division = "division",
        /// As the paper says: the right side is replaced by its left-hand neighbour, and that by its own.
        LeftNeighbour = "left_neighbour",
    }
}
