//! Ctrl-C, and the signals that mean it.

use crate::desk::Desk;
use crate::program::{PROGRAM, away_from_home, send_signal};
use crate::waiting::wait_for;
use octray::render::{Renderer, Settings};
use octray::scene;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};

/// A command that goes on, and what it prints and says meanwhile.
pub struct Running {
    child: Child,
    printed: Heard,
    said: Heard,
}

/// The text that came through a pipe until now, and the thread that reads it.
struct Heard(Arc<Mutex<String>>, Option<JoinHandle<()>>);

impl Heard {
    fn from(pipe: impl Read + Send + 'static) -> Self {
        let text = Arc::new(Mutex::new(String::new()));
        let heard = text.clone();
        let listen = move || {
            let lines = BufReader::new(pipe).lines().map_while(Result::ok);
            lines.for_each(|line| *heard.lock().unwrap() += &(line + "\n"));
        };
        Self(text, Some(thread::spawn(listen)))
    }
    fn wait_for(&self, words: &str) {
        wait_for(words, || self.0.lock().unwrap().contains(words).then_some(()));
    }
    /// All of it, once the pipe is closed.
    fn all(&mut self) -> String {
        self.1.take().unwrap().join().unwrap();
        self.0.lock().unwrap().clone()
    }
}

impl Running {
    pub fn start(desk: &Desk, line: &str) -> Self {
        Self::spawn(desk.command(line))
    }

    fn spawn(mut command: Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let printed = Heard::from(child.stdout.take().unwrap());
        let said = Heard::from(child.stderr.take().unwrap());
        Self { child, printed, said }
    }

    /// Starts a rendering on one thread, and waits until its checkpoint says that tiles are done.
    fn rendering(desk: &Desk, arguments: &str) -> Self {
        let checkpoint = "--checkpoint c.part --checkpoint-interval 0.001";
        let line = format!("render {arguments} -o a.exr --threads 1 {checkpoint}");
        let running = Self::start(desk, &line);
        wait_for("a checkpoint", || desk.path("c.part").exists().then_some(()));
        running
    }

    fn send(&self, signal: &str) {
        send_signal(signal, self.child.id());
    }

    pub fn press_ctrl_c(&self) {
        self.send("INT");
    }

    /// Waits for words on standard error.
    pub fn wait_until_it_says(&self, words: &str) {
        self.said.wait_for(words);
    }

    /// Waits until Ctrl-C is heard, and returns the mask of signals that are.
    #[cfg(target_os = "linux")]
    fn wait_until_it_listens(&mut self) -> u64 {
        wait_for("a handler of Ctrl-C", || {
            assert_eq!(self.child.try_wait().unwrap(), None, "the program ended");
            // The shell that starts the program may have handlers of its own.
            let exe = std::fs::read_link(format!("/proc/{}/exe", self.child.id())).ok()?;
            let caught = signals(&self.child.id().to_string(), "SigCgt:").unwrap();
            (exe.file_name() == Path::new(PROGRAM).file_name() && caught & 2 > 0).then_some(caught)
        })
    }

    /// Waits for the end: the exit code, what was printed, and what was said on standard error.
    pub fn end(mut self) -> (Option<i32>, String, String) {
        let status = wait_for("the end", || self.child.try_wait().unwrap());
        let (printed, said) = (self.printed.all(), self.said.all());
        assert!(!said.contains("samples  "), "progress is for terminals: {said}");
        (status.code(), printed, said)
    }

