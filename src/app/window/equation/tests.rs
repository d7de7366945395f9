use eframe::egui::{Context, FontDefinitions, FontFamily, RawInput, Rect, Vec2};

use super::*;
use crate::app::window::theme;
use crate::core::lesson::{Equation, built_in};

/// Calls `look` in a panel of a width.
fn in_panel(width: f32, mut look: impl FnMut(&mut Ui)) {
    let context = Context::default();
    theme::install(&context);
    let screen = Rect::from_min_size(Pos2::ZERO, Vec2::new(width, 600.0));
    // Fonts are there from the second frame on.
    for frame in 0..2 {
        let input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
        let mut output = context.run_ui(input, |ui| {
            if frame == 1 {
                look(ui);
            }
        });
        // Nothing is drawn.
        output.textures_delta.clear();
    }
}

#[test]
fn every_sign_is_in_the_fonts_of_equations() {
    // Only our own: others would stand in with letters of another kind.
    let mut fonts = theme::fonts();
    for names in fonts.families.values_mut() {
        names.truncate(1);
    }
    let has = |fonts: &FontDefinitions, face: Face, c: char| {
        let context = Context::default();
        context.set_fonts(fonts.clone());
        let mut is_there = false;
        for _ in 0..2 {
            let mut output = context.run_ui(RawInput::default(), |ui| {
                is_there = ui.fonts_mut(|fonts| fonts.has_glyph(&font(face, 17.0), c));
            });
            output.textures_delta.clear();
        }
        is_there
    };
    assert!(!has(&fonts, Face::Upright, '\u{2207}'), "the test would see what is missing");
    assert!(fonts.families.contains_key(&FontFamily::Name("equation-italic".into())));
    for sign in crate::core::lesson::equation::signs() {
        let face = if sign.is_slanted() { Face::Italic } else { Face::Upright };
        assert!(has(&fonts, face, sign.glyph), "{}", sign.glyph);
    }
}

#[test]
fn equations_fit_the_panel_and_stand_on_their_baseline() {
    for equation in built_in::equations() {
        let mut whole = Vec2::ZERO;
        in_panel(2000.0, |ui| whole = Typeset::new(ui, &equation, 17.0).size());
        for width in [420.0, 260.0] {
            in_panel(width, |ui| {
                let set = Typeset::new(ui, &equation, 17.0);
                let room = ui.available_width();
                assert!(set.size().x <= room, "{}: {} of {room}", equation.tex(), set.size().x);
                assert!(set.size().x <= whole.x && set.baseline() > 0.0 && set.baseline() < set.size().y);
                let response = set.show(ui, Color32::WHITE);
                // Panels are laid out in fractions of a point.
                assert!((response.rect.size() - set.size()).abs().max_elem() < 0.1);
            });
        }
        assert!(whole.y > 17.0);
    }
    let one = Equation::parse("x").map_err(|(fault, _)| fault).unwrap();
    in_panel(400.0, |ui| {
        // A small letter: nothing of it is below the baseline.
        let set = Typeset::new(ui, &one, 17.0);
        let below = set.size().y - set.baseline() - AROUND * 17.0;
        assert!((0.0..=1.5).contains(&below), "{below}");
        // As high as the font says, and at most a pixel more.
        let above = set.baseline() - AROUND * 17.0;
        assert!((0.516 * 17.0 - 1.0..=0.516 * 17.0 + 1.5).contains(&above), "{above}");
    });
}

/// All equations of the lessons on one page, as a picture; kept as a file where `QUADFRONT_PICTURES` names a folder for
/// those who want to look at it.
#[cfg(feature = "uitest")]
#[test]
fn equations_are_drawn_where_their_texts_are() {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    if wgpu_adapter().is_none() {
        println!("skipped: there is no graphics adapter");
        return;
    }
    let equations = built_in::equations();
    for dark in [true, false] {
        let palette = theme::palette(dark);
        let (colour, ground) = (theme::ink(palette.strong), theme::ink(palette.panel));
        let mut harness = Harness::builder().with_size(Vec2::new(700.0, 780.0)).wgpu().build_ui(|ui| {
            theme::install(ui.ctx());
            let screen = ui.ctx().content_rect();
            ui.painter().rect_filled(screen, 0.0, ground);
            for shown in &equations {
                ui.horizontal(|ui| {
                    equation(ui, shown, 17.0, colour);
                });
                ui.add_space(12.0);
            }
            // In a narrow panel.
            ui.set_max_width(260.0);
            equations.iter().for_each(|shown| drop(equation(ui, shown, 17.0, colour)));
        });
        harness.run_steps(3);
        let image = harness.render().unwrap();
        if let Some(folder) = std::env::var_os("QUADFRONT_PICTURES") {
            let name = format!("equations-{}.png", if dark { "dark" } else { "light" });
            let file = std::fs::File::create(std::path::Path::new(&folder).join(name)).unwrap();
            let mut encoder = png::Encoder::new(file, image.width(), image.height());
            encoder.set_color(png::ColorType::Rgba);
            encoder.write_header().unwrap().write_image_data(image.as_raw()).unwrap();
        }
        let is_ink = |x: u32, y: u32| {
            let pixel = image.get_pixel(x, y);
            (0..3).any(|k| pixel[k].abs_diff([ground.r(), ground.g(), ground.b()][k]) > 60)
        };
        for shown in &equations {
            let text = shown.text();
            let found: Vec<_> = harness.query_all_by_label(&text).collect();
            assert!(found.len() >= 2, "{text}");
            for node in found {
                let rect = node.rect().intersect(Rect::from_min_size(Pos2::ZERO, Vec2::new(700.0, 780.0)));
                let inked = (rect.top() as u32..rect.bottom() as u32)
                    .flat_map(|y| (rect.left() as u32..rect.right() as u32).map(move |x| (x, y)))
                    .filter(|&(x, y)| is_ink(x, y))
                    .count() as f32;
                let share = inked / rect.area();
                assert!((0.01..0.5).contains(&share), "{text}: {share}");
            }
        }
    }
}

#[cfg(feature = "uitest")]
fn wgpu_adapter() -> Option<eframe::wgpu::Adapter> {
    use eframe::wgpu;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).ok()
}
