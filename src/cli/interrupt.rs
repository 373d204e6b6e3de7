//! Ctrl-C: the first asks for an end, the second is the end.
//!
//! For: [`Interrupt`]. May import: `ctrlc`. Must never know: what is interrupted.

use super::INTERRUPTED;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Has the user asked for an end? Ctrl-C asks; hang-up is left alone, so that nohup works.
#[derive(Clone, Default)]
pub struct Interrupt {
    asked: Arc<AtomicBool>,
    holding: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens from now on, in background jobs too, which start with the signal ignored. Where that is impossible, Ctrl-C keeps its
    /// usual meaning.
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let heard = interrupt.clone();
        let listening = ctrlc::set_handler(move || {
            let again = heard.asked.swap(true, Ordering::SeqCst);
            if again && !heard.holding.load(Ordering::SeqCst) {
                std::process::exit(INTERRUPTED.into());
            }
        });
        if let Err(error) = listening {
            super::terminal::warn(&format!("Ctrl-C will end the program without a picture: {error}."));
        }
        interrupt
    }

    /// Has the user asked?
    pub fn asked(&self) -> bool {
        self.asked.load(Ordering::SeqCst)
    }

    /// From now on a second Ctrl-C no longer ends the program: a file is being written, which takes a moment and must
    /// not stay half done.
    pub fn hold(&self) {
        self.holding.store(true, Ordering::SeqCst);
    }
}
