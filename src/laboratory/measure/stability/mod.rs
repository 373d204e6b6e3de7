//! Where methods fail: recipes that make them fail on purpose, every method through each, judged in double precision.
//!
//! For: [`Recipe`] and [`recipes`]; [`methods`] lists the methods by family. May import: everything above `measure`. Must never know: how
//! figures are shown.
//!
//! A recipe throws rays (or whatever it is about) with fixed seeds along one axis: a distance, a scale, a shape. At each place of the axis
//! each method answers the same cases, and a judge in f64, which shares nothing with the methods, counts failures and measures errors.
//! Nothing depends on threads. The command `octray stability` and `tests/stability.rs` run the same recipes.
//!
//! | file | what fails there |
//! |---|---|
//! | [`spheres`] | spheres that are far, huge, tiny, touched, left from inside |
//! | [`meshes`] | edges and vertices of closed meshes |
//! | [`triangles`] | slivers, sizes, distances, grazing rays |
//! | [`boxes`] | corners, planes of faces, boxes far from the origin |
//! | [`leaving`] | triangles that are hit again by what leaves them |
//! | [`shells`] | the same of spheres; what is close to a surface and lost |
//! | [`textures`] | poles and seam of a sphere, coordinates far from the first repeat |
//! | [`scattering`] | directions that cancel, normals for shading |
//! | [`lamps`] | lamps that are small, near, around, seen edge-on |
//! | [`numbers`] | the largest random numbers, long and large sums, what is no number |
//! | [`mirrors`] | thousands of reflections |
//! | [`cameras`] | fields of view near 0° and 180°, cameras inside of things |
//! | [`scenes`] | all sizes in one scene, surfaces that coincide |
//!
//! To add a recipe: put it into the `RECIPES` of its file. To add a file: name its `RECIPES` in [`recipes`].

pub mod aim;
pub mod boxes;
pub mod cameras;
pub mod dice;
pub mod lamps;
pub mod leaving;
pub mod meshes;
pub mod methods;
pub mod mirrors;
pub mod numbers;
pub mod scattering;
pub mod scenes;
pub mod shells;
pub mod spheres;
pub mod textures;
pub mod triangles;

pub use dice::Dice;
pub use methods::Method;

use super::statistics::Quantiles;
use rayon::prelude::*;
use serde::Serialize;

/// All recipes, in the order in which they are told.
pub fn recipes() -> impl Iterator<Item = &'static Recipe> {
    const FILES: &[&[Recipe]] = &[
        spheres::RECIPES,
        meshes::RECIPES,
        triangles::RECIPES,
        boxes::RECIPES,
        leaving::RECIPES,
        shells::RECIPES,
        textures::RECIPES,
        scattering::RECIPES,
        lamps::RECIPES,
        numbers::RECIPES,
        mirrors::RECIPES,
        cameras::RECIPES,
        scenes::RECIPES,
    ];
    FILES.iter().copied().flatten()
}

/// The recipe of this name.
pub fn recipe(name: &str) -> Option<&'static Recipe> {
    recipes().find(|recipe| recipe.name == name)
}

/// Half the distance from 1 to the next float, 2⁻²⁴, for bounds.
pub const EPSILON: f64 = crate::math::EPSILON as f64;

/// Throws so many cases at this place of the axis.
pub type Trial = fn(&mut Dice, f64, usize) -> Tally;

/// A way to make methods fail.
#[derive(Debug)]
pub struct Recipe {
    /// Short, for the command line and for files: `spheres-far`.
    pub name: &'static str,
    pub title: &'static str,
    pub axis: &'static str,
    /// Places on the axis, ascending. It is logarithmic; 0 may come first.
    pub places: &'static [f64],
    /// What counts as a failure.
    pub failure: &'static str,
    /// What the error is, and in which unit, where one is measured.
    pub error: Option<&'static str>,
    /// Who described it.
    pub source: &'static str,
    /// Cases at each place, with an effort of 1.
    pub cases: usize,
    pub methods: &'static [Method<Trial>],
    /// What the default method is held to, by place.
    pub bound: fn(f64) -> Bound,
}

