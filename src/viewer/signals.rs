//! Signals that end the program: Ctrl-C, `kill`, a closed terminal.
//!
//! For: [`exit_flag`].

#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A flag that is set when SIGINT, SIGTERM or SIGHUP arrives, so that the program can end in order: it
/// restores the terminal and prints its figures. On systems other than Unix the signals end the program at
/// once.
pub fn exit_flag() -> io::Result<Arc<AtomicBool>> {
    let exit = Arc::default();
    #[cfg(unix)]
    for signal in [SIGTERM, SIGHUP, SIGINT] {
        signal_hook::flag::register(signal, Arc::clone(&exit))?;
    }
    Ok(exit)
}
