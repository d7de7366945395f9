//! What `make soak` and whoever looks for a failure set in the environment.

/// The whole number that a variable gives: `QUADFRONT_SOAK_ROUNDS` (rounds of property tests), `QUADFRONT_SEED` and
/// others.
pub fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{variable}={text} is no number")))
}
