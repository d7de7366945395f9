//! Elements of higher order: those whose edges have nodes between their ends. Their corners are read.

use super::mesh_file::MeshFile;

impl MeshFile {
    /// Removes those of [`MeshFile::middles`] that are no corners of any element, with their data, and tells of them.
    pub(in crate::core) fn drop_middles(&mut self) {
        let middles = std::mem::take(&mut self.middles);
        let mut gone = vec![false; self.points.len()];
        middles.iter().for_each(|&point| gone[point as usize] = true);
        self.visit_corners(&mut |point| gone[*point as usize] = false);
        for members in self.members.iter().filter(|members| members.dimension == 0) {
            members.of.iter().for_each(|&point| gone[point as usize] = false);
        }
        let dropped = gone.iter().filter(|gone| **gone).count();
        if dropped == 0 {
            return;
        }
        let mut next = 0..;
        let index: Vec<u32> = gone.iter().map(|&gone| if gone { 0 } else { next.next().unwrap_or(0) }).collect();
        self.visit_corners(&mut |point| *point = index[*point as usize]);
        for members in self.members.iter_mut().filter(|members| members.dimension == 0) {
            members.of.iter_mut().for_each(|point| *point = index[*point as usize]);
        }
        keep(&mut self.points, &gone);
        self.metric.iter_mut().for_each(|metric| keep(metric, &gone));
        self.uv.iter_mut().for_each(|uv| keep(uv, &gone));
        self.point_data.iter_mut().for_each(|data| keep(&mut data.values, &gone));
        self.counting.points.keep(&gone);
        self.omit_many("mid-side node", "of an element of higher order", dropped);
    }

    fn visit_corners(&mut self, visit: &mut dyn FnMut(&mut u32)) {
        self.lines.as_flattened_mut().iter_mut().for_each(&mut *visit);
        self.triangles.as_flattened_mut().iter_mut().for_each(&mut *visit);
        self.quads.as_flattened_mut().iter_mut().for_each(&mut *visit);
        self.polygons.iter_mut().flatten().for_each(visit);
    }
}

/// Removes the items that are gone.
fn keep<T>(items: &mut Vec<T>, gone: &[bool]) {
    let mut of_item = gone.iter();
    items.retain(|_| of_item.next() != Some(&true));
}
