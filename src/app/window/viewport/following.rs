//! A camera that goes where the decision is, softly: it stays while the decision is seen well, and the user may move it
//! away until the next step.

use eframe::egui::Ui;
use glam::{DVec2, DVec3};

use super::cameras::near;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::core::mesh::{Mesh, NodeId};
use crate::render::camera::Camera;

/// The time in which the camera does all but a third of what is left of its way, in seconds.
const EASE: f64 = 0.14;
/// The longest time that a frame counts for: after a pause the camera does not leap.
const LONGEST: f64 = 0.05;
/// The room that the decision has around it in the view, in points, and the least length of its base.
const ROOM: f64 = 40.0;
const LEAST: f64 = 24.0;
/// The camera has arrived within this share of its scale, and this many points.
const ARRIVED: [f64; 2] = [0.003, 0.5];

/// The camera that follows the decisions of a run.
#[derive(Default)]
pub(super) struct Following {
    /// The run and the step that were looked at last.
    seen: Option<(u64, u64)>,
    /// Whether it is on its way.
    moves: bool,
}

impl Following {
    /// The camera of this frame, where it moves; `place` is where nodes lie in the view.
    pub(super) fn guide(
        &mut self,
        ui: &Ui,
        state: &State,
        follows: bool,
        moment: &Moment,
        camera: Camera,
        size: DVec2,
        place: impl Fn(&Mesh, NodeId) -> DVec3,
    ) -> Option<Camera> {
        if !follows {
            *self = Following::default();
            return None;
        }
        let decision = moment.decision();
        let base = decision.base?;
        let now = (state.run().number, moment.step);
        if self.seen != Some(now) {
            self.seen = Some(now);
            let nodes = decision.letters().map(|(node, _)| node).filter(|n| moment.mesh.has_node(*n));
            let places: Vec<DVec3> = nodes.map(|n| place(&moment.mesh, n)).collect();
            self.moves = !shows(&camera, size, &places);
        }
        if !self.moves {
            return None;
        }
        let (centre, scale) = near(moment, base, size, place)?;
        let passed = f64::from(ui.input(|input| input.stable_dt)).min(LONGEST);
        let (camera, arrived) = nearer(camera, centre, scale, 1.0 - libm::exp(-passed / EASE));
        self.moves = !arrived;
        if !arrived {
            ui.ctx().request_repaint();
        }
        Some(camera)
    }

    /// The user has moved the camera: it stays until the next step.
    pub(super) fn leave(&mut self) {
        self.moves = false;
    }
}

/// Whether a view shows some places, the first two of which are the ends of the base, with room around them.
fn shows(camera: &Camera, size: DVec2, places: &[DVec3]) -> bool {
    let at: Vec<DVec2> = places.iter().map(|p| camera.project(*p, size)).collect();
    let is_inside = |p: &DVec2| p.cmpgt(DVec2::splat(ROOM)).all() && p.cmplt(size - ROOM).all();
    at.len() > 1 && at.iter().all(is_inside) && at[0].distance(at[1]) >= LEAST
}

/// A camera a share of the way nearer to a place and a scale, and whether it is there.
fn nearer(mut camera: Camera, centre: DVec3, scale: f64, share: f64) -> (Camera, bool) {
    let factor = libm::log(scale / camera.scale);
    let away = camera.centre.distance(centre) * camera.scale.max(scale);
    if factor.abs() < ARRIVED[0] && away < ARRIVED[1] {
        camera.look_at_place(centre, scale);
        return (camera, true);
    }
    // The place moves on the screen by the same share, whether the view grows or shrinks.
    camera.look_at_place(camera.centre.lerp(centre, share), camera.scale * libm::exp(share * factor));
    (camera, false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_comes_nearer_in_every_frame_and_arrives() {
        let mut camera = Camera::fit([DVec2::ZERO, DVec2::ONE], DVec2::splat(400.0), 0.0);
        let (centre, scale) = (DVec3::new(0.9, 0.8, 0.0), 40.0 * camera.scale);
        let mut frames = 0;
        loop {
            let before = camera;
            let (next, arrived) = nearer(camera, centre, scale, 0.11);
            camera = next;
            frames += 1;
            if arrived {
                break;
            }
            assert!(camera.centre.distance(centre) < before.centre.distance(centre) && camera.scale > before.scale);
            assert!(camera.scale < scale && frames < 200);
        }
        assert!((camera.centre, camera.scale) == (centre, scale) && frames > 20, "{frames}");
    }

    #[test]
    fn a_decision_is_shown_where_all_of_it_has_room_and_the_base_can_be_read() {
        let size = DVec2::splat(400.0);
        let camera = Camera::fit([DVec2::ZERO, DVec2::ONE], size, 0.0);
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        assert!(shows(&camera, size, &[at(0.4, 0.5), at(0.5, 0.5), at(0.5, 0.6)]));
        assert!(!shows(&camera, size, &[at(0.4, 0.5), at(0.41, 0.5)]), "the base is a dot");
        assert!(!shows(&camera, size, &[at(0.4, 0.5), at(0.5, 0.5), at(0.5, 0.99)]), "a top is at the edge");
        assert!(!shows(&camera, size, &[]));
    }
}
