// Faces, lines and dots. Colours are premultiplied sRGB numbers: the target does no conversion.

struct View {
    // The map from positions relative to the anchor to clip space.
    clip: mat4x4<f32>,
    // Size of the view in points.
    size: vec2<f32>,
    // Pixels per point.
    pixels: f32,
    // Points per unit of the mesh.
    scale: f32,
    // The rotation of the mesh.
    turn: mat3x3<f32>,
    // The lighting of surfaces (even, lit, shine), and the opacity of hidden lines.
    light: vec4<f32>,
    // The depth of a screen point, and the smallest shift of lines towards the eye.
    depth: vec4<f32>,
};

// Views are orthographic: w is 1, so that all is interpolated linearly in the picture, as WebGL does it only then.
@group(0) @binding(0) var<uniform> view: View;

fn premultiplied(colour: vec4<f32>, coverage: f32) -> vec4<f32> {
    let alpha = colour.a * coverage;
    return vec4<f32>(colour.rgb * alpha, alpha);
}

// A position outside of clip space.
fn nowhere() -> vec4<f32> {
    return vec4<f32>(2.0, 2.0, 2.0, 1.0);
}

// The corner of an item, anticlockwise from 0. Items have four corners each, one after the other.
fn corner_of(vertex: u32) -> u32 {
    return vertex % 4u;
}

// Whether a corner is at the far end of an item, and whether it is on the left of it.
fn is_far(corner: u32) -> bool {
    return corner == 1u || corner == 2u;
}
fn is_left(corner: u32) -> bool {
    return corner == 2u || corner == 3u;
}

// Items on faces are shifted towards the eye by this many points.
fn pull(points: f32) -> f32 {
    return max(points * view.depth.x, view.depth.y);
}

// ---- faces ----

struct FaceIn {
    @location(0) p0: vec3<f32>,
    @location(1) p1: vec3<f32>,
    @location(2) p2: vec3<f32>,
    @location(3) p3: vec3<f32>,
    @location(4) n0: vec2<f32>,
    @location(5) n1: vec2<f32>,
    @location(6) n2: vec2<f32>,
    @location(7) n3: vec2<f32>,
    @location(8) colour: vec4<f32>,
};

struct FaceOut {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) colour: vec4<f32>,
    @location(1) normal: vec3<f32>,
};

// A normal from the unfolded octahedron.
fn unfolded(n: vec2<f32>) -> vec3<f32> {
    let z = 1.0 - abs(n.x) - abs(n.y);
    let t = max(-z, 0.0);
    return normalize(vec3<f32>(n.x - select(-t, t, n.x >= 0.0), n.y - select(-t, t, n.y >= 0.0), z));
}

@vertex
fn face_vertex(@builtin(vertex_index) k: u32, in: FaceIn) -> FaceOut {
    var out: FaceOut;
    out.colour = in.colour;
    var p = in.p0;
    var n = in.n0;
    let corner = corner_of(k);
    if corner == 1u { p = in.p1; n = in.n1; }
    if corner == 2u { p = in.p2; n = in.n2; }
    if corner == 3u { p = in.p3; n = in.n3; }
    out.position = view.clip * vec4<f32>(p, 1.0);
    out.normal = view.turn * unfolded(n);
    if in.colour.a == 0.0 { out.position = nowhere(); }
    return out;
}

@fragment
fn face_fragment(in: FaceOut) -> @location(0) vec4<f32> {
    // A lamp above and to the left of the eye; back sides are lit from behind, a little less.
    var n = normalize(in.normal);
    let away = n.z < 0.0;
    if away { n = -n; }
    let lamp = normalize(vec3<f32>(-0.35, 0.45, 0.82));
    var light = max(dot(n, lamp), 0.0);
    if away { light *= 0.75; }
    let colour = in.colour.rgb * (view.light.x + view.light.y * light) + vec3<f32>(view.light.z * light);
    return premultiplied(vec4<f32>(min(colour, vec3<f32>(1.0)), in.colour.a), 1.0);
}

// ---- lines ----

struct LineIn {
    @location(0) a: vec3<f32>,
    @location(1) b: vec3<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) width: f32,
    @location(4) dash: vec2<f32>,
    @location(5) room: f32,
};

struct LineOut {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) colour: vec4<f32>,
    // Along and across the line in points, from its first end.
    @location(1) place: vec2<f32>,
    // Length, half width, and the dash.
    @location(2) @interpolate(flat) shape: vec4<f32>,
};

