//! The run in a PDF: an attached file, found by its type wherever another program that has written the PDF anew has
//! put it. The rest of the file is ignored.

use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_zlib_with_limit};

use super::{ATTACHED_TYPE, LONGEST, damaged, find, nothing, too_long};
use crate::core::fault::Fault;

/// How a PDF begins.
pub(super) const SIGNATURE: &[u8] = b"%PDF-";
/// Maximum length of the dictionary of an attached file.
const LONGEST_HEAD: usize = 1 << 12;

/// The text of the attached run.
pub(super) fn text_in(bytes: &[u8]) -> Result<String, Fault> {
    // The slash of the type is written in several ways.
    let name = ATTACHED_TYPE.rsplit('/').next().unwrap_or(ATTACHED_TYPE);
    let at = find(bytes, name.as_bytes()).ok_or_else(nothing)?;
    let before = &bytes[at.saturating_sub(LONGEST_HEAD)..at];
    let start = before.windows(3).rposition(|three| three == b"obj").ok_or_else(damaged)?;
    let rest = &bytes[at..bytes.len().min(at + LONGEST_HEAD)];
    let stream = find(rest, b"stream").ok_or_else(damaged)?;
    let head = [&before[start..], &rest[..stream]].concat();
    let head = std::str::from_utf8(&head).map_err(|_| damaged())?;
    let after = &bytes[at + stream + b"stream".len()..];
    let data = after.strip_prefix(b"\r\n").or(after.strip_prefix(b"\n")).ok_or_else(damaged)?;
    let data = match number(head, "/Length") {
        Some(length) => {
            let (data, after) = data.split_at_checked(length).ok_or_else(damaged)?;
            let after = after.trim_ascii_start();
            if after.starts_with(b"endstream") { data } else { return Err(damaged()) }
        }
        // The length stands elsewhere.
        None => {
            let end = find(data, b"endstream").ok_or_else(damaged)?;
            let data = &data[..end];
            let data = data.strip_suffix(b"\n").unwrap_or(data);
            data.strip_suffix(b"\r").unwrap_or(data)
        }
    };
    let text = match filter(head)? {
        None => data.to_vec(),
        Some(Deflate) => decompress_to_vec_zlib_with_limit(data, LONGEST + 1)
            .map_err(|error| if error.status == TINFLStatus::HasMoreOutput { too_long() } else { damaged() })?,
    };
    if number(head, "/Size").is_some_and(|size| size != text.len()) {
        return Err(damaged());
    }
    String::from_utf8(text).map_err(|_| damaged())
}

/// The number that follows a key in a dictionary; `None` where it is a reference or no number.
fn number(head: &str, key: &str) -> Option<usize> {
    let rest = head.split_once(key)?.1.trim_start();
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let (digits, rest) = rest.split_at(end);
    // A reference is two numbers and R.
    let rest = rest.trim_start().trim_start_matches(|c: char| c.is_ascii_digit());
    if rest.trim_start().starts_with('R') { None } else { digits.parse().ok() }
}

/// The one compression that is known.
struct Deflate;

/// How the attached file is compressed.
fn filter(head: &str) -> Result<Option<Deflate>, Fault> {
    let filters = head.matches("Decode").count() - head.matches("DecodeParms").count();
    match (head.contains("/Filter"), head.contains("/FlateDecode")) {
        (false, _) => Ok(None),
        (true, true) if filters == 1 && !head.contains("/Predictor") => Ok(Some(Deflate)),
        _ => Err(Fault::new("The run in the figure was compressed by another program, which is not supported")
            .remedy("Use the file as quadfront wrote it")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RUN: &str = "run = 'θ endstream 5 0 obj'\n";

    fn pdf(head: &str, data: &[u8]) -> Vec<u8> {
        let head = format!("%PDF-1.7\n4 0 obj\n<<\n  /Type /EmbeddedFile\n  {head}\n>>\nstream\n");
        [head.as_bytes(), data, b"\nendstream\nendobj\ntrailer"].concat()
    }

    fn head(length: &str) -> String {
        format!("/Subtype /application#2Fx-quadfront-run /Params << /Size {} >> {length}", RUN.len())
    }

    #[test]
    fn a_run_is_read_as_it_was_written_and_as_other_programs_write_it() {
        let length = |data: &[u8]| format!("/Length {}", data.len());
        assert_eq!(text_in(&pdf(&head(&length(RUN.as_bytes())), RUN.as_bytes())).unwrap(), RUN);
        let deflated = miniz_oxide::deflate::compress_to_vec_zlib(RUN.as_bytes(), 6);
        let compressed = head(&format!("{} /Filter /FlateDecode", length(&deflated)));
        assert_eq!(text_in(&pdf(&compressed, &deflated)).unwrap(), RUN);
        let list = head(&format!("/Filter [ /FlateDecode ] /DecodeParms [ null ]\r\n{}", length(&deflated)));
        assert_eq!(text_in(&pdf(&list, &deflated)).unwrap(), RUN);
        // A length that stands elsewhere.
        assert_eq!(text_in(&pdf(&head("/Filter/FlateDecode/Length 7 0 R"), &deflated)).unwrap(), RUN);
    }

    #[test]
    fn what_is_damaged_or_compressed_otherwise_is_a_fault() {
        let told = |bytes: &[u8]| text_in(bytes).unwrap_err().what;
        let whole = pdf(&head(&format!("/Length {}", RUN.len())), RUN.as_bytes());
        for length in 0..whole.len() - b"\nendobj\ntrailer".len() {
            let told = told(&whole[..length]);
            assert!(told.contains("no run") || told.contains("damaged"), "{length}: {told}");
        }
        let deflated = miniz_oxide::deflate::compress_to_vec_zlib(RUN.as_bytes(), 6);
        let with = |filter: &str| told(&pdf(&head(&format!("/Length {} {filter}", deflated.len())), &deflated));
        assert!(with("/Filter /LZWDecode").contains("not supported"));
        assert!(with("/Filter [/ASCII85Decode /FlateDecode]").contains("not supported"));
        assert!(with("/Filter /FlateDecode /DecodeParms << /Predictor 12 >>").contains("not supported"));
        assert!(with("").contains("damaged"), "its length is another one");
        for length in ["/Length 99999999999999999999999", "/Length -1", "/Length 3", "/Length 4000000000"] {
            assert!(told(&pdf(&head(length), RUN.as_bytes())).contains("damaged"), "{length}");
        }
        let bomb = miniz_oxide::deflate::compress_to_vec_zlib(&vec![b'a'; LONGEST + 2], 6);
        let head = format!("/x-quadfront-run /Filter /FlateDecode /Length {}", bomb.len());
        assert!(told(&pdf(&head, &bomb)).contains("too long"));
        assert!(told(b"%PDF-1.7\nx-quadfront-run").contains("damaged"));
    }
}
