//! From the mesh to the screen and back: an orthographic camera in f64, so that a mesh with sizes 1 and 1e-4 can be
//! viewed closely without jitter. Screen positions are in points, x to the right and y down, from the top left corner
//! of a view.

use crate::core::run::run;
use glam::{DMat2, DMat3, DQuat, DVec2, DVec3, Mat4};

/// The range of scales, relative to that of the whole mesh fitted to the view.
const ZOOM: [f64; 2] = [0.1, 1e7];

/// The position and scale of a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point of the mesh at the centre of the view.
    pub centre: DVec3,
    /// Points per unit of the mesh.
    pub scale: f64,
    /// The rotation of the mesh; the identity for a plane seen from above.
    pub turn: DQuat,
    /// A map of the plane before everything else: the metric lens.
    pub lens: DMat2,
    /// Points per unit at which the whole mesh fits.
    fitted: f64,
    /// An approximate bound of the distance of all visible points from the centre.
    reach: f64,
}

/// The direction from which a mesh in space is viewed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Bearing {
    /// From the front, right and above.
    #[default]
    Iso,
    /// From +x.
    X,
    /// From +y.
    Y,
    /// From +z.
    Z,
    /// Azimuth in degrees from -y to the right, elevation, and anticlockwise roll of the picture.
    Angles([f64; 3]),
}

impl Bearing {
    /// Parses `iso`, `x`, `y`, `z`, or degrees: `AZ,EL` or `AZ,EL,ROLL`.
    pub fn parse(text: &str) -> Option<Bearing> {
        Some(match text.trim().to_lowercase().as_str() {
            "iso" => Bearing::Iso,
            "x" => Bearing::X,
            "y" => Bearing::Y,
            "z" => Bearing::Z,
            text => {
                let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite() && x.abs() <= 360.0);
                let numbers: Vec<f64> = text.split(',').map(number).collect::<Option<_>>()?;
                let angles = match numbers[..] {
                    [azimuth, elevation] => [azimuth, elevation, 0.0],
                    [azimuth, elevation, roll] => [azimuth, elevation, roll],
                    _ => return None,
                };
                (angles[1].abs() <= 90.0).then_some(Bearing::Angles(angles))?
            }
        })
    }

    /// Azimuth, elevation and roll in degrees.
    pub fn angles(self) -> [f64; 3] {
        match self {
            Bearing::Iso => [33.0, 27.0, 0.0],
            Bearing::X => [90.0, 0.0, 0.0],
            Bearing::Y => [180.0, 0.0, 0.0],
            Bearing::Z => [0.0, 90.0, 0.0],
            Bearing::Angles(angles) => angles,
        }
    }

    /// The rotation of the mesh that shows it from this direction, with z upwards as far as possible.
    pub fn turn(self) -> DQuat {
        let [azimuth, elevation, roll] = self.angles().map(f64::to_radians);
        let tilt = elevation - 0.5 * std::f64::consts::PI;
        DQuat::from_rotation_z(roll) * DQuat::from_rotation_x(tilt) * DQuat::from_rotation_z(-azimuth)
    }

    /// The bearing of a rotation, to a thousandth of a degree.
    pub fn of_turn(turn: DQuat) -> Bearing {
        let towards = turn.inverse() * DVec3::Z;
        let elevation = libm::asin(towards.z.clamp(-1.0, 1.0));
        // Straight from above or below, only the sum of azimuth and roll is defined.
        let level = libm::hypot(towards.x, towards.y) > 1e-6;
        let azimuth = if level { libm::atan2(towards.x, -towards.y) } else { 0.0 };
        let upright = Bearing::Angles([azimuth, elevation, 0.0].map(f64::to_degrees)).turn();
        let up = turn * upright.inverse() * DVec3::X;
        let roll = libm::atan2(up.y, up.x);
        Bearing::Angles([azimuth, elevation, roll].map(|angle| (angle.to_degrees() * 1e3).round() / 1e3 + 0.0))
    }
}

impl std::fmt::Display for Bearing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Bearing::Iso => write!(f, "iso"),
            Bearing::X => write!(f, "x"),
            Bearing::Y => write!(f, "y"),
            Bearing::Z => write!(f, "z"),
            Bearing::Angles([azimuth, elevation, 0.0]) => write!(f, "{azimuth},{elevation}"),
            Bearing::Angles([azimuth, elevation, roll]) => write!(f, "{azimuth},{elevation},{roll}"),
        }
    }
}

impl Default for Camera {
    fn default() -> Self {
        Camera {
            centre: DVec3::ZERO,
            scale: 1.0,
            turn: DQuat::IDENTITY,
            lens: DMat2::IDENTITY,
            fitted: 1.0,
            reach: 1.0,
        }
    }
}

