//! Random parameters, each drawn from its full range.

use quadfront::core::case::{ParameterKind, Parameters};

use crate::xor_shift::XorShift;

/// Keys of names, which need the curves and faces of a case.
const NAMES: [&str; 2] = ["layered_loops", "faces"];

/// Sets every key but those in `kept` to a random value, as `--set` takes it: a limit, a value with all its digits, or
/// a round one.
pub fn draw(parameters: &mut Parameters, kept: &[&str], random: &mut XorShift) -> Vec<(&'static str, String)> {
    let keys = Parameters::KEYS.into_iter().filter(|key| !kept.contains(key) && !NAMES.contains(key));
    let set: Vec<_> = keys.map(|key| (key, value(key, random))).collect();
    for (key, value) in &set {
        parameters.set(key, value).unwrap();
    }
    set
}

fn value(key: &str, random: &mut XorShift) -> String {
    let share = random.next() as f64 / u64::MAX as f64;
    let between = |[least, most]: [f64; 2]| least + share * (most - least);
    match Parameters::kind_of(key).unwrap() {
        ParameterKind::Number(limits) | ParameterKind::Angle(limits) => match random.below(4) {
            0 => limits[random.below(2)],
            1 => ((between(limits) * 100.0).round() / 100.0).clamp(limits[0], limits[1]),
            _ => between(limits),
        }
        .to_string(),
        ParameterKind::Count(limits) => between(limits).round().to_string(),
        ParameterKind::Word(words) => words[random.below(words.len())].to_owned(),
        ParameterKind::Flag => (random.below(2) == 0).to_string(),
        ParameterKind::Names => String::new(),
    }
}
