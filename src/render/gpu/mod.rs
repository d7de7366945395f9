//! Draws a scene with the graphics card: into a texture with depth and four samples per pixel, which is then copied to
//! the window. A view whose scene and camera did not change is not drawn again. On a software renderer one sample is
//! enough: lines and dots have their own soft edges, and faces end under lines.

mod buffer;
mod pipelines;
mod target;

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use self::buffer::{Corners, Patched};
use self::pipelines::Pipelines;
use self::target::Target;
use super::camera::Camera;
use super::palette::Rgba;
use super::scene::{Dot, Face, Form, Line, Scene};

pub use self::target::read_back;

/// Whether an adapter draws by software.
pub fn is_software(adapter: &wgpu::AdapterInfo) -> bool {
    adapter.device_type == wgpu::DeviceType::Cpu
}

/// How to draw a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Its camera.
    pub camera: Camera,
    /// Its size in points.
    pub size: DVec2,
    /// Pixels per point.
    pub pixels: f32,
    /// Background colour.
    pub ground: Rgba,
    /// How surfaces are lit.
    pub light: Light,
    /// The opacity of hidden lines, 0 to 1.
    pub hidden: f32,
}

/// The lighting of surfaces by a lamp beside the eye: the colour times `even`, plus the colour times `lit` and plain
/// `shine` (which dark colours need), both scaled by the angle to the lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The factor in the shadow.
    pub even: f32,
    /// The factor added towards the lamp.
    pub lit: f32,
    /// The light added towards the lamp.
    pub shine: f32,
}

impl Light {
    /// Unlit colours, for the plane.
    pub const NONE: Light = Light { even: 1.0, lit: 0.0, shine: 0.0 };
    /// The light of surfaces whose colours are read off a scale: it changes their lightness so little that they are not
    /// taken for others.
    pub const ON_DATA: Light = Light { even: 0.9, lit: 0.12, shine: 0.0 };

    /// For surfaces, in the dark or light theme. Edges between elements are seen in the shadow and towards the lamp.
    pub fn on_surfaces(dark: bool) -> Light {
        if dark { Light { even: 0.62, lit: 0.7, shine: 0.09 } } else { Light { even: 0.87, lit: 0.14, shine: 0.0 } }
    }
}

impl View {
    /// Its size in pixels, at least one and at most the limit of the card.
    pub fn size_in_pixels(&self, most: u32) -> [u32; 2] {
        let pixels = |points: f64| ((points * f64::from(self.pixels)).round() as u32).clamp(1, most);
        [pixels(self.size.x), pixels(self.size.y)]
    }
}

/// The uniforms of a view.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct Uniform {
    clip: [[f32; 4]; 4],
    size: [f32; 2],
    pixels: f32,
    scale: f32,
    turn: [[f32; 4]; 3],
    /// Even, lit and shine; the opacity of hidden lines.
    light: [f32; 4],
    /// The depth of a screen point, and the smallest shift of lines towards the eye.
    depth: [f32; 4],
}

/// Lines lie on faces: they are shifted towards the eye by at least this much depth.
const LEAST_PULL: f32 = 1e-6;

/// How many views of a run there are: view k shows run k / `VIEWS`.
pub const VIEWS: usize = 4;

/// Draws a scene in the plane, one in space and one of an imported surface into any number of views.
pub struct Painter {
    pipelines: Pipelines,
    /// For each run: in the plane, in space, and as given.
    lists: Vec<[Lists; 3]>,
    targets: Vec<Option<Target>>,
    most: u32,
}

/// A scene on the card.
struct Lists {
    faces: Patched<Face>,
    edges: Patched<Line>,
    dots: Patched<Dot>,
    under: Patched<Line>,
    boundary: Patched<Line>,
    over: Patched<Line>,
    over_dots: Patched<Dot>,
    generation: Option<u64>,
}

impl Lists {
    fn new() -> Lists {
        Lists {
            faces: Patched::new("faces"),
            edges: Patched::new("edges"),
            dots: Patched::new("dots"),
            under: Patched::new("lines under the boundary"),
            boundary: Patched::new("boundary"),
            over: Patched::new("lines over the mesh"),
            over_dots: Patched::new("dots over the mesh"),
            generation: None,
        }
    }

    /// Sends the changes to the card.
    fn set(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, corners: &Corners, scene: &Scene) {
        let generation = scene.generation;
        if self.generation.replace(generation) == Some(generation) {
            return;
        }
        self.faces.set(device, queue, corners, &scene.faces, generation);
        self.edges.set(device, queue, corners, &scene.edges, generation);
        self.dots.set(device, queue, corners, &scene.dots, generation);
        self.under.set(device, queue, corners, &scene.under, generation);
        self.boundary.set(device, queue, corners, &scene.boundary, generation);
        self.over.set(device, queue, corners, &scene.over, generation);
        self.over_dots.set(device, queue, corners, &scene.over_dots, generation);
    }

