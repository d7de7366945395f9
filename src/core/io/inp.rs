//! inp: being written.
