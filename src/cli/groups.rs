//! Groups of arguments that several commands share, and how a choice is read.
//!
//! For: [`MethodArgs`], [`PictureArgs`], [`LimitArgs`], [`choice`]. Numbers stay text here and `numbers`
//! reads them, so that every refusal has the same form.

use crate::buffers::LightChoice;
use crate::choice::Choice;
use crate::render::{LaneChoice, PipelineChoice};
use crate::sampling::Sampler;
use crate::tone::Operator;
use crate::traverse::{BoxChoice, SphereChoice, TraversalChoice, TriangleChoice};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Reads the name of a choice; help and errors list all names.
pub fn choice<C: Choice>() -> impl TypedValueParser<Value = C> {
    let value = |choice: &C| PossibleValue::new(choice.name()).help(choice.about());
    PossibleValuesParser::new(C::all().iter().map(value))
        .map(|name| C::from_name(&name).expect("the parser accepts the names of choices alone"))
}

/// The methods of a rendering.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::Args)]
pub struct MethodArgs {
    /// Use the robust intersection methods: woop, robust spheres, padded-fma boxes. They are the default;
    /// with a view, this overrides the methods that the view names.
    #[arg(long, conflicts_with = "fast")]
    pub robust: bool,
    /// Use the fastest intersection methods on the front that `octray chart` measures: baldwin-weber, which
    /// leaks at edges, in scenes that test every triangle; the defaults, which are the fastest, in others.
    #[arg(long)]
    pub fast: bool,
    /// Ray-sphere intersection method [default: robust].
    #[arg(long, value_name = "METHOD", value_parser = choice::<SphereChoice>())]
    pub sphere: Option<SphereChoice>,
    /// Ray-triangle intersection method [default: woop].
    #[arg(long, value_name = "METHOD", value_parser = choice::<TriangleChoice>())]
    pub triangle: Option<TriangleChoice>,
    /// Ray-box intersection method, for the boxes of a hierarchy and of single triangles [default:
    /// padded-fma].
    #[arg(long = "box", value_name = "METHOD", value_parser = choice::<BoxChoice>())]
    pub boxes: Option<BoxChoice>,
    /// How rays find the primitives that they hit; it does not change the picture [default: needed].
    #[arg(long, value_name = "TRAVERSAL", value_parser = choice::<TraversalChoice>())]
    pub traversal: Option<TraversalChoice>,
    /// Which emitters next event estimation samples. It changes the noise, not the expected picture [default:
    /// auto].
    #[arg(long, value_name = "CHOICE", value_parser = choice::<LightChoice>())]
    pub lights: Option<LightChoice>,
    /// Source of random numbers. It changes the noise, not the expected picture [default: sobol].
    #[arg(long, value_name = "SAMPLER", value_parser = choice::<Sampler>())]
    pub sampler: Option<Sampler>,
}

/// How a picture is made: shared by `render` and `view`.
#[derive(Debug, clap::Args)]
pub struct PictureArgs {
    /// Pixels of the picture [default: the scene's].
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<String>,
    /// Most scattering events on a path; 0 shows only emission [default: the scene's].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub bounces: Option<String>,
    /// Seed of the random numbers: the same seed gives the same picture, bit by bit [default: 0].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub seed: Option<String>,
    /// Worker threads; they do not change the picture [default: all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Rays traced at a time; they do not change the picture [default: auto].
    #[arg(long, value_name = "LANES", value_parser = choice::<LaneChoice>())]
    pub lanes: Option<LaneChoice>,
    /// Largest radiance of a sample in each channel. It removes fireflies and their light: the picture is
    /// biased, darker by the light that is cut off [default: no limit].
    #[arg(long, value_name = "MOST", allow_hyphen_values = true)]
    pub clamp: Option<String>,
    /// Brighten (above 0) or darken (below 0) the displayed picture, .png and .jpg included, by so many stops
    /// of a factor of two [default: 0].
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// Tone mapping of the displayed picture, .png and .jpg included [default: clamp].
    #[arg(long, value_name = "OPERATOR", value_parser = choice::<Operator>())]
    pub tone: Option<Operator>,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Features that the pipeline is compiled for; it does not change the picture [default: needed].
    #[arg(long, value_name = "PIPELINE", value_parser = choice::<PipelineChoice>())]
    pub pipeline: Option<PipelineChoice>,
}

/// When a rendering ends.
#[derive(Debug, clap::Args)]
pub struct LimitArgs {
    /// Samples per pixel: four times as many halve the noise [default: 64; with --target-error at most 16384;
    /// with --time-limit as many as fit].
    #[arg(long, visible_alias = "spp", value_name = "N", allow_hyphen_values = true)]
    pub samples: Option<String>,
    /// Stop at a relative standard error of E over the picture, such as 0.05 for five per cent, and of 2 E in
    /// every block of 16×16 pixels. Blocks that reach it early get no more samples.
    #[arg(long, value_name = "E", allow_hyphen_values = true)]
    pub target_error: Option<String>,
    /// With --target-error: samples per pixel before the first estimate of the error [default: 16].
    #[arg(long, value_name = "N", allow_hyphen_values = true, requires = "target_error")]
    pub min_samples: Option<String>,
    /// Stop after so many seconds of tracing, between samples of the whole picture where one fits; loading
    /// and writing are not counted.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub time_limit: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traverse::batch::Traversal;
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
        check::<BoxChoice>();
        check::<Traversal>();
        check::<TraversalChoice>();
        check::<LightChoice>();
        check::<Sampler>();
        check::<PipelineChoice>();
        check::<Operator>();
    }
}
