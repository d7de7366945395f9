//! Parts of an imported mesh with odd numbers of triangles: made even by the division of sides, or refused.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::{Import, same_edge};
use crate::core::background::cut::{Side, cut, sorted_sides};
use crate::core::fault::Fault;
use crate::core::kernel::DisjointSets;
use crate::core::kernel::decimal::point_text;
use crate::core::kernel::parity::fewest_toggles;
use crate::core::soup::Repair;

impl Import<'_> {
    /// Makes the number of triangles of every part even by the division of as few sides as possible: sides between
    /// two parts, of one region or of two, and with `split_odd` sides on the boundary.
    pub(super) fn even_parts(&mut self, split_odd: bool) -> Result<(), Fault> {
        let mut parts = DisjointSets::new(self.triangles.len());
        let on_line = |side: &Side| self.lines.contains_key(&side.ends());
        let one_region = |a: &Side, b: &Side| self.region[a.triangle()] == self.region[b.triangle()];
        for pair in self.sides.chunk_by(same_edge) {
            if let [a, b] = pair
                && one_region(a, b)
                && !on_line(a)
            {
                parts.join(a.corner / 3, b.corner / 3);
            }
        }
        let part: Vec<u32> = (0..self.triangles.len() as u32).map(|t| parts.find(t)).collect();
        let mut count = vec![0_u32; part.len()];
        part.iter().for_each(|&p| count[p as usize] += 1);
        let Some(first) = (0..part.len()).find(|&p| count[p] % 2 == 1) else { return Ok(()) };
        // The longest side on the boundary of each part, and between each two parts.
        let mut longest: BTreeMap<_, (f64, &[Side])> = BTreeMap::new();
        for group in self.sides.chunk_by(same_edge) {
            let at = |side: &Side| part[side.triangle()];
            let between = match group {
                [a] if split_odd => (at(a), None),
                [a, b] if at(a) != at(b) => (at(a).min(at(b)), Some(at(a).max(at(b)))),
                _ => continue,
            };
            let length = self.uv[group[0].low as usize].distance(self.uv[group[0].high as usize]);
            let known = longest.entry(between).or_insert((length, group));
            if length > known.0 {
                *known = (length, group);
            }
        }
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); part.len()];
        for (column, (one, other)) in (0..).zip(longest.keys()) {
            [Some(*one), *other].into_iter().flatten().for_each(|p| rows[p as usize].push(column));
        }
        let odd: Vec<bool> = count.iter().map(|n| n % 2 == 1).collect();
        let cost: Vec<Option<f64>> =
            longest.values().map(|(length, _)| Some(1.0 / length.max(f64::MIN_POSITIVE))).collect();
        let toggled = fewest_toggles(&rows, &odd, &cost).map_err(|blamed| {
            let named = blamed.iter().copied().find(|&p| odd[p as usize]).unwrap_or(first as u32);
            self.odd_fault(&part, named, count[named as usize], split_odd)
        })?;
        let chosen: Vec<Vec<Side>> = longest
            .values()
            .zip(toggled)
            .filter(|(_, toggled)| *toggled)
            .map(|((_, group), _)| group.to_vec())
            .collect();
        let mut halves = FxHashMap::default();
        for sides in &chosen {
            self.divide(sides, &mut halves)?;
        }
        let inside = chosen.iter().filter(|sides| sides.len() > 1).count();
        Repair::DividedInterface.report(inside, &mut self.repairs);
        Repair::DividedSegment.report(chosen.len() - inside, &mut self.repairs);
        self.sides = sorted_sides(self.uv.len(), &self.triangles);
        Ok(())
    }

    /// Divides the sides on one edge and their triangles; `halves` maps divided triangles to the ones split off from
    /// them.
    fn divide(&mut self, sides: &[Side], halves: &mut FxHashMap<usize, Vec<usize>>) -> Result<(), Fault> {
        let [a, b] = [sides[0].low, sides[0].high];
        let middle = self.uv[a as usize].midpoint(self.uv[b as usize]);
        let m = self.uv.len() as u32;
        self.uv.push(middle);
        self.origin.push([a, b]);
        if let Some(&group) = self.lines.get(&(a.min(b), a.max(b))) {
            self.lines.extend([a, b].map(|end| ((end, m), group)));
        }
        for side in sides {
            let given = side.triangle();
            let others = halves.entry(given).or_default();
            let has_both = |t: &usize| [a, b].iter().all(|end| self.triangles[*t].contains(end));
            let t = others.iter().copied().find(has_both).unwrap_or(given);
            let k = (0..3).find(|&k| ![a, b].contains(&self.triangles[t][(k + 2) % 3])).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|i| self.triangles[t][(k + i) % 3]);
            let parts = [[a, m, c], [m, b, c]];
            if parts.iter().any(|&h| !self.firm(h)) {
                return Err(Fault::new(format!("{} is too thin to divide", self.named([t])))
                    .at(format!("at {}", point_text(middle)))
                    .remedy("Divide another boundary segment of its part in the mesh")
                    .showing(self.shapes([t])));
            }
            others.push(self.triangles.len());
            self.triangles[t] = parts[0];
            self.triangles.push(parts[1]);
            self.region.push(self.region[t]);
            self.element.push(self.element[t]);
        }
        Ok(())
    }

    fn odd_fault(&self, part: &[u32], odd: u32, count: u32, split_odd: bool) -> Fault {
        let member = |t: usize| part[t] == odd;
        let members: Vec<usize> = (0..part.len()).filter(|&t| member(t)).collect();
        let triangles: Vec<[u32; 3]> = members.iter().map(|&t| self.triangles[t]).collect();
        let mesh = cut(&self.uv, triangles, vec![0; count as usize], &[]);
        let loops = mesh.loops();
        let found = loops.iter().find(|l| l.len() % 2 == 1);
        let segments = found.map_or(0, Vec::len);
        let at = found.map_or(DVec2::ZERO, |l| mesh.set.uv[l[0] as usize]);
        let region = match self.tags.len() {
            1 => String::new(),
            _ => format!(" of {}", self.region_name(self.region[odd as usize]).name),
        };
        let mut remedy = "Divide one boundary segment of this part".to_owned();
        if !split_odd {
            remedy += ", or allow the division (--split-odd)";
        }
        if self.coincident > 0 {
            remedy += "; or merge coincident points, if the mesh should be connected there";
        }
        let triangles = if count == 1 { "triangle" } else { "triangles" };
        let side = |ends: [u32; 2]| ends.map(|n| mesh.set.uv[n as usize].extend(self.z)).to_vec();
        let sides: Vec<[u32; 2]> =
            found.into_iter().flat_map(|l| (0..l.len()).map(|k| [l[k], l[(k + 1) % l.len()]])).collect();
        let ends: BTreeSet<[u32; 2]> = sides.iter().copied().collect();
        let is_beside = |t: &[u32; 3]| (0..3).any(|k| ends.contains(&[t[k], t[(k + 1) % 3]]));
        let beside =
            members.into_iter().zip(&mesh.set.triangles).filter(|(_, t)| is_beside(t)).map(|(t, _)| self.element[t]);
        let beside = self.given.describe_elements(&beside.collect::<Vec<_>>());
        Fault::new(format!(
            "The boundary loop of {segments} segments leaves a part{region} with {count} {triangles}; \
             an all-quad mesh needs an even count"
        ))
        .at(format!("at {}, sides of {beside}", point_text(at)))
        .remedy(remedy)
        .showing(sides.into_iter().map(side))
    }
}
