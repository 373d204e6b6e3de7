//! A display of the test's own, whose pixels can be read, and the program on it.

use crate::folder::Folder;
use crate::pictures::Bytes;
use crate::program::{PROGRAM, away_from_home, send_signal};
use crate::skipped::skip;
use crate::waiting::wait_for;
use std::fs;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

/// Pixels of all pictures here, and how many of the window's pixels show one, across and down.
pub const SIZE: [usize; 2] = [64, 36];
pub const SIZE_TEXT: &str = "64x36";
const ENLARGED: usize = 4;

/// Columns and rows, row by row.
fn places([width, height]: [usize; 2]) -> impl Iterator<Item = (usize, usize)> {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// A screen that nobody sees.
struct Screen {
    server: Child,
    display: String,
    /// Where the server keeps the screen, as `xwd` would save it.
    folder: TempDir,
}

impl Screen {
    /// Returns `None` and says so where the programs for it are not installed.
    fn start() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mut server = Command::new("Xvfb");
        server.args("-displayfd 1 -noreset -nolisten tcp -screen 0 640x480x24 -fbdir".split(' '));
        server.arg(folder.path()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut server = found("Xvfb", server.spawn())?;
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.is_empty(), "Xvfb has no display to give");
        let screen = Self { server, display: format!(":{}", number.trim()), folder };
        found("xdotool", screen.command("xdotool").arg("version").output())?;
        Some(screen)
    }

    /// A program that this screen is the display of. The environment speaks of another one as well, which is
    /// over: it is to be passed over.
    fn command(&self, program: &str) -> Command {
        let mut command = away_from_home(program);
        command.env("DISPLAY", &self.display).env("WAYLAND_DISPLAY", "over");
        command
    }

    /// Has xdotool do something; `None` if it could not.
    fn try_xdotool(&self, arguments: &[&str]) -> Option<String> {
        let done = self.command("xdotool").args(arguments).output().unwrap();
        let said = String::from_utf8(done.stdout).unwrap();
        done.status.success().then(|| said.trim().to_string())
    }

    /// The corner of the screen where the window is: no window manager puts it anywhere else.
    fn corner(&self, size: [usize; 2]) -> Bytes {
        let dump = fs::read(self.folder.path().join("Xvfb_screen0")).unwrap();
        // Big-endian words: 0 size of the header, 7 byte order of pixels (0: the least significant first), 11
        // bits a pixel, 12 bytes a row, 19 colours, of 12 bytes each, that stand before the pixels.
        // (XWDFile.h of X11.)
        let word = |at: usize| u32::from_be_bytes(dump[4 * at..][..4].try_into().unwrap()) as usize;
        assert_eq!(word(11), 32, "bits of a pixel");
        let pixels = &dump[word(0) + 12 * word(19)..];
        let pixel = |x: usize, y: usize| {
            let bytes = pixels[y * word(12) + 4 * x..][..4].try_into().unwrap();
            let pixel = if word(7) == 0 { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) };
            let [_, r, g, b] = pixel.to_be_bytes();
            [r, g, b]
        };
        places(size).map(|(x, y)| pixel(x, y)).collect()
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// What a program gave, unless there is no such program.
fn found<T>(program: &str, ran: std::io::Result<T>) -> Option<T> {
    match ran {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            skip(&format!("windows are tested where {program} is installed"));
            None
        }
        ran => Some(ran.unwrap()),
    }
}

/// The program, and its window on a screen of its own.
pub struct Viewer {
    screen: Screen,
    program: Child,
    window: String,
}

impl Viewer {
    /// Starts it in a folder, and waits for the window to be there and hear keys; `None`, and a word about
    /// it, where there is no screen.
    pub fn start(folder: &Folder, arguments: &str) -> Option<Self> {
        let screen = Screen::start()?;
        let mut command = screen.command(PROGRAM);
        command.args(["view", "--size", SIZE_TEXT, "--threads", "1"]).args(arguments.split(' '));
        command.current_dir(folder.path("")).stdout(Stdio::piped()).stderr(Stdio::piped());
        let program = command.spawn().unwrap();
        let mut viewer = Self { screen, program, window: String::new() };
        viewer.window = wait_for("a window", || {
            assert_eq!(viewer.program.try_wait().unwrap(), None, "the program ended");
            let found = viewer.screen.try_xdotool(&["search", "--onlyvisible", "--name", "^octray"])?;
            found.lines().last().map(String::from)
        });
        wait_for("a window that hears keys", || {
            viewer.screen.try_xdotool(&["windowfocus", &viewer.window])?;
            (viewer.screen.try_xdotool(&["getwindowfocus", "-f"])? == viewer.window).then_some(())
        });
        Some(viewer)
    }

    fn xdotool(&self, arguments: &[&str]) -> String {
        self.screen.try_xdotool(arguments).unwrap_or_else(|| panic!("xdotool {arguments:?}"))
    }
    pub fn press(&self, key: &str) {
        self.xdotool(&["key", key]);
    }
    /// Keeps a key down as long as something goes on.
    pub fn hold<T>(&self, key: &str, meanwhile: impl FnOnce() -> T) -> T {
        self.xdotool(&["keydown", key]);
        let seen = meanwhile();
        self.xdotool(&["keyup", key]);
        seen
    }
    pub fn title(&self) -> String {
        self.xdotool(&["getwindowname", &self.window])
    }
    /// Width and height of the window.
    pub fn size(&self) -> [usize; 2] {
        let said = self.xdotool(&["getwindowgeometry", "--shell", &self.window]);
        let number =
            |name: &str| said.lines().find_map(|line| line.strip_prefix(name)?.parse().ok()).unwrap();
        [number("WIDTH="), number("HEIGHT=")]
    }

    /// Every pixel of the window.
    pub fn pixels(&self) -> Bytes {
        self.screen.corner(SIZE.map(|side| side * ENLARGED))
    }
    /// What it shows, at the picture's own size.
    pub fn picture(&self) -> Bytes {
        let (pixels, across) = (self.pixels(), SIZE[0] * ENLARGED);
        let at = |x: usize, y: usize| pixels[(ENLARGED * y + 1) * across + ENLARGED * x + 1];
        places(SIZE).map(|(x, y)| at(x, y)).collect()
    }

    /// Asks the window to close, or, with an xdotool that cannot ask, takes it away.
    pub fn close(&self) {
        let quit = self.screen.try_xdotool(&["windowquit", &self.window]);
        quit.unwrap_or_else(|| self.xdotool(&["windowclose", &self.window]));
    }

    pub fn tell_to_end(&self) {
        send_signal("TERM", self.program.id());
    }

    /// Waits for the end: what was printed, once the program has ended well.
    pub fn end(mut self) -> String {
        let status = wait_for("the end", || self.program.try_wait().unwrap());
        let (mut said, mut complained) = (String::new(), String::new());
        self.program.stdout.take().unwrap().read_to_string(&mut said).unwrap();
        self.program.stderr.take().unwrap().read_to_string(&mut complained).unwrap();
        assert_eq!((status.code(), complained.contains("panicked")), (Some(0), false), "{complained}");
        said
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
