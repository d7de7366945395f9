//! Which bodies a file has, and where: representations of shape, the assemblies that place them, the names of their
//! products (ISO 10303-43, -44).

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::DAMAGED;
use super::exchange::Exchange;
use super::fields::Entity;
use super::placement::{Placed, Placement};
use super::units::{Units, units};
use crate::core::fault::Fault;
use crate::core::geometry::AxisFrame;

/// The most bodies of a file, counted as often as they are placed.
const MOST_BODIES: usize = 100_000;
/// The deepest assembly.
const DEEPEST: usize = 64;

/// A body: faces that are placed together.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Its name: that of the solid or its product; may be empty.
    pub name: String,
    /// Its instance: a solid, a model of surfaces, a shell or a face.
    pub item: u64,
    /// Its shells, or single faces.
    pub shells: Vec<u64>,
    /// From the file's coordinates to those that are wanted.
    pub placement: Placement,
    /// The units of its representation.
    pub units: Units,
}

/// What a file has.
#[derive(Debug)]
pub(super) struct Bodies {
    pub bodies: Vec<Body>,
    /// Kinds of items that have no faces, with their numbers.
    pub left_out: BTreeMap<String, usize>,
    /// The units of the file.
    pub own: Units,
    /// Metres of the unit of length in which the bodies are wanted.
    pub wanted: f64,
}

/// A representation with what stands in it.
struct Representation {
    items: Vec<u64>,
    context: Option<u64>,
}

/// Finds the bodies of a file; lengths become multiples of `metres`, if that is given, and of the unit of the first
/// body otherwise.
///
/// # Errors
/// Representations and placements that cannot be read, assemblies that contain themselves, too many bodies.
pub(super) fn bodies(file: &Exchange<'_>, metres: Option<f64>) -> Result<Bodies, Fault> {
    let graph = Graph::read(file)?;
    let own = graph.own_units()?;
    let wanted = metres.unwrap_or(own.metres);
    let mut found = Bodies { own, wanted, bodies: Vec::new(), left_out: BTreeMap::new() };
    let mut walk = Walk { graph: &graph, found: &mut found, seen: BTreeSet::new() };
    for &root in &graph.roots() {
        walk.visit(root, Placement::scaled(1.0), DEEPEST)?;
    }
    if found.bodies.is_empty() {
        // Files without representations of shape: solids and shells stand by themselves.
        for keyword in [&SOLIDS[..], &MODELS[..], &SHELLS[..]] {
            for id in file.of_keywords(keyword) {
                let shells = shells_of(&file.entity(id)?, &mut found.left_out)?;
                let placement = Placement::scaled(own.metres / wanted);
                let name = file.entity(id)?.first().text(0);
                found.bodies.push(Body { name, item: id, shells: shells.unwrap_or_default(), placement, units: own });
            }
            if !found.bodies.is_empty() {
                break;
            }
        }
    }
    Ok(found)
}

