//! What a person looks for by number or by coordinates: `quad 467`, `node 12`, `edge 12-40`, `.5 .3`, `step 812`.
//!
//! ```text
//! sought  = ("quad" | "triangle" | "element" | "node") number
//!         | ("edge" | "segment") number "-" number
//!         | ["step"] number | "nq" number
//!         | coordinate coordinate [ coordinate ]
//! ```
//!
//! Words may be cut (`q 467`, `tri 12`); `=` and commas count as blanks.

use glam::{DVec2, DVec3};

use super::explain;
use super::watch::Watched;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::predicates::orient;
use crate::core::mesh::{ElementId, Mesh, NodeId};

/// What is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// A quadrilateral.
    Quad(ElementId),
    /// A triangle.
    Triangle(ElementId),
    /// An element of either kind.
    Element(ElementId),
    /// A node.
    Node(NodeId),
    /// An edge.
    Edge([NodeId; 2]),
    /// A front segment, in either direction.
    Segment([NodeId; 2]),
    /// What is at a place of the plane.
    Place(DVec2),
    /// The node that is nearest to a point in space.
    Point(DVec3),
    /// A step.
    Step(u64),
    /// The step at which so many quadrilaterals stand.
    Quads(u64),
}

/// The words, longest first where one begins with the other.
const WORDS: [&str; 8] = ["quadrilateral", "triangle", "element", "node", "edge", "segment", "step", "nq"];

/// The words of a text: blanks, `=` and commas separate them; thin spaces group digits.
fn words(text: &str) -> Vec<String> {
    let text = text.to_lowercase().replace('\u{2009}', "");
    text.split(|c: char| c.is_whitespace() || matches!(c, '=' | ','))
        .filter(|w| !w.is_empty())
        .map(str::to_owned)
        .collect()
}

impl Sought {
    /// Reads what is looked for.
    ///
    /// # Errors
    /// A text of another form.
    pub fn parse(text: &str) -> Result<Sought, Fault> {
        let example = "Write for example quad 467, node 12, edge 12-40, segment 104-105, .5 .3, step 812 or nq 100";
        let fault = || {
            let what = format!("\"{}\" names nothing that can be found", text.trim());
            Fault::new(what).remedy(example).of_kind(FaultKind::Syntax)
        };
        let words = words(text);
        let is_number = |word: &String| word.parse::<f64>().is_ok_and(f64::is_finite);
        let Some(first) = words.first() else { return Err(fault()) };
        if words.iter().all(is_number) {
            let values: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
            return match values[..] {
                [_] => words[0].parse().map(Sought::Step).map_err(|_| fault()),
                [x, y] => Ok(Sought::Place(DVec2::new(x, y))),
                [x, y, z] => Ok(Sought::Point(DVec3::new(x, y, z))),
                _ => Err(fault()),
            };
        }
        // A word and its number may be written together: q467, node12.
        let split = first.find(|c: char| c.is_ascii_digit()).unwrap_or(first.len());
        let (name, rest) = first.split_at(split);
        let mut numbers: Vec<&str> = rest.split(is_dash).filter(|part| !part.is_empty()).collect();
        numbers.extend(words[1..].iter().flat_map(|word| word.split(is_dash)).filter(|part| !part.is_empty()));
        let numbers: Vec<u64> = numbers.iter().map(|n| n.parse().map_err(|_| fault())).collect::<Result<_, _>>()?;
        let id = |n: u64| u32::try_from(n).map_err(|_| fault());
        let kind = match name {
            // Two numbers with a dash between them are an edge.
            "" => "edge",
            name => WORDS.into_iter().find(|word| word.starts_with(name)).ok_or_else(fault)?,
        };
        Ok(match (kind, &numbers[..]) {
            ("quadrilateral", &[n]) => Sought::Quad(ElementId(id(n)?)),
            ("triangle", &[n]) => Sought::Triangle(ElementId(id(n)?)),
            ("element", &[n]) => Sought::Element(ElementId(id(n)?)),
            ("node", &[n]) => Sought::Node(NodeId(id(n)?)),
            ("edge", &[a, b]) => Sought::Edge([NodeId(id(a)?), NodeId(id(b)?)]),
            ("segment", &[a, b]) => Sought::Segment([NodeId(id(a)?), NodeId(id(b)?)]),
            ("step", &[n]) => Sought::Step(n),
            ("nq", &[n]) => Sought::Quads(n),
            _ => return Err(fault()),
        })
    }

