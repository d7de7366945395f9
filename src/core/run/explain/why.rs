//! Why a segment was or was not selected as the base (paper 4.3.3, table 1), in sentences. Those about the base under
//! way speak of the front at its selection, in the past; the others of the next selection.

use super::numbers::{angles_apart, apart, capital, count, down, range_of_c, segment, smaller, up};
use super::segment::{SegmentFacts, Verdict};
use super::selecting::{SelectedBase, Selecting};
use crate::core::case::{Parameters, Selection, SelectionWindow};
use crate::core::convert::{Converter, Phase};
use crate::core::front::segment::Key;
use crate::core::kernel::number::{fixed, grouped, size};
use crate::core::mesh::NodeId;
use crate::core::run::front_table::{FrontTable, Row};

/// Parameters of the selection. A value that is changed while a quadrilateral is under way counts from the next base
/// on.
const OF_SELECTION: [&str; 6] = ["c", "selection", "selection_window", "h_min_over", "layers", "layered_loops"];

/// The name of the key by which segments are ordered, short and in words.
pub fn key_name(parameters: &Parameters) -> [&'static str; 2] {
    match (parameters.selection, parameters.selection_window) {
        (Selection::SmallestAngle, _) => ["\u{3b8}A+\u{3b8}B \u{b0}", "sum of frontal angles"],
        (Selection::Level, _) => ["key", "state \u{b7} level \u{b7} metric length"],
        (Selection::Shortest, _) | (Selection::Table1, SelectionWindow::PhysicalLength) => {
            ["len xyz", "length in space"]
        }
        (Selection::Table1, SelectionWindow::HValue) => ["key H", "H"],
        (Selection::Table1, SelectionWindow::MetricLengthTimesH) => ["len\u{b7}H", "metric length \u{d7} H"],
    }
}

/// The key of a segment.
pub fn key_text(row: &Row, parameters: &Parameters) -> String {
    let [text, _] = keys_apart(row, row, parameters);
    text
}

/// The keys of two segments, with as many digits as it takes to see a difference.
fn keys_apart(one: &Row, other: &Row, parameters: &Parameters) -> [String; 2] {
    let [Key(one), Key(other)] = [one, other].map(|row| row.primary_key(parameters));
    match parameters.selection {
        Selection::Table1 | Selection::Shortest => apart(one[0], other[0]),
        Selection::SmallestAngle => angles_apart(one[0], other[0]),
        Selection::Level => {
            let [length, its] = apart(one[2], other[2]);
            [(one, length), (other, its)]
                .map(|([state, level, _], length)| format!("{state:.0}\u{b7}{level:.0}\u{b7}{length}"))
        }
    }
}

impl Selecting {
    /// Why the front segment from A to B was or was not selected, or would or would not be selected now; `None` where
    /// it is not on that front. The state is the one in which the question is asked.
    pub fn explain(&self, state: &Converter<'_>, a: NodeId, b: NodeId) -> Option<SegmentFacts> {
        let is_base = self.base.is_some_and(|base| [base.a, base.b] == [a, b]);
        // While a quadrilateral is under way, the front and its metrics do not change.
        let mut told = SegmentFacts::of(&self.table, &state.mesh, [a, b], is_base)?;
        told.why = sentences(self, &told, state);
        Some(told)
    }

    /// What puts a segment at its place in the order, as the front is: the first sentence names the rule that decides.
    pub fn decided(&self, told: &SegmentFacts) -> Vec<String> {
        match told.verdict {
            Verdict::First => first(&self.table, &told.row, Tense::Present),
            _ => not_first(&self.table, told, Tense::Present),
        }
    }
}

/// Why a segment was or was not selected, or would or would not be selected now.
fn sentences(selecting: &Selecting, told: &SegmentFacts, state: &Converter<'_>) -> Vec<String> {
    let ends = [told.row.a, told.row.b];
    let mut sentences = match selecting.base {
        Some(base) => of_the_past(&selecting.table, told, base),
        None => of_the_next(&selecting.table, told, state),
    };
    if selecting.base.is_some() {
        sentences.extend(changes(&selecting.table.parameters, state.parameters()));
        match state.picked() {
            Some(picked) if picked == ends => sentences.push("You chose it as the next base.".to_owned()),
            Some(picked) => sentences.push(format!("You chose {} as the next base.", segment(picked))),
            None => {}
        }
    }
    sentences
}

