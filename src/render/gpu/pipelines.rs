//! Shaders and pipelines.

use super::super::scene::{Dot, Face, Line};
use super::buffer::Corners;
use wgpu::VertexFormat::{Float32, Float32x2, Float32x3, Snorm16x2, Unorm8x4};

/// Shaders for the mesh and for drawing pictures in the window.
pub(super) const MESH: &str = include_str!("mesh.wgsl");
pub(super) const BLIT: &str = include_str!("blit.wgsl");

/// Colours stay in sRGB without conversion, so that blending looks as in vector figures.
pub(super) const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Attributes of the instances, in the order of their fields.
pub(super) const FACE: [wgpu::VertexFormat; 9] =
    [Float32x3, Float32x3, Float32x3, Float32x3, Snorm16x2, Snorm16x2, Snorm16x2, Snorm16x2, Unorm8x4];
pub(super) const LINE: [wgpu::VertexFormat; 6] = [Float32x3, Float32x3, Unorm8x4, Float32, Float32x2, Float32];
pub(super) const DOT: [wgpu::VertexFormat; 7] = [Float32x3, Float32, Unorm8x4, Unorm8x4, Float32, Float32, Float32];

pub(super) struct Pipelines {
    /// Samples per pixel.
    pub samples: u32,
    /// The corners of the items that are drawn.
    pub corners: Corners,
    pub faces: wgpu::RenderPipeline,
    pub lines: wgpu::RenderPipeline,
    /// The hidden parts of lines.
    pub hidden: wgpu::RenderPipeline,
    pub dots: wgpu::RenderPipeline,
    pub blit: wgpu::RenderPipeline,
    pub view_layout: wgpu::BindGroupLayout,
    pub blit_layout: wgpu::BindGroupLayout,
}

impl Pipelines {
    /// For a software renderer, or for a graphics card.
    pub fn new(device: &wgpu::Device, window: wgpu::TextureFormat, on_software: bool) -> Pipelines {
        let module = |label, text: &'static str| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(text.into()),
            })
        };
        let (mesh, blit) = (module("mesh", MESH), module("blit", BLIT));
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("view"),
            entries: &[entry(
                0,
                wgpu::ShaderStages::VERTEX_FRAGMENT,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
            )],
        });
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let blit_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("picture"),
            entries: &[
                entry(0, wgpu::ShaderStages::FRAGMENT, texture),
                entry(1, wgpu::ShaderStages::FRAGMENT, sampler),
            ],
        });
        let samples = if on_software { 1 } else { 4 };
        let step = if on_software { wgpu::VertexStepMode::Vertex } else { wgpu::VertexStepMode::Instance };
        let over_mesh = |name, formats: &[wgpu::VertexFormat], size, writes_depth| {
            let seen = Pass { writes_depth, compare: wgpu::CompareFunction::LessEqual, fragment: name };
            mesh_pipeline(device, &view_layout, &mesh, name, formats, size, seen, samples, step)
        };
        let covered = Pass { writes_depth: false, compare: wgpu::CompareFunction::Greater, fragment: "hidden" };
        let hidden =
            mesh_pipeline(device, &view_layout, &mesh, "line", &LINE, size_of::<Line>(), covered, samples, step);
        Pipelines {
            samples,
            corners: Corners::new(device, !on_software),
            faces: over_mesh("face", &FACE, size_of::<Face>(), true),
            lines: over_mesh("line", &LINE, size_of::<Line>(), false),
            hidden,
            dots: over_mesh("dot", &DOT, size_of::<Dot>(), false),
            blit: blit_pipeline(device, &blit_layout, &blit, window),
            view_layout,
            blit_layout,
        }
    }
}

fn entry(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn layout(device: &wgpu::Device, group: &wgpu::BindGroupLayout) -> wgpu::PipelineLayout {
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(group)],
        immediate_size: 0,
    })
}

/// The attributes of an instance whose fields have these formats, one after the other.
fn attributes(formats: &[wgpu::VertexFormat]) -> Vec<wgpu::VertexAttribute> {
    let mut offset = 0;
    let attribute = |(location, format): (usize, &wgpu::VertexFormat)| {
        let attribute = wgpu::VertexAttribute { format: *format, offset, shader_location: location as u32 };
        offset += format.size();
        attribute
    };
    formats.iter().enumerate().map(attribute).collect()
}

/// The depth test of a pipeline, and the shader that colours its pixels.
struct Pass {
    writes_depth: bool,
    compare: wgpu::CompareFunction,
    fragment: &'static str,
}

fn mesh_pipeline(
    device: &wgpu::Device,
    group: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
    name: &str,
    formats: &[wgpu::VertexFormat],
    size: usize,
    pass: Pass,
    samples: u32,
    step_mode: wgpu::VertexStepMode,
) -> wgpu::RenderPipeline {
    let attributes = attributes(formats);
    debug_assert_eq!(formats.iter().map(wgpu::VertexFormat::size).sum::<u64>(), size as u64, "{name}");
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: Some(&layout(device, group)),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(&format!("{name}_vertex")),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size as u64,
                step_mode,
                attributes: &attributes,
            })],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(pass.writes_depth),
            depth_compare: Some(pass.compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(&format!("{}_fragment", pass.fragment)),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOUR,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn blit_pipeline(
    device: &wgpu::Device,
    group: &wgpu::BindGroupLayout,
    module: &wgpu::ShaderModule,
    window: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("blit"),
        layout: Some(&layout(device, group)),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("blit_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("blit_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(window.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