impl Camera {
    /// A camera that fits a box of the plane into a view of `size` points with a margin of `margin` points.
    pub fn fit(bounds: [DVec2; 2], size: DVec2, margin: f64) -> Camera {
        let extent = (bounds[1] - bounds[0]).max(DVec2::splat(f64::MIN_POSITIVE));
        let room = (size - 2.0 * margin).max(DVec2::ONE);
        let scale = (room / extent).min_element();
        let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
        let centre = (0.5 * (bounds[0] + bounds[1])).extend(0.0);
        Camera { centre, scale, fitted: scale, reach: size.max_element() / scale, ..Camera::default() }
    }

    /// A camera with a rotation that fits all positions into a view of `size` points with a margin of `margin` points.
    pub fn fit_in_space(places: impl Iterator<Item = DVec3>, turn: DQuat, size: DVec2, margin: f64) -> Camera {
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = places.map(|p| turn * p).fold(empty, |[low, high], p| [low.min(p), high.max(p)]);
        if !(low.is_finite() && high.is_finite()) {
            return Camera { turn, ..Camera::default() };
        }
        let middle = 0.5 * (low + high);
        let bounds = [low.truncate(), high.truncate()];
        let flat = Camera::fit(bounds, size, margin);
        let reach = (high - low).length().max(f64::MIN_POSITIVE);
        Camera { centre: turn.inverse() * middle, turn, reach, ..flat }
    }

    /// This camera, with the fit of `all`, which sees everything.
    #[must_use]
    pub fn come_from(self, all: &Camera) -> Camera {
        Camera { reach: all.reach, fitted: all.fitted, ..self }
    }

    /// A camera on `centre` with the symmetric root `lens` as metric lens and `scale` points per unit of metric length.
    pub fn through_lens(centre: DVec2, lens: DMat2, scale: f64) -> Camera {
        Camera { centre: centre.extend(0.0), scale, lens, fitted: scale, turn: DQuat::IDENTITY, reach: 1.0 }
    }

    /// The map from differences in the mesh to points on the screen: x to the right, y up, z towards the eye.
    fn linear(&self) -> DMat3 {
        DMat3::from_quat(self.turn) * DMat3::from_mat2(self.lens) * self.scale
    }

    /// The position of a point of the mesh in a view of `size` points.
    pub fn project(&self, p: DVec3, size: DVec2) -> DVec2 {
        let q = self.linear() * (p - self.centre);
        DVec2::new(0.5 * size.x + q.x, 0.5 * size.y - q.y)
    }

    /// The same with its nearness to the eye, in points.
    pub fn seen(&self, p: DVec3, size: DVec2) -> DVec3 {
        let q = self.linear() * (p - self.centre);
        DVec3::new(0.5 * size.x + q.x, 0.5 * size.y - q.y, q.z)
    }

    /// The position in space at a screen position and nearness: the inverse of `seen`.
    pub fn place(&self, seen: DVec3, size: DVec2) -> DVec3 {
        let q = DVec3::new(seen.x - 0.5 * size.x, 0.5 * size.y - seen.y, seen.z);
        self.centre + self.linear().inverse() * q
    }

    /// The direction towards the eye.
    pub fn towards(&self) -> DVec3 {
        self.turn.inverse() * DVec3::Z
    }

    /// The point of the plane z = 0 at a screen position; `None` where the plane is seen edge-on.
    pub fn unproject(&self, at: DVec2, size: DVec2) -> Option<DVec2> {
        let linear = self.linear();
        let plane = DMat2::from_cols(linear.x_axis.truncate(), linear.y_axis.truncate());
        // The centre of a rotated camera may lie off the plane.
        let lift = linear * DVec3::new(0.0, 0.0, -self.centre.z);
        let q = DVec2::new(at.x - 0.5 * size.x, 0.5 * size.y - at.y) - lift.truncate();
        let area = plane.determinant();
        (area.abs() > 1e-12 * self.scale * self.scale).then(|| plane.inverse() * q + self.centre.truncate())
    }

    /// Points per unit; with a metric lens the geometric mean over its axes.
    pub fn points_per_unit(&self) -> f64 {
        self.scale * self.lens.determinant().abs().sqrt()
    }

    /// Pans the view by `by` points.
    pub fn pan(&mut self, by: DVec2) {
        let q = DVec3::new(by.x, -by.y, 0.0);
        self.centre -= self.linear().inverse() * q;
    }

    /// Zooms by `factor` about the position `at` in a view of `size` points.
    pub fn zoom(&mut self, factor: f64, at: DVec2, size: DVec2) {
        let scale = (self.scale * factor).clamp(ZOOM[0] * self.fitted, ZOOM[1] * self.fitted);
        let factor = scale / self.scale;
        // `at` stays fixed: the centre moves towards it.
        let away = at - 0.5 * size;
        self.pan(away * (1.0 / factor - 1.0));
        self.scale = scale;
    }

