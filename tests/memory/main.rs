//! The viewer makes its memory when it starts, and none from frame to frame.
#![cfg(feature = "viewer")]

#[path = "../common/seat.rs"]
mod seat;

use octray::viewer::keys::Key;
use octray::viewer::state::Event;
use seat::{Seat, options};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

#[global_allocator]
static MEMORY: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Frames until everything has the size that it keeps, and frames that are watched then.
const WARM: u64 = 60;
const WATCHED: u64 = 50;
/// Most pieces of memory that writing the figures may take, and how often they are written.
const PIECES: f64 = 40.0;
const WRITTEN: Duration = Duration::from_millis(250);
/// Pieces of memory in a frame of the views of paths (bounces, lanes) where several threads share its tiles.
const SHARING: u64 = 2;

fn start(scene: &str, threads: usize) -> Seat {
    let seat = Seat::start(options([64, 36], threads, Path::new(".")), &[scene]);
    // Frames as fast as they can be made.
    seat.viewer.send(Event::Rate(1e6));
    seat
}

/// Takes frames until there were so many more.
fn watch(seat: &mut Seat, frames: u64) {
    let start = Instant::now();
    let until = seat.made() + frames;
    while seat.made() < until {
        seat.viewer.swap_newer(&mut seat.frame);
        assert!(start.elapsed() < Duration::from_secs(120), "frames come");
        thread::sleep(Duration::from_micros(100));
    }
}

/// Pieces of memory taken, or made larger, in frames that go on for so long at least; and how long they did.
fn pieces(seat: &mut Seat, least: Duration) -> (usize, Duration) {
    watch(seat, WARM);
    let (region, start) = (Region::new(MEMORY), Instant::now());
    watch(seat, WATCHED);
    while start.elapsed() < least {
        watch(seat, 1);
    }
    let change = region.change();
    (change.allocations + change.reallocations, start.elapsed())
}

/// Bytes that are in use.
fn in_use() -> isize {
    let stats = MEMORY.stats();
    stats.bytes_allocated as isize - stats.bytes_deallocated as isize
}

/// One test: another one beside it would take memory, too. It takes some seconds for [`WATCHED`] frames of
/// every view, still and in motion.
#[test]
fn frames_take_no_memory() {
    for (scene, threads) in [("builtin:three", 1), ("builtin:cornell", 2)] {
        let mut seat = start(scene, threads);
        let (taken, time) = pieces(&mut seat, 4 * WRITTEN);
        let written = time.as_secs_f64() / WRITTEN.as_secs_f64() + 1.0;
        assert!(taken > 0, "{scene}: figures are written, and they are counted here");
        let most = PIECES * written;
        assert!(taken as f64 <= most, "{scene}: {taken} pieces for figures written {written:.1} times");
        seat.press(Key::Char('i'));
        let views = if threads > 1 { "27" } else { "234567890" };

        // More threads share their work through queues, whose room rayon changes now and then.
        let now_and_then = |frames: u64| if threads > 1 { frames / 10 } else { 0 };
        // The test's own thread takes some at times, to say that it takes long: what frames take, they take
        // every time.
        let few = |seat: &mut Seat, what: &str, most: u64| {
            let mut watched = Vec::new();
            let mut takes_more = || {
                let from = seat.made() + WARM;
                let (pieces, _) = pieces(seat, Duration::ZERO);
                let frames = seat.made() - from + 1;
                watched.push(format!("{pieces} pieces in {frames} frames"));
                pieces as u64 > most * frames + now_and_then(frames)
            };
            let always = (0..3).all(|_| takes_more());
            assert!(!always, "{scene}, {threads} threads, {what}: {watched:?}");
        };
        let none = |seat: &mut Seat, what: &str| few(seat, what, 0);
        none(&mut seat, "standing");
        let before = in_use();
        let from = seat.made();
        watch(&mut seat, if threads > 1 { 200 } else { 1_000 });
        let (more, frames) = (in_use() - before, seat.made() - from);
        // A line of the test's own, and the queues.
        let most = 256 + 4096 * now_and_then(frames);
        assert!(more.unsigned_abs() as u64 <= most, "{scene}: {more} bytes more in use");
        // In a circle.
        for key in [Key::Char('w'), Key::Right] {
            seat.key(key, true);
        }
        none(&mut seat, "walking");
        let in_views = |seat: &mut Seat, what: &str| {
            for view in views.chars() {
                seat.press(Key::Char(view));
                let most = if "70".contains(view) && threads > 1 { SHARING } else { 0 };
                few(seat, &format!("{what} in view {view}"), most);
            }
        };
        in_views(&mut seat, "walking");
        seat.press(Key::Char('1'));
        seat.press(Key::Char('m'));
        none(&mut seat, "walking with a map");
        for key in [Key::Char('w'), Key::Right] {
            seat.key(key, false);
        }
        seat.key(Key::Home, true);
        in_views(&mut seat, "standing");
        seat.press(Key::Char('1'));
        for filter in ["3×3 blur", "FXAA"] {
            seat.press(Key::Char('f'));
            none(&mut seat, filter);
        }
        seat.press(Key::Char('n'));
        none(&mut seat, "with the denoiser");
        seat.viewer.finish();
    }
}
