//! Ctrl-C: the first asks for an end, the second is the end, with nothing written. So is the first where there is nothing to write yet.
//!
//! For: [`Interrupt`]. May import: `ctrlc`, `terminal`. Must never know: what is interrupted.

use super::{INTERRUPTED, terminal};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Has the user asked for an end? Ctrl-C asks; hang-up is left alone, so that nohup works.
#[derive(Clone, Default)]
pub struct Interrupt {
    /// How often.
    asked: Arc<AtomicU32>,
    begun: Arc<AtomicBool>,
    holding: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens from now on, in background jobs too, which start with the signal ignored. Where that is impossible, Ctrl-C keeps its
    /// usual meaning.
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let heard = interrupt.clone();
        let listening = ctrlc::set_handler(move || {
            if !heard.begun.load(Ordering::SeqCst) {
                // Below the line that may tell the progress.
                let line = if std::io::stderr().is_terminal() { "\n" } else { "" };
                terminal::note(&format!(
                    "{line}Ctrl-C came before any part of the picture was done: nothing was written."
                ));
                std::process::exit(INTERRUPTED.into());
            }
            let again = heard.asked.fetch_add(1, Ordering::SeqCst) > 0;
            if again && !heard.holding.load(Ordering::SeqCst) {
                std::process::exit(INTERRUPTED.into());
            }
        });
        if let Err(error) = listening {
            terminal::warn(&format!("Ctrl-C will end the program without a picture: {error}."));
        }
        interrupt
    }

    /// From now on there is something that an early end can keep: before, the first Ctrl-C ends the program.
    pub fn begun(&self) {
        // Told after every tile, from all threads: one that only reads takes the line from nobody.
        if !self.begun.load(Ordering::Relaxed) {
            self.begun.store(true, Ordering::SeqCst);
        }
    }

    /// As Ctrl-C does.
    #[cfg(test)]
    pub fn ask(&self) {
        self.asked.fetch_add(1, Ordering::SeqCst);
    }
    /// Has the user asked?
    pub fn asked(&self) -> bool {
        self.asked.load(Ordering::SeqCst) > 0
    }

    /// Has the user asked more than once: an end at once, and no picture?
    pub fn insisted(&self) -> bool {
        self.asked.load(Ordering::SeqCst) > 1
    }

    /// From now on a second Ctrl-C no longer ends the program: a file is being written, and the half of it has to be taken away. Whoever
    /// writes looks at [`Interrupt::insisted`].
    pub fn hold(&self) {
        self.holding.store(true, Ordering::SeqCst);
    }
}
