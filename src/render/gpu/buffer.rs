//! Instances on the card, in pages: a growing list adds pages and is never copied, and only the stretches that changed
//! are sent.

use bytemuck::Pod;

use crate::render::scene::{Placed, STRETCH};

/// Instances per page: a multiple of the stretch.
const PAGE: usize = 512 * STRETCH;

/// A list of instances on the card.
pub(super) struct Patched<T> {
    label: &'static str,
    pages: Vec<wgpu::Buffer>,
    count: usize,
    /// The generation of the list on the card.
    generation: u64,
    /// Bytes sent so far.
    pub sent: u64,
    kind: std::marker::PhantomData<T>,
}

impl<T: Pod + PartialEq> Patched<T> {
    pub fn new(label: &'static str) -> Self {
        Patched { label, pages: Vec::new(), count: 0, generation: 0, sent: 0, kind: std::marker::PhantomData }
    }

    /// Updates the list on the card from `list` of a generation.
    pub fn set(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, list: &Placed<T>, generation: u64) {
        let items = list.items();
        while self.pages.len() < items.len().div_ceil(PAGE) {
            self.pages.push(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
                size: (PAGE * size_of::<T>()) as u64,
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        for [start, end] in list.newer_than(self.generation) {
            let mut from = start;
            while from < end {
                let page = from / PAGE;
                let until = end.min((page + 1) * PAGE);
                let bytes = bytemuck::cast_slice(&items[from..until]);
                queue.write_buffer(&self.pages[page], ((from - page * PAGE) * size_of::<T>()) as u64, bytes);
                self.sent += bytes.len() as u64;
                from = until;
            }
        }
        (self.count, self.generation) = (items.len(), generation);
    }

    /// Draws all instances, six corners each.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        for (k, page) in self.pages.iter().enumerate().take(self.count.div_ceil(PAGE)) {
            pass.set_vertex_buffer(0, page.slice(..));
            pass.draw(0..6, 0..(self.count - k * PAGE).min(PAGE) as u32);
        }
    }
}
