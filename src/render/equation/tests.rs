use super::*;
use crate::core::lesson::built_in;

/// A font whose letters are six tenths of its size wide, or five tenths where they are italic. Brackets alone are below
/// the line.
struct Plain;

impl Measure for Plain {
    fn extent(&self, text: &str, face: Face, size: f32) -> Extent {
        let letter = if face == Face::Italic { 0.5 } else { 0.6 };
        if "()[]{}|".contains(text) {
            return Extent { width: letter * size, above: 0.76 * size, below: 0.14 * size };
        }
        let above = if text.chars().all(|c| matches!(c, '+' | '−' | '=' | '·')) { 0.5 } else { 0.7 };
        Extent { width: letter * size * text.chars().count() as f32, above: above * size, below: 0.0 }
    }
}

fn drawn(tex: &str, size: f32) -> Drawing {
    Drawing::of(&Equation::parse(tex).map_err(|(fault, _)| fault).unwrap(), size, &Plain)
}

/// The text that reads so.
fn find<'d>(drawing: &'d Drawing, text: &str) -> &'d Text {
    drawing.texts.iter().find(|t| t.text == text).unwrap_or_else(|| panic!("{text} in {drawing:?}"))
}

fn is_near(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-3
}

#[test]
fn the_width_of_a_row_is_that_of_its_letters_and_the_room_of_the_texbook() {
    for (tex, letters, eighteenths) in [
        ("ab", 1.0, 0.0),
        ("a = b", 1.6, 10.0),
        ("a + b", 1.6, 8.0),
        ("-a", 1.1, 0.0),
        ("a = -b", 2.2, 10.0),
        ("a, b", 1.6, 3.0),
        ("(a)", 1.7, 0.0),
        (r"\sin a", 2.3, 3.0),
        (r"\max(a)", 3.5, 0.0),
        (r"a\,b", 1.0, 3.0),
        (r"a\quad b", 1.0, 18.0),
        ("|a| < 1", 2.9, 10.0),
        (r"\text{one two}", 4.2, 0.0),
        ("12.5", 2.4, 0.0),
    ] {
        for size in [17.0, 40.0] {
            let width = drawn(tex, size).extent.width;
            assert!(is_near(width, (letters + eighteenths / 18.0) * size), "{tex} at {size}: {width}");
        }
    }
}

#[test]
fn a_fraction_is_centred_about_a_bar_on_the_axis() {
    let drawing = drawn(r"\frac{a+b}{2}", 20.0);
    let [bar] = drawing.bars[..] else { panic!("{drawing:?}") };
    assert!(is_near(bar.at[1], -AXIS * 20.0));
    let (a, b, two) = (find(&drawing, "a"), find(&drawing, "b"), find(&drawing, "2"));
    let middle = bar.at[0] + 0.5 * bar.length;
    assert!(is_near(0.5 * (a.at[0] + b.at[0] + b.extent.width), middle));
    assert!(is_near(two.at[0] + 0.5 * two.extent.width, middle));
    // Numerators stand above the bar, denominators below it, with room.
    assert!(a.at[1] < bar.at[1] - 2.0 && is_near(a.at[1], b.at[1]));
    assert!(two.at[1] - two.extent.above > bar.at[1] + 2.0);
    assert!(a.at[0] > bar.at[0] && b.at[0] + b.extent.width < bar.at[0] + bar.length);
    assert_eq!((a.size, two.size), (20.0, 20.0), "a fraction that stands by itself is not smaller");
    let nested = drawn(r"\frac{\frac{1}{3}}{2}", 20.0);
    assert!(find(&nested, "3").size < 20.0);
}

