//! Items on the card, in pages: a growing list adds pages and is never copied, and only the stretches that changed
//! are sent.
//!
//! A graphics card draws them as instances of one quadrilateral, so that an item is sent once. A software renderer
//! sets out for each instance as if it were a call of its own (SwiftShader: some 10 µs for a line): for it an item
//! is sent once for each of its corners, and a page is drawn as one list of triangles.

use std::borrow::Cow;

use bytemuck::Pod;
use wgpu::util::DeviceExt;

use crate::render::scene::{Placed, STRETCH};

/// Items per page: a multiple of the stretch.
const PAGE: usize = 512 * STRETCH;

/// Corners of an item.
const CORNERS: usize = 4;

/// The corners of the two triangles of an item.
const TRIANGLES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// The triangles of the items of a page, or of one instance.
pub(super) struct Corners {
    indices: wgpu::Buffer,
    /// How often an item is sent: once, or once for each corner.
    copies: usize,
}

impl Corners {
    /// For items that are instances, or not.
    pub fn new(device: &wgpu::Device, as_instances: bool) -> Corners {
        let items = if as_instances { 1 } else { PAGE as u32 };
        let indices: Vec<u32> = (0..items).flat_map(|item| TRIANGLES.map(|k| item * CORNERS as u32 + k)).collect();
        Corners {
            indices: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("corners"),
                contents: bytemuck::cast_slice(&indices),
                usage: wgpu::BufferUsages::INDEX,
            }),
            copies: if as_instances { 1 } else { CORNERS },
        }
    }

    /// The items as they are sent.
    fn sent<'t, T: Pod>(&self, items: &'t [T]) -> Cow<'t, [T]> {
        match self.copies {
            1 => Cow::Borrowed(items),
            copies => items.iter().flat_map(|item| std::iter::repeat_n(*item, copies)).collect(),
        }
    }

    /// Has the lists drawn by these triangles from now on.
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

/// A list of items on the card.
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
    pub fn set(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        corners: &Corners,
        list: &Placed<T>,
        generation: u64,
    ) {
        let items = list.items();
        let size = corners.copies * size_of::<T>();
        while self.pages.len() < items.len().div_ceil(PAGE) {
            self.pages.push(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
                size: (PAGE * size) as u64,
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        for [start, end] in list.newer_than(self.generation) {
            let mut from = start;
            while from < end {
                let page = from / PAGE;
                let until = end.min((page + 1) * PAGE);
                let sent = corners.sent(&items[from..until]);
                let bytes = bytemuck::cast_slice(&sent);
                queue.write_buffer(&self.pages[page], ((from - page * PAGE) * size) as u64, bytes);
                self.sent += bytes.len() as u64;
                from = until;
            }
        }
        (self.count, self.generation) = (items.len(), generation);
    }

    /// Draws all items, in a pass in which `corners` are bound.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, corners: &Corners) {
        for (k, page) in self.pages.iter().enumerate().take(self.count.div_ceil(PAGE)) {
            pass.set_vertex_buffer(0, page.slice(..));
            let items = (self.count - k * PAGE).min(PAGE) as u32;
            let drawn = TRIANGLES.len() as u32;
            match corners.copies {
                1 => pass.draw_indexed(0..drawn, 0, 0..items),
                _ => pass.draw_indexed(0..drawn * items, 0, 0..1),
            }
        }
    }
}
