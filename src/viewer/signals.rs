//! Signals that end the program: Ctrl-C, `kill`, a closed terminal.
//!
//! For: [`ExitSignal`].

#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set when SIGINT, SIGTERM or SIGHUP arrives, so that the program can end in order: it restores the terminal
/// and prints its figures. On systems other than Unix the signals end the program at once.
pub struct ExitSignal(Arc<AtomicBool>);

impl ExitSignal {
    /// Installs the signal handlers.
    pub fn register() -> io::Result<Self> {
        let exit = Self(Arc::default());
        #[cfg(unix)]
        for signal in [SIGTERM, SIGHUP, SIGINT] {
            signal_hook::flag::register(signal, exit.0.clone())?;
        }
        Ok(exit)
    }
    pub fn received(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