/// At the selection of the base under way.
fn of_the_past(table: &FrontTable, told: &SegmentFacts, base: SelectedBase) -> Vec<String> {
    let step = grouped(base.step);
    let is_first = told.verdict == Verdict::First;
    let mut sentences = Vec::new();
    match (told.is_base, base.picked) {
        (true, false) => {}
        (true, true) if is_first => {
            sentences.push(format!("You chose it at step {step}; the rules would have chosen it too."));
        }
        (true, true) => {
            let rank = told.rank.map_or("was deferred".to_owned(), |rank| format!("had {}", rank_of(rank)));
            sentences.push(format!("You chose it at step {step}, whatever its rank. By the rules it {rank}."));
        }
        (false, _) if is_first => {
            let chosen = segment([base.a, base.b]);
            sentences.push(format!("By the rules it came first at step {step}, but you chose {chosen}."));
        }
        (false, _) => {
            let rank = told.rank.map(|rank| format!("It had {} when", rank_of(rank)));
            let rank = rank.unwrap_or_else(|| "Not chosen when".to_owned());
            sentences.push(format!("{rank} {} was selected (step {step}).", segment([base.a, base.b])));
        }
    }
    sentences.extend(reasons(table, told, Tense::Past));
    sentences
}

/// At the next selection, as the front is now.
fn of_the_next(table: &FrontTable, told: &SegmentFacts, state: &Converter<'_>) -> Vec<String> {
    let phase = state.phase();
    let is_selecting = *phase == Phase::Select;
    if !is_selecting && !phase.is_local_post_processing() && told.verdict != Verdict::LaterFace {
        return vec!["No base is selected any more: what is left is converted without a front.".to_owned()];
    }
    let mut sentences = Vec::new();
    let picked = state.picked();
    match picked {
        Some(picked) if picked == [told.row.a, told.row.b] => {
            sentences.push("You chose it: it is the next base, whatever its rank.".to_owned());
        }
        Some(picked) => sentences.push(format!("You chose {} as the next base.", segment(picked))),
        None => {}
    }
    match told.rank {
        Some((0, _)) if picked.is_some() => sentences.push("By the rules it comes first.".to_owned()),
        Some((0, _)) if is_selecting => sentences.push("It is the next base.".to_owned()),
        Some((0, _)) => sentences.push("It comes first at present.".to_owned()),
        Some(rank) => sentences.push(format!("It has {}.", rank_of(rank))),
        None => {}
    }
    sentences.extend(reasons(table, told, Tense::Present));
    if let Some(quad) = phase.last_formed() {
        let quad = quad.0;
        sentences.push(format!("Operations around quadrilateral {quad} are still to come and may change the order."));
    }
    sentences
}

fn rank_of((before, all): (usize, usize)) -> String {
    format!("rank {} of {}", grouped(before as u64 + 1), grouped(all as u64))
}

/// What was changed since the selection, and from when on it counts.
fn changes(then: &Parameters, now: &Parameters) -> Vec<String> {
    let mut sentences = Vec::new();
    if then.theta_rect != now.theta_rect {
        let [then, now] = [then, now].map(|p| fixed(p.theta_rect.to_degrees(), 1));
        sentences.push(format!(
            "\u{3b8}_{{rect}} was {then}\u{b0} at this selection; {now}\u{b0} counts for sides that are still to be prepared, and \
             from the next base on."
        ));
    }
    for key in OF_SELECTION {
        let [then, now] = [then, now].map(|parameters| parameters.text_of(key).unwrap_or_default());
        if then != now {
            sentences.push(format!("{key} was {then} at this selection; {now} counts from the next base on."));
        }
    }
    sentences
}

/// The time of what is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tense {
    Past,
    Present,
}

impl Tense {
    fn is(self) -> &'static str {
        if self == Tense::Past { "was" } else { "is" }
    }

    fn has(self) -> &'static str {
        if self == Tense::Past { "had" } else { "has" }
    }

    fn comes(self) -> &'static str {
        if self == Tense::Past { "came" } else { "comes" }
    }

    fn decides(self) -> &'static str {
        if self == Tense::Past { "decided" } else { "decides" }
    }
}

/// What puts a segment at its place in the order, and for which parameters it would come first.
fn reasons(table: &FrontTable, told: &SegmentFacts, tense: Tense) -> Vec<String> {
    let mut sentences = Vec::new();
    if told.verdict == Verdict::First {
        sentences.extend(first(table, &told.row, tense));
        sentences.extend(holder_of_h_min(table, &told.row, tense));
        sentences.extend(margins(told.margin_of_c, told.margin_of_theta_rect));
    } else {
        sentences.extend(not_first(table, told, tense));
        if let Some([low, high]) = told.chosen_for_c {
            let would = if tense == Tense::Past { "would have come" } else { "would come" };
            sentences.push(format!("It {would} first for {}.", range_of_c(low, high)));
        }
    }
    sentences.extend(rows_that_compete(table, tense));
    sentences
}

