//! Where methods fail: recipes of difficult inputs, every method on each, checked in double precision.
//!
//! For: [`recipes`]; `recipe.rs` defines a recipe, `methods.rs` lists the methods by family.
//!
//! A recipe generates rays (or other inputs) with fixed seeds along one axis: a distance, a scale, a shape.
//! At each place of the axis each method gets the same inputs; an f64 computation, which shares nothing with
//! the methods, counts failures and measures errors. The result does not depend on threads. `octray
//! stability` and `tests/pictures/stability.rs` run the same recipes.
//!
//! | file | difficult inputs |
//! |---|---|
//! | [`spheres`] | far, huge, tiny and tangent spheres, origins inside |
//! | [`meshes`] | edges and vertices of closed meshes |
//! | [`triangles`] | slivers, sizes, distances, grazing rays |
//! | [`boxes`] | corners, planes of faces, boxes far from the origin |
//! | [`leaving`] | self-intersection of rays that leave triangles |
//! | [`rooms`] | rays that leave walls next to the corners of closed rooms |
//! | [`shells`] | self-intersection on spheres; surfaces close to the one that is left |
//! | `textures` | poles and seam of a sphere, large texture coordinates |
//! | `scattering` | directions that cancel, shading normals |
//! | `lights` | light sampling: small, near, surrounding and edge-on emitters |
//! | `numbers` | the largest random numbers, long and large sums, NaN |
//! | `mirrors` | thousands of reflections |
//! | `cameras` | fields of view near 0° and 180°, cameras inside objects |
//! | `scenes` | very different sizes in one scene, coplanar surfaces |
//!
//! To add a recipe: add it to the `recipes` of its file. To add a file: add its `recipes` to `RECIPES`.

pub mod boxes;
mod cameras;
pub mod leaving;
mod lights;
pub mod meshes;
pub mod methods;
mod mirrors;
mod numbers;
pub mod rays;
mod recipe;
mod rng;
pub mod rooms;
mod scattering;
mod scenes;
pub mod shells;
pub mod spheres;
mod textures;
pub mod triangles;

pub use methods::Method;
pub use recipe::{Bound, Curve, Effort, FailureCounts, Outcome, Point, Recipe, Trial, run};
pub use rng::Rng;
use std::sync::LazyLock;

static RECIPES: LazyLock<Vec<Recipe>> = LazyLock::new(|| {
    let files = [
        spheres::recipes(),
        meshes::recipes(),
        triangles::recipes(),
        boxes::recipes(),
        leaving::recipes(),
        rooms::recipes(),
        shells::recipes(),
        textures::recipes(),
        scattering::recipes(),
        lights::recipes(),
        numbers::recipes(),
        mirrors::recipes(),
        cameras::recipes(),
        scenes::recipes(),
    ];
    files.into_iter().flatten().collect()
});

/// All recipes, in the order of reports.
pub fn recipes() -> impl Iterator<Item = &'static Recipe> {
    RECIPES.iter()
}

/// The recipe of this name.
pub fn recipe(name: &str) -> Option<&'static Recipe> {
    recipes().find(|recipe| recipe.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_recipes_are_unique_and_valid_in_file_names() {
        let names: Vec<&str> = recipes().map(|recipe| recipe.name).collect();
        for (at, name) in names.iter().enumerate() {
            assert!(
                name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-')
            );
            assert!(!names[..at].contains(name), "{name} occurs twice");
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
}
