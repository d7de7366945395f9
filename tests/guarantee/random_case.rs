//! Random domains with everything that a case can have: holes, cracks, repeated lines, islands, faces that share
//! curves.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::random::Random;
use super::random_metric;
use super::shape::{Curve, Frame, inside, on_circle, to_segment};

/// What the seed of a case is combined with for its hardship.
const HARDSHIP: u64 = 0x6861_7264_7368_6970;

/// Nothing is put nearer to anything else than this.
const NEAR: f64 = 0.03;

/// A case being drawn up, in local coordinates.
pub struct Draft {
    pub frame: Frame,
    pub curves: Vec<(String, Curve, Option<usize>)>,
    pub faces: Vec<Face>,
    /// Hard points and their sizes.
    pub points: Vec<(DVec2, Option<f64>)>,
    /// Where the case is to be a hard one, the source of what makes it so.
    pub hardship: Option<Random>,
}

#[derive(Default)]
pub struct Face {
    pub outer: Vec<String>,
    pub holes: Vec<Vec<String>>,
    pub cracks: Vec<String>,
    pub repeated: Vec<String>,
}

/// The text of the case of a seed, with size_scale 1.
pub fn text(seed: u64) -> String {
    let mut random = Random::new(seed);
    let r = &mut random;
    let frame = if r.chance(0.3) {
        let scale = r.power(-3.0, 3.0);
        Frame { origin: scale * DVec2::new(r.range(-5.0, 5.0), r.range(-5.0, 5.0)), scale, turn: r.range(0.0, TAU) }
    } else {
        Frame { origin: DVec2::ZERO, scale: 1.0, turn: 0.0 }
    };
    let mut own = Random::new(seed ^ HARDSHIP);
    let hardship = own.chance(0.5).then_some(own);
    let mut draft = Draft { frame, curves: Vec::new(), faces: Vec::new(), points: Vec::new(), hardship };
    match r.whole(0, 9) {
        0 | 1 => draft.star(r),
        2 | 3 => draft.round_polygon(r),
        4 => draft.comb(r),
        5 => draft.zigzag(r),
        6 => draft.blob(r),
        7 => draft.rectangle(r),
        _ => draft.cells(r),
    }
    draft.fix_counts();
    let metric = random_metric::text(r, &draft);
    format!("version = 1\n\n{metric}{}", draft.toml())
}

impl Draft {
    fn toml(&self) -> String {
        let mut text = String::new();
        for (name, curve, segments) in &self.curves {
            text += &curve.toml(name, *segments, &self.frame);
        }
        let names = |list: &[String]| list.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(", ");
        for (i, face) in self.faces.iter().enumerate() {
            text += &format!("[[face]]\nname = \"face {i}\"\nouter = [{}]\n", names(&face.outer));
            if !face.holes.is_empty() {
                let holes: Vec<String> = face.holes.iter().map(|hole| format!("[{}]", names(hole))).collect();
                text += &format!("holes = [{}]\n", holes.join(", "));
            }
            for (key, list) in [("cracks", &face.cracks), ("repeated", &face.repeated)] {
                if !list.is_empty() {
                    text += &format!("{key} = [{}]\n", names(list));
                }
            }
            text += "\n";
        }
        for (k, (p, size)) in self.points.iter().enumerate() {
            let at = self.frame.place(*p);
            text += &format!("[[point]]\nname = \"p{k}\"\nat = [{:?}, {:?}]\n", at.x, at.y);
            text += &size.map_or(String::new(), |size| format!("size = {:?}\n", size * self.frame.scale));
            text += "\n";
        }
        text
    }

    /// Gives sides of some outlines numbers of segments that have nothing to do with the sizes.
    fn fix_counts(&mut self) {
        let Some(h) = &mut self.hardship else { return };
        for face in self.faces.iter().filter(|face| face.outer.len() > 2) {
            let name = &face.outer[h.whole(0, face.outer.len() - 1)];
            let (is_wanted, n) = (h.chance(0.4), h.power(0.0, 1.7) as usize);
            let curve = self.curves.iter_mut().find(|curve| curve.0 == *name);
            if let (true, Some((_, curve, segments @ None))) = (is_wanted, curve)
                && !matches!(curve, Curve::Path(path) if path.len() > 2)
            {
                *segments = Some(n.max(1));
            }
        }
    }

