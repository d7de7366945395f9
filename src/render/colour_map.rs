//! Perceptually uniform colour maps for all kinds of colour vision: viridis, cividis, batlow.

use super::palette::Rgba;
use crate::core::kernel::worded::worded;

worded! {
    /// A colour map.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ColourMap by name {
        /// Purple over green to yellow: sizes, areas, births.
        Viridis = "viridis",
        /// Blue to yellow: angles and qualities.
        Cividis = "cividis",
        /// Blue over green and orange to pink: levels.
        Batlow = "batlow",
    }
}

/// Nine equidistant colours of each map, in the order of [`ColourMap::ALL`]; between them, linear interpolation is
/// visually exact.
const STOPS: [[u32; 9]; 3] = [
    [0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21918C, 0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725],
    [0x00224E, 0x1A386F, 0x434E6C, 0x61656F, 0x7D7C78, 0x9B9476, 0xBCAF6F, 0xDECB5F, 0xFEE838],
    [0x011959, 0x0F3C5F, 0x1C5460, 0x3C6D56, 0x687B3E, 0x9D892B, 0xD29343, 0xF8A17B, 0xFACCFA],
];

impl ColourMap {
    /// The colour at `t`, which is clamped to [0, 1]; NaN counts as 0.
    pub fn at(self, t: f32) -> Rgba {
        let stops = STOPS[self as usize];
        let x = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) } * (stops.len() - 1) as f32;
        let below = (x as usize).min(stops.len() - 2);
        let share = x - below as f32;
        let channel = |shift: u32| {
            let of = |colour: u32| (colour >> shift & 0xFF) as f32;
            (of(stops[below]) * (1.0 - share) + of(stops[below + 1]) * share).round() as u8
        };
        Rgba([channel(16), channel(8), channel(0), 0xFF])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_grows_along_every_map() {
        for map in ColourMap::ALL {
            let lightness = |k: u16| {
                let Rgba([r, g, b, _]) = map.at(f32::from(k) / 64.0);
                0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
            };
            for k in 0..64 {
                assert!(lightness(k) <= lightness(k + 1) + 1.0, "{} at {k}", map.name());
            }
        }
    }

    #[test]
    fn the_ends_are_the_map_s_own_and_nothing_lies_beyond() {
        assert_eq!(ColourMap::Viridis.at(-1.0), ColourMap::Viridis.at(0.0));
        assert_eq!(ColourMap::Viridis.at(2.0), Rgba([0xFD, 0xE7, 0x25, 0xFF]));
        assert_eq!(ColourMap::Cividis.at(f32::NAN), ColourMap::Cividis.at(0.0));
    }
}
