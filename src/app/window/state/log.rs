//! The log of all messages of a window.

use std::collections::VecDeque;
use std::time::Duration;

use web_time::Instant;

/// How many messages are kept.
const MOST: usize = 500;

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    pub text: String,
    /// Whether it says that something went wrong.
    pub is_fault: bool,
    /// The time since the window was opened.
    pub at: Duration,
    /// The step that was shown; none if nothing was open.
    pub step: Option<u64>,
}

/// All messages of a window, the oldest first.
pub struct MessageLog {
    pub messages: VecDeque<Message>,
    opened: Instant,
}

impl Default for MessageLog {
    fn default() -> Self {
        MessageLog { messages: VecDeque::new(), opened: Instant::now() }
    }
}

impl MessageLog {
    /// Keeps a message.
    pub(super) fn keep(&mut self, text: String, is_fault: bool, step: Option<u64>) {
        if self.messages.len() == MOST {
            self.messages.pop_front();
        }
        self.messages.push_back(Message { text, is_fault, at: self.opened.elapsed(), step });
    }
}
