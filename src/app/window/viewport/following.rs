//! A camera that goes where the decision is, or what a lesson speaks of, softly: it stays while the decision is seen
//! well, and the user may move it away until the next step.

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
/// The room that the decision has around it in the view, in points.
const ROOM: f64 = 40.0;
/// The least length in points of a base that is seen well: in the window, and by an audience.
pub(super) const LEAST: [f64; 2] = [24.0, 90.0];
/// The room around what a lesson frames, in points.
const FRAME: f64 = 76.0;
/// A surface whose normal has less than this in common with the direction towards the eye is turned to the front.
const FACING: f64 = 0.3;
/// The camera has arrived within this share of its scale or this angle in radians, and this many points.
const ARRIVED: [f64; 2] = [0.003, 0.5];

/// The camera that follows the decisions of a run.
#[derive(Default)]
pub(super) struct Following {
    /// The run and the step that were looked at last.
    seen: Option<(u64, u64)>,
    /// The frame of a lesson that was looked at last.
    framed: Option<u64>,
    /// Where it is on its way to.
    aim: Option<Aim>,
}

/// Where a camera is on its way to.
#[derive(Clone)]
enum Aim {
    /// The decision with this base.
    Decision([NodeId; 2]),
    /// Some nodes.
    Nodes(Vec<NodeId>),
}

/// Where the nodes of a mesh lie in a view, and how its surface is turned there.
pub(super) struct Places<P, N> {
    pub place: P,
    pub normal: N,
}

impl Following {
    /// The camera of this frame, where it moves; where it follows the decisions, `follows` is the
    /// least length in points of a base that is seen well.
    pub(super) fn guide<P: Fn(&Mesh, NodeId) -> DVec3, N: Fn(&Mesh, NodeId) -> DVec3>(
        &mut self,
        ui: &Ui,
        state: &State,
        follows: Option<f64>,
        moment: &Moment,
        camera: Camera,
        size: DVec2,
        places: &Places<P, N>,
    ) -> Option<Camera> {
        let mesh = &*moment.mesh;
        let study = state.shown_study();
        if let Some((number, frame)) = study.and_then(|study| study.framed(moment.step, mesh)) {
            if self.framed.replace(number) != Some(number) {
                self.aim = Some(Aim::Nodes(nodes_of(mesh, frame)));
            }
        } else if study.is_none() {
            self.framed = None;
        }
        let now = (state.run().number, moment.step);
        if let Some(least) = follows {
            let decision = moment.decision();
            if let Some(base) = decision.base
                && self.seen != Some(now)
            {
                self.seen = Some(now);
                let nodes = decision.letters().map(|(node, _)| node).filter(|n| mesh.has_node(*n));
                let at: Vec<DVec3> = nodes.map(|n| (places.place)(mesh, n)).collect();
                self.aim = (!shows(&camera, size, &at, least)).then_some(Aim::Decision(base));
            }
        } else {
            self.seen = None;
            self.aim.take_if(|aim| matches!(aim, Aim::Decision(_)));
        }
        let target = match self.aim.as_ref()? {
            Aim::Decision(base) => {
                let (centre, scale) = near(moment, *base, size, &places.place)?;
                let mut target = camera;
                target.look_at_place(centre, scale);
                target
            }
            Aim::Nodes(nodes) => {
                // The mesh may have changed since.
                let nodes: Vec<NodeId> = nodes.iter().copied().filter(|n| mesh.has_node(*n)).collect();
                let at: Vec<DVec3> = nodes.iter().map(|n| (places.place)(mesh, *n)).collect();
                let normal = nodes.iter().map(|n| (places.normal)(mesh, *n)).sum::<DVec3>();
                framing(camera, &at, normal.normalize_or(camera.towards()), size)?
            }
        };
        let passed = f64::from(ui.input(|input| input.stable_dt)).min(LONGEST);
        let (camera, arrived) = nearer(camera, &target, 1.0 - libm::exp(-passed / EASE));
        if arrived {
            self.aim = None;
        } else {
            ui.ctx().request_repaint();
        }
        Some(camera)
    }

    /// The user has moved the camera: it stays until the next step.
    pub(super) fn leave(&mut self) {
        self.aim = None;
    }
}

/// The nodes that a frame shows: with their neighbours where they are too few to tell a size, all of them where it
/// names nothing.
fn nodes_of(mesh: &Mesh, nodes: Vec<NodeId>) -> Vec<NodeId> {
    match nodes.len() {
        0 => mesh.nodes().collect(),
        1 | 2 => nodes.iter().flat_map(|n| mesh.neighbours(*n).chain([*n])).collect(),
        _ => nodes,
    }
}

