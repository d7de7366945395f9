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
        ..Face::default()
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
    View { camera, size: DVec2::splat(100.0), pixels: 1.0, ground: DARK.ground, light: Light::NONE, hidden: 0.0 }
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
    for on_software in [true, false] {
        let mut painter = Painter::new(&device, wgpu::TextureFormat::Rgba8Unorm, on_software);
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

/// The window's scene of a whole sphere, of whose lines only the near or the far half is drawn.
#[test]
fn the_far_side_of_a_sphere_is_hidden_but_for_hidden_lines() {
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::{history::History, run::Run};
    use crate::render::camera::Bearing;
    use crate::render::scene::{Drawn, Form, Layers, Shading};
    use glam::DVec3;

    let Some((device, queue)) = device() else { return };
    let mut case = built_in::named("sphere").unwrap().unwrap();
    case.parameters.size_scale = 2.0;
    let history = History::open(Run::of(case), &mut Nobody).unwrap();
    let mesh = &history.state().mesh;
    let camera =
        Camera::fit_in_space(mesh.nodes().map(|n| mesh.xyz(n)), Bearing::Iso.turn(), DVec2::splat(300.0), 20.0);
    for form in [Form::Flat, Form::Curved] {
        for on_software in [true, false] {
            let draw = |half: f32, hidden: f32| {
                let mut painter = Painter::new(&device, wgpu::TextureFormat::Rgba8Unorm, on_software);
                let mut scene = Scene::default();
                let (shading, layers) = (Shading::default(), Layers::default());
                let drawn = Drawn { mesh, changed: &[], shading: &shading, layers, palette: &DARK, form };
                scene.set_mesh(&drawn, DVec3::ZERO);
                // Only one half of the lines is drawn: that before the middle, or that behind it.
                let mut lines = scene.edges.items().to_vec();
                let towards = camera.towards().as_vec3();
                let middle = camera.centre.as_vec3();
                let radius = 0.5 * (300.0 - 40.0) / camera.scale as f32;
                for line in &mut lines {
                    let depth = line.ends.map(|p| (glam::Vec3::from_array(p) - middle).dot(towards) / radius);
                    let shown = depth.iter().all(|z| z * half > 0.3);
                    (line.colour, line.width) = (if shown { DARK.base.packed() } else { 0 }, 2.0);
                    line.room = -1.0;
                }
                scene.edges.replace(&lines, 2);
                scene.dots.replace(&[], 2);
                scene.boundary.replace(&[], 2);
                scene.generation = 2;
                let light = Light::on_surfaces(true);
                let view = View { camera, size: DVec2::splat(300.0), light, hidden, ..view() };
                let bytes = pixels(&mut painter, &device, &queue, &view, &scene);
                let [r, g, b, _] = DARK.base.0.map(i32::from);
                let near =
                    |p: &[u8]| (i32::from(p[0]) - r).abs() + (i32::from(p[1]) - g).abs() + (i32::from(p[2]) - b).abs();
                bytes.chunks(4).filter(|p| near(p) < 60).count()
            };
            let (front, back) = (draw(1.0, 0.0), draw(-1.0, 0.0));
            assert!(front > 3000, "the near half is drawn: {front}");
            assert_eq!(back, 0, "{form:?} {on_software}: nothing of the far half is");
            assert!(draw(-1.0, 1.0) > 3000, "but for hidden lines");
        }
    }
}

#[test]
fn a_view_that_has_not_changed_sends_and_draws_nothing() {
    let Some((device, queue)) = device() else { return };
    let mut painter = Painter::new(&device, wgpu::TextureFormat::Rgba8Unorm, false);
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
