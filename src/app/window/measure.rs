//! How long states and frames take on this machine: shown in the status line, or measured by stepping.

use std::time::Duration;

use web_time::Instant;

use super::session::Goal;

/// How many quadrilaterals to step forward, and back again.
const QUADS: usize = 60;
/// How many leaps to steps all over the run.
const LEAPS: usize = 20;
/// A longer pause between two frames is not the time of a frame.
const PAUSE: Duration = Duration::from_secs(2);

/// The times of the last frames.
#[derive(Clone, Debug, Default)]
pub struct Times {
    frame: Option<Duration>,
    begun: Option<Instant>,
    /// When the program was started, and how long it took from there to the first picture.
    pub started: Option<Instant>,
    first: Option<Duration>,
}

impl Times {
    /// A frame begins; `is_shown`: the frame before has shown a mesh.
    pub fn first(&mut self, is_shown: bool) {
        if is_shown && self.first.is_none() {
            self.first = self.started.map(|started| started.elapsed());
        }
    }

    /// A frame begins. `follows`: the frame before asked for it, so that the time between them is that of a whole
    /// frame, including the work of the graphics card.
    pub fn frame(&mut self, follows: bool) {
        let now = Instant::now();
        if let Some(begun) = self.begun.filter(|_| follows) {
            self.frame = Some(now - begun).filter(|took| *took < PAUSE).or(self.frame);
        }
        self.begun = Some(now);
    }

    /// The times in words, with how long the current state took.
    pub fn told(&self, state: Duration) -> String {
        let told = |time: Option<Duration>, decimals: usize| match time {
            Some(time) => super::words::fixed(1e3 * time.as_secs_f64(), decimals),
            None => super::words::UNDEFINED.to_owned(),
        };
        let first = told(self.first, 0);
        format!("first {first} ms  \u{b7}  state {} ms  \u{b7}  frame {} ms", told(Some(state), 2), told(self.frame, 0))
    }
}

/// Times steps forward and back, and leaps.
#[derive(Clone, Debug)]
pub struct Measuring {
    left: usize,
    /// Times of states and of frames: forward, back, leaping.
    states: [Vec<f64>; 3],
    frames: [Vec<f64>; 3],
    asked: Option<Instant>,
    /// Whether the state came after the frame that asked for it.
    late: bool,
}

impl Default for Measuring {
    fn default() -> Self {
        Measuring {
            left: 2 * QUADS + LEAPS,
            states: Default::default(),
            frames: Default::default(),
            asked: None,
            late: false,
        }
    }
}

impl Measuring {
    /// At the beginning of a frame: the next goal, if the frame before has shown the last one; none while it has not
    /// arrived. `took`: how long its state took. `end`: the last step that is known.
    pub fn next(&mut self, is_there: bool, took: Duration, end: u64) -> Option<Goal> {
        if !is_there {
            self.late = true;
            return None;
        }
        if self.asked.is_some() && std::mem::take(&mut self.late) {
            // It arrived after its frame had begun, and is shown by this one.
            return None;
        }
        let kind = |left: usize| match left.checked_sub(LEAPS) {
            None => 2,
            Some(left) => usize::from(left < QUADS),
        };
        if let Some(asked) = self.asked.take() {
            let kind = kind(self.left);
            self.states[kind].push(1e3 * took.as_secs_f64());
            self.frames[kind].push(1e3 * asked.elapsed().as_secs_f64());
        }
        self.left = self.left.checked_sub(1)?;
        self.asked = Some(Instant::now());
        Some(match kind(self.left) {
            0 => Goal::Quads(1),
            1 => Goal::Quads(-1),
            // Successive leaps go far.
            _ => Goal::Step(end * (self.left * 7 % LEAPS) as u64 / LEAPS as u64),
        })
    }

    /// The result, once the measurement is done.
    pub fn told(&self) -> Option<String> {
        if self.left > 0 || self.asked.is_some() {
            return None;
        }
        let spread = |times: &[f64], decimals: usize| {
            let mut times = times.to_vec();
            times.sort_by(f64::total_cmp);
            let at = |share: f64| times.get((share * times.len().saturating_sub(1) as f64) as usize).copied();
            let told = |share| super::words::fixed(at(share).unwrap_or(f64::NAN), decimals);
            format!("{} ({})", told(0.5), told(1.0))
        };
        let [on, back, leap] = [0, 1, 2].map(|k| (spread(&self.states[k], 2), spread(&self.frames[k], 0)));
        Some(format!(
            "{QUADS} quads forward and back, {LEAPS} leaps; milliseconds, median (largest): state {} forward, \
             {} back, {} leaping; until the picture is drawn {}, {}, {}.",
            on.0, back.0, leap.0, on.1, back.1, leap.1
        ))
    }
}
