//! Divides bent elements into triangles that follow their bend.
//!
//! Sides and insides are halved where the quadratic element leaves the straight piece by more than [`CHORD`], until none
//! does. Whether a piece of a side is halved is a matter of that piece, not of the elements at it, so that they still
//! fit together; the neighbour without a bend of its own has that of the shared side.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::key;
use crate::core::kernel::Metric3;
use crate::core::soup::counting::Count;
use crate::core::soup::mesh_file::{ELEMENT_ID, MeshFile, NODE_ID, SecondOrder};
use crate::core::soup::{CELL_DATA, POINT_DATA};

/// How far a piece may be from its element, as a share of the mean length of the element's sides. Inside a piece the
/// distance is at most 4/3 of that at its sides.
const CHORD: f64 = 5e-4;
/// A side whose node is off its middle by less than this share of its length is straight.
const STRAIGHT: f64 = 1e-6;
/// Halvings of a side.
const LEVELS: usize = 6;
/// Triangles beyond which nothing is halved any more.
const MOST: usize = 1 << 22;
/// Where on a piece of a side its distance is taken. That of a quadratic triangle is largest in the middle.
const SAMPLES: [f64; 3] = [0.25, 0.5, 0.75];

/// What a division has done.
#[derive(Debug)]
pub(in crate::core) struct Divided {
    /// The number of elements that were divided.
    pub elements: usize,
    /// The number of triangles made of them.
    pub triangles: usize,
    /// The mean length of the sides of the given elements at each point; at a new one, the mean of those of its ends.
    pub lengths: Vec<f64>,
    /// Whether pieces remain that leave their element by more than they may.
    pub is_coarse: bool,
}

/// A bent element as a map from its reference element: the triangle (0, 0), (1, 0), (0, 1), or the unit square.
enum Map {
    /// The corners, and the nodes of the sides from each corner to the next.
    Triangle([DVec3; 6]),
    /// Likewise, and the node in the middle.
    Quad([DVec3; 9]),
}

/// A triangle of an element.
struct Piece {
    /// Its element, among the bent ones.
    of: u32,
    corners: [u32; 3],
    /// The places of its corners in the reference element.
    at: [DVec2; 3],
}

