//! What stands in braces at the end of a heading or a question: `{go: "end", light: "C D"}`.

use crate::core::fault::Fault;
use crate::core::kernel::spelling::suggestion;

/// A value under its key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Attribute {
    pub key: &'static str,
    pub value: String,
}

/// Splits a line into its text and its attributes; a line without braces at its end has none. The faults have no place
/// yet.
pub(super) fn split<'t>(line: &'t str, known: &[&'static str]) -> Result<(&'t str, Vec<Attribute>), Fault> {
    let line = line.trim();
    let Some(open) = opening(line) else { return Ok((line, Vec::new())) };
    let attributes = parse(&line[open + 1..line.len() - 1], known)?;
    Ok((line[..open].trim_end(), attributes))
}

/// Where the braces at the end of a line open. What follows a letter or an underscore is markup: `H_{min}`.
fn opening(line: &str) -> Option<usize> {
    if !line.ends_with('}') {
        return None;
    }
    let is_open = |at: &usize| line[..*at].ends_with(char::is_whitespace) || *at == 0;
    line.match_indices('{').map(|(at, _)| at).find(is_open)
}

fn parse(text: &str, known: &[&'static str]) -> Result<Vec<Attribute>, Fault> {
    let mut found: Vec<Attribute> = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let example = "Write for example {go: \"end\", light: \"base\"}";
        let Some((key, after)) = rest.split_once(':') else {
            return Err(Fault::new(format!("\"{}\" in braces has no colon", shortened(rest))).remedy(example));
        };
        let key = key.trim();
        let Some(key) = known.iter().copied().find(|name| *name == key) else {
            let fault = Fault::new(format!("There is no attribute \"{}\"", shortened(key)));
            let remedy = suggestion(key, known.iter().copied());
            return Err(fault.remedy(remedy.unwrap_or_else(|| format!("Attributes here are {}", known.join(", ")))));
        };
        if found.iter().any(|attribute| attribute.key == key) {
            return Err(Fault::new(format!("The attribute \"{key}\" is given twice")).remedy("Remove one of them"));
        }
        let Some((value, after)) = quoted(after.trim_start()) else {
            return Err(Fault::new(format!("The value of \"{key}\" is no text in quotes")).remedy(example));
        };
        found.push(Attribute { key, value });
        let after = after.trim_start();
        rest = match after.strip_prefix(',') {
            Some(next) => next.trim_start(),
            None if after.is_empty() => after,
            None => {
                let what = format!("A comma is missing before \"{}\"", shortened(after));
                return Err(Fault::new(what).remedy(example));
            }
        };
    }
    Ok(found)
}

/// A text in quotes at the beginning, and what follows it; a backslash takes the next character as it is.
fn quoted(text: &str) -> Option<(String, &str)> {
    let inner = text.strip_prefix('"')?;
    let mut value = String::new();
    let mut characters = inner.char_indices();
    while let Some((at, c)) = characters.next() {
        match c {
            '"' => return Some((value, &inner[at + 1..])),
            '\\' => value.push(characters.next()?.1),
            c => value.push(c),
        }
    }
    None
}

/// A text for a message.
pub(super) fn shortened(text: &str) -> String {
    let text = text.trim().escape_debug().to_string();
    if text.chars().count() > 40 { text.chars().take(37).chain("...".chars()).collect() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: [&str; 2] = ["go", "light"];

    type Told = (String, Vec<(&'static str, String)>);

    fn attributes(line: &str) -> Result<Told, String> {
        let (text, found) = split(line, &KNOWN).map_err(|fault| fault.to_string())?;
        Ok((text.to_owned(), found.into_iter().map(|a| (a.key, a.value)).collect()))
    }

    #[test]
    fn braces_at_the_end_are_attributes_and_markup_is_text() {
        assert_eq!(attributes("H_{min}"), Ok(("H_{min}".to_owned(), vec![])));
        assert_eq!(attributes("a {b} c"), Ok(("a {b} c".to_owned(), vec![])));
        let found = attributes(r#"The H_{min} {go: "a \"b\"", light: "C, D",}"#);
        let expected = vec![("go", "a \"b\"".to_owned()), ("light", "C, D".to_owned())];
        assert_eq!(found, Ok(("The H_{min}".to_owned(), expected)));
        assert_eq!(attributes("x {}"), Ok(("x".to_owned(), vec![])));
    }

    #[test]
    fn what_is_no_attribute_is_refused_by_name() {
        for (line, part) in [
            ("x {goo: \"1\"}", "Did you mean \"go\"?"),
            ("x {zzz: \"1\"}", "go, light"),
            ("x {go \"1\"}", "no colon"),
            ("x {go: 1}", "in quotes"),
            ("x {go: \"1}", "in quotes"),
            ("x {go: \"1\" light: \"2\"}", "comma"),
            ("x {go: \"1\", go: \"2\"}", "twice"),
        ] {
            let fault = attributes(line).unwrap_err();
            assert!(fault.contains(part), "{line}: {fault}");
        }
    }
}
