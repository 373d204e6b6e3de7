//! Dynamic resolution: holds a target frame rate by fewer pixels.

use std::time::Duration;

/// Shares of the target frame time: what a new resolution aims at, and below what a higher resolution is
/// chosen.
const TARGET_SHARE: f64 = 0.95;
const MIN_SHARE: f64 = 0.6;
/// Lowest resolution scale.
const MIN_RESOLUTION_SCALE: f64 = 0.05;

/// Chooses the scale of the resolution from the time of frames.
#[derive(Clone, Copy, Debug)]
pub struct DynamicResolution {
    /// Scale of the resolution's sides that holds the target frame rate; at most 1.
    pub scale: f64,
    /// Time of the fastest frame since the last decision. At least two decide: one alone may have been
    /// delayed by something else.
    fastest: Option<Duration>,
    /// Whether the frame time was within the target's bounds at the last decision.
    target_met: bool,
}

impl Default for DynamicResolution {
    fn default() -> Self {
        Self { scale: 1.0, fastest: None, target_met: false }
    }
}

impl DynamicResolution {
    /// Discards the measured frames and keeps the scale: the resolution or the renderer changed.
    pub fn restart(&mut self) {
        *self = Self { scale: self.scale, ..Self::default() };
    }

    /// Lowers the scale when frames take longer than the target allows, raises it when there is time.
    /// `needed` is the time of the last frame. A `settled` picture keeps its scale once the target is met.
    pub fn adapt(&mut self, target: Option<u32>, needed: Duration, settled: bool) {
        let Some(target) = target else {
            self.scale = 1.0;
            return;
        };
        let fastest = self.fastest.map_or(needed, |before| before.min(needed));
        let is_first = self.fastest.replace(fastest).is_none();
        if is_first || (self.target_met && settled) {
            return;
        }
        self.fastest = None;
        let (needed, wanted) = (fastest.as_secs_f64(), 1.0 / f64::from(target));
        self.target_met = (wanted * MIN_SHARE..wanted * 1.05).contains(&needed);
        if !self.target_met {
            // Frame time is proportional to the number of pixels, the square of the scale.
            let step = (TARGET_SHARE * wanted / needed.max(1e-9)).sqrt();
            self.scale = (self.scale * step).clamp(MIN_RESOLUTION_SCALE, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scale, and its time as a share of the target's, after frames of a machine that takes so many
    /// milliseconds for all pixels.
    fn after(resolution: &mut DynamicResolution, frames: u32, ms: f64, target: u32) -> (f64, f64) {
        let time = |scale: f64| Duration::from_secs_f64(ms * 1e-3 * scale.powi(2));
        let mut last = Duration::ZERO;
        for _ in 0..frames {
            last = time(resolution.scale);
            resolution.adapt(Some(target), last, false);
        }
        (resolution.scale, last.as_secs_f64() * f64::from(target))
    }

    #[test]
    fn resolution_drops_within_a_few_frames_as_far_as_the_frame_rate_needs_and_no_further() {
        let mut resolution = DynamicResolution::default();
        let mut settle = |target| after(&mut resolution, 3, 100.0, target);
        let [coarse, again, coarser, finer] = [30, 30, 60, 20].map(&mut settle);
        assert!([coarse, coarser, finer].iter().all(|(_, share)| (0.6..1.05).contains(share)));
        assert!(coarse.0 < 1.0 && coarser.0 < coarse.0 && finer.0 > coarse.0);
        assert_eq!(again.0, coarse.0, "at rest");
        assert_eq!(settle(5).0, 1.0);
        assert!(settle(1_000).0 < coarser.0);
        resolution.adapt(None, Duration::ZERO, false);
        assert_eq!(resolution.scale, 1.0);
    }

    #[test]
    fn resolution_of_a_slow_picture_drops_at_a_resting_camera_too() {
        let mut resolution = DynamicResolution::default();
        (0..2).for_each(|_| resolution.adapt(Some(30), Duration::from_secs(2), true));
        assert!(resolution.scale < 0.2, "{}", resolution.scale);
        (0..2).for_each(|_| resolution.adapt(Some(30), Duration::from_secs(200), true));
        assert_eq!(resolution.scale, MIN_RESOLUTION_SCALE, "no coarser, however slow");
    }

    #[test]
    fn frame_times_that_vary_a_little_keep_the_resolution() {
        let mut resolution = DynamicResolution::default();
        let mut hold = |frames, ms| after(&mut resolution, frames, ms, 30).0;
        let coarse = hold(10, 100.0);
        for ms in [90.0, 105.0, 80.0, 100.0, 70.0] {
            assert_eq!(hold(4, ms), coarse, "{ms} ms for all pixels, where 100 were");
        }
        assert!(hold(4, 50.0) > coarse && hold(4, 150.0) < coarse);
    }
}