    /// Cuts corners off by tiny sides.
    fn with_tiny_sides(&mut self, corners: Vec<DVec2>) -> Vec<DVec2> {
        let Some(h) = &mut self.hardship else { return corners };
        let n = corners.len();
        let mut cut = Vec::new();
        for (k, &corner) in corners.iter().enumerate() {
            let [before, after] = [corners[(k + n - 1) % n], corners[(k + 1) % n]].map(|p| p - corner);
            let tiny = h.power(-4.5, -1.5) * before.length().min(after.length());
            if h.chance(0.15) {
                cut.extend([before, after].map(|side| corner + side.normalize() * tiny));
            } else {
                cut.push(corner);
            }
        }
        cut
    }

    /// Puts holes all but at the outline, slits, and hard points into a face.
    fn make_hard(&mut self, polygon: &[DVec2], discs: &[(DVec2, f64)], face: &mut Face) {
        let Some(mut h) = self.hardship.take() else { return };
        let mut taken = discs.to_vec();
        let walls = |p: DVec2| {
            let n = polygon.len();
            (0..n).map(|k| to_segment(p, polygon[k], polygon[(k + 1) % n])).fold(f64::INFINITY, f64::min)
        };
        for _ in 0..h.whole(0, 12) {
            let p = DVec2::new(h.range(-1.3, 1.3), h.range(-1.3, 1.3));
            let room = taken.iter().map(|(q, radius)| q.distance(p) - radius).fold(walls(p), f64::min);
            if !inside(polygon, p) || room < NEAR {
                continue;
            }
            // Chords of curves are off by less than a thousandth.
            let radius = if h.chance(0.6) { room - h.power(-3.0, -1.5).min(0.5 * room) } else { 0.5 * room };
            let a = h.range(0.0, TAU);
            if h.chance(0.6) {
                face.holes.push(vec![self.add(Curve::circle(p, radius, a), None)]);
            } else {
                let (along, across) = (on_circle(DVec2::ZERO, 0.9 * radius, a), h.power(-3.0, -1.0) * radius);
                let across = along.perp().normalize() * across;
                let corners = [along + across, along - across, -along - across, -along + across].map(|c| p + c);
                let path = [corners.as_slice(), &corners[..1]].concat();
                face.holes.push(vec![self.add(Curve::Path(path), None)]);
            }
            taken.push((p, radius));
        }
        for _ in 0..h.whole(0, 8) {
            let p = DVec2::new(h.range(-1.3, 1.3), h.range(-1.3, 1.3));
            let size = h.chance(0.3).then(|| h.power(-2.5, -0.5));
            let is_free = taken.iter().all(|(q, radius)| q.distance(p) > *radius);
            if is_free && inside(polygon, p) && walls(p) > 2e-3 {
                self.points.push((p, size));
                taken.push((p, 1e-3));
            }
        }
        self.hardship = Some(h);
    }

    fn add(&mut self, curve: Curve, segments: Option<usize>) -> String {
        let name = format!("c{}", self.curves.len());
        self.curves.push((name.clone(), curve, segments));
        name
    }

    // ---- outlines ----

    fn star(&mut self, r: &mut Random) {
        let n = r.whole(3, 12);
        let least = r.range(0.3, 0.9);
        let corners: Vec<DVec2> = (0..n)
            .map(|k| {
                let angle = (k as f64 + r.range(0.0, 0.4)) / n as f64 * TAU;
                on_circle(DVec2::ZERO, r.range(least, 1.0), angle)
            })
            .collect();
        self.polygon(r, corners, |_, _| 0.0);
    }

    fn round_polygon(&mut self, r: &mut Random) {
        let n = r.whole(3, 8);
        let corners = (0..n)
            .map(|k| on_circle(DVec2::ZERO, r.range(0.8, 1.0), (k as f64 + r.range(0.0, 0.2)) / n as f64 * TAU))
            .collect();
        self.polygon(r, corners, |r, _| r.range(-0.7, 0.9));
    }

