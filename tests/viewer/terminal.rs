//! `octray view --terminal` in a terminal of the test's own: what stands on its screen, what keys do, and how
//! it is left.

use crate::pictures::{Bytes, difference, rendered};
use crate::program::{PROGRAM, kept, send_signal};
use crate::waiting::{repeat_until, wait_for};
use portable_pty::{Child, CommandBuilder, ExitStatus, PtyPair, PtySize, native_pty_system};
use std::io::{Read, Write};
use std::sync::{Arc, Mutex};
use std::thread;

/// Two pixels of the picture in every character.
const COLUMNS: u16 = 64;
const ROWS: u16 = 18;
const SIZE: &str = "64x36";
/// Of the pictures that the terminal's are held against: their noise is far below [`SAME`].
const SAMPLES: u32 = 1024;
const SAME: f64 = 2.0;
const OTHER: f64 = 8.0;

type Input = Arc<Mutex<Box<dyn Write + Send>>>;

/// What stands on the screen, and every byte that came.
struct Seen {
    screen: vt100::Parser,
    bytes: Vec<u8>,
}

struct Terminal {
    pair: PtyPair,
    program: Box<dyn Child + Send + Sync>,
    input: Input,
    seen: Arc<Mutex<Seen>>,
    /// Its modes before the program.
    before: String,
}

impl Terminal {
    /// Starts the program in a terminal that answers what it is asked: `features`, and that it is a terminal.
    fn start(arguments: &[&str], features: &'static str) -> Self {
        let size = PtySize { rows: ROWS, cols: COLUMNS, pixel_width: 0, pixel_height: 0 };
        let pair = native_pty_system().openpty(size).unwrap();
        let mut command = CommandBuilder::new(PROGRAM);
        command.env_clear();
        kept().for_each(|(name, value)| command.env(name, value));
        command.args(["view", "--terminal", "--size", SIZE, "--threads", "1"]);
        command.args(arguments);
        command.env("TERM", "xterm-256color");
        let mut output = pair.master.try_clone_reader().unwrap();
        let input: Input = Arc::new(Mutex::new(pair.master.take_writer().unwrap()));
        let seen = Seen { screen: vt100::Parser::new(ROWS, COLUMNS, 0), bytes: Vec::new() };
        let seen = Arc::new(Mutex::new(seen));
        let (answers, shown) = (input.clone(), seen.clone());
        thread::spawn(move || {
            let mut buffer = [0; 1 << 16];
            while let Ok(count @ 1..) = output.read(&mut buffer) {
                let mut seen = shown.lock().unwrap();
                let from = seen.bytes.len().saturating_sub(2);
                seen.bytes.extend_from_slice(&buffer[..count]);
                seen.screen.process(&buffer[..count]);
                if has(&seen.bytes[from..], "\x1b[c") {
                    let _ = write!(answers.lock().unwrap(), "{features}\x1b[?62c");
                }
            }
        });
        let before = modes(&pair);
        let program = pair.slave.spawn_command(command).unwrap();
        Self { pair, program, input, seen, before }
    }

    /// What the terminal does with keys and lines: echo, signals, line by line.
    fn modes(&self) -> String {
        modes(&self.pair)
    }

    fn write(&self, keys: &str) {
        self.input.lock().unwrap().write_all(keys.as_bytes()).unwrap();
    }
    fn wrote(&self, bytes: &str) -> bool {
        has(&self.seen.lock().unwrap().bytes, bytes)
    }
    fn text(&self) -> String {
        self.seen.lock().unwrap().screen.screen().contents()
    }

    /// The picture, once the whole screen is one.
    fn picture(&self) -> Option<Bytes> {
        let seen = self.seen.lock().unwrap();
        let screen = seen.screen.screen();
        let rgb = |color| match color {
            vt100::Color::Rgb(r, g, b) => Some([r, g, b]),
            _ => None,
        };
        let mut picture = Bytes::new();
        for row in 0..ROWS {
            let cells = || (0..COLUMNS).map(|column| screen.cell(row, column).unwrap());
            if cells().any(|cell| cell.contents() != "▀") {
                return None;
            }
            picture.append(&mut cells().map(|cell| rgb(cell.fgcolor())).collect::<Option<_>>()?);
            picture.append(&mut cells().map(|cell| rgb(cell.bgcolor())).collect::<Option<_>>()?);
        }
        Some(picture)
    }
    fn shows(&self, wanted: &Bytes) -> bool {
        self.picture().is_some_and(|picture| difference(&picture, wanted) < SAME)
    }
    fn wait_for_picture(&self, what: &str, wanted: &Bytes) {
        wait_for(what, || self.shows(wanted).then_some(()));
    }