/// For which values of c, and of theta_rect in degrees, a choice would be the same.
pub fn margins(c: Option<[f64; 2]>, theta_rect: Option<[f64; 2]>) -> Option<String> {
    let mut bounds: Vec<String> = c.map(|[low, high]| range_of_c(low, high)).into_iter().collect();
    bounds.extend(theta_rect.map(range_of_theta_rect));
    same_choice(&bounds)
}

/// That a choice would be the same for each of some bounds of parameters.
pub(super) fn same_choice(bounds: &[String]) -> Option<String> {
    (!bounds.is_empty()).then(|| format!("Same choice for {}, all else unchanged.", bounds.join(", or for ")))
}

/// An interval of theta_rect in degrees; its lower end is excluded.
pub(super) fn range_of_theta_rect([low, high]: [f64; 2]) -> String {
    format!("{}\u{b0} < \u{3b8}_{{rect}} \u{2264} {}\u{b0}", up(low, 1), down(high, 1))
}

/// c Hmin with its factors.
fn reach(table: &FrontTable, text: &str) -> String {
    format!("c\u{b7}H_{{min}} = {} \u{d7} {} = {text}", table.parameters.c, size(table.h_min))
}

/// Why the first one comes first.
fn first(table: &FrontTable, row: &Row, tense: Tense) -> Vec<String> {
    let parameters = &table.parameters;
    let has = tense.has();
    let [_, name] = key_name(parameters);
    let competing = || table.rows.iter().filter(|other| table.competes(other));
    if parameters.selection != Selection::Table1 {
        let (all, key) = (count(competing().count(), "segment"), key_text(row, parameters));
        let equal = || {
            competing().filter(|other| other.h != row.h && other.primary_key(parameters) == row.primary_key(parameters))
        };
        let unit = if parameters.selection == Selection::SmallestAngle { "\u{b0}" } else { "" };
        let text = format!("Of {all} it {} first by {name}: {key}{unit}.", tense.comes());
        return [text].into_iter().chain(tie(row, equal(), name, tense)).collect();
    }
    if !table.is_within_reach(row) {
        let text = format!(
            "No segment of classes 1 to 3 {} within reach ({name} below {}), so the smallest H {} (4.3.3, iii): {}.",
            tense.is(),
            reach(table, &size(table.reach())),
            tense.decides(),
            size(row.h_value)
        );
        let equal = competing().filter(|other| other.h != row.h && other.h_value == row.h_value);
        return [text].into_iter().chain(tie(row, equal, "H", tense)).collect();
    }
    let mut sentences = Vec::new();
    for class in 1..row.class {
        let text = match competing().filter(|other| other.class == class).count() {
            0 => format!("Class {class} {} empty.", tense.is()),
            1 => format!("The only segment of class {class} {} out of reach.", tense.is()),
            2 => format!("Both segments of class {class} {} out of reach.", plural(tense)),
            n => format!("All {n} segments of class {class} {} out of reach.", plural(tense)),
        };
        sentences.push(text);
    }
    let rivals = || competing().filter(|other| other.class == row.class && table.is_within_reach(other));
    let [key, bound] = apart(row.window, table.reach());
    let of = match rivals().count() {
        1 => format!("It {} the only segment of class {} within reach", tense.is(), row.class),
        n => format!("Of {n} segments of class {} within reach it {has} the smallest key", row.class),
    };
    let step = if row.class == 1 { "ii" } else { "iii" };
    sentences.push(format!("{of}: {name} = {key} < {} (4.3.3, {step}).", reach(table, &bound)));
    let equal = rivals().filter(|other| other.h != row.h && other.window == row.window);
    sentences.extend(tie(row, equal, name, tense));
    sentences
}

fn plural(tense: Tense) -> &'static str {
    if tense == Tense::Past { "were" } else { "are" }
}

