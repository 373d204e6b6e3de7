//! Rays a second, by kind of ray and way of tracing, from prepared arrays: making the rays is not counted.
//!
//! For: [`build`], [`prepare`], [`measure()`]. May import: everything above it. Must never know: command lines, terminals.
//!
//! All ways take turns, pass by pass, so that a machine that slows down slows all of them. Every pass's hits are held against
//! those of one scalar ray at a time on the binary tree.

use super::ray_sets::{Answers, Kind, Prepared, RaySet, pixels};
use super::statistics::Quantiles;
use super::stats::RayStats;
use super::ways::{Ground, Team, Way};
use crate::bvh::Trees;
use crate::camera::Pinhole;
use crate::math::MISS;
use crate::scene::{Camera, Scene};
use crate::traverse::batch::Traversal;
use crate::traverse::hierarchy::Hierarchy;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Fewest passes behind a median.
const FEWEST_PASSES: usize = 7;
/// Short passes go on until this time has passed for all ways of a kind together.
const PER_KIND: Duration = Duration::from_secs(1);
/// Builds behind a median: at least as many as are asked for, and on until this time or this number is reached.
const MOST_BUILDS: usize = 51;
const BUILDING: Duration = Duration::from_millis(500);
/// Most rays times primitives that a linear pass may test: about a second on one thread.
const MOST_LINEAR: usize = 500_000_000;

/// How long one build takes: nodes, and leaves filled with what traversals read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuildTime {
    pub threads: usize,
    /// Median.
    pub ms: f64,
    pub builds: usize,
}

/// Builds the scene's hierarchy at least `fewest` times on each of these numbers of threads, in turn.
///
/// # Panics
/// If there is no number of threads, or the system refuses threads.
pub fn build(scene: &Scene, threads: &[usize], fewest: usize) -> (Hierarchy, Vec<BuildTime>) {
    // The builder takes the threads of the pool it runs in: one thread needs a pool too.
    let pool = |&threads: &usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("the system gives threads")
    };
    let pools: Vec<rayon::ThreadPool> = threads.iter().map(pool).collect();
    let mut seconds = vec![Vec::new(); threads.len()];
    let mut hierarchy = None;
    let start = Instant::now();
    while seconds[0].len() < fewest || (seconds[0].len() < MOST_BUILDS && start.elapsed() < BUILDING) {
        for (pool, seconds) in pools.iter().zip(&mut seconds) {
            // Two large hierarchies at a time are one too many.
            drop(hierarchy.take());
            let start = Instant::now();
            hierarchy = Some(pool.install(|| Hierarchy::new(scene, Trees::WideAndBinary)));
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    let time = |(&threads, seconds): (&usize, Vec<f64>)| {
        let times = Quantiles::of(seconds);
        BuildTime { threads, ms: times.median() * 1e3, builds: times.count() }
    };
    let times = threads.iter().zip(seconds).map(time).collect();
    (hierarchy.expect("at least one was built"), times)
}

/// What every way is held against: one scalar ray at a time.
const BASELINE: Way = Way::Tree(Traversal::Scalar);

/// The rays of every kind and their nearest hits; primary rays are those of `camera`.
pub fn prepare(
    scene: &Scene,
    camera: &Camera,
    ground: &Ground,
    team: &Team,
    size: [u32; 2],
    seed: u32,
) -> Vec<Prepared> {
    let prepared = |set: RaySet| {
        let mut nearest = Answers::none(&set);
        team.run(|| team.trace::<false>(BASELINE, ground, &set, &mut nearest));
        Prepared { set, nearest }
    };
    let pixels = pixels(size);
    let primary = prepared(RaySet::primary(&Pinhole::new(camera, size), &pixels));
    let from_hits = |kind| prepared(RaySet::from_hits(kind, scene, &primary, &pixels, size[0], seed));
    let (shadow, diffuse) = (from_hits(Kind::Shadow), from_hits(Kind::Diffuse));
    vec![primary, shadow, diffuse]
}

/// What one way reached with one kind of rays.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    pub kind: Kind,
    pub traversal: &'static str,
    pub lanes: usize,
    pub threads: usize,
    pub rays: usize,
    pub hits: usize,
    /// In the median pass, in millions a second; 0 where there are no rays.
    pub mrays_per_s: f64,
    /// The rate that 90 % and 10 % of the passes reach: the spread.
    pub mrays_per_s_spread: [f64; 2],
    pub passes: usize,
    /// Rays, in the pass with most of them, whose answer is not the baseline's: in any bit of the nearest hit, or, of shadow rays, in
    /// whether there is a hit.
    pub disagreements: usize,
    pub first_disagreement: Option<Disagreement>,
}

/// A ray whose answer is not the baseline's.
#[derive(Clone, Debug, Serialize)]
pub struct Disagreement {
    /// Place in the set.
    pub ray: usize,
    pub expected: Answer,
    pub found: Answer,
}

#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    pub t: f32,
    pub primitive: u32,
    pub u: f32,
    pub v: f32,
}

/// The ways worth timing for a kind of rays.
fn applies(way: Way, kind: Kind) -> bool {
    way != Way::Tree(Traversal::Packet) || kind == Kind::Primary
}

/// Would testing everything take too long for these rays?
pub fn too_many_for_linear(scene: &Scene, set: &RaySet) -> bool {
    (scene.spheres.len() + scene.triangles.len()).saturating_mul(set.len()) > MOST_LINEAR
}