@vertex
fn line_vertex(@builtin(vertex_index) k: u32, in: LineIn) -> LineOut {
    var out: LineOut;
    let a = view.clip * vec4<f32>(in.a, 1.0);
    let b = view.clip * vec4<f32>(in.b, 1.0);
    let half_size = 0.5 * view.size;
    let along = (b.xy - a.xy) * half_size;
    let length = length(along);
    var direction = vec2<f32>(1.0, 0.0);
    if length > 1e-6 { direction = along / length; }
    let across = vec2<f32>(-direction.y, direction.x);
    // One more pixel on all sides for the soft edge. Lines of the mesh end flat, since round ends would show where they
    // overlap.
    let soft = 1.0 / view.pixels;
    let half_width = 0.5 * in.width;
    let cap = select(0.0, half_width + soft, in.room < 0.0);
    let far = is_far(corner_of(k));
    let left = is_left(corner_of(k));
    let x = select(-cap, length + cap, far);
    let y = select(-half_width - soft, half_width + soft, left);
    let end = select(a, b, far);
    let offset = direction * select(-cap, cap, far) + across * y;
    out.position = vec4<f32>(end.xy + offset / half_size, end.z - pull(1.0 + 1.5 * half_width), 1.0);
    out.place = vec2<f32>(x, y);
    out.shape = vec4<f32>(length, half_width, in.dash.x, in.dash.y);
    // Edges fade as their elements become small on the screen: 22 % at a height of 2 points, all of it at 9.
    var shown = 1.0;
    if in.room >= 0.0 {
        let height = in.room * view.scale;
        shown = mix(0.22, 1.0, clamp((height - 2.0) / 7.0, 0.0, 1.0)) * clamp(2.0 * height - 1.0, 0.0, 1.0);
    }
    out.colour = vec4<f32>(in.colour.rgb, in.colour.a * shown);
    if out.colour.a == 0.0 { out.position = nowhere(); }
    return out;
}

@fragment
fn line_fragment(in: LineOut) -> @location(0) vec4<f32> {
    return stroke(in);
}

// The part of a line behind a face.
@fragment
fn hidden_fragment(in: LineOut) -> @location(0) vec4<f32> {
    return stroke(in) * view.light.w;
}

fn stroke(in: LineOut) -> vec4<f32> {
    let length = in.shape.x;
    let beyond = max(max(-in.place.x, in.place.x - length), 0.0);
    let away = length2(vec2<f32>(beyond, in.place.y));
    var coverage = clamp((in.shape.y - away) * view.pixels + 0.5, 0.0, 1.0);
    if in.shape.z > 0.0 {
        let period = in.shape.z + in.shape.w;
        let phase = in.place.x - period * floor(in.place.x / period);
        let off = abs(phase - 0.5 * in.shape.z) - 0.5 * in.shape.z;
        coverage *= clamp(0.5 - off * view.pixels, 0.0, 1.0);
    }
    return premultiplied(in.colour, coverage);
}

fn length2(v: vec2<f32>) -> f32 {
    return sqrt(dot(v, v));
}

// ---- dots ----

struct DotIn {
    @location(0) at: vec3<f32>,
    @location(1) radius: f32,
    @location(2) fill: vec4<f32>,
    @location(3) ring: vec4<f32>,
    @location(4) ring_width: f32,
    @location(5) room: f32,
    @location(6) least: f32,
};

struct DotOut {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) fill: vec4<f32>,
    @location(1) @interpolate(flat) ring: vec4<f32>,
    @location(2) place: vec2<f32>,
    // Radius and width of the ring.
    @location(3) @interpolate(flat) shape: vec2<f32>,
};

@vertex
fn dot_vertex(@builtin(vertex_index) k: u32, in: DotIn) -> DotOut {
    var out: DotOut;
    let x = select(-1.0, 1.0, is_far(corner_of(k)));
    let y = select(-1.0, 1.0, is_left(corner_of(k)));
    let room = in.room * view.scale;
    // Dots shrink when the view zooms out.
    let radius = in.radius * select(mix(0.6, 1.0, clamp((room - 6.0) / 8.0, 0.0, 1.0)), 1.0, in.least == 0.0);
    let reach = radius + 1.0 / view.pixels;
    let centre = view.clip * vec4<f32>(in.at, 1.0);
    out.place = vec2<f32>(x, y) * reach;
    out.position = vec4<f32>(centre.xy + out.place / (0.5 * view.size), centre.z - pull(2.0 + 1.5 * radius), 1.0);
    out.fill = in.fill;
    out.ring = in.ring;
    out.shape = vec2<f32>(radius, in.ring_width);
    if room < in.least { out.position = nowhere(); }
    return out;
}

@fragment
fn dot_fragment(in: DotOut) -> @location(0) vec4<f32> {
    let away = length2(in.place);
    let outer = clamp((in.shape.x - away) * view.pixels + 0.5, 0.0, 1.0);
    let inner = clamp((in.shape.x - in.shape.y - away) * view.pixels + 0.5, 0.0, 1.0);
    let ring = premultiplied(in.ring, outer * (1.0 - inner));
    let fill = premultiplied(in.fill, inner);
    return ring + fill;
}
