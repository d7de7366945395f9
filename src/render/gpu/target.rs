//! Render targets of views, and reading their pixels back.

use super::Uniform;
use super::pipelines::{COLOUR, DEPTH, Pipelines};
use crate::core::fault::Fault;
use crate::render::palette::Rgba;

/// The textures and bind groups of one view.
pub(super) struct Target {
    pub size: [u32; 2],
    pub uniform: wgpu::Buffer,
    pub view_group: wgpu::BindGroup,
    pub blit_group: wgpu::BindGroup,
    /// The finished picture, one sample per pixel.
    pub picture: wgpu::Texture,
    finished: wgpu::TextureView,
    /// The multisampled picture, where there are several samples per pixel.
    samples: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    /// The state that the picture shows.
    pub drawn: Option<(usize, u64, Uniform, Rgba)>,
}

impl Target {
    pub fn new(device: &wgpu::Device, pipelines: &Pipelines, size: [u32; 2]) -> Target {
        let texture = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let picture = texture("picture", COLOUR, 1, attachment | read);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let finished = view(&picture);
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<Uniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view"),
            layout: &pipelines.view_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor::default());
        let blit_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &pipelines.blit_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&finished) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
            ],
        });
        Target {
            size,
            uniform,
            view_group,
            blit_group,
            samples: (pipelines.samples > 1).then(|| view(&texture("samples", COLOUR, pipelines.samples, attachment))),
            depth: view(&texture("depth", DEPTH, pipelines.samples, attachment)),
            picture,
            finished,
            drawn: None,
        }
    }

    /// Begins drawing on a cleared target.
    pub fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, ground: wgpu::Color) -> wgpu::RenderPass<'e> {
        let (view, resolve_target, store) = match &self.samples {
            Some(samples) => (samples, Some(&self.finished), wgpu::StoreOp::Discard),
            None => (&self.finished, None, wgpu::StoreOp::Store),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mesh"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(ground), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }
}

/// The pixels of a picture, row by row from the top, four bytes each.
///
/// # Errors
/// The device was lost.
pub fn read_back(device: &wgpu::Device, queue: &wgpu::Queue, picture: &wgpu::Texture) -> Result<Vec<u8>, Fault> {
    let lost = |what: String| Fault::new(format!("The picture cannot be read back: {what}"));
    let (width, height) = (picture.width(), picture.height());
    let row = 4 * width;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("pixels"),
        size: u64::from(padded) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        picture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    // Sending fails only if this function has already returned.
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |mapped| drop(sender.send(mapped)));
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| lost(error.to_string()))?;
    let mapped = receiver.recv().map_err(|error| lost(error.to_string()))?;
    mapped.map_err(|error| lost(error.to_string()))?;
    let bytes = buffer.slice(..).get_mapped_range().map_err(|error| lost(error.to_string()))?;
    let rows = bytes.chunks(padded as usize).flat_map(|bytes| &bytes[..row as usize]);
    Ok(rows.copied().collect())
}
