//! Files written instance by instance: what other programs write than Open CASCADE.

use std::fmt::Write as _;

use quadfront::core::case::ImportOptions;
use quadfront::core::soup::Allow;
use quadfront::core::step::{StepOptions, Unit};

use super::{area_and_volume, case_of, mesh_of, sides, skipping};

/// A file in the making.
struct Model {
    text: String,
    last: u64,
}

impl Model {
    /// With a unit of length, as its instance, and a context that is #1.
    fn new(unit: &str) -> Model {
        let text = format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
             FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {{ 1 0 10303 442 1 1 4 }}'));\nENDSEC;\nDATA;\n\
             #1=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#4))\
             GLOBAL_UNIT_ASSIGNED_CONTEXT((#2,#3))REPRESENTATION_CONTEXT('',''));\n#2={unit};\n\
             #3=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
             #4=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#2,'','');\n"
        );
        Model { text, last: 10 }
    }

    fn millimetres() -> Model {
        Model::new("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    }

    fn add(&mut self, instance: &str) -> u64 {
        self.last += 1;
        writeln!(self.text, "#{}={instance};", self.last).unwrap();
        self.last
    }

    fn point(&mut self, p: [f64; 3]) -> u64 {
        self.add(&format!("CARTESIAN_POINT('',({:?},{:?},{:?}))", p[0], p[1], p[2]))
    }

    fn direction(&mut self, p: [f64; 3]) -> u64 {
        self.add(&format!("DIRECTION('',({:?},{:?},{:?}))", p[0], p[1], p[2]))
    }

    fn frame(&mut self, centre: [f64; 3], axis: [f64; 3], start: [f64; 3]) -> u64 {
        let (centre, axis, start) = (self.point(centre), self.direction(axis), self.direction(start));
        self.add(&format!("AXIS2_PLACEMENT_3D('',#{centre},#{axis},#{start})"))
    }

    fn vertex(&mut self, p: [f64; 3]) -> u64 {
        let p = self.point(p);
        self.add(&format!("VERTEX_POINT('',#{p})"))
    }

    /// A straight edge between two vertices at these places.
    fn line(&mut self, vertices: [u64; 2], from: [f64; 3], to: [f64; 3]) -> u64 {
        let (origin, along) = (self.point(from), self.direction([0, 1, 2].map(|k| to[k] - from[k])));
        let vector = self.add(&format!("VECTOR('',#{along},1.)"));
        let line = self.add(&format!("LINE('',#{origin},#{vector})"));
        self.add(&format!("EDGE_CURVE('',#{},#{},#{line},.T.)", vertices[0], vertices[1]))
    }

    /// A circle about z with its vertex at the angle 0.
    fn circle(&mut self, z: f64, radius: f64) -> u64 {
        let vertex = self.vertex([radius, 0.0, z]);
        let frame = self.frame([0.0, 0.0, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        let circle = self.add(&format!("CIRCLE('',#{frame},{radius:?})"));
        self.add(&format!("EDGE_CURVE('',#{vertex},#{vertex},#{circle},.T.)"))
    }

    /// A loop of edges with their directions.
    fn edge_loop(&mut self, edges: &[(u64, bool)]) -> u64 {
        let oriented = edges.iter().map(|(edge, forward)| {
            let flag = if *forward { "T" } else { "F" };
            format!("ORIENTED_EDGE('',*,*,#{edge},.{flag}.)")
        });
        let oriented: Vec<String> =
            oriented.collect::<Vec<_>>().iter().map(|text| format!("#{}", self.add(text))).collect();
        self.add(&format!("EDGE_LOOP('',({}))", oriented.join(",")))
    }

    fn face(&mut self, name: &str, loops: &[u64], surface: u64, same: bool) -> u64 {
        let bounds: Vec<String> =
            loops.iter().map(|own| format!("#{}", self.add(&format!("FACE_BOUND('',#{own},.T.)")))).collect();
        let flag = if same { "T" } else { "F" };
        self.add(&format!("ADVANCED_FACE('{name}',({}),#{surface},.{flag}.)", bounds.join(",")))
    }

    fn plane(&mut self, centre: [f64; 3], axis: [f64; 3], start: [f64; 3]) -> u64 {
        let frame = self.frame(centre, axis, start);
        self.add(&format!("PLANE('',#{frame})"))
    }

    /// A solid of faces in a representation; its number.
    fn solid(&mut self, name: &str, faces: &[u64]) -> u64 {
        let faces: Vec<String> = faces.iter().map(|face| format!("#{face}")).collect();
        let shell = self.add(&format!("CLOSED_SHELL('',({}))", faces.join(",")));
        let solid = self.add(&format!("MANIFOLD_SOLID_BREP('{name}',#{shell})"));
        self.add(&format!("ADVANCED_BREP_SHAPE_REPRESENTATION('',(#{solid}),#1)"))
    }

    /// The faces of a box from the origin, each named by its side.
    fn cuboid(&mut self, size: [f64; 3]) -> Vec<u64> {
        let at = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { size[axis] } else { 0.0 });
        let vertices: Vec<u64> = (0..8).map(|k| self.vertex(at(k))).collect();
        let mut edges = std::collections::BTreeMap::new();
        for a in 0..8 {
            for axis in 0..3 {
                let b = a | 1 << axis;
                if b != a {
                    let edge = self.line([vertices[a], vertices[b]], at(a), at(b));
                    edges.insert((a, b), edge);
                }
            }
        }
        let sides = [
            ("left", [0, 4, 6, 2]),
            ("right", [1, 3, 7, 5]),
            ("front", [0, 1, 5, 4]),
            ("back", [2, 6, 7, 3]),
            ("bottom", [0, 2, 3, 1]),
            ("top", [4, 5, 7, 6]),
        ];
        let normals = [[-1., 0., 0.], [1., 0., 0.], [0., -1., 0.], [0., 1., 0.], [0., 0., -1.], [0., 0., 1.]];
        let mut faces = Vec::new();
        for ((name, corners), normal) in sides.into_iter().zip(normals) {
            let steps: Vec<(u64, bool)> = (0..4)
                .map(|k| {
                    let (a, b): (usize, usize) = (corners[k], corners[(k + 1) % 4]);
                    (edges[&(a.min(b), a.max(b))], a < b)
                })
                .collect();
            let own = self.edge_loop(&steps);
            let start = if normal[2] == 0.0 { [0., 0., 1.] } else { [1., 0., 0.] };
            let plane = self.plane(at(corners[0]), normal, start);
            faces.push(self.face(name, &[own], plane, true));
        }
        faces
    }

    fn bytes(&self) -> Vec<u8> {
        format!("{}ENDSEC;\nEND-ISO-10303-21;\n", self.text).into_bytes()
    }
}

fn near(a: f64, b: f64, within: f64) -> bool {
    (a / b - 1.0).abs() < within
}

#[test]
fn a_cylinder_without_a_seam_is_cut_between_its_circles() {
    let mut model = Model::millimetres();
    let (low, high) = (model.circle(0.0, 2.0), model.circle(5.0, 2.0));
    let [up, down] = [true, false].map(|forward| model.edge_loop(&[(low, forward)]));
    let [top_up, top_down] = [true, false].map(|forward| model.edge_loop(&[(high, forward)]));
    let frame = model.frame([0.0; 3], [0., 0., 1.], [1., 0., 0.]);
    let surface = model.add(&format!("CYLINDRICAL_SURFACE('',#{frame},2.)"));
    let wall = model.face("wall", &[up, top_down], surface, true);
    let bottom_plane = model.plane([0.0; 3], [0., 0., -1.], [1., 0., 0.]);
    let bottom = model.face("bottom", &[down], bottom_plane, true);
    // A plane that looks down, and a face that looks up.
    let top_plane = model.plane([0., 0., 5.], [0., 0., -1.], [1., 0., 0.]);
    let top = model.face("top", &[top_up], top_plane, false);
    model.solid("rod", &[wall, bottom, top]);
    let options = ImportOptions { mesh_size: Some(0.5), curvature: Some(0.003), ..ImportOptions::default() };
    let (case, part) = case_of(&model.bytes(), "rod", &options).unwrap();
    assert_eq!((part.spec.faces.len(), part.unit.as_str(), part.told.len()), (3, "mm", 0));
    let mesh = mesh_of(&case, "rod", Allow::default());
    let [area, volume] = area_and_volume(&mesh);
    let pi = std::f64::consts::PI;
    assert!(near(area, 28.0 * pi, 0.01) && near(volume, 20.0 * pi, 0.01), "{area} {volume}");
    assert_eq!(sides(&mesh)[0], 0);
    // Names of faces are groups.
    let groups: Vec<&str> = mesh.groups.iter().filter(|g| g.dimension == 2).map(|g| g.name.as_str()).collect();
    assert_eq!(groups, ["bottom", "top", "wall"]);
}

#[test]
fn a_cone_without_a_seam_is_cut_to_its_apex() {
    let mut model = Model::millimetres();
    let base = model.circle(0.0, 2.0);
    let [around, below] = [true, false].map(|forward| model.edge_loop(&[(base, forward)]));
    let apex = model.vertex([0., 0., 4.]);
    let apex = model.add(&format!("VERTEX_LOOP('',#{apex})"));
    // The cone opens downwards.
    let frame = model.frame([0.0; 3], [0., 0., -1.], [1., 0., 0.]);
    let surface = model.add(&format!("CONICAL_SURFACE('',#{frame},2.,{:?})", libm::atan(0.5)));
    let wall = model.face("", &[around, apex], surface, true);
    let plane = model.plane([0.0; 3], [0., 0., -1.], [1., 0., 0.]);
    let bottom = model.face("", &[below], plane, true);
    model.solid("", &[wall, bottom]);
    let options = ImportOptions { mesh_size: Some(0.4), ..ImportOptions::default() };
    let (case, _) = case_of(&model.bytes(), "cone", &options).unwrap();
    let mesh = mesh_of(&case, "cone", Allow::default());
    let [area, volume] = area_and_volume(&mesh);
    let pi = std::f64::consts::PI;
    assert!(near(area, 4.0 * pi + pi * 2.0 * 20.0_f64.sqrt(), 0.02) && near(volume, 16.0 * pi / 3.0, 0.03));
}

#[test]
fn whole_surfaces_need_no_edges() {
    let mut model = Model::millimetres();
    let frame = model.frame([0.0; 3], [0., 0., 1.], [1., 0., 0.]);
    let ring = model.add(&format!("TOROIDAL_SURFACE('',#{frame},3.,1.)"));
    let ring = model.face("ring", &[], ring, true);
    let far = model.frame([10., 0., 0.], [0., 0., 1.], [1., 0., 0.]);
    let ball = model.add(&format!("SPHERICAL_SURFACE('',#{far},2.)"));
    // Seen from inside.
    let hollow = model.face("hollow", &[], ball, false);
    model.solid("one", &[ring]);
    model.solid("other", &[hollow]);
    let options = ImportOptions { mesh_size: Some(0.4), ..ImportOptions::default() };
    let (case, part) = case_of(&model.bytes(), "whole", &options).unwrap();
    assert_eq!(part.bodies, 2);
    let mesh = mesh_of(&case, "whole", Allow::default());
    let [area, volume] = area_and_volume(&mesh);
    let pi = std::f64::consts::PI;
    assert!(near(area, 12.0 * pi * pi + 16.0 * pi, 0.02), "{area}");
    assert!(near(volume, 6.0 * pi * pi - 32.0 * pi / 3.0, 0.05), "{volume}");
    for body in ["one", "other"] {
        assert!(mesh.groups.iter().any(|group| group.name == body), "{:?}", mesh.groups);
    }
}

#[test]
fn an_assembly_is_placed_in_the_unit_of_its_parts_and_in_the_one_asked_for() {
    let mut model = Model::new("(CONVERSION_BASED_UNIT('INCH',#5)LENGTH_UNIT()NAMED_UNIT(#6))");
    model.text += "#5=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#7);\n#6=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n\
                   #7=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n";
    let faces = model.cuboid([1.0, 2.0, 3.0]);
    let part = model.solid("block", &faces);
    let own = model.frame([0.0; 3], [0., 0., 1.], [1., 0., 0.]);
    let places = [
        model.frame([10., 0., 0.], [0., 0., 1.], [1., 0., 0.]),
        // On its side: x is y, and z is x.
        model.frame([0., 20., 0.], [1., 0., 0.], [0., 1., 0.]),
    ];
    let whole = model.add(&format!("SHAPE_REPRESENTATION('',(#{},#{}),#1)", places[0], places[1]));
    for place in places {
        let transformation = model.add(&format!("ITEM_DEFINED_TRANSFORMATION('','',#{own},#{place})"));
        let relation = model.add(&format!(
            "(REPRESENTATION_RELATIONSHIP('','',#{part},#{whole})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(\
             #{transformation})SHAPE_REPRESENTATION_RELATIONSHIP())"
        ));
        model.add(&format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},$)"));
    }
    let box_of = |options: &ImportOptions| {
        let (case, part) = case_of(&model.bytes(), "assembly", options).unwrap();
        assert_eq!((part.bodies, part.spec.faces.len()), (2, 12));
        let mesh = mesh_of(&case, "assembly", Allow::default());
        let least = mesh.points.iter().fold(glam::DVec3::INFINITY, |low, p| low.min(*p));
        let most = mesh.points.iter().fold(glam::DVec3::NEG_INFINITY, |high, p| high.max(*p));
        (least, most, area_and_volume(&mesh)[1], part.unit)
    };
    let (least, most, volume, unit) = box_of(&ImportOptions { mesh_size: Some(1.0), ..ImportOptions::default() });
    assert_eq!(unit, "in");
    assert!(least.distance(glam::DVec3::new(0., 0., 0.)) < 1e-9, "{least}");
    assert!(most.distance(glam::DVec3::new(11., 21., 3.)) < 1e-9, "{most}");
    assert!(near(volume, 12.0, 1e-9), "{volume}");
    let step = StepOptions { unit: Some(Unit::Metre), ..StepOptions::default() };
    let (_, most, _, unit) = box_of(&ImportOptions { mesh_size: Some(0.0254), step, ..ImportOptions::default() });
    assert_eq!(unit, "m");
    assert!(most.distance(glam::DVec3::new(11., 21., 3.) * 0.0254) < 1e-9, "{most}");
}

#[test]
fn faces_that_do_not_share_their_edge_are_sewn_and_it_is_told() {
    for gap in [0.0, 3e-6] {
        let mut model = Model::millimetres();
        let mut faces = Vec::new();
        for (x0, x1) in [(0.0, 1.0), (1.0 + gap, 2.0)] {
            let corners = [[x0, 0., 0.], [x1, 0., 0.], [x1, 1., 0.], [x0, 1., 0.]];
            let vertices = corners.map(|p| model.vertex(p));
            let edges: Vec<(u64, bool)> = (0..4)
                .map(|k| {
                    let next = (k + 1) % 4;
                    (model.line([vertices[k], vertices[next]], corners[k], corners[next]), true)
                })
                .collect();
            let own = model.edge_loop(&edges);
            let plane = model.plane([0.0; 3], [0., 0., 1.], [1., 0., 0.]);
            faces.push(model.face("", &[own], plane, true));
        }
        let shells: Vec<String> =
            faces.iter().map(|face| format!("#{}", model.add(&format!("OPEN_SHELL('',(#{face}))")))).collect();
        let sheet = model.add(&format!("SHELL_BASED_SURFACE_MODEL('',({}))", shells.join(",")));
        model.add(&format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{sheet}),#1)"));
        let options = ImportOptions { mesh_size: Some(0.25), ..ImportOptions::default() };
        let (case, part) = case_of(&model.bytes(), "sheets", &options).unwrap();
        assert!(part.told[0].starts_with("1 edge was joined to one that coincides"), "{:?}", part.told);
        assert_eq!(part.told[1], "6 edges bound one face only");
        assert_eq!(part.spec.curves.len(), 7);
        let mesh = mesh_of(&case, "sheets", Allow::default());
        assert_eq!((sides(&mesh)[0], mesh.quads.len()), (24, 32), "{gap}");
    }
}

#[test]
fn what_cannot_be_taken_is_refused_by_its_number_or_left_out() {
    let mut model = Model::millimetres();
    let faces = model.cuboid([1.0, 1.0, 1.0]);
    let plane = model.plane([0.0; 3], [0., 0., 1.], [1., 0., 0.]);
    let offset = model.add(&format!("OFFSET_SURFACE('',#{plane},1.,.F.)"));
    let bad = model.face("bad", &[], offset, true);
    model.solid("", &[faces.clone(), vec![bad]].concat());
    let refused = case_of(&model.bytes(), "offset", &ImportOptions::default()).unwrap_err().to_string();
    for part in
        [format!("#{offset} is a surface of a kind that is not supported: OFFSET_SURFACE"), "--skip-bad-faces".into()]
    {
        assert!(refused.contains(&part), "{refused}");
    }
    let (case, part) = case_of(&model.bytes(), "offset", &skipping()).unwrap();
    assert_eq!(part.spec.faces.len(), 6);
    assert!(part.told[0].starts_with(&format!("left out: #{offset} is a surface")), "{:?}", part.told);
    assert_eq!(sides(&mesh_of(&case, "offset", Allow::default()))[0], 0);
    // A loop that lacks an edge.
    let mut model = Model::millimetres();
    let corners = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.]];
    let vertices = corners.map(|p| model.vertex(p));
    let edges: Vec<(u64, bool)> =
        (0..2).map(|k| (model.line([vertices[k], vertices[k + 1]], corners[k], corners[k + 1]), true)).collect();
    let own = model.edge_loop(&edges);
    let plane = model.plane([0.0; 3], [0., 0., 1.], [1., 0., 0.]);
    let open = model.face("", &[own], plane, true);
    model.solid("", &[open]);
    let fault = case_of(&model.bytes(), "open", &ImportOptions::default()).unwrap_err().to_string();
    assert!(fault.contains(&format!("The face #{open} has an open loop")), "{fault}");
}

