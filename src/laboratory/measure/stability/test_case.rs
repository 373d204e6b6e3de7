//! A test case: inputs on which methods fail, and the failures of each method.

use super::methods::Method;
use super::rng::Rng;
use crate::measure::quantiles::Quantiles;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::{self, Debug};

/// Half the distance from 1 to the next f32, 2⁻²⁴, for bounds.
pub const EPSILON: f64 = crate::math::EPSILON as f64;

/// Tries and records some inputs at a place of the axis: usually one, and none where the random input is
/// unsuitable.
pub type Trial = Box<dyn Fn(&mut Rng, f64, &mut FailureCounts) + Send + Sync>;

/// Inputs on which methods fail, along one axis. JSON has its texts.
#[derive(Serialize)]
pub struct TestCase {
    /// Short name, for the command line and for files: `spheres-far`.
    #[serde(rename = "test_case")]
    pub name: &'static str,
    /// Difficulty, as the heading of a figure.
    pub title: &'static str,
    /// Quantity along the axis, with its unit.
    pub axis: &'static str,
    /// Places on the axis, ascending. It is logarithmic; 0 may come first.
    #[serde(skip)]
    pub places: &'static [f64],
    /// Definition of a failure.
    pub failure: &'static str,
    /// Definition and unit of the error, where one is measured.
    pub error: Option<&'static str>,
    /// Source that describes the difficulty.
    pub source: &'static str,
    /// Inputs at each place, with an effort of 1.
    #[serde(skip)]
    pub inputs: usize,
    /// The methods that are tried, the default among them.
    #[serde(skip)]
    pub methods: Vec<Method<Trial>>,
    /// Bound of the default method, by place.
    #[serde(skip)]
    pub bound: fn(f64) -> Bound,
}

impl Debug for TestCase {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// A [`Trial`] that also gets what a method computes.
pub(crate) type Case<M> = fn(&mut Rng, f64, &mut FailureCounts, M);

/// Returns the trial of each method.
pub(crate) fn trials<M: Copy + Send + Sync + 'static>(
    case: Case<M>,
    methods: &[Method<M>],
) -> Vec<Method<Trial>> {
    let trial = |&Method { name, default, run }: &Method<M>| Method::<Trial> {
        name,
        default,
        run: Box::new(move |rng, x, counts| case(rng, x, counts, run)),
    };
    methods.iter().map(trial).collect()
}

/// Variant of [`trials`] for methods by name, the last one the default.
pub(crate) fn compare<M: Copy + Send + Sync + 'static>(
    case: Case<M>,
    methods: &[(&'static str, M)],
) -> Vec<Method<Trial>> {
    let last = methods.len() - 1;
    let method = |(at, &(name, run))| Method { name, default: at == last, run };
    trials(case, &methods.iter().enumerate().map(method).collect::<Vec<_>>())
}

/// Largest share of failures and error of a method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// Most expected share of failures. Where it is not 0, five standard deviations of their number plus
    /// three are allowed on top.
    pub failures: f64,
    /// Largest 99th percentile of the error; `None` without a promise.
    pub p99: Option<f64>,
}

impl Bound {
    /// No promise.
    pub const NONE: Self = Self { failures: 1.0, p99: None };
    /// No failure.
    pub const NO_FAILURE: Self = Self { failures: 0.0, p99: None };

    /// Returns a bound of no failure, and of this 99th percentile of the error.
    pub(crate) const fn error(p99: f64) -> Self {
        Self { failures: 0.0, p99: Some(p99) }
    }
    /// Tests whether this number of failures is within the bound.
    pub(crate) fn allows(&self, failures: usize, tested: usize) -> bool {
        let expected = self.failures * tested as f64;
        let tolerance = if expected > 0.0 { 5.0 * expected.sqrt() + 3.0 } else { 0.0 };
        failures as f64 <= expected + tolerance
    }
}

/// Number of inputs, as a share of those of the command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort(pub f64);

