//! The terminal: half a character a pixel, in true colour.
//!
//! For: [`terminal()`]. May import: `crossterm`, `told`, `frame`, `keys`. Must never know: scenes, renderers.
//!
//! Every character cell shows two pixels, one above the other: the upper half block in the colour of the upper one, on the colour of the lower
//! one. Terminals that do not tell when a key comes up (most) get keys that are held for a moment after each time they are heard of.

use super::canvas::{fit, wrap};
use super::frame::Frame;
use super::keys::{self, Action, Key};
use super::playlist::Playlist;
use super::state::Event;
use super::told::Told;
use super::{Options, Summary, Viewer};
use crate::scene::Loaded;
use crossterm::event::{
    self, DisableBracketedPaste, DisableFocusChange, DisableMouseCapture, EnableBracketedPaste,
    EnableFocusChange, EnableMouseCapture, KeyCode, KeyEventKind, KeyModifiers, KeyboardEnhancementFlags,
    MouseEventKind, PopKeyboardEnhancementFlags, PushKeyboardEnhancementFlags,
};
use crossterm::style::{Color, Colors, Print, ResetColor, SetColors};
use crossterm::{cursor, execute, queue, terminal as screen};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a key is taken to be down after it was heard of: a little longer than from one repetition to the next.
const LINGER: Duration = Duration::from_millis(130);
/// Longest wait for a key before frames are looked after.
const PATIENCE: Duration = Duration::from_millis(8);
/// Frames a second: what terminals keep up with.
const RATE: f64 = 30.0;

/// Shows a scene in the terminal and stays until somebody quits: Ctrl-C.
pub fn terminal(options: Options, playlist: Playlist, scene: Loaded) -> io::Result<Summary> {
    let told = Told::listen()?;
    let mut raw = Raw::enter()?;
    let viewer = Viewer::start(options, playlist, scene, Arc::new(|| {}));
    viewer.send(Event::Rate(RATE));
    let shown = show(&viewer, &mut raw, &told);
    let summary = viewer.finish();
    drop(raw);
    shown.map(|()| summary)
}

/// A terminal that shows pictures; as it was before once this is gone, whatever the reason.
struct Raw {
    out: io::BufWriter<io::Stdout>,
    /// Does it tell when keys come up?
    tells_up: bool,
}

impl Raw {
    fn enter() -> io::Result<Self> {
        screen::enable_raw_mode()?;
        // From here on everything is undone, panics included.
        let mut raw = Self { out: io::BufWriter::with_capacity(1 << 18, io::stdout()), tells_up: false };
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
        raw.tells_up = screen::supports_keyboard_enhancement().unwrap_or(false);
        if raw.tells_up {
            execute!(raw.out, PushKeyboardEnhancementFlags(KeyboardEnhancementFlags::REPORT_EVENT_TYPES))?;
        }
        Ok(raw)
    }
}

impl Drop for Raw {
    fn drop(&mut self) {
        let tells_up = self.tells_up;
        restore(&mut self.out, tells_up);
    }
}