#[test]
fn colours_layers_and_names_are_groups() {
    let mut model = Model::millimetres();
    let faces = model.cuboid([1.0, 1.0, 1.0]);
    model.solid("block", &faces);
    let colour = |model: &mut Model, of: &str, item: u64| {
        let colour = model.add(of);
        let fill = model.add(&format!("FILL_AREA_STYLE_COLOUR('',#{colour})"));
        let fill = model.add(&format!("FILL_AREA_STYLE('',(#{fill}))"));
        let area = model.add(&format!("SURFACE_STYLE_FILL_AREA(#{fill})"));
        let side = model.add(&format!("SURFACE_SIDE_STYLE('',(#{area}))"));
        let usage = model.add(&format!("SURFACE_STYLE_USAGE(.BOTH.,#{side})"));
        let style = model.add(&format!("PRESENTATION_STYLE_ASSIGNMENT((#{usage}))"));
        model.add(&format!("STYLED_ITEM('',(#{style}),#{item})"));
    };
    colour(&mut model, "COLOUR_RGB('',1.,0.5,0.)", faces[0]);
    colour(&mut model, "DRAUGHTING_PRE_DEFINED_COLOUR('green')", faces[1]);
    colour(&mut model, "COLOUR_RGB('',1.,0.5,0.)", faces[2]);
    model.add(&format!("PRESENTATION_LAYER_ASSIGNMENT('inlet','',(#{},#{}))", faces[4], faces[5]));
    let (case, _) = case_of(&model.bytes(), "colours", &ImportOptions::default()).unwrap();
    let mesh = mesh_of(&case, "colours", Allow::default());
    let members = |name: &str| {
        let group = mesh.groups.iter().find(|group| group.dimension == 2 && group.name == name).unwrap();
        let own = mesh.members.iter().filter(|m| m.dimension == 2 && m.tag == group.tag);
        own.map(|m| m.of.len()).sum::<usize>() + mesh.quad_tags.iter().filter(|tag| **tag == group.tag).count()
    };
    let side = members("left");
    assert_eq!(
        ["colour #ff8000", "colour green", "layer inlet"].map(members),
        [2 * side, side, 2 * side],
        "{:?}",
        mesh.groups
    );
}

#[test]
fn faceted_solids_have_loops_of_points() {
    let mut model = Model::millimetres();
    let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(|p| model.point(p));
    let mut faces = Vec::new();
    for [a, b, c] in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        let own = model.add(&format!("POLY_LOOP('',(#{},#{},#{}))", corners[a], corners[b], corners[c]));
        let bound = model.add(&format!("FACE_OUTER_BOUND('',#{own},.T.)"));
        faces.push(format!("#{}", model.add(&format!("FACE('',(#{bound}))"))));
    }
    let shell = model.add(&format!("CLOSED_SHELL('',({}))", faces.join(",")));
    let solid = model.add(&format!("FACETED_BREP('',#{shell})"));
    model.add(&format!("FACETED_BREP_SHAPE_REPRESENTATION('',(#{solid}),#1)"));
    let (case, part) = case_of(&model.bytes(), "tetrahedron", &ImportOptions::default()).unwrap();
    assert_eq!((part.spec.faces.len(), part.spec.curves.len()), (4, 6));
    let mesh = mesh_of(&case, "tetrahedron", Allow::default());
    assert!(near(area_and_volume(&mesh)[1], 1.0 / 6.0, 1e-9));
}