/// A way's turns.
struct Run<'a> {
    way: Way,
    team: &'a Team,
    seconds: Vec<f64>,
    hits: usize,
    disagreements: usize,
    first: Option<Disagreement>,
}

impl Run<'_> {
    /// Traces all rays once; returns the seconds that took. Never in line: `perf/stat.sh` knows it by name.
    #[inline(never)]
    fn pass(&mut self, ground: &Ground, rays: &Prepared, answers: &mut Answers) -> f64 {
        let Prepared { set, nearest } = rays;
        let team = self.team;
        let seconds = team.run(|| {
            team.forget(set, answers);
            let start = Instant::now();
            if set.kind.any_hit() {
                team.trace::<true>(self.way, ground, set, answers);
            } else {
                team.trace::<false>(self.way, ground, set, answers);
            }
            start.elapsed().as_secs_f64()
        });
        self.hits = answers.count();
        let mut wrong = (0..set.len()).filter(|&at| !agree(set.kind, nearest, answers, at)).peekable();
        if let (None, Some(&ray)) = (&self.first, wrong.peek()) {
            let [expected, found] = [nearest, answers].map(|answers| answer(answers, ray));
            self.first = Some(Disagreement { ray, expected, found });
        }
        self.disagreements = self.disagreements.max(wrong.count());
        seconds
    }
}

fn agree(kind: Kind, expected: &Answers, found: &Answers, at: usize) -> bool {
    let hit = |answers: &Answers| answers.primitive[at] != MISS;
    if kind.any_hit() {
        return hit(expected) == hit(found);
    }
    let bits = |answers: &Answers| {
        let Answers { t, primitive, u, v } = answers;
        [t[at].to_bits(), primitive[at], u[at].to_bits(), v[at].to_bits()]
    };
    bits(expected) == bits(found)
}

fn answer(answers: &Answers, at: usize) -> Answer {
    let Answers { t, primitive, u, v } = answers;
    Answer { t: t[at], primitive: primitive[at], u: u[at], v: v[at] }
}

/// Times these ways with one kind of rays, each on each team, in turn: so many passes, or as many as it takes. Ways that do not
/// apply to the kind are left out.
pub fn measure(
    ground: &Ground,
    rays: &Prepared,
    ways: &[Way],
    teams: &[Team],
    passes: Option<u32>,
) -> Vec<Measurement> {
    let set = &rays.set;
    let mut answers = Answers::none(set);
    let run = |team, way| Run { way, team, seconds: Vec::new(), hits: 0, disagreements: 0, first: None };
    let ways = || ways.iter().copied().filter(|&way| applies(way, set.kind));
    let mut runs: Vec<Run> = teams.iter().flat_map(|team| ways().map(move |way| run(team, way))).collect();
    if runs.is_empty() {
        return Vec::new();
    }
    // Caches and branch predictors fill, threads start.
    for run in &mut runs {
        run.pass(ground, rays, &mut answers);
    }
    let (start, mut done) = (Instant::now(), 0);
    let enough = |done: usize| match passes {
        Some(passes) => done >= passes as usize,
        None => done >= FEWEST_PASSES && (set.is_empty() || start.elapsed() >= PER_KIND),
    };
    while !enough(done) {
        for run in &mut runs {
            let seconds = run.pass(ground, rays, &mut answers);
            run.seconds.push(seconds);
        }
        done += 1;
    }
    runs.into_iter().map(|run| measurement(set, run)).collect()
}

/// What these ways test for one kind of rays: each traces them once, on one thread, and no more time is measured. Ways that do not
/// apply to the kind are left out.
pub fn count(ground: &Ground, rays: &Prepared, ways: &[Way]) -> Vec<RayStats> {
    let ways = ways.iter().filter(|&&way| applies(way, rays.set.kind));
    ways.map(|&way| RayStats::count(ground, way, &rays.set)).collect()
}

fn measurement(set: &RaySet, run: Run) -> Measurement {
    let times = Quantiles::of(run.seconds);
    // A clock may stand still over no rays.
    let rate = |seconds: f64| if set.is_empty() { 0.0 } else { set.len() as f64 / seconds / 1e6 };
    Measurement {
        kind: set.kind,
        traversal: run.way.name(),
        lanes: run.way.lanes(),
        threads: run.team.threads(),
        rays: set.len(),
        hits: run.hits,
        mrays_per_s: rate(times.median()),
        mrays_per_s_spread: [rate(times.at(0.9)), rate(times.at(0.1))],
        passes: times.count(),
        disagreements: run.disagreements,
        first_disagreement: run.first,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_formats::scene::load;

    #[test]
    fn measure_takes_no_time_where_no_way_applies() {
        let scene = load("builtin:terrain:2").unwrap();
        let ground = Ground::new(&scene, Hierarchy::new(&scene, Trees::WideAndBinary));
        let teams = [Team::new(1)];
        let packet = [Way::Tree(Traversal::Packet)];
        let sets = prepare(&scene, &scene.overview().unwrap(), &ground, &teams[0], [64, 48], 0);
        for rays in &sets[1..] {
            let start = Instant::now();
            assert!(measure(&ground, rays, &packet, &teams, None).is_empty());
            assert!(start.elapsed() < PER_KIND, "{:?} for nothing", start.elapsed());
        }
        assert_eq!(measure(&ground, &sets[0], &packet, &teams, Some(1)).len(), 1);
    }
}
