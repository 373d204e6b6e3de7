//! Rays per second by kind of ray and traversal, from prepared arrays: generating the rays is not timed.
//!
//! All methods are timed in alternating passes, so that a slow spell of the machine affects all alike. Every
//! pass's hits are compared with those of the scalar traversal.

use super::cores::{Reliability, on_own_cores};
use super::quantiles::{Quantiles, Rounds};
use super::ray_sets::{Answer, Answers, Kind, RaySet, RaysWithHits, pixels};
use super::stats::{RayStats, TestStats};
use super::timed::{Ratio, Times};
use super::trace::{Accelerators, TracePool, lanes};
use crate::camera::PreparedCamera;
use crate::rays::{Geometry, Structure, Traversal};
use crate::render::TraversalChoice;
use crate::scene::{Camera, Scene};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Fewest passes behind a median and its spread, of which a tenth is one pass.
const FEWEST_PASSES: usize = 10;
/// Passes repeat until this time has passed for all methods of a kind together.
const PER_KIND: Duration = Duration::from_secs(1);
/// Builds repeat until this time or this number is reached.
const MOST_BUILDS: usize = 51;
const BUILDING: Duration = Duration::from_millis(500);
/// Most tests of a linear pass: about a second on one thread.
const MOST_LINEAR: usize = 500_000_000;

/// Time of one build: nodes, and leaves with the primitives that traversals read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuildTime {
    /// Threads of the builder.
    pub threads: usize,
    /// Median, in milliseconds.
    pub ms: f64,
    /// Builds behind the median.
    pub builds: usize,
}

/// Builds the scene's hierarchy at least `fewest` times on each of these numbers of threads, in alternation.
///
/// # Panics
/// If `threads` is empty, or the system refuses threads.
pub fn build(geometry: &Geometry, threads: &[usize], fewest: usize) -> (Structure, Vec<BuildTime>) {
    // The builder uses the pool that it runs in: one thread needs a pool too.
    let pool = |&threads: &usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("the system gives threads")
    };
    let pools: Vec<rayon::ThreadPool> = threads.iter().map(pool).collect();
    let mut seconds = vec![Vec::new(); threads.len()];
    let mut hierarchy = None;
    for _ in Rounds::until(Instant::now() + BUILDING, fewest.max(1), MOST_BUILDS) {
        for (pool, seconds) in pools.iter().zip(&mut seconds) {
            // Frees the memory of the last build first.
            drop(hierarchy.take());
            let start = Instant::now();
            hierarchy = Some(pool.install(|| Structure::tree_for_all(geometry)));
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

/// The method whose hits all others must reproduce: one scalar ray at a time.
const BASELINE: TraversalChoice = TraversalChoice::Through(Traversal::Scalar);

/// Returns the rays of every kind, from `camera`, with their nearest hits.
pub fn prepare(
    scene: &Scene,
    camera: &Camera,
    structures: &Accelerators,
    pool: &TracePool,
    size: [u32; 2],
    seed: u32,
) -> Vec<RaysWithHits> {
    let prepared = |set: RaySet| {
        let mut nearest = Answers::none(&set);
        pool.run(|| pool.trace(BASELINE, structures, &set, &mut nearest, false));
        RaysWithHits { set, nearest }
    };
    let pixels = pixels(size);
    let primary = prepared(RaySet::primary(&PreparedCamera::new(camera, size), &pixels));
    let from_hits = |kind| prepared(RaySet::from_hits(kind, scene, &primary, &pixels, size[0], seed));
    let (shadow, diffuse) = (from_hits(Kind::Shadow), from_hits(Kind::Diffuse));
    vec![primary, shadow, diffuse]
}

/// The speed of one method with one kind of rays.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// Kind of the rays.
    pub kind: Kind,
    /// Name on the command line: [`TraversalChoice::name`].
    pub traversal: &'static str,
    /// SIMD width of the traversal.
    pub lanes: usize,
    /// Threads that trace.
    pub threads: usize,
    /// Rays of a pass.
    pub rays: usize,
    /// Rays that hit something, in the last pass.
    pub hits: usize,
    /// Millions of rays per second in the median pass; 0 without rays.
    pub mrays_per_s: f64,
    /// 90 % and 10 % of the passes are at least this fast: the spread.
    pub mrays_per_s_spread: [f64; 2],
    /// Speed over that of the scalar traversal on as many threads: of the passes. `None` for that traversal,
    /// and where it is not measured.
    pub over_scalar: Option<Ratio>,
    /// Speed over that in an earlier report, where it has these rays, traversal, lanes and threads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_baseline: Option<Ratio>,
    /// Passes behind the median.
    pub passes: usize,
    /// Reliability of the speeds.
    #[serde(flatten)]
    pub reliability: Reliability,
    /// Rays whose answer differs from the baseline's, in the pass with most of them: in any bit of the
    /// nearest hit; for shadow rays, in whether there is a hit.
    pub disagreements: usize,
    /// A ray of the first pass that has one; `None` without.
    pub first_disagreement: Option<Disagreement>,
}

/// A ray whose answer differs from the baseline's.
#[derive(Clone, Debug, Serialize)]
pub struct Disagreement {
    /// Index in the set.
    pub ray: usize,
    /// Hit of the scalar traversal.
    pub expected: Answer,
    /// Hit of the measured method.
    pub found: Answer,
}

/// Tests whether a method is timed for a kind of rays: packets need coherent rays.
fn applies(method: TraversalChoice, kind: Kind) -> bool {
    method != TraversalChoice::Through(Traversal::Packet) || kind == Kind::Primary
}

/// Tests whether testing every primitive takes too long for these rays.
pub fn too_many_for_linear(scene: &Scene, set: &RaySet) -> bool {
    scene.primitives().saturating_mul(set.len()) > MOST_LINEAR
}

/// A method on a pool while it is timed.
struct Run<'a> {
    method: TraversalChoice,
    pool: &'a TracePool,
    times: Times,
    hits: usize,
    disagreements: usize,
    first: Option<Disagreement>,
}

