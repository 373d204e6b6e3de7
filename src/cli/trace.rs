//! Takes samples until a limit is reached or the user interrupts.

use super::checkpoint::CheckpointWriter;
use super::interrupt;
use super::limits::Limits;
use super::progress::Progress;
use crate::adaptive::{ErrorEstimate, Round};
use crate::film::{Film, TileSums};
use crate::render::{RenderObserver, Renderer};
use crate::report::render::End;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Target duration of a chunk of samples: short enough for Ctrl-C to feel immediate, long enough that the
/// overhead of a chunk is negligible.
const CHUNK: Duration = Duration::from_millis(100);
/// Time that a chunk has to finish after Ctrl-C or the deadline, so that every pixel has the same number of
/// samples. A chunk that takes longer stops between tiles.
const GRACE: Duration = Duration::from_millis(300);

/// The result of [`trace`].
pub struct Traced {
    pub time: Duration,
    pub end: End,
    /// Mean samples of the film before.
    pub resumed_samples: f64,
    /// Rays of this run, without those that the film had before.
    pub rays: u64,
    /// The samples that each tile was to have at the end of the last round, by tile number.
    pub goals: Vec<u32>,
}

/// Adds samples in chunks until a limit is reached or the user interrupts. Between chunks, `writer` saves the
/// film when it is time.
pub fn trace(
    renderer: &Renderer,
    film: &mut Film,
    limits: &Limits,
    mut writer: Option<&mut CheckpointWriter>,
    progress: &Progress,
) -> Traced {
    let start = Instant::now();
    let (resumed_samples, resumed_rays) = (film.mean_samples(), film.rays());
    let deadline = limits.time.map(|time| start + time);
    let mut pace = Pace { chunk: 1, seconds_a_pixel: 0.0, deadline };
    let mut goals = writer.as_mut().map(|writer| std::mem::take(&mut writer.goals)).unwrap_or_default();
    let end = loop {
        let Some(round) = next_round(film, limits, &goals) else {
            let met = limits.target.is_some_and(|target| target.met(&ErrorEstimate::of(film)));
            break if met { End::TargetError } else { End::Samples };
        };
        progress.bar.set_length(round.forecast);
        let writer = writer.as_deref_mut();
        let end = take_round(renderer, film, &round, &mut pace, writer, progress);
        goals = round.goals;
        if let Some(end) = end {
            break end;
        }
    };
    Traced { time: start.elapsed(), end, resumed_samples, rays: film.rays() - resumed_rays, goals }
}

/// Returns the next round, or what is left of one with these goals; `None` at the end.
fn next_round(film: &Film, limits: &Limits, goals: &[u32]) -> Option<Round> {
    match &limits.target {
        // The film of an unfinished round must not decide: with other samples, the decision would differ.
        Some(_) if film.tiles().iter().any(|sums| goals.get(sums.tile.number) > Some(&sums.samples)) => {
            let pixel_samples =
                |sums: &TileSums| sums.tile.pixels() as u64 * u64::from(goals[sums.tile.number]);
            Some(Round { goals: goals.to_vec(), forecast: film.tiles().iter().map(pixel_samples).sum() })
        }
        Some(target) => target.next(film),
        None => Round::equal(film, limits.samples),
    }
}

/// The speed of sampling so far.
struct Pace {
    /// Samples per pixel in the next chunk.
    chunk: u32,
    /// Seconds per sample of a pixel; 0 before the first chunk.
    seconds_a_pixel: f64,
    /// When sampling ends, if it has a time limit.
    deadline: Option<Instant>,
}

