//! How far a rendering is: a line on standard error, where that is a terminal.
//!
//! For: [`Progress`]. May import: `terminal`, `indicatif`. Must never know: what is rendered, or how.

use super::terminal::figure;
use crate::wording::grouped;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// How often the line is drawn, whatever is done meanwhile.
const REDRAW: Duration = Duration::from_millis(200);
/// From when on the time left is known well enough to be told: this long after the start, and this share of the work.
const SETTLED: Duration = Duration::from_secs(2);
const SETTLED_SHARE: f64 = 0.02;

/// The line, drawn by a thread of its own: whoever works only counts. Nothing is drawn where standard error is not a terminal.
pub struct Progress {
    /// Counts samples of single pixels, so that it moves during the first sample of the picture.
    bar: ProgressBar,
    rays: Arc<AtomicU64>,
}

impl Progress {
    /// Starts now: so many samples of a picture.
    pub fn new([width, height]: [u32; 2], samples: u32) -> Self {
        let pixels = u64::from(width) * u64::from(height);
        let total = pixels * u64::from(samples);
        let rays = Arc::new(AtomicU64::new(0));
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr_with_hz(10));
        let (counted, start) = (rays.clone(), Instant::now());
        let say = move |state: &ProgressState, out: &mut dyn Write| {
            let rays = counted.load(Ordering::Relaxed);
            let _ = out.write_str(&figures(state.pos(), pixels, samples, rays, start.elapsed()));
        };
        bar.set_style(style("{wide_bar} {figures}").with_key("figures", say));
        if !bar.is_hidden() {
            bar.enable_steady_tick(REDRAW);
        }
        Self { bar, rays }
    }

    /// Counts a sample of so many pixels, and its rays.
    pub fn add(&self, pixels: usize, rays: u64) {
        if !self.bar.is_hidden() {
            self.rays.fetch_add(rays, Ordering::Relaxed);
            self.bar.inc(pixels as u64);
        }
    }

    /// From now on the line says that the file is being written.
    pub fn writing(&self, file: &Path) {
        self.bar.set_style(style("{spinner} writing {msg}"));
        self.bar.set_message(file.display().to_string());
        self.bar.tick();
    }

    /// Takes the line away.
    pub fn end(self) {
        self.bar.finish_and_clear();
    }
}

/// Millions of rays a second.
pub fn mrays_per_s(rays: u64, time: Duration) -> f64 {
    rays as f64 / time.as_secs_f64().max(1e-9) / 1e6
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// What stands behind the bar: `done` samples of single pixels, so many of which are a sample of the picture.
fn figures(done: u64, pixels: u64, samples: u32, rays: u64, time: Duration) -> String {
    let share = done as f64 / (pixels * u64::from(samples)) as f64;
    let rate = figure(mrays_per_s(rays, time), 1);
    let of = format!("{}/{}", grouped(done / pixels), grouped(samples));
    let mut text = format!("{:.1} %  {of} samples  {rate} Mray/s", share * 100.0);
    if (SETTLED_SHARE..1.0).contains(&share) && time >= SETTLED {
        let left = time.mul_f64((1.0 - share) / share).max(Duration::from_secs(1));
        // The parts of a picture cost differently: before each was seen once, the rest is a guess.
        let guess = if done < pixels { "perhaps " } else { "" };
        let _ = write!(text, "  {guess}{} left", HumanDuration(left));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_move_within_a_sample_and_tell_the_time_left_only_when_it_is_known() {
        let seconds = Duration::from_secs;
        let after = |done, time| figures(done, 1_000, 4, 2_000_000 * time, seconds(time));
        assert_eq!(figures(0, 1_000, 4, 0, Duration::ZERO), "0.0 %  0/4 samples  0.0 Mray/s");
        assert_eq!(after(16, 60), "0.4 %  0/4 samples  2.0 Mray/s", "too little is done");
        assert_eq!(after(2_000, 1), "50.0 %  2/4 samples  2.0 Mray/s", "too little time has passed");
        assert_eq!(after(400, 6), "10.0 %  0/4 samples  2.0 Mray/s  perhaps 54 seconds left");
        assert_eq!(after(3_000, 540), "75.0 %  3/4 samples  2.0 Mray/s  3 minutes left");
        assert_eq!(
            after(3_999, 9),
            "100.0 %  3/4 samples  2.0 Mray/s  1 second left",
            "never none before the end"
        );
        assert_eq!(after(4_000, 9), "100.0 %  4/4 samples  2.0 Mray/s");
    }
}
