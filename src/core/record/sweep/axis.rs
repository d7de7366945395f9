//! An axis of a sweep: a parameter and the values that it takes.

use super::MOST_CELLS;
use crate::core::case::{ParameterKind, Parameters};
use crate::core::fault::{Fault, FaultKind};

/// The form of an axis, for messages.
const FORM: &str = "Write KEY=FROM:TO:STEP or KEY=VALUE,VALUE, for example c=1.5:3:0.25 or selection=table1,level";

/// The largest number of digits, and power of ten, of a number of a range.
const DIGITS: usize = 18;
const POWER: i32 = 18;

/// A parameter and its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// The key.
    pub key: &'static str,
    /// The values, each as [`Parameters::text_of`] writes it; angles in degrees.
    pub values: Vec<String>,
}

impl Axis {
    /// Parses `KEY=FROM:TO:STEP`, both ends included, or `KEY=VALUE,VALUE,...`. The values of a range are computed in
    /// decimals, without rounding.
    ///
    /// # Errors
    /// Another form, an unknown key, a value of the wrong type or out of range, a value that is there twice, too many
    /// values.
    pub fn parse(text: &str) -> Result<Axis, Fault> {
        Axis::parsed(text).map_err(|fault| fault.of_kind(FaultKind::Parameter).at(text))
    }

    fn parsed(text: &str) -> Result<Axis, Fault> {
        let Some((key, values)) = text.split_once('=') else {
            return Err(Fault::new("This names no values").remedy(FORM));
        };
        let (key, values) = (key.trim(), values.trim());
        let mut parameters = Parameters::default();
        let Some(&key) = Parameters::KEYS.iter().find(|known| **known == key) else {
            // The fault of an unknown key.
            parameters.set(key, values)?;
            return Err(Fault::new("This is no parameter").remedy(FORM));
        };
        let takes_numbers = Parameters::kind_of(key).is_some_and(|kind| kind.limits().is_some());
        let texts: Vec<String> = if takes_numbers && values.contains(':') {
            range(values)?
        } else {
            values.split(',').map(|value| value.trim().to_owned()).collect()
        };
        let mut values: Vec<String> = Vec::with_capacity(texts.len());
        for text in texts {
            parameters.set(key, &text)?;
            let value = parameters.text_of(key).unwrap_or(text);
            if values.contains(&value) {
                return Err(Fault::new(format!("The value {value} is there twice")).remedy("Name each value once"));
            }
            values.push(value);
        }
        Ok(Axis { key, values })
    }

    /// The unit of the values: degrees of angles, else none.
    pub fn unit(&self) -> &'static str {
        if matches!(Parameters::kind_of(self.key), Some(ParameterKind::Angle(_))) { "°" } else { "" }
    }

    /// The key with one of its values: `theta_rect = 110°`.
    pub fn with_value(&self, value: &str) -> String {
        // An empty list of loops or faces stands for all of them.
        format!("{} = {}{}", self.key, if value.is_empty() { "(all)" } else { value }, self.unit())
    }
}

/// The values of `FROM:TO:STEP` as decimal numbers.
fn range(text: &str) -> Result<Vec<String>, Fault> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let [from, to, step] = parts[..] else {
        return Err(Fault::new("A range has three numbers").remedy(FORM));
    };
    let read = |text: &str| {
        decimal(text).ok_or_else(|| Fault::new(format!("\"{}\" is not a number", text.escape_debug())).remedy(FORM))
    };
    let [from, to, step] = [read(from)?, read(to)?, read(step)?];
    let power = from.1.min(to.1).min(step.1);
    let [first, last, step] = [from, to, step].map(|(digits, own)| digits * 10_i128.pow((own - power).unsigned_abs()));
    if step <= 0 || last < first {
        return Err(Fault::new("A range goes from the smaller number to the larger one, by a positive step")
            .remedy("Write FROM:TO:STEP, for example 1.5:3:0.25"));
    }
    let count = (last - first) / step + 1;
    if count > MOST_CELLS as i128 {
        return Err(Fault::new(format!("The range has {count} values; a sweep may have {MOST_CELLS} cells"))
            .remedy("Take a larger step"));
    }
    Ok((0..count).map(|k| decimal_text(first + k * step, power)).collect())
}

