//! Colours and strokes: the palettes of the window, dark and light, and that of figures, which is made for print and
//! independent of any window.

use super::look::Ink;
use super::picture::Role;

/// A colour in sRGB with its opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Rgba(pub [u8; 4]);

impl Rgba {
    /// An opaque colour, written `0xRRGGBB`.
    const fn hex(rgb: u32) -> Rgba {
        Rgba::hexa(rgb << 8 | 0xFF)
    }

    /// A colour written `0xRRGGBBAA`.
    const fn hexa(rgba: u32) -> Rgba {
        Rgba(rgba.to_be_bytes())
    }

    /// Opaque colours, each written `0xRRGGBB`.
    const fn hexes<const N: usize>(rgb: [u32; N]) -> [Rgba; N] {
        let mut colours = [Rgba([0; 4]); N];
        let mut k = 0;
        while k < N {
            colours[k] = Rgba::hex(rgb[k]);
            k += 1;
        }
        colours
    }

    /// The same colour, its opacity multiplied by `factor` (0 to 1).
    #[must_use]
    pub fn faded(self, factor: f32) -> Rgba {
        let [r, g, b, a] = self.0;
        Rgba([r, g, b, (f32::from(a) * factor.clamp(0.0, 1.0)).round() as u8])
    }

    /// This colour blended with a share (0 to 1) of another one.
    #[must_use]
    pub fn mixed(self, other: Rgba, share: f32) -> Rgba {
        let share = share.clamp(0.0, 1.0);
        let mix = |a: u8, b: u8| (f32::from(a) * (1.0 - share) + f32::from(b) * share).round() as u8;
        Rgba(std::array::from_fn(|k| mix(self.0[k], other.0[k])))
    }

    /// The colour as one number for the graphics card, red in the lowest byte.
    pub fn packed(self) -> u32 {
        u32::from_le_bytes(self.0)
    }
}

/// As figures write it: `#RRGGBB`, without the opacity.
impl std::fmt::Display for Rgba {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [r, g, b, _] = self.0;
        write!(f, "#{r:02X}{g:02X}{b:02X}")
    }
}

/// All colours of the window: amber for the current step, neutral for the selection, cool for the front, quiet for the
/// mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Whether it is the dark theme.
    pub dark: bool,
    /// Background of the views.
    pub ground: Rgba,
    /// Fill of live triangles.
    pub live: Rgba,
    /// Edges of live triangles.
    pub live_edge: Rgba,
    /// Fill of dead quadrilaterals.
    pub dead: Rgba,
    /// Edges of dead quadrilaterals.
    pub dead_edge: Rgba,
    /// Fill of elements that the last operation changed.
    pub changed: Rgba,
    /// Edges of elements that the last operation changed.
    pub changed_edge: Rgba,
    /// Boundary of the domain.
    pub boundary: Rgba,
    /// The selection.
    pub selection: Rgba,
    /// What is under the pointer.
    pub hover: Rgba,
    /// Labels in the views.
    pub label: Rgba,
    /// Background of labels.
    pub label_plate: Rgba,
    /// Front segments by their class of table 1, 1 to 4.
    pub front: [Rgba; 4],
    /// The base segment: the accent.
    pub base: Rgba,
    /// Side edges, and the top edge (dashed).
    pub side: Rgba,
    /// Rejected candidates.
    pub refused: Rgba,
    /// Invariants hold.
    pub holds: Rgba,
    /// An invariant is broken; errors.
    pub broken: Rgba,
    /// Background of panels.
    pub panel: Rgba,
    /// Buttons, chips, hovered rows.
    pub button: Rgba,
    /// Text fields.
    pub field: Rgba,
    /// Lines and rails.
    pub line: Rgba,
    /// Text.
    pub text: Rgba,
    /// Titles, active tabs, results.
    pub strong: Rgba,
    /// Units, headings.
    pub weak: Rgba,
    /// Hints, disabled items.
    pub hint: Rgba,
    /// Text in the accent colour.
    pub accent: Rgba,
    /// The row of the current step.
    pub accent_row: Rgba,
    /// Every other row.
    pub stripe: Rgba,
    /// Metric ellipses.
    pub ellipse: Rgba,
    /// Fills of adjacent charts, in quiet colours like the mesh.
    pub charts: [Rgba; 6],
}

