//! Maximum cardinality matching in a general graph (Edmonds 1965; docs/algorithm.md, "The last resort", step 1), made
//! for the dual graphs of triangulations: millions of vertices of degree at most three, nearly all matched greedily.
//!
//! The start takes edges by rank, best first, but serves vertices with one possibility left before all others (Karp &
//! Sipser 1981: that loses no cardinality). Then one search for an augmenting path grows from each vertex left over. It
//! pays only for what it touches: labels carry the number of their search, blossoms are sets in a union-find forest. A
//! search that fails leaves a Hungarian tree, which no later augmenting path can use: it is closed permanently.
//!
//! Edges come in two tiers. *Preferred* ones are matched to their maximum first; *reserve* ones may then match more,
//! each search using them only where preferred ones lead nowhere. Deliberately absent: weights beyond the start's
//! ranking (a minimum cost perfect matching costs far more, and smoothing and clean-up follow anyway).

/// No vertex.
const NONE: u32 = u32::MAX;

/// How many vertices a search goes on along preferred edges before it turns to the reserve edges of the first of them.
/// To exhaust the preferred ones first costs a walk through most of a large graph for each search: measured on two
/// million triangles 0.14 s an augmentation, against 0.2 ms; this many leads to 3 % more reserve edges in the result.
const PATIENCE: usize = 1024;

/// A vertex in the tree of the running search at even distance from its root.
const EVEN: u32 = 0;
/// A vertex at odd distance.
const ODD: u32 = 1;
/// A vertex at odd distance that a blossom has made reachable at even distance, too: over its `bridge`.
const TURNED: u32 = 2;

/// A graph and a matching in it, with what a search needs.
#[derive(Debug)]
pub struct Matching {
    /// Where the neighbours of each vertex begin in `neighbours`; one more at the end.
    begin: Vec<u32>,
    /// Where the reserve neighbours of each vertex begin.
    reserve: Vec<u32>,
    neighbours: Vec<u32>,
    mate: Vec<u32>,

    /// `4 * search + label`: valid where the search is the running one; `u32::MAX` where the vertex is shut.
    mark: Vec<u32>,
    search: u32,
    /// Of an odd vertex: the even one from which it was reached.
    parent: Vec<u32>,
    /// Union-find: leads to the base of the blossom that holds the vertex.
    blossom: Vec<u32>,
    /// Of a turned vertex: the edge that closed its blossom, first the end on the vertex's own side.
    bridge: Vec<[u32; 2]>,
    /// Walks towards a common base: the number of the walk that came by last.
    visited: Vec<u32>,
    walk: u32,
    /// Even vertices of the running search in order of discovery.
    queue: Vec<u32>,
    /// Odd vertices of the running search.
    odd: Vec<u32>,
    path: Vec<[u32; 2]>,
    pending: Vec<[u32; 2]>,
}

impl Matching {
    /// The graph with `n` vertices (below 2^30), the preferred and the reserve edges; nothing is matched yet.
    pub fn new(n: usize, preferred: &[[u32; 2]], reserve: &[[u32; 2]]) -> Self {
        assert!(n < 1 << 30, "a matching holds fewer than 2^30 vertices");
        let mut degree = vec![0u32; n];
        let mut low = vec![0u32; n];
        for &[a, b] in preferred {
            low[a as usize] += 1;
            low[b as usize] += 1;
        }
        for &[a, b] in reserve {
            degree[a as usize] += 1;
            degree[b as usize] += 1;
        }
        let mut begin = Vec::with_capacity(n + 1);
        let mut middle = Vec::with_capacity(n);
        let mut end = 0;
        for v in 0..n {
            begin.push(end);
            middle.push(end + low[v]);
            end += low[v] + degree[v];
        }
        begin.push(end);
        let mut neighbours = vec![0; end as usize];
        // From here on `low` and `degree` are where the next neighbour of each tier goes.
        low.copy_from_slice(&begin[..n]);
        degree.copy_from_slice(&middle);
        for (edges, next) in [(preferred, &mut low), (reserve, &mut degree)] {
            for &[a, b] in edges {
                for [a, b] in [[a, b], [b, a]] {
                    neighbours[next[a as usize] as usize] = b;
                    next[a as usize] += 1;
                }
            }
        }
        Matching {
            begin,
            reserve: middle,
            neighbours,
            mate: vec![NONE; n],
            mark: vec![0; n],
            search: 0,
            parent: low,
            blossom: degree,
            bridge: vec![[NONE; 2]; n],
            visited: vec![0; n],
            walk: 0,
            queue: Vec::new(),
            odd: Vec::new(),
            path: Vec::new(),
            pending: Vec::new(),
        }
    }

    /// The partner of a vertex.
    #[inline]
    pub fn mate(&self, v: u32) -> Option<u32> {
        let mate = self.mate[v as usize];
        (mate != NONE).then_some(mate)
    }

