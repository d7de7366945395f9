//! The kinds of repairs of a mesh and how reports word them, for meshes in the plane and in space.

/// A kind of repair, or of deviation from the file that is reported with the repairs; [`Repair::words`] describes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::core) enum Repair {
    Triangulated,
    BentElement,
    UnusedPoint,
    MergedPoint,
    CrackPoint,
    HangingPoint,
    DuplicateTriangle,
    DegenerateTriangle,
    ClockwiseTriangle,
    ReversedTriangle,
    ContactPoint,
    PinchedNode,
    LineOffEdges,
    PointOffCorners,
    FurtherGroup,
    UngroupedLine,
    ShapedCurve,
    DividedInterface,
    DividedSegment,
    DividedSide,
    RepeatedPoint,
    JoinedEnd,
}

/// Why sides of triangles are divided.
const EVEN: &str = "divided to make triangle counts even";

impl Repair {
    /// What was repaired, singular and plural, and how.
    fn words(self) -> [&'static str; 3] {
        match self {
            Repair::Triangulated => ["quadrilateral or polygon", "quadrilaterals and polygons", "split into triangles"],
            Repair::BentElement => ["element of order 2", "elements of order 2", "divided along their bend"],
            Repair::UnusedPoint => ["unused point", "unused points", "removed"],
            Repair::MergedPoint => ["coincident point", "coincident points", "merged"],
            Repair::CrackPoint => ["coincident point", "coincident points", "kept as the other side of a crack"],
            Repair::HangingPoint => ["hanging point", "hanging points", "joined to the mesh"],
            Repair::DuplicateTriangle => ["duplicate triangle", "duplicate triangles", "removed"],
            Repair::DegenerateTriangle => ["degenerate triangle", "degenerate triangles", "removed"],
            Repair::ClockwiseTriangle => ["clockwise triangle", "clockwise triangles", "reversed"],
            Repair::ReversedTriangle => ["triangle", "triangles", "reversed to match neighbours"],
            Repair::ContactPoint => ["contact point between parts", "contact points between parts", "split"],
            Repair::PinchedNode => ["node", "nodes", "split where triangles share only a point"],
            Repair::LineOffEdges => ["line on no edge of the mesh", "lines on no edge of the mesh", "ignored"],
            Repair::PointOffCorners => ["point in a group", "points in groups", "ignored: no corner of the mesh"],
            Repair::FurtherGroup => ["group", "groups", "kept without a cut"],
            Repair::UngroupedLine => ["ungrouped line inside a region", "ungrouped lines inside regions", "ignored"],
            Repair::ShapedCurve => ["curve", "curves", "divided more finely than the sizes ask, to keep the shape"],
            Repair::DividedInterface => ["side between parts", "sides between parts", EVEN],
            Repair::DividedSegment => ["boundary segment", "boundary segments", EVEN],
            Repair::RepeatedPoint => ["repeated point of a polyline", "repeated points of polylines", "merged"],
            Repair::JoinedEnd => ["end of a curve", "ends of curves", "moved to where another one ends"],
            Repair::DividedSide => ["side of a triangle", "sides of triangles", "divided to make counts even"],
        }
    }

    /// Appends a phrase such as "2 degenerate triangles were removed" to `repairs`; nothing for a count of 0.
    pub fn report(self, count: usize, repairs: &mut Vec<String>) {
        let [one, many, how] = self.words();
        match count {
            0 => {}
            1 => repairs.push(format!("1 {one} was {how}")),
            n => repairs.push(format!("{n} {many} were {how}")),
        }
    }
}
