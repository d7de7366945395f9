//! Suggestions for mistyped names.

/// The known name most similar to a mistyped one (the first in the alphabet among equals); `None` if none is similar.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let likeness = |k| strsim::normalized_damerau_levenshtein(name, k);
    let likely = known.map(|k| (likeness(k), k)).filter(|(likeness, _)| *likeness >= 0.5);
    likely.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(a.1))).map(|(_, k)| k)
}

/// The remedy for a mistyped name, `Did you mean "east"?`; `None` if no known name is similar.
pub fn suggestion<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    nearest(name, known).map(|near| format!("Did you mean \"{near}\"?"))
}