    /// Waits for the end, and for the terminal to be as it was before.
    fn end(mut self) -> ExitStatus {
        let status = wait_for("the end", || self.program.try_wait().unwrap());
        wait_for("the screen as it was before", || {
            let seen = self.seen.lock().unwrap();
            let screen = seen.screen.screen();
            let plain = !screen.alternate_screen() && !screen.hide_cursor() && !screen.bracketed_paste();
            let plain = plain && has(&seen.bytes, "\x1b[?1004l");
            (plain && screen.mouse_protocol_mode() == vt100::MouseProtocolMode::None).then_some(())
        });
        assert_eq!(self.modes(), self.before, "the modes of the terminal");
        status
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if thread::panicking() {
            eprintln!("on the screen:\n{}", self.text());
        }
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn has(bytes: &[u8], what: &str) -> bool {
    bytes.windows(what.len()).any(|part| part == what.as_bytes())
}

fn modes(pair: &PtyPair) -> String {
    format!("{:?}", pair.master.get_termios().unwrap())
}

/// Of most terminals, which do not tell when keys come up.
const PLAIN: &str = "";
/// Of those that do (the protocol of kitty).
const TELLS_UP: &str = "\x1b[?0u";

#[test]
fn half_blocks_show_what_render_writes_and_keys_change_it() {
    let terminal = Terminal::start(&["builtin:three", "builtin:thesis"], PLAIN);
    let three = rendered("builtin:three", SIZE, SAMPLES);
    wait_for("figures", || terminal.text().contains("builtin:three (1 of 2)").then_some(()));
    assert_ne!(terminal.modes(), terminal.before, "keys are heard one by one");
    terminal.write("i");
    terminal.wait_for_picture("the picture that render writes", &three);
    // A key is held for a moment after it was heard of, and no longer.
    wait_for("a walk", || {
        terminal.write("w");
        terminal.picture().filter(|picture| difference(picture, &three) > OTHER)
    });
    repeat_until("home, and a stand there", || terminal.write("\x1b[H"), || terminal.shows(&three));
    terminal.write(".");
    terminal.wait_for_picture("the next scene", &rendered("builtin:thesis", SIZE, SAMPLES));
    terminal.write("h");
    wait_for("help", || terminal.text().contains("walk").then_some(()));
    terminal.write("h");
    wait_for("no help any more", || terminal.picture());
    terminal.write("\x03");
    assert_eq!(terminal.end().exit_code(), 0);
}

#[test]
fn terminals_that_tell_when_keys_come_up_are_asked_to_and_left_alone_in_the_end() {
    let terminal = Terminal::start(&["builtin:three"], TELLS_UP);
    let three = rendered("builtin:three", SIZE, SAMPLES);
    wait_for("a question", || terminal.wrote("\x1b[>2u").then_some(()));
    terminal.write("i");
    terminal.wait_for_picture("the picture", &three);
    // The key comes up, or goes on in another window without a word.
    for end in ["\x1b[119;1:3u", "\x1b[O"] {
        terminal.write("\x1b[119;1:1u");
        wait_for("a walk that goes on", || {
            terminal.picture().filter(|picture| difference(picture, &three) > OTHER)
        });
        terminal.write(end);
        terminal.write("\x1b[H");
        terminal.wait_for_picture("home, and a stand there", &three);
    }
    assert!(!terminal.wrote("\x1b[<1u"));
    terminal.write("\x03");
    wait_for("its own keys again", || terminal.wrote("\x1b[<1u").then_some(()));
    assert_eq!(terminal.end().exit_code(), 0);
}

#[test]
fn terminal_is_left_as_it_was_when_the_program_is_told_to_end() {
    for signal in ["TERM", "INT", "HUP"] {
        let terminal = Terminal::start(&["builtin:three"], PLAIN);
        wait_for("figures", || terminal.text().contains("builtin:three").then_some(()));
        send_signal(signal, terminal.program.process_id().unwrap());
        assert_eq!(terminal.end().exit_code(), 0, "{signal}");
    }
}

#[test]
fn a_number_of_frames_ends_and_prints_its_figures_below_what_was_there() {
    let terminal = Terminal::start(&["builtin:three", "--frames", "30"], PLAIN);
    wait_for("figures of all frames", || terminal.text().contains("30 frames, ").then_some(()));
    assert_eq!(terminal.end().exit_code(), 0);
}
