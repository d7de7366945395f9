//! Promise: nodes and elements that an event names are found in the files of the state, by their ids and at their
//! places.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use quadfront::core::case::built_in;
use quadfront::core::convert::background;
use quadfront::core::convert::{Converter, Event, Phase};
use quadfront::core::formats::{Format, WriteOptions, format};
use quadfront::core::mesh::{Mesh, NodeId};
use quadfront::core::prepare::Background;
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::{Data, MeshFile};
use serde_json::Value;

/// A mesh as another program reads it, by the ids in it.
struct Joined {
    nodes: BTreeMap<u64, DVec3>,
    /// Corners of each element as points.
    elements: BTreeMap<u64, Vec<u32>>,
    file: MeshFile,
}

/// Writes a mesh and reads it again.
fn joined(file: &MeshFile, format: Format) -> Joined {
    let mut bytes = Vec::new();
    format::write_to(&mut bytes, format, file, WriteOptions::default()).unwrap();
    let file = format::read_bytes("file", &bytes, format).unwrap();
    let mut nodes = BTreeMap::new();
    for Data { name, values } in &file.point_data {
        assert!(name.starts_with("node_id"), "{name}");
        for (&id, &place) in values.iter().zip(&file.points) {
            if id >= 0.0 {
                assert_eq!(nodes.insert(id as u64, place), None, "ids are unique");
            }
        }
    }
    let corners = file.triangles.iter().map(|t| t.to_vec()).chain(file.quads.iter().map(|q| q.to_vec()));
    let ids = file.element_data.iter().find(|data| data.name == "element_id").unwrap();
    let elements: BTreeMap<u64, Vec<u32>> = ids.values.iter().map(|&id| id as u64).zip(corners).collect();
    assert_eq!(elements.len(), ids.values.len(), "ids are unique");
    Joined { nodes, elements, file }
}

/// The nodes that an event names by these keys.
fn named(event: &Event, keys: &[&str]) -> BTreeSet<u64> {
    let Value::Object(fields) = serde_json::to_value(event).unwrap() else { panic!() };
    let of = |value: &Value| match value {
        Value::Number(id) => vec![id.as_u64().unwrap()],
        Value::Array(ids) => ids.iter().map(|id| id.as_u64().unwrap()).collect(),
        other => panic!("{other}"),
    };
    fields.iter().filter(|(key, _)| keys.contains(&key.as_str())).flat_map(|(_, value)| of(value)).collect()
}

/// Nodes that are there after the event.
fn nodes_of(event: &Event) -> BTreeSet<u64> {
    let keys: &[&str] = match event {
        // A number of nodes, and what is no longer there.
        Event::Smoothed { .. } | Event::TopSmoothed { .. } | Event::NodeRemoved { .. } => &[],
        _ => &["a", "b", "node", "nodes", "ends", "new", "across", "at"],
    };
    named(event, keys)
}

/// Nodes that the event removed.
fn gone_of(event: &Event) -> BTreeSet<u64> {
    match event {
        Event::NodeRemoved { .. } => named(event, &["node"]),
        Event::Split { .. } | Event::Seamed { .. } | Event::TransitionSeamed { .. } => named(event, &["gone"]),
        Event::Formed { .. } => named(event, &["swallowed"]),
        _ => BTreeSet::new(),
    }
}

/// Calls `look` after each step of the front with the nodes before it and what it did.
fn steps(name: &str, mut look: impl FnMut(&Converter<'_>, &Background, &BTreeSet<u64>, Event)) {
    let case = built_in::named(name).unwrap().unwrap();
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    let ids = |mesh: &Mesh| mesh.nodes().map(|n| u64::from(n.0)).collect::<BTreeSet<u64>>();
    while !matches!(converter.phase(), Phase::PostProcess { .. } | Phase::Done) {
        let before = ids(&converter.mesh);
        let event = converter.step().unwrap();
        look(&converter, &made, &before, event);
    }
}

#[test]
fn nodes_and_elements_of_events_are_points_and_cells_of_files() {
    let mut seen = BTreeSet::new();
    let mut names = 0;
    let mut with_swallowed = 0;
    steps("example1", |converter, made, before, event| {
        let mesh = &converter.mesh;
        // The first of each kind, formations over nodes, and some others.
        let swallows = !gone_of(&event).is_empty() && matches!(event, Event::Formed { .. });
        with_swallowed += u32::from(swallows);
        if !(seen.insert(event.kind()) || swallows && with_swallowed < 6 || converter.counts.steps % 97 == 0) {
            return;
        }
        let export = Export::of_state(mesh, &made.names).file;
        for format in [Format::Vtu, Format::Msh] {
            let found = joined(&export, format);
            for id in nodes_of(&event) {
                let expected = mesh.xyz(NodeId(id as u32));
                assert_eq!(found.nodes.get(&id), Some(&expected), "step {}: {event:?}", converter.counts.steps);
                names += 1;
            }
            for id in gone_of(&event) {
                assert!(before.contains(&id) && !found.nodes.contains_key(&id), "{event:?}");
            }
            assert_eq!(found.nodes.len(), mesh.node_count());
            if let Event::Formed { element, nodes, .. } = event {
                let corners = &found.elements[&u64::from(element.0)];
                let places: Vec<DVec3> = corners.iter().map(|&point| found.file.points[point as usize]).collect();
                assert!(nodes.iter().all(|&n| places.contains(&mesh.xyz(n))) && places.len() == 4);
            }
            let id_at: BTreeMap<[u64; 3], u64> =
                found.nodes.iter().map(|(&id, place)| (place.to_array().map(f64::to_bits), id)).collect();
            let lines = found.file.front_lines().map(|line| found.file.lines[line]);
            let in_file: BTreeSet<[u64; 2]> = lines
                .map(|ends| ends.map(|end| id_at[&found.file.points[end as usize].to_array().map(f64::to_bits)]))
                .collect();
            let on_front: BTreeSet<[u64; 2]> = mesh.front().map(|h| mesh.ends(h).map(|n| u64::from(n.0))).collect();
            assert_eq!(in_file, on_front);
        }
    });
    assert!(seen.len() >= 15 && names > 150 && with_swallowed > 20, "{} {names} {with_swallowed}", seen.len());
}

#[test]
fn a_formed_event_names_every_node_that_its_step_removed() {
    for name in ["example1", "polar-2", "figure-14"] {
        steps(name, |converter, _, before, event| {
            if let Event::Formed { merged, .. } = event {
                let gone = gone_of(&event);
                assert_eq!(usize::from(merged), 2 + 2 * gone.len());
                let after: BTreeSet<u64> = converter.mesh.nodes().map(|n| u64::from(n.0)).collect();
                assert_eq!(before - &after, gone);
            }
        });
    }
}

#[test]
fn a_point_on_a_curve_between_faces_carries_the_ids_of_all_its_nodes() {
    let case = built_in::named("two-faces").unwrap().unwrap();
    let Background { mesh, names, .. } = background(&case, &mut Nobody).unwrap();
    let export = Export::of(&mesh, &names).file;
    for format in [Format::Vtu, Format::Msh] {
        let found = joined(&export, format);
        assert!(found.nodes.len() == mesh.node_count() && found.file.points.len() < mesh.node_count());
        assert!(mesh.nodes().all(|n| found.nodes[&u64::from(n.0)] == mesh.xyz(n)));
        for e in mesh.elements() {
            let places = found.elements[&u64::from(e.0)].iter().map(|&point| found.file.points[point as usize]);
            assert!(places.eq(mesh.corners(e).map(|n| mesh.xyz(n))));
        }
    }
}