impl MeshFile {
    /// Divides the elements that nodes of second order bend into triangles, and forgets these nodes. Lines, tags, groups
    /// and numbers are those of what was divided; values at new points are the means of those at the ends. `None`, and
    /// nothing changed, if nothing is bent.
    pub(in crate::core) fn divided_along_bends(&mut self) -> Option<Divided> {
        let second = &self.second_order;
        if second.is_empty() || !self.points.iter().all(|p| p.is_finite()) {
            return None;
        }
        let is_bent = |(ends, node): &&([u32; 2], DVec3)| {
            let [a, b] = ends.map(|end| self.points[end as usize]);
            (*node - (a + b) / 2.0).length() > STRAIGHT * a.distance(b)
        };
        let bent: FxHashMap<[u32; 2], DVec3> = second.sides.iter().filter(is_bent).copied().collect();
        let mut bends = Bends { maps: Vec::new(), tolerances: Vec::new(), of: Vec::new() };
        let mut pieces = Vec::new();
        for (element, corners) in (0..).zip(&self.triangles) {
            if let Some(sides) = sides_of(corners, &bent, &self.points) {
                let [a, b, c] = corners.map(|k| self.points[k as usize]);
                let map = Map::Triangle([a, b, c, sides[0], sides[1], sides[2]]);
                let at = [DVec2::ZERO, DVec2::X, DVec2::Y];
                pieces.push(Piece { of: bends.push(map, element), corners: *corners, at });
            }
        }
        for (element, quad) in (self.triangles.len() as u32..).zip(&self.quads) {
            let centre = second.of_quad(*quad);
            let Some(sides) = sides_of(quad, &bent, &self.points).or_else(|| {
                let middle = |k: usize| (self.points[quad[k] as usize] + self.points[quad[(k + 1) % 4] as usize]) / 2.0;
                centre.map(|_| (0..4).map(middle).collect())
            }) else {
                continue;
            };
            let corners = quad.map(|k| self.points[k as usize]);
            let [a, b, c, d] = corners;
            let serendipity = sides.iter().sum::<DVec3>() / 2.0 - (a + b + c + d) / 4.0;
            let centre = centre.unwrap_or(serendipity);
            let map = Map::Quad([a, b, c, d, sides[0], sides[1], sides[2], sides[3], centre]);
            if !map.is_bent() {
                continue;
            }
            let of = bends.push(map, element);
            let at = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
            let first = usize::from(a.distance_squared(c) > b.distance_squared(d));
            for k in [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| (k + first) % 4)) {
                pieces.push(Piece { of, corners: k.map(|k| quad[k]), at: k.map(|k| at[k]) });
            }
        }
        if pieces.is_empty() {
            return None;
        }
        let mut lengths = self.lengths_at_points();
        let halved = bends.halve(pieces, &mut self.points, self.triangles.len() + self.quads.len());
        let Halved { pieces, halves, ends, is_coarse } = halved;
        ends.iter().for_each(|&[a, b]| lengths.push((lengths[a as usize] + lengths[b as usize]) / 2.0));
        let divided = Divided { elements: bends.maps.len(), triangles: pieces.len(), lengths, is_coarse };
        self.second_order = SecondOrder::default();
        self.fill_points(&ends);
        self.take_lines(&halves);
        self.take_pieces(&pieces, &bends.of);
        Some(divided)
    }

    fn lengths_at_points(&self) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.points.len()];
        let elements = self.faces().map(|face| face.0).chain(self.polygons.iter().map(|polygon| &polygon[..]));
        for corners in elements {
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % corners.len()];
                let long = self.points[a as usize].distance(self.points[b as usize]);
                for end in [a, b] {
                    let (sum, count) = &mut sums[end as usize];
                    (*sum, *count) = (*sum + long, *count + 1.0);
                }
            }
        }
        sums.iter().map(|&(sum, count): &(f64, f64)| sum / count.max(1.0)).collect()
    }

    /// Values at new points.
    fn fill_points(&mut self, ends: &[[u32; 2]]) {
        for &[a, b] in ends {
            if let Some(metric) = &mut self.metric {
                metric.push(mean(&metric[a as usize], &metric[b as usize]));
            }
            if let Some(uv) = &mut self.uv {
                uv.push((uv[a as usize] + uv[b as usize]) / 2.0);
            }
        }
        for (kind, data) in
            [(POINT_DATA, std::mem::take(&mut self.point_data)), (CELL_DATA, std::mem::take(&mut self.element_data))]
        {
            for data in data.iter().filter(|data| data.name != ELEMENT_ID && !data.name.starts_with(NODE_ID)) {
                self.omit(kind, &data.name);
            }
        }
        if self.texture.take().is_some() {
            self.omit("texture coordinates", "of elements of order 2");
        }
    }

    /// Lines along sides that are divided, and polygons beside them.
    fn take_lines(&mut self, halves: &FxHashMap<[u32; 2], u32>) {
        let parts_of = |side: [u32; 2]| {
            let (mut open, mut parts) = (vec![side], Vec::new());
            while let Some([a, b]) = open.pop() {
                match halves.get(&key(a, b)) {
                    Some(&middle) => open.extend([[middle, b], [a, middle]]),
                    None => parts.push([a, b]),
                }
            }
            parts
        };
        for polygon in &mut self.polygons {
            let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
            *polygon = ends.flat_map(|(&a, &b)| parts_of([a, b])).map(|part| part[0]).collect();
        }
        let mut origin = Vec::new();
        let mut lines = Vec::with_capacity(self.lines.len());
        for (k, &line) in (0u32..).zip(&self.lines) {
            lines.extend(parts_of(line));
            origin.resize(lines.len(), k);
        }
        self.lines = lines;
        take_tags(&mut self.line_tags, &origin);
        self.take_members(1, &origin);
    }

    /// The pieces instead of their elements.
    fn take_pieces(&mut self, pieces: &[Piece], element_of: &[u32]) {
        let triangles = self.triangles.len() as u32;
        let old = |piece: &&Piece| element_of[piece.of as usize];
        let (mut made, mut origin) = (Vec::new(), Vec::new());
        let mut next = pieces.iter().peekable();
        for (k, &corners) in (0..).zip(&self.triangles) {
            if next.peek().map(old) != Some(k) {
                made.push(corners);
                origin.push(k);
            }
            while let Some(piece) = next.next_if(|piece| old(piece) == k) {
                made.push(piece.corners);
                origin.push(k);
            }
        }
        let mut is_divided = vec![false; self.quads.len()];
        for piece in next {
            made.push(piece.corners);
            origin.push(old(&piece));
            is_divided[(old(&piece) - triangles) as usize] = true;
        }
        let of_triangles = origin.clone();
        let left: Vec<u32> = (0..).zip(&is_divided).filter(|(_, divided)| !**divided).map(|(k, _)| k).collect();
        let quads = triangles + self.quads.len() as u32;
        origin.extend(left.iter().map(|k| triangles + k));
        origin.extend(quads..quads + self.polygons.len() as u32);
        let number = |k: &u32| match k.checked_sub(triangles) {
            None => self.counting.triangles.number(*k as usize),
            Some(quad) => self.counting.quads.number(quad as usize),
        };
        let of_quads: Vec<u32> = left.iter().map(|k| triangles + k).collect();
        let count = |of: &[u32]| {
            of.iter().map(number).collect::<Option<Vec<u64>>>().map_or(Count::Nothing, |all| Count::of(&all))
        };
        (self.counting.triangles, self.counting.quads) = (count(&of_triangles), count(&of_quads));
        self.counting.shared = true;
        if !self.triangle_tags.is_empty() || !self.quad_tags.is_empty() {
            self.triangle_tags.resize(triangles as usize, 0);
            self.quad_tags.resize(self.quads.len(), 0);
            let mut tags = std::mem::take(&mut self.triangle_tags);
            tags.extend(&self.quad_tags);
            self.triangle_tags = of_triangles.iter().map(|&k| tags[k as usize]).collect();
            take_tags(&mut self.quad_tags, &left);
        }
        self.quads = left.iter().map(|&k| self.quads[k as usize]).collect();
        self.triangles = made;
        self.take_members(2, &origin);
    }

    fn take_members(&mut self, dimension: u8, origin: &[u32]) {
        for members in self.members.iter_mut().filter(|members| members.dimension == dimension) {
            let is_in = |k: &u32| members.of.binary_search(&origin[*k as usize]).is_ok();
            members.of = (0..origin.len() as u32).filter(is_in).collect();
        }
    }
}

