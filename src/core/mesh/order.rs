//! Sorting in linear time: along a Hilbert curve, and by small integers.

use glam::DVec2;

use crate::core::kernel::box_tree::extent;

/// The order of the Hilbert curve: its square has 2^BITS cells along each side.
const BITS: u32 = 26;

/// The ids sorted along a Hilbert curve through the bounding box of the points; ids in the same cell are sorted.
pub fn hilbert_order(places: &[(u32, DVec2)]) -> Vec<u32> {
    let (low, high) = extent(places.iter().map(|place| place.1));
    let extent = (high - low).max_element();
    let scale = if extent > 0.0 { f64::from((1_u32 << BITS) - 1) / extent } else { 0.0 };
    let keyed = places.iter().map(|&(id, p)| {
        let cell = (p - low) * scale;
        (hilbert_distance(BITS, cell.x as u32, cell.y as u32), id)
    });
    // About one group per point, so that groups are small unless the points are clustered.
    let bits = (usize::BITS - places.len().leading_zeros()).min(2 * BITS);
    let group = |&(key, _): &(u64, u32)| (key >> (2 * BITS - bits)) as u32;
    let mut sorted = grouped(1 << bits, &keyed.collect::<Vec<_>>(), group);
    sorted.chunk_by_mut(|a, b| group(a) == group(b)).for_each(<[_]>::sort_unstable);
    sorted.into_iter().map(|(_, id)| id).collect()
}

/// Items sorted by a group number below `groups`: a stable counting sort.
pub fn grouped<T: Copy + Default>(groups: usize, items: &[T], group: impl Fn(&T) -> u32) -> Vec<T> {
    let mut start = vec![0_u32; groups + 1];
    for item in items {
        start[group(item) as usize + 1] += 1;
    }
    for i in 0..groups {
        start[i + 1] += start[i];
    }
    let mut sorted = vec![T::default(); items.len()];
    for item in items {
        let slot = &mut start[group(item) as usize];
        sorted[*slot as usize] = *item;
        *slot += 1;
    }
    sorted
}

/// The Hilbert curve as four ways to traverse a square: for a way (0: from the lower left corner to the lower right, 1:
/// its mirror image at the diagonal, 2: 0 rotated by 180 degrees, 3: 1 rotated by 180 degrees) and a quadrant (`2 *
/// right + up`), the position of the quadrant on the way (two lower bits) and the way through it (upper bits). A table
/// avoids branches.
const HILBERT: [[u8; 4]; 4] = {
    let mut table = [[0; 4]; 4];
    let mut way = 0;
    while way < 4 {
        let mut quadrant = 0;
        while quadrant < 4 {
            // Rotated and mirrored to way 0, which visits lower left, upper left, upper right, lower right.
            let turned = if way >= 2 { 3 - quadrant } else { quadrant };
            let (right, up) = if way % 2 == 1 { (turned & 1, turned >> 1) } else { (turned >> 1, turned & 1) };
            let place = (3 * right) ^ up;
            // Way 0 traverses the lower left quadrant by its mirror image, and the lower right one by that image
            // rotated.
            let through = match (right, up) {
                (0, 0) => way ^ 1,
                (1, 0) => way ^ 3,
                _ => way,
            };
            table[way][quadrant] = (place | through << 2) as u8;
            quadrant += 1;
        }
        way += 1;
    }
    table
};

/// The index of the cell (x, y) along the Hilbert curve of order `bits`.
fn hilbert_distance(bits: u32, x: u32, y: u32) -> u64 {
    let (mut distance, mut way) = (0, 0);
    for level in (0..bits).rev() {
        let quadrant = (x >> level & 1) << 1 | (y >> level & 1);
        let next = HILBERT[way][quadrant as usize];
        distance = distance << 2 | u64::from(next & 3);
        way = usize::from(next >> 2);
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(ids: std::ops::Range<u32>, place: impl Fn(u32) -> DVec2) -> Vec<u32> {
        hilbert_order(&ids.map(|id| (id, place(id))).collect::<Vec<_>>())
    }

    #[test]
    fn the_order_steps_from_cell_to_neighbouring_cell() {
        // A grid of 32 x 32 points, given row by row.
        let place = |id: u32| DVec2::new(f64::from(id % 32), f64::from(id / 32));
        let mut ids = order(0..1024, place);
        for w in ids.windows(2) {
            assert_eq!(place(w[0]).distance(place(w[1])), 1.0, "{w:?}");
        }
        ids.sort_unstable();
        assert!(ids.into_iter().eq(0..1024));
    }

    #[test]
    fn equal_points_and_clusters_are_in_the_order_of_their_ids() {
        assert_eq!(order(0..5, |_| DVec2::ONE), [0, 1, 2, 3, 4]);
        let place = |id: u32| if id == 7 { DVec2::ONE } else { DVec2::splat(1e-12) };
        assert_eq!(order(3..9, place), [3, 4, 5, 6, 8, 7]);
        assert!(order(0..0, place).is_empty());
    }

    #[test]
    fn groups_are_sorted_and_keep_their_order() {
        let items = [(2, 'a'), (0, 'b'), (2, 'c'), (1, 'd'), (0, 'e')];
        let sorted = grouped(4, &items, |item| item.0);
        assert!(sorted.into_iter().map(|(_, name)| name).eq("bedac".chars()));
    }
}