/// What a method is held to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// The expected share of failures, at most. Where it is not 0, five standard deviations of their number and three are added.
    pub failures: f64,
    /// The 99th percentile of the error, at most; none where none is promised.
    pub p99: Option<f64>,
}

impl Bound {
    /// Nothing is promised here.
    pub const NONE: Self = Self { failures: 1.0, p99: None };
    /// No failure at all.
    pub const NO_FAILURE: Self = Self { failures: 0.0, p99: None };

    /// No failure, and an error up to this.
    pub const fn error(p99: f64) -> Self {
        Self { failures: 0.0, p99: Some(p99) }
    }
    /// May so many of so many fail?
    pub fn allows(&self, failures: usize, tested: usize) -> bool {
        let expected = self.failures * tested as f64;
        let spread = if expected > 0.0 { 5.0 * expected.sqrt() + 3.0 } else { 0.0 };
        failures as f64 <= expected + spread
    }
}

/// How many cases a recipe throws: a share of what the command throws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort(pub f64);

impl Effort {
    /// The command's.
    pub const FULL: Self = Self(1.0);

    fn cases(self, full: usize) -> usize {
        ((full as f64 * self.0).ceil() as usize).max(1)
    }
}

/// What happened to a method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    pub tested: usize,
    pub failures: usize,
    /// Of the cases that did not fail and have one.
    pub errors: Vec<f64>,
}

impl Tally {
    /// A case in which it failed, or did not.
    pub fn count(&mut self, failed: bool) {
        self.tested += 1;
        self.failures += usize::from(failed);
    }
    /// A case in which it did not fail, and was off by this. An answer that is off by no number, or infinitely, is a failure: quantiles
    /// would put it where nobody looks.
    pub fn off_by(&mut self, error: f64) {
        if error.is_finite() {
            self.tested += 1;
            self.errors.push(error);
        } else {
            self.count(true);
        }
    }
    fn join(mut self, other: Self) -> Self {
        self.tested += other.tested;
        self.failures += other.failures;
        self.errors.extend(other.errors);
        self
    }
}

/// What a recipe found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    pub recipe: &'static str,
    pub title: &'static str,
    pub axis: &'static str,
    pub failure: &'static str,
    pub error: Option<&'static str>,
    pub source: &'static str,
    /// Does the default method keep its bounds?
    pub holds: bool,
    pub curves: Vec<Curve>,
}

/// One method along the axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    pub method: &'static str,
    /// Pictures are made with this one, unless another is asked for.
    pub default: bool,
    pub points: Vec<Point>,
}

/// One method at one place of the axis. Quantiles are those of the error where the method did not fail; none where nothing is measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    pub x: f64,
    pub tested: usize,
    pub failures: usize,
    pub p50: Option<f64>,
    pub p90: Option<f64>,
    pub p99: Option<f64>,
    pub max: Option<f64>,
    /// Of the default method.
    pub bound: Option<Bound>,
}

impl Outcome {
    pub fn curve(&self, method: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.method == method)
    }
    /// Where the default method does not keep its bounds.
    pub fn faults(&self) -> impl Iterator<Item = &Point> {
        self.curves.iter().flat_map(|curve| &curve.points).filter(|point| !point.holds())
    }
}

impl Point {
    fn of(x: f64, tally: Tally, bound: Option<Bound>) -> Self {
        let Tally { tested, failures, errors } = tally;
        let quantiles = (!errors.is_empty()).then(|| Quantiles::of(errors));
        let at = |share| quantiles.as_ref().map(|quantiles| quantiles.at(share));
        Self { x, tested, failures, p50: at(0.5), p90: at(0.9), p99: at(0.99), max: at(1.0), bound }
    }
    /// Is this a place of the default method where it promises nothing?
    pub fn promises_nothing(&self) -> bool {
        self.bound.is_some_and(|bound| bound.failures >= 1.0)
    }
    /// Failures as a share of what was tested.
    pub fn rate(&self) -> f64 {
        self.failures as f64 / self.tested as f64
    }
    /// Is the bound kept, if there is one? A trial that tested nothing proves nothing.
    pub fn holds(&self) -> bool {
        self.bound.is_none_or(|bound| {
            let exact_enough = bound.p99.is_none_or(|most| self.p99.is_none_or(|p99| p99 <= most));
            self.tested > 0 && bound.allows(self.failures, self.tested) && exact_enough
        })
    }
}

