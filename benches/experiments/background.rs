//! The backgrounds of a case: its own, and others that differ from it by a little, so that what hangs on the case can
//! be told from what hangs on one mesh of it.

#[path = "../../tests/guarantee/random.rs"]
#[allow(dead_code, reason = "the tests need more of it")]
mod random;

use glam::DVec2;
use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::background;
use quadfront::core::kernel::Metric2;
use quadfront::core::mesh::{Mesh, NodeId};
use quadfront::core::metric::{MetricSource, Sizing};
use quadfront::core::prepare::Background;
use quadfront::core::progress::Nobody;

use random::Random;

/// A case at one size.
pub struct Subject {
    pub case: Case,
    /// Name, with the scale where it is not 1.
    pub name: String,
    /// Number of backgrounds.
    pub count: u64,
}

impl Subject {
    pub fn new(name: &str, scale: f64, count: u64) -> Subject {
        let mut case = built_in::named(name).unwrap().unwrap();
        case.parameters.size_scale = scale;
        let name = if scale == 1.0 { name.to_owned() } else { format!("{name} at {scale}") };
        Subject { case, name, count }
    }
}

/// The backgrounds of a subject: its own with every inner node moved by up to `most` of a unit metric length, each by
/// the next seed.
pub fn backgrounds(subject: &Subject, most: f64) -> Vec<Background> {
    let own = background(&subject.case, &mut Nobody).unwrap();
    let jittered = |seed| {
        let mut background = own.clone();
        jitter(&mut background.mesh, &background.sizing, most, &mut Random::new(seed));
        background
    };
    (0..subject.count).map(jittered).collect()
}

/// Moves each free node into a metric disc of radius `most` about it, evenly, where all triangles stay firm.
fn jitter(mesh: &mut Mesh, sizing: &Sizing, most: f64, random: &mut Random) {
    for node in mesh.nodes().filter(|&n| !mesh.is_fixed(n)).collect::<Vec<NodeId>>() {
        let in_disc = loop {
            let p = DVec2::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0));
            if p.length_squared() <= 1.0 {
                break p;
            }
        };
        let uv = mesh.uv(node) + of_metric_length(&mesh.metric(node), most * in_disc);
        if let (Ok(()), Ok(metric)) = (mesh.can_move(node, uv), sizing.metric(uv)) {
            mesh.move_node(node, uv, metric);
        }
    }
    mesh.commit();
}

/// The vector whose metric length is the length of `w`: `L^T v = w` with `M = L L^T`, so that what is evenly spread
/// over a disc is evenly spread over the metric's.
fn of_metric_length(m: &Metric2, w: DVec2) -> DVec2 {
    let l_uu = m.uu.sqrt();
    let l_vu = m.uv / l_uu;
    let l_vv = m.det().sqrt() / l_uu;
    let v = w.y / l_vv;
    DVec2::new((w.x - l_vu * v) / l_uu, v)
}
