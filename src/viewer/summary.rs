//! What a run of the viewer took: for whoever measures it.
//!
//! For: [`Summary`]. May import: the standard library. Must never know: windows, the state machine.

use std::time::Duration;

/// Sums over all frames.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    pub frames: u64,
    /// Samples of whole pictures.
    pub samples: f64,
    /// Time in which samples were taken, and in which frames were painted: filters, colours, figures.
    pub tracing: Duration,
    pub painting: Duration,
    /// Until the last frame.
    pub elapsed: Duration,
    /// From an event to the frame that answers it: the longest, and the sum of so many.
    pub slowest_answer: Duration,
    pub answers: Duration,
    pub answered: u64,
    /// From asking for another scene to its first frame: the longest.
    pub slowest_switch: Option<Duration>,
}

impl Summary {
    /// A frame is handed over, so long after the one before, and an event so long after it happened.
    pub fn frame(&mut self, after: Duration, answer: Option<Duration>) {
        self.elapsed += after;
        self.frames += 1;
        if let Some(answer) = answer {
            self.slowest_answer = self.slowest_answer.max(answer);
            self.answers += answer;
            self.answered += 1;
        }
    }
    /// Another scene shows, so long after it was asked for.
    pub fn switched(&mut self, after: Duration) {
        self.slowest_switch = self.slowest_switch.max(Some(after));
    }
}
