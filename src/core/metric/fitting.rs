//! Sizes that fit a shape where none are given: of CAD files, and of meshes whose triangles are no elements.

/// Elements are as large as this fraction of the diagonal where nothing bends, at most as long as the shorter edges.
const SIZE: f64 = 1.0 / 30.0;
/// The distance between chord and arc, divided by the radius.
pub const CHORD: f64 = 0.03;
/// The smallest size by curvature is the largest size divided by this.
pub const FINEST: f64 = 100.0;
/// Tiny edges count as the diagonal divided by this,
const TINY: f64 = 200.0;
/// and one edge of so many may be shorter than an element.
const SHORTER: usize = 10;

/// A length that few edges fall below: their tenth part, by number; infinite without edges.
pub fn short_edge(lengths: impl Iterator<Item = f64>, diagonal: f64) -> f64 {
    let mut lengths: Vec<f64> = lengths.map(|length| length.max(diagonal / TINY)).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get(lengths.len() / SHORTER).copied().unwrap_or(f64::INFINITY)
}

/// The largest size of elements on a shape, with two digits.
pub fn fitting_size(diagonal: f64, short_edge: f64) -> f64 {
    let size = (SIZE * diagonal).min(short_edge);
    format!("{size:.1e}").parse().unwrap_or(size)
}
