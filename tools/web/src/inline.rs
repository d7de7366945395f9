//! The two pages that are made of one template: the one beside its files, and the one that holds everything.

use base64::prelude::{BASE64_STANDARD, Engine};

/// Where the template loads its script.
const SCRIPT: &str = r#"<script type="module" src="page.js"></script>"#;
/// Where a page carries what it shows. The template leaves it empty; `quadfront page` fills it.
const CONTENT: &str = r#"<script type="application/json" id="content"></script>"#;
const HEAD_END: &str = "</head>";

/// The template, with the sizes of the program: plain, and as it is transferred.
pub fn with_sizes(template: &str, plain: usize, compressed: usize) -> Result<String, String> {
    around(template, CONTENT)?;
    if template.contains("quadfront-size") {
        return Err("page.html must leave the sizes of the program (quadfront-size) to this tool".into());
    }
    let (before, after) = around(template, HEAD_END)?;
    Ok(format!(
        "{before}<meta name=\"quadfront-size\" content=\"{plain}\">\n\
         <meta name=\"quadfront-size-gzip\" content=\"{compressed}\">\n{HEAD_END}{after}"
    ))
}

/// The page with its program, compressed, and its one module inside.
pub fn whole(page: &str, program_gz: &[u8], module: &str) -> Result<String, String> {
    let (before, after) = around(page, SCRIPT)?;
    Ok(format!(
        "{before}<script type=\"application/gzip;base64\" id=\"program\">{}</script>\n\
         <script type=\"module\">\n{}</script>{after}",
        BASE64_STANDARD.encode(program_gz),
        escaped(module)
    ))
}

/// What is before and after a part that must be there once.
fn around<'t>(text: &'t str, part: &str) -> Result<(&'t str, &'t str), String> {
    match (text.split_once(part), text.matches(part).count()) {
        (Some(both), 1) => Ok(both),
        (_, count) => Err(format!("page.html must have `{part}` once, and has it {count} times")),
    }
}

/// A script that the parser of HTML reads to its end: no `</script`, and no `<!--`, after which a `<script` would
/// swallow the end. In a module both stand only in strings, templates, regular expressions and comments, where `\x3C`
/// is `<`.
fn escaped(script: &str) -> String {
    let mut text = String::with_capacity(script.len());
    let mut rest = script;
    while let Some(at) = rest.find('<') {
        text += &rest[..at];
        rest = &rest[at + 1..];
        let closes = rest.get(..7).is_some_and(|next| next.eq_ignore_ascii_case("/script"));
        text += if closes || rest.starts_with("!--") { "\\x3C" } else { "<" };
    }
    text + rest
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const PAGE: &str = include_str!("../tests/assets/page.html");

    #[test]
    fn the_sizes_stand_in_the_head() {
        let page = with_sizes(PAGE, 3000, 1000).unwrap();
        let head = page.split_once(HEAD_END).unwrap().0;
        assert!(head.contains("<meta name=\"quadfront-size\" content=\"3000\">"), "{page}");
        assert!(head.contains("<meta name=\"quadfront-size-gzip\" content=\"1000\">"), "{page}");
        assert!(page.contains(SCRIPT) && page.contains(CONTENT), "{page}");
        assert!(with_sizes(&page, 1, 1).unwrap_err().contains("leave the sizes"));
    }

    #[test]
    fn the_whole_page_loads_no_file() {
        let page = whole(PAGE, b"\x1f\x8b and so on", "let a = 1;\n").unwrap();
        assert!(
            page.contains("<script type=\"application/gzip;base64\" id=\"program\">H4sgYW5kIHNvIG9u</script>"),
            "{page}"
        );
        assert!(page.contains("<script type=\"module\">\nlet a = 1;\n</script>"), "{page}");
        assert!(!page.contains("src=") && page.contains(CONTENT), "{page}");
    }

    #[test]
    fn nothing_in_a_script_ends_it_or_opens_a_comment() {
        assert_eq!(
            escaped("a < b; '</SCRIPT>' + `<!-- <script>` + '</p><é' // </script"),
            "a < b; '\\x3C/SCRIPT>' + `\\x3C!-- <script>` + '</p><é' // \\x3C/script"
        );
        assert_eq!(escaped("a <"), "a <");
        assert_eq!(escaped(""), "");
    }

    #[test]
    fn a_template_that_lacks_a_part_is_refused() {
        for part in [HEAD_END, CONTENT] {
            let fault = with_sizes(&PAGE.replacen(part, "", 1), 1, 1).unwrap_err();
            assert!(fault.contains(part) && fault.contains("0 times"), "{fault}");
        }
        let fault = whole(&PAGE.replacen(SCRIPT, &SCRIPT.repeat(2), 1), b"", "").unwrap_err();
        assert!(fault.contains("2 times"), "{fault}");
    }
}
