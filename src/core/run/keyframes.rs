//! Stored states of a run, sorted by step: a few as whole meshes, the others as differences from the one before. Any
//! state is a few steps from the nearest one.

use crate::core::convert::Converter;
use crate::core::mesh::{Difference, Mesh};

/// A stored state, before the edits of its step are applied.
#[derive(Clone)]
pub struct Keyframe {
    /// Its step.
    pub step: u64,
    /// Everything but the mesh.
    rest: Converter<'static>,
    /// The mesh, where it is stored whole.
    full: Option<Mesh>,
    /// The difference from the keyframe before; none in the first one.
    difference: Option<Difference>,
}

impl Keyframe {
    /// The first keyframe.
    pub(super) fn first(rest: Converter<'static>, mesh: Mesh) -> Keyframe {
        Keyframe { step: 0, rest, full: Some(mesh), difference: None }
    }

    /// A keyframe that follows another.
    pub(super) fn after(step: u64, rest: Converter<'static>, difference: Difference, full: Option<Mesh>) -> Keyframe {
        Keyframe { step, rest, full, difference: Some(difference) }
    }

    /// The difference from the keyframe before; none in the first one.
    pub(super) fn difference(&self) -> Option<&Difference> {
        self.difference.as_ref()
    }

    fn bytes_of_difference(&self) -> usize {
        let difference = self.difference.as_ref().map_or(0, Difference::bytes);
        size_of::<Self>() + difference + self.rest.bytes_of_rest()
    }

    fn bytes_of_mesh(&self) -> usize {
        self.full.as_ref().map_or(0, Mesh::bytes)
    }
}

/// Keyframes sorted by step, the first at step 0.
#[derive(Clone)]
pub struct Keyframes {
    frames: Vec<Keyframe>,
    /// Keyframes closer than this are merged.
    spacing: u64,
    bytes_of_meshes: usize,
    bytes_of_differences: usize,
}

impl Keyframes {
    /// Starts with the first keyframe.
    pub(super) fn new(first: Keyframe) -> Keyframes {
        let mut keyframes = Keyframes { frames: Vec::new(), spacing: 1, bytes_of_meshes: 0, bytes_of_differences: 0 };
        keyframes.push(first);
        keyframes
    }

    /// All of them.
    pub(super) fn frames(&self) -> &[Keyframe] {
        &self.frames
    }

    /// The index of the last keyframe at or before a step.
    pub(super) fn at_or_before(&self, step: u64) -> usize {
        self.frames.partition_point(|frame| frame.step <= step) - 1
    }

    /// The state of a keyframe; it reuses the memory of a spare mesh.
    pub(super) fn state(&self, index: usize, spare: Mesh) -> Converter<'static> {
        let whole = self.frames[..=index].iter().rposition(|frame| frame.full.is_some());
        let whole = whole.expect("the first keyframe is whole");
        let mut mesh = spare;
        if let Some(full) = &self.frames[whole].full {
            mesh.become_same(full);
        }
        for frame in &self.frames[whole + 1..=index] {
            if let Some(difference) = &frame.difference {
                mesh.apply(difference);
            }
        }
        self.frames[index].rest.with_mesh(mesh)
    }

    /// Appends a keyframe.
    pub(super) fn push(&mut self, frame: Keyframe) {
        self.bytes_of_meshes += frame.bytes_of_mesh();
        self.bytes_of_differences += frame.bytes_of_difference();
        self.frames.push(frame);
        let last = self.frames.len() - 1;
        if last >= 2 && self.frames[last].step - self.frames[last - 2].step < self.spacing {
            self.merge(last - 1);
        }
    }

    /// Drops a keyframe that is not whole; the next one takes over its difference.
    fn merge(&mut self, index: usize) {
        if self.frames[index].full.is_some() {
            return;
        }
        let gone = self.frames.remove(index);
        self.bytes_of_differences -= gone.bytes_of_difference();
        let next = &mut self.frames[index];
        self.bytes_of_differences -= next.bytes_of_difference();
        next.difference = match (&gone.difference, &next.difference) {
            (Some(before), Some(later)) => Some(before.and(later)),
            _ => unreachable!("only the first keyframe has no difference, and it is whole"),
        };
        self.bytes_of_differences += next.bytes_of_difference();
    }

    /// The memory they take, in bytes.
    pub fn bytes(&self) -> usize {
        self.bytes_of_meshes + self.bytes_of_differences
    }

    /// Drops every second whole mesh, and then every second keyframe, until meshes and differences take no more than
    /// `budget` bytes each, as far as possible.
    pub(super) fn thin(&mut self, budget: usize) {
        while self.bytes_of_meshes > budget && self.frames[1..].iter().any(|frame| frame.full.is_some()) {
            let mut keep = true;
            for frame in &mut self.frames {
                if frame.full.is_some() {
                    if !keep {
                        self.bytes_of_meshes -= frame.bytes_of_mesh();
                        frame.full = None;
                    }
                    keep = !keep;
                }
            }
        }
        while self.bytes_of_differences > budget && self.frames.len() > 8 {
            let before = self.bytes_of_differences;
            let span = self.frames.last().map_or(0, |frame| frame.step);
            self.spacing = (2 * self.spacing).max(2 * span / self.frames.len() as u64);
            let mut frames: Vec<Keyframe> = Vec::with_capacity(self.frames.len());
            for frame in std::mem::take(&mut self.frames) {
                let mut next = frame;
                let previous = frames.len().checked_sub(2).map(|i| frames[i].step);
                if frames.last().is_some_and(|last| last.full.is_none())
                    && previous.is_some_and(|step| next.step - step < self.spacing)
                    && let Some(gone) = frames.pop()
                    && let (Some(first), Some(second)) = (&gone.difference, &next.difference)
                {
                    next.difference = Some(first.and(second));
                }
                frames.push(next);
            }
            self.frames = frames;
            self.bytes_of_differences = self.frames.iter().map(Keyframe::bytes_of_difference).sum();
            if self.bytes_of_differences == before && self.spacing > span {
                break;
            }
        }
    }

    /// Drops all keyframes after a step.
    pub(super) fn truncate(&mut self, step: u64) {
        self.frames.truncate(self.at_or_before(step) + 1);
        self.bytes_of_meshes = self.frames.iter().map(Keyframe::bytes_of_mesh).sum();
        self.bytes_of_differences = self.frames.iter().map(Keyframe::bytes_of_difference).sum();
    }
}