impl Run<'_> {
    /// Traces all rays once. `inline(never)`: `perf/stat.sh` selects this function by name.
    #[inline(never)]
    fn pass(&mut self, structures: &Accelerators, rays: &RaysWithHits, answers: &mut Answers) {
        let RaysWithHits { set, nearest } = rays;
        let pool = self.pool;
        let trace = || {
            pool.clear(set, answers);
            let start = Instant::now();
            pool.trace(self.method, structures, set, answers, set.kind.any_hit());
            start.elapsed().as_secs_f64()
        };
        let (seconds, _, turn) = pool.run(|| on_own_cores(pool.threads(), trace));
        self.times.push(&[seconds], turn);
        self.hits = answers.count();
        let disagreement = |ray| {
            let [expected, found] = [nearest, answers].map(|answers| answers.get(ray));
            (!expected.agrees(&found, set.kind)).then_some(Disagreement { ray, expected, found })
        };
        let wrong: Vec<Disagreement> = (0..set.len()).filter_map(disagreement).collect();
        self.disagreements = self.disagreements.max(wrong.len());
        self.first = self.first.take().or(wrong.into_iter().next());
    }
}

/// Times these methods with one kind of rays, each on each pool, in alternating passes: `passes` of them, or
/// as many as a median needs. Methods that do not apply to the kind are left out.
pub fn measure(
    structures: &Accelerators,
    rays: &RaysWithHits,
    methods: &[TraversalChoice],
    pools: &[TracePool],
    passes: Option<u32>,
) -> Vec<Measurement> {
    let set = &rays.set;
    let mut answers = Answers::none(set);
    let run =
        |pool, method| Run { method, pool, times: Times::default(), hits: 0, disagreements: 0, first: None };
    let methods = || methods.iter().copied().filter(|&method| applies(method, set.kind));
    let mut runs: Vec<Run> =
        pools.iter().flat_map(|pool| methods().map(move |method| run(pool, method))).collect();
    if runs.is_empty() {
        return Vec::new();
    }
    // Caches and branch predictors fill, threads start.
    for run in &mut runs {
        run.pass(structures, rays, &mut answers);
        run.times = Times::default();
    }
    let start = Instant::now();
    let rounds = match passes.map(|passes| passes as usize) {
        Some(passes) => Rounds::until(start, passes, passes),
        None if set.is_empty() => Rounds::until(start, FEWEST_PASSES, FEWEST_PASSES),
        None => Rounds::until(start + PER_KIND, FEWEST_PASSES, usize::MAX),
    };
    for _ in rounds {
        for run in &mut runs {
            run.pass(structures, rays, &mut answers);
        }
    }
    runs.iter().map(|run| measurement(set, run, &runs)).collect()
}