/// Brings all tiles to their goals, chunk by chunk, so that no tile runs ahead. Returns why it stopped early,
/// if it did.
fn take_round(
    renderer: &Renderer,
    film: &mut Film,
    round: &Round,
    pace: &mut Pace,
    mut writer: Option<&mut CheckpointWriter>,
    progress: &Progress,
) -> Option<End> {
    loop {
        let (missing, pixels) = round.missing(film);
        if missing == 0 {
            return None;
        }
        if interrupt::requested() {
            return Some(End::Interrupt);
        }
        let mut chunk = pace.chunk.min(missing);
        let (began, least) = (Instant::now(), film.samples());
        let whole = least > 0;
        if let Some(deadline) = pace.deadline {
            let left = deadline.saturating_duration_since(began).as_secs_f64();
            let fitting = (left / (pixels as f64 * pace.seconds_a_pixel).max(1e-12)) as u32;
            // The first sample starts in any case: a part of the picture is more than none.
            if left == 0.0 || (whole && fitting == 0) {
                return Some(End::TimeLimit);
            }
            chunk = chunk.min(fitting.max(1));
        }
        let late = pace.deadline.map(|deadline| if whole { deadline + GRACE } else { deadline });
        let before = film.pixel_samples();
        let mut observer = Chunk { began, late, pause: None, progressed: AtomicBool::new(false), progress };
        // A resumed film may be uneven: where all tiles have one goal, those ahead wait for the others.
        let even = round.goals.windows(2).all(|goals| goals[0] == goals[1]);
        let mut goals = round.goals.clone();
        for sums in film.tiles() {
            let goal = &mut goals[sums.tile.number];
            *goal = (*goal).min(if even { least } else { sums.samples }.saturating_add(chunk));
        }
        let mut took = Duration::ZERO;
        // A chunk that is longer than the time between two checkpoints pauses for each.
        loop {
            observer.pause = writer.as_ref().map(|writer| writer.due + GRACE);
            observer.progressed = AtomicBool::new(false);
            let resumed = Instant::now();
            renderer.sample_tiles_to(film, |tile, _| goals[tile], &observer);
            took += resumed.elapsed();
            if let Some(writer) = writer.as_deref_mut()
                && writer.is_due(film)
            {
                progress.bar.suspend(|| writer.save_or_warn(film, &round.goals));
            }
            let done = film.tiles().iter().all(|sums| sums.samples >= goals[sums.tile.number]);
            if done || observer.is_stopped() {
                break;
            }
        }
        let done = film.pixel_samples() - before;
        pace.seconds_a_pixel = took.as_secs_f64() / (done as f64).max(1.0);
        // The next chunk has as many samples as should take `CHUNK` at this speed, and at most four times as
        // many as the last one, because short times are measured poorly.
        let fitting = f64::from(chunk) * CHUNK.as_secs_f64() / took.as_secs_f64().max(1e-9);
        pace.chunk = (fitting as u32).clamp(1, chunk.saturating_mul(4));
    }
}

/// The observer of a chunk: counts progress, and stops the chunk after an interrupt or the deadline.
struct Chunk<'a> {
    began: Instant,
    late: Option<Instant>,
    /// Time for a checkpoint, once there is something new to save.
    pause: Option<Instant>,
    progressed: AtomicBool,
    progress: &'a Progress,
}

impl Chunk<'_> {
    /// Tests whether the user or the deadline ends the rendering.
    fn is_stopped(&self) -> bool {
        let interrupted = interrupt::requested() && self.began.elapsed() >= GRACE;
        interrupted || self.late.is_some_and(|late| Instant::now() >= late)
    }
}

impl RenderObserver for Chunk<'_> {
    fn is_cancelled(&self) -> bool {
        let is_due = |pause| self.progressed.load(Ordering::Relaxed) && Instant::now() >= pause;
        self.is_stopped() || self.pause.is_some_and(is_due)
    }
    fn sample_done(&self, pixels: usize, rays: u64) {
        interrupt::set_begun();
        if !self.progressed.load(Ordering::Relaxed) {
            self.progressed.store(true, Ordering::Relaxed);
        }
        self.progress.add(pixels, rays);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Settings;

    /// All pixels have equal samples, unless a busy machine held the last chunk up for longer than its grace.
    #[test]
    fn trace_evens_out_what_it_resumes() {
        let scene = crate::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [40, 24], max_bounces: 1, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film_with_noise();
        renderer.sample_tiles_to(&mut film, |tile, _| tile as u32 % 4, &());
        let time = Duration::from_millis(200);
        let limits = Limits { samples: 1 << 24, target: None, time: Some(time) };
        let progress = Progress::new(film.pixels(), film.pixel_samples(), limits.time);
        let traced = trace(&renderer, &mut film, &limits, None, &progress);
        assert_eq!(traced.end, End::TimeLimit);
        let (least, most, took) = (film.samples(), film.most_samples(), traced.time);
        assert!((least == most && most > 3) || took >= time + GRACE, "{least} to {most} samples in {took:?}");
    }
}
