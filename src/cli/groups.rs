//! The options of methods, which several commands share, and value parsers of choices.

use super::error::{CliError, refuse};
use super::terminal;
use crate::buffers::LightChoice;
use crate::choice::Choice;
use crate::lane::WIDTHS;
use crate::render::LaneChoice;
use crate::render::{Methods, SphereChoice, TraversalChoice, TriangleChoice};
use crate::sampling::Sampler;
use crate::scene::Scene;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::fs;
use std::path::Path;

/// Reads the earlier report that `--baseline` names.
pub fn baseline<T>(file: &Path, read: impl Fn(&str) -> Result<T, String>) -> Result<T, CliError> {
    let text = fs::read_to_string(file).map_err(|error| format!("it cannot be read ({error})"));
    text.and_then(|text| read(&text)).map_err(|why| refuse("--baseline", file.display(), why))
}

/// The help of an argument that is a scene.
pub const SCENE: &str = "A scene (.json), a model (.obj, .gltf, .glb, .ply), or builtin:NAME";

/// The heading of options that choose a method.
pub const METHODS: &str = "Methods, explained by `octray methods`";

/// Reads the name of a choice; errors list all names.
pub fn choice<C: Choice>() -> impl TypedValueParser<Value = C> {
    PossibleValuesParser::new(C::NAMES)
        .map(|name| C::from_name(&name).expect("the parser accepts the names of choices alone"))
}

/// The long help of a choice: what is chosen, all names, and the default.
pub fn one_of<C: Choice + Default>(what: &str) -> String {
    format!("{what}: {} [default: {}]", C::NAMES.join(", "), C::default().name())
}

/// Reads a width that this build has.
pub fn lanes() -> impl TypedValueParser<Value = LaneChoice> {
    let instead = "this octray was built for processors without AVX-512: give auto, 1 or 8";
    let is_built = |choice: LaneChoice| WIDTHS.contains(&choice.lanes());
    choice::<LaneChoice>().try_map(move |choice| is_built(choice).then_some(choice).ok_or(instead))
}

/// The methods of a rendering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct MethodArgs {
    /// Ray-sphere intersection.
    #[arg(long, value_name = "METHOD", value_parser = choice::<SphereChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<SphereChoice>("Ray-sphere intersection"))]
    pub sphere: Option<SphereChoice>,
    /// Ray-triangle intersection.
    #[arg(long, value_name = "METHOD", value_parser = choice::<TriangleChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<TriangleChoice>("Ray-triangle intersection"))]
    pub triangle: Option<TriangleChoice>,
    /// How rays find primitives, with the same picture.
    #[arg(long, value_name = "METHOD", value_parser = choice::<TraversalChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<TraversalChoice>("How rays find primitives"))]
    pub traversal: Option<TraversalChoice>,
    /// Next event estimation: other noise, the same mean.
    #[arg(long, value_name = "METHOD", value_parser = choice::<LightChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<LightChoice>("Lights of next event estimation"))]
    pub lights: Option<LightChoice>,
    /// Source of random numbers: other noise, the same mean.
    #[arg(long, value_name = "METHOD", value_parser = choice::<Sampler>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<Sampler>("Source of random numbers"))]
    pub sampler: Option<Sampler>,
}

impl MethodArgs {
    /// These, and from `weaker` those that are missing here.
    pub fn or(self, weaker: Self) -> Self {
        Self {
            sphere: self.sphere.or(weaker.sphere),
            triangle: self.triangle.or(weaker.triangle),
            traversal: self.traversal.or(weaker.traversal),
            lights: self.lights.or(weaker.lights),
            sampler: self.sampler.or(weaker.sampler),
        }
    }
    /// The methods, the defaults where none is given.
    pub fn methods(self) -> Methods {
        let Self { sphere, triangle, traversal, lights, sampler } = self;
        Methods {
            sphere: sphere.unwrap_or_default(),
            triangle: triangle.unwrap_or_default(),
            traversal: traversal.unwrap_or_default(),
            lights: lights.unwrap_or_default(),
            sampler: sampler.unwrap_or_default(),
        }
    }
    /// Refuses a traversal that stands here where one of `methods`, these or a view's, has no hierarchy.
    pub fn check(self, methods: &Methods) -> Result<(), CliError> {
        match (self.traversal, methods.without_hierarchy()) {
            (Some(choice @ TraversalChoice::Through(_)), Some((option, method))) => {
                let instead = format!(
                    "{option} {method} has no hierarchy to traverse and tests every primitive: leave out one of \
                     the two, or give --traversal linear"
                );
                Err(refuse("--traversal", choice.name(), instead))
            }
            _ => Ok(()),
        }
    }
}

/// One line where a method costs this scene its hierarchy.
pub fn warn_of_lost_hierarchy(methods: &Methods, scene: &Scene) {
    let Some((option, method)) = methods.without_hierarchy() else { return };
    let with = Methods { sphere: SphereChoice::default(), triangle: TriangleChoice::default(), ..*methods };
    if with.traversal_of(scene, 1).is_some() {
        let name = &scene.name;
        terminal::warn(&format!(
            "{option} {method} has no hierarchy: every primitive of {name} is tested for each ray."
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::PipelineChoice;
    use crate::tone::Operator;
    use serde_json::json;
    use std::fmt::Debug;

    fn check<C: Choice + Debug + Default + serde::Serialize + for<'de> serde::Deserialize<'de>>() {
        assert_eq!(C::all().iter().map(|choice| choice.name()).collect::<Vec<_>>(), C::NAMES);
        assert!(C::all().contains(&C::default()));
        for (index, (&name, &choice)) in C::NAMES.iter().zip(C::all()).enumerate() {
            assert!(!C::NAMES[..index].contains(&name), "{name} stands twice");
            assert!(choice.about().ends_with('.'), "{name}: the help text is a sentence");
            assert_eq!(
                (json!(choice), serde_json::from_value(json!(name)).ok()),
                (json!(name), Some(choice))
            );
            let error = serde_json::from_value::<C>(json!(name.to_uppercase())).unwrap_err().to_string();
            assert!(C::NAMES.iter().all(|known| error.contains(known)), "{error}");
        }
    }

    #[test]
    fn every_choice_is_read_from_its_name_and_from_no_other() {
        check::<SphereChoice>();
        check::<TriangleChoice>();
        check::<TraversalChoice>();
        check::<LightChoice>();
        check::<Sampler>();
        check::<PipelineChoice>();
        check::<Operator>();
    }
}