/// The dark theme.
pub const DARK: Palette = Palette {
    dark: true,
    ground: Rgba::hex(0x0C0F12),
    live: Rgba::hex(0x161B20),
    live_edge: Rgba::hex(0x465059),
    dead: Rgba::hex(0x22303D),
    dead_edge: Rgba::hex(0x566C80),
    changed: Rgba::hex(0x17453F),
    changed_edge: Rgba::hex(0x45D6B5),
    boundary: Rgba::hex(0xF0EADB),
    selection: Rgba::hex(0xFFFFFF),
    hover: Rgba::hexa(0xAEB6BF8C),
    label: Rgba::hex(0xE6EAEE),
    label_plate: Rgba::hexa(0x0C0F12E0),
    front: Rgba::hexes([0xCFF5FF, 0x74CDF7, 0x7E96F5, 0x8798A9]),
    base: Rgba::hex(0xFFB01F),
    side: Rgba::hex(0xFFD690),
    refused: Rgba::hex(0x8A939E),
    holds: Rgba::hex(0x45D6B5),
    broken: Rgba::hex(0xFF6B8B),
    panel: Rgba::hex(0x191D22),
    button: Rgba::hex(0x23282F),
    field: Rgba::hex(0x101317),
    line: Rgba::hex(0x2B3138),
    text: Rgba::hex(0xCDD3DA),
    strong: Rgba::hex(0xF3F5F7),
    weak: Rgba::hex(0x8A939E),
    hint: Rgba::hex(0x6C7681),
    accent: Rgba::hex(0xFFC65C),
    accent_row: Rgba::hexa(0xFFB01F1F),
    stripe: Rgba::hex(0x1D2127),
    ellipse: Rgba::hexa(0x8A939E8C),
    charts: Rgba::hexes([0x24364A, 0x3A4226, 0x48362A, 0x3A3052, 0x17443F, 0x46293A]),
};

/// The light theme.
pub const LIGHT: Palette = Palette {
    dark: false,
    ground: Rgba::hex(0xF4F4F2),
    live: Rgba::hex(0xFFFFFF),
    live_edge: Rgba::hex(0xB9C0C7),
    dead: Rgba::hex(0xDBE4EC),
    dead_edge: Rgba::hex(0x8DA2B5),
    changed: Rgba::hex(0xA6DCCB),
    changed_edge: Rgba::hex(0x00806A),
    boundary: Rgba::hex(0x20262C),
    selection: Rgba::hex(0x0E1216),
    hover: Rgba::hexa(0x616A748C),
    label: Rgba::hex(0x14191E),
    label_plate: Rgba::hexa(0xFFFFFFE6),
    front: Rgba::hexes([0x002B45, 0x00659C, 0x7C70DA, 0x6E7A87]),
    base: Rgba::hex(0xAD4E00),
    side: Rgba::hex(0xC77812),
    refused: Rgba::hex(0x616A74),
    holds: Rgba::hex(0x00806A),
    broken: Rgba::hex(0xC2123F),
    panel: Rgba::hex(0xF1F2F3),
    button: Rgba::hex(0xFFFFFF),
    field: Rgba::hex(0xFFFFFF),
    line: Rgba::hex(0xD9DCDF),
    text: Rgba::hex(0x2B3138),
    strong: Rgba::hex(0x0E1216),
    weak: Rgba::hex(0x616A74),
    hint: Rgba::hex(0x858D96),
    accent: Rgba::hex(0x9A4700),
    accent_row: Rgba::hexa(0xAD4E0018),
    stripe: Rgba::hex(0xECEEF0),
    ellipse: Rgba::hexa(0x616A748C),
    charts: Rgba::hexes([0xD3E2F2, 0xE4EDC8, 0xF5E0CB, 0xDCCFF3, 0xC3E8E4, 0xF4D7DF]),
};

