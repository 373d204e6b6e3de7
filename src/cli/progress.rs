//! Progress lines on standard error, where that is a terminal.

use crate::report::numbers::{figure, mrays_per_s};
use crate::wording::grouped;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Interval at which the line is drawn.
const REDRAW: Duration = Duration::from_millis(200);
/// The time left is shown from this time after the start and this share of the work on: before, the estimate
/// is too uncertain.
const SETTLED: Duration = Duration::from_secs(2);
const SETTLED_SHARE: f64 = 0.02;

/// A rendering's line. A separate thread draws it; workers only count. Nothing is drawn where standard error
/// is not a terminal.
pub struct Progress {
    /// Counts pixel samples, so that it moves during the first sample of the picture. Its length is their
    /// number in all, by the present forecast.
    pub bar: ProgressBar,
    rays: Arc<AtomicU64>,
}

impl Progress {
    /// Starts the line for a film of so many pixels that has pixel samples of an earlier run; `limit` is the
    /// time limit, if there is one.
    pub fn new(pixels: u64, resumed: u64, limit: Option<Duration>) -> Self {
        let rays = Arc::new(AtomicU64::new(0));
        let (counted, start) = (rays.clone(), Instant::now());
        let say = move |state: &ProgressState, out: &mut dyn Write| {
            let (done, expected) = ([resumed, state.pos()], state.len().unwrap_or(0));
            let rays = counted.load(Ordering::Relaxed);
            let _ = out.write_str(&figures(done, pixels, expected, rays, start.elapsed(), limit));
        };
        let bar = line(Some(pixels), style("{wide_bar} {figures}").with_key("figures", say));
        bar.set_position(resumed);
        Self { bar, rays }
    }

    /// Counts one sample of `pixels` pixels, and its rays.
    pub fn add(&self, pixels: usize, rays: u64) {
        if !self.bar.is_hidden() {
            self.rays.fetch_add(rays, Ordering::Relaxed);
            self.bar.inc(pixels as u64);
        }
    }

    /// Shows that the file is being written.
    pub fn writing(&self, file: &Path) {
        self.bar.set_style(style("{spinner} writing {msg}"));
        self.bar.set_message(file.display().to_string());
        self.bar.tick();
    }
}

/// Starts the line of a run that began at `start` with a budget of `time`: the share of it that has passed,
/// and the present step, which is its message.
pub fn countdown(start: Instant, time: Duration) -> ProgressBar {
    let passed = move || start.elapsed().div_duration_f64(time).min(1.0);
    let filled = move |_: &ProgressState, out: &mut dyn Write| {
        let _ = out.write_str(&"█".repeat((passed() * 30.0) as usize));
    };
    let say = move |_: &ProgressState, out: &mut dyn Write| {
        let left = time.saturating_sub(start.elapsed()).max(Duration::from_secs(1));
        let _ = write!(out, "{:.0} %  {} left", passed() * 100.0, HumanDuration(left));
    };
    let template = style("{filled:30!.cyan/blue} {say}  {msg}");
    line(None, template.with_key("filled", filled).with_key("say", say))
}

/// Starts the line of a list of tasks, which several threads take, with the time left.
pub fn tasks(count: usize) -> ProgressBar {
    let left = |state: &ProgressState, out: &mut dyn Write| {
        let (share, time) = (f64::from(state.fraction()), state.elapsed());
        let _ = out.write_str(&time_left(share, share, time));
    };
    line(Some(count as u64), style("{wide_bar} {pos}/{len}{left}").with_key("left", left))
}

/// Starts a line on standard error, redrawn by a separate thread, if that is a terminal.
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

/// Returns the text behind the bar, at `done` of `expected` pixel samples, `had` of them by an earlier run;
/// `pixels` of them are a pass.
fn figures(
    [had, done]: [u64; 2],
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
    // Where the time limit will end the rendering, the number of samples is unknown.
    let all =
        if of_samples < of_time { String::new() } else { format!("/{}", grouped(expected.div_ceil(pixels))) };
    let mut text = format!("{:.1} %  {}{all} samples  {rate} Mray/s", share * 100.0, grouped(done / pixels));
    // The share that this run did.
    let own = share - if of_samples < of_time { 0.0 } else { had as f64 / expected.max(1) as f64 };
    let left = time_left(share, own, time);
    // Parts of a picture differ in cost: before the first whole sample the time left is a guess.
    let guess = done < pixels && of_time < of_samples;
    text += &if guess { left.replacen("  ", "  perhaps ", 1) } else { left };
    text
}

/// Returns the time left at this share of the work, `own` of which took this time; empty while it is
/// uncertain.
fn time_left(share: f64, own: f64, time: Duration) -> String {
    if !(SETTLED_SHARE..1.0).contains(&share) || time < SETTLED {
        return String::new();
    }
    let left = time.mul_f64(((1.0 - share) / own.max(1e-9)).min(1e9)).max(Duration::from_secs(1));
    format!("  {} left", HumanDuration(left))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each sample has 1,000 pixels, and 4 are expected.
    #[test]
    fn figures_move_within_a_sample_and_tell_the_time_left_only_when_it_is_known() {
        for (samples, seconds, limit, progress, left) in [
            ([0, 16], 60, None, "0.4 %  0/4", ""),
            ([0, 2_000], 1, None, "50.0 %  2/4", ""),
            ([0, 400], 6, None, "10.0 %  0/4", "  perhaps 54 seconds left"),
            ([0, 3_000], 540, None, "75.0 %  3/4", "  3 minutes left"),
            ([0, 3_999], 9, None, "100.0 %  3/4", "  1 second left"),
            ([0, 4_000], 9, None, "100.0 %  4/4", ""),
            // Half was there; a quarter took nine seconds, and so will the last one.
            ([2_000, 3_000], 9, None, "75.0 %  3/4", "  9 seconds left"),
            // The clock decides where it will end first.
            ([0, 500], 5, Some(10), "50.0 %  0", "  5 seconds left"),
            ([0, 3_000], 5, Some(10), "75.0 %  3/4", "  2 seconds left"),
            ([0, 500], 12, Some(10), "100.0 %  0", ""),
        ] {
            let (time, limit) = (Duration::from_secs(seconds), limit.map(Duration::from_secs));
            let found = figures(samples, 1_000, 4_000, 2_000_000 * seconds, time, limit);
            assert_eq!(found, format!("{progress} samples  2.0 Mray/s{left}"));
        }
    }
}
