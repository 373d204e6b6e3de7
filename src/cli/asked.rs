//! What may be asked of a still, on the command line or in a view: both say it with the same words, and the command line wins.
//!
//! For: [`Asked`], and [`ViewReport`] for `inspect`. May import: `choices`, `limits`, `methods`, `numbers`, `scene`'s views. Must never know: how a still is made.

use super::choices::{MethodArgs, PipelineArg, ToneArg};
use super::error::CliError;
use super::limits::Limits;
use super::methods::MethodOptions;
use super::numbers::{clamp, exposure, samples, seed};
use crate::render::PipelineChoice;
use crate::scene::{Loaded, Rendering, Scene, View, view_fault};
use crate::tone::{Operator, Tone};
use clap::ValueEnum;
use serde::Serialize;
use serde_json::{Map, Value};

/// What was asked for; `None` is what nothing was said of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    pub limits: Option<Limits>,
    pub seed: Option<u32>,
    pub exposure: Option<f32>,
    pub tone: Option<Operator>,
    /// The most that a sample may bring to a channel.
    pub clamp: Option<f32>,
    pub methods: MethodOptions,
    pub pipeline: Option<PipelineChoice>,
}

impl Asked {
    /// What a scene's own file asks for: nothing, unless it is a view.
    pub fn of(scene: &Loaded) -> Result<Self, CliError> {
        let Some(view) = &scene.view else { return Ok(Self::default()) };
        let render = &view.render;
        let said = Said { scene };
        let text = |number: Option<u32>| number.map(|number| number.to_string());
        // The shortest digits that tell an f32 from all others read back as the same bits.
        let digits = |number: Option<f32>| number.map(|number| number.to_string());
        let methods = MethodArgs {
            robust: false,
            fast: false,
            sphere: said.choice("sphere", render.sphere.as_deref())?,
            triangle: said.choice("triangle", render.triangle.as_deref())?,
            boxes: said.choice("box", render.boxes.as_deref())?,
            traversal: said.choice("traversal", render.traversal.as_deref())?,
            lights: said.choice("lights", render.lights.as_deref())?,
            sampler: said.choice("sampler", render.sampler.as_deref())?,
        };
        Ok(Self {
            limits: said.number("samples", text(render.samples), samples)?.map(Limits::of_samples),
            seed: said.number("seed", text(render.seed), seed)?,
            exposure: said.number("exposure", digits(render.exposure), exposure)?,
            tone: said.choice("tone", render.tone.as_deref())?.map(|tone: ToneArg| tone.into()),
            clamp: said.number("clamp", digits(render.clamp), clamp)?,
            methods: methods.into(),
            pipeline: said
                .choice("pipeline", render.pipeline.as_deref())?
                .map(|pipeline: PipelineArg| pipeline.into()),
        })
    }

    /// This, and what `weaker` asks for besides. Limits go together: who gives a time does not want the other's samples.
    pub fn or(self, weaker: Self) -> Self {
        Self {
            limits: self.limits.or(weaker.limits),
            seed: self.seed.or(weaker.seed),
            exposure: self.exposure.or(weaker.exposure),
            tone: self.tone.or(weaker.tone),
            clamp: self.clamp.or(weaker.clamp),
            methods: self.methods.or(weaker.methods),
            pipeline: self.pipeline.or(weaker.pipeline),
        }
    }

    /// How the picture is shown on screens.
    pub fn shown(&self) -> Tone {
        Tone { exposure: self.exposure.unwrap_or(0.0), operator: self.tone.unwrap_or_default() }
    }
}

/// What a view says, held to what the command line takes.
struct Said<'a> {
    /// The view.
    scene: &'a Scene,
}

impl Said<'_> {
    /// A number, as the option of this name reads it.
    fn number<T>(
        &self,
        key: &str,
        text: Option<String>,
        read: fn(&str) -> Result<T, CliError>,
    ) -> Result<Option<T>, CliError> {
        let Some(text) = text else { return Ok(None) };
        read(&text).map(Some).map_err(|error| match error {
            CliError::Value { value, why, .. } => {
                view_fault(self.scene, key, format!("`{key}` cannot be {value}"), why).into()
            }
            other => other,
        })
    }

    /// One of the names that the option takes.
    fn choice<T: ValueEnum>(&self, key: &str, name: Option<&str>) -> Result<Option<T>, CliError> {
        let Some(name) = name else { return Ok(None) };
        T::from_str(name, false).map(Some).map_err(|_| {
            let known = T::value_variants().iter().filter_map(T::to_possible_value);
            let known: Vec<String> = known.map(|value| value.get_name().to_string()).collect();
            let what = format!("`{key}` cannot be `{name}`");
            view_fault(self.scene, key, what, format!("write one of {}", known.join(", "))).into()
        })
    }
}