impl Effort {
    /// Number of inputs of the command.
    pub const STANDARD: Self = Self(1.0);
    /// Number of inputs of the command with `--thorough`: millions for most test cases.
    pub const THOROUGH: Self = Self(10.0);

    fn inputs(self, full: usize) -> usize {
        ((full as f64 * self.0).ceil() as usize).max(1)
    }
}

/// Failures and errors of a method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FailureCounts {
    /// Inputs, failed or not.
    pub tested: usize,
    /// Inputs that failed.
    pub failures: usize,
    /// Errors of the inputs that did not fail, where measured.
    pub errors: Vec<f64>,
}

impl FailureCounts {
    /// Records an input without an error.
    pub(crate) fn record(&mut self, failed: bool) {
        self.tested += 1;
        self.failures += usize::from(failed);
    }
    /// Records an input that did not fail, with its error. An error that is NaN ([`FAILED`]) or infinite is a
    /// failure: in quantiles it would go unnoticed.
    pub(crate) fn record_error(&mut self, error: f64) {
        if error.is_finite() {
            self.tested += 1;
            self.errors.push(error);
        } else {
            self.record(true);
        }
    }
    fn merge(mut self, other: Self) -> Self {
        self.tested += other.tested;
        self.failures += other.failures;
        self.errors.extend(other.errors);
        self
    }
}

/// The error of an input that failed.
pub(crate) const FAILED: f64 = f64::NAN;

/// The result of a test case.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Its texts are flattened into this object in JSON.
    #[serde(flatten)]
    pub test_case: &'static TestCase,
    /// Whether the default method keeps its bounds.
    pub holds: bool,
    /// One per method, in the order of the test case.
    pub curves: Vec<Curve>,
}

/// One method along the axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Its name.
    pub method: &'static str,
    /// Whether this is the renderer's default.
    pub default: bool,
    /// Points by place, ascending.
    pub points: Vec<Point>,
}

/// Runs one method at one place, which need not be one of the test case's places.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The place, in the unit of [`TestCase::axis`].
    pub x: f64,
    /// Inputs, failed or not.
    pub tested: usize,
    /// Inputs that failed.
    pub failures: usize,
    /// Median error, in the unit of [`TestCase::error`].
    pub p50: Option<f64>,
    /// 90th percentile of the error.
    pub p90: Option<f64>,
    /// 99th percentile of the error, which bounds limit.
    pub p99: Option<f64>,
    /// Largest error.
    pub max: Option<f64>,
    /// Bound of the default method; `None` for others.
    pub bound: Option<Bound>,
}

impl Outcome {
    /// Returns the curve of the method of this name.
    pub fn curve(&self, method: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.method == method)
    }
    /// Returns the places where the default method breaks its bound.
    pub fn faults(&self) -> impl Iterator<Item = &Point> {
        self.curves.iter().flat_map(|curve| &curve.points).filter(|point| !point.holds())
    }
}

impl Point {
    fn of(x: f64, counts: FailureCounts, bound: Option<Bound>) -> Self {
        let FailureCounts { tested, failures, errors } = counts;
        let quantiles = (!errors.is_empty()).then(|| Quantiles::of(errors));
        let at = |share| quantiles.as_ref().map(|quantiles| quantiles.at(share));
        Self { x, tested, failures, p50: at(0.5), p90: at(0.9), p99: at(0.99), max: at(1.0), bound }
    }
    /// Tests whether this is a place of the default method without a promise.
    pub fn promises_nothing(&self) -> bool {
        self.bound.is_some_and(|bound| bound.failures >= 1.0)
    }
    /// Returns the share of failures.
    pub fn rate(&self) -> f64 {
        self.failures as f64 / self.tested as f64
    }
    /// Tests whether the bound is kept, if there is one. Zero tested inputs break it.
    pub fn holds(&self) -> bool {
        self.bound.is_none_or(|bound| {
            let exact_enough = bound.p99.is_none_or(|most| self.p99.is_none_or(|p99| p99 <= most));
            self.tested > 0 && bound.allows(self.failures, self.tested) && exact_enough
        })
    }
}

