//! glTF 2.0, as text (`.gltf`, with embedded or external buffers) or binary (`.glb`); the crate `gltf` parses and
//! validates the document. Reads triangles, strips and fans of the default scene (without one, of all scenes), with the
//! nodes' transforms applied; each node with a mesh becomes a group. Coincident points are welded, since glTF repeats a
//! point where its normal or texture differs. Deliberately absent: writing (glTF has no quadrilaterals), materials,
//! skins, morph targets; points and lines are counted as skipped, materials and further attributes told as not read.

mod bytes;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DQuat, DVec3, Mat4, Quat, Vec3};
use gltf::binary::Glb;
use gltf::json::validation::Error as Invalid;
use gltf::mesh::{Mode, Primitive};
use gltf::scene::Transform;
use gltf::{Document, Node, json};
use serde_json::error::Category;

use super::scan::{DAMAGED, TRUNCATED, shown};
use crate::core::fault::Fault;
use crate::core::progress::Pace;
use crate::core::soup::weld::{SINGLE, weld};
use crate::core::soup::{Count, Group, MeshFile, Texture};
use bytes::Buffers;

/// Prefixes of extensions that do not change the geometry, so that a document may require them.
const HARMLESS: [&str; 3] = ["KHR_materials_", "KHR_texture_", "KHR_lights_"];

/// Limit on a scene's memory as a multiple of the size of its files, since a million nodes can share one mesh.
const MOST_TIMES: usize = 12;
/// Memory allowed for any scene, in bytes.
const ALWAYS: usize = 64 << 20;

/// Reads a mesh from the bytes of a glTF document; external buffers are read from `folder` only, and not at all without
/// one.
///
/// # Errors
/// Documents that are not valid glTF 2.0; unsupported required extensions (Draco and other compressed meshes), by name;
/// buffers that are missing, outside the folder, or too short; nodes with two parents; indices out of range.
pub fn read(name: &str, bytes: &[u8], folder: Option<&Path>, pace: &dyn Pace) -> Result<MeshFile, Fault> {
    pace.goes_on(0, bytes.len());
    let (document, blob) = document(name, bytes)?;
    pace.cancel().check()?;
    let buffers = Buffers::load(name, &document, blob, folder)?;
    // Drop the text of embedded buffers: they are decoded now.
    let mut root = document.into_json();
    root.buffers.iter_mut().for_each(|buffer| buffer.uri = None);
    let document = Document::from_json_without_validation(root);
    let most = ALWAYS.max(MOST_TIMES.saturating_mul(bytes.len() + buffers.size()));
    let mut scene = Scene { name, buffers, most, ..Scene::default() };
    let named: Vec<usize> = document.default_scene().iter().map(gltf::Scene::index).collect();
    for part in document.scenes().filter(|scene| named.is_empty() || named.contains(&scene.index())) {
        scene.nodes(&document, part.nodes())?;
    }
    if document.scenes().len() == 0 {
        // A library of meshes: all root nodes.
        let parented: Vec<usize> = document.nodes().flat_map(|node| node.children().map(|c| c.index())).collect();
        scene.nodes(&document, document.nodes().filter(|node| !parented.contains(&node.index())))?;
    }
    let mut mesh = scene.mesh;
    // Free the buffers before welding allocates.
    drop(scene.buffers);
    let representative = weld(&mut mesh.points, SINGLE, pace.cancel());
    pace.cancel().check()?;
    mesh.counting.points = Count::Nothing;
    mesh.triangles.iter_mut().flatten().for_each(|corner| *corner = representative[*corner as usize]);
    // Strips contain degenerate triangles to change direction.
    let keep = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let mut of_triangle = mesh.triangles.iter();
    mesh.triangle_tags.retain(|_| of_triangle.next().is_some_and(keep));
    mesh.texture = scene.texture.filled(&mesh);
    if let Some(texture) = &mut mesh.texture {
        let mut of_triangle = mesh.triangles.iter();
        texture.triangles.retain(|_| of_triangle.next().is_some_and(keep));
    }
    mesh.triangles.retain(keep);
    mesh.skipped = scene.skipped.into_iter().map(|(kind, count)| (kind.to_owned(), count)).collect();
    Ok(mesh)
}

/// The binary chunk of a `.glb`.
type Blob<'b> = Option<Cow<'b, [u8]>>;

