//! How a run's figures are made: the settings, the machine and the build. A part of every JSON report, and a
//! line of text.

use super::text::paragraph;
use crate::lights::LightChoice;
use crate::machine::Machine;
use crate::render::{Methods, PipelineChoice, Settings, SphereChoice, TraversalChoice, TriangleChoice};
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::wording::counted;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The settings of a run. Keys are the names of options.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunSettings {
    pub sphere: SphereChoice,
    pub triangle: TriangleChoice,
    /// The option; the results have the traversal that was used.
    pub traversal: TraversalChoice,
    pub lights: LightChoice,
    pub sampler: Sampler,
    /// Features that the pipeline is compiled for.
    pub pipeline: PipelineChoice,
    pub seed: u32,
    /// Every width that is measured.
    pub lanes: Vec<usize>,
    /// Every number of threads that is measured.
    pub threads: Vec<usize>,
    /// Pixels; absent where each scene has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[u32; 2]>,
    /// Most scattering events of a path; absent where each scene has its own, and where there are no paths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounces: Option<u32>,
    /// The command's own options, where they are given.
    #[serde(flatten)]
    pub more: Map<String, Value>,
    pub machine: Machine,
}

impl RunSettings {
    /// Builds the settings of these methods; all else is a default, or empty.
    pub fn of(Methods { sphere, triangle, traversal, lights, sampler }: Methods) -> Self {
        let machine = Machine::current();
        Self { sphere, triangle, traversal, lights, sampler, machine, ..Self::default() }
    }

    /// Builds the settings of a picture.
    pub fn of_picture(settings: &Settings) -> Self {
        let Settings { resolution, max_bounces, seed, methods, lanes, threads, pipeline, clamp, .. } =
            *settings;
        let (lanes, threads) = (vec![lanes], vec![threads]);
        let run = Self { pipeline, seed, lanes, threads, ..Self::of(methods) };
        let run = run.sized(resolution, max_bounces, false);
        run.with("clamp", Some(clamp).filter(|clamp| clamp.is_finite()))
    }

    /// Adds an option of the command's own, if it is given.
    pub fn with(mut self, option: &str, value: Option<impl Serialize>) -> Self {
        self.more.extend(value.map(|value| (option.to_owned(), json(&value))));
        self
    }

    /// Adds size and bounces, or with `as_scene` the option that takes each scene's own.
    pub fn sized(self, size: [u32; 2], bounces: u32, as_scene: bool) -> Self {
        match as_scene {
            true => self.with("as-scene", Some(true)),
            false => Self { size: Some(size), bounces: Some(bounces), ..self },
        }
    }

    /// Returns the options that turn the other settings into these, as on the command line; empty where none
    /// differs.
    pub fn options(&self, others: &Self) -> String {
        let differences = differences(&json(self), &json(others));
        as_options(differences.iter().map(|(key, [own, _])| (key, own)))
    }

    /// Returns a line of the options that differ from the command's `defaults`.
    pub fn line(&self, defaults: &Self) -> String {
        match self.options(defaults).as_str() {
            "" => "options: the defaults\n".into(),
            options => format!("options: {options}\n"),
        }
    }
}

/// Differences of two runs: by name, the value here and there; null where it is not given.
pub type Differences = BTreeMap<String, [Value; 2]>;

/// Returns the differences of two reports' settings. Those of an object within them are listed one by one,
/// except the names of instruction sets, which are many.
pub fn differences(here: &Value, there: &Value) -> Differences {
    let mut found = Differences::new();
    for key in [here, there].into_iter().filter_map(Value::as_object).flat_map(Map::keys) {
        let [here, there] = [&here[key], &there[key]];
        if here.is_object() && there.is_object() {
            found.extend(differences(here, there));
        } else if here != there && key != "target_features" {
            found.insert(key.clone(), [here, there].map(Value::clone));
        }
    }
    found
}

/// Returns the differences in a sentence.
pub fn in_words(differences: &Differences) -> String {
    let clause = |(name, values): (&String, &[Value; 2])| {
        let [here, there] = values.each_ref().map(|value| word(value, name));
        format!("{name} {here}, there {there}")
    };
    match differences.iter().map(clause).collect::<Vec<_>>().join("; ") {
        none if none.is_empty() => "The settings are the same.".into(),
        some => format!("Differences: {some}."),
    }
}

/// Converts a value to JSON through text: an f32 in a `Value` would have the digits of an f64.
pub fn json(value: &impl Serialize) -> Value {
    let text = serde_json::to_string(value).expect("settings are JSON");
    serde_json::from_str(&text).expect("it was just written")
}

/// Formats settings that are not null as options of the command line.
pub fn as_options<'a>(settings: impl Iterator<Item = (&'a String, &'a Value)>) -> String {
    let option = |(key, value): (&String, &Value)| match value {
        Value::Bool(true) => format!("--{key}"),
        value => format!("--{key} {}", word(value, key)),
    };
    settings.filter(|(_, value)| !value.is_null()).map(option).collect::<Vec<_>>().join(" ")
}

/// Formats the value of a setting of this name.
fn word(value: &Value, name: &str) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(list) => {
            let between = if name == "size" { "x" } else { "," };
            list.iter().map(Value::to_string).collect::<Vec<_>>().join(between)
        }
        Value::Null => "none".into(),
        other => other.to_string(),
    }
}

/// Names the traversal of each scene: `scenes` are names and traversals.
pub fn traversals<'a>(scenes: impl Iterator<Item = (&'a str, &'static str)>) -> String {
    let mut of_traversal = BTreeMap::<_, Vec<_>>::new();
    scenes.for_each(|(scene, traversal)| of_traversal.entry(traversal).or_default().push(scene));
    let only = of_traversal.len() == 1;
    let words = of_traversal.iter().map(|(&traversal, scenes)| {
        let about =
            if traversal == TraversalChoice::Linear.name() { " (every primitive is tested)" } else { "" };
        let scenes = if only && scenes.len() > 1 { "all scenes".into() } else { scenes.join(", ") };
        format!("{traversal}{about} in {scenes}")
    });
    paragraph(&format!("Traversal: {}.", words.collect::<Vec<_>>().join("; ")))
}

/// Returns a scene's own size and bounces, where they are not those that are measured.
pub fn own_size(scene: &Scene, measured: &Settings) -> Option<String> {
    let ([width, height], bounces) = (scene.resolution, scene.max_bounces);
    let differs = (measured.resolution, measured.max_bounces) != (scene.resolution, bounces);
    differs
        .then(|| format!("{} has {width}×{height} and {}", scene.name, counted(bounces, "bounce", "bounces")))
}

/// Joins the results of [`own_size`] in one line; empty where every scene has the measured size and bounces.
pub fn own_sizes(own: &[String]) -> String {
    let Some((first, others)) = own.split_first() else { return String::new() };
    let others =
        if others.is_empty() { String::new() } else { format!(" (and {} more differ)", others.len()) };
    format!("Not the scene's own size and bounces: {first}{others}; --as-scene takes them.\n")
}
