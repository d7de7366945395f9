//! glTF 2.0, as text (`.gltf`, buffers within or beside it) or in one file (`.glb`); the crate `gltf` parses and validates the
//! document. Triangles, strips and fans of the default scene (of all scenes where none is named) are read, with the nodes'
//! transforms applied; each node with a mesh becomes a group. Points at one place are welded, since glTF repeats a point where
//! its normal or texture differs. Deliberately absent: writing (glTF has no quadrilaterals), materials, skins, morph
//! targets; points and lines are counted as skipped.

mod bytes;

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DQuat, DVec3, Mat4, Quat, Vec3};
use gltf::mesh::{Mode, Primitive};
use gltf::scene::Transform;
use gltf::{Document, Gltf, Node};

use super::counting::Count;
use super::mesh_file::{Group, MeshFile, Texture};
use super::scan::shown;
use super::weld::{SINGLE, weld};
use crate::core::fault::Fault;
use crate::core::progress::Pace;
use bytes::Buffers;

/// Extensions that say nothing of where a triangle is, and may be required of a reader.
const HARMLESS: [&str; 3] = ["KHR_materials_", "KHR_texture_", "KHR_lights_"];

/// What a scene may take in memory, by the size of its files: a document can ask for one mesh at a million nodes.
const MOST_TIMES: usize = 12;
/// Whatever the size of its files, this much it may take.
const ALWAYS: usize = 64 << 20;

/// Reads a mesh from the bytes of a glTF document; buffers beside it are looked for in `folder` only, and not at all without
/// one.
///
/// # Errors
/// Documents that are not valid glTF 2.0; extensions that are required and not known here (Draco and other compressed meshes), by
/// name; buffers that are missing, lie elsewhere, or end too soon; nodes with two parents; indices that point nowhere.
pub fn read(name: &str, bytes: &[u8], folder: Option<&Path>, pace: &dyn Pace) -> Result<MeshFile, Fault> {
    pace.goes_on(0, bytes.len());
    let (document, blob) = document(name, bytes)?;
    pace.cancel().check()?;
    let buffers = Buffers::load(name, &document, blob, folder)?;
    let most = ALWAYS.max(MOST_TIMES.saturating_mul(bytes.len() + buffers.size()));
    let mut scene = Scene { name, buffers, most, ..Scene::default() };
    let named: Vec<usize> = document.default_scene().iter().map(gltf::Scene::index).collect();
    for part in document.scenes().filter(|scene| named.is_empty() || named.contains(&scene.index())) {
        scene.nodes(&document, part.nodes())?;
    }
    if document.scenes().len() == 0 {
        // A library of meshes: every one where it is.
        let parented: Vec<usize> = document.nodes().flat_map(|node| node.children().map(|c| c.index())).collect();
        scene.nodes(&document, document.nodes().filter(|node| !parented.contains(&node.index())))?;
    }
    let mut mesh = scene.mesh;
    // Their bytes are not needed beside what welding needs.
    drop(scene.buffers);
    let (points, standing) = weld(&mesh.points, SINGLE, pace.cancel());
    pace.cancel().check()?;
    mesh.points = points;
    mesh.counting.points = Count::Nothing;
    mesh.triangles.iter_mut().flatten().for_each(|corner| *corner = standing[*corner as usize]);
    // Strips turn corners with triangles of no area, which are no triangles.
    let tags = std::mem::take(&mut mesh.triangle_tags);
    let keep = |[a, b, c]: [u32; 3]| a != b && b != c && c != a;
    mesh.triangle_tags = mesh.triangles.iter().zip(tags).filter(|(t, _)| keep(**t)).map(|(_, tag)| tag).collect();
    mesh.texture = scene.texture.of_all(&mesh);
    if let Some(texture) = &mut mesh.texture {
        let mut of_triangle = mesh.triangles.iter();
        texture.triangles.retain(|_| of_triangle.next().is_some_and(|&t| keep(t)));
    }
    mesh.triangles.retain(|&t| keep(t));
    mesh.skipped = scene.skipped.into_iter().map(|(kind, count)| (kind.to_owned(), count)).collect();
    Ok(mesh)
}

/// The validated document and the binary part of a `.glb`.
fn document(name: &str, bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), Fault> {
    if bytes.starts_with(b"glTF") {
        // The parser subtracts the header from the length without looking.
        let length = bytes.get(8..12).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
        if length < 12 || length > bytes.len() {
            let what = format!("It says that it has {length} bytes, and it has {}", bytes.len());
            return Err(Fault::new(what).at(name).remedy("It seems to be cut off: write it again"));
        }
    }
    let refuse = |error: gltf::Error| {
        let said: String = error.to_string().chars().filter(|c| !c.is_control()).take(160).collect();
        Fault::new(format!("This is not valid glTF 2.0: {said}")).at(name)
    };
    let gltf = Gltf::from_slice_without_validation(bytes).map_err(refuse)?;
    for extension in gltf.document.extensions_required() {
        if !HARMLESS.iter().any(|known| extension.starts_with(known)) {
            return Err(Fault::new(format!(
                "It requires the extension {}, which is not read",
                shown(extension.as_bytes())
            ))
            .at(name)
            .remedy("Export it without compression and quantization"));
        }
    }
    let mut root = gltf.document.into_json();
    // The validation looks positions up before it has seen that they are there.
    let attributes =
        root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|primitive| primitive.attributes.values());
    if let Some(lost) = attributes.map(|accessor| accessor.value()).find(|&accessor| accessor >= root.accessors.len()) {
        let what = format!("A mesh has the accessor {lost}, and there are {}", root.accessors.len());
        return Err(Fault::new(what).at(name).remedy("It seems to be damaged: write it again"));
    }
    // Looked at above: the validation knows none.
    root.extensions_required.clear();
    Ok((Document::from_json(root).map_err(refuse)?, gltf.blob))
}

