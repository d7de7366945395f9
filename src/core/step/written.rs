//! The text of a case of a part.

use std::fmt::Write as _;

use glam::DVec3;

use super::part::Part;
use crate::core::geometry::{AxisFrame, SpaceShape, SurfaceShape};

impl Part {
    /// The surfaces, curves and faces as tables of a case, with the tolerance, without version, title and metric.
    pub fn tables(&self) -> String {
        let mut text = String::new();
        for surface in &self.spec.surfaces {
            let _ = writeln!(text, "\n[[surface]]\nname = {}", quoted(&surface.name));
            write_surface(&mut text, &surface.shape);
        }
        for curve in &self.spec.curves {
            let _ = writeln!(text, "\n[[curve]]\nname = {}", quoted(&curve.name));
            write_curve(&mut text, &curve.shape);
        }
        for face in &self.spec.faces {
            let (name, surface) = (quoted(&face.face.name), quoted(&face.surface));
            let _ = writeln!(text, "\n[[face]]\nname = {name}\nsurface = {surface}");
            if face.reversed {
                text.push_str("reversed = true\n");
            }
            if !face.loops.is_empty() {
                let step = |(name, forward): &(String, bool)| {
                    quoted(&if *forward { name.clone() } else { format!("-{name}") })
                };
                let ring = |steps: &Vec<(String, bool)>| list(steps.iter().map(step));
                let _ = writeln!(text, "loops = {}", list(face.loops.iter().map(ring)));
            }
            if !face.face.groups.is_empty() {
                let _ = writeln!(text, "groups = {}", list(face.face.groups.iter().map(|group| quoted(group))));
            }
        }
        text
    }
}

/// A text as TOML.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}

/// Numbers that are read back to the last bit.
fn numbers(all: &[f64]) -> String {
    list(all.iter().map(|number| format!("{number:?}")))
}

fn vector(p: DVec3) -> String {
    numbers(&p.to_array())
}

fn vectors(points: &[DVec3]) -> String {
    list(points.iter().map(|p| vector(*p)))
}

fn write_frame(text: &mut String, frame: &AxisFrame) {
    let [centre, axis, start] = [frame.centre, frame.axis, frame.start].map(vector);
    let _ = writeln!(text, "centre = {centre}\naxis = {axis}\nstart = {start}");
}

fn write_range(text: &mut String, keys: [&str; 2], range: [f64; 2], default: [f64; 2]) {
    if range != default {
        let _ = writeln!(text, "{} = {:?}\n{} = {:?}", keys[0], range[0], keys[1], range[1]);
    }
}

fn write_surface(text: &mut String, shape: &SurfaceShape) {
    const WHOLE: [f64; 2] = [0.0, 360.0];
    const ANGLES: [&str; 2] = ["from_angle", "to_angle"];
    let _ = match shape {
        SurfaceShape::Plane { corner, sides: [u, v] } => {
            writeln!(text, "kind = \"plane\"\ncorner = {}\nu = {}\nv = {}", vector(*corner), vector(*u), vector(*v))
        }
        SurfaceShape::Cone { frame, radii: [foot, top], height, angles } => {
            let _ = if foot == top {
                writeln!(text, "kind = \"cylinder\"\nradius = {foot:?}\nheight = {height:?}")
            } else {
                writeln!(text, "kind = \"cone\"\nradius = {foot:?}\ntop_radius = {top:?}\nheight = {height:?}")
            };
            write_frame(text, frame);
            write_range(text, ANGLES, *angles, WHOLE);
            Ok(())
        }
        SurfaceShape::Sphere { frame, radius, angles, latitudes } => {
            let _ = writeln!(text, "kind = \"sphere\"\nradius = {radius:?}");
            write_frame(text, frame);
            write_range(text, ANGLES, *angles, WHOLE);
            write_range(text, ["from_latitude", "to_latitude"], *latitudes, [-90.0, 90.0]);
            Ok(())
        }
        SurfaceShape::Torus { frame, radius, tube, angles, tube_angles } => {
            let _ = writeln!(text, "kind = \"torus\"\nradius = {radius:?}\ntube = {tube:?}");
            write_frame(text, frame);
            write_range(text, ANGLES, *angles, WHOLE);
            write_range(text, ["from_tube", "to_tube"], *tube_angles, WHOLE);
            Ok(())
        }
        SurfaceShape::Extrusion { curve, along } => {
            writeln!(text, "kind = \"extrusion\"\ncurve = {}\ndirection = {}", quoted(curve), vector(*along))
        }
        SurfaceShape::Revolution { curve, frame, angles } => {
            let _ = writeln!(text, "kind = \"revolution\"\ncurve = {}", quoted(curve));
            write_frame(text, frame);
            write_range(text, ANGLES, *angles, WHOLE);
            Ok(())
        }
        SurfaceShape::Nurbs { degrees: [p, q], knots: [u, v], weights, points, columns } => {
            let rows = |all: &mut dyn Iterator<Item = String>| {
                format!("[\n{}]", all.map(|row| format!("    {row},\n")).collect::<String>())
            };
            let _ = writeln!(
                text,
                "kind = \"nurbs\"\ndegree_u = {p}\ndegree_v = {q}\nknots_u = {}\nknots_v = {}\npoints = {}",
                numbers(u),
                numbers(v),
                rows(&mut points.chunks(*columns).map(vectors))
            );
            if !weights.is_empty() {
                let _ = writeln!(text, "weights = {}", rows(&mut weights.chunks(*columns).map(numbers)));
            }
            Ok(())
        }
    };
}

fn write_curve(text: &mut String, shape: &SpaceShape) {
    let _ = match shape {
        SpaceShape::Segment { from, to } => {
            writeln!(text, "kind = \"segment\"\nfrom = {}\nto = {}", vector(*from), vector(*to))
        }
        SpaceShape::Arc { frame, radius, angles: [from, to] } => {
            let _ = writeln!(text, "kind = \"arc\"\nradius = {radius:?}\nfrom_angle = {from:?}\nto_angle = {to:?}");
            write_frame(text, frame);
            Ok(())
        }
        SpaceShape::Polyline { points, closed, corner_angle } => {
            let points = vectors(points);
            let angle = corner_angle.to_degrees();
            writeln!(text, "kind = \"polyline\"\nclosed = {closed}\ncorner_angle = {angle:?}\npoints = {points}")
        }
        SpaceShape::Nurbs { degree, knots, weights, points } => {
            let (knots, points) = (numbers(knots), vectors(points));
            let _ = writeln!(text, "kind = \"nurbs\"\ndegree = {degree}\nknots = {knots}\npoints = {points}");
            if !weights.is_empty() {
                let _ = writeln!(text, "weights = {}", numbers(weights));
            }
            Ok(())
        }
        SpaceShape::On { surface, .. } => {
            // Edges of files are curves in space.
            debug_assert!(false, "a curve on {surface}");
            Ok(())
        }
    };
}