    /// Number of vertices without a partner.
    pub fn unmatched(&self) -> usize {
        self.mate.iter().filter(|&&mate| mate == NONE).count()
    }

    /// The greedy start over the preferred edges, given again with their ranks (not NaN): vertices with a single free
    /// neighbour first, then the best edge left; ties by the edge's place in the list.
    pub fn start(&mut self, preferred: &[[u32; 2]], rank: &[f32]) {
        assert_eq!(preferred.len(), rank.len());
        // One integer orders by falling rank, then place: bits of positive floats rise, of negative ones fall.
        let mut order: Vec<u64> = (rank.iter().enumerate())
            .map(|(place, rank)| {
                let bits = rank.to_bits();
                let rising = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
                u64::from(!rising) << 32 | place as u64
            })
            .collect();
        order.sort_unstable();
        let mut degree: Vec<u32> = (self.begin.iter().zip(&self.reserve)).map(|(begin, end)| end - begin).collect();
        let mut single: Vec<u32> = (0..degree.len() as u32).filter(|&v| degree[v as usize] == 1).rev().collect();
        for key in order {
            self.match_singles(&mut degree, &mut single);
            let [a, b] = preferred[(key & 0xffff_ffff) as usize];
            if a != b && self.mate[a as usize] == NONE && self.mate[b as usize] == NONE {
                self.pair(a, b, &mut degree, &mut single);
            }
        }
        self.match_singles(&mut degree, &mut single);
    }

    /// Matches vertices whose only free neighbour is known, and those that become such.
    fn match_singles(&mut self, degree: &mut [u32], single: &mut Vec<u32>) {
        while let Some(v) = single.pop() {
            if self.mate[v as usize] == NONE
                && let Some(&w) = (self.preferred(v).iter()).find(|&&w| w != v && self.mate[w as usize] == NONE)
            {
                self.pair(v, w, degree, single);
            }
        }
    }

    /// Matches two free vertices, and notes the neighbours that have a single possibility left.
    fn pair(&mut self, a: u32, b: u32, degree: &mut [u32], single: &mut Vec<u32>) {
        self.mate[a as usize] = b;
        self.mate[b as usize] = a;
        for v in [a, b] {
            for &w in self.preferred(v) {
                degree[w as usize] -= 1;
                if degree[w as usize] == 1 && self.mate[w as usize] == NONE {
                    single.push(w);
                }
            }
        }
    }

    /// Augments to maximum cardinality, over the preferred edges or all. Returns the number of augmentations.
    pub fn augment(&mut self, with_reserve: bool) -> usize {
        // What an earlier call shut may be of use with other edges.
        self.mark.fill(0);
        self.search = 0;
        let mut done = 0;
        for root in 0..self.mate.len() as u32 {
            if self.mate[root as usize] != NONE || self.mark[root as usize] == NONE {
                continue;
            }
            if self.grow(root, with_reserve) {
                done += 1;
            } else {
                for v in self.queue.iter().chain(&self.odd) {
                    self.mark[*v as usize] = NONE;
                }
            }
        }
        done
    }

    #[inline]
    fn preferred(&self, v: u32) -> &[u32] {
        &self.neighbours[self.begin[v as usize] as usize..self.reserve[v as usize] as usize]
    }

    /// Grows an alternating tree from an unmatched vertex, breadth first, until it meets another one: then the path is
    /// flipped and the answer is true.
    fn grow(&mut self, root: u32, with_reserve: bool) -> bool {
        self.search += 1;
        self.queue.clear();
        self.odd.clear();
        self.set(root, EVEN);
        self.queue.push(root);
        let (mut next, mut next_reserve) = (0, 0);
        loop {
            let patient = !with_reserve || next <= next_reserve + PATIENCE;
            let (v, range) = if patient && let Some(&v) = self.queue.get(next) {
                next += 1;
                (v, self.begin[v as usize]..self.reserve[v as usize])
            } else if with_reserve && let Some(&v) = self.queue.get(next_reserve) {
                next_reserve += 1;
                (v, self.reserve[v as usize]..self.begin[v as usize + 1])
            } else {
                return false;
            };
            for place in range {
                let w = self.neighbours[place as usize];
                let mark = self.mark[w as usize];
                if mark == NONE {
                    continue;
                }
                if mark >> 2 == self.search {
                    if mark & 3 != ODD {
                        self.contract(v, w);
                    }
                    continue;
                }
                let mate = self.mate[w as usize];
                if mate == NONE {
                    self.flip(root, v, w);
                    return true;
                }
                self.set(w, ODD);
                self.parent[w as usize] = v;
                self.odd.push(w);
                self.set(mate, EVEN);
                self.queue.push(mate);
            }
        }
    }