    /// Rotates the mesh: by `by.x` points about the vertical axis of the screen and by `by.y` about its horizontal
    /// axis.
    pub fn orbit(&mut self, by: DVec2) {
        const RADIANS_PER_POINT: f64 = 0.006;
        let turn = DQuat::from_rotation_y(by.x * RADIANS_PER_POINT) * DQuat::from_rotation_x(by.y * RADIANS_PER_POINT);
        self.turn = (turn * self.turn).normalize();
    }

    /// Rotates the mesh about a pivot, which stays fixed on the screen.
    pub fn orbit_about(&mut self, by: DVec2, pivot: DVec3) {
        let away = self.turn * (self.centre - pivot);
        self.orbit(by);
        self.centre = pivot + self.turn.inverse() * away;
    }

    /// Centres a position, at the same scale.
    pub fn centre_on(&mut self, p: DVec3) {
        self.centre = p;
    }

    /// Centres a position in space, at `scale` points per unit.
    pub fn look_at_place(&mut self, p: DVec3, scale: f64) {
        self.centre = p;
        self.scale = scale.clamp(ZOOM[0] * self.fitted, ZOOM[1] * self.fitted);
    }

    /// Rotates the mesh by the smallest angle that turns a direction of it towards the eye.
    pub fn face(&mut self, direction: DVec3) {
        let now = self.turn * direction.normalize_or(DVec3::Z);
        self.turn = (DQuat::from_rotation_arc(now, DVec3::Z) * self.turn).normalize();
    }

    /// Centres `p`, at `scale` points per unit.
    pub fn look_at(&mut self, p: DVec2, scale: f64) {
        self.centre = p.extend(0.0);
        self.scale = scale.clamp(ZOOM[0] * self.fitted, ZOOM[1] * self.fitted);
    }

    /// The view that a run stores, from a view of `size` points.
    pub fn kept(&self, size: DVec2) -> run::Camera {
        run::Camera {
            target: self.centre.to_array(),
            turn: self.turn.to_array(),
            height: size.y.max(1.0) / self.scale.max(f64::MIN_POSITIVE),
        }
    }

    /// Restores a stored view in a view of `size` points.
    pub fn take_up(&mut self, kept: &run::Camera, size: DVec2) {
        self.centre = DVec3::from_array(kept.target);
        self.turn = DQuat::from_array(kept.turn);
        self.turn = if self.turn.length() > 1e-9 { self.turn.normalize() } else { DQuat::IDENTITY };
        self.scale = (size.y.max(1.0) / kept.height).clamp(ZOOM[0] * self.fitted, ZOOM[1] * self.fitted);
    }

    /// The map from positions relative to `anchor` to clip space, for a view of `size` points. Differences of large
    /// numbers are taken here, in f64.
    pub fn clip(&self, anchor: DVec3, size: DVec2) -> Mat4 {
        let to_clip = DVec3::new(2.0 / size.x, 2.0 / size.y, 0.0);
        // Depth with a soft bound: everything stays in front of the far plane.
        let linear = DMat3::from_diagonal(to_clip.with_z(-self.depth_of_point())) * self.linear();
        let offset = linear * (anchor - self.centre) + DVec3::new(0.0, 0.0, 0.5);
        let mut clip = glam::DMat4::from_mat3(linear);
        clip.w_axis = offset.extend(1.0);
        clip.as_mat4()
    }

    /// The depth in clip space of one screen point.
    pub fn depth_of_point(&self) -> f64 {
        0.25 / (self.scale * self.reach)
    }

