//! Where methods fail: test cases of difficult inputs, every method on each, checked in double precision.
//!
//! A test case generates rays (or other inputs) with fixed seeds along one axis: a distance, a scale, a
//! shape. At each place of the axis each method gets the same inputs; an f64 computation, which shares
//! nothing with the methods, counts failures and measures errors. The result does not depend on threads.
//! `octray stability` and `tests/pictures/stability.rs` run the same test cases.
//!
//! | file | difficult inputs |
//! |---|---|
//! | [`spheres`] | far, huge, tiny and tangent spheres, origins inside |
//! | [`meshes`] | edges and vertices of closed meshes |
//! | [`triangles`] | slivers, sizes, distances, grazing rays |
//! | [`boxes`] | corners, planes of faces, boxes far from the origin |
//! | [`spawn`] | self-intersection of rays spawned on triangles |
//! | [`rooms`] | rays spawned on walls next to the corners of closed rooms |
//! | [`shells`] | self-intersection on spheres; surfaces close to the one that is left |
//! | `textures` | poles and seam of a sphere, large texture coordinates |
//! | `scattering` | directions that cancel, shading normals |
//! | `lights` | light sampling: small, near, surrounding and edge-on emitters |
//! | `numbers` | the largest random numbers, long and large sums, NaN |
//! | `mirrors` | thousands of reflections |
//! | `cameras` | fields of view near 0° and 180°, cameras inside objects |
//! | `scenes` | very different sizes in one scene, coplanar surfaces |
//!
//! To add one: add it to the `test_cases` of its file. To add a file: add its `test_cases` to `TEST_CASES`.

pub mod boxes;
mod cameras;
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
        triangles::test_cases(),
        boxes::test_cases(),
        spawn::test_cases(),
        rooms::test_cases(),
        shells::test_cases(),
        textures::test_cases(),
        scattering::test_cases(),
        lights::test_cases(),
        numbers::test_cases(),
        mirrors::test_cases(),
        cameras::test_cases(),
        scenes::test_cases(),
    ];
    files.into_iter().flatten().collect()
});

/// All test cases, in the order of reports.
pub fn test_cases() -> impl Iterator<Item = &'static TestCase> {
    TEST_CASES.iter()
}

/// The test case of this name.
pub fn test_case(name: &str) -> Option<&'static TestCase> {
    test_cases().find(|test_case| test_case.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_test_cases_are_unique_and_valid_in_file_names() {
        let names: Vec<&str> = test_cases().map(|test_case| test_case.name).collect();
        for (at, name) in names.iter().enumerate() {
            assert!(
                name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-')
            );
            assert!(!names[..at].contains(name), "{name} occurs twice");
        }
    }

    #[test]
    fn test_cases_have_ascending_places_one_default_and_a_method_to_compare() {
        for TestCase { name, places, methods, .. } in test_cases() {
            assert!(places.is_sorted_by(|a, b| a < b) && places[0] >= 0.0, "{name}: {places:?}");
            assert_eq!(methods.iter().filter(|method| method.default).count(), 1, "{name}");
            assert!(methods.len() > 1, "{name}");
        }
    }
}