/// The validated document and its binary chunk.
fn document<'b>(name: &str, bytes: &'b [u8]) -> Result<(Document, Blob<'b>), Fault> {
    if bytes.starts_with(b"glTF") {
        // The parser subtracts the header from the length unchecked.
        let length = bytes.get(8..12).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
        if length < 12 || length > bytes.len() {
            let what = format!("The header declares {length} bytes, but the file has {}", bytes.len());
            return Err(Fault::new(what).at(name).remedy(TRUNCATED));
        }
    }
    let refuse = |error: gltf::Error| invalid(name, &error);
    let (text, blob) = if bytes.starts_with(b"glTF") {
        let glb = Glb::from_slice(bytes).map_err(refuse)?;
        (glb.json, glb.bin)
    } else {
        (Cow::Borrowed(bytes), None)
    };
    let mut root: json::Root = json::deserialize::from_slice(&text).map_err(|error| refuse(error.into()))?;
    for extension in &root.extensions_required {
        if !HARMLESS.iter().any(|known| extension.starts_with(known)) {
            return Err(Fault::new(format!(
                "It requires the extension {}, which is not supported",
                shown(extension.as_bytes())
            ))
            .at(name)
            .remedy("Export it without compression and quantization"));
        }
    }
    // The validation looks accessors up before it checks that they exist.
    let attributes =
        root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|primitive| primitive.attributes.values());
    if let Some(lost) = attributes.map(|accessor| accessor.value()).find(|&accessor| accessor >= root.accessors.len()) {
        let what = format!("A mesh refers to accessor {lost} of {}", root.accessors.len());
        return Err(Fault::new(what).at(name).remedy(DAMAGED));
    }
    // Checked above; the validation would reject all of them.
    root.extensions_required.clear();
    Ok((Document::from_json(root).map_err(refuse)?, blob))
}

/// What is wrong with a document, in words.
fn invalid(name: &str, error: &gltf::Error) -> Fault {
    match error {
        gltf::Error::Deserialize(error) => {
            let what = match error.classify() {
                Category::Eof => "The JSON of the document ends too early",
                Category::Data => "A value of the JSON is not one that glTF 2.0 has in its place",
                Category::Syntax | Category::Io => "This is not JSON",
            };
            let remedy = if error.is_eof() { TRUNCATED } else { DAMAGED };
            Fault::new(what)
                .at(format!("{name}, line {} of the JSON, column {}", error.line(), error.column()))
                .remedy(remedy)
        }
        gltf::Error::Validation(list) => {
            let what = match list.first() {
                Some((path, kind)) => {
                    let how = match kind {
                        Invalid::IndexOutOfBounds => "refers to something that is not there",
                        Invalid::Missing => "is missing",
                        Invalid::Oversize => "is too large",
                        Invalid::Invalid | Invalid::Unsupported => "has a value that glTF 2.0 does not allow",
                    };
                    format!("This is not valid glTF 2.0: \"{}\" {how}", shown(path.as_str().as_bytes()))
                }
                None => "This is not valid glTF 2.0".to_owned(),
            };
            Fault::new(what).at(name).remedy(DAMAGED)
        }
        gltf::Error::Binary(gltf::binary::Error::Version(version)) => {
            let what = format!("This is glTF of version {version}, and only version 2 is read");
            Fault::new(what).at(name).remedy("Export it as glTF 2.0")
        }
        _ => Fault::new("The chunks of the file are not those of binary glTF 2.0").at(name).remedy(DAMAGED),
    }
}

#[derive(Default)]
struct Scene<'a> {
    name: &'a str,
    buffers: Buffers<'a>,
    most: usize,
    mesh: MeshFile,
    texture: Texture,
    skipped: BTreeMap<&'static str, usize>,
}

