//! The camera of a film that follows what happens: it glides, and what it follows never leaves the picture.

use glam::DVec2;

use super::look::FigurePart;

/// A box in the picture, low corner first.
pub type Extent = [DVec2; 2];

/// The height of the part drawn, in diagonals of what is followed.
const AROUND: f64 = 4.0;
/// The room around what is followed, as a share of the part drawn.
const MARGIN: f64 = 0.08;

/// The part drawn in each frame of a film. `followed` is what is followed in each frame, where `None` is everything:
/// the box `whole`. `shape` is the width of a frame divided by its height, and the camera begins to move `reach` frames
/// before what it follows does, and arrives as many after it.
///
/// Centres are means over the frames around. Heights are what these centres need; of those around, the largest is taken
/// and then the mean, which is never less than what the frame itself needs.
pub fn follow(followed: &[Option<Extent>], whole: Extent, shape: f64, reach: usize) -> Vec<FigurePart> {
    let boxes: Vec<Extent> = followed.iter().map(|extent| extent.unwrap_or(whole)).collect();
    let middle = |[low, high]: Extent| 0.5 * (low + high);
    let centres: Vec<DVec2> = boxes.iter().map(|extent| middle(*extent)).collect();
    let centres: Vec<DVec2> = (0..centres.len()).map(|k| around(k, reach, &centres).sum()).collect();
    let everything = needed(whole, middle(whole), shape);
    let heights: Vec<f64> = boxes
        .iter()
        .zip(&centres)
        .map(|(&extent, &centre)| {
            let [low, high] = extent;
            let usual = (AROUND * (high - low).length()).min(everything);
            usual.max(needed(extent, centre, shape))
        })
        .collect();
    let largest = |k: usize| {
        let (from, to) = (k.saturating_sub(reach), (k + reach).min(heights.len() - 1));
        libm::log(heights[from..=to].iter().copied().fold(f64::MIN_POSITIVE, f64::max))
    };
    let largest: Vec<f64> = (0..heights.len()).map(largest).collect();
    // The mean of the logarithms: a zoom by a factor takes as long in as out.
    let height = |k: usize| libm::exp(around(k, reach, &largest).sum());
    let part = |(k, &centre): (usize, &DVec2)| within(FigurePart { centre, height: height(k) }, whole, shape);
    centres.iter().enumerate().map(part).collect()
}

/// The same part moved so that it shows no more than a margin beyond the whole. What it shows of the whole it still
/// shows.
fn within(part: FigurePart, [low, high]: Extent, shape: f64) -> FigurePart {
    let half = 0.5 * part.height * DVec2::new(shape, 1.0);
    let margin = DVec2::splat(MARGIN * part.height);
    let [first, last] = [low - margin + half, high + margin - half];
    // Where it is larger than the whole, the whole is in its middle.
    let middle = 0.5 * (low + high);
    FigurePart { centre: part.centre.clamp(first.min(middle), last.max(middle)), ..part }
}

/// The height of a part with this centre that shows a box with some room around it.
fn needed([low, high]: Extent, centre: DVec2, shape: f64) -> f64 {
    let half = (high - centre).abs().max((low - centre).abs());
    let height = 2.0 * half.y.max(half.x / shape) / (1.0 - 2.0 * MARGIN);
    if height > 0.0 { height } else { 1.0 }
}

/// The values of the frames around one, with weights of sum one that fade towards `reach`; the first and the last frame
/// go on beyond the ends.
fn around<T>(k: usize, reach: usize, values: &[T]) -> impl Iterator<Item = T>
where
    T: Copy + std::ops::Mul<f64, Output = T>,
{
    let weight = move |away: usize| {
        let share = away as f64 / (reach + 1) as f64;
        // The raised cosine: its values at whole steps add up to the number of steps.
        0.5 * (1.0 + libm::cos(std::f64::consts::PI * share)) / (reach + 1) as f64
    };
    let last = values.len() - 1;
    (0..=2 * reach).map(move |i| values[(k + i).saturating_sub(reach).min(last)] * weight(i.abs_diff(reach)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Extent = [DVec2::ZERO, DVec2::new(10.0, 5.0)];

    fn quad(x: f64, y: f64) -> Option<Extent> {
        let at = DVec2::new(x, y);
        Some([at, at + 0.1])
    }

    #[test]
    fn weights_add_up_to_one() {
        for reach in 0..20 {
            let ones = [1.0; 7];
            let sum: f64 = around(3, reach, &ones).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{reach}: {sum}");
        }
    }

    #[test]
    fn what_is_followed_is_always_within_the_part_drawn_and_the_camera_never_jumps() {
        let mut random = 1_u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as f64 / f64::from(u32::MAX >> 1)
        };
        let mut at = DVec2::new(5.0, 2.0);
        let followed: Vec<_> = (0..300)
            .map(|k| {
                // It wanders, and leaps now and then.
                let by = if k % 40 == 39 { 9.0 } else { 0.1 };
                at = (at + by * (DVec2::new(next(), next()) - 0.5)).clamp(WHOLE[0], WHOLE[1] - 0.1);
                if (10..=290).contains(&k) { quad(at.x, at.y) } else { None }
            })
            .collect();
        let (shape, reach) = (1.5, 12);
        let parts = follow(&followed, WHOLE, shape, reach);
        assert_eq!(parts.len(), 300);
        for (part, what) in parts.iter().zip(&followed) {
            let half = 0.5 * part.height * DVec2::new(shape, 1.0);
            let [low, high] = what.unwrap_or(WHOLE);
            assert!((low - part.centre + half).min_element() > 0.0, "{part:?} {what:?}");
            assert!((part.centre + half - high).min_element() > 0.0, "{part:?} {what:?}");
            // Little is shown beside the whole.
            let beside = (WHOLE[0] - part.centre + half).max(part.centre + half - WHOLE[1]);
            let free = (half - 0.5 * (WHOLE[1] - WHOLE[0])).max(DVec2::splat(MARGIN * part.height));
            assert!((beside - free).max_element() < 1e-9, "{part:?}");
        }
        for two in parts.windows(2) {
            let factor = two[1].height / two[0].height;
            assert!((0.7..1.4).contains(&factor), "{two:?}");
            let moved = (two[1].centre - two[0].centre).length() / two[0].height;
            assert!(moved < 0.2, "{two:?}");
        }
        assert_eq!(parts, follow(&followed, WHOLE, shape, reach));
    }

    #[test]
    fn what_stays_is_seen_from_near_and_everything_from_where_it_fits() {
        let parts = follow(&[quad(1.0, 1.0), quad(1.0, 1.0)], WHOLE, 1.0, 5);
        assert!((parts[0].centre - DVec2::splat(1.05)).length() < 1e-9);
        assert!((parts[0].height - AROUND * 0.1 * 2.0_f64.sqrt()).abs() < 1e-9);
        let [part] = follow(&[None], WHOLE, 2.0, 5)[..] else { panic!("one") };
        assert!(part.height >= 5.0 && part.height < 6.5 && part.centre.distance(DVec2::new(5.0, 2.5)) < 1e-9);
        assert!(follow(&[], WHOLE, 2.0, 5).is_empty());
    }
}
