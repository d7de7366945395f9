//! Narrow places in words: the angle of a seam against its bound, and the sets T and V of a split (paper 4.3.6).

use super::numbers::{angles_apart, apart, count, edge};
use crate::core::convert::{
    AROUND, LEAST_PART, Narrow, NotSlender, OnFront, SHORT, SeamCorner, SideToCollapse, Slender,
};
use crate::core::kernel::number::degrees;

/// The frontal angle of a seam against its bound.
pub(super) fn angle(corner: &SeamCorner) -> String {
    let SeamCorner { angle, theta_seam, widest, length, .. } = *corner;
    let [angle, bound] = angles_apart(angle, widest);
    if widest == theta_seam {
        return format!("The frontal angle is {angle}\u{b0}, and \u{3b8}_{{seam}} = {bound}\u{b0} (4.3.6).");
    }
    let [length, short] = apart(length, SHORT);
    format!(
        "The frontal angle is {angle}\u{b0}; \u{3b8}_{{seam}} = {}\u{b0} is widened to {bound}\u{b0}, since the \
         {} segments around are {length} long on average, less than {short} (4.3.6).",
        degrees(theta_seam),
        2 * AROUND
    )
}

/// The sets T and V of 4.3.6 (fig. 19), a sentence for each triangle.
pub(super) fn regions(narrow: &Narrow) -> Vec<String> {
    let Narrow { eps1, eps2, on_front, slender } = narrow;
    let mut sentences = vec![format!("T has {} (all nodes on the front):", count(on_front.len(), "triangle"))];
    for OnFront { element, area, ratio, passed } in on_front {
        let area = |sign: &str| {
            let [area, bound] = apart(*area, *eps1);
            format!("metric area {area} {sign} \u{3b5}_{{1}} = {bound}")
        };
        let ratio = |sign: &str| {
            let [ratio, bound] = apart(*ratio, *eps2);
            format!("width / height {ratio} {sign} \u{3b5}_{{2}} = {bound}")
        };
        let why = match passed {
            Some(NotSlender::Adjacent) => "not slender, two sides are adjacent front segments (condition a)".to_owned(),
            Some(NotSlender::NoBase) => "not slender, it has no side on the front".to_owned(),
            Some(NotSlender::Large) => format!("not slender, {} (condition b)", area("\u{2265}")),
            Some(NotSlender::Wide) => format!("not slender, {}, but {} (condition c)", area("<"), ratio("\u{2264}")),
            None => format!("slender: {}, {}", area("<"), ratio(">")),
        };
        sentences.push(format!("Triangle {}: {why}.", element.0));
    }
    let least = if slender.len() > 1 { ", the least area / ratio first" } else { "" };
    sentences.push(format!("V has {}{least}:", count(slender.len(), "slender triangle")));
    for Slender { element, sides, .. } in slender {
        let sides = sides.iter().map(side_to_collapse).collect::<Vec<_>>().join("; ");
        sentences.push(format!("Triangle {}: {sides}.", element.0));
    }
    sentences
}

/// What the collapse of a side edge would leave.
fn side_to_collapse(side: &SideToCollapse) -> String {
    let ends = edge(side.ends);
    match side.segments {
        None => format!("the ends of {ends} lie on two loops"),
        Some([first, second]) => {
            let parts = format!("{ends} would leave loops of {first} and {second} segments");
            if side.splits() {
                format!("{parts}, both even")
            } else if first % 2 == 1 || second % 2 == 1 {
                format!("{parts}, not both even")
            } else {
                format!("{parts}, one with fewer than {LEAST_PART}")
            }
        }
    }
}
