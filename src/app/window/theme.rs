//! Fonts, sizes, spacing and the two themes.

use std::sync::Arc;

use eframe::egui::epaint::Shadow;
use eframe::egui::style::{HandleShape, ScrollStyle, WidgetVisuals};
use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{
    Align, Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Stroke, Style,
    TextStyle, Vec2, Visuals,
};

use crate::render::palette::{DARK, LIGHT, Palette, Rgba};

/// Sizes of text in points.
pub const BODY: f32 = 13.0;
pub const TABLE: f32 = 12.5;
pub const HEAD: f32 = 11.5;
pub const TIMELINE: f32 = 11.0;
pub const FORMULA: f32 = 13.5;
pub const TITLE: f32 = 16.0;
pub const ICON: f32 = 16.0;
pub const TRANSPORT_ICON: f32 = 18.0;

/// The colour for egui.
pub fn ink(Rgba([r, g, b, a]): Rgba) -> Color32 {
    Color32::from_rgba_unmultiplied(r, g, b, a)
}

/// The palette of the theme in force.
pub fn palette(dark: bool) -> &'static Palette {
    if dark { &DARK } else { &LIGHT }
}

/// Emphasised text: headings, active tabs, results.
pub fn semibold(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name("semibold".into()))
}

/// Text a little stronger than the rest.
pub fn medium(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name("medium".into()))
}

/// Ordinary text.
pub fn regular(size: f32) -> FontId {
    FontId::new(size, FontFamily::Proportional)
}

/// Variables in equations.
pub fn equation_italic(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name("equation-italic".into()))
}

/// Text with subscripts, written `_{x}`, and emphasis, written `**x**`.
pub fn formula(text: &str, size: f32, colour: Color32, strong: Color32) -> LayoutJob {
    let mut job = LayoutJob::default();
    for (k, mut rest) in text.split("**").enumerate() {
        let (font, colour) = match k % 2 {
            1 => (semibold as fn(f32) -> FontId, strong),
            _ => (regular as fn(f32) -> FontId, colour),
        };
        while !rest.is_empty() {
            let parts = rest.split_once("_{").and_then(|(plain, after)| Some((plain, after.split_once('}')?)));
            let (plain, (low, after)) = parts.unwrap_or((rest, ("", "")));
            for (text, size, valign) in [(plain, size, Align::Center), (low, 0.75 * size, Align::BOTTOM)] {
                let format = TextFormat { font_id: font(size), color: colour, valign, ..TextFormat::default() };
                job.append(text, 0.0, format);
            }
            rest = after;
        }
    }
    job
}

/// Installs fonts and styles in a context.
pub fn install(context: &Context) {
    context.set_fonts(fonts());
    context.set_visuals_of(eframe::egui::Theme::Dark, visuals(&DARK));
    context.set_visuals_of(eframe::egui::Theme::Light, visuals(&LIGHT));
    context.all_styles_mut(sizes);
}

pub(super) fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let files: [(&str, &'static [u8]); 5] = [
        ("plex", include_bytes!("../../../assets/fonts/QuadfrontSans-Regular.ttf")),
        ("plex-medium", include_bytes!("../../../assets/fonts/QuadfrontSans-Medium.ttf")),
        ("plex-semibold", include_bytes!("../../../assets/fonts/QuadfrontSans-SemiBold.ttf")),
        ("equation-italic", include_bytes!("../../../assets/fonts/QuadfrontEquation-Italic.ttf")),
        ("phosphor", include_bytes!("../../../assets/fonts/Phosphor.ttf")),
    ];
    for (name, bytes) in files {
        let mut data = FontData::from_static(bytes);
        if name == "phosphor" {
            // Phosphor's glyphs stand high on the line.
            data.tweak.y_offset_factor = 0.1;
        }
        fonts.font_data.insert(name.to_owned(), Arc::new(data));
    }
    let fallback = fonts.families.get(&FontFamily::Proportional).cloned().unwrap_or_default();
    for (family, first) in [
        (FontFamily::Proportional, "plex"),
        (FontFamily::Monospace, "plex"),
        (FontFamily::Name("medium".into()), "plex-medium"),
        (FontFamily::Name("semibold".into()), "plex-semibold"),
        (FontFamily::Name("equation-italic".into()), "equation-italic"),
    ] {
        // Only the regular font has all letters.
        let mut names = [first, "plex", "phosphor"].map(str::to_owned).to_vec();
        names.dedup();
        names.extend(fallback.iter().cloned());
        fonts.families.insert(family, names);
    }
    fonts
}

fn sizes(style: &mut Style) {
    style.text_styles = [
        (TextStyle::Body, regular(BODY)),
        (TextStyle::Button, regular(BODY)),
        (TextStyle::Small, regular(HEAD)),
        (TextStyle::Monospace, regular(TABLE)),
        (TextStyle::Heading, semibold(TITLE)),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(7.0, 4.0);
    spacing.button_padding = Vec2::new(8.0, 3.0);
    spacing.window_margin = Margin::same(0);
    spacing.menu_margin = Margin::same(6);
    spacing.interact_size.y = 22.0;
    spacing.combo_height = 400.0;
    spacing.slider_rail_height = 4.0;
    spacing.scroll = ScrollStyle::thin();
    style.animation_time = 0.08;
    style.interaction.tooltip_delay = 0.35;
}

fn visuals(palette: &Palette) -> Visuals {
    let mut visuals = if palette.dark { Visuals::dark() } else { Visuals::light() };
    let radius = CornerRadius::same(4);
    let line = Stroke::new(1.0, ink(palette.line));
    let widget = |fill: Rgba, text: Rgba, border: Stroke| WidgetVisuals {
        bg_fill: ink(fill),
        weak_bg_fill: ink(fill),
        bg_stroke: border,
        corner_radius: radius,
        fg_stroke: Stroke::new(1.0, ink(text)),
        expansion: 0.0,
    };
    let hint = Stroke::new(1.0, ink(palette.hint));
    visuals.widgets.noninteractive = widget(palette.panel, palette.text, line);
    visuals.widgets.inactive = widget(palette.button, palette.text, line);
    visuals.widgets.hovered = widget(palette.button, palette.strong, hint);
    visuals.widgets.active = widget(palette.button, palette.strong, Stroke::new(1.0, ink(palette.weak)));
    visuals.widgets.open = widget(palette.button, palette.strong, line);
    // Rails and check boxes must be seen on the panel.
    visuals.widgets.inactive.bg_fill = ink(palette.line);
    visuals.handle_shape = HandleShape::Circle;
    // A neutral colour marks the user's selection: amber rows are the algorithm's.
    visuals.selection.bg_fill = ink(palette.selection.faded(0.13));
    visuals.selection.stroke = Stroke::new(1.0, ink(palette.strong));
    visuals.panel_fill = ink(palette.panel);
    visuals.window_fill = ink(palette.panel);
    visuals.window_stroke = line;
    visuals.window_corner_radius = radius;
    visuals.menu_corner_radius = radius;
    visuals.window_shadow = Shadow::NONE;
    visuals.faint_bg_color = ink(palette.stripe);
    visuals.extreme_bg_color = ink(palette.field);
    visuals.text_edit_bg_color = Some(ink(palette.field));
    visuals.weak_text_color = Some(ink(palette.weak));
    visuals.hyperlink_color = ink(palette.accent);
    visuals.warn_fg_color = ink(palette.accent);
    visuals.error_fg_color = ink(palette.broken);
    visuals.striped = true;
    visuals
}