    fn comb(&mut self, r: &mut Random) {
        let teeth = r.whole(2, 6);
        let width = 2.0 / teeth as f64;
        let mut corners = vec![DVec2::new(-1.0, -0.6), DVec2::new(1.0, -0.6)];
        for k in (0..teeth).rev() {
            let left = -1.0 + width * k as f64;
            let top = r.range(0.0, 0.8);
            let (a, b) = (r.range(0.02, 0.25), r.range(0.02, 0.25));
            let foot = r.range(-0.5, -0.2);
            corners.push(DVec2::new(left + width * (1.0 - a), foot.max(-0.45)));
            corners.push(DVec2::new(left + width * (0.98 - b), top));
            corners.push(DVec2::new(left + width * (0.02 + a), top + r.range(-0.1, 0.1)));
            corners.push(DVec2::new(left + width * b.min(0.2), foot));
        }
        self.polygon(r, corners, |_, _| 0.0);
    }

    fn zigzag(&mut self, r: &mut Random) {
        let n = r.whole(2, 6);
        let (thick, high) = (r.range(0.1, 0.6), r.range(0.0, 1.0));
        let lower: Vec<DVec2> = (0..n)
            .map(|k| {
                let x = 2.0 * k as f64 / (n - 1) as f64 - 1.0;
                DVec2::new(x, if k % 2 == 0 { r.range(0.0, high) } else { r.range(-high, 0.0) })
            })
            .collect();
        let upper = lower.iter().rev().map(|p| *p + DVec2::new(0.0, thick));
        let corners = lower.iter().copied().chain(upper).collect();
        self.polygon(r, corners, |_, _| 0.0);
    }

    fn rectangle(&mut self, r: &mut Random) {
        let (width, height) = (1.0, r.power(-1.5, 0.0));
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        self.polygon(r, corners.map(|(x, y)| DVec2::new(width * x, height * y)).to_vec(), |_, _| 0.0);
    }

    fn blob(&mut self, r: &mut Random) {
        let n = r.whole(6, 10);
        let mut control: Vec<DVec2> =
            (0..n).map(|k| on_circle(DVec2::ZERO, r.range(0.6, 1.0), k as f64 / n as f64 * TAU)).collect();
        control.push(control[0]);
        let curve = Curve::Spline(control);
        let polygon = curve.sampled(0.02);
        let outer = vec![self.add(curve, None)];
        let mut face = Face { outer, ..Face::default() };
        self.furnish(r, &polygon, &mut face);
        self.faces.push(face);
    }

    /// A face with these corners, anticlockwise; `turn` says by how much each side bulges.
    fn polygon(&mut self, r: &mut Random, corners: Vec<DVec2>, turn: impl Fn(&mut Random, usize) -> f64) {
        let corners = self.with_tiny_sides(corners);
        let n = corners.len();
        let mut face = Face::default();
        let mut polygon = Vec::new();
        let in_pieces = r.chance(0.6);
        let turns: Vec<f64> = (0..n).map(|k| turn(r, k)).collect();
        if in_pieces || turns.iter().any(|t| *t != 0.0) {
            for (k, &by) in turns.iter().enumerate() {
                let (a, b) = (corners[k], corners[(k + 1) % n]);
                let curve = if by.abs() < 0.1 { Curve::line(a, b) } else { Curve::arc_between(a, b, by) };
                polygon.extend(curve.sampled(0.02));
                let segments = r.chance(0.05).then(|| r.whole(1, 8));
                let name = self.add(curve, segments);
                face.outer.push(name);
            }
            // The order of the curves is not to matter.
            let k = r.whole(0, n - 1);
            face.outer.swap(0, k);
            self.attached_line(r, &corners, &mut polygon, &mut face);
        } else {
            let mut path = corners;
            path.push(path[0]);
            let curve = Curve::Path(path);
            polygon = curve.sampled(0.02);
            let name = self.add(curve, None);
            face.outer.push(name);
        }
        self.furnish(r, &polygon, &mut face);
        self.faces.push(face);
    }