/// What decides between segments of equal keys.
fn tie<'a>(row: &Row, equal: impl Iterator<Item = &'a Row>, name: &str, tense: Tense) -> Option<String> {
    let equal: Vec<&Row> = equal.collect();
    let others = count(equal.len(), "other segment");
    let has = if equal.len() > 1 && tense == Tense::Present { "have" } else { tense.has() };
    let by = if equal.iter().any(|other| other.theta_sum() == row.theta_sum()) {
        format!("and the same sum of frontal angles: the lower half-edge number {}", tense.decides())
    } else {
        "but a larger sum of frontal angles".to_owned()
    };
    (!equal.is_empty()).then(|| format!("{} {has} the same {name} {by}.", capital(&others)))
}

/// Which segment has Hmin, where it is not this one.
fn holder_of_h_min(table: &FrontTable, row: &Row, tense: Tense) -> Option<String> {
    let least = table.least().filter(|_| table.parameters.selection == Selection::Table1)?;
    if least.h_value >= row.h_value {
        return None;
    }
    let [_, name] = key_name(&table.parameters);
    let what = if least.is_deferred {
        format!("{} deferred", tense.is())
    } else if table.is_within_reach(least) {
        format!("{} of class {}, with {name} = {}", tense.is(), least.class, size(least.window))
    } else if least.class == 4 {
        format!("{} of class 4", tense.is())
    } else {
        format!("{} of class {} and out of reach: {name} = {}", tense.is(), least.class, size(least.window))
    };
    let ends = segment([least.a, least.b]);
    Some(format!("{ends} {} H_{{min}} = {}; it {what}.", tense.has(), size(least.h_value)))
}

/// Which rows compete, where rows are offset first.
fn rows_that_compete(table: &FrontTable, tense: Tense) -> Option<String> {
    let layers = table.parameters.layers;
    let row = table.layer % (layers + 1);
    let compete = if tense == Tense::Past { "competed" } else { "compete" };
    (row < layers).then(|| format!("Rows are offset first: only segments of row {row} {compete} (4.3.3, point 3)."))
}

/// Why another one comes first.
fn not_first(table: &FrontTable, told: &SegmentFacts, tense: Tense) -> Vec<String> {
    let row = &told.row;
    let parameters = &table.parameters;
    let [_, name] = key_name(parameters);
    let choice = table.choice();
    let its = choice.map_or(String::new(), |choice| segment([choice.a, choice.b]));
    let (is, has, comes) = (tense.is(), tense.has(), tense.comes());
    let text = match told.verdict {
        Verdict::First => return Vec::new(),
        Verdict::Deferred => "Deferred: every attempt has failed; it waits until something near it changes.".to_owned(),
        Verdict::LaterFace => format!("Its face, {}, is converted later.", row.face + 1),
        Verdict::LaterRow => format!("It is of row {}; rows nearer to the boundary come first.", row.level),
        Verdict::OutOfReach => {
            let [key, bound] = apart(row.window, table.reach());
            let step = if row.class == 1 { "ii" } else { "iii" };
            let bound = reach(table, &bound);
            format!(
                "It {is} of class {} and out of reach: {name} = {key}, not below {bound} (4.3.3, {step}).",
                row.class
            )
        }
        Verdict::ClassFour => format!(
            "It {is} of class 4, which counts only where no segment of classes 1 to 3 is within reach (4.3.3, iii)."
        ),
        Verdict::BetterClass { class } => {
            format!(
                "It {is} of class {}; {its}, of class {class}, {is} within reach and {comes} before it (table 1).",
                row.class
            )
        }
        Verdict::LargerKey if parameters.selection == Selection::Table1 => {
            let less = smaller(apart(choice.map_or(f64::NAN, |choice| choice.window), row.window));
            format!("It {is} within reach, but {its} of the same class {has} a smaller {name}: {less}.")
        }
        Verdict::LargerKey => {
            let less = smaller(keys_apart(choice.unwrap_or(row), row, parameters));
            format!("{its} {comes} before it by {name}: {less}.")
        }
        Verdict::LargerH => {
            let less = smaller(apart(choice.map_or(f64::NAN, |choice| choice.h_value), row.h_value));
            format!("No segment {is} within reach, and {its} {has} a smaller H: {less} (4.3.3, iii).")
        }
        Verdict::Tied => {
            let name = if choice.is_some_and(|c| parameters.selection != Selection::Table1 || table.is_within_reach(c))
            {
                name
            } else {
                "H"
            };
            let smaller = choice.is_some_and(|choice| choice.theta_sum() < row.theta_sum());
            let by = if smaller { "a smaller sum of frontal angles" } else { "a half-edge with a lower number" };
            format!("{its} {has} the same {name} and {by}.")
        }
    };
    vec![text]
}