    fn lines(&self) -> [&Patched<Line>; 4] {
        [&self.edges, &self.under, &self.boundary, &self.over]
    }

    fn sent(&self) -> u64 {
        let lines: u64 = self.lines().iter().map(|lines| lines.sent).sum();
        self.faces.sent + lines + self.dots.sent + self.over_dots.sent
    }
}

impl Painter {
    /// A painter for targets of the format `window`, on a software renderer or on a graphics card.
    pub fn new(device: &wgpu::Device, window: wgpu::TextureFormat, on_software: bool) -> Painter {
        Painter {
            pipelines: Pipelines::new(device, window, on_software),
            lists: Vec::new(),
            targets: Vec::new(),
            most: device.limits().max_texture_dimension_2d,
        }
    }

    /// Sends the changes of the scene, and draws view number `index` if its picture is not up to date. The views of a
    /// run are numbered one after another and share its scenes: see [`VIEWS`].
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        index: usize,
        view: &View,
        scene: &Scene,
    ) {
        let which = match scene.form() {
            Form::Plane => 0,
            Form::Flat | Form::Curved => 1,
            Form::Given => 2,
        };
        let run = index / VIEWS;
        while self.lists.len() <= run {
            self.lists.push([Lists::new(), Lists::new(), Lists::new()]);
        }
        let lists = &mut self.lists[run][which];
        lists.set(device, queue, &self.pipelines.corners, scene);
        if self.targets.len() <= index {
            self.targets.resize_with(index + 1, || None);
        }
        let size = view.size_in_pixels(self.most);
        let slot = &mut self.targets[index];
        let target = match slot {
            Some(target) if target.size == size => target,
            _ => slot.insert(Target::new(device, &self.pipelines, size)),
        };
        let uniform = Uniform {
            clip: view.camera.clip(scene.anchor, view.size).to_cols_array_2d(),
            size: view.size.as_vec2().to_array(),
            pixels: view.pixels,
            scale: view.camera.points_per_unit() as f32,
            turn: glam::DMat3::from_quat(view.camera.turn).as_mat3().to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0]),
            light: [view.light.even, view.light.lit, view.light.shine, view.hidden],
            depth: [view.camera.depth_of_point() as f32, LEAST_PULL, 0.0, 0.0],
        };
        let drawn = (which, scene.generation, uniform, view.ground);
        if target.drawn == Some(drawn) {
            return;
        }
        target.drawn = Some(drawn);
        queue.write_buffer(&target.uniform, 0, bytemuck::bytes_of(&uniform));
        let [r, g, b, _] = view.ground.0.map(|c| f64::from(c) / 255.0);
        let mut pass = target.begin(encoder, wgpu::Color { r, g, b, a: 1.0 });
        let corners = &self.pipelines.corners;
        corners.bind(&mut pass);
        pass.set_bind_group(0, &target.view_group, &[]);
        pass.set_pipeline(&self.pipelines.faces);
        lists.faces.draw(&mut pass, corners);
        if view.hidden > 0.0 {
            pass.set_pipeline(&self.pipelines.hidden);
            lists.lines().iter().for_each(|lines| lines.draw(&mut pass, corners));
        }
        pass.set_pipeline(&self.pipelines.lines);
        lists.lines().iter().for_each(|lines| lines.draw(&mut pass, corners));
        pass.set_pipeline(&self.pipelines.dots);
        for dots in [&lists.dots, &lists.over_dots] {
            dots.draw(&mut pass, corners);
        }
    }

    /// Draws the picture of a view in the pass of the window, whose viewport must be that of the view.
    pub fn lay(&self, index: usize, pass: &mut wgpu::RenderPass<'_>) {
        let Some(Some(target)) = self.targets.get(index) else { return };
        pass.set_pipeline(&self.pipelines.blit);
        pass.set_bind_group(0, &target.blit_group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// The finished picture of a view, if it was drawn.
    pub fn picture(&self, index: usize) -> Option<&wgpu::Texture> {
        self.targets.get(index)?.as_ref().map(|target| &target.picture)
    }

    /// Bytes sent to the card for the scene's lists since the painter was made.
    pub fn bytes_sent(&self) -> u64 {
        self.lists.iter().flatten().map(Lists::sent).sum()
    }
}

#[cfg(test)]
mod tests;