/// Counts the tests of these methods for one kind of rays, which each traces once on one thread, untimed: the
/// counts do not depend on the number of threads. Methods that do not apply to the kind are left out.
pub fn count(structures: &Accelerators, rays: &RaysWithHits, methods: &[TraversalChoice]) -> Vec<RayStats> {
    let RaysWithHits { set, .. } = rays;
    let methods = methods.iter().filter(|&&method| applies(method, set.kind));
    let count = |&method: &TraversalChoice| {
        let rays = set.len() as u64;
        let tests = TestStats::of(&structures.count(method, set), rays);
        RayStats { kind: set.kind, traversal: method.name(), rays, tests }
    };
    methods.map(count).collect()
}

fn measurement(set: &RaySet, run: &Run, runs: &[Run]) -> Measurement {
    let times = Quantiles::of(run.times.seconds.clone());
    // Without rays the time may be 0.
    let [fast, slow] = times.spread();
    let is_scalar = |other: &&Run| other.method == BASELINE && std::ptr::eq(other.pool, run.pool);
    let scalar = runs.iter().find(is_scalar).filter(|_| run.method != BASELINE && !set.is_empty());
    let rate = |seconds: f64| if set.is_empty() { 0.0 } else { set.len() as f64 / seconds / 1e6 };
    Measurement {
        kind: set.kind,
        traversal: run.method.name(),
        lanes: lanes(run.method),
        threads: run.pool.threads(),
        rays: set.len(),
        hits: run.hits,
        mrays_per_s: rate(times.median()),
        mrays_per_s_spread: [rate(slow), rate(fast)],
        over_scalar: scalar.and_then(|scalar| Ratio::of(&run.times, &scalar.times)),
        over_baseline: None,
        passes: times.count(),
        reliability: run.times.reliability(FEWEST_PASSES),
        disagreements: run.disagreements,
        first_disagreement: run.first.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::MISS;
    use crate::measure::ray_sets::secondary_origin;
    use octray_formats::scene::load;

    fn prepared(scene: &Scene, size: [u32; 2], seed: u32) -> Vec<RaysWithHits> {
        let structures = Accelerators::new(&scene.geometry(), Structure::tree_for_all(&scene.geometry()));
        prepare(scene, &scene.overview().unwrap(), &structures, &TracePool::new(2), size, seed)
    }

    fn vector([x, y, z]: &[Vec<f32>; 3], at: usize) -> glam::Vec3 {
        glam::Vec3::new(x[at], y[at], z[at])
    }

    #[test]
    fn rays_leave_from_the_side_on_which_the_primary_ray_arrived_and_miss_their_own_surface() {
        // Convex from outside and from inside: a ball, and the inner side of a box.
        for (name, all_hit) in [("builtin:three", false), ("builtin:cornell", true)] {
            let scene = load(name).unwrap();
            let [primary, shadow, diffuse] = &prepared(&scene, [70, 50], 3)[..] else {
                panic!("three kinds")
            };
            let hits: Vec<usize> =
                (0..primary.set.len()).filter(|&at| primary.nearest.primitive[at] != MISS).collect();
            assert!(hits.len() > 100, "{name}");
            for secondary in [shadow, diffuse] {
                assert_eq!(secondary.set.len(), hits.len(), "{name}");
                for (at, &from) in hits.iter().enumerate() {
                    let hit = primary.nearest.get(from);
                    let ray = primary.set.rays().packet::<f32>(from);
                    let (origin, normal) = secondary_origin(&scene, &ray, &hit);
                    assert_eq!(origin.get(0), vector(&secondary.set.origin, at));
                    let direction = vector(&secondary.set.direction, at);
                    assert!(
                        normal.get(0).dot(ray.direction.get(0)) <= 0.0 && normal.get(0).dot(direction) > 0.0
                    );
                    let distance = origin.get(0).distance(ray.at(hit.t).get(0));
                    assert!(distance < 1e-3 * hit.t, "{name}: {distance} at {}", hit.t);
                    assert_ne!(secondary.nearest.primitive[at], hit.primitive, "{name}");
                }
            }
            let (lower, upper) = scene.bounds();
            let t_max = (0.25 * (upper - lower).length()) as f32;
            assert!(shadow.set.t_max.iter().all(|&one| one == t_max));
            assert!(!all_hit || shadow.nearest.t.iter().all(|&t| t <= t_max));
            assert_ne!(shadow.set.direction, diffuse.set.direction);
        }
    }
}