    /// What is looked for in a state; else why it is not there, in a sentence. Steps are not in a state.
    ///
    /// # Errors
    /// It is not there.
    pub fn find(&self, mesh: &Mesh) -> Result<Watched, String> {
        let is_quad = |e: ElementId| mesh.has_element(e).then(|| mesh.is_quad(e));
        match *self {
            Sought::Quad(e) => match is_quad(e) {
                Some(true) => Ok(Watched::Element(e)),
                Some(false) => Err(format!("Element {} is a live triangle at this step.", e.0)),
                None => Err(format!("Quadrilateral {} does not exist at this step.", e.0)),
            },
            Sought::Triangle(e) => match is_quad(e) {
                Some(false) => Ok(Watched::Element(e)),
                Some(true) => Err(format!("Element {} is a quadrilateral at this step.", e.0)),
                None => Err(format!("Triangle {} does not exist at this step.", e.0)),
            },
            Sought::Element(e) if mesh.has_element(e) => Ok(Watched::Element(e)),
            Sought::Element(e) => Err(format!("Element {} does not exist at this step.", e.0)),
            Sought::Node(n) if mesh.has_node(n) => Ok(Watched::Node(n)),
            Sought::Node(n) => Err(format!("Node {} does not exist at this step.", n.0)),
            Sought::Edge([a, b]) | Sought::Segment([a, b]) => {
                if let Some(gone) = [a, b].into_iter().find(|&n| !mesh.has_node(n)) {
                    return Err(format!("Node {} does not exist at this step.", gone.0));
                }
                if !mesh.are_joined(a, b) {
                    return Err(format!("No edge joins nodes {} and {} at this step.", a.0, b.0));
                }
                if !matches!(self, Sought::Segment(_)) {
                    return Ok(Watched::Edge(a, b));
                }
                let on_front = [[a, b], [b, a]].into_iter().find(|&[a, b]| mesh.front_between(a, b).is_some());
                let off = format!("Edge {} is not on the front at this step.", explain::edge([a, b]));
                on_front.map(|[a, b]| Watched::Edge(a, b)).ok_or(off)
            }
            Sought::Place(_) if mesh.embedding().is_some() => {
                Err("The mesh lies on surfaces: a point in space has three coordinates.".to_owned())
            }
            Sought::Place(p) => {
                let holds = |e: &ElementId| {
                    mesh.half_edges(*e).all(|h| orient(mesh.uv(mesh.origin(h)), mesh.uv(mesh.target(h)), p) >= 0.0)
                };
                let element = mesh.elements().find(holds).map(Watched::Element);
                element.or_else(|| nearest(mesh, p.extend(0.0))).ok_or_else(|| "The mesh is empty.".to_owned())
            }
            Sought::Point(p) => nearest(mesh, p).ok_or_else(|| "The mesh is empty.".to_owned()),
            Sought::Step(_) | Sought::Quads(_) => Err("A step is not in a state.".to_owned()),
        }
    }

    /// The thing by its id, whether or not it is there; `None` for places and steps.
    pub fn named(&self) -> Option<Watched> {
        match *self {
            Sought::Quad(e) | Sought::Triangle(e) | Sought::Element(e) => Some(Watched::Element(e)),
            Sought::Node(n) => Some(Watched::Node(n)),
            Sought::Edge([a, b]) | Sought::Segment([a, b]) => Some(Watched::Edge(a, b)),
            Sought::Place(_) | Sought::Point(_) | Sought::Step(_) | Sought::Quads(_) => None,
        }
    }
}

/// The dashes and arrows between two nodes.
fn is_dash(c: char) -> bool {
    matches!(c, '-' | '\u{2013}' | '\u{2192}' | '>')
}