/// The mean of two tensors.
fn mean(a: &Metric3, b: &Metric3) -> Metric3 {
    let half = |a: f64, b: f64| (a + b) / 2.0;
    Metric3 {
        xx: half(a.xx, b.xx),
        xy: half(a.xy, b.xy),
        xz: half(a.xz, b.xz),
        yy: half(a.yy, b.yy),
        yz: half(a.yz, b.yz),
        zz: half(a.zz, b.zz),
    }
}

fn take_tags(tags: &mut Vec<u32>, origin: &[u32]) {
    if !tags.is_empty() {
        *tags = origin.iter().map(|&k| tags[k as usize]).collect();
    }
}

/// The nodes of the sides of an element, if any is bent.
fn sides_of(corners: &[u32], bent: &FxHashMap<[u32; 2], DVec3>, points: &[DVec3]) -> Option<Vec<DVec3>> {
    let sides: Vec<[u32; 2]> = (0..corners.len()).map(|k| key(corners[k], corners[(k + 1) % corners.len()])).collect();
    let straight = |[a, b]: &[u32; 2]| (points[*a as usize] + points[*b as usize]) / 2.0;
    let node = |side: &[u32; 2]| bent.get(side).copied().unwrap_or_else(|| straight(side));
    sides.iter().any(|side| bent.contains_key(side)).then(|| sides.iter().map(node).collect())
}

