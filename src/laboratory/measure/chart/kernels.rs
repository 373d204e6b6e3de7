//! The intersection methods alone: time of a test, and error and failures on difficult inputs.

use super::clock::{self, Clock, Times};
use crate::lane::{Lane, NATIVE_WIDTH, Native};
use crate::measure::cores::Reliability;
use crate::measure::kernel_set::{self as set, Found};
use crate::measure::quantiles::Rounds;
use crate::measure::stability::methods::{Method, all_methods};
use crate::measure::stability::{Effort, Point, test_case};
use crate::methods::{BoxMethod, SphereMethod, TriangleMethod};
use serde::Serialize;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// One method at one width.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Kernel {
    /// `sphere`, `triangle` or `box`.
    pub family: &'static str,
    /// Name, as in `octray stability`.
    pub method: &'static str,
    /// Whether it is the renderer's default.
    pub default: bool,
    /// [`NATIVE_WIDTH`] or 1.
    pub lanes: usize,
    /// Nanoseconds of one core per test of one ray against one primitive: of processor time where the machine
    /// is busy.
    pub ns: f64,
    /// The 10th and the 90th percentile of the turns.
    pub ns_spread: [f64; 2],
    /// Wall time.
    pub wall_ns: f64,
    /// Processor time of the thread.
    pub processor_ns: f64,
    /// Reliability of `ns`.
    #[serde(flatten)]
    pub reliability: Reliability,
    /// The 99th percentile of the error of t, in the unit of `error_case`'s test case; null for boxes, which
    /// have none.
    pub p99: Option<f64>,
    /// The share of inputs that fail.
    pub failures: f64,
    /// Test case and place of `p99`; null without one.
    pub error_case: Option<CaseAt>,
    /// Test case and place of `failures`.
    pub failure_case: CaseAt,
}

/// A place in a test case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CaseAt {
    /// A test case of `octray stability`.
    pub test_case: &'static str,
    /// A place on its axis, in the unit of the axis.
    pub place: f64,
}

/// All rays against all primitives, once.
type Work = Box<dyn Fn() -> Found>;
/// The work of one method at a width.
type WorkOf = fn(usize) -> Work;

/// Defines the function that returns the work of a family's method at a width.
macro_rules! work {
    ($work:ident, $Method:ident, $primitives:expr, $test:ident) => {
        fn $work<M: $Method>(lanes: usize) -> Work {
            fn at<L: Lane, M: $Method>() -> Work {
                let (rays, primitives) = (set::rays::<L>(), $primitives);
                Box::new(move || set::$test::<L, M>(black_box(&rays), black_box(&primitives)))
            }
            if lanes == 1 { at::<f32, M>() } else { at::<Native, M>() }
        }
    };
}
work!(spheres, SphereMethod, set::spheres(), all_spheres);
work!(triangles, TriangleMethod, set::triangles::<M>(), all_triangles);
work!(boxes, BoxMethod, set::boxes(), all_boxes);

/// A kernel while it is timed.
struct TimedKernel {
    /// All but its times.
    kernel: Kernel,
    work: Work,
    /// Nanoseconds per test, by turn.
    turns: Times,
}

/// Length of a turn: long against the time of reading the clock, short against the drift of clock rates.
const TURN: Duration = Duration::from_micros(500);
/// The share of the stability command's inputs.
pub const EFFORT: Effort = Effort(0.25);

/// Measures errors and failures of every method, then times every method at both widths in alternating turns
/// until `end`, at least three each.
pub fn measure(end: Instant) -> Vec<Kernel> {
    let mut all = Vec::new();
    let case = |test_case, place| CaseAt { test_case, place };
    let mut add = |family, error_case: Option<CaseAt>, failure_case: CaseAt, methods: &[Method<WorkOf>]| {
        for lanes in [NATIVE_WIDTH, 1] {
            for &Method { name: method, default, run } in methods {
                let p99 = error_case.and_then(|case| at(case, method).p99);
                let failures = at(failure_case, method).rate();
                let untimed = Kernel { p99, failures, error_case, failure_case, ..Kernel::default() };
                let kernel = Kernel { family, method, default, lanes, ..untimed };
                all.push(TimedKernel { kernel, work: run(lanes), turns: Times::default() });
            }
        }
    };
    let (far, slivers) = (case("spheres-far", 1e3), case("triangles-slivers", 1e4));
    add("sphere", Some(far), far, &all_methods!(sphere, spheres));
    add("triangle", Some(slivers), case("mesh-edges", 1.0), &all_methods!(triangle, triangles));
    add("box", None, case("boxes-corners", 1.0), &all_methods!(box, boxes));
    for _ in Rounds::until(end, 3, usize::MAX) {
        all.iter_mut().for_each(TimedKernel::turn);
    }
    let clock = Clock::of(all.iter().map(|timed| &timed.turns));
    all.into_iter().map(|timed| timed.kernel(clock)).collect()
}