/// The node that is nearest to a point in space.
fn nearest(mesh: &Mesh, p: DVec3) -> Option<Watched> {
    let far = |n: &NodeId| mesh.xyz(*n).distance_squared(p);
    mesh.nodes().min_by(|a, b| far(a).total_cmp(&far(b)).then(a.cmp(b))).map(Watched::Node)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::history::History;
    use crate::core::run::run::Run;

    #[test]
    fn numbers_and_places_are_read_however_they_are_written() {
        let edge = [NodeId(12), NodeId(40)];
        for (text, expected) in [
            ("quad 467", Sought::Quad(ElementId(467))),
            ("Q467", Sought::Quad(ElementId(467))),
            ("quadrilateral 467", Sought::Quad(ElementId(467))),
            ("triangle 12", Sought::Triangle(ElementId(12))),
            ("tri 12", Sought::Triangle(ElementId(12))),
            ("element 9", Sought::Element(ElementId(9))),
            ("node 1\u{2009}267", Sought::Node(NodeId(1267))),
            ("edge 12-40", Sought::Edge(edge)),
            ("edge 12 40", Sought::Edge(edge)),
            ("12\u{2013}40", Sought::Edge(edge)),
            ("segment 12 \u{2192} 40", Sought::Segment(edge)),
            (".5 .3", Sought::Place(DVec2::new(0.5, 0.3))),
            ("-.5, 3e-1", Sought::Place(DVec2::new(-0.5, 0.3))),
            ("1 2 3", Sought::Point(DVec3::new(1.0, 2.0, 3.0))),
            ("step 812", Sought::Step(812)),
            ("step=812", Sought::Step(812)),
            (" 812 ", Sought::Step(812)),
            ("nq 100", Sought::Quads(100)),
            ("NQ=100", Sought::Quads(100)),
        ] {
            assert_eq!(Sought::parse(text).unwrap(), expected, "{text}");
        }
        for text in
            ["", "quad", "quad x", "quad 1 2", "edge 12", "lamp 4", "1 2 3 4", "-5", "1.5", "node 99999999999", "nq"]
        {
            let fault = Sought::parse(text).unwrap_err().to_string();
            assert!(fault.contains("quad 467"), "{text}: {fault}");
        }
    }

    #[test]
    fn what_is_there_is_found_and_what_is_not_is_said() {
        let mut case = built_in::named("example1").unwrap().unwrap();
        case.parameters.size_scale = 2.0;
        let mut history = History::open(Run::of(case), &mut Nobody).unwrap();
        history.seek(200).unwrap();
        let mesh = &history.state().mesh;
        let quad = mesh.elements().find(|e| mesh.is_quad(*e)).unwrap();
        let triangle = mesh.elements().find(|e| mesh.is_triangle(*e)).unwrap();
        assert_eq!(Sought::Quad(quad).find(mesh), Ok(Watched::Element(quad)));
        assert!(Sought::Quad(triangle).find(mesh).unwrap_err().contains("live triangle"));
        assert!(Sought::Triangle(quad).find(mesh).unwrap_err().contains("is a quadrilateral"));
        assert!(Sought::Element(ElementId(999_999)).find(mesh).unwrap_err().contains("does not exist"));
        let [a, b] = mesh.ends(mesh.front().next().unwrap());
        for segment in [Sought::Segment([a, b]), Sought::Segment([b, a])] {
            assert_eq!(segment.find(mesh), Ok(Watched::Edge(a, b)));
        }
        let inner = mesh
            .edges()
            .find(|h| mesh.twin(*h).is_some_and(|t| mesh.is_triangle(t.element())) && mesh.is_triangle(h.element()));
        let inner = mesh.ends(inner.unwrap());
        assert_eq!(Sought::Edge(inner).find(mesh), Ok(Watched::Edge(inner[0], inner[1])));
        assert!(Sought::Segment(inner).find(mesh).unwrap_err().contains("not on the front"));
        for e in mesh.elements().step_by(17) {
            assert_eq!(Sought::Place(mesh.centroid(e)).find(mesh), Ok(Watched::Element(e)));
        }
        let corner = mesh.nodes().min_by(|a, b| mesh.uv(*a).length().total_cmp(&mesh.uv(*b).length())).unwrap();
        assert_eq!(Sought::Place(mesh.uv(corner) - 1.0).find(mesh), Ok(Watched::Node(corner)));
        assert_eq!(Sought::Point(mesh.xyz(corner)).find(mesh), Ok(Watched::Node(corner)));
    }
}
