//! A series of questions: drawn by a seed, so that a class is asked the same ones, on every machine.

use std::fmt;
use std::str::FromStr;

use super::kind::Kind;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::spelling::suggestion;

/// The most questions of a series.
const MOST: usize = 1000;

/// Which questions are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Series {
    /// The seed.
    pub seed: u64,
    /// How many there are at most.
    pub count: usize,
    /// Of which kinds, which take turns.
    pub kinds: Vec<Kind>,
}

impl Default for Series {
    fn default() -> Self {
        Series { seed: 1, count: 10, kinds: vec![Kind::Segment, Kind::Edge, Kind::Top, Kind::Seam] }
    }
}

/// Reads `seed=7,count=10,kinds=segment+top`; what is not named is as in [`Series::default`].
impl FromStr for Series {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Series, Fault> {
        let fault = |what: String| {
            Fault::new(what).of_kind(FaultKind::Parameter).remedy("Write for example seed=7,count=10,kinds=segment+top")
        };
        let mut series = Series::default();
        for entry in text.split(',').map(str::trim).filter(|entry| !entry.is_empty()) {
            let (key, value) = entry.split_once('=').unwrap_or((entry, ""));
            let (key, value) = (key.trim(), value.trim());
            let wrong = || fault(format!("{key} = \"{}\" is none", value.escape_debug()));
            match key {
                "seed" => series.seed = value.parse().map_err(|_| wrong())?,
                "count" => {
                    series.count = value.parse().map_err(|_| wrong())?;
                    if !(1..=MOST).contains(&series.count) {
                        return Err(fault(format!("A series has 1 to {MOST} questions, not {value}")));
                    }
                }
                "kinds" => series.kinds = value.split('+').map(|name| kind(name.trim())).collect::<Result<_, _>>()?,
                _ => {
                    let unknown = fault(format!("A series of questions has no \"{}\"", key.escape_debug()));
                    return Err(match suggestion(key, ["seed", "count", "kinds"].into_iter()) {
                        Some(near) => unknown.remedy(near),
                        None => unknown,
                    });
                }
            }
        }
        Ok(series)
    }
}

/// A kind of questions that the next step answers.
fn kind(name: &str) -> Result<Kind, Fault> {
    let of_steps = || Kind::ALL.into_iter().filter(|kind| !kind.is_of_state());
    of_steps().find(|kind| kind.name() == name).ok_or_else(|| {
        let names: Vec<&str> = of_steps().map(Kind::name).collect();
        let fault = Fault::new(format!("No series has questions of the kind \"{}\"", name.escape_debug()));
        let known = || format!("Kinds are {}", names.join(", "));
        fault.of_kind(FaultKind::Parameter).remedy(suggestion(name, names.iter().copied()).unwrap_or_else(known))
    })
}

/// As [`Series::from_str`] reads it.
impl fmt::Display for Series {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds: Vec<&str> = self.kinds.iter().map(|kind| kind.name()).collect();
        write!(f, "seed={},count={},kinds={}", self.seed, self.count, kinds.join("+"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_read_as_it_is_written() {
        let read = |text: &str| text.parse::<Series>();
        let series = Series { seed: 7, count: 12, kinds: vec![Kind::Segment, Kind::Count] };
        assert_eq!(read("seed=7,count=12,kinds=segment+count"), Ok(series.clone()));
        assert_eq!(read(&series.to_string()), Ok(series));
        assert_eq!(read(" count = 3 "), Ok(Series { count: 3, ..Series::default() }));
        assert_eq!(read(""), Ok(Series::default()));
        for text in ["seed", "seed=-1", "count=0", "count=1001", "kinds=", "kinds=live", "kinds=segment+x", "sed=1"] {
            assert!(read(text).is_err(), "{text}");
        }
        assert!(read("sead=1").unwrap_err().to_string().contains("seed"));
        assert!(read("kinds=segmant").unwrap_err().to_string().contains("segment"));
    }
}
