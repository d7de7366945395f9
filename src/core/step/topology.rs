//! Faces, loops and edges of a file (ISO 10303-42, "topology"), as far as they can be taken.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::DAMAGED;
use super::exchange::Exchange;
use super::fields::Entity;
use super::placement::Placed;
use super::products::Body;
use super::surfaces::{Surface, sphere_frame};
use crate::core::fault::Fault;
use crate::core::geometry::{AxisFrame, SpaceCurve, SpaceShape, SurfaceShape, unseamed};
use crate::core::kernel::decimal::point_text;
use crate::core::progress::Pace;

/// Edges of a loop are at most so many tolerances apart: both ends may be off their vertex.
const APART: f64 = 2.5;

/// An edge: part of a curve between two vertices.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    /// The number of its instance.
    pub id: u64,
    /// Its own name; may be empty.
    pub name: String,
    /// The body in which it stands.
    pub body: usize,
    pub shape: SpaceShape,
    /// Points along it, from end to end.
    pub points: Vec<DVec3>,
    /// How far its vertices are from its curve.
    pub off: f64,
}

impl Edge {
    /// Whether it ends where it begins.
    pub fn is_closed(&self) -> bool {
        self.points.first() == self.points.last()
    }

    /// The length of the polyline of its points.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }
}

/// An edge in a loop, and whether the loop runs along it.
pub(super) type Step = (usize, bool);

/// A face: a part of a surface on the left of its loops.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// The number of its instance.
    pub id: u64,
    /// Its own name; may be empty.
    pub name: String,
    /// The body in which it stands.
    pub body: usize,
    pub surface: Surface,
    /// Whether it looks against the normal of its surface.
    pub reversed: bool,
    /// Its loops; without any it is its whole surface.
    pub loops: Vec<Vec<Step>>,
    /// The instances from which its colour may come: itself, its shell, its solid.
    pub owners: Vec<u64>,
}

/// All faces and edges of a file.
#[derive(Debug, Default)]
pub(super) struct Topology {
    pub faces: Vec<Face>,
    pub edges: Vec<Edge>,
    /// Faces that cannot be taken, with the reason.
    pub bad: Vec<(u64, Fault)>,
}

/// Reads the faces of all bodies.
///
/// # Errors
/// Shells that cannot be read; [`Fault::stopped`]. Faces that cannot be read are collected.
pub(super) fn topology(file: &Exchange<'_>, bodies: &[Body], pace: &dyn Pace) -> Result<Topology, Fault> {
    let mut found = Topology::default();
    for (number, body) in bodies.iter().enumerate() {
        let placed = Placed { file, placement: body.placement, radians: body.units.radians };
        let mut reader = Reader { placed, body: number, found: &mut found, known: FxHashMap::default(), pace };
        for &shell in &body.shells {
            reader.shell(shell, false, &[body.item])?;
        }
    }
    Ok(found)
}

/// Reads the shells of a body.
struct Reader<'r, 'm, 'a> {
    placed: Placed<'m, 'a>,
    body: usize,
    found: &'r mut Topology,
    /// The edges that were read, by their instances: of EDGE_CURVE alone, or the two points of a side of a POLY_LOOP.
    known: FxHashMap<[u64; 2], usize>,
    pace: &'r dyn Pace,
}