    /// A crack or a repeated line from a corner to the inside, with a kink or a branch now and then.
    fn attached_line(&mut self, r: &mut Random, corners: &[DVec2], polygon: &mut Vec<DVec2>, face: &mut Face) {
        if r.chance(0.6) {
            return;
        }
        let n = corners.len();
        let k = r.whole(0, n - 1);
        let (a, previous, next) = (corners[k], corners[(k + n - 1) % n], corners[(k + 1) % n]);
        let ahead = ((previous - a).normalize() + (next - a).normalize()).normalize_or_zero();
        let ahead = if (next - a).perp_dot(previous - a) < 0.0 { -ahead } else { ahead };
        // As far as nothing stands within reach of its sides.
        let free = |t: f64| {
            let p = a + ahead * t;
            inside(polygon, p) && polygon.iter().all(|q| q.distance(a) < 0.5 * t || q.distance(p) > NEAR.max(0.2 * t))
        };
        let mut far = 0.0;
        while far < 1.2 && free(far + NEAR) {
            far += NEAR;
        }
        if far < 3.0 * NEAR {
            return;
        }
        let end = a + ahead * far * r.range(0.4, 0.9);
        let curve = match r.whole(0, 2) {
            0 => Curve::line(a, end),
            1 => Curve::arc_between(a, end, r.range(0.1, 0.2)),
            _ => {
                let middle = a.midpoint(end) + ahead.perp() * a.distance(end) * r.range(-0.08, 0.08);
                Curve::Path(vec![a, middle, end])
            }
        };
        let mut lines = vec![curve];
        if r.chance(0.3) {
            let reach = 0.4 * NEAR.max(0.2 * a.distance(end));
            for turn in [-1.0, 1.2] {
                lines.push(Curve::line(end, on_circle(end, reach, libm::atan2(ahead.y, ahead.x) + turn)));
            }
        }
        let crack = r.chance(0.6);
        for curve in lines {
            polygon.extend(curve.sampled(0.02).iter().rev());
            polygon.extend(curve.sampled(0.02));
            let name = self.add(curve, None);
            if crack { face.cracks.push(name) } else { face.repeated.push(name) }
        }
    }

    /// A jittered grid of cells that share curves; some are left out.
    fn cells(&mut self, r: &mut Random) {
        let (columns, rows) = (r.whole(1, 3), r.whole(1, 3));
        let (columns, rows) = if columns * rows == 1 { (2, 1) } else { (columns, rows) };
        let (w, h) = (2.0 / columns as f64, 2.0 / rows as f64);
        let corners: Vec<Vec<DVec2>> = (0..=rows)
            .map(|j| {
                (0..=columns)
                    .map(|i| {
                        let p = DVec2::new(i as f64 + r.range(-0.15, 0.15), j as f64 + r.range(-0.15, 0.15));
                        p * DVec2::new(w, h) - DVec2::ONE
                    })
                    .collect()
            })
            .collect();
        let keep: Vec<bool> = (0..columns * rows).map(|k| k == 0 || r.chance(0.85)).collect();
        let mut sides: Vec<((usize, usize, bool), String, Curve)> = Vec::new();
        for j in 0..rows {
            for i in 0..columns {
                if !keep[j * columns + i] {
                    continue;
                }
                let mut face = Face::default();
                let mut polygon = Vec::new();
                let around = [
                    ((i, j, false), true),
                    ((i + 1, j, true), true),
                    ((i, j + 1, false), false),
                    ((i, j, true), false),
                ];
                for (key, forward) in around {
                    if !sides.iter().any(|side| side.0 == key) {
                        let (i, j, up) = key;
                        let (a, b) = (corners[j][i], if up { corners[j + 1][i] } else { corners[j][i + 1] });
                        let curve = match r.whole(0, 3) {
                            0 => Curve::arc_between(a, b, r.range(0.1, 0.4) * if r.chance(0.5) { 1.0 } else { -1.0 }),
                            1 => {
                                let off = (b - a).perp() * r.range(-0.1, 0.1);
                                Curve::Spline(vec![a, a.lerp(b, 0.33) + off, a.lerp(b, 0.67) - off, b])
                            }
                            2 => Curve::Path(vec![a, a.midpoint(b) + (b - a).perp() * r.range(-0.05, 0.05), b]),
                            _ => Curve::line(a, b),
                        };
                        let segments = r.chance(0.03).then(|| r.whole(2, 8));
                        let name = self.add(curve.clone(), segments);
                        sides.push((key, name, curve));
                    }
                    if let Some((_, name, curve)) = sides.iter().find(|side| side.0 == key) {
                        face.outer.push(name.clone());
                        let mut points = curve.sampled(0.02);
                        if !forward {
                            points.reverse();
                        }
                        polygon.extend(points);
                    }
                }
                if r.chance(0.4) {
                    self.furnish(r, &polygon, &mut face);
                }
                self.faces.push(face);
            }
        }
    }

