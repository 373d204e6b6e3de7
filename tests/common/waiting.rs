//! Waiting for what another program does. Nothing is expected after a given time: what is waited for is
//! looked for, and the longest wait only ends a test that has failed.
#![allow(dead_code)] // Every test file takes its own part.

use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longest wait for anything to happen: far longer than it takes on a slow and busy machine.
const PATIENCE: Duration = Duration::from_secs(300);

/// Looks again and again until something is to be seen.
pub fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(seen) = look() {
            return seen;
        }
        assert!(start.elapsed() < PATIENCE, "waited in vain: {what}");
        sleep(Duration::from_millis(5));
    }
}

/// Does something until it has its effect, which is given twice the time after each try.
pub fn repeat_until(what: &str, mut act: impl FnMut(), mut has_happened: impl FnMut() -> bool) {
    let mut time = Duration::from_millis(300);
    wait_for(what, || {
        act();
        let start = Instant::now();
        while start.elapsed() < time {
            sleep(Duration::from_millis(20));
            if has_happened() {
                return Some(());
            }
        }
        time *= 2;
        None
    });
}
