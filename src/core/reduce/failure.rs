//! What is the same about two failures whatever their names and numbers: of cases that are refused, and of panics.

use std::any::Any;

use crate::core::fault::{Fault, FaultKind};

/// Longest message of a panic that is kept.
const LONGEST: usize = 300;
/// Where the compiler puts the sources of other crates: what follows is the same on every machine.
const ROOTS: [&str; 2] = ["/registry/src/", "/rustc/"];

/// A panic, an abort or a stack overflow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Panic {
    /// File, line and column, where they are known.
    pub place: Option<String>,
    /// The first line of the message.
    pub message: String,
}

/// A failure without names and numbers, so that the failures of two cases can be compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Failure {
    Refusal(FaultKind, Vec<String>),
    Panic(Option<String>, Vec<String>),
}

impl Panic {
    /// A panic of which only the message is known.
    pub fn saying(message: &str) -> Panic {
        let line = message.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        Panic { place: None, message: line.trim().chars().take(LONGEST).collect() }
    }

    /// A panic that was caught.
    pub fn caught(payload: &(dyn Any + Send)) -> Panic {
        let text = payload.downcast_ref::<&str>().copied();
        Panic::saying(text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or_default())
    }

    /// The panic that ended a process, by what it wrote to standard error: the last one, since readers of other crates
    /// may have had one caught before.
    pub fn written(text: &str) -> Option<Panic> {
        let mut last: Option<Panic> = None;
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            let found = match line.strip_prefix("thread ") {
                Some(rest) if rest.contains(" has overflowed its stack") => Panic::saying("stack overflow"),
                Some(rest) => match rest.split_once(" panicked at ") {
                    Some((_, place)) => {
                        let place = without_root(place.trim_end().trim_end_matches(':'));
                        Panic { place: Some(place), ..Panic::saying(lines.next().unwrap_or_default()) }
                    }
                    None => continue,
                },
                None if line.starts_with("memory allocation of ") => Panic::saying(line),
                None => continue,
            };
            // A panic that cannot unwind is followed by another one, which does not say why.
            if last.is_none() || !found.message.starts_with("panic in a ") {
                last = Some(found);
            }
        }
        last
    }

    /// What happened, a sentence without its full stop.
    pub(super) fn sentence(&self) -> String {
        let place = self.place.as_ref().map_or_else(String::new, |place| format!(" at {place}"));
        let message = if self.message.is_empty() { String::new() } else { format!(": {}", self.message) };
        format!("The program panics{place}{}", message.trim_end_matches('.'))
    }
}

impl Failure {
    /// What is the same about refusals: the kind of the fault and its words.
    pub fn of_fault(fault: &Fault) -> Failure {
        Failure::Refusal(fault.kind(), words(&fault.what))
    }

    /// What is the same about panics: the place in the source, and the words.
    pub fn of_panic(panic: &Panic) -> Failure {
        Failure::Panic(panic.place.clone(), words(&panic.message))
    }

    /// Whether a limit was exceeded.
    pub fn is_limit(&self) -> bool {
        matches!(self, Failure::Refusal(FaultKind::Limit, _))
    }
}

/// The words of a message without what follows a colon or a parenthesis, names in quotes, numbers, and the s of
/// plurals.
fn words(message: &str) -> Vec<String> {
    let unquoted: String = message.split('"').step_by(2).collect::<Vec<_>>().join(" ");
    let head = unquoted.split([':', '(']).next().unwrap_or_default();
    let words = head.split_whitespace().map(|word| word.trim_matches(|c: char| !c.is_alphanumeric()));
    let is_word = |word: &&str| !word.is_empty() && !word.contains(|c: char| c.is_ascii_digit()) && *word != "and";
    words.filter(is_word).map(|word| word.trim_end_matches('s').to_owned()).collect()
}

/// A path in the sources without the folder of another crate or of the standard library.
fn without_root(place: &str) -> String {
    let place = place.replace('\\', "/");
    let after = ROOTS.iter().find_map(|root| place.split_once(root)?.1.split_once('/'));
    after.map_or(place.clone(), |(_, inner)| inner.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_alike_whatever_their_names_and_numbers() {
        let head = |what: &str| Failure::of_fault(&Fault::new(what).of_kind(FaultKind::Mesh));
        assert_eq!(head("The loop \"a b\" has 27 segments (at 0, 1)"), head("The loop \"hole\" has 1 segment"));
        assert_eq!(head("Triangles 3, 7 and 9 overlap: they lie on"), head("Triangles 1 and 2 overlap"));
        assert_ne!(head("Triangles 1 and 2 overlap"), head("Triangles 1 and 2 are the same"));
        assert_ne!(head("It fails"), Failure::of_fault(&Fault::new("It fails").of_kind(FaultKind::Metric)));
    }

    #[test]
    fn the_panic_that_ends_a_process_is_the_last_one_that_says_why() {
        let text = "Reading\n\nthread 'main' (77) panicked at src/core/a.rs:3:5:\nindex out of bounds: the len is 5\n\
                    note: run with `RUST_BACKTRACE=1` environment variable to display a backtrace\n";
        let panic = Panic::written(text).unwrap();
        assert_eq!(panic.sentence(), "The program panics at src/core/a.rs:3:5: index out of bounds: the len is 5");
        let other = |text: &str| Failure::of_panic(&Panic::written(text).unwrap());
        let own = Failure::of_panic(&panic);
        assert_eq!(
            own,
            other("thread '<unnamed>' panicked at src/core/a.rs:3:5:\nindex out of bounds: the len is 9\n")
        );
        assert_ne!(own, other("thread 'main' panicked at src/core/a.rs:4:5:\nindex out of bounds: the len is 5\n"));
        assert_ne!(own, other("thread 'main' panicked at src/core/a.rs:3:5:\nattempt to subtract with overflow\n"));
        let aborted = format!(
            "thread 'main' panicked at src/b.rs:1:1:\ncaught\n{text}\
             thread 'main' panicked at library/core/src/panicking.rs:230:5:\npanic in a function that cannot unwind\n"
        );
        assert_eq!(Panic::written(&aborted), Some(panic));
        assert_eq!(Panic::written("error: The case is refused\n"), None);
    }

    #[test]
    fn overflows_and_exhausted_memory_are_told_and_places_are_those_of_every_machine() {
        let said = |text: &str| Panic::written(text).unwrap();
        let overflow = "\nthread 'main' (5) has overflowed its stack\nfatal runtime error: stack overflow, aborting\n";
        assert_eq!(said(overflow), Panic::saying("stack overflow"));
        let [a, b] = [4096, 77].map(|n| said(&format!("memory allocation of {n} bytes failed\n")));
        assert_eq!(Failure::of_panic(&a), Failure::of_panic(&b));
        for (path, place) in [
            ("/home/me/.cargo/registry/src/index.crates.io-1949/core-1.13.0/src/a.rs", "core-1.13.0/src/a.rs"),
            ("C:\\Users\\me\\registry\\src\\index-1\\b-1.0.0\\src\\lib.rs", "b-1.0.0/src/lib.rs"),
            ("/rustc/59807616e1fa2540724bfbac14d7976d7e4a3860/library/std/src/io.rs", "library/std/src/io.rs"),
        ] {
            let panic = said(&format!("thread 'main' panicked at {path}:9:1:\nno\n"));
            assert_eq!(panic.place, Some(format!("{place}:9:1")));
        }
        assert_eq!(Panic::caught(&"plain").message, "plain");
        assert_eq!(Panic::caught(&format!("of {}", 3)).message, "of 3");
    }
}