impl Map {
    /// The place in space of one in the reference element.
    fn at(&self, p: DVec2) -> DVec3 {
        match self {
            Map::Triangle(nodes) => {
                let l = [1.0 - p.x - p.y, p.x, p.y];
                let corner = |k: usize| nodes[k] * (l[k] * (2.0 * l[k] - 1.0));
                let side = |k: usize| nodes[3 + k] * (4.0 * l[k] * l[(k + 1) % 3]);
                (0..3).map(|k| corner(k) + side(k)).sum()
            }
            Map::Quad([a, b, c, d, ab, bc, cd, da, m]) => {
                let along = |t: f64| [(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)];
                let ([u0, u1, u2], [v0, v1, v2]) = (along(p.x), along(p.y));
                v0 * (u0 * *a + u1 * *ab + u2 * *b)
                    + v1 * (u0 * *da + u1 * *m + u2 * *bc)
                    + v2 * (u0 * *d + u1 * *cd + u2 * *c)
            }
        }
    }

    fn corners(&self) -> &[DVec3] {
        match self {
            Map::Triangle(nodes) => &nodes[..3],
            Map::Quad(nodes) => &nodes[..4],
        }
    }

    /// The mean length of its straight sides.
    fn size(&self) -> f64 {
        let corners = self.corners();
        let n = corners.len();
        (0..n).map(|k| corners[k].distance(corners[(k + 1) % n])).sum::<f64>() / n as f64
    }

    /// Whether any node is off its place in the element with straight sides.
    fn is_bent(&self) -> bool {
        let corners = self.corners();
        let n = corners.len();
        let middle = |k: usize| (corners[k] + corners[(k + 1) % n]) / 2.0;
        let off = |node: DVec3, place: DVec3| node.distance(place) > STRAIGHT * self.size();
        match self {
            Map::Triangle(nodes) => (0..3).any(|k| off(nodes[3 + k], middle(k))),
            Map::Quad(nodes) => {
                (0..4).any(|k| off(nodes[4 + k], middle(k))) || off(nodes[8], corners.iter().sum::<DVec3>() / 4.0)
            }
        }
    }

    /// Whether the straight line between two places is on a side of the reference element.
    fn is_side(&self, p: DVec2, q: DVec2) -> bool {
        let both = |place: fn(DVec2) -> f64| place(p) == 0.0 && place(q) == 0.0;
        both(|p| p.x)
            || both(|p| p.y)
            || match self {
                Map::Triangle(_) => both(|p| p.x + p.y - 1.0),
                Map::Quad(_) => both(|p| p.x - 1.0) || both(|p| p.y - 1.0),
            }
    }

    /// How far the element leaves the straight piece `[a, b]` between two places: on its sides across the piece, and
    /// inside along the normal, since what moves within the surface does not change it.
    fn leaves(&self, [p, q]: [DVec2; 2], [a, b]: [DVec3; 2], normal: DVec3) -> f64 {
        let off = |t: f64| self.at(p.lerp(q, t)) - a.lerp(b, t);
        let along = (b - a).normalize_or_zero();
        let distance = |t: f64| match off(t) {
            off if self.is_side(p, q) => (off - along * off.dot(along)).length(),
            off if normal != DVec3::ZERO => off.dot(normal).abs(),
            off => off.length(),
        };
        SAMPLES.into_iter().map(distance).fold(0.0, f64::max)
    }
}

/// The bent elements.
struct Bends {
    maps: Vec<Map>,
    /// How far pieces may be from them.
    tolerances: Vec<f64>,
    /// Their indices among all elements.
    of: Vec<u32>,
}

/// Pieces in the order of their elements.
struct Halved {
    pieces: Vec<Piece>,
    /// The point in the middle of each side that was halved.
    halves: FxHashMap<[u32; 2], u32>,
    ends: Vec<[u32; 2]>,
    is_coarse: bool,
}

impl Bends {
    fn push(&mut self, map: Map, element: u32) -> u32 {
        self.tolerances.push(CHORD * map.size());
        self.maps.push(map);
        self.of.push(element);
        self.of.len() as u32 - 1
    }

