//! The palette of a GIF: colours that are kept, those seen most, and the means of groups of all others.

use rustc_hash::FxHashMap;

use crate::render::vector::png::Raster;

/// Entries of a palette, one of which is transparent.
const MOST: usize = 255;
/// Of the colours seen most, so many stay as they are.
const FREQUENT: usize = 32;

/// A palette.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Colours(Vec<[u8; 3]>);

/// Colours with the number of their pixels.
type Counted = Vec<([u8; 3], u64)>;

impl Colours {
    /// The palette for frames such as `samples`; `kept` are in it in any case.
    pub fn of(samples: &[Raster], kept: &[[u8; 3]]) -> Colours {
        let mut counts: FxHashMap<[u8; 3], u64> = FxHashMap::default();
        for [r, g, b, _] in samples.iter().flat_map(|sample| &sample.pixels) {
            *counts.entry([*r, *g, *b]).or_default() += 1;
        }
        let mut counted: Counted = counts.into_iter().collect();
        counted.sort_unstable_by_key(|&(colour, count)| (std::cmp::Reverse(count), colour));
        let mut table = Vec::new();
        for &colour in kept.iter().chain(counted.iter().take(FREQUENT).map(|(colour, _)| colour)) {
            if table.len() < MOST && !table.contains(&colour) {
                table.push(colour);
            }
        }
        counted.retain(|(colour, _)| !table.contains(colour));
        table.extend(means(counted, MOST - table.len()));
        Colours(table)
    }

    /// Its entries, that of transparent pixels last.
    pub fn table(&self) -> Vec<[u8; 3]> {
        self.0.iter().copied().chain([[0; 3]]).collect()
    }

    /// The index of transparent pixels.
    pub fn clear(&self) -> u8 {
        self.0.len() as u8
    }

    /// The index of the nearest colour for each pixel.
    pub fn indices(&self, pixels: &[[u8; 4]]) -> Vec<u8> {
        let mut known: FxHashMap<[u8; 3], u8> = FxHashMap::default();
        let mut last = None;
        let one = |&[r, g, b, _]: &[u8; 4]| {
            let colour = [r, g, b];
            match last {
                Some((before, index)) if before == colour => index,
                _ => {
                    let index = *known.entry(colour).or_insert_with(|| self.nearest(colour));
                    last = Some((colour, index));
                    index
                }
            }
        };
        pixels.iter().map(one).collect()
    }

    /// The first of the nearest entries.
    fn nearest(&self, colour: [u8; 3]) -> u8 {
        let distance = |other: &[u8; 3]| {
            let [r, g, b] = std::array::from_fn(|k| (i32::from(colour[k]) - i32::from(other[k])).pow(2));
            // The eye sees green best.
            2 * r + 4 * g + 3 * b
        };
        let nearest = self.0.iter().enumerate().min_by_key(|(_, other)| distance(other));
        nearest.map_or(0, |(index, _)| index as u8)
    }
}

/// The means of at most so many groups of colours. The group whose colours vary most is divided where its widest
/// channel has its mean.
fn means(colours: Counted, most: usize) -> Vec<[u8; 3]> {
    let mut groups: Vec<Group> = if colours.is_empty() { Vec::new() } else { vec![Group::of(colours)] };
    while !groups.is_empty() && groups.len() < most {
        let (at, widest) = groups
            .iter()
            .enumerate()
            .fold((0, &groups[0]), |best, (k, group)| if group.spread > best.1.spread { (k, group) } else { best });
        if widest.spread == 0.0 {
            break;
        }
        let Group { colours, mean, channel, .. } = groups.swap_remove(at);
        let (below, above) = colours.into_iter().partition(|(colour, _)| f64::from(colour[channel]) < mean[channel]);
        groups.extend([below, above].map(Group::of));
    }
    groups.iter().take(most).map(|group| group.mean.map(|x| x.round() as u8)).collect()
}

/// Colours that share an entry.
struct Group {
    colours: Counted,
    mean: [f64; 3],
    /// The channel in which they vary most.
    channel: usize,
    /// How much they vary in it: the sum of squares.
    spread: f64,
}

impl Group {
    fn of(colours: Counted) -> Group {
        // The root of the counts, or the shades along thin lines would not matter beside those of areas.
        let weight = |count: u64| (count as f64).sqrt();
        let total: f64 = colours.iter().map(|c| weight(c.1)).sum();
        let sum = |of: &dyn Fn([u8; 3]) -> f64| colours.iter().map(|c| weight(c.1) * of(c.0)).sum::<f64>();
        let mean: [f64; 3] = std::array::from_fn(|k| sum(&|colour| f64::from(colour[k])) / total.max(1.0));
        let spreads: [f64; 3] = std::array::from_fn(|k| {
            let off = |colour: [u8; 3]| f64::from(colour[k]) - mean[k];
            sum(&|colour| off(colour) * off(colour))
        });
        let channel = if spreads[1] >= spreads[0] && spreads[1] >= spreads[2] {
            1
        } else if spreads[0] >= spreads[2] {
            0
        } else {
            2
        };
        Group { colours, mean, channel, spread: spreads[channel] }
    }
}