#[derive(Default)]
struct Scene<'a> {
    name: &'a str,
    buffers: Buffers,
    most: usize,
    mesh: MeshFile,
    texture: Texture,
    skipped: BTreeMap<&'static str, usize>,
}

impl Scene<'_> {
    /// Takes in nodes and what hangs below them.
    fn nodes<'d>(&mut self, document: &'d Document, roots: impl Iterator<Item = Node<'d>>) -> Result<(), Fault> {
        let mut seen = vec![false; document.nodes().len()];
        let mut waiting: Vec<(Node, DMat4)> = roots.map(|node| (node, DMat4::IDENTITY)).collect();
        waiting.reverse();
        while let Some((node, above)) = waiting.pop() {
            if std::mem::replace(&mut seen[node.index()], true) {
                let what = format!("Node {} hangs below two others, or below itself", node.index());
                return Err(Fault::new(what).at(self.name).remedy("The nodes of glTF are trees: export it again"));
            }
            let placed = above * matrix(node.transform());
            if let Some(mesh) = node.mesh() {
                let tag = self.mesh.groups.len() as u32 + 1;
                let name = node.name().or(mesh.name()).map_or_else(|| format!("node {}", node.index()), str::to_owned);
                self.mesh.groups.push(Group { dimension: 2, tag, name });
                for primitive in mesh.primitives() {
                    self.primitive(&primitive, placed, tag)?;
                }
            }
            let children: Vec<Node> = node.children().collect();
            waiting.extend(children.into_iter().rev().map(|child| (child, placed)));
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive, placed: DMat4, tag: u32) -> Result<(), Fault> {
        let kind = match primitive.mode() {
            Mode::Points => "point",
            Mode::Lines | Mode::LineLoop | Mode::LineStrip => "line",
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan => "",
        };
        if !kind.is_empty() {
            let count =
                primitive.indices().or_else(|| primitive.get(&gltf::Semantic::Positions)).map_or(0, |a| a.count());
            *self.skipped.entry(kind).or_default() += count;
            return Ok(());
        }
        let Some(positions) = primitive.get(&gltf::Semantic::Positions) else { return Ok(()) };
        let local = self.buffers.positions(self.name, &positions)?;
        let first = self.mesh.points.len();
        let count = primitive.indices().map_or(positions.count(), |a| a.count());
        let bytes = positions.count().saturating_add(first).saturating_mul(48);
        let bytes = bytes.saturating_add(count.saturating_add(self.mesh.triangles.len()).saturating_mul(16));
        if bytes > self.most || first + positions.count() > i32::MAX as usize {
            return Err(Fault::new("Its nodes repeat its meshes until they take more memory than such a file should")
                .at(self.name)
                .remedy("Export fewer copies"));
        }
        for p in local {
            let p = placed.transform_point3(p);
            if !p.is_finite() {
                let what = format!("A vertex of \"{}\" lies at {}, {}, {}", self.group(tag), p.x, p.y, p.z);
                return Err(Fault::new(what).at(self.name).remedy("Coordinates must be finite numbers"));
            }
            self.mesh.points.push(p);
        }
        let corners = match primitive.indices() {
            Some(indices) => self.buffers.indices(self.name, &indices)?,
            None => (0..positions.count() as u32).collect(),
        };
        if let Some(corner) = corners.iter().find(|&&corner| corner as usize >= positions.count()) {
            let what =
                format!("A triangle of \"{}\" has the vertex {corner} of {}", self.group(tag), positions.count());
            return Err(Fault::new(what).at(self.name));
        }
        let places = match primitive.get(&gltf::Semantic::TexCoords(0)) {
            Some(accessor) => self.buffers.texture(&accessor),
            None => Vec::new(),
        };
        let first_place = self.texture.places.len() as u32;
        self.texture.places.extend(&places);
        // A mirroring transform turns triangles over.
        let mirrored = placed.determinant() < 0.0;
        let mut add = |[a, b, c]: [u32; 3]| {
            let t = if mirrored { [a, c, b] } else { [a, b, c] };
            self.mesh.triangles.push(t.map(|corner| first as u32 + corner));
            self.mesh.triangle_tags.push(tag);
            let place = |corner: u32| {
                if (corner as usize) < places.len() { first_place + corner } else { Texture::NOWHERE }
            };
            self.texture.place_triangle(self.mesh.triangles.len() - 1, t.map(place));
        };
        match primitive.mode() {
            Mode::TriangleStrip => {
                for (i, w) in corners.windows(3).enumerate() {
                    add(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] });
                }
            }
            Mode::TriangleFan => corners.windows(2).skip(1).for_each(|w| add([corners[0], w[0], w[1]])),
            _ => corners.as_chunks().0.iter().for_each(|&t| add(t)),
        }
        Ok(())
    }

    fn group(&self, tag: u32) -> String {
        shown(self.mesh.groups[tag as usize - 1].name.as_bytes())
    }
}

fn matrix(transform: Transform) -> DMat4 {
    match transform {
        Transform::Matrix { matrix } => Mat4::from_cols_array_2d(&matrix).as_dmat4(),
        Transform::Decomposed { translation, rotation, scale } => {
            let turn: DQuat = Quat::from_array(rotation).as_dquat();
            let turn = if turn.length_squared() > 0.0 { turn.normalize() } else { DQuat::IDENTITY };
            let [scale, shift]: [DVec3; 2] = [scale, translation].map(|v| Vec3::from_array(v).as_dvec3());
            DMat4::from_scale_rotation_translation(scale, turn, shift)
        }
    }
}

#[cfg(test)]
mod tests;
