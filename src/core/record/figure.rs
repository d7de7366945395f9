//! Runs embedded in figures: the text of a run file in the `<metadata>` of an SVG, in an iTXt chunk of a PNG, or in a
//! file attached to a PDF. The rest of the file is ignored.

mod pdf;

use std::path::Path;

use super::run_file;
use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::save::load;
use crate::core::run::Run;

/// The keyword of the chunk in a PNG.
pub const KEYWORD: &str = "quadfront run";
/// The name of the file attached to a PDF.
pub const ATTACHED: &str = "quadfront-run.toml";
/// Its type.
pub const ATTACHED_TYPE: &str = "application/x-quadfront-run";
/// The extensions of figures.
pub const EXTENSIONS: [&str; 3] = ["svg", "png", "pdf"];
/// The element in an SVG.
const ELEMENT: &str = "quadfront:run";
/// Maximum length of a run in bytes: cases are small, and meshes are stored as paths.
const LONGEST: usize = 16 << 20;
/// Maximum size of a figure in bytes.
const LARGEST: u64 = 1 << 30;
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Whether a path is a figure, by its extension.
pub fn is_figure(path: &Path) -> bool {
    path.extension().is_some_and(|e| EXTENSIONS.iter().any(|extension| e.eq_ignore_ascii_case(extension)))
}

/// The run embedded in a figure; its `shown` lists the states in the figure.
///
/// # Errors
/// Those of reading the file; a figure without a run, truncated or damaged; and those of [`run_file::parse`].
pub fn read(path: &Path) -> Result<Run, Fault> {
    run_in(path).map_err(|fault| fault.of_kind(FaultKind::Syntax))
}

fn run_in(path: &Path) -> Result<Run, Fault> {
    let place = path.display().to_string();
    if std::fs::metadata(path).is_ok_and(|meta| meta.len() > LARGEST) {
        return Err(Fault::new("The file is too large for a figure").at(place));
    }
    let text = text_in(&load(path)?).map_err(|fault| fault.at(place.clone()))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let run = run_file::parse(&text, &format!("{place}, its run"), folder)?;
    if run.shown.is_none() {
        return Err(Fault::new("The run in the figure does not list the states shown").at(place));
    }
    Ok(run)
}

/// The text of the run in the bytes of an SVG, a PNG or a PDF.
///
/// # Errors
/// Bytes without a run, truncated or damaged.
pub fn text_in(bytes: &[u8]) -> Result<String, Fault> {
    let text = match bytes {
        _ if bytes.starts_with(&SIGNATURE) => in_png(bytes)?,
        _ if bytes.starts_with(pdf::SIGNATURE) => pdf::text_in(bytes)?,
        _ => in_svg(bytes)?,
    };
    if text.len() > LONGEST { Err(too_long()) } else { Ok(text) }
}

fn nothing() -> Fault {
    Fault::new("This figure contains no run")
        .remedy("It was not drawn by quadfront from a case, or another program has removed its metadata")
}

fn too_long() -> Fault {
    Fault::new("The run in the figure is too long")
}

fn damaged() -> Fault {
    Fault::new("The figure is damaged or truncated").remedy("Use the file as quadfront wrote it")
}

fn in_svg(bytes: &[u8]) -> Result<String, Fault> {
    // The run precedes the drawing; bytes after it need not be text.
    let start = format!("<{ELEMENT}");
    let at = find(bytes, start.as_bytes()).ok_or_else(nothing)?;
    let rest = &bytes[at + start.len()..];
    let open = find(rest, b">").ok_or_else(damaged)?;
    let rest = &rest[open + 1..];
    let end = find(rest, format!("</{ELEMENT}").as_bytes()).ok_or_else(damaged)?;
    if end > 6 * LONGEST {
        return Err(too_long());
    }
    let text = std::str::from_utf8(&rest[..end]).map_err(|_| damaged())?;
    unescaped(text).ok_or_else(damaged)
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

/// XML text with entities and CDATA sections resolved; `None` if malformed.
fn unescaped(text: &str) -> Option<String> {
    const CDATA: [&str; 2] = ["<![CDATA[", "]]>"];
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(['&', '<']) {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        if let Some(inside) = rest.strip_prefix(CDATA[0]) {
            let end = inside.find(CDATA[1])?;
            out.push_str(&inside[..end]);
            rest = &inside[end + CDATA[1].len()..];
            continue;
        }
        let (entity, after) = rest.strip_prefix('&')?.split_once(';')?;
        out.push(match entity {
            "amp" => '&',
            "lt" => '<',
            "gt" => '>',
            "quot" => '"',
            "apos" => '\'',
            number => {
                let number = number.strip_prefix('#')?;
                let code = match number.strip_prefix('x') {
                    Some(digits) => u32::from_str_radix(digits, 16),
                    None => number.parse(),
                };
                char::from_u32(code.ok()?)?
            }
        });
        rest = after;
    }
    out.push_str(rest);
    Some(out)
}

/// The `<metadata>` element of an SVG with a run.
pub fn metadata(run: &str) -> String {
    let mut escaped = String::with_capacity(run.len() + run.len() / 8);
    for c in run.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            c => escaped.push(c),
        }
    }
    format!("<metadata><{ELEMENT} xmlns:quadfront=\"urn:quadfront:run\">\n{escaped}</{ELEMENT}></metadata>\n")
}

