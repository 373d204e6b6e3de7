//! What the tests of the viewer's front ends share: waiting for what another program does, and the picture
//! that it should show.
#![allow(dead_code)] // Every test file takes its own part.

use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longest wait for anything to happen: far longer than it takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Looks again and again until something is to be seen.
pub fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(seen) = look() {
            return seen;
        }
        assert!(start.elapsed() < PATIENCE, "waited in vain: {what}");
        sleep(Duration::from_millis(20));
    }
}

/// Bytes of red, green and blue, row by row from the top.
pub type Bytes = Vec<[u8; 3]>;

/// The mean over all pixels and channels, in steps of a byte.
pub fn difference(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let steps = |(a, b): (&[u8; 3], &[u8; 3])| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).sum::<u64>();
    a.iter().zip(b).map(steps).sum::<u64>() as f64 / (3 * a.len()) as f64
}

/// What `octray render` makes of a scene.
pub fn rendered(scene: &str, size: &str, samples: u32) -> Bytes {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("picture.png");
    let samples = samples.to_string();
    let mut render = Command::new(env!("CARGO_BIN_EXE_octray"));
    render.args(["render", scene, "--size", size, "--samples", &samples, "-o"]).arg(&file);
    let done = render.output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    image::open(file).unwrap().to_rgb8().pixels().map(|pixel| pixel.0).collect()
}
