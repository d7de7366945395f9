//! Percent-encoding (RFC 3986, section 2.1) of values in links, and of addresses in files.

/// What stands for itself beside letters and digits: the unreserved characters, and others that a fragment may have
/// and that separate no words.
const PLAIN: &[u8] = b"-._~,:/";

/// A text in which everything but letters, digits and [`PLAIN`] is encoded.
pub fn encoded(text: &str) -> String {
    let mut encoded = String::with_capacity(text.len());
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || PLAIN.contains(&byte) {
            encoded.push(char::from(byte));
        } else {
            encoded.push_str(&format!("%{byte:02X}"));
        }
    }
    encoded
}

/// The text that was encoded; `None` where two hexadecimal digits are missing after a percent sign, or where what is
/// encoded is not UTF-8.
pub fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let byte;
        (byte, rest) = match (first, after) {
            (b'%', [high, low, after @ ..]) => (16 * digit(*high)? + digit(*low)?, after),
            (b'%', _) => return None,
            (plain, after) => (plain, after),
        };
        bytes.push(byte);
    }
    String::from_utf8(bytes).ok()
}

fn digit(byte: u8) -> Option<u8> {
    char::from(byte).to_digit(16).and_then(|digit| u8::try_from(digit).ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_would_end_a_word_is_encoded_and_what_is_cut_off_is_refused() {
        assert_eq!(encoded("a b&c=1.5,2#%"), "a%20b%26c%3D1.5,2%23%25");
        assert_eq!(encoded("\u{3b8}"), "%CE%B8");
        assert_eq!(decoded("%ce%B8+1").as_deref(), Some("\u{3b8}+1"));
        for bad in ["%", "%4", "a%", "%4g", "%+1", "%ff"] {
            assert_eq!(decoded(bad), None, "{bad}");
        }
    }

    proptest! {
        #[test]
        fn any_text_survives_a_round_trip(text in any::<String>()) {
            let encoded = encoded(&text);
            prop_assert!(encoded.bytes().all(|b| b.is_ascii_graphic() && !b"&=#".contains(&b)));
            prop_assert_eq!(decoded(&encoded), Some(text));
        }
    }
}