/// A decimal number as digits times a power of ten: `-1.25e3` is (-125, 1).
fn decimal(text: &str) -> Option<(i128, i32)> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let (sign, whole) = whole.strip_prefix('-').map_or((1, whole), |whole| (-1, whole));
    let digits = format!("{whole}{part}");
    let is_number = !digits.is_empty() && digits.len() <= DIGITS && digits.bytes().all(|b| b.is_ascii_digit());
    let power = exponent.checked_sub(part.len() as i32)?;
    if !is_number || power.abs() > POWER {
        return None;
    }
    Some((sign * digits.parse::<i128>().ok()?, power))
}

/// Digits times a power of ten, written without an exponent or trailing zeros.
fn decimal_text(digits: i128, power: i32) -> String {
    let sign = if digits < 0 { "-" } else { "" };
    let digits = digits.unsigned_abs().to_string();
    if power >= 0 {
        let zeros = if digits == "0" { 0 } else { power as usize };
        return format!("{sign}{digits}{}", "0".repeat(zeros));
    }
    let after = power.unsigned_abs() as usize;
    let padded = format!("{digits:0>width$}", width = after + 1);
    let (whole, part) = padded.split_at(padded.len() - after);
    let part = part.trim_end_matches('0');
    if part.is_empty() { format!("{sign}{whole}") } else { format!("{sign}{whole}.{part}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        Axis::parse(text).unwrap().values
    }

    #[test]
    fn ranges_have_both_ends_and_no_rounding_errors() {
        assert_eq!(values("c=1.5:3:.25"), ["1.5", "1.75", "2", "2.25", "2.5", "2.75", "3"]);
        assert_eq!(values("theta_rect=110:150:5").len(), 9);
        assert_eq!(values("theta_rect = 110 : 118 : 5"), ["110", "115"], "a range ends before what lies beyond");
        assert_eq!(values("eps1=0:0.3:0.1"), ["0", "0.1", "0.2", "0.3"], "0.1 + 0.2 is 0.3");
        assert_eq!(values("size_scale=1e-3:3E-3:1e-3"), ["0.001", "0.002", "0.003"]);
        assert_eq!(values("max_quads=1e3:3e3:1e3"), ["1000", "2000", "3000"]);
        assert_eq!(values("layers=0:4:2"), ["0", "2", "4"]);
        assert_eq!(values("c=2:2:1"), ["2"]);
        // A tenth cannot be written in binary: adding it up a thousand times would miss the end.
        let tenths = values("c=1:101:.1");
        assert_eq!((tenths.len(), tenths[3].as_str(), tenths[1000].as_str()), (1001, "1.3", "101"));
    }

    #[test]
    fn lists_have_numbers_words_flags_and_names() {
        assert_eq!(values("c=2,1.50,3"), ["2", "1.5", "3"], "in their order");
        assert_eq!(values("selection=table1, level"), ["table1", "level"]);
        assert_eq!(values("smoothing=true,false"), ["true", "false"]);
        assert_eq!(values("faces=left,left;right"), ["left", "left; right"]);
        assert_eq!(Axis::parse("theta_rect=120").unwrap().unit(), "°");
        assert_eq!(Axis::parse("c=2").unwrap().unit(), "");
        assert_eq!(Axis::parse("faces=").unwrap().with_value(""), "faces = (all)");
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place_and_a_remedy() {
        for (text, what) in [
            ("c", "names no values"),
            ("theta_rekt=110:150:5", "\"theta_rekt\" is not known"),
            ("c=1:2", "three numbers"),
            ("c=1:2:3:4", "three numbers"),
            ("c=1:two:.5", "\"two\" is not a number"),
            ("c=1:2:0", "positive step"),
            ("c=3:1:.5", "from the smaller"),
            ("c=1:2:1e-9", "1000000001 values"),
            ("c=1:2:1e-99", "not a number"),
            ("c=0:3:1", "c = 0 is out of range"),
            ("theta_rect=80,120", "theta_rect = 80 is out of range"),
            ("layers=0:1:.5", "not a whole number"),
            ("selection=table1,tabel1", "not known"),
            ("c=2,2.0", "2 is there twice"),
            ("c=", "not a number"),
        ] {
            let fault = Axis::parse(text).unwrap_err();
            assert!(fault.what.contains(what), "{text}: {fault}");
            assert!(fault.place == text && !fault.remedy.is_empty(), "{text}: {fault}");
        }
    }
}
