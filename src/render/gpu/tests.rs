use glam::DVec2;

use super::*;
use crate::render::palette::DARK;

/// A device without a window; `None`, with the reason printed, on a machine without any adapter. Where
/// `QUADFRONT_NEEDS_ADAPTER` is set, its absence is an error.
fn device() -> Option<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    match adapter {
        Ok(adapter) => {
            let made = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()));
            Some(made.unwrap())
        }
        Err(error) => {
            assert!(std::env::var_os("QUADFRONT_NEEDS_ADAPTER").is_none(), "no graphics adapter: {error}");
            println!("skipped: there is no graphics adapter ({error})");
            None
        }
    }
}

fn pixels(painter: &mut Painter, device: &wgpu::Device, queue: &wgpu::Queue, view: &View, scene: &Scene) -> Vec<u8> {
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    painter.draw(device, queue, &mut encoder, 0, view, scene);
    queue.submit([encoder.finish()]);
    read_back(device, queue, painter.picture(0).unwrap()).unwrap()
}

fn scene() -> Scene {
    let face = |y: f32, colour: Rgba| Face {
        corners: [[-1.0, y, 0.0], [1.0, y, 0.0], [1.0, y + 0.5, 0.0], [-1.0, y + 0.5, 0.0]],
        colour: colour.packed(),
    };
    let line = |x: f32, dash: [f32; 2], room: f32| Line {
        ends: [[x, -1.0, 0.0], [x, 1.0, 0.0]],
        colour: DARK.base.packed(),
        width: 5.0,
        dash,
        room,
    };
    let mut scene = Scene::default();
    scene.faces.replace(&[face(-1.0, DARK.dead), face(0.0, DARK.live)], 1);
    scene.over.replace(&[line(0.0, [0.0; 2], -1.0), line(0.5, [7.0, 5.0], -1.0), line(-0.5, [0.0; 2], 0.001)], 1);
    let fill = DARK.selection.packed();
    scene.over_dots.replace(&[Dot { at: [-0.8, 0.8, 0.0], radius: 5.0, fill, ..Dot::default() }], 1);
    scene.generation = 1;
    scene
}

fn view() -> View {
    let camera = Camera::fit([-DVec2::ONE, DVec2::ONE], DVec2::splat(100.0), 0.0);
    View { camera, size: DVec2::splat(100.0), pixels: 1.0, ground: DARK.ground }
}

#[test]
fn shaders_are_valid_and_their_inputs_are_those_of_the_instances() {
    for text in [pipelines::MESH, pipelines::BLIT] {
        let module = wgpu::naga::front::wgsl::parse_str(text).unwrap();
        let mut validator = wgpu::naga::valid::Validator::new(
            wgpu::naga::valid::ValidationFlags::all(),
            wgpu::naga::valid::Capabilities::empty(),
        );
        validator.validate(&module).unwrap();
    }
    let size = |formats: &[wgpu::VertexFormat]| formats.iter().map(wgpu::VertexFormat::size).sum::<u64>() as usize;
    assert_eq!(size(&pipelines::FACE), size_of::<Face>());
    assert_eq!(size(&pipelines::LINE), size_of::<Line>());
    assert_eq!(size(&pipelines::DOT), size_of::<Dot>());
}

#[test]
fn faces_lines_and_dots_are_where_they_should_be() {
    let Some((device, queue)) = device() else { return };
    for samples in [1, 4] {
        let mut painter = Painter::new(&device, wgpu::TextureFormat::Rgba8Unorm, samples);
        looks_right(&pixels(&mut painter, &device, &queue, &view(), &scene()));
    }
}

fn looks_right(bytes: &[u8]) {
    let at = |x: usize, y: usize| Rgba(bytes[4 * (100 * y + x)..][..4].try_into().unwrap());
    assert_eq!(at(20, 90), DARK.dead);
    assert_eq!(at(20, 40), DARK.live);
    assert_eq!(at(80, 10), DARK.ground);
    assert_eq!((at(50, 60), at(48, 60), at(51, 60)), (DARK.base, DARK.base, DARK.base));
    assert_eq!(at(56, 60), DARK.ground, "a line has its width");
    assert_eq!(at(10, 10), DARK.selection);
    let dashed: Vec<bool> = (20..80).map(|y| at(75, y) == DARK.base).collect();
    assert!(dashed.contains(&true) && dashed.contains(&false), "a dashed line has gaps");
    assert_eq!(at(25, 60), DARK.ground, "an edge without room has faded away");
}

#[test]
fn a_view_that_has_not_changed_sends_and_draws_nothing() {
    let Some((device, queue)) = device() else { return };
    let mut painter = Painter::new(&device, wgpu::TextureFormat::Rgba8Unorm, 4);
    let mut scene = scene();
    let before = pixels(&mut painter, &device, &queue, &view(), &scene);
    let sent = painter.bytes_sent();
    assert_eq!(pixels(&mut painter, &device, &queue, &view(), &scene), before);
    assert_eq!(painter.bytes_sent(), sent);
    let white = Line { colour: DARK.selection.packed(), ..scene.over.items()[0] };
    scene.over.set(0, white, 2);
    scene.generation += 1;
    assert_ne!(pixels(&mut painter, &device, &queue, &view(), &scene), before);
    assert_eq!(painter.bytes_sent() - sent, size_of_val(scene.over.items()) as u64);
}