    // ---- what is inside ----

    /// Puts things into a face, each in a disc of its own.
    fn furnish(&mut self, r: &mut Random, polygon: &[DVec2], face: &mut Face) {
        let wanted = [0, 0, 1, 1, 2, 3, 5][r.whole(0, 6)];
        let mut discs: Vec<(DVec2, f64)> = Vec::new();
        for _ in 0..30 * wanted {
            let p = DVec2::new(r.range(-1.3, 1.3), r.range(-1.3, 1.3));
            if discs.len() == wanted || !inside(polygon, p) {
                continue;
            }
            let walls = polygon.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
            let room = discs.iter().map(|(q, radius)| q.distance(p) - radius).fold(walls, f64::min) - NEAR;
            if room < NEAR {
                continue;
            }
            let radius = (room * r.range(0.2, 0.9)).clamp(0.5 * NEAR, 0.5);
            discs.push((p, radius));
            self.thing(r, p, radius, face);
        }
        self.make_hard(polygon, &discs, face);
    }

    /// Something within a disc.
    fn thing(&mut self, r: &mut Random, p: DVec2, radius: f64, face: &mut Face) {
        let a = r.range(0.0, TAU);
        let rim = |angle: f64| on_circle(p, radius, a + angle);
        let even = r.chance(0.1).then(|| 2 * r.whole(2, 6));
        let mut lines = Vec::new();
        match r.whole(0, 11) {
            0 | 1 => face.holes.push(vec![self.add(Curve::circle(p, radius, a), even)]),
            2 => {
                let n = r.whole(3, 7);
                let mut path: Vec<DVec2> =
                    (0..n).map(|k| on_circle(p, radius * r.range(0.5, 1.0), k as f64 / n as f64 * TAU)).collect();
                path.push(path[0]);
                face.holes.push(vec![self.add(Curve::Path(path), None)]);
            }
            3 => {
                let (by, back) = (r.range(0.5, 2.5), r.range(0.5, 2.5));
                let one = self.add(Curve::arc_between(rim(0.0), rim(PI), by), None);
                let other = self.add(Curve::arc_between(rim(PI), rim(0.0), back), None);
                face.holes.push(vec![one, other]);
            }
            4 => {
                // An island: another face in the hole.
                let name = self.add(Curve::circle(p, radius, a), None);
                face.holes.push(vec![name.clone()]);
                self.faces.push(Face { outer: vec![name], ..Face::default() });
            }
            5 => lines.push(Curve::line(rim(0.0), rim(PI))),
            6 => lines.push(Curve::Path(vec![rim(0.0), on_circle(p, 0.5 * radius, a + 1.5), rim(PI)])),
            7 => lines.push(Curve::arc_between(rim(0.0), rim(r.range(1.5, PI)), r.range(0.3, 2.0))),
            8 => {
                // A star of lines, all from the middle: T, X and the like.
                let n = r.whole(2, 5);
                for k in 0..n {
                    let angle = (k as f64 + r.range(-0.25, 0.25)) / n as f64 * TAU;
                    lines.push(Curve::line(p, on_circle(p, radius * r.range(0.6, 1.0), a + angle)));
                }
            }
            9 => lines.push(Curve::circle(p, radius, a)),
            10 => {
                // A hole with a line from its rim.
                face.holes.push(vec![self.add(Curve::circle(p, 0.5 * radius, a), even)]);
                lines.push(Curve::line(on_circle(p, 0.5 * radius, a), rim(0.0)));
            }
            _ => {
                // A chain of lines, closed and with a tail.
                let corners = [rim(0.0), rim(2.0), rim(4.0)];
                lines.extend((0..3).map(|k| Curve::line(corners[k], corners[(k + 1) % 3])));
                lines.push(Curve::line(corners[0], on_circle(p, 0.4 * radius, a)));
            }
        }
        let crack = r.chance(0.5);
        let mixed = r.chance(0.15);
        for (k, curve) in lines.into_iter().enumerate() {
            let name = self.add(curve, None);
            if crack != (mixed && k % 2 == 1) { face.cracks.push(name) } else { face.repeated.push(name) }
        }
    }
}
