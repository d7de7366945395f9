//! A presentation: the view of the run at hand, and below it the sentence of the step in large type.

use eframe::egui::{
    Align, Align2, CentralPanel, Color32, Frame, Label, Layout, Panel, Rect, RichText, Role, Sense, Ui, UiBuilder,
    Vec2, WidgetInfo, accesskit,
};

use super::in_lines;
use crate::app::window::command::Command;
use crate::app::window::presentation::{Audience, PresentationForm};
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::viewport::{Views, pair};
use crate::app::window::words;
use crate::core::run::explain::plain;
use crate::render::palette::Palette;

/// How much larger labels in the view are.
const LABELS: f32 = 1.5;
/// The font size of the sentence in heights of the window, and its least and greatest one in points.
const SENTENCE: f32 = 1.0 / 32.0;
const SIZES: [f32; 2] = [19.0, 36.0];
/// The lines of the sentence, and their height in font sizes: no step changes them.
const LINES: usize = 3;
const LINE: f32 = 1.32;
/// Smaller sizes for longer sentences.
const SMALLER: [f32; 4] = [1.0, 0.88, 0.76, 0.66];
/// The room around the sentence.
const SIDE: f32 = 28.0;
/// The size of step and number of quadrilaterals, in that of the sentence, and its least.
const CORNER: f32 = 0.58;
const LEAST: f32 = 12.5;

/// Shows it. Returns where the view is.
pub fn show(
    ui: &mut Ui,
    window: &State,
    views: &mut [Views; 2],
    plain_frame: Frame,
    commands: &mut Vec<Command>,
    palette: &'static Palette,
) -> Rect {
    let whole = ui.available_rect_before_wrap();
    if window.view().is_black {
        black(ui, whole);
        return whole;
    }
    let state = window.active();
    let size = (SENTENCE * whole.height()).clamp(SIZES[0], SIZES[1]);
    let height = LINES as f32 * LINE * size + SIDE;
    Panel::bottom("sentence").frame(plain_frame).exact_size(height).show(ui, |ui| sentence(ui, state, size, palette));
    let shown = ui.available_rect_before_wrap();
    let PresentationForm { spotlight, follows } = window.workspace().presentation;
    CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
        let which = window.active_run();
        let views = &mut views[which as usize];
        views.audience = Some(Audience { type_scale: LABELS, spotlight, follows });
        match window.pair() {
            Some(_) => {
                pair::view(ui, shown, window, which, views, commands, palette);
            }
            None => views.space(ui, window, commands, palette),
        }
        views.audience = None;
    });
    corner(ui, shown, window, (CORNER * size).max(LEAST), palette);
    shown
}

/// Nothing but black, as clickers ask for it.
fn black(ui: &mut Ui, rect: Rect) {
    let response = ui.allocate_rect(rect, Sense::hover());
    ui.painter().rect_filled(rect, 0.0, Color32::BLACK);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, "Black screen"));
}

/// What the last step did, in the middle of its lines.
fn sentence(ui: &mut Ui, state: &State, size: f32, palette: &Palette) {
    let rect = ui.max_rect();
    ui.painter().hline(rect.x_range(), rect.top() + 0.5, (1.0, ink(palette.line)));
    let Some(moment) = &state.run().moment else { return };
    let text = &moment.narration;
    let sizes = SMALLER.map(|share| share * size);
    let galley = in_lines(ui.painter(), text, rect.width() - 2.0 * SIDE, LINES, &sizes, palette);
    let at = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), rect);
    let told = ui.allocate_rect(at, Sense::hover());
    ui.painter().galley(at.min, galley, ink(palette.text));
    told.widget_info(|| WidgetInfo::labeled(Role::Status, true, plain(text)));
    // Screen readers say it when it changes.
    ui.ctx().accesskit_node_builder(told.id, |node| node.set_live(accesskit::Live::Polite));
}

/// Step and number of quadrilaterals, or the work under way.
fn corner(ui: &mut Ui, view: Rect, window: &State, size: f32, palette: &Palette) {
    let run = window.active().run();
    let waits = run.is_busy() && run.since.is_some_and(|since| since.elapsed().as_millis() > 150);
    let text = match (&run.progress, &run.moment) {
        (Some(progress), _) if waits => words::progress(progress),
        (_, Some(moment)) => {
            let quads = words::counted(moment.standing, "quad");
            let which = window.pair().map(|_| format!("run {}   ", window.active_run().name()));
            format!("{}step {}   {quads}", which.unwrap_or_default(), words::grouped(moment.step))
        }
        _ => return,
    };
    let place = Rect::from_min_size(view.min + Vec2::new(14.0, 10.0), Vec2::new(0.5 * view.width(), 2.0 * size));
    let layout = Layout::left_to_right(Align::Min);
    ui.scope_builder(UiBuilder::new().max_rect(place).layout(layout), |ui| {
        Frame::NONE.fill(ink(palette.label_plate)).corner_radius(3.0).inner_margin(5).show(ui, |ui| {
            let text = RichText::new(text).font(theme::regular(size)).color(ink(palette.label));
            ui.add(Label::new(text).selectable(false));
        });
    });
}
