//! Shows frames in a terminal, as half blocks in true colour, and sends its keys.
//!
//! Most terminals do not report key releases. There a key counts as held for `KEY_TIMEOUT` after each press
//! or repetition.

use super::cell_buffer::CellBuffer;
use super::frame::Frame;
use super::keys::{self, Action, Key};
use super::options::Options;
use super::playlist::Playlist;
use super::session::{Viewer, exit_flag};
use super::state::Event;
use super::timing::Summary;
use crossterm::event::{
    self, DisableBracketedPaste, DisableFocusChange, DisableMouseCapture, EnableBracketedPaste,
    EnableFocusChange, EnableMouseCapture, KeyEventKind, KeyModifiers, KeyboardEnhancementFlags,
    MouseEventKind, PopKeyboardEnhancementFlags, PushKeyboardEnhancementFlags,
};
use crossterm::style::ResetColor;
use crossterm::{cursor, execute, terminal as screen};
use octray_formats::scene::Loaded;
use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long a key counts as held after a press without a reported release, slightly longer than the interval
/// of repetition.
const KEY_TIMEOUT: Duration = Duration::from_millis(130);
/// Longest wait for a key before frames are checked.
const POLL_TIMEOUT: Duration = Duration::from_millis(8);
/// Frames per second that terminals keep up with.
const FRAME_RATE: f64 = 30.0;

/// Shows scenes in the terminal; returns on Ctrl-C, or after [`Options::frames`].
///
/// # Errors
/// If the terminal cannot be read from or written to; it is restored first.
pub fn terminal(options: Options, playlist: Playlist, scene: Loaded) -> io::Result<Summary> {
    let exit = exit_flag()?;
    let mut raw = RawTerminal::enter()?;
    let viewer = Viewer::start(options, playlist, scene, Arc::new(|| {}));
    viewer.send(Event::Rate(FRAME_RATE));
    let shown = show(&viewer, &mut raw, &exit);
    let summary = viewer.finish();
    drop(raw);
    shown.map(|()| summary)
}

/// The terminal in raw mode on the alternate screen; restored on drop and on panic.
struct RawTerminal {
    out: io::BufWriter<io::Stdout>,
    reports_release: bool,
    /// Time of each held key's last press; empty if releases are reported.
    down: HashMap<Key, Instant>,
}

impl RawTerminal {
    fn enter() -> io::Result<Self> {
        screen::enable_raw_mode()?;
        // From here on, `drop` and the panic hook restore the terminal.
        let out = io::BufWriter::with_capacity(1 << 18, io::stdout());
        let mut raw = Self { out, reports_release: false, down: HashMap::new() };
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            restore(&mut io::stdout(), true);
            before(panic);
        }));
        execute!(
            raw.out,
            screen::EnterAlternateScreen,
            cursor::Hide,
            EnableMouseCapture,
            EnableBracketedPaste,
            EnableFocusChange
        )?;
        raw.reports_release = screen::supports_keyboard_enhancement().unwrap_or(false);
        if raw.reports_release {
            execute!(raw.out, PushKeyboardEnhancementFlags(KeyboardEnhancementFlags::REPORT_EVENT_TYPES))?;
        }
        Ok(raw)
    }

    /// Handles an event of the terminal; returns false on quit.
    fn handle(&mut self, event: event::Event, viewer: &Viewer, cells: &mut CellBuffer) -> bool {
        match event {
            event::Event::Key(event) => {
                let control = event.modifiers.contains(KeyModifiers::CONTROL);
                if control && matches!(event.code, Key::Char('c' | 'q' | 'C' | 'Q')) {
                    return false;
                }
                let key = match event.code {
                    Key::Char(letter) => Key::Char(letter.to_lowercase().next().unwrap_or(letter)),
                    code => code,
                };
                let Some(action) = keys::action_of(key) else { return true };
                let down = event.kind != KeyEventKind::Release;
                if matches!(action, Action::Hold(_)) && !self.reports_release {
                    self.down.insert(key, Instant::now());
                }
                let repeat = event.kind == KeyEventKind::Repeat;
                viewer.send(Event::Key { key, down, repeat });
            }
            event::Event::Mouse(mouse) => match mouse.kind {
                MouseEventKind::ScrollUp => viewer.send(Event::Wheel(1.0)),
                MouseEventKind::ScrollDown => viewer.send(Event::Wheel(-1.0)),
                _ => {}
            },
            // Terminals paste the path of a dropped file.
            event::Event::Paste(name) => {
                let name = name.trim().trim_matches(['\'', '"']).replace("\\ ", " ");
                viewer.send(Event::Dropped(name.into()));
            }
            event::Event::FocusLost => viewer.send(Event::Unfocused),
            event::Event::Resize(..) => cells.invalidate(),
            event::Event::FocusGained => {}
        }
        true
    }

    /// Releases keys without a recent press.
    fn release_stale(&mut self, viewer: &Viewer) {
        self.down.retain(|&key, heard| {
            let down = heard.elapsed() < KEY_TIMEOUT;
            if !down {
                viewer.send(Event::Key { key, down: false, repeat: false });
            }
            down
        });
    }
}

impl Drop for RawTerminal {
    fn drop(&mut self) {
        let reports_release = self.reports_release;
        restore(&mut self.out, reports_release);
    }
}

/// Restores the terminal. Errors are ignored, because nothing can be done about them.
fn restore(out: &mut impl Write, reports_release: bool) {
    if reports_release {
        let _ = execute!(out, PopKeyboardEnhancementFlags);
    }
    let _ = execute!(
        out,
        DisableFocusChange,
        DisableBracketedPaste,
        DisableMouseCapture,
        ResetColor,
        cursor::Show,
        screen::LeaveAlternateScreen
    );
    let _ = screen::disable_raw_mode();
}

fn show(viewer: &Viewer, raw: &mut RawTerminal, exit: &AtomicBool) -> io::Result<()> {
    let mut frame = Frame::default();
    let mut cells = CellBuffer::default();
    while !exit.load(Ordering::Relaxed) && !viewer.is_finished() {
        let mut patience = POLL_TIMEOUT;
        while event::poll(patience)? {
            if !raw.handle(event::read()?, viewer, &mut cells) {
                return Ok(());
            }
            patience = Duration::ZERO;
        }
        raw.release_stale(viewer);
        if viewer.swap_newer(&mut frame) {
            let (columns, rows) = screen::size()?;
            cells.draw(&mut raw.out, &frame, [columns, rows])?;
            raw.out.flush()?;
        }
    }
    Ok(())
}
