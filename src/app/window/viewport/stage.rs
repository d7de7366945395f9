//! A scene and the changes of the state that it has not drawn yet.

use std::sync::Arc;

use super::ViewFrame;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::core::run::Changes;
use crate::core::run::copies::Since;
use crate::render::palette::Palette;
use crate::render::scene::{ColourBy, Decision, Drawn, Form, Overlay, Scene, Shading};

/// A scene that follows the state.
pub(super) struct Stage {
    pub scene: Arc<Scene>,
    /// The differences of the state from the one that it shows.
    changes: Since,
    /// The style, theme and form of the picture.
    style: Option<(u64, bool, Form)>,
    /// The range of what elements are coloured by.
    range: [f64; 2],
    over: Option<u64>,
}

impl Default for Stage {
    fn default() -> Self {
        Stage { scene: Arc::default(), changes: Since::everything(), style: None, range: [0.0; 2], over: None }
    }
}

impl Stage {
    /// Whether it has shown a mesh.
    pub fn has_shown(&self) -> bool {
        self.style.is_some()
    }

    /// Notes changes of the state.
    pub fn note(&mut self, changes: &Changes, slots: usize) {
        self.changes.note(changes, slots);
    }

    /// Brings the scene up to date with the state, by the differences if possible. `leads`: the scene is laid out for
    /// this view.
    pub fn update(
        &mut self,
        state: &State,
        moment: &Moment,
        palette: &Palette,
        frame: &ViewFrame,
        form: Form,
        leads: bool,
        shading: &mut Shading,
    ) {
        let served = frame.camera.is_served_by(self.scene.anchor, frame.size());
        let style = Some((state.view().style_epoch, palette.dark, form));
        let again = self.style != style || (leads && !served);
        if again || !self.changes.is_nothing() {
            let by = state.document().colour_by;
            if by != ColourBy::State || shading.by != by {
                *shading = Shading::of(&moment.mesh, by, &state.births(by, moment));
            }
            let drawn = Drawn {
                mesh: &moment.mesh,
                changed: &moment.changed,
                shading,
                layers: state.document().layers,
                palette,
                form,
            };
            let scene = Arc::make_mut(&mut self.scene);
            match self.changes.take() {
                Changes::Some { nodes, elements } if !again && shading.range == self.range => {
                    scene.patch_mesh(&drawn, &nodes, &elements);
                }
                _ => {
                    let keep = (served && self.style.is_some()) || !leads;
                    scene.set_mesh(&drawn, if keep { scene.anchor } else { frame.camera.centre });
                    self.style = style;
                    self.range = shading.range;
                }
            }
            self.over = None;
        }
        if self.over != Some(state.view().over_epoch) {
            let background = state.run().opened.as_ref().filter(|_| state.document().layers.background);
            let refused = if state.hides_candidates() { Vec::new() } else { moment.refused() };
            let overlay = Overlay {
                mesh: &moment.mesh,
                front: &moment.front,
                changed: &moment.changed,
                decision: Decision::of(&moment.phase),
                is_coloured: state.document().colour_by != ColourBy::State,
                refused: &refused.iter().map(|candidate| candidate.ends).collect::<Vec<_>>(),
                picked: state.document().picked,
                hovered: state.frame().hovered,
                lit: &state.view().lit,
                spoken: &state.spoken(),
                hides_classes: state.hides_classes(),
                background: background.map(|opened| &opened.background.mesh),
            };
            Arc::make_mut(&mut self.scene).set_overlay(&overlay, state.document().layers, palette);
            self.over = Some(state.view().over_epoch);
        }
    }
}