impl Reader<'_, '_, '_> {
    /// Reads a shell, or a single face; `turned` turns its faces over.
    fn shell(&mut self, id: u64, turned: bool, owners: &[u64]) -> Result<(), Fault> {
        let entity = self.placed.file.entity(id)?;
        let fields = entity.first();
        let owners = [owners, &[id]].concat();
        match entity.keyword() {
            "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL" if owners.len() < 8 => {
                let (shell, forward) = (fields.instance(2)?, fields.flag(3)?);
                self.shell(shell, turned == forward, &owners)
            }
            "CLOSED_SHELL" | "OPEN_SHELL" | "CONNECTED_FACE_SET" => {
                for face in fields.instances(1)? {
                    self.take(face, turned, &owners)?;
                }
                Ok(())
            }
            "ADVANCED_FACE" | "FACE_SURFACE" => self.take(id, turned, &owners),
            _ => Err(entity.unexpected("a shell")),
        }
    }

    fn take(&mut self, id: u64, turned: bool, owners: &[u64]) -> Result<(), Fault> {
        self.pace.cancel().check()?;
        match self.face(id, turned, owners) {
            Ok(face) => self.found.faces.push(face),
            Err(fault) if fault.is_stop() => return Err(fault),
            Err(fault) => self.found.bad.push((id, fault)),
        }
        Ok(())
    }

    fn face(&mut self, id: u64, turned: bool, owners: &[u64]) -> Result<Face, Fault> {
        let entity = self.placed.file.entity(id)?;
        let fields = entity.first();
        if entity.is("ORIENTED_FACE") && owners.len() < 8 {
            let (face, forward) = (fields.instance(2)?, fields.flag(3)?);
            return self.face(face, turned == forward, &[owners, &[id]].concat());
        }
        if !["ADVANCED_FACE", "FACE_SURFACE", "FACE"].contains(&entity.keyword()) {
            return Err(entity.unexpected("a face"));
        }
        let mut loops: Vec<Vec<Step>> = Vec::new();
        for bound in fields.instances(1)? {
            let bound = self.placed.file.entity(bound)?;
            if !bound.is("FACE_BOUND") && !bound.is("FACE_OUTER_BOUND") {
                return Err(bound.unexpected("a bound of a face"));
            }
            let (own, forward) = (bound.first().instance(1)?, bound.first().flag(2)?);
            let mut steps = self.steps(own)?;
            if forward == turned {
                steps.reverse();
                steps.iter_mut().for_each(|step| step.1 = !step.1);
            }
            // A loop of a single vertex bounds nothing.
            if !steps.is_empty() {
                loops.push(steps);
            }
        }
        let (surface, same) = if entity.is("FACE") {
            (self.plane_of(&entity, &loops)?, true)
        } else {
            (self.placed.surface(fields.instance(2)?)?, fields.flag(3)?)
        };
        let own_name = fields.text(0);
        Ok(Face {
            id,
            name: if own_name == "NONE" { String::new() } else { own_name },
            body: self.body,
            surface,
            reversed: same == turned,
            loops,
            owners: [owners, &[id]].concat(),
        })
    }

    /// The plane of a face that has none of its own: the loops of a faceted solid lie in one.
    fn plane_of(&self, entity: &Entity<'_, '_>, loops: &[Vec<Step>]) -> Result<Surface, Fault> {
        let points = loops.first().map(|steps| self.points(steps)).unwrap_or_default();
        let around = |k: usize| points[k].cross(points[(k + 1) % points.len()]);
        let normal: DVec3 = (0..points.len()).map(around).sum();
        let centre = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let frame = AxisFrame::new(centre, normal, None);
        frame.map(Surface::Plane).map_err(|_| entity.fault(format!("The face #{} has no area", entity.id())))
    }

    /// The points along a loop.
    fn points(&self, steps: &[Step]) -> Vec<DVec3> {
        points_along(&self.found.edges, steps)
    }

    /// The edges of a loop.
    fn steps(&mut self, id: u64) -> Result<Vec<Step>, Fault> {
        let entity = self.placed.file.entity(id)?;
        let fields = entity.first();
        match entity.keyword() {
            "VERTEX_LOOP" => Ok(Vec::new()),
            "EDGE_LOOP" => {
                let mut steps = Vec::new();
                for oriented in fields.instances(1)? {
                    let oriented = self.placed.file.entity(oriented)?;
                    let fields = oriented.fields("ORIENTED_EDGE")?;
                    steps.push((self.edge(fields.instance(3)?)?, fields.flag(4)?));
                }
                Ok(steps)
            }
            "POLY_LOOP" => {
                let ids = fields.instances(1)?;
                let mut steps = Vec::new();
                for (k, &a) in ids.iter().enumerate() {
                    let b = ids[(k + 1) % ids.len()];
                    steps.push((self.side(a.min(b), a.max(b))?, a < b));
                }
                Ok(steps)
            }
            _ => Err(entity.unexpected("a loop")),
        }
    }

    /// A side of a POLY_LOOP.
    fn side(&mut self, a: u64, b: u64) -> Result<usize, Fault> {
        if let Some(&known) = self.known.get(&[a, b]) {
            return Ok(known);
        }
        let ends = [self.placed.point(a)?, self.placed.point(b)?];
        let shape = SpaceShape::Segment { from: ends[0], to: ends[1] };
        let edge = Edge { id: a, name: String::new(), body: self.body, shape, points: ends.to_vec(), off: 0.0 };
        Ok(self.push([a, b], edge))
    }

    fn push(&mut self, key: [u64; 2], edge: Edge) -> usize {
        self.found.edges.push(edge);
        self.known.insert(key, self.found.edges.len() - 1);
        self.found.edges.len() - 1
    }

    /// An EDGE_CURVE.
    fn edge(&mut self, id: u64) -> Result<usize, Fault> {
        if let Some(&known) = self.known.get(&[id, id]) {
            return Ok(known);
        }
        let entity = self.placed.file.entity(id)?;
        if entity.is("ORIENTED_EDGE") {
            return Err(entity.unexpected("an EDGE_CURVE"));
        }
        let fields = entity.fields("EDGE_CURVE")?;
        let vertices = [fields.instance(1)?, fields.instance(2)?];
        let mut ends = [DVec3::ZERO; 2];
        for (end, vertex) in ends.iter_mut().zip(vertices) {
            let vertex = self.placed.file.entity(vertex)?;
            *end = self.placed.point(vertex.fields("VERTEX_POINT")?.instance(1)?)?;
        }
        let curve = self.placed.curve(fields.instance(3)?)?;
        let part = curve.between(ends, vertices[0] == vertices[1], fields.flag(4)?);
        let refused = |what: String| entity.fault(format!("The edge #{id} {what}")).remedy(DAMAGED);
        let part = part.map_err(refused)?;
        let made = SpaceCurve::new(&part.shape, &|_| None);
        let made = made.map_err(|fault| refused(format!("is refused: {}", fault.what)))?;
        let mut points = made.polyline();
        if vertices[0] == vertices[1] {
            let last = points.len() - 1;
            points[last] = points[0];
        }
        let name = fields.text(0);
        let name = if name == "NONE" { String::new() } else { name };
        let edge = Edge { id, name, body: self.body, shape: part.shape, points, off: part.off };
        Ok(self.push([id, id], edge))
    }
}