    /// Halves sides until no piece is too far from its element; `others` are the elements of the mesh.
    fn halve(&self, mut pieces: Vec<Piece>, points: &mut Vec<DVec3>, others: usize) -> Halved {
        let (mut halves, mut ends) = (FxHashMap::default(), Vec::new());
        let mut level = 0;
        loop {
            let mut marked: Vec<([u32; 2], DVec3)> = Vec::new();
            let mut known: FxHashMap<[u32; 2], ()> = FxHashMap::default();
            for piece in &pieces {
                let (map, tolerance) = (&self.maps[piece.of as usize], self.tolerances[piece.of as usize]);
                let p = piece.corners.map(|k| points[k as usize]);
                let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
                for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                    let (side, at) = (key(piece.corners[i], piece.corners[j]), [piece.at[i], piece.at[j]]);
                    let leaves = map.leaves(at, [p[i], p[j]], normal);
                    if leaves > tolerance && known.insert(side, ()).is_none() {
                        marked.push((side, map.at((at[0] + at[1]) / 2.0)));
                    }
                }
            }
            let is_coarse = !marked.is_empty();
            let is_marked =
                |piece: &Piece| sides(piece.corners).iter().filter(|side| known.contains_key(*side)).count();
            let count = pieces.iter().map(|piece| 1 + is_marked(piece)).sum::<usize>();
            if !is_coarse || level == LEVELS || count + others > MOST.max(4 * others) {
                return Halved { pieces, halves, ends, is_coarse };
            }
            for (side, middle) in marked {
                halves.insert(side, points.len() as u32);
                points.push(middle);
                ends.push(side);
            }
            pieces = pieces.iter().flat_map(|piece| piece.halved(&halves, points)).collect();
            level += 1;
        }
    }
}

fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [key(a, b), key(b, c), key(c, a)]
}

impl Piece {
    /// ```text
    ///        c              c              c
    ///       / \            /|\            / \
    ///      /   \          / | \          /___\ bc
    ///     /     \        /  |  \        / \ / \
    ///    a---ab--b      a--ab---b      a--ab---b      and one across where ca is whole
    /// ```
    fn halved(&self, halves: &FxHashMap<[u32; 2], u32>, points: &[DVec3]) -> Vec<Piece> {
        let middles = sides(self.corners).map(|side| halves.get(&side).copied());
        // Places 0 to 2 are corners, 3 to 5 middles of the sides that begin there.
        let point = |k: usize| if k < 3 { self.corners[k] } else { middles[k - 3].unwrap_or(self.corners[k - 3]) };
        let at = |k: usize| if k < 3 { self.at[k] } else { (self.at[k - 3] + self.at[(k - 2) % 3]) / 2.0 };
        let turned = |by: usize| move |k: usize| (k % 3 + by) % 3 + if k < 3 { 0 } else { 3 };
        let made: Vec<[usize; 3]> = match (middles.map(|m| m.is_some()), middles.iter().flatten().count()) {
            (_, 0) => vec![[0, 1, 2]],
            (is, 1) => {
                let turn = turned(is.iter().position(|is| *is).unwrap_or(0));
                [[0, 3, 2], [3, 1, 2]].map(|t| t.map(turn)).to_vec()
            }
            (is, 2) => {
                // The side from 2 to 0 is whole.
                let turn = turned((is.iter().position(|is| !is).unwrap_or(0) + 1) % 3);
                let p = |k: usize| points[point(turn(k)) as usize];
                let across = if p(0).distance_squared(p(4)) < p(3).distance_squared(p(2)) {
                    [[0, 3, 4], [0, 4, 2]]
                } else {
                    [[0, 3, 2], [3, 4, 2]]
                };
                [[3, 1, 4], across[0], across[1]].map(|t| t.map(turn)).to_vec()
            }
            _ => vec![[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
        };
        made.iter().map(|t| Piece { of: self.of, corners: t.map(point), at: t.map(at) }).collect()
    }
}

#[cfg(test)]
#[path = "division_tests.rs"]
mod tests;
