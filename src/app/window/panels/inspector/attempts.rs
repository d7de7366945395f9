//! The attempts at the quadrilateral under way, as a tree: what each tried, its steps, and why it was taken back.

use eframe::egui::{CollapsingHeader, Role, Ui, WidgetInfo};

use super::past::step_link;
use super::{line, section, sentence};
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::words;
use crate::core::run::explain;
use crate::render::palette::Palette;

pub fn show(ui: &mut Ui, moment: &Moment, commands: &mut Vec<Command>, palette: &Palette) {
    let count = words::counted(moment.attempts.len() as u64, "attempt");
    if !section(ui, "Attempts at this quadrilateral", &count, palette) {
        return;
    }
    let last = moment.attempts.len().saturating_sub(1);
    for (k, tried) in moment.attempts.iter().enumerate() {
        let name = format!("Attempt {}: {}", u32::from(tried.attempt.number) + 1, explain::attempt(&tried.attempt));
        let step = tried.steps.first().map_or(moment.step, |step| step.0);
        let shown = CollapsingHeader::new(line(&name, palette.strong))
            .id_salt((moment.so_far.first().map(|first| first.0), k, step))
            .default_open(k == last)
            .show(ui, |ui| {
                for (step, event) in &tried.steps {
                    step_link(ui, *step, &words::event(event), commands, palette);
                }
            });
        shown.header_response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name.clone()));
        if let Some(why) = tried.failed() {
            ui.indent(&name, |ui| {
                sentence(ui, &format!("Taken back: {}.", words::why(why)), palette.text, palette);
            });
        }
    }
}