/// Kinds of solids, of models of surfaces, and of shells.
const SOLIDS: [&str; 3] = ["MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "FACETED_BREP"];
const MODELS: [&str; 2] = ["SHELL_BASED_SURFACE_MODEL", "FACE_BASED_SURFACE_MODEL"];
const SHELLS: [&str; 5] =
    ["CLOSED_SHELL", "OPEN_SHELL", "ORIENTED_CLOSED_SHELL", "ORIENTED_OPEN_SHELL", "CONNECTED_FACE_SET"];
const FACES: [&str; 2] = ["ADVANCED_FACE", "FACE_SURFACE"];

/// The shells of an item; `None` for one that has no faces, counted unless it is a mere frame.
fn shells_of(item: &Entity<'_, '_>, left_out: &mut BTreeMap<String, usize>) -> Result<Option<Vec<u64>>, Fault> {
    let is_one = |keywords: &[&str]| keywords.iter().any(|keyword| item.is(keyword));
    if is_one(&SOLIDS) {
        let is_complex = item.instance.records.len() > 1;
        let outer = item.record("MANIFOLD_SOLID_BREP").unwrap_or_else(|| item.first());
        let mut shells = vec![outer.instance(usize::from(!is_complex))?];
        if let Some(voids) = item.record("BREP_WITH_VOIDS") {
            shells.extend(voids.instances(voids.len().saturating_sub(1))?);
        }
        return Ok(Some(shells));
    }
    if is_one(&MODELS) {
        return item.first().instances(1).map(Some);
    }
    if is_one(&SHELLS) || is_one(&FACES) {
        return Ok(Some(vec![item.id()]));
    }
    if !is_one(&["AXIS2_PLACEMENT_3D", "AXIS2_PLACEMENT_2D", "AXIS1_PLACEMENT", "CARTESIAN_POINT", "PLANE"]) {
        let kind = item.keyword().to_lowercase().replace('_', " ");
        *left_out.entry(kind).or_default() += 1;
    }
    Ok(None)
}

/// Representations, equal ones as one, and the placements between them.
struct Graph<'m, 'a> {
    file: &'m Exchange<'a>,
    representations: BTreeMap<u64, Representation>,
    /// The first of the equal representations of each.
    same: BTreeMap<u64, u64>,
    /// By assembly: its parts, each with the frames that are mapped onto each other, of the part and of the assembly.
    parts: BTreeMap<u64, Vec<(u64, [u64; 2])>>,
    /// The name of the product of a representation.
    names: BTreeMap<u64, String>,
    /// By the first of equal representations: all of them.
    equals: BTreeMap<u64, Vec<u64>>,
}

impl<'m, 'a> Graph<'m, 'a> {
    fn read(file: &'m Exchange<'a>) -> Result<Graph<'m, 'a>, Fault> {
        let mut graph = Graph {
            file,
            representations: BTreeMap::new(),
            same: BTreeMap::new(),
            parts: BTreeMap::new(),
            names: BTreeMap::new(),
            equals: BTreeMap::new(),
        };
        for id in file.of_keywords(&KINDS) {
            let entity = file.entity(id)?;
            let fields = entity.first();
            let context = fields.instance(2).ok();
            graph.representations.insert(id, Representation { items: fields.instances(1)?, context });
        }
        for id in file.of_keywords(&["SHAPE_REPRESENTATION_RELATIONSHIP"]) {
            let entity = file.entity(id)?;
            let fields = entity.first();
            graph.join(fields.instance(2)?, fields.instance(3)?);
        }
        let parents = graph.parents()?;
        for id in file.of_keywords(&["CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"]) {
            graph.placed_part(id, &parents)?;
        }
        for id in file.of_keywords(&["SHAPE_DEFINITION_REPRESENTATION"]) {
            let entity = file.entity(id)?;
            let fields = entity.first();
            let (definition, representation) = (fields.instance(0)?, fields.instance(1)?);
            if let Some(name) = product_name(file, definition) {
                let of = graph.first(representation);
                graph.names.entry(of).or_insert(name);
            }
        }
        for &id in graph.representations.keys() {
            graph.equals.entry(graph.first(id)).or_default().push(id);
        }
        Ok(graph)
    }

    /// The first of the representations that are equal to one.
    fn first(&self, of: u64) -> u64 {
        let mut at = of;
        while let Some(&next) = self.same.get(&at) {
            at = next;
        }
        at
    }

    fn join(&mut self, a: u64, b: u64) {
        let (a, b) = (self.first(a), self.first(b));
        if a != b {
            self.same.insert(a.max(b), a.min(b));
        }
    }

    /// By definition of a shape of a NEXT_ASSEMBLY_USAGE_OCCURRENCE: the representations of the assembly's own shape.
    fn parents(&self) -> Result<BTreeMap<u64, BTreeSet<u64>>, Fault> {
        let file = self.file;
        // Representations of each product definition.
        let mut shapes: BTreeMap<u64, BTreeSet<u64>> = BTreeMap::new();
        for id in file.of_keywords(&["SHAPE_DEFINITION_REPRESENTATION"]) {
            let entity = file.entity(id)?;
            let (shape, representation) = (entity.first().instance(0)?, entity.first().instance(1)?);
            if let Ok(of) = file.entity(shape).and_then(|shape| shape.first().instance(2)) {
                shapes.entry(of).or_default().insert(self.first(representation));
            }
        }
        let mut parents = BTreeMap::new();
        for id in file.of_keywords(&["PRODUCT_DEFINITION_SHAPE"]) {
            let entity = file.entity(id)?;
            let Ok(occurrence) = entity.first().instance(2).and_then(|of| file.entity(of)) else { continue };
            if occurrence.is("NEXT_ASSEMBLY_USAGE_OCCURRENCE") {
                let assembly = occurrence.first().instance(3)?;
                parents.insert(id, shapes.get(&assembly).cloned().unwrap_or_default());
            }
        }
        Ok(parents)
    }

    /// Reads a CONTEXT_DEPENDENT_SHAPE_REPRESENTATION: a part in an assembly.
    fn placed_part(&mut self, id: u64, parents: &BTreeMap<u64, BTreeSet<u64>>) -> Result<(), Fault> {
        let file = self.file;
        let entity = file.entity(id)?;
        let relation = file.entity(entity.first().instance(0)?)?;
        let fields = relation.fields("REPRESENTATION_RELATIONSHIP")?;
        let [one, other] = [fields.instance(2)?, fields.instance(3)?].map(|id| self.first(id));
        let Some(transformed) = relation.record("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") else {
            self.join(one, other);
            return Ok(());
        };
        let operator = file.entity(transformed.instance(0)?)?;
        let fields = operator.fields("ITEM_DEFINED_TRANSFORMATION")?;
        let frames = [fields.instance(2)?, fields.instance(3)?];
        // The first representation is the part, unless the occurrence says that it is the assembly.
        let of_occurrence = entity.first().instance(1).ok().and_then(|shape| parents.get(&shape));
        let is_turned = of_occurrence.is_some_and(|parents| parents.contains(&one) && !parents.contains(&other));
        let (part, assembly) = if is_turned { (other, one) } else { (one, other) };
        // The first frame stands in the part, unless only the assembly has it.
        let has = |of: u64, item: u64| {
            let own = self.representations.iter().filter(|(id, _)| self.first(**id) == of);
            own.flat_map(|(_, own)| &own.items).any(|known| *known == item)
        };
        let crossed = has(assembly, frames[0]) && has(part, frames[1]) && !(has(part, frames[0]));
        let frames = if crossed != is_turned { [frames[1], frames[0]] } else { frames };
        self.parts.entry(assembly).or_default().push((part, frames));
        Ok(())
    }

    /// The representations that are no part of another one.
    fn roots(&self) -> Vec<u64> {
        let mut is_part: BTreeSet<u64> = self.parts.values().flatten().map(|part| part.0).collect();
        for representation in self.representations.values() {
            for &item in &representation.items {
                is_part.extend(self.mapped(item).map(|(of, _)| self.first(of)));
            }
        }
        let firsts: BTreeSet<u64> = self.representations.keys().map(|id| self.first(*id)).collect();
        firsts.into_iter().filter(|id| !is_part.contains(id)).collect()
    }

    /// The units of a representation, or of one that is equal to it.
    fn units_of(&self, of: u64) -> Units {
        let own = self.equals.get(&of).into_iter().flatten();
        let contexts = own.filter_map(|id| self.representations[id].context);
        contexts.filter_map(|context| units(self.file, context).ok()).next().unwrap_or(Units::DEFAULT)
    }

    /// The units of the first representation that has a body, or else of the first context.
    fn own_units(&self) -> Result<Units, Fault> {
        for (&id, representation) in &self.representations {
            for &item in &representation.items {
                if shells_of(&self.file.entity(item)?, &mut BTreeMap::new())?.is_some() {
                    return Ok(self.units_of(self.first(id)));
                }
            }
        }
        let first = self.representations.keys().next().map(|id| self.units_of(self.first(*id)));
        Ok(first.unwrap_or(Units::DEFAULT))
    }

    /// The representation of a MAPPED_ITEM and its frames: of the representation, and where it is placed.
    fn mapped(&self, item: u64) -> Option<(u64, [u64; 2])> {
        let entity = self.file.entity(item).ok()?;
        let fields = entity.record("MAPPED_ITEM")?;
        let map = self.file.entity(fields.instance(1).ok()?).ok()?;
        let map = map.first();
        Some((map.instance(1).ok()?, [map.instance(0).ok()?, fields.instance(2).ok()?]))
    }
}

/// The keywords of representations that have bodies.
const KINDS: [&str; 10] = [
    "SHAPE_REPRESENTATION",
    "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
    "FACETED_BREP_SHAPE_REPRESENTATION",
    "NON_MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
    "SHELL_BASED_WIREFRAME_SHAPE_REPRESENTATION",
    "GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION",
    "GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION",
    "TESSELLATED_SHAPE_REPRESENTATION",
    "SHAPE_REPRESENTATION_WITH_PARAMETERS",
];

/// The name of the product that a PRODUCT_DEFINITION_SHAPE is about.
fn product_name(file: &Exchange<'_>, shape: u64) -> Option<String> {
    let definition = file.entity(file.entity(shape).ok()?.first().instance(2).ok()?).ok()?;
    let formation = file.entity(definition.first().instance(2).ok()?).ok()?;
    let product = file.entity(formation.first().instance(2).ok()?).ok()?;
    let fields = product.record("PRODUCT")?;
    Some(if fields.text(1).is_empty() { fields.text(0) } else { fields.text(1) })
}

/// A walk from assemblies to their parts.
struct Walk<'g, 'm, 'a> {
    graph: &'g Graph<'m, 'a>,
    found: &'g mut Bodies,
    /// The representations on the way to the current one.
    seen: BTreeSet<u64>,
}

