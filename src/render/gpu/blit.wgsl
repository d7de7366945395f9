// Copies the finished picture of a view to the window, pixel by pixel.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var nearest: sampler;

struct Out {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
};

@vertex
fn blit_vertex(@builtin(vertex_index) k: u32) -> Out {
    var out: Out;
    let corner = vec2<f32>(f32((k << 1u) & 2u), f32(k & 2u));
    out.position = vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
    out.place = vec2<f32>(corner.x, 1.0 - corner.y);
    return out;
}

@fragment
fn blit_fragment(in: Out) -> @location(0) vec4<f32> {
    return textureSample(picture, nearest, in.place);
}