    #[inline]
    fn set(&mut self, v: u32, label: u32) {
        self.mark[v as usize] = self.search << 2 | label;
        self.blossom[v as usize] = v;
    }

    /// The base of the blossom that holds a vertex of the tree (itself where none does).
    #[inline]
    fn base(&mut self, mut v: u32) -> u32 {
        loop {
            let above = self.blossom[v as usize];
            if above == v {
                return v;
            }
            let next = self.blossom[above as usize];
            self.blossom[v as usize] = next;
            v = next;
        }
    }

    /// Two even vertices are joined by an edge: the odd cycle becomes a blossom, unless they are in one already.
    fn contract(&mut self, v: u32, w: u32) {
        let (mut a, mut b) = (self.base(v), self.base(w));
        if a == b {
            return;
        }
        // Walk towards the root from both ends by turns: the first base seen twice is the new blossom's.
        self.walk += 1;
        let common = loop {
            if a != NONE {
                if self.visited[a as usize] == self.walk {
                    break a;
                }
                self.visited[a as usize] = self.walk;
                let odd = self.mate[a as usize];
                a = if odd == NONE { NONE } else { self.base(self.parent[odd as usize]) };
            }
            std::mem::swap(&mut a, &mut b);
        };
        for bridge in [[v, w], [w, v]] {
            let mut base = self.base(bridge[0]);
            while base != common {
                let odd = self.mate[base as usize];
                self.mark[odd as usize] = self.search << 2 | TURNED;
                self.bridge[odd as usize] = bridge;
                self.blossom[base as usize] = common;
                self.blossom[odd as usize] = common;
                self.queue.push(odd);
                base = self.base(self.parent[odd as usize]);
            }
        }
    }

    /// Flips the path from the root over the even vertex `v` to the unmatched vertex `w`.
    ///
    /// Only its edges outside the matching are needed, in any order: they are the new matching. Below a turned vertex
    /// the path runs down to its bridge (that stretch is the way up from the bridge) and up from the bridge's far end.
    fn flip(&mut self, root: u32, v: u32, w: u32) {
        self.path.clear();
        self.path.push([v, w]);
        self.pending.push([v, root]);
        while let Some([mut v, end]) = self.pending.pop() {
            while v != end {
                let mate = self.mate[v as usize];
                if self.mark[v as usize] & 3 == EVEN {
                    let up = self.parent[mate as usize];
                    self.path.push([mate, up]);
                    v = up;
                } else {
                    let [near, far] = self.bridge[v as usize];
                    self.path.push([near, far]);
                    self.pending.push([near, mate]);
                    v = far;
                }
            }
        }
        for &[a, b] in &self.path {
            self.mate[a as usize] = b;
            self.mate[b as usize] = a;
        }
    }
}

#[cfg(test)]
mod tests {
    use petgraph::graph::{NodeIndex, UnGraph};
    use proptest::prelude::Rng;
    use proptest::test_runner::{RngAlgorithm, TestRng};

    /// A maximum matching; among several, edges of higher rank are favoured.
    fn maximum_matching(n: usize, edges: &[[u32; 2]], rank: &[f32]) -> Vec<Option<u32>> {
        let mut matching = Matching::new(n, edges, &[]);
        matching.start(edges, rank);
        matching.augment(false);
        (0..n as u32).map(|v| matching.mate(v)).collect()
    }

    use super::*;
    /// Seeded random numbers.
    struct Random(TestRng);

    impl Random {
        fn new() -> Self {
            Random(TestRng::deterministic_rng(RngAlgorithm::ChaCha))
        }
        fn below(&mut self, n: u32) -> u32 {
            ((u64::from(self.0.next_u32()) * u64::from(n)) >> 32) as u32
        }
    }

    fn cardinality(mate: &[Option<u32>]) -> usize {
        mate.iter().flatten().count() / 2
    }

    fn petgraph_cardinality(n: usize, edges: &[[u32; 2]]) -> usize {
        let mut graph = UnGraph::<(), ()>::default();
        for _ in 0..n {
            graph.add_node(());
        }
        for &[a, b] in edges {
            graph.add_edge(NodeIndex::new(a as usize), NodeIndex::new(b as usize), ());
        }
        petgraph::algo::maximum_matching(&graph).edges().count()
    }

    fn assert_is_matching(mate: &[Option<u32>], edges: &[[u32; 2]]) {
        for (v, w) in mate.iter().enumerate().filter_map(|(v, w)| w.map(|w| (v as u32, w))) {
            assert_eq!(mate[w as usize], Some(v), "partners know each other");
            assert!(edges.contains(&[v, w]) || edges.contains(&[w, v]), "partners {v} and {w} share an edge");
        }
    }

