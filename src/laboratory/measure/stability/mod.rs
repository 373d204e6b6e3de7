//! Test cases on which methods fail: difficult inputs, every method on each, checked in double precision.
//!
//! A test case generates rays (or other inputs) with fixed seeds along one axis: a distance, a scale, a
//! shape. At each place of the axis each method gets the same inputs; an f64 computation, which shares
//! nothing with the methods, counts failures and measures errors. The result does not depend on threads.
//! `octray stability` and `tests/pictures/stability.rs` run the same test cases.
//!
//! To add one: add it to the `test_cases` of its file. To add a file: add its `test_cases` to `TEST_CASES`.

pub mod boxes;
mod cameras;
mod doubles;
mod lights;
pub mod meshes;
pub mod methods;
mod mirrors;
mod numbers;
pub mod rays;
mod rng;
pub mod rooms;
mod scattering;
mod scenes;
pub mod shells;
pub mod spawn;
pub mod spheres;
mod spots;
mod test_case;
mod textures;
pub mod triangles;

pub use methods::Method;
pub use rng::Rng;
use std::sync::LazyLock;
pub use test_case::{Bound, Curve, Effort, FailureCounts, Outcome, Point, TestCase, Trial, run};

static TEST_CASES: LazyLock<Vec<TestCase>> = LazyLock::new(|| {
    let files = [
        spheres::test_cases(),
        meshes::test_cases(),
        doubles::test_cases(),
        triangles::test_cases(),
        boxes::test_cases(),
        spawn::test_cases(),
        rooms::test_cases(),
        shells::test_cases(),
        textures::test_cases(),
        scattering::test_cases(),
        lights::test_cases(),
        spots::test_cases(),
        numbers::test_cases(),
        mirrors::test_cases(),
        cameras::test_cases(),
        scenes::test_cases(),
    ];
    files.into_iter().flatten().collect()
});

/// Returns all test cases, in the order of reports.
pub fn test_cases() -> impl Iterator<Item = &'static TestCase> {
    TEST_CASES.iter()
}

/// Returns the test case of this name.
pub fn test_case(name: &str) -> Option<&'static TestCase> {
    test_cases().find(|test_case| test_case.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_cases_have_ascending_places_one_default_and_a_method_to_compare() {
        for TestCase { name, places, methods, .. } in test_cases() {
            assert!(places.is_sorted_by(|a, b| a < b) && places[0] >= 0.0, "{name}: {places:?}");
            assert_eq!(methods.iter().filter(|method| method.default).count(), 1, "{name}");
            assert!(methods.len() > 1, "{name}");
        }
    }
}