/// What fills an area of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// A colour.
    Colour(Rgba),
    /// Lines of the colour [`HATCHING`], for areas that the last step changed, without colours.
    Hatch,
}

impl From<Rgba> for Paint {
    fn from(colour: Rgba) -> Paint {
        Paint::Colour(colour)
    }
}

/// The style of a role in a figure: widths in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// What fills areas; `None` shows the background.
    pub fill: Option<Paint>,
    /// Colour of lines.
    pub stroke: Option<Rgba>,
    /// Width of lines in points, independent of the scale of the mesh.
    pub width: f64,
    /// The dash pattern: points drawn and points left out.
    pub dash: Option<[f64; 2]>,
}

/// The width in points of edges closer to each other than [`CROWDED`].
pub const THIN: f64 = 0.12;

/// Edges of elements with a height below this many points are drawn thin, so that they do not merge.
pub const CROWDED: f64 = 0.4;

/// The colour of the lines of a hatched area.
pub const HATCHING: Rgba = Rgba::hex(0x404040);

/// The ground of figures, and of the plates under their labels.
pub fn ground(ink: Ink) -> Rgba {
    if ink == Ink::Dark { Rgba::hex(0x0C0F12) } else { Rgba::hex(0xFFFFFF) }
}

/// The ink of letters and wedges in figures.
pub fn letter(ink: Ink) -> Rgba {
    if ink == Ink::Dark { Rgba::hex(0xE6EAEE) } else { Rgba::hex(0x000000) }
}

/// The ink of notes, axes, arcs and ellipses in figures.
pub fn note(ink: Ink) -> Rgba {
    if ink == Ink::Dark { Rgba::hex(0x8A939E) } else { Rgba::hex(0x404040) }
}

/// All colours of figures in an ink: red, green, blue.
pub fn colours(ink: Ink) -> Vec<[u8; 3]> {
    let of_roles = Role::ALL.into_iter().flat_map(|role| {
        let style = figure(role, ink);
        let fill = match style.fill {
            Some(Paint::Colour(colour)) => Some(colour),
            // The hatching has a colour that a line has, too.
            Some(Paint::Hatch) | None => None,
        };
        [fill, style.stroke].into_iter().flatten()
    });
    let all = [ground(ink), letter(ink), note(ink)].into_iter().chain(of_roles);
    all.map(|Rgba([r, g, b, _])| [r, g, b]).collect()
}

/// The inks of what holds and of what is broken in figures.
pub fn verdicts(ink: Ink) -> [Rgba; 2] {
    match ink {
        Ink::Grey => [Rgba::hex(0x808080), Rgba::hex(0x000000)],
        Ink::Colour => [LIGHT.holds, LIGHT.broken],
        Ink::Dark => [DARK.holds, DARK.broken],
    }
}

/// The two series of a histogram in a figure: fill and outline of its bars.
pub fn bars(ink: Ink) -> [[Rgba; 2]; 2] {
    match ink {
        Ink::Grey => [[Rgba::hex(0x808080), Rgba::hex(0x808080)], [Rgba::hex(0xFFFFFF), Rgba::hex(0x404040)]],
        Ink::Colour => [[Rgba::hex(0x00659C), Rgba::hex(0x00659C)], [Rgba::hex(0xFFFFFF), Rgba::hex(0x7C70DA)]],
        Ink::Dark => [[Rgba::hex(0x74CDF7), Rgba::hex(0x74CDF7)], [Rgba::hex(0x0C0F12), Rgba::hex(0x7E96F5)]],
    }
}