#[test]
fn scripts_are_smaller_beside_their_base_and_limits_stand_below_and_above_it() {
    let drawing = drawn("x_1^2", 20.0);
    let (x, low, high) = (find(&drawing, "x"), find(&drawing, "1"), find(&drawing, "2"));
    assert!(low.size == high.size && low.size < x.size);
    assert!(is_near(low.at[0], x.extent.width) && is_near(high.at[0], x.extent.width));
    assert!(low.at[1] > 0.0 && high.at[1] < 0.0);
    assert!(high.at[1] + 1.0 <= low.at[1] - low.extent.above, "room between both");
    let sum = drawn(r"\sum_{i=1}^N a", 20.0);
    let (sign, low, high, a) = (find(&sum, "∑"), find(&sum, "i"), find(&sum, "N"), find(&sum, "a"));
    assert!(low.at[1] - low.extent.above > sign.at[1] && high.at[1] < sign.at[1] - sign.extent.above);
    assert!(is_near(high.at[0] + 0.5 * high.extent.width, sign.at[0] + 0.5 * sign.extent.width));
    assert!(sign.size > a.size && a.at[0] > sign.at[0] + sign.extent.width);
    // The sum stands in the middle of the line.
    assert!(is_near(0.5 * (2.0 * sign.at[1] - sign.extent.above), -AXIS * 20.0));
    // Where room is short, limits are scripts.
    let tight = drawn(r"\frac{\sum_{i=1}^N a}{2}", 20.0);
    assert!(find(&tight, "i").at[0] >= find(&tight, "∑").at[0] + find(&tight, "∑").extent.width);
    // The sign of degrees is raised already.
    let degrees = drawn(r"90^\circ", 20.0);
    assert_eq!((find(&degrees, "°").at[1], find(&degrees, "°").size), (0.0, 20.0));
}

#[test]
fn roots_and_brackets_cover_what_they_hold() {
    for tex in ["x", r"\frac{1}{2}", "x_1^2", r"\sqrt{\sqrt{y}}"] {
        let (bare, root) = (drawn(tex, 20.0), drawn(&format!(r"\sqrt{{{tex}}}"), 20.0));
        assert!(root.extent.above > bare.extent.above && root.extent.below >= bare.extent.below);
        assert!(root.extent.width > bare.extent.width && root.strokes.len() == bare.strokes.len() + 2);
    }
    let small = drawn(r"\left( x \right)", 20.0);
    assert!(small.strokes.is_empty() && small.texts.len() == 3, "the font's brackets are high enough: {small:?}");
    for fences in ["()", "[]", "||"] {
        let (open, close) = fences.split_at(1);
        let grown = drawn(&format!(r"\left{open} \frac{{\frac{{1}}{{2}}}}{{3}} \right{close}"), 20.0);
        let [left, right] = [0, 1].map(|k| &grown.strokes[k].points);
        let height = |points: &[[f32; 2]]| {
            points.iter().map(|p| p[1]).fold(f32::MIN, f32::max) - points.iter().map(|p| p[1]).fold(f32::MAX, f32::min)
        };
        assert!(height(left) > 30.0 && is_near(height(left), height(right)));
        // Both are mirrored about the middle of the whole.
        for (p, q) in left.iter().zip(right) {
            assert!(is_near(p[0] + q[0], grown.extent.width) && is_near(p[1], q[1]), "{fences}");
        }
    }
    let one_sided = drawn(r"\left. \frac{a}{b} \right\}", 20.0);
    assert_eq!(one_sided.strokes.len(), 1);
}

/// Boxes of texts do not overlap, and nothing is outside of the extent, in every equation of the lessons.
#[test]
fn nothing_overlaps_in_the_equations_of_the_lessons() {
    let equations = built_in::equations();
    assert!(!equations.is_empty());
    for equation in equations {
        let drawing = Drawing::of(&equation, 17.0, &Plain);
        let Extent { width, above, below } = drawing.extent;
        let corners = |t: &Text| {
            let [x, y] = t.at;
            [x, y - t.extent.above, x + t.extent.width, y + t.extent.below]
        };
        for (k, one) in drawing.texts.iter().enumerate() {
            let [l, t, r, b] = corners(one);
            let is_inside = l >= -0.01 && r <= width + 0.01 && t >= -above - 0.01 && b <= below + 0.01;
            assert!(is_inside, "{}: {one:?} of {:?}", equation.tex(), drawing.extent);
            for other in &drawing.texts[..k] {
                let [l2, t2, r2, b2] = corners(other);
                let is_apart = l >= r2 - 0.01 || l2 >= r - 0.01 || t >= b2 - 0.01 || t2 >= b - 0.01;
                assert!(is_apart, "{}: {} and {}", equation.tex(), one.text, other.text);
            }
        }
        let points = drawing.strokes.iter().flat_map(|stroke| &stroke.points);
        for [x, y] in points.copied().chain(drawing.bars.iter().map(|bar| bar.at)) {
            assert!((0.0..=width).contains(&x) && (-above..=below).contains(&y), "{}", equation.tex());
        }
    }
}