/// Runs a method at a place of the test case, which has every method of the family.
fn at(CaseAt { test_case: name, place }: CaseAt, method: &str) -> Point {
    let test_case = test_case(name).expect("the test case that the family names");
    test_case.at(test_case.method(method).expect("a method of the family"), place, EFFORT)
}

impl TimedKernel {
    fn turn(&mut self) {
        // Untimed: the method before left its own data and branches in the caches.
        black_box((self.work)());
        let mut rounds = 0;
        let seconds = clock::time(|| {
            let start = Instant::now();
            while start.elapsed() < TURN {
                black_box((self.work)());
                rounds += 1;
            }
        });
        self.turns.push(seconds.map(|seconds| seconds * 1e9 / (rounds * set::TESTS) as f64));
    }

    fn kernel(self, clock: Clock) -> Kernel {
        let turns = self.turns.spread(clock);
        Kernel {
            ns: turns.median,
            ns_spread: [turns.p10, turns.p90],
            wall_ns: self.turns.spread(Clock::Wall).median,
            processor_ns: self.turns.spread(Clock::Processor).median,
            reliability: self.turns.reliability(clock, true),
            ..self.kernel
        }
    }
}

impl Kernel {
    /// Returns the fastest other method of the family at the same width that is faster beyond the spread of
    /// the turns and has no larger error and no more failures. Both times must be reliable.
    pub fn dominated_by<'a>(&self, all: &'a [Kernel]) -> Option<&'a Kernel> {
        let better = |other: &&Kernel| {
            let peer =
                (other.family, other.lanes) == (self.family, self.lanes) && other.method != self.method;
            let errors = (other.p99.unwrap_or(0.0), other.failures);
            let ours = (self.p99.unwrap_or(0.0), self.failures);
            let as_accurate = errors.0 <= ours.0 && errors.1 <= ours.1;
            let reliable = self.reliability.worse(&other.reliability).reliable;
            peer && as_accurate && reliable && other.ns_spread[1] < self.ns_spread[0]
        };
        all.iter().filter(better).min_by(|a, b| a.ns.total_cmp(&b.ns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dominated_is_slower_and_not_more_accurate() {
        let reliability = Reliability { reliable: true, pinned: true, taken: None };
        let of = |method, ns: f64, failures| Kernel {
            method,
            ns,
            ns_spread: [ns * 0.95, ns * 1.05],
            reliability,
            p99: Some(1e-6),
            failures,
            ..Kernel::default()
        };
        let all =
            [of("fast", 1.0, 0.1), of("right", 2.0, 0.0), of("bad", 3.0, 0.1), of("as fast", 1.02, 0.1)];
        let by = |number: usize| all[number].dominated_by(&all).map(|other| other.method);
        assert_eq!([by(0), by(1), by(2), by(3)], [None, None, Some("fast"), None]);
        let reliability = Reliability { reliable: false, ..reliability };
        let doubtful = Kernel { reliability, ..all[2].clone() };
        assert_eq!(doubtful.dominated_by(&all), None);
        let exact = Kernel { p99: Some(1e-7), ..of("exact", 4.0, 0.1) };
        assert_eq!(exact.dominated_by(&all), None, "slower, and more accurate where it does not fail");
    }

    #[test]
    fn turns_give_nanoseconds_per_test() {
        let slept = Duration::from_millis(1);
        let work: Work = Box::new(move || {
            std::thread::sleep(slept);
            Found { hits: 0, distance: 0.0 }
        });
        let mut timed = TimedKernel { kernel: Kernel::default(), work, turns: Times::default() };
        let start = Instant::now();
        timed.turn();
        // `sleep` takes at least its time, and sometimes far more.
        let [least, most] = [slept, start.elapsed()].map(|time| time.as_nanos() as f64 / set::TESTS as f64);
        let [wall, processor] = [Clock::Wall, Clock::Processor].map(|clock| timed.turns.by(clock)[0]);
        assert!((least..=most).contains(&wall) && processor < wall, "{:?}", timed.turns);
    }
}
