//! From what the user chose to the methods of a scene's picture.
//!
//! For: [`MethodOptions`]. May import: `choices`, `traverse`'s choices. Must never know: how a command does its work.

use super::choices::{
    BoxMethod, LightArg, MethodArgs, SamplerArg, SphereMethod, TraversalArg, TriangleMethod,
};
use crate::buffers::LightChoice;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::traverse::batch::Traversal;
use crate::traverse::{BoxChoice, Methods, SphereChoice, TraversalChoice, TriangleChoice};

/// The methods asked for; which ones `--fast` means depends on the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MethodOptions {
    /// `--fast`, or `--robust`; `None` is the latter, not said.
    fast: Option<bool>,
    /// Said by name, and so stronger than `--fast`.
    sphere: Option<SphereChoice>,
    triangle: Option<TriangleChoice>,
    boxes: Option<BoxChoice>,
    traversal: Option<TraversalChoice>,
    lights: Option<LightChoice>,
    sampler: Option<Sampler>,
}

impl MethodOptions {
    /// The methods of this scene's picture.
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

    /// These, and what `weaker` asks for besides. Who asks for all equations at once wants none of the other's.
    pub fn or(self, weaker: Self) -> Self {
        let equations = if self.fast.is_some() { Self::default() } else { weaker };
        Self {
            fast: self.fast.or(weaker.fast),
            sphere: self.sphere.or(equations.sphere),
            triangle: self.triangle.or(equations.triangle),
            boxes: self.boxes.or(equations.boxes),
            traversal: self.traversal.or(weaker.traversal),
            lights: self.lights.or(weaker.lights),
            sampler: self.sampler.or(weaker.sampler),
        }
    }
}

impl From<MethodArgs> for MethodOptions {
    fn from(args: MethodArgs) -> Self {
        Self {
            fast: (args.fast || args.robust).then_some(args.fast),
            sphere: args.sphere.map(Into::into),
            triangle: args.triangle.map(Into::into),
            boxes: args.boxes.map(Into::into),
            traversal: args.traversal.map(Into::into),
            lights: args.lights.map(Into::into),
            sampler: args.sampler.map(Into::into),
        }
    }
}

impl From<SphereMethod> for SphereChoice {
    fn from(method: SphereMethod) -> Self {
        match method {
            SphereMethod::Robust => Self::Robust,
            SphereMethod::Naive => Self::Naive,
        }
    }
}

impl From<TriangleMethod> for TriangleChoice {
    fn from(method: TriangleMethod) -> Self {
        match method {
            TriangleMethod::Woop => Self::Woop,
            TriangleMethod::MollerTrumbore => Self::MollerTrumbore,
            TriangleMethod::BaldwinWeber => Self::BaldwinWeber,
        }
    }
}

impl From<BoxMethod> for BoxChoice {
    fn from(method: BoxMethod) -> Self {
        match method {
            BoxMethod::PaddedFma => Self::PaddedFma,
            BoxMethod::Fma => Self::Fma,
        }
    }
}

impl From<SamplerArg> for Sampler {
    fn from(sampler: SamplerArg) -> Self {
        match sampler {
            SamplerArg::Sobol => Self::Sobol,
            SamplerArg::Random => Self::Random,
        }
    }
}

impl From<LightArg> for LightChoice {
    fn from(lights: LightArg) -> Self {
        match lights {
            LightArg::Auto => Self::Auto,
            LightArg::On => Self::On,
            LightArg::Off => Self::Off,
        }
    }
}

impl From<TraversalArg> for TraversalChoice {
    fn from(traversal: TraversalArg) -> Self {
        match traversal {
            TraversalArg::Needed => Self::Needed,
            TraversalArg::Linear => Self::Linear,
            TraversalArg::Scalar => Self::Through(Traversal::Scalar),
            TraversalArg::Single => Self::Through(Traversal::Single),
            TraversalArg::Packet => Self::Through(Traversal::Packet),
            TraversalArg::Stream => Self::Through(Traversal::Stream),
            TraversalArg::Hybrid => Self::Through(Traversal::Hybrid),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Args, Command};
    use clap::Parser;

    fn methods(scene: &str, options: &[&str]) -> Methods {
        let words = ["octray", "bench"].iter().chain(options);
        let Some(Command::Bench(args)) = Args::parse_from(words).command else {
            unreachable!("bench was asked for")
        };
        MethodOptions::from(args.methods).of(&crate::scene::load(scene).unwrap())
    }

    #[test]
    fn fast_is_for_scenes_that_gain_by_it_and_robust_is_the_default() {
        let few = "builtin:cornell";
        assert_eq!(methods(few, &[]), Methods::default());
        assert_eq!(methods(few, &["--robust"]), Methods::default());
        assert_eq!(methods(few, &["--fast"]).triangle, TriangleChoice::BaldwinWeber);
        assert_eq!(methods("builtin:knot:2000", &["--fast"]), Methods::default(), "others know no hierarchy");
        let said =
            methods(few, &["--fast", "--triangle", "moller-trumbore", "--sphere", "naive", "--box", "fma"]);
        let expected = (SphereChoice::Naive, TriangleChoice::MollerTrumbore, BoxChoice::Fma);
        assert_eq!((said.sphere, said.triangle, said.boxes), expected, "what is said by name is stronger");
        assert!(Args::try_parse_from(["octray", "bench", "--fast", "--robust"]).is_err());
    }
}
