//! A preview of the figure as the panel describes it, drawn beside the window by the code that writes it.

use std::sync::mpsc::{Receiver, TryRecvError};

use eframe::egui::{ColorImage, Image, Label, Sense, TextureHandle, TextureOptions, Ui, Vec2};

use super::super::{line, note};
use crate::app::window::figures::{self, FigureForm};
use crate::app::window::state::{State, ViewCamera};
use crate::core::fault::Fault;
use crate::core::run::Bookmark;
use crate::render::palette::Palette;

/// The greatest size of the preview in points.
const MOST: Vec2 = Vec2::new(280.0, 300.0);

/// What the preview depends on: the form, the step and the number of the run, its bookmarks, its changes, and the
/// cameras.
type Key = (FigureForm, u64, u64, Vec<Bookmark>, usize, [ViewCamera; 2]);

/// The preview that is shown, and the one that is being drawn.
#[derive(Default)]
pub struct PreviewState {
    key: Option<Key>,
    drawing: Option<Receiver<Result<ColorImage, Fault>>>,
    shown: Option<Result<TextureHandle, String>>,
}

impl PreviewState {
    /// Shows the preview, and has it drawn again if anything has changed.
    pub fn show(&mut self, ui: &mut Ui, state: &State, palette: &Palette) {
        self.follow(ui, state);
        // It keeps its room, so that what is below does not move.
        let (rect, response) = ui.allocate_exact_size(MOST, Sense::hover());
        let mut inner = ui.new_child(eframe::egui::UiBuilder::new().max_rect(rect));
        match &self.shown {
            Some(Ok(texture)) => {
                let size = texture.size_vec2();
                let scale = (MOST / size).min_elem().min(1.0);
                let at = eframe::egui::Rect::from_center_size(rect.center(), size * scale);
                inner.put(at, Image::new(texture).fit_to_exact_size(size * scale).alt_text("Preview of the figure"));
            }
            Some(Err(fault)) => drop(inner.add(Label::new(line(fault, palette.broken)).wrap())),
            None => drop(inner.label(note("The preview is being drawn.", palette))),
        }
        response.on_hover_text("The figure as it will be written");
    }

    fn follow(&mut self, ui: &Ui, state: &State) {
        match self.drawing.as_ref().map(Receiver::try_recv) {
            Some(Err(TryRecvError::Empty)) => return,
            Some(Ok(Ok(image))) => {
                let texture = ui.ctx().load_texture("preview of the figure", image, TextureOptions::LINEAR);
                self.shown = Some(Ok(texture));
            }
            Some(Ok(Err(fault))) => self.shown = Some(Err(fault.to_string())),
            Some(Err(TryRecvError::Disconnected)) | None => {}
        }
        self.drawing = None;
        let Some(moment) = state.run().moment.as_ref().filter(|_| !state.run().is_busy()) else { return };
        let view = state.view();
        let form = FigureForm { name: String::new(), folder: String::new(), ..state.workspace().figure.clone() };
        let document = state.document();
        let key = Some((
            form,
            moment.step,
            state.run().number,
            document.bookmarks.clone(),
            document.edits.len(),
            [view.plane, view.space],
        ));
        if self.key == key {
            return;
        }
        self.key = key;
        let pixels = MOST * ui.pixels_per_point();
        match figures::preview(state, pixels.into()) {
            Ok(drawing) => self.drawing = drawing,
            Err(fault) => self.shown = Some(Err(fault.to_string())),
        }
    }
}
