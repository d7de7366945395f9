//! Texts of STEP files: ISO 10303-21, 6.4.3, "String".

/// The characters of a text between quotes: doubled quotes, and the directives `\X\`, `\X2\`, `\X4\`, `\S\`, `\P.\`.
/// What is malformed stays as it is; bytes that are no UTF-8 are taken as Latin-1.
pub(super) fn decoded(raw: &[u8]) -> String {
    let latin: String;
    let text = match std::str::from_utf8(raw) {
        Ok(text) => text,
        Err(_) => {
            latin = raw.iter().map(|&b| char::from(b)).collect();
            &latin
        }
    };
    let mut found = String::new();
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let (taken, length) = directive(rest).unwrap_or_else(|| (next.to_string(), next.len_utf8()));
        found.push_str(&taken);
        rest = &rest[length..];
    }
    found
}

/// The characters of the directive with which a text begins, and its length in bytes.
fn directive(text: &str) -> Option<(String, usize)> {
    if text.starts_with("''") {
        return Some(("'".to_owned(), 2));
    }
    if text.starts_with("\\\\") {
        return Some(("\\".to_owned(), 2));
    }
    if let Some(rest) = text.strip_prefix("\\S\\") {
        let c = rest.chars().next().filter(char::is_ascii)?;
        return Some((char::from(c as u8 | 0x80).to_string(), 4));
    }
    if let Some(rest) = text.strip_prefix("\\X\\") {
        let code = u8::from_str_radix(rest.get(..2)?, 16).ok()?;
        return Some((char::from(code).to_string(), 5));
    }
    if text.starts_with("\\P") && text.get(3..4) == Some("\\") {
        return Some((String::new(), 4));
    }
    let digits = match text.get(..4)? {
        "\\X2\\" => 4,
        "\\X4\\" => 8,
        _ => return None,
    };
    let end = text.find("\\X0\\")?;
    let codes = text.get(4..end).filter(|codes| codes.is_ascii() && codes.len().is_multiple_of(digits))?;
    let numbers =
        codes.as_bytes().chunks(digits).map(|code| u32::from_str_radix(std::str::from_utf8(code).ok()?, 16).ok());
    let numbers: Vec<u32> = numbers.collect::<Option<_>>()?;
    let characters: String = if digits == 4 {
        let units: Vec<u16> = numbers.iter().map(|&n| n as u16).collect();
        String::from_utf16_lossy(&units)
    } else {
        numbers.iter().map(|&n| char::from_u32(n).unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    Some((characters, end + 4))
}

#[cfg(test)]
mod tests {
    use super::decoded;

    #[test]
    fn directives_become_characters_and_malformed_ones_stay() {
        for (raw, text) in [
            ("it''s", "it's"),
            ("\\X2\\00C400D6\\X0\\x", "ÄÖx"),
            ("\\X4\\0001F600\\X0\\", "\u{1f600}"),
            ("\\X\\E9t\\X\\E9", "été"),
            ("\\S\\D", "Ä"),
            ("\\PA\\a", "a"),
            ("a\\\\b", "a\\b"),
            ("\\X2\\00C", "\\X2\\00C"),
            ("\\X2\\zzzz\\X0\\", "\\X2\\zzzz\\X0\\"),
        ] {
            assert_eq!(decoded(raw.as_bytes()), text, "{raw}");
        }
        assert_eq!(decoded(b"caf\xe9"), "café");
        assert_eq!(decoded("名前".as_bytes()), "名前");
    }
}
