//! The tables, as Markdown.

use super::background::Subject;
use super::outcome::{Measured, Outcome};
use super::settings::{Question, Setting};

/// What the cells of the comparisons are.
pub fn heading() -> String {
    "Cells of the first table of each question: quadrilaterals / % of metric corner angles within 60-120 degrees / % irregular \
     inner nodes / metric edge length, mean ± standard deviation. Of the second, as the front leaves the mesh, before the \
     post-processing of the whole: % of angles within 60-120 / % irregular / attempts taken back and quadrilaterals of the last \
     resort, both in % of those made. Means over several backgrounds, each with its inner nodes moved by up to 10 % of a unit \
     length.\n"
        .to_owned()
}

/// The tables of a question, settings down and cases across: at the end, and as the front leaves the mesh.
pub fn tables<'o>(
    question: &Question,
    subjects: &[Subject],
    outcomes: impl Fn(&Setting, usize) -> Vec<&'o Outcome>,
) -> String {
    let mut text = format!("### {}\n\n{}", question.asks, table(question, subjects, &outcomes, &AT_THE_END));
    if question.of_the_front {
        text += &format!("\nAs the front leaves it:\n\n{}", table(question, subjects, &outcomes, &BY_THE_FRONT));
    }
    text
}

/// How much the defaults differ from one background to another, at the end and as the front leaves the mesh.
pub fn spread<'o>(subjects: &[Subject], outcomes: impl Fn(&Setting, usize) -> Vec<&'o Outcome>) -> String {
    let mut rows = head(subjects);
    for (words, cell) in [("at the end", &AT_THE_END), ("as the front leaves it", &BY_THE_FRONT)] {
        let cells = (0..subjects.len()).map(|c| deviations(&outcomes(&Setting::Defaults, c), cell));
        rows.push(row(words, cells));
    }
    let numbers = subjects.iter().map(|s| s.count.to_string());
    rows.push(row("backgrounds", numbers));
    format!(
        "### How much do the defaults differ from one background to another? (standard deviation)\n\n{}\n",
        rows.join("\n")
    )
}

/// What a cell shows: numbers, how they are written, and how their deviations are.
struct Cell {
    values: fn(&Measured) -> [f64; 5],
    mean: fn([f64; 5]) -> String,
    deviation: fn([f64; 5]) -> String,
}

const AT_THE_END: Cell = Cell {
    values: |measured| {
        let mesh = &measured.mesh;
        let within = 100.0 * mesh.metric_angles.share_60_120;
        [mesh.quads as f64, within, mesh.irregular.percent, mesh.lengths.mean, mesh.lengths.deviation]
    },
    mean: |[quads, within, irregular, length, deviation]| {
        format!("{quads:.0} / {within:.1} / {irregular:.1} / {length:.2}±{deviation:.2}")
    },
    deviation: |[quads, within, irregular, length, _]| {
        format!("±{quads:.0} / ±{within:.1} / ±{irregular:.1} / ±{length:.2}")
    },
};

const BY_THE_FRONT: Cell = Cell {
    values: |measured| {
        let before = &measured.before;
        let share = |count: u64| 100.0 * count as f64 / measured.made() as f64;
        let within = 100.0 * before.metric_angles.share_60_120;
        [within, before.irregular.percent, share(measured.counts.rolled_back), share(measured.last_resort), 0.0]
    },
    mean: |[within, irregular, back, resort, _]| format!("{within:.1} / {irregular:.1} / {back:.0}, {resort:.1}"),
    deviation: |[within, irregular, back, resort, _]| {
        format!("±{within:.1} / ±{irregular:.1} / ±{back:.0}, ±{resort:.1}")
    },
};

fn table<'o>(
    question: &Question,
    subjects: &[Subject],
    outcomes: &impl Fn(&Setting, usize) -> Vec<&'o Outcome>,
    cell: &Cell,
) -> String {
    let mut rows = head(subjects);
    let mut settings = vec![(Setting::Defaults, format!("**{}**", question.defaults))];
    settings.extend(question.others.iter().map(|&setting| (setting, setting.words())));
    for (setting, words) in &settings {
        rows.push(row(words, (0..subjects.len()).map(|c| means(&outcomes(setting, c), cell))));
    }
    rows.join("\n") + "\n"
}

fn head(subjects: &[Subject]) -> Vec<String> {
    let names = subjects.iter().map(|s| s.name.clone());
    vec![row("", names), row("---", subjects.iter().map(|_| "---".to_owned()))]
}