impl Recipe {
    /// Every method at every place. Cases are thrown in parallel, on the threads of the caller's pool.
    pub fn run(&self, effort: Effort) -> Outcome {
        let curve = |method: &Method<Trial>| Curve {
            method: method.name,
            default: method.default,
            points: self.places.iter().map(|&x| self.at(method, x, effort)).collect(),
        };
        let curves: Vec<Curve> = self.methods.iter().map(curve).collect();
        Outcome {
            recipe: self.name,
            title: self.title,
            axis: self.axis,
            failure: self.failure,
            error: self.error,
            source: self.source,
            holds: curves.iter().flat_map(|curve| &curve.points).all(Point::holds),
            curves,
        }
    }

    /// One method at one place, which need not be one of [`Recipe::places`].
    pub fn at(&self, method: &Method<Trial>, x: f64, effort: Effort) -> Point {
        let cases = effort.cases(self.cases);
        // Large enough that making meshes and sorting out what is left do not count, small enough for all threads.
        let part = cases.div_ceil(16).clamp(1, 4096);
        let parts = (0..cases.div_ceil(part)).into_par_iter().map(|number| {
            let mut dice = Dice::of(self.name, [x.to_bits(), number as u64]);
            (method.run)(&mut dice, x, part.min(cases - number * part))
        });
        // Collected in order: their number is small.
        let tally = parts.collect::<Vec<_>>().into_iter().fold(Tally::default(), Tally::join);
        Point::of(x, tally, method.default.then(|| (self.bound)(x)))
    }

    /// The method of this name.
    pub fn method(&self, name: &str) -> Option<&'static Method<Trial>> {
        self.methods.iter().find(|method| method.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_recipes_are_unlike_and_fit_for_files() {
        let names: Vec<&str> = recipes().map(|recipe| recipe.name).collect();
        for (at, name) in names.iter().enumerate() {
            assert!(
                name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-')
            );
            assert!(!names[..at].contains(name), "{name} stands twice");
        }
    }

    #[test]
    fn recipes_have_ascending_places_one_default_and_a_method_to_compare() {
        for Recipe { name, places, methods, .. } in recipes() {
            assert!(places.is_sorted_by(|a, b| a < b) && places[0] >= 0.0, "{name}: {places:?}");
            assert_eq!(methods.iter().filter(|method| method.default).count(), 1, "{name}");
            assert!(methods.len() > 1, "{name}");
        }
    }

    #[test]
    fn points_are_the_same_on_any_number_of_threads() {
        let recipe = recipes().next().unwrap();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| recipe.at(&recipe.methods[0], recipe.places[1], Effort(0.05)))
        };
        assert_eq!(on(1), on(3));
        assert!(on(1).tested > 1000);
    }

    #[test]
    fn answers_that_are_no_number_are_failures() {
        let mut tally = Tally::default();
        [1e-6, f64::NAN, -f64::NAN, f64::INFINITY].into_iter().for_each(|error| tally.off_by(error));
        assert_eq!(tally, Tally { tested: 4, failures: 3, errors: vec![1e-6] });
    }

    #[test]
    fn bounds_allow_chance_but_no_failure_where_none_is_promised() {
        let point = |failures, p99, bound| Point {
            failures,
            p99: Some(p99),
            ..Point::of(1.0, Tally { tested: 10_000, ..Tally::default() }, Some(bound))
        };
        assert!(point(0, 1.0, Bound::NO_FAILURE).holds() && !point(1, 1.0, Bound::NO_FAILURE).holds());
        assert!(point(0, 0.5, Bound::error(0.5)).holds() && !point(0, 0.6, Bound::error(0.5)).holds());
        let hundred = Bound { failures: 0.01, p99: None };
        assert!(point(153, 0.0, hundred).holds() && !point(154, 0.0, hundred).holds());
        assert!(point(10_000, 1.0, Bound::NONE).holds());
        assert!(!Point::of(1.0, Tally::default(), Some(Bound::NONE)).holds(), "nothing was tested");
    }
}