/// The camera that shows some places with room around them; what faces away from it is turned to the front.
fn framing(camera: Camera, places: &[DVec3], normal: DVec3, size: DVec2) -> Option<Camera> {
    let mut target = camera;
    if normal.dot(camera.towards()) < FACING {
        target.face(normal);
    }
    // In points of the view, whose scale is the same in all directions.
    let seen = places.iter().map(|p| target.seen(*p, size));
    let [low, high] = seen.map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    let room = (size - 2.0 * FRAME).max(DVec2::splat(FRAME));
    let extent = (high - low).truncate();
    let factor = (room / extent.max(DVec2::splat(f64::MIN_POSITIVE))).min_element();
    let centre = target.place(0.5 * (low + high), size);
    // As far as a view can be zoomed.
    target.look_at_place(centre, target.scale * factor);
    Some(target).filter(|camera| camera.scale.is_finite() && camera.centre.is_finite())
}

/// Whether a view shows some places, the first two of which are the ends of the base, with room around them.
fn shows(camera: &Camera, size: DVec2, places: &[DVec3], least: f64) -> bool {
    let at: Vec<DVec2> = places.iter().map(|p| camera.project(*p, size)).collect();
    let is_inside = |p: &DVec2| p.cmpgt(DVec2::splat(ROOM)).all() && p.cmplt(size - ROOM).all();
    at.len() > 1 && at.iter().all(is_inside) && at[0].distance(at[1]) >= least
}

/// A camera a share of the way nearer to another one, and whether it is there.
fn nearer(mut camera: Camera, target: &Camera, share: f64) -> (Camera, bool) {
    let factor = libm::log(target.scale / camera.scale);
    let away = camera.centre.distance(target.centre) * camera.scale.max(target.scale);
    let turned = camera.turn.angle_between(target.turn);
    if factor.abs() < ARRIVED[0] && turned < ARRIVED[0] && away < ARRIVED[1] {
        return (*target, true);
    }
    camera.turn = camera.turn.slerp(target.turn, share);
    // The place moves on the screen by the same share, whether the view grows or shrinks.
    camera.look_at_place(camera.centre.lerp(target.centre, share), camera.scale * libm::exp(share * factor));
    (camera, false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_comes_nearer_in_every_frame_and_arrives() {
        let mut camera = Camera::fit([DVec2::ZERO, DVec2::ONE], DVec2::splat(400.0), 0.0);
        let (centre, scale) = (DVec3::new(0.9, 0.8, 0.0), 40.0 * camera.scale);
        let mut target = camera;
        target.look_at_place(centre, scale);
        let mut frames = 0;
        loop {
            let before = camera;
            let (next, arrived) = nearer(camera, &target, 0.11);
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
        assert!(shows(&camera, size, &[at(0.4, 0.5), at(0.5, 0.5), at(0.5, 0.6)], 24.0));
        assert!(!shows(&camera, size, &[at(0.4, 0.5), at(0.5, 0.5), at(0.5, 0.6)], 90.0), "too small for an audience");
        assert!(!shows(&camera, size, &[at(0.4, 0.5), at(0.41, 0.5)], 24.0), "the base is a dot");
        assert!(!shows(&camera, size, &[at(0.4, 0.5), at(0.5, 0.5), at(0.5, 0.99)], 24.0), "a top is at the edge");
        assert!(!shows(&camera, size, &[], 24.0));
    }

    #[test]
    fn what_is_framed_fills_the_view_but_for_the_room_around_it_and_faces_it() {
        let size = DVec2::new(600.0, 400.0);
        let camera = Camera::fit([DVec2::ZERO, DVec2::ONE], size, 0.0);
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let within = |camera: &Camera, places: &[DVec3]| {
            let seen: Vec<DVec2> = places.iter().map(|p| camera.project(*p, size)).collect();
            let low = seen.iter().copied().reduce(DVec2::min).unwrap();
            let high = seen.iter().copied().reduce(DVec2::max).unwrap();
            assert!((low.min_element() - FRAME).abs() < 1e-6 || (low - DVec2::splat(FRAME)).min_element().abs() < 1e-6);
            assert!((low - DVec2::splat(FRAME)).min_element() > -1e-6, "{low}");
            assert!((size - DVec2::splat(FRAME) - high).min_element() > -1e-6, "{high}");
            assert!((0.5 * (low + high) - 0.5 * size).length() < 1e-6);
        };
        let places = [at(0.1, 0.2, 0.0), at(0.3, 0.25, 0.0), at(0.2, 0.3, 0.0)];
        let plain = framing(camera, &places, DVec3::Z, size).unwrap();
        assert_eq!(plain.turn, camera.turn);
        within(&plain, &places);
        // Seen from behind, and standing upright.
        let upright = [at(0.5, 0.1, 0.2), at(0.5, 0.4, 0.9), at(0.5, 0.2, 0.6)];
        let turned = framing(camera, &upright, DVec3::X, size).unwrap();
        assert!(turned.towards().dot(DVec3::X) > 0.99);
        within(&turned, &upright);
        assert!(framing(camera, &[], DVec3::Z, size).is_none());
        // On its way it turns too, and arrives.
        let mut moving = camera;
        for _ in 0..200 {
            moving = nearer(moving, &turned, 0.11).0;
        }
        assert_eq!((moving.centre, moving.scale, moving.turn), (turned.centre, turned.scale, turned.turn));
    }
}
