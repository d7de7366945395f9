//! Bad surfaces, curves and loops are refused with one clear error: what, where, and what to do.

use quadfront::core::convert::conversion::convert;
use quadfront::core::progress::Nobody;

use super::{make, parsed};

const METRIC: &str = "[[metric]]\nkind = \"uniform\"\nh = 0.3\n";

/// A cylinder of radius 1 and height 2.
const CYLINDER: &str = "[[surface]]\nname = \"pipe\"\nkind = \"cylinder\"\nradius = 1\nheight = 2\n";

fn refusal(text: &str) -> String {
    let case = parsed(&format!("version = 1\n{text}\n{METRIC}"));
    convert(&case, &mut Nobody).unwrap_err().to_string()
}

fn assert_says(text: &str, words: &[&str]) {
    let said = refusal(text);
    for word in words {
        assert!(said.contains(word), "\"{word}\" is not in: {said}");
    }
}

#[test]
fn a_knot_vector_that_decreases_or_a_weight_that_is_not_positive_names_the_surface() {
    let surface = |knots: &str, weights: &str| {
        format!(
            "[[surface]]\nname = \"sheet\"\nkind = \"nurbs\"\ndegree_u = 1\ndegree_v = 1\nknots_u = {knots}\n\
             knots_v = [0, 0, 1, 1]\npoints = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 1]]]\nweights = {weights}\n\
             [[face]]\nname = \"f\"\nsurface = \"sheet\"\n"
        )
    };
    let ones = "[[1, 1], [1, 1]]";
    assert_says(&surface("[0, 0, 1, 0.5]", ones), &["sheet", "along u", "Knot 4", "less than the one before"]);
    assert_says(&surface("[0, 0, 0, 1]", ones), &["sheet", "along u", "empty parameter range"]);
    let more = |knots: &str| {
        surface(knots, "[[1, 1], [1, 1], [1, 1], [1, 1]]")
            .replace("[[1, 0, 0], [1, 1, 1]]", "[[1, 0, 0], [1, 1, 1]], [[2, 0, 0], [2, 1, 1]], [[3, 0, 0], [3, 1, 0]]")
    };
    assert_says(&more("[0, 0, 0.5, 0.5, 1, 1]"), &["sheet", "along u", "0.5 occurs 2 times", "degree 1"]);
    assert_says(&surface("[0, 0, 1, 1]", "[[1, 1], [0, 1]]"), &["sheet", "Weight 3 is 0"]);
    assert_says(&surface("[0, 0, 1, 1]", "[[1, -2.5], [1, 1]]"), &["sheet", "Weight 2 is -2.5"]);
}

#[test]
fn a_trim_outside_of_the_knots_says_where_and_how_far_the_surface_goes() {
    let text = format!(
        "{CYLINDER}[[curve]]\nname = \"hole\"\nkind = \"circle\"\non = \"pipe\"\ncentre = [90, 1.9]\nradius = 0.4\n\
         [[face]]\nname = \"f\"\nsurface = \"pipe\"\nholes = [[\"hole\"]]\n"
    );
    assert_says(&text, &["\"hole\" leaves the surface of the face \"f\"", "v = ", "v from 0 to 2"]);
}

#[test]
fn a_curve_that_does_not_lie_on_the_surface_is_told_with_its_distance() {
    let text = format!(
        "{CYLINDER}[[curve]]\nname = \"ring\"\nkind = \"circle\"\ncentre = [0, 0, 1]\nradius = 1.01\n\
         [[face]]\nname = \"f\"\nsurface = \"pipe\"\nrepeated = [\"ring\"]\n"
    );
    assert_says(&text, &["\"ring\" does not lie on the surface of the face \"f\"", "0.01 away"]);
}

#[test]
fn a_loop_that_goes_round_a_closed_surface_asks_for_a_seam() {
    let text = format!(
        "{CYLINDER}[[curve]]\nname = \"a\"\nkind = \"circle\"\nradius = 1\n\
         [[face]]\nname = \"f\"\nsurface = \"pipe\"\nouter = [\"a\"]\n"
    );
    assert_says(&text, &["outer loop of \"f\" does not close", "needs a seam"]);
}

#[test]
fn trims_that_cross_are_named() {
    let text = "[[surface]]\nname = \"s\"\nkind = \"plane\"\nu = [4, 0, 1]\nv = [0, 4, 0]\n\
                [[curve]]\nname = \"one\"\nkind = \"circle\"\non = \"s\"\ncentre = [1.5, 2]\nradius = 0.7\n\
                [[curve]]\nname = \"two\"\nkind = \"circle\"\non = \"s\"\ncentre = [2.5, 2]\nradius = 0.7\n\
                [[face]]\nname = \"f\"\nsurface = \"s\"\nholes = [[\"one\"], [\"two\"]]\n";
    assert_says(text, &["\"one\" and \"two\" cross"]);
}

#[test]
fn a_trim_that_crosses_itself_is_named_with_its_face_and_place() {
    let text = "[[surface]]\nname = \"s\"\nkind = \"plane\"\nu = [4, 0, 1]\nv = [0, 4, 0]\n\
                [[curve]]\nname = \"bow\"\nkind = \"polyline\"\non = \"s\"\n\
                points = [[1, 1], [3, 3], [3, 1], [1, 3], [1, 1]]\n\
                [[face]]\nname = \"f\"\nsurface = \"s\"\nholes = [[\"bow\"]]\n";
    assert_says(text, &["\"bow\"", "cross", "\"f\"", "2"]);
}

#[test]
fn fixed_counts_that_cannot_be_even_on_all_faces_name_the_loop() {
    let faces = |shared: u32| {
        format!(
            "[[surface]]\nname = \"a\"\nkind = \"plane\"\nu = [1, 0, 0]\nv = [0, 1, 0]\n\
             [[surface]]\nname = \"b\"\nkind = \"plane\"\nu = [0, 0, 1]\nv = [0, 1, 0]\n\
             [[curve]]\nname = \"line\"\nkind = \"segment\"\nfrom = [0, 0, 0]\nto = [0, 1, 0]\nsegments = {shared}\n\
             [[curve]]\nname = \"rim a\"\nkind = \"polyline\"\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\n\
             segments = 9\n\
             [[curve]]\nname = \"rim b\"\nkind = \"polyline\"\npoints = [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]]\n\
             [[face]]\nname = \"a\"\nsurface = \"a\"\nouter = [\"line\", \"rim a\"]\n\
             [[face]]\nname = \"b\"\nsurface = \"b\"\nouter = [\"line\", \"rim b\"]\n"
        )
    };
    assert_says(&faces(4), &["outer loop of \"a\" has 13 segments", "even"]);
    // The free rim of the other face gives way.
    make(&parsed(&format!("version = 1\n{}\n{METRIC}", faces(5)))).assert_sound("odd and free");
}