/// Runs several test cases, as [`TestCase::run`] does, in their order.
pub fn run(test_cases: &[&'static TestCase], effort: Effort, done: &(dyn Fn() + Sync)) -> Vec<Outcome> {
    test_cases.par_iter().map(|test_case| test_case.run(effort, done)).collect()
}

impl TestCase {
    /// The defaults of test cases: the number of inputs, no error, and a default method that never fails.
    pub const COMMON: Self = Self {
        name: "",
        title: "",
        axis: "",
        places: &[],
        failure: "",
        error: None,
        source: "",
        inputs: 100_000,
        methods: Vec::new(),
        bound: |_| Bound::NO_FAILURE,
    };

    /// Returns the number of points of all methods.
    pub fn points(&self) -> usize {
        self.methods.len() * self.places.len()
    }

    /// Runs every method at every place, in parallel on the threads of the caller's pool. Calls `done` after
    /// each of [`TestCase::points`].
    pub fn run(&'static self, effort: Effort, done: &(dyn Fn() + Sync)) -> Outcome {
        let point = |method: &Method<Trial>, x| {
            let point = self.at(method, x, effort);
            done();
            point
        };
        let curve = |method: &Method<Trial>| Curve {
            method: method.name,
            default: method.default,
            points: self.places.par_iter().map(|&x| point(method, x)).collect(),
        };
        let curves: Vec<Curve> = self.methods.par_iter().map(curve).collect();
        Outcome {
            test_case: self,
            holds: curves.iter().flat_map(|curve| &curve.points).all(Point::holds),
            curves,
        }
    }

    /// One method at one place, which need not be one of the test case's places.
    pub fn at(&self, method: &Method<Trial>, x: f64, effort: Effort) -> Point {
        let inputs = effort.inputs(self.inputs);
        // Large enough that the overhead of a part is small, small enough for all threads.
        let part = inputs.div_ceil(16).clamp(1, 4096);
        let parts = (0..inputs.div_ceil(part)).into_par_iter().map(|number| {
            let mut rng = Rng::of(self.name, [x.to_bits(), number as u64]);
            let mut counts = FailureCounts::default();
            while counts.tested < part.min(inputs - number * part) {
                (method.run)(&mut rng, x, &mut counts);
            }
            counts
        });
        // Merged in order, so that errors do not depend on threads.
        let counts =
            parts.collect::<Vec<_>>().into_iter().fold(FailureCounts::default(), FailureCounts::merge);
        Point::of(x, counts, method.default.then(|| (self.bound)(x)))
    }

    /// Returns the method of this name.
    pub fn method(&self, name: &str) -> Option<&Method<Trial>> {
        self.methods.iter().find(|method| method.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_that_are_nan_or_infinite_are_failures() {
        let mut counts = FailureCounts::default();
        [1e-6, f64::NAN, -f64::NAN, f64::INFINITY].into_iter().for_each(|error| counts.record_error(error));
        assert_eq!(counts, FailureCounts { tested: 4, failures: 3, errors: vec![1e-6] });
    }

    #[test]
    fn bounds_allow_chance_but_no_failure_where_none_is_promised() {
        let point = |failures, p99, bound| Point {
            failures,
            p99: Some(p99),
            ..Point::of(1.0, FailureCounts { tested: 10_000, ..FailureCounts::default() }, Some(bound))
        };
        assert!(point(0, 1.0, Bound::NO_FAILURE).holds() && !point(1, 1.0, Bound::NO_FAILURE).holds());
        assert!(point(0, 0.5, Bound::error(0.5)).holds() && !point(0, 0.6, Bound::error(0.5)).holds());
        let hundred = Bound { failures: 0.01, p99: None };
        assert!(point(153, 0.0, hundred).holds() && !point(154, 0.0, hundred).holds());
        assert!(point(10_000, 1.0, Bound::NONE).holds());
        assert!(!Point::of(1.0, FailureCounts::default(), Some(Bound::NONE)).holds(), "nothing was tested");
    }
}
