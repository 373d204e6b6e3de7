//! The methods that the user chose, and from them the methods of a scene's rendering.
//!
//! For: [`MethodOptions`].

use super::groups::MethodArgs;
use crate::buffers::LightChoice;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::traverse::{BoxChoice, Methods, SphereChoice, TraversalChoice, TriangleChoice};

/// The methods given; which ones `--fast` means depends on the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MethodOptions {
    /// `--fast` is `Some(true)`, `--robust` is `Some(false)`.
    pub fast: Option<bool>,
    /// A method given by name overrides `--fast`.
    pub sphere: Option<SphereChoice>,
    pub triangle: Option<TriangleChoice>,
    pub boxes: Option<BoxChoice>,
    pub traversal: Option<TraversalChoice>,
    pub lights: Option<LightChoice>,
    pub sampler: Option<Sampler>,
}

impl MethodOptions {
    /// The methods of this scene's rendering.
    pub fn of(&self, scene: &Scene) -> Methods {
        let base = if self.fast == Some(true) { Methods::fast(scene) } else { Methods::default() };
        Methods {
            sphere: self.sphere.unwrap_or(base.sphere),
            triangle: self.triangle.unwrap_or(base.triangle),
            boxes: self.boxes.unwrap_or(base.boxes),
            traversal: self.traversal.unwrap_or(base.traversal),
            lights: self.lights.unwrap_or(base.lights),
            sampler: self.sampler.unwrap_or(base.sampler),
        }
    }

    /// These, and from `weaker` those that are missing here. `--fast` and `--robust` override all of
    /// `weaker`'s intersection methods.
    pub fn or(self, weaker: Self) -> Self {
        let intersection = if self.fast.is_some() { Self::default() } else { weaker };
        Self {
            fast: self.fast.or(weaker.fast),
            sphere: self.sphere.or(intersection.sphere),
            triangle: self.triangle.or(intersection.triangle),
            boxes: self.boxes.or(intersection.boxes),
            traversal: self.traversal.or(weaker.traversal),
            lights: self.lights.or(weaker.lights),
            sampler: self.sampler.or(weaker.sampler),
        }
    }
}

impl From<MethodArgs> for MethodOptions {
    fn from(args: MethodArgs) -> Self {
        let MethodArgs { robust, fast, sphere, triangle, boxes, traversal, lights, sampler } = args;
        Self { fast: (fast || robust).then_some(fast), sphere, triangle, boxes, traversal, lights, sampler }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        methods: MethodArgs,
    }

    fn methods(scene: &str, options: &[&str]) -> Methods {
        let line = Line::parse_from(["octray"].iter().chain(options));
        MethodOptions::from(line.methods).of(&crate::scene::load(scene).unwrap())
    }

    #[test]
    fn fast_is_for_scenes_that_gain_by_it_and_robust_is_the_default() {
        let few = "builtin:cornell";
        assert_eq!(methods(few, &[]), Methods::default());
        assert_eq!(methods(few, &["--robust"]), Methods::default());
        assert_eq!(methods(few, &["--fast"]).triangle, TriangleChoice::BaldwinWeber);
        assert_eq!(
            methods("builtin:knot:2000", &["--fast"]),
            Methods::default(),
            "other methods have no hierarchy"
        );
        let said =
            methods(few, &["--fast", "--triangle", "moller-trumbore", "--sphere", "naive", "--box", "fma"]);
        let expected = (SphereChoice::Naive, TriangleChoice::MollerTrumbore, BoxChoice::Fma);
        assert_eq!((said.sphere, said.triangle, said.boxes), expected, "a name overrides --fast");
        assert!(Line::try_parse_from(["octray", "--fast", "--robust"]).is_err());
    }
}
