//! Ctrl-C: the first requests an end, the second ends the program with nothing written. Before any part of a
//! picture is done, the first ends the program too. SIGTERM and, unless `nohup` has it ignored, SIGHUP
//! request an end as the first Ctrl-C does, however often they come: `timeout` and shells send them twice.

use super::error::INTERRUPTED;
use super::terminal;
#[cfg(unix)]
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    iterator::Signals,
};
use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

static REQUESTS: AtomicU32 = AtomicU32::new(0);
static BEGUN: AtomicBool = AtomicBool::new(false);
static HOLDING: AtomicBool = AtomicBool::new(false);
static LAST_NOTE: Mutex<String> = Mutex::new(String::new());

/// Makes Ctrl-C end the program after a note that says what remains of the run. Does nothing if the handler
/// cannot be installed.
pub fn end_with(note: impl Into<String>) {
    set_last_note(note);
    on_signal(|_| end_after(LAST_NOTE.lock().unwrap_or_else(PoisonError::into_inner).clone())).ok();
}

/// Installs a handler of signals. Its argument is true for Ctrl-C, which, sent again, ends the program at
/// once.
#[cfg(unix)]
fn on_signal(mut handle: impl FnMut(bool) + Send + 'static) -> io::Result<()> {
    let ends = [(!is_hang_up_ignored()).then_some(SIGHUP), Some(SIGTERM), Some(SIGINT)];
    let mut signals = Signals::new(ends.into_iter().flatten())?;
    let listen = move || signals.forever().for_each(|signal| handle(signal == SIGINT));
    std::thread::Builder::new().spawn(listen).map(drop)
}

#[cfg(not(unix))]
fn on_signal(mut handle: impl FnMut(bool) + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || handle(true))
}

/// Tests whether `nohup` started the program; true if the system does not report it.
#[cfg(unix)]
fn is_hang_up_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_none_or(|mask| mask >> (SIGHUP - 1) & 1 == 1)
}

/// Replaces the note of [`end_with`].
pub fn set_last_note(note: impl Into<String>) {
    *LAST_NOTE.lock().unwrap_or_else(PoisonError::into_inner) = note.into();
}

/// Prints a note below the progress line, if there is one, from a thread of its own: if nobody reads standard
/// error, the handler must still receive Ctrl-C. The receiver is notified at the end.
fn note(line: String) -> Receiver<()> {
    let (said, end) = channel();
    std::thread::spawn(move || {
        let below = if io::stderr().is_terminal() { "\n" } else { "" };
        terminal::note(&format!("{below}{line}"));
        said.send(()).ok();
    });
    end
}

/// Ends the program after a note; waits at most `LAST_WORD` for it to be printed.
fn end_after(line: String) -> ! {
    const LAST_WORD: Duration = Duration::from_secs(1);
    note(line).recv_timeout(LAST_WORD).ok();
    std::process::exit(INTERRUPTED.into())
}

/// Installs the handler, in background jobs too, which start with Ctrl-C ignored. Where that fails, signals
/// keep their usual meaning.
pub fn listen() {
    let listening = on_signal(|insists| {
        if !BEGUN.load(Ordering::SeqCst) {
            end_after("Ctrl-C came before any part of the picture was done: nothing was written.".into());
        }
        let before = REQUESTS.load(Ordering::SeqCst);
        if before > 0 && !insists {
            return;
        }
        REQUESTS.store(before + 1, Ordering::SeqCst);
        if before == 0 {
            let what = "parts under way are finished, then the picture is written";
            let [who, again] = if insists { ["Ctrl-C", "again"] } else { ["SIGTERM or SIGHUP", "Ctrl-C"] };
            note(format!("{who}: {what}; {again} ends without it."));
        } else if !HOLDING.load(Ordering::SeqCst) {
            std::process::exit(INTERRUPTED.into());
        }
    });
    if let Err(error) = listening {
        terminal::warn(&format!("Ctrl-C will end the program without a picture: {error}."));
    }
}

/// Marks the start of a new picture: until a part of it is done, the first Ctrl-C ends the program.
pub fn begin() {
    BEGUN.store(false, Ordering::SeqCst);
}

/// Declares that a part of the picture is done: an early end now keeps it. Before, the first Ctrl-C ends the
/// program.
pub fn set_begun() {
    // Called after every tile by all threads: a load leaves the cache line shared, a store would not.
    if !BEGUN.load(Ordering::Relaxed) {
        BEGUN.store(true, Ordering::SeqCst);
    }
}

/// Tests whether the user requested an end.
pub fn requested() -> bool {
    REQUESTS.load(Ordering::SeqCst) > 0
}

/// Tests whether the user pressed Ctrl-C again, to end at once without a picture.
pub fn insisted() -> bool {
    REQUESTS.load(Ordering::SeqCst) > 1
}

/// Keeps a second Ctrl-C from ending the program at once: a file is being written, and a partial file must be
/// removed first. The writer polls [`insisted`].
pub fn hold() {
    HOLDING.store(true, Ordering::SeqCst);
}

/// Reverts [`hold`]. If a second Ctrl-C came since then, the program ends now.
pub fn release() {
    HOLDING.store(false, Ordering::SeqCst);
    if insisted() {
        std::process::exit(INTERRUPTED.into());
    }
}