impl<'m, 'a> Walk<'_, 'm, 'a> {
    /// Takes the bodies of a representation and of its parts. `place` maps it, in the unit that is wanted, to where it
    /// is wanted.
    fn visit(&mut self, of: u64, place: Placement, depth: usize) -> Result<(), Fault> {
        let graph = self.graph;
        let file = graph.file;
        let Some(depth) = depth.checked_sub(1).filter(|_| self.seen.insert(of)) else {
            return Err(file.fault_at(of, format!("The assembly #{of} contains itself")).remedy(DAMAGED));
        };
        let units = graph.units_of(of);
        let placed = self.placed(of);
        let own = graph.equals.get(&of).into_iter().flatten();
        for &item in own.flat_map(|id| &graph.representations[id].items) {
            if let Some((part, [from, to])) = graph.mapped(item) {
                let part = graph.first(part);
                let from = Placement::of_frame(&self.placed(part).frame(from)?);
                self.visit(part, place.after(&self.target(&placed, to)?.after(&from.inverse())), depth)?;
                continue;
            }
            let entity = file.entity(item)?;
            let Some(shells) = shells_of(&entity, &mut self.found.left_out)? else { continue };
            let own_name = entity.first().text(0);
            let is_named = !own_name.is_empty() && own_name != "NONE";
            let name = if is_named { own_name } else { graph.names.get(&of).cloned().unwrap_or_default() };
            let placement = place.after(&placed.placement);
            self.found.bodies.push(Body { name, item, shells, placement, units });
            if self.found.bodies.len() > MOST_BODIES {
                let what = format!("The file has more than {MOST_BODIES} bodies");
                return Err(file.fault_at(of, what).remedy("Export a part of the assembly"));
            }
        }
        for &(part, [from, to]) in graph.parts.get(&of).into_iter().flatten() {
            // Each frame is in the unit of the representation in which it stands.
            let from = Placement::of_frame(&self.placed(part).frame(from)?);
            let to = Placement::of_frame(&placed.frame(to)?);
            self.visit(part, place.after(&to.after(&from.inverse())), depth)?;
        }
        self.seen.remove(&of);
        Ok(())
    }

    /// Reads what stands in a representation, in the unit that is wanted.
    fn placed(&self, of: u64) -> Placed<'m, 'a> {
        let units = self.graph.units_of(of);
        let placement = Placement::scaled(units.metres / self.found.wanted);
        Placed { file: self.graph.file, placement, radians: units.radians }
    }

    /// The target of a mapped item: a frame, or a CARTESIAN_TRANSFORMATION_OPERATOR_3D without a mirror image.
    fn target(&self, placed: &Placed<'_, '_>, id: u64) -> Result<Placement, Fault> {
        let entity = self.graph.file.entity(id)?;
        if entity.is("AXIS2_PLACEMENT_3D") {
            return Ok(Placement::of_frame(&placed.frame(id)?));
        }
        let refused = || placed.unsupported(&entity, "placement").remedy("Export the model with its parts in place");
        let fields = entity.record("CARTESIAN_TRANSFORMATION_OPERATOR_3D").ok_or_else(refused)?;
        // A simple instance has the name and the description twice.
        let own = fields.from(fields.len().saturating_sub(5));
        let axis = |i: usize, default: DVec3| {
            if own.has(i) { placed.direction(own.instance(i)?) } else { Ok(default) }
        };
        let (x, y, z) = (axis(0, DVec3::X)?, axis(1, DVec3::Y)?, axis(4, DVec3::Z)?);
        if x.cross(y).dot(z) < 0.99 {
            return Err(refused());
        }
        let scale = if own.has(3) { own.number(3)? } else { 1.0 };
        let frame = AxisFrame::new(placed.point(own.instance(2)?)?, z, Some(x))?;
        Ok(Placement { scale, ..Placement::of_frame(&frame) })
    }
}
