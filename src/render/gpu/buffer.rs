//! Instances on the card, in pages: a list that grows takes another page and is never copied, and only the stretches that
//! differ from what is there are sent.

use bytemuck::Pod;

/// Instances in a page, and in a stretch that is compared at once.
const PAGE: usize = 1 << 15;
const STRETCH: usize = 64;

/// A list of instances on the card.
pub(super) struct Patched<T> {
    label: &'static str,
    here: Vec<T>,
    pages: Vec<wgpu::Buffer>,
    /// Bytes sent so far.
    pub sent: u64,
}

impl<T: Pod + PartialEq> Patched<T> {
    pub fn new(label: &'static str) -> Self {
        Patched { label, here: Vec::new(), pages: Vec::new(), sent: 0 }
    }

    /// Makes the list on the card that of `new`.
    pub fn set(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, new: &[T]) {
        let pages = new.len().div_ceil(PAGE);
        while self.pages.len() < pages {
            self.pages.push(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
                size: (PAGE * size_of::<T>()) as u64,
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        for (page, fresh) in new.chunks(PAGE).enumerate() {
            let first = page * PAGE;
            let old = self.here.get(first..(first + fresh.len()).min(self.here.len())).unwrap_or_default();
            for [start, end] in differing(old, fresh) {
                let bytes = bytemuck::cast_slice(&fresh[start..end]);
                queue.write_buffer(&self.pages[page], (start * size_of::<T>()) as u64, bytes);
                self.sent += bytes.len() as u64;
            }
        }
        self.here.clear();
        self.here.extend_from_slice(new);
    }

    /// Draws all of them, six corners each.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        for (page, instances) in self.pages.iter().zip(self.here.chunks(PAGE)) {
            pass.set_vertex_buffer(0, page.slice(..));
            pass.draw(0..6, 0..instances.len() as u32);
        }
    }
}

/// The stretches of `new` that differ from `old`, as starts and ends; what `old` does not have differs.
fn differing<T: PartialEq>(old: &[T], new: &[T]) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    let mut start = 0;
    while start < new.len() {
        let end = (start + STRETCH).min(new.len());
        if old.get(start..end) != Some(&new[start..end]) {
            match found.last_mut() {
                Some(last) if last[1] == start => last[1] = end,
                _ => found.push([start, end]),
            }
        }
        start = end;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_stretches_that_differ_are_sent_and_neighbours_go_together() {
        let old: Vec<u32> = (0..1000).collect();
        let mut new = old.clone();
        assert!(differing(&old, &new).is_empty());
        new[3] = 7;
        new[64] = 7;
        new[900] = 7;
        assert_eq!(differing(&old, &new), [[0, 128], [896, 960]]);
        new.push(1);
        assert_eq!(differing(&old, &new).last(), Some(&[896, 1001]));
        new.truncate(10);
        assert_eq!(differing(&old, &new), [[0, 10]]);
    }
}
