//! Suggestions for mistyped names.

/// The name that is most like a mistyped one, where one is like it at all.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let likeness = |k| strsim::normalized_damerau_levenshtein(name, k);
    let likely = known.map(|k| (likeness(k), k)).filter(|(likeness, _)| *likeness >= 0.5);
    likely.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(a.1))).map(|(_, k)| k)
}