    /// Whether positions relative to `anchor` are precise enough for a view of `size` points: a step of f32 must stay
    /// well below a point.
    pub fn is_served_by(&self, anchor: DVec3, size: DVec2) -> bool {
        let away = (self.linear() * (anchor - self.centre)).length();
        away <= 50.0 * size.max_element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: DVec2 = DVec2::new(800.0, 600.0);

    fn fitted() -> Camera {
        Camera::fit([DVec2::new(-1.0, 0.0), DVec2::new(3.0, 1.0)], SIZE, 20.0)
    }

    #[test]
    fn a_fitted_box_lies_within_the_margin_and_touches_it() {
        let camera = fitted();
        let low = camera.project(DVec3::new(-1.0, 0.0, 0.0), SIZE);
        let high = camera.project(DVec3::new(3.0, 1.0, 0.0), SIZE);
        assert!((low.x - 20.0).abs() < 1e-9 && (high.x - 780.0).abs() < 1e-9);
        assert!(low.y > high.y && high.y > 20.0);
    }

    #[test]
    fn unprojecting_is_the_inverse_of_projecting_for_every_camera_that_sees_the_plane() {
        let mut camera = fitted();
        camera.orbit(DVec2::new(40.0, 25.0));
        camera.pan(DVec2::new(13.0, -7.0));
        camera.zoom(3.0, DVec2::new(100.0, 50.0), SIZE);
        let p = DVec2::new(0.3, 0.7);
        let at = camera.project(p.extend(0.0), SIZE);
        assert!((camera.unproject(at, SIZE).unwrap() - p).length() < 1e-9);
    }

    #[test]
    fn zooming_leaves_the_point_under_the_pointer_where_it_is() {
        let mut camera = fitted();
        let at = DVec2::new(123.0, 456.0);
        let before = camera.unproject(at, SIZE).unwrap();
        camera.zoom(7.0, at, SIZE);
        assert!((camera.unproject(at, SIZE).unwrap() - before).length() < 1e-12);
    }

    #[test]
    fn standard_views_look_from_their_sides_with_z_up() {
        let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-12, "{a} {b}");
        for (side, towards) in [(Bearing::X, DVec3::X), (Bearing::Y, DVec3::Y), (Bearing::Z, DVec3::Z)] {
            near(side.turn() * towards, DVec3::Z);
        }
        for side in [Bearing::X, Bearing::Y, Bearing::Angles([12.0, 0.0, 0.0])] {
            near(side.turn() * DVec3::Z, DVec3::Y);
        }
        near(Bearing::Z.turn() * DVec3::Y, DVec3::Y);
        assert_eq!(Bearing::parse(" 33, -27 "), Some(Bearing::Angles([33.0, -27.0, 0.0])));
        assert_eq!(Bearing::parse("Z"), Some(Bearing::Z));
        for bad in ["", "w", "33", "nan,0", "0,91", "361,0", "1,2,3,4"] {
            assert_eq!(Bearing::parse(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_side_is_found_from_its_turn_and_reads_back() {
        for angles in
            [[33.0, 27.0, 0.0], [-120.5, -60.0, 14.0], [0.0, 90.0, 45.0], [0.0, -90.0, 0.0], [179.0, 0.0, -90.0]]
        {
            let side = Bearing::of_turn(Bearing::Angles(angles).turn());
            assert_eq!(side, Bearing::Angles(angles));
            assert_eq!(Bearing::parse(&side.to_string()), Some(side));
        }
    }

    #[test]
    fn in_space_all_places_are_seen_and_what_is_grabbed_stays_where_it_is() {
        let place = |(sin, cos): (f64, f64), k: u32| DVec3::new(sin, 9.0 * cos, 0.1 * f64::from(k));
        let places: Vec<DVec3> = (0..60).map(|k| place(libm::sincos(f64::from(k)), k)).collect();
        let mut camera = Camera::fit_in_space(places.iter().copied(), Bearing::Iso.turn(), SIZE, 20.0);
        for p in &places {
            let at = camera.seen(*p, SIZE);
            assert!(at.x > 19.9 && at.x < 780.1 && at.y > 19.9 && at.y < 580.1, "{at}");
            let clip = camera.clip(DVec3::ZERO, SIZE) * p.as_vec3().extend(1.0);
            assert!((0.0..=1.0).contains(&clip.z));
            assert!(camera.place(at, SIZE).distance(*p) < 1e-9);
        }
        camera.zoom(5.0, DVec2::new(200.0, 100.0), SIZE);
        let before = camera.project(places[7], SIZE);
        camera.orbit_about(DVec2::new(80.0, -50.0), places[7]);
        assert!(camera.project(places[7], SIZE).distance(before) < 1e-9);
        assert!(camera.project(places[8], SIZE).distance(before) > 1.0);
        // Nearer to the eye means a smaller depth.
        let clip = |p: DVec3| (camera.clip(DVec3::ZERO, SIZE) * p.as_vec3().extend(1.0)).z;
        assert!(clip(places[3] + 0.5 * camera.towards()) < clip(places[3]));
    }

    #[test]
    fn clip_space_agrees_with_the_projection_also_from_very_near() {
        let mut camera = fitted();
        camera.look_at(DVec2::new(1.234_567_89, 0.456_789), camera.scale * 1e6);
        let anchor = camera.centre;
        let p = camera.centre + DVec3::new(1e-7, -2e-7, 0.0);
        let clip = camera.clip(anchor, SIZE) * (p - anchor).as_vec3().extend(1.0);
        let at = camera.project(p, SIZE);
        let seen = DVec2::new(f64::from(clip.x) + 1.0, 1.0 - f64::from(clip.y)) * 0.5 * SIZE;
        assert!((seen - at).length() < 1e-3, "{seen} {at}");
        assert!((0.0..=1.0).contains(&clip.z));
        assert!(camera.is_served_by(anchor, SIZE) && !camera.is_served_by(DVec3::ZERO, SIZE));
    }
}