/// The `figure` palette. The widths are for paper, a quarter to three quarters of a point: in a column of 84 mm lines
/// neither merge nor fade. `Weights` has the factor for other media.
pub fn figure(role: Role, ink: Ink) -> Style {
    let of_ink = |grey, colour, dark| {
        Rgba::hex(match ink {
            Ink::Grey => grey,
            Ink::Colour => colour,
            Ink::Dark => dark,
        })
    };
    let filled = |paint| Style { fill: Some(paint), stroke: None, width: 0.0, dash: None };
    let area = |grey, colour, dark| filled(Paint::Colour(of_ink(grey, colour, dark)));
    let line = |grey, colour, dark, width| {
        let stroke = Some(of_ink(grey, colour, dark));
        Style { fill: None, stroke, width, dash: None }
    };
    match role {
        Role::LiveTriangle => area(0xFFFFFF, 0xFFFFFF, 0x161B20),
        Role::DeadQuad => area(0xE4E4E4, 0xDBE4EC, 0x22303D),
        Role::Changed => filled(match ink {
            Ink::Grey => Paint::Hatch,
            Ink::Colour => Paint::Colour(Rgba::hex(0xA6DCCB)),
            Ink::Dark => Paint::Colour(Rgba::hex(0x17453F)),
        }),
        Role::LiveEdge => line(0x9A9A9A, 0x9A9A9A, 0x465059, 0.25),
        Role::DeadEdge => line(0x6B6B6B, 0x6F8496, 0x566C80, 0.25),
        Role::ChangedEdge => line(0x404040, 0x00806A, 0x45D6B5, 0.4),
        Role::Boundary => line(0x000000, 0x20262C, 0xF0EADB, 0.45),
        Role::Front(4) => line(0x808080, 0x6E7A87, 0x8798A9, 0.4),
        Role::Front(3) => line(0x404040, 0x7C70DA, 0x7E96F5, 0.5),
        Role::Front(2) => line(0x404040, 0x00659C, 0x74CDF7, 0.5),
        Role::Front(_) => line(0x000000, 0x002B45, 0xCFF5FF, 0.55),
        Role::Refused => Style { dash: Some([0.4, 1.2]), ..line(0x404040, 0x616A74, 0x8A939E, 0.4) },
        Role::Side => line(0x000000, 0xC77812, 0xFFD690, 0.55),
        Role::Top => Style { dash: Some([2.0, 1.3]), ..line(0x000000, 0xC77812, 0xFFD690, 0.5) },
        Role::Base => line(0x000000, 0xAD4E00, 0xFFB01F, 0.75),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red, green and blue as linear light; the standards differ in where the curve begins.
    fn linear(Rgba([r, g, b, _]): Rgba, begin: f64) -> [f64; 3] {
        [r, g, b].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= begin { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
        })
    }

    /// Contrast after WCAG 2: 1 (none) to 21.
    fn contrast(a: Rgba, b: Rgba) -> f64 {
        let luminance = |colour| {
            let [r, g, b] = linear(colour, 0.03928);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn front_and_decision_lines_stand_out_from_live_and_dead_elements() {
        for (palette, live, dead) in [(DARK, 5.8, 4.5), (LIGHT, 3.4, 2.7)] {
            for colour in palette.front.into_iter().chain([palette.base, palette.side]) {
                let (on_live, on_dead) = (contrast(colour, palette.live), contrast(colour, palette.dead));
                assert!(on_live >= live - 0.05 && on_dead >= dead - 0.05, "{colour:?}: {on_live:.2}, {on_dead:.2}");
            }
        }
    }

    #[cfg(feature = "window")]
    #[test]
    fn edges_are_seen_on_surfaces_in_the_shadow_and_towards_the_lamp() {
        for palette in [DARK, LIGHT] {
            let light = crate::render::gpu::Light::on_surfaces(palette.dark);
            for (area, edge) in [(palette.live, palette.live_edge), (palette.dead, palette.dead_edge)] {
                for towards in [0.0, 1.0] {
                    let Rgba([r, g, b, a]) = area;
                    let lit = |c| f32::from(c) * (light.even + light.lit * towards) + 255.0 * light.shine * towards;
                    let [r, g, b] = [r, g, b].map(|c: u8| lit(c).min(255.0) as u8);
                    let contrast = contrast(edge, Rgba([r, g, b, a]));
                    assert!(contrast >= 1.35, "dark: {}, {area:?} at {towards}: {contrast:.2}", palette.dark);
                }
            }
        }
    }

    #[test]
    fn the_dark_ink_of_figures_has_the_colours_of_the_dark_theme() {
        let of = |role| {
            let style = figure(role, Ink::Dark);
            style.fill.or(style.stroke.map(Paint::Colour)).unwrap()
        };
        for (role, colour) in [
            (Role::LiveTriangle, DARK.live),
            (Role::DeadQuad, DARK.dead),
            (Role::Changed, DARK.changed),
            (Role::LiveEdge, DARK.live_edge),
            (Role::DeadEdge, DARK.dead_edge),
            (Role::ChangedEdge, DARK.changed_edge),
            (Role::Boundary, DARK.boundary),
            (Role::Front(1), DARK.front[0]),
            (Role::Front(2), DARK.front[1]),
            (Role::Front(3), DARK.front[2]),
            (Role::Front(4), DARK.front[3]),
            (Role::Refused, DARK.refused),
            (Role::Side, DARK.side),
            (Role::Top, DARK.side),
            (Role::Base, DARK.base),
        ] {
            assert_eq!(of(role), Paint::Colour(colour), "{role:?}");
        }
        let inks = [ground(Ink::Dark), letter(Ink::Dark), note(Ink::Dark)];
        assert_eq!(inks, [DARK.ground, DARK.label, DARK.weak]);
        assert!(colours(Ink::Dark).contains(&[0xFF, 0xB0, 0x1F]) && colours(Ink::Grey).contains(&[0x40; 3]));
    }

    #[test]
    fn text_can_be_read_on_panels() {
        for (palette, text, weak) in [(DARK, 11.2, 5.4), (LIGHT, 11.7, 4.9)] {
            let (on_panel, weak_on_panel) =
                (contrast(palette.text, palette.panel), contrast(palette.weak, palette.panel));
            assert!(on_panel >= text - 0.05 && weak_on_panel >= weak - 0.05, "{on_panel:.2}, {weak_on_panel:.2}");
            assert!(contrast(palette.accent, palette.panel) >= 4.5);
            assert!(contrast(palette.strong, palette.button) >= 4.5);
        }
    }

    /// The perceived distance of two colours, in OKLab times 100.
    fn apart(a: Rgba, b: Rgba) -> f64 {
        let lab = |colour| {
            let [r, g, b] = linear(colour, 0.04045);
            let l = libm::cbrt(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
            let m = libm::cbrt(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
            let s = libm::cbrt(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
            glam::DVec3::new(
                0.210_454_255_3 * l + 0.793_617_785 * m - 0.004_072_046_8 * s,
                1.977_998_495_1 * l - 2.428_592_205 * m + 0.450_593_709_9 * s,
                0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766 * s,
            )
        };
        100.0 * lab(a).distance(lab(b))
    }

    #[test]
    fn charts_are_told_apart_and_features_stand_out_from_all_of_them() {
        for palette in [DARK, LIGHT] {
            for (k, &one) in palette.charts.iter().enumerate() {
                let nearest = palette.charts[..k].iter().map(|&other| apart(one, other)).fold(f64::INFINITY, f64::min);
                assert!(nearest > 3.5, "{one:?}: {nearest:.1}");
                assert!(contrast(palette.boundary, one) > 7.0, "{one:?}: {:.1}", contrast(palette.boundary, one));
                assert!(contrast(palette.weak, one) > 2.7, "{one:?}: {:.1}", contrast(palette.weak, one));
            }
        }
    }

    #[test]
    fn fading_changes_the_opacity_alone() {
        assert_eq!(Rgba::hex(0x102030).faded(0.5), Rgba::hexa(0x10203080));
        assert_eq!(Rgba([1, 2, 3, 4]).packed(), 0x0403_0201);
    }
}
