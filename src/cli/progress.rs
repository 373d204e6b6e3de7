//! How far a rendering, or a list of tasks, is: a line on standard error, where that is a terminal.
//!
//! For: [`Progress`], [`Countdown`] of what ends by the clock, and [`Tasks`]. May import: `terminal`, `indicatif`. Must never know: what is rendered, or how.

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
    pixels: u64,
    /// Samples of single pixels that there will be, as far as is known.
    expected: Arc<AtomicU64>,
}

impl Progress {
    /// Starts now, and ends after so much time, if that is limited.
    pub fn new([width, height]: [u32; 2], limit: Option<Duration>) -> Self {
        let pixels = u64::from(width) * u64::from(height);
        let (rays, expected) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
        let (counted, all, start) = (rays.clone(), expected.clone(), Instant::now());
        let say = move |state: &ProgressState, out: &mut dyn Write| {
            let [rays, expected] = [&counted, &all].map(|count| count.load(Ordering::Relaxed));
            let _ = out.write_str(&figures(state.pos(), pixels, expected, rays, start.elapsed(), limit));
        };
        let bar = line(Some(pixels), style("{wide_bar} {figures}").with_key("figures", say));
        Self { bar, rays, pixels, expected }
    }

    /// So many samples of single pixels there will be, in all.
    pub fn expect(&self, pixel_samples: u64) {
        self.expected.store(pixel_samples, Ordering::Relaxed);
        self.bar.set_length(pixel_samples.max(self.pixels));
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

/// A line for what ends by the clock: how much of its time is over, and what it does.
pub struct Countdown {
    bar: ProgressBar,
}

impl Countdown {
    /// Began at `start` and is to take so much time.
    pub fn new(start: Instant, time: Duration) -> Self {
        let passed = move || start.elapsed().div_duration_f64(time).min(1.0);
        let filled = move |_: &ProgressState, out: &mut dyn Write| {
            let _ = out.write_str(&"█".repeat((passed() * 30.0) as usize));
        };
        let say = move |_: &ProgressState, out: &mut dyn Write| {
            let left = time.saturating_sub(start.elapsed()).max(Duration::from_secs(1));
            let _ = write!(out, "{:.0} %  {} left", passed() * 100.0, HumanDuration(left));
        };
        let template = style("{filled:30!.cyan/blue} {say}  {msg}");
        Self { bar: line(None, template.with_key("filled", filled).with_key("say", say)) }
    }

    /// From now on it does this.
    pub fn step(&self, what: &str) {
        self.bar.set_message(what.to_owned());
    }

    /// Something that writes above the line.
    pub fn above(&self, say: impl FnOnce()) {
        self.bar.suspend(say);
    }

    /// Takes the line away.
    pub fn end(self) {
        self.bar.finish_and_clear();
    }
}

/// How far a list of tasks is: a line of the same kind, with the name of the task at hand.
pub struct Tasks {
    bar: ProgressBar,
}

impl Tasks {
    pub fn new(count: usize) -> Self {
        Self { bar: line(Some(count as u64), style("{wide_bar} {pos}/{len} {msg}")) }
    }

    /// Shows what is begun now.
    pub fn begin(&self, task: &'static str) {
        self.bar.set_message(task);
    }
    /// Runs something that writes to the terminal, with the line out of its way, and counts the task.
    pub fn done<R>(&self, tell: impl FnOnce() -> R) -> R {
        self.bar.inc(1);
        self.bar.suspend(tell)
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

/// A line on standard error, drawn again and again by a thread of its own, if somebody can see it.
fn line(length: Option<u64>, style: ProgressStyle) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr_with_hz(10));
    bar.set_style(style);
    if !bar.is_hidden() {
        bar.enable_steady_tick(REDRAW);
    }
    bar
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// What stands behind the bar: `done` of `expected` samples of single pixels, so many of which are a sample of the picture.
fn figures(
    done: u64,
    pixels: u64,
    expected: u64,
    rays: u64,
    time: Duration,
    limit: Option<Duration>,
) -> String {
    let of_samples = done as f64 / expected.max(1) as f64;
    let of_time = limit.map_or(0.0, |limit| time.div_duration_f64(limit).min(1.0));
    let share = of_samples.max(of_time);
    let rate = figure(mrays_per_s(rays, time), 1);
    // Where the time will end it, nobody knows how many samples there will be.
    let all =
        if of_samples < of_time { String::new() } else { format!("/{}", grouped(expected.div_ceil(pixels))) };
    let mut text = format!("{:.1} %  {}{all} samples  {rate} Mray/s", share * 100.0, grouped(done / pixels));
    if (SETTLED_SHARE..1.0).contains(&share) && time >= SETTLED {
        let left = time.mul_f64((1.0 - share) / share).max(Duration::from_secs(1));
        // The parts of a picture cost differently: before each was seen once, the rest is a guess.
        let guess = if done < pixels && of_time < of_samples { "perhaps " } else { "" };
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
        let after = |done, time| figures(done, 1_000, 4_000, 2_000_000 * time, seconds(time), None);
        assert_eq!(figures(0, 1_000, 4_000, 0, Duration::ZERO, None), "0.0 %  0/4 samples  0.0 Mray/s");
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

    #[test]
    fn figures_go_by_the_clock_where_it_will_end_first() {
        let seconds = Duration::from_secs;
        let after =
            |done, time| figures(done, 1_000, 4_000, 2_000_000 * time, seconds(time), Some(seconds(10)));
        assert_eq!(after(500, 5), "50.0 %  0 samples  2.0 Mray/s  5 seconds left");
        assert_eq!(after(3_000, 5), "75.0 %  3/4 samples  2.0 Mray/s  2 seconds left");
        assert_eq!(after(500, 12), "100.0 %  0 samples  2.0 Mray/s");
    }
}
