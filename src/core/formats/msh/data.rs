//! Reading the sections $NodeData and $ElementData of an MSH file.

use super::METRIC;
use super::read::Reader;
use crate::core::fault::Fault;
use crate::core::formats::numbering::Numbering;
use crate::core::kernel::Metric3;
use crate::core::soup::{CELL_DATA, Data, POINT_DATA};

impl Reader<'_> {
    /// Reads $NodeData or $ElementData.
    pub fn data(&mut self, section: &[u8]) -> Result<(), Fault> {
        let of_nodes = section == b"NodeData";
        let scanner = &mut self.input.scanner;
        let mut name = String::new();
        let names = scanner.count("a number of names", 2)?;
        scanner.line();
        for place in 0..names {
            let line = scanner.filled_line().unwrap_or_default();
            if place == 0 {
                name = String::from_utf8_lossy(line).trim_matches('"').to_string();
            }
        }
        for _ in 0..scanner.count("a number of real tags", 2)? {
            scanner.real("a real tag")?;
        }
        let mut tags = [0; 3];
        for place in 0..scanner.count("a number of integer tags", 2)? {
            let tag = scanner.integer("an integer tag")?;
            if let Some(slot) = tags.get_mut(place) {
                *slot = tag;
            }
        }
        scanner.line();
        let [_, components, count] = tags;
        let total = if of_nodes { self.file.points.len() } else { self.file.triangles.len() + self.file.quads.len() };
        let (components, count) = (components.max(0) as u64, count.max(0) as u64);
        let is_metric = of_nodes && components == 9 && name == METRIC;
        // Incomplete data is skipped, before memory is reserved by a possibly wrong count.
        if total == 0 || (count as usize) < total || !(components == 1 || is_metric) {
            self.file.omit(if of_nodes { POINT_DATA } else { CELL_DATA }, &name);
            return self.skip(section);
        }
        let components = components as usize;
        let count = self.input.fits(count, 2 + 2 * components, 4 + 8 * components, "a number of values")?;
        let mut values = vec![0.0; total * components];
        let mut seen = vec![false; total];
        for _ in 0..count {
            let tag = self.input.tag("a node or element tag")?;
            let index =
                if of_nodes { self.nodes.as_ref().and_then(|nodes| nodes.index(tag)) } else { self.element_index(tag) };
            let mut ignored = [0.0; 9];
            let slots = match index.map(|index| index as usize) {
                Some(index) => {
                    seen[index] = true;
                    &mut values[index * components..(index + 1) * components]
                }
                None => &mut ignored[..components],
            };
            for slot in slots {
                *slot = self.input.real("a value")?;
            }
        }
        let missing = seen.iter().position(|seen| !seen);
        if is_metric {
            if let Some(index) = missing {
                return Err(self.input.scanner.fault(format!("The metric has no value for node {}", index + 1)));
            }
            let scanner = &self.input.scanner;
            let metric = values.chunks_exact(9).zip(1u32..).map(|(m, node)| {
                let metric = Metric3 { xx: m[0], xy: m[1], xz: m[2], yy: m[4], yz: m[5], zz: m[8] };
                let found = metric.is_spd().then_some(metric);
                found.ok_or_else(|| scanner.fault(format!("The metric of node {node} is not positive definite")))
            });
            self.file.metric = Some(metric.collect::<Result<_, _>>()?);
        } else if missing.is_none() {
            let data = Data { name, values };
            if of_nodes { self.file.point_data.push(data) } else { self.file.element_data.push(data) }
        } else {
            self.file.omit(if of_nodes { POINT_DATA } else { CELL_DATA }, &name);
        }
        self.end(section)
    }

    /// The index of a triangle or quadrilateral by its tag.
    fn element_index(&mut self, tag: u64) -> Option<u32> {
        let numbers = &self.numbers;
        self.elements
            .get_or_insert_with(|| Numbering::new(&[&numbers[1][..], &numbers[2][..]].concat()).ok())
            .as_ref()?
            .index(tag)
    }
}