/// Nothing more can be done where a step fails.
fn restore(out: &mut impl Write, tells_up: bool) {
    if tells_up {
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

/// Frames out, keys in, until the end.
fn show(viewer: &Viewer, raw: &mut Raw, told: &Told) -> io::Result<()> {
    let mut frame = Frame::default();
    let mut keys = Keys { tells_up: raw.tells_up, down: BTreeMap::new() };
    let mut cells = Cells::default();
    while !told.to_end() && !viewer.is_over() {
        if event::poll(PATIENCE)? {
            loop {
                if !keys.hear(event::read()?, viewer, &mut cells) {
                    return Ok(());
                }
                if !event::poll(Duration::ZERO)? {
                    break;
                }
            }
        }
        keys.let_go(viewer);
        if viewer.take(&mut frame) {
            let (columns, rows) = screen::size()?;
            cells.draw(&mut raw.out, &frame, [columns, rows])?;
            raw.out.flush()?;
        }
    }
    Ok(())
}

/// Keys that are down, as far as is known.
struct Keys {
    tells_up: bool,
    /// When each was heard of last; only where nobody tells when they come up.
    down: BTreeMap<Key, Instant>,
}

impl Keys {
    /// Takes in what the terminal tells; false at the end.
    fn hear(&mut self, event: event::Event, viewer: &Viewer, cells: &mut Cells) -> bool {
        match event {
            event::Event::Key(event) => {
                let control = event.modifiers.contains(KeyModifiers::CONTROL);
                if control && matches!(event.code, KeyCode::Char('c' | 'q' | 'C' | 'Q')) {
                    return false;
                }
                let Some(key) = key_of(event.code) else { return true };
                let held = matches!(keys::action_of(key), Some(Action::Hold(_)));
                let down = event.kind != KeyEventKind::Release;
                if held && !self.tells_up {
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
            // Terminals paste the name of a file that is dropped on them.
            event::Event::Paste(name) => {
                let name = name.trim().trim_matches(['\'', '"']).replace("\\ ", " ");
                viewer.send(Event::Dropped(name));
            }
            event::Event::FocusLost => viewer.send(Event::Unfocused),
            event::Event::Resize(..) => cells.forget(),
            event::Event::FocusGained => {}
        }
        true
    }

    /// Keys that were not heard of for a while are up.
    fn let_go(&mut self, viewer: &Viewer) {
        self.down.retain(|&key, heard| {
            let down = heard.elapsed() < LINGER;
            if !down {
                viewer.send(Event::Key { key, down: false, repeat: false });
            }
            down
        });
    }
}

fn key_of(code: KeyCode) -> Option<Key> {
    Some(match code {
        KeyCode::Char(letter) => Key::Char(letter.to_lowercase().next().unwrap_or(letter)),
        KeyCode::Up => Key::Up,
        KeyCode::Down => Key::Down,
        KeyCode::Left => Key::Left,
        KeyCode::Right => Key::Right,
        KeyCode::Tab => Key::Tab,
        KeyCode::Esc => Key::Escape,
        KeyCode::PageUp => Key::PageUp,
        KeyCode::PageDown => Key::PageDown,
        KeyCode::Home => Key::Home,
        KeyCode::F(1) => Key::F1,
        KeyCode::F(5) => Key::F5,
        _ => return None,
    })
}

/// What stands on the terminal: only what changes is written.
#[derive(Default)]
struct Cells {
    /// Upper and lower pixel, row by row.
    shown: Vec<[u32; 2]>,
    size: [u16; 2],
    /// Lines of text that lie over the picture.
    lines: Vec<String>,
    /// Columns of the frame's pixels, and the frame at the size of the terminal.
    pixels: Vec<u32>,
}

/// In place of pixels where something else stands.
const UNKNOWN: [u32; 2] = [u32::MAX; 2];

impl Cells {
    /// Nothing is known of what stands there.
    fn forget(&mut self) {
        self.shown.clear();
    }

    fn draw(&mut self, out: &mut impl Write, frame: &Frame, size: [u16; 2]) -> io::Result<()> {
        let [columns, rows] = size.map(usize::from);
        if columns == 0 || rows == 0 {
            return Ok(());
        }
        if self.size != size || self.shown.len() != columns * rows {
            self.size = size;
            self.shown.clear();
            self.shown.resize(columns * rows, UNKNOWN);
            self.lines.clear();
            queue!(out, ResetColor, screen::Clear(screen::ClearType::All))?;
        }
        self.shrink(frame, [columns as u32, 2 * rows as u32]);
        let lines = text_of(frame, columns, rows);
        // Where text was and is no more, the picture is written again.
        for (row, line) in self.lines.iter().enumerate().take(rows) {
            let kept = lines.get(row).map_or(0, |line| line.chars().count());
            let gone = line.chars().count().min(columns);
            self.shown[row * columns..][kept.min(gone)..gone].fill(UNKNOWN);
        }
        let mut colors = None;
        for row in 0..rows {
            let covered = lines.get(row).map_or(0, |line| line.chars().count().min(columns));
            let mut at = None;
            for column in covered..columns {
                let cell = [2 * row, 2 * row + 1].map(|y| self.pixels[y * columns + column]);
                let place = row * columns + column;
                if self.shown[place] == cell {
                    continue;
                }
                self.shown[place] = cell;
                if at != Some(column) {
                    queue!(out, cursor::MoveTo(column as u16, row as u16))?;
                }
                if colors != Some(cell) {
                    colors = Some(cell);
                    let [upper, lower] = cell.map(color);
                    queue!(out, SetColors(Colors::new(upper, lower)))?;
                }
                queue!(out, Print('▀'))?;
                at = Some(column + 1);
            }
        }
        for (row, line) in lines.iter().enumerate() {
            if self.lines.get(row) != Some(line) || self.shown[row * columns] != UNKNOWN {
                queue!(out, ResetColor, cursor::MoveTo(0, row as u16), Print(line))?;
                let covered = line.chars().count().min(columns);
                self.shown[row * columns..][..covered].fill(UNKNOWN);
            }
        }
        queue!(out, ResetColor)?;
        self.lines = lines;
        Ok(())
    }

    /// The frame at the terminal's size, the mean of the pixels that fall together; the map in its corner, black around.
    fn shrink(&mut self, frame: &Frame, [width, height]: [u32; 2]) {
        self.pixels.clear();
        self.pixels.resize((width * height) as usize, 0);
        let [left, top, across, down] = fit([frame.width, frame.height], [width, height]);
        let inset = if frame.inset.is_empty() { 0 } else { (width.min(height) / 3).min(frame.inset_side) };
        for y in 0..down {
            for x in 0..across {
                let mean = mean(&frame.pixels, [frame.width, frame.height], [x, y], [across, down]);
                self.pixels[((top + y) * width + left + x) as usize] = mean;
            }
        }
        for y in 0..inset {
            for x in 0..inset {
                let side = frame.inset_side;
                let mean = mean(&frame.inset, [side, side], [x, y], [inset, inset]);
                self.pixels[(y * width + width - inset + x) as usize] = mean;
            }
        }
    }
}

/// The mean of the pixels that fall on one of `size`, at least of one.
fn mean(pixels: &[u32], [width, height]: [u32; 2], [x, y]: [u32; 2], [across, down]: [u32; 2]) -> u32 {
    let span = |at: u32, of: u32, all: u32| {
        let from = (u64::from(at) * u64::from(all) / u64::from(of)) as u32;
        let to = (u64::from(at + 1) * u64::from(all) / u64::from(of)) as u32;
        from..to.max(from + 1)
    };
    let (mut sums, mut count) = ([0u32; 3], 0);
    for y in span(y, down, height) {
        for x in span(x, across, width) {
            let [_, r, g, b] = pixels[(y * width + x) as usize].to_be_bytes();
            sums = [sums[0] + u32::from(r), sums[1] + u32::from(g), sums[2] + u32::from(b)];
            count += 1;
        }
    }
    let [r, g, b] = sums.map(|sum| (sum + count / 2) / count);
    r << 16 | g << 8 | b
}

fn color(pixel: u32) -> Color {
    let [_, r, g, b] = pixel.to_be_bytes();
    Color::Rgb { r, g, b }
}

/// The lines of text over a frame, as many as fit in the terminal.
fn text_of(frame: &Frame, columns: usize, rows: usize) -> Vec<String> {
    let said = frame.figures.lines().chain(frame.message.lines());
    let mut lines: Vec<String> = said.flat_map(|line| wrap(line, columns)).map(String::from).collect();
    if frame.help {
        lines.push("Ctrl-C  end".to_string());
        lines.extend(keys::help_in(columns, rows.saturating_sub(lines.len())));
    }
    lines.truncate(rows);
    lines.iter().map(|line| line.chars().take(columns).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_fits_the_terminal() {
        let said =
            Frame { figures: "one two three\nfour".into(), message: "five".into(), ..Frame::default() };
        assert_eq!(text_of(&said, 80, 24), ["one two three", "four", "five"]);
        assert_eq!(text_of(&said, 8, 24), ["one two", "three", "four", "five"]);
        assert_eq!(text_of(&said, 8, 2), ["one two", "three"]);
        let help = Frame { help: true, ..Frame::default() };
        assert_eq!(text_of(&help, 200, 60)[1..], keys::help().collect::<Vec<_>>());
        for (columns, rows) in [(80, 24), (200, 60), (200, 10), (40, 12), (5, 3), (1, 1)] {
            let lines = text_of(&help, columns, rows);
            assert!(lines.len() <= rows && lines.iter().all(|line| line.chars().count() <= columns));
            assert!(columns < 20 || lines[0] == "Ctrl-C  end");
        }
        let last = keys::BINDINGS.last().expect("there are some");
        assert!(text_of(&help, 80, 24).iter().any(|line| line.contains(last.meaning)), "all of it");
    }
}