/// What a view says besides its camera: a part of what `octray inspect` tells.
#[derive(Debug, Serialize)]
pub struct ViewReport {
    /// As the view names it.
    of: String,
    /// Options of `octray render`.
    render: Rendering,
}

impl ViewReport {
    pub fn of(view: &View) -> Self {
        Self { of: view.scene.clone(), render: view.render.clone() }
    }

    /// For people: what it is a view of, and the options as one would type them.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![("view of", self.of.clone())];
        let options: Option<Map<String, Value>> =
            serde_json::to_string(&self.render).ok().and_then(|text| serde_json::from_str(&text).ok());
        let words = options.iter().flatten().map(|(name, value)| match value {
            Value::String(word) => format!("--{name} {word}"),
            number => format!("--{name} {number}"),
        });
        let words: Vec<String> = words.collect();
        if !words.is_empty() {
            lines.push(("render", words.join(" ")));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Args, Command};
    use crate::cli::options::RenderOptions;
    use crate::scene::load;
    use crate::traverse::{Methods, TriangleChoice};
    use clap::Parser;

    /// What is asked of a view with this `render` under these options.
    fn asked(render: Rendering, options: &[&str]) -> Asked {
        let words = ["octray", "render", "view.json", "-o", "a.png"].iter().chain(options);
        let Some(Command::Render(args)) = Args::parse_from(words).command else {
            unreachable!("render was asked for")
        };
        let view = View { render, ..View::of(&cornell(), None, std::path::Path::new("")) };
        let scene = Loaded { scene: cornell(), view: Some(view) };
        RenderOptions::try_from(args).unwrap().picture.asked.or(Asked::of(&scene).unwrap())
    }

    fn cornell() -> Scene {
        load("builtin:cornell").unwrap()
    }

    #[test]
    fn views_ask_in_the_words_of_the_command_line_and_options_win() {
        let word = |word: &str| Some(word.to_string());
        let render = Rendering {
            samples: Some(37),
            seed: Some(u32::MAX),
            exposure: Some(-0.3),
            tone: word("reinhard"),
            clamp: Some(10.1),
            sphere: word("naive"),
            triangle: word("moller-trumbore"),
            boxes: word("fma"),
            traversal: word("single"),
            lights: word("on"),
            sampler: word("random"),
            pipeline: word("general"),
        };
        let same = "--samples 37 --seed 4294967295 --exposure -0.3 --tone reinhard --clamp 10.1 --sphere naive \
                    --triangle moller-trumbore --box fma --traversal single --lights on --sampler random --pipeline general";
        let same: Vec<&str> = same.split_whitespace().collect();
        let by_view = asked(render.clone(), &[]);
        assert_eq!(by_view, asked(Rendering::default(), &same));
        assert_ne!(by_view, asked(Rendering::default(), &[]));
        let other = "--samples 1 --seed 2 --exposure 3 --tone aces --clamp 4 --sphere robust --triangle woop --box padded-fma \
                     --traversal linear --lights off --sampler sobol --pipeline needed";
        let other: Vec<&str> = other.split_whitespace().collect();
        assert_eq!(asked(render, &other), asked(Rendering::default(), &other));
    }

    #[test]
    fn fast_and_robust_win_over_the_views_equations_and_any_limit_over_its_samples() {
        let render = Rendering {
            samples: Some(37),
            triangle: Some("moller-trumbore".into()),
            lights: Some("off".into()),
            ..Rendering::default()
        };
        let methods = |options: &[&str]| asked(render.clone(), options).methods.of(&cornell());
        let plain = methods(&[]);
        assert_eq!(plain.triangle, TriangleChoice::MollerTrumbore);
        assert_eq!(methods(&["--robust"]), Methods { triangle: TriangleChoice::Woop, ..plain });
        assert_eq!(methods(&["--fast"]), Methods { triangle: TriangleChoice::BaldwinWeber, ..plain });
        let limits = |options: &[&str]| asked(render.clone(), options).limits.unwrap();
        assert_eq!(limits(&[]).samples, 37);
        assert_eq!(limits(&["--samples", "5"]).samples, 5);
        assert!(limits(&["--target-error", "0.1"]).samples > 37);
        assert!(limits(&["--time-limit", "1"]).samples > 37);
    }
}