    /// A random simple graph with at most the given degree.
    fn random_graph(random: &mut Random, n: u32, tries: u32, max_degree: usize) -> Vec<[u32; 2]> {
        let mut degree = vec![0; n as usize];
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for _ in 0..tries {
            let (a, b) = (random.below(n), random.below(n));
            let known = edges.contains(&[a, b]) || edges.contains(&[b, a]);
            if a != b && !known && degree[a as usize] < max_degree && degree[b as usize] < max_degree {
                degree[a as usize] += 1;
                degree[b as usize] += 1;
                edges.push([a, b]);
            }
        }
        edges
    }

    fn ranks(random: &mut Random, edges: &[[u32; 2]]) -> Vec<f32> {
        edges.iter().map(|_| random.below(7) as f32 - 3.0).collect()
    }

    #[test]
    fn cardinality_equals_petgraphs_on_thousands_of_random_graphs() {
        let mut random = Random::new();
        let mut deficient = 0;
        for round in 0..6000 {
            let n = 1 + random.below(if round % 20 == 0 { 120 } else { 24 });
            let tries = random.below(4 * n + 1);
            let edges = random_graph(&mut random, n, tries, if round % 5 == 0 { 6 } else { 3 });
            let rank = ranks(&mut random, &edges);
            let mate = maximum_matching(n as usize, &edges, &rank);
            assert_is_matching(&mate, &edges);
            assert_eq!(cardinality(&mate), petgraph_cardinality(n as usize, &edges), "round {round}: {edges:?}");
            deficient += usize::from(2 * cardinality(&mate) < n as usize);
        }
        assert!(deficient > 1000, "graphs without a perfect matching are among them");
    }

    #[test]
    fn augmenting_from_nothing_reaches_the_maximum_too() {
        let mut random = Random::new();
        for round in 0..3000 {
            let n = 1 + random.below(30);
            let tries = random.below(5 * n);
            let edges = random_graph(&mut random, n, tries, 3);
            let mut matching = Matching::new(n as usize, &edges, &[]);
            let augmented = matching.augment(false);
            assert_eq!(augmented, petgraph_cardinality(n as usize, &edges), "round {round}: {edges:?}");
        }
    }

    #[test]
    fn reserve_edges_bring_the_maximum_of_the_whole_graph_and_are_used_only_where_needed() {
        let mut random = Random::new();
        for round in 0..3000 {
            let n = 2 + random.below(40);
            let edges = random_graph(&mut random, n, 4 * n, 3);
            let (preferred, reserve) = edges.split_at(edges.len() * 3 / 4);
            let rank = ranks(&mut random, preferred);
            let mut matching = Matching::new(n as usize, preferred, reserve);
            matching.start(preferred, &rank);
            matching.augment(false);
            let first = (n as usize - matching.unmatched()) / 2;
            assert_eq!(first, petgraph_cardinality(n as usize, preferred), "round {round}");
            let more = matching.augment(true);
            assert_eq!(first + more, petgraph_cardinality(n as usize, &edges), "round {round}");
            let mate: Vec<_> = (0..n).map(|v| matching.mate(v)).collect();
            assert_is_matching(&mate, &edges);
            if more == 0 {
                assert_is_matching(&mate, preferred);
            }
        }
    }

    #[test]
    fn a_path_is_found_that_enters_a_blossom_and_leaves_it_by_a_turned_vertex() {
        // 7-0=1, the cycle 1-2=3-4=5-1, and 2-6: the only augmenting path is 7-0=1-5=4-3=2-6, the long way round.
        let edges = [[7, 0], [0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 1], [2, 6]];
        let mut matching = Matching::new(8, &edges, &[]);
        matching.mate = vec![1, 0, 3, 2, 5, 4, NONE, NONE];
        assert!(matching.grow(7, false));
        assert_eq!(matching.mate, [7, 5, 6, 4, 3, 1, 2, 0]);
    }

    #[test]
    fn the_start_takes_the_best_edge_where_cardinality_leaves_a_choice() {
        // A square: either pair of opposite sides is perfect.
        let edges = [[0, 1], [1, 2], [2, 3], [3, 0]];
        assert_eq!(maximum_matching(4, &edges, &[0.1, 0.2, 0.3, 0.9])[0], Some(3));
        assert_eq!(maximum_matching(4, &edges, &[-0.1, -0.2, -0.3, -0.9])[0], Some(1));
    }

    #[test]
    fn no_vertices_and_no_edges_are_served() {
        assert!(maximum_matching(0, &[], &[]).is_empty());
        assert_eq!(maximum_matching(3, &[], &[]), [None, None, None]);
    }

    #[test]
    fn the_same_input_gives_the_same_matching() {
        let mut random = Random::new();
        let edges = random_graph(&mut random, 300, 1500, 3);
        let rank = ranks(&mut random, &edges);
        assert_eq!(maximum_matching(300, &edges, &rank), maximum_matching(300, &edges, &rank));
    }
}