fn means(outcomes: &[&Outcome], cell: &Cell) -> String {
    let good: Vec<_> = outcomes.iter().filter_map(|o| o.as_ref().ok()).map(cell.values).collect();
    let bad: Vec<_> = outcomes.iter().filter_map(|o| o.as_ref().err()).collect();
    let mut text = if good.is_empty() { String::new() } else { (cell.mean)(mean(&good)) };
    if let Some(what) = bad.first() {
        text += &format!(" **{} of {} fail: {what}**", bad.len(), outcomes.len());
    }
    text
}

/// Standard deviations over the backgrounds of what is in a cell.
fn deviations(outcomes: &[&Outcome], cell: &Cell) -> String {
    let values: Vec<_> = outcomes.iter().filter_map(|o| o.as_ref().ok()).map(cell.values).collect();
    let about = mean(&values);
    let squares: Vec<_> =
        values.iter().map(|v| [0, 1, 2, 3, 4].map(|i| (v[i] - about[i]) * (v[i] - about[i]))).collect();
    // Of a sample: one background says nothing about the others.
    let more = values.len() as f64 / (values.len() as f64 - 1.0);
    (cell.deviation)(mean(&squares).map(|s| (s * more).sqrt()))
}

fn mean(values: &[[f64; 5]]) -> [f64; 5] {
    let sum = values.iter().fold([0.0; 5], |sum, v| [0, 1, 2, 3, 4].map(|i| sum[i] + v[i]));
    sum.map(|s| s / values.len() as f64)
}

/// What each case comes to by a setting, on its own background.
pub fn features(setting: &Setting, rows: &[(&Subject, &Outcome)]) -> String {
    let head = [
        "NQ",
        "least, greatest angle",
        "% in 30-160",
        "% in 60-120",
        "edge length",
        "% irregular",
        "scaled Jacobian min, mean",
        "last resort %",
        "rescues %",
        "right side replaced %",
        "deferred %",
        "taken back %",
    ];
    let cells = |measured: &Measured| {
        let mesh = &measured.mesh;
        let angles = &mesh.metric_angles;
        let jacobian = mesh.metric_scaled_jacobian.map_or(String::new(), |j| format!("{:.2}, {:.3}", j.min, j.mean));
        let counts = &measured.counts;
        // Each in percent of the quadrilaterals that were made.
        let share = |count: u64| format!("{:.1}", 100.0 * count as f64 / measured.made() as f64);
        vec![
            mesh.quads.to_string(),
            format!("{:.0}, {:.0}", angles.min, angles.max),
            format!("{:.2}", 100.0 * angles.share_30_160),
            format!("{:.1}", 100.0 * angles.share_60_120),
            format!("{:.2}±{:.2}", mesh.lengths.mean, mesh.lengths.deviation),
            format!("{:.1}", mesh.irregular.percent),
            jacobian,
            share(measured.last_resort),
            share(counts.rescued),
            share(counts.right_replaced),
            share(counts.deferred),
            share(counts.rolled_back),
        ]
    };
    format!("### Every built-in case, {}\n\n{}\n", setting.words(), by_case(&head, rows, cells))
}

/// How often what happened, by a setting.
pub fn operations(setting: &Setting, rows: &[(&Subject, &Outcome)]) -> String {
    let head = [
        "steps",
        "formed",
        "nodes removed",
        "enhancing swaps",
        "seams",
        "of these with a transition",
        "splits",
        "closed small loops: quads",
        "last resort: quads",
    ];
    let cells = |measured: &Measured| {
        let counts = &measured.counts;
        let numbers = [
            counts.steps,
            counts.formed,
            counts.removed,
            counts.enhanced,
            counts.seamed,
            counts.transitions,
            counts.split,
            counts.closed,
            measured.last_resort,
        ];
        numbers.map(|n| n.to_string()).to_vec()
    };
    format!("### How often what happens, {}\n\n{}\n", setting.words(), by_case(&head, rows, cells))
}

fn by_case(head: &[&str], rows: &[(&Subject, &Outcome)], cells: impl Fn(&Measured) -> Vec<String>) -> String {
    let mut lines =
        vec![row("", head.iter().map(|h| (*h).to_owned())), row("---", head.iter().map(|_| "---".to_owned()))];
    for (subject, outcome) in rows {
        lines.push(match outcome {
            Ok(measured) => row(&subject.name, cells(measured).into_iter()),
            Err(what) => row(&subject.name, [format!("**fails: {what}**")].into_iter()),
        });
    }
    lines.join("\n")
}

fn row(first: &str, rest: impl Iterator<Item = String>) -> String {
    let cells: Vec<String> = std::iter::once(first.to_owned()).chain(rest).collect();
    format!("| {} |", cells.join(" | "))
}