impl Scene<'_> {
    /// Adds the meshes of nodes and their descendants.
    fn nodes<'d>(&mut self, document: &'d Document, roots: impl Iterator<Item = Node<'d>>) -> Result<(), Fault> {
        let mut seen = vec![false; document.nodes().len()];
        let mut waiting: Vec<(Node, DMat4)> = roots.map(|node| (node, DMat4::IDENTITY)).collect();
        waiting.reverse();
        while let Some((node, above)) = waiting.pop() {
            if std::mem::replace(&mut seen[node.index()], true) {
                let what = format!("Node {} has two parents, or is its own ancestor", node.index());
                return Err(Fault::new(what)
                    .at(self.name)
                    .remedy("The nodes of glTF must form trees: export it again"));
            }
            let to_world = above * matrix(node.transform());
            if let Some(mesh) = node.mesh() {
                let tag = self.mesh.groups.len() as u32 + 1;
                let name = node.name().or(mesh.name()).map_or_else(|| format!("node {}", node.index()), str::to_owned);
                self.mesh.groups.push(Group { dimension: 2, tag, name });
                for primitive in mesh.primitives() {
                    self.primitive(&primitive, to_world, tag)?;
                }
            }
            let children: Vec<Node> = node.children().collect();
            waiting.extend(children.into_iter().rev().map(|child| (child, to_world)));
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive, to_world: DMat4, tag: u32) -> Result<(), Fault> {
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
        for (semantic, _) in primitive.attributes() {
            // Joints and weights belong to skins.
            use gltf::Semantic::{Joints, Positions, TexCoords, Weights};
            if !matches!(semantic, Positions | TexCoords(0) | Joints(_) | Weights(_)) {
                self.mesh.omit("vertex attribute", &semantic.to_string());
            }
        }
        if let Some(index) = primitive.material().index() {
            let name = primitive.material().name().map_or_else(|| index.to_string(), str::to_owned);
            self.mesh.omit("material", &name);
        }
        let Some(positions) = primitive.get(&gltf::Semantic::Positions) else { return Ok(()) };
        let group = || shown(self.mesh.groups[tag as usize - 1].name.as_bytes());
        let first = self.mesh.points.len();
        self.buffers.positions(self.name, &positions, &mut self.mesh.points)?;
        let count = primitive.indices().map_or(positions.count(), |a| a.count());
        let bytes = positions.count().saturating_add(first).saturating_mul(48);
        let bytes = bytes.saturating_add(count.saturating_add(self.mesh.triangles.len()).saturating_mul(16));
        if bytes > self.most || first + positions.count() > i32::MAX as usize {
            return Err(Fault::new("The nodes repeat the meshes so often that the scene needs too much memory")
                .at(self.name)
                .remedy("Export fewer copies"));
        }
        for point in &mut self.mesh.points[first..] {
            let p = to_world.transform_point3(*point);
            if !p.is_finite() {
                let what = format!("A vertex of \"{}\" is at ({}, {}, {})", group(), p.x, p.y, p.z);
                return Err(Fault::new(what).at(self.name).remedy("Coordinates must be finite numbers"));
            }
            *point = p;
        }
        let corners: Box<dyn Iterator<Item = u32>> = match primitive.indices() {
            Some(indices) => Box::new(self.buffers.indices(self.name, &indices)?),
            None => Box::new(0..positions.count() as u32),
        };
        let first_uv = self.texture.uv.len();
        if let Some(accessor) = primitive.get(&gltf::Semantic::TexCoords(0)) {
            self.buffers.texture(&accessor, &mut self.texture.uv);
        }
        let uv_count = self.texture.uv.len() - first_uv;
        let most = if primitive.mode() == Mode::Triangles { count / 3 } else { count };
        self.mesh.triangles.reserve(most);
        self.mesh.triangle_tags.reserve(most);
        // A mirroring transform inverts triangles.
        let mirrored = to_world.determinant() < 0.0;
        let mut add = |[a, b, c]: [u32; 3]| {
            let t = if mirrored { [a, c, b] } else { [a, b, c] };
            self.mesh.triangles.push(t.map(|corner| first as u32 + corner));
            self.mesh.triangle_tags.push(tag);
            let corner_uv = |corner: u32| {
                if (corner as usize) < uv_count { first_uv as u32 + corner } else { Texture::NONE }
            };
            self.texture.set_triangle(self.mesh.triangles.len() - 1, t.map(corner_uv));
        };
        let [mut first_corner, mut a, mut b] = [0; 3];
        for (i, corner) in corners.enumerate() {
            if corner as usize >= positions.count() {
                let what = format!("A triangle of \"{}\" refers to vertex {corner} of {}", group(), positions.count());
                return Err(Fault::new(what).at(self.name));
            }
            match primitive.mode() {
                _ if i == 0 => first_corner = corner,
                Mode::TriangleStrip if i >= 2 => add(if i % 2 == 0 { [a, b, corner] } else { [b, a, corner] }),
                Mode::TriangleFan if i >= 2 => add([first_corner, b, corner]),
                Mode::Triangles if i % 3 == 2 => add([a, b, corner]),
                _ => {}
            }
            (a, b) = (b, corner);
        }
        Ok(())
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
