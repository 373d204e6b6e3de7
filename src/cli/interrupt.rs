//! Ctrl-C: the first requests an end, the second ends the program with nothing written. Before any part of a
//! picture is done, the first ends the program too.
//!
//! For: [`Interrupt`], and [`LastNote`] for commands that cannot end early.

use super::error::INTERRUPTED;
use super::terminal;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Whether the user has pressed Ctrl-C. Hang-up keeps its default, so that nohup works.
#[derive(Clone, Default)]
pub struct Interrupt {
    requests: Arc<AtomicU32>,
    begun: Arc<AtomicBool>,
    holding: Arc<AtomicBool>,
}

/// What is left of a run that Ctrl-C ends, of a command that cannot end early.
pub struct LastNote(Arc<Mutex<String>>);

impl LastNote {
    /// From now on Ctrl-C ends the program after this note. Where the handler cannot be installed, without.
    pub fn listen(note: impl Into<String>) -> Self {
        let note = Self(Arc::new(Mutex::new(note.into())));
        let last = Self(note.0.clone());
        ctrlc::set_handler(move || end_after(last.lock().clone())).ok();
        note
    }
    /// Another note from now on.
    pub fn set(&self, note: String) {
        *self.lock() = note;
    }
    fn lock(&self) -> MutexGuard<'_, String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Says something below the progress line, if there is one. From a thread of its own: where nobody reads
/// standard error, the handler must still hear Ctrl-C. The receiver hears of the end.
fn note(line: String) -> Receiver<()> {
    let (said, end) = channel();
    std::thread::spawn(move || {
        let below = if std::io::stderr().is_terminal() { "\n" } else { "" };
        terminal::note(&format!("{below}{line}"));
        said.send(()).ok();
    });
    end
}

/// Ends the program after a last word, which may take this long.
fn end_after(line: String) -> ! {
    const LAST_WORD: Duration = Duration::from_secs(1);
    note(line).recv_timeout(LAST_WORD).ok();
    std::process::exit(INTERRUPTED.into())
}

impl Interrupt {
    /// Installs the handler, in background jobs too, which start with the signal ignored. Where that fails,
    /// Ctrl-C keeps its usual meaning.
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let handler = interrupt.clone();
        let listening = ctrlc::set_handler(move || {
            if !handler.begun.load(Ordering::SeqCst) {
                end_after("Ctrl-C came before any part of the picture was done: nothing was written.".into());
            }
            if handler.requests.fetch_add(1, Ordering::SeqCst) == 0 {
                let what = "parts under way are finished, then the picture is written; again ends without it";
                note(format!("Ctrl-C: {what}."));
            } else if !handler.holding.load(Ordering::SeqCst) {
                std::process::exit(INTERRUPTED.into());
            }
        });
        if let Err(error) = listening {
            terminal::warn(&format!("Ctrl-C will end the program without a picture: {error}."));
        }
        interrupt
    }

    /// A new picture begins: until a part of it is done, the first Ctrl-C ends the program.
    pub fn begin(&self) {
        self.begun.store(false, Ordering::SeqCst);
    }

    /// From now on an early end keeps a picture; before, the first Ctrl-C ends the program.
    pub fn set_begun(&self) {
        // Called after every tile by all threads: a load leaves the cache line shared, a store would not.
        if !self.begun.load(Ordering::Relaxed) {
            self.begun.store(true, Ordering::SeqCst);
        }
    }

    /// Has the user requested an end?
    pub fn requested(&self) -> bool {
        self.requests.load(Ordering::SeqCst) > 0
    }

    /// Has the user pressed Ctrl-C again, for an end at once without a picture?
    pub fn insisted(&self) -> bool {
        self.requests.load(Ordering::SeqCst) > 1
    }

    /// Ends [`Interrupt::hold`]. A second Ctrl-C since then ends the program now.
    pub fn release(&self) {
        self.holding.store(false, Ordering::SeqCst);
        if self.insisted() {
            std::process::exit(INTERRUPTED.into());
        }
    }

    /// From now on a second Ctrl-C does not end the program at once: a file is being written, and a partial
    /// file must be removed first. The writer polls [`Interrupt::insisted`].
    pub fn hold(&self) {
        self.holding.store(true, Ordering::SeqCst);
    }
}