    /// Presses Ctrl-C, which ends it: what was printed, and what was said on standard error.
    fn interrupt(self) -> (String, String) {
        self.press_ctrl_c();
        let (code, printed, said) = self.end();
        assert_eq!(code, Some(130), "{printed}{said}");
        (printed, said)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns a mask of signals of a process on Linux: the second bit is that of the second signal.
fn signals(process: &str, kind: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let mask = status.lines().find_map(|line| line.strip_prefix(kind))?;
    Some(u64::from_str_radix(mask.trim(), 16).unwrap())
}

/// Returns the standard output of a rendering that Ctrl-C ends when tiles are done.
fn interrupted(desk: &Desk, arguments: &str) -> String {
    Running::rendering(desk, arguments).interrupt().0
}

/// Asserts that every pixel of a picture is that of `least` to `most` samples, to the bit: only a rendering
/// that was ended within its first sample, or a machine that was very busy, leaves more numbers than one.
pub fn assert_samples(desk: &Desk, name: &str, size: [u32; 2], pixels: &[[f32; 3]], [least, most]: [u64; 2]) {
    let scene = scene::load(name).unwrap();
    let renderer = Renderer::new(&scene, Settings { resolution: size, ..Settings::of(&scene) });
    let mut film = renderer.film();
    let mut unknown: Vec<usize> = (0..pixels.len()).collect();
    for samples in 0..=most {
        if samples >= least {
            let again = film.picture().pixels;
            unknown.retain(|&index| again[index] != pixels[index]);
        }
        renderer.add_samples(&mut film, 1);
    }
    assert!(unknown.is_empty(), "{unknown:?} differ from {least} to {most} samples in {:?}", desk.names());
}

/// A picture whose sample takes minutes, and each run of its tiles seconds: of 512 tiles eight are traced
/// together, of a quarter of a million rays each.
pub fn put_heavy_picture(desk: &Desk) -> &'static str {
    desk.put_endless_paths(8);
    "endless.json --size 512x256 --bounces 1024 --lanes 1 --samples 4"
}

#[test]
fn ctrl_c_saves_the_samples_so_far_and_is_named_as_the_end() {
    let desk = Desk::new();
    let picture = "builtin:three --samples 10000000 --size 64x36";
    let printed = interrupted(&Desk::new(), picture);
    assert!(printed.contains(" of 10,000,000 samples"), "{printed}");
    assert!(printed.ends_with("ended by Ctrl-C or a signal\n"), "{printed}");
    let printed = interrupted(&desk, &format!("{picture} --json"));
    let report: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(report["interrupted"], true);
    let [least, most] = ["samples", "most_samples"].map(|key| report[key].as_u64().unwrap());
    assert!((1..10_000_000).contains(&most) && least <= most, "{report}");
    assert_eq!(desk.names(), ["a.exr", "c.part", "model.obj", "scene.json"], "no temporary file stays");
    let pixels = desk.pixels("a.exr");
    assert_eq!(pixels.len(), 64 * 36);
    assert_samples(&desk, "builtin:three", [64, 36], &pixels, [least, most]);
}

#[test]
fn ctrl_c_ends_a_sample_that_takes_minutes_and_keeps_its_tiles() {
    let desk = Desk::new();
    let printed = interrupted(&desk, &format!("{} --json", put_heavy_picture(&desk)));
    let report: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!([&report["samples"], &report["most_samples"]], [0, 1], "{report}");
    // Everything shines: what has had a sample is not black.
    let pixels = desk.pixels("a.exr");
    let begun = pixels.iter().filter(|pixel| **pixel != [0.0; 3]).count();
    // It ends with the run of eight tiles that is under way: the checkpoint comes after the first or second.
    assert!((256..=8 * 8 * 256).contains(&begun) && pixels.len() == 512 * 256, "{begun} pixels");
    assert_eq!(desk.names(), ["a.exr", "c.part", "endless.json", "model.obj", "scene.json"]);
}

/// Whether the tests themselves run under nohup; their programs inherit that.
fn ignores_hang_up() -> bool {
    signals("self", "SigIgn:").is_some_and(|mask| mask & 1 == 1)
}

/// `timeout` and shells send their signals twice.
#[test]
fn sigterm_and_hang_up_save_the_picture_however_often_they_come() {
    let signals: &[_] = if ignores_hang_up() { &["TERM"] } else { &["TERM", "HUP"] };
    for signal in signals {
        let desk = Desk::new();
        let running = Running::rendering(&desk, put_heavy_picture(&desk));
        running.send(signal);
        running.wait_until_it_says("Ctrl-C ends without it");
        running.send(signal);
        assert_eq!(running.end().0, Some(130), "{signal}");
        assert!(desk.path("a.exr").exists(), "{signal}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn hang_up_stays_ignored_under_nohup() {
    for (ignore, hears) in [("", u64::from(!ignores_hang_up())), ("trap '' HUP;", 0)] {
        let desk = Desk::new();
        let mut command = away_from_home("sh");
        command.args(["-c", &format!("{ignore} exec \"$0\" $1"), PROGRAM]);
        command.arg("render builtin:three --samples 10000000 --size 64x36 -o a.exr");
        command.current_dir(desk.path(""));
        let mut running = Running::spawn(command);
        // The handler of Ctrl-C is the last one.
        assert_eq!(running.wait_until_it_listens() & 1, hears, "{ignore}");
    }
}

/// Renders so many balls, against each of which every ray is tested, that the first tile takes minutes.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_before_the_first_tile_is_done_writes_nothing_and_says_so() {
    let desk = Desk::new();
    desk.put_endless_paths(40_000);
    desk.write("a.exr", "of yesterday");
    let arguments = "endless.json --size 64x64 --bounces 1024 --lanes 1 --traversal linear --samples 4";
    let mut running = Running::start(&desk, &format!("render {arguments} -o a.exr --threads 1"));
    running.wait_until_it_listens();
    let (printed, said) = running.interrupt();
    assert!(printed.is_empty() && said.contains("nothing was written"), "{printed}{said}");
    assert_eq!(desk.text("a.exr"), "of yesterday");
    assert_eq!(desk.names(), ["a.exr", "endless.json", "model.obj", "scene.json"]);
}

/// The second comes while the tiles under way go on for seconds.
#[test]
fn ctrl_c_twice_ends_at_once_and_writes_nothing() {
    let desk = Desk::new();
    let running = Running::rendering(&desk, put_heavy_picture(&desk));
    running.press_ctrl_c();
    running.wait_until_it_says("again ends without it");
    assert_eq!(running.interrupt().0, "");
    assert_eq!(desk.names(), ["c.part", "endless.json", "model.obj", "scene.json"]);
}

/// The second scene takes minutes: its reference tests every ball for every ray.
#[test]
fn interrupted_bench_prints_the_ratios_of_what_it_measured() {
    let desk = Desk::new();
    desk.put_endless_paths(20_000);
    let line = "bench builtin:three endless.json --size 64x36 --frames 1 --threads 1 --bounces 1024";
    let running = Running::start(&desk, line);
    running.printed.wait_for("\nbuiltin:three");
    let (_, said) = running.interrupt();
    let ratios = said.lines().find(|line| line.starts_with("builtin:three")).unwrap_or_default();
    assert!(ratios.contains('×') && !said.contains("endless.json"), "{said}");
    assert!(said.ends_with("Ctrl-C came after 1 of 2 scenes.\n"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn commands_that_are_interrupted_before_they_print_say_what_they_leave() {
    for (line, words) in [
        ("chart builtin:three -o charts", "Ctrl-C: nothing was drawn in `charts`."),
        ("bench builtin:three --frames 10000 --json", "after 0 of 1 scenes: the report was not written."),
    ] {
        let desk = Desk::new();
        let mut running = Running::start(&desk, line);
        running.wait_until_it_listens();
        let (printed, said) = running.interrupt();
        assert!(printed.is_empty() && said.contains(words), "{printed}{said}");
    }
}
