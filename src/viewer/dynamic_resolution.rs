//! Dynamic resolution: holds a target frame rate by fewer pixels.
//!
//! For: [`DynamicResolution`].

use std::time::Duration;

/// Shares of the target frame time: what a new resolution aims at, and below what a higher resolution is
/// chosen.
const TARGET_SHARE: f64 = 0.95;
const MIN_SHARE: f64 = 0.6;
/// Lowest resolution scale.
const MIN_RESOLUTION_SCALE: f64 = 0.05;
/// Number of frames whose fastest decides: one frame alone may have been delayed by something else.
const DECIDING_FRAMES: u32 = 2;
/// Count and fastest time of no frames.
const NO_FRAMES: (u32, Duration) = (0, Duration::MAX);

/// Chooses the scale of the resolution from the time of frames.
#[derive(Clone, Copy, Debug)]
pub struct DynamicResolution {
    /// Scale of the resolution's sides that holds the target frame rate; at most 1.
    pub scale: f64,
    /// Count and fastest time of the frames since the last decision.
    fastest: (u32, Duration),
    /// Whether the frame time was within the target's bounds at the last decision.
    target_met: bool,
}

impl Default for DynamicResolution {
    fn default() -> Self {
        Self { scale: 1.0, fastest: NO_FRAMES, target_met: false }
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
        self.fastest = (self.fastest.0 + 1, self.fastest.1.min(needed));
        if self.fastest.0 < DECIDING_FRAMES || (self.target_met && settled) {
            return;
        }
        let (needed, wanted) = (self.fastest.1.as_secs_f64(), 1.0 / f64::from(target));
        self.fastest = NO_FRAMES;
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

    #[test]
    fn resolution_drops_as_far_as_the_frame_rate_needs_and_no_further() {
        let mut resolution = DynamicResolution::default();
        // A machine that takes 100 ms for all pixels.
        let mut settle = |target| {
            for _ in 0..300 {
                let time = Duration::from_secs_f64(0.1 * resolution.scale.powi(2));
                resolution.adapt(target, time, false);
            }
            (resolution.scale, 0.1 * resolution.scale.powi(2))
        };
        let (coarse, takes) = settle(Some(30));
        assert!(coarse < 1.0 && (0.5 / 30.0..1.05 / 30.0).contains(&takes), "{takes} s");
        assert_eq!(settle(Some(30)).0, coarse, "at rest");
        assert!(settle(Some(60)).0 < coarse);
        assert_eq!(settle(Some(5)).0, 1.0);
        assert!(settle(Some(1_000)).0 < coarse);
        assert_eq!(settle(None).0, 1.0);
    }

    #[test]
    fn a_frame_rate_is_held_after_a_few_frames() {
        let mut resolution = DynamicResolution::default();
        let mut after = |frames, target| {
            let mut time = Duration::ZERO;
            for _ in 0..frames {
                time = Duration::from_secs_f64(0.4 * resolution.scale.powi(2));
                resolution.adapt(Some(target), time, false);
            }
            time.as_secs_f64() * f64::from(target)
        };
        let takes = [after(3, 30), after(3, 60), after(3, 20)];
        assert!(takes.iter().all(|share| (0.6..1.05).contains(share)), "shares of the time: {takes:?}");
    }

    #[test]
    fn resolution_of_a_slow_picture_drops_at_a_resting_camera_too() {
        let mut resolution = DynamicResolution::default();
        (0..DECIDING_FRAMES).for_each(|_| resolution.adapt(Some(30), Duration::from_secs(2), true));
        assert!(resolution.scale < 0.2, "{}", resolution.scale);
        (0..DECIDING_FRAMES).for_each(|_| resolution.adapt(Some(30), Duration::from_secs(200), true));
        assert_eq!(resolution.scale, MIN_RESOLUTION_SCALE, "no coarser, however slow");
    }

    #[test]
    fn frame_times_that_vary_a_little_keep_the_resolution() {
        let mut resolution = DynamicResolution::default();
        let mut hold = |ms, times| {
            for _ in 0..times {
                let time = Duration::from_secs_f64(ms * 1e-3 * resolution.scale.powi(2));
                resolution.adapt(Some(30), time, false);
            }
            resolution.scale
        };
        let coarse = hold(100.0, 10);
        for ms in [90.0, 105.0, 80.0, 100.0, 70.0] {
            assert_eq!(hold(ms, 4), coarse, "{ms} ms for all pixels, where 100 were");
        }
        assert!(hold(50.0, 4) > coarse && hold(150.0, 4) < coarse);
    }
}
