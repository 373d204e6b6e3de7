//! Whether the program has been told to end.
//!
//! For: [`Told`]. May import: `signal-hook`. Must never know: who asks.

#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Has the program been told to end: by Ctrl-C in the shell that runs it, by `kill`, or because its terminal is gone? Whoever is told so ends in
/// order: a terminal is not to be left without its cursor, figures are to be printed. Other systems than Unix end it at once.
pub struct Told(Arc<AtomicBool>);

impl Told {
    /// Listens from now on.
    pub fn listen() -> io::Result<Self> {
        let told = Self(Arc::default());
        #[cfg(unix)]
        for signal in [SIGTERM, SIGHUP, SIGINT] {
            signal_hook::flag::register(signal, told.0.clone())?;
        }
        Ok(told)
    }
    pub fn to_end(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