/// The text of the chunk with [`KEYWORD`]; the lengths of chunks are checked.
fn in_png(bytes: &[u8]) -> Result<String, Fault> {
    let mut rest = &bytes[SIGNATURE.len()..];
    while !rest.is_empty() {
        let (head, after) = rest.split_at_checked(8).ok_or_else(damaged)?;
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let (data, after) = after.split_at_checked(length).ok_or_else(damaged)?;
        let (check, after) = after.split_at_checked(4).ok_or_else(damaged)?;
        match &head[4..] {
            b"IEND" => break,
            b"iTXt" if data.starts_with(KEYWORD.as_bytes()) && data.get(KEYWORD.len()) == Some(&0) => {
                if crc(&rest[4..8 + length]).to_be_bytes() != check {
                    return Err(damaged());
                }
                return itxt(&data[KEYWORD.len() + 1..]);
            }
            _ => rest = after,
        }
    }
    Err(nothing())
}

/// The text of an iTXt chunk after its keyword: compression flag and method, language, translated keyword, text.
fn itxt(data: &[u8]) -> Result<String, Fault> {
    let (flags, rest) = data.split_at_checked(2).ok_or_else(damaged)?;
    if flags[0] != 0 {
        return Err(Fault::new("The run in the figure was compressed by another program, which is not supported")
            .remedy("Use the file as quadfront wrote it"));
    }
    let mut parts = rest.splitn(3, |byte| *byte == 0);
    let text = parts.nth(2).ok_or_else(damaged)?;
    String::from_utf8(text.to_vec()).map_err(|_| damaged())
}

/// The checksum of a PNG chunk (CRC-32 of ISO 3309).
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let body = [&kind[..], data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
    }

    fn png(text: &str) -> Vec<u8> {
        let data = [KEYWORD.as_bytes(), &[0, 0, 0, 0, 0], text.as_bytes()].concat();
        [&SIGNATURE[..], &chunk(b"IHDR", &[0; 13]), &chunk(b"iTXt", &data), &chunk(b"IEND", &[])].concat()
    }

    #[test]
    fn the_checksum_is_that_of_png() {
        assert_eq!(crc(b"IEND"), 0xAE42_6082);
    }

    #[test]
    fn a_run_survives_a_round_trip_through_svg_and_png() {
        let run = "a = '''x < y && \"z\" > 'w'\n\tθ = 1'''\n";
        let svg = format!("<svg>\n<title>t</title>\n{}<path d=\"M0 0\"/></svg>", metadata(run));
        assert_eq!(text_in(svg.as_bytes()).unwrap().trim_start_matches('\n'), run);
        assert_eq!(text_in(&png(run)).unwrap(), run);
        let rewritten = "<quadfront:run a=\"b\"><![CDATA[a < b]]> &amp;&#x3b8;&#39;</quadfront:run >";
        assert_eq!(text_in(rewritten.as_bytes()).unwrap(), "a < b &θ'");
    }

    #[test]
    fn a_truncated_or_damaged_figure_is_a_fault() {
        let whole = png("run = 1");
        for length in 0..whole.len() {
            let read = text_in(&whole[..length]);
            assert!(read.is_err() || length >= whole.len() - 12, "{length}");
        }
        let mut lying = whole.clone();
        lying[8..12].copy_from_slice(&u32::MAX.to_be_bytes());
        assert!(text_in(&lying).unwrap_err().what.contains("damaged"));
        let mut changed = whole;
        let last = changed.len() - 20;
        changed[last] ^= 1;
        assert!(text_in(&changed).unwrap_err().what.contains("damaged"));
        for svg in ["<svg/>", "", "\u{0}", "<quadfront:run", "<quadfront:run>", "<quadfront:run>&bad;</quadfront:run>"]
        {
            assert!(text_in(svg.as_bytes()).is_err(), "{svg}");
        }
    }
}