/// The points along the edges of a loop, in its order, each once.
pub(super) fn points_along(edges: &[Edge], steps: &[Step]) -> Vec<DVec3> {
    let mut points = Vec::new();
    for &(edge, forward) in steps {
        let own = &edges[edge].points;
        let count = own.len() - 1;
        points.extend((0..count).map(|k| own[if forward { k } else { count - k }]));
    }
    points
}

impl Face {
    /// The part of its surface on which it lies.
    ///
    /// # Errors
    /// What is wrong, for a sentence that begins with the face.
    pub fn bounded_surface(&self, edges: &[Edge], tolerance: f64) -> Result<SurfaceShape, String> {
        self.check_closed(edges, tolerance)?;
        if let Surface::Sphere { frame, radius } = &self.surface {
            let loops: Vec<_> = unseamed(&self.loops).iter().map(|steps| points_along(edges, steps)).collect();
            let frame = sphere_frame(frame, &loops, self.reversed);
            return Surface::Sphere { frame, radius: *radius }.around(&[], false);
        }
        let loops: Vec<Vec<DVec3>> = self.loops.iter().map(|steps| points_along(edges, steps)).collect();
        let turns: i32 = loops.iter().map(|points| self.surface.turns(points)).sum();
        self.surface.around(&loops.concat(), turns != 0)
    }

    /// Refuses loops whose edges do not follow one another.
    fn check_closed(&self, edges: &[Edge], tolerance: f64) -> Result<(), String> {
        let end = |&(edge, forward): &Step, at_end: bool| {
            let points = &edges[edge].points;
            points[if forward == at_end { points.len() - 1 } else { 0 }]
        };
        for steps in &self.loops {
            for (k, step) in steps.iter().enumerate() {
                let next = &steps[(k + 1) % steps.len()];
                let (from, to) = (end(step, true), end(next, false));
                if from.distance(to) > APART * tolerance {
                    let [one, other] = [step, next].map(|step| edges[step.0].id);
                    return Err(format!(
                        "has an open loop: the edge #{one} ends at {}, and the next one, #{other}, begins at {}",
                        point_text(from),
                        point_text(to)
                    ));
                }
            }
        }
        Ok(())
    }
}
