//! What must be the same for two runs to give the same bits.

use super::fingerprint::Fingerprint;
use octray_engine::adaptive::Target;
use octray_engine::lane::FUSED;
use octray_engine::lights::LightChoice;
use octray_engine::render::Settings;
use octray_engine::render::{Methods, SphereChoice, TriangleChoice};
use octray_engine::sampling::Sampler;
use octray_engine::scene::Scene;
use octray_engine::tone::{Operator, Tone};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A part of a picture: the tiles whose number leaves the remainder `number` − 1 when divided by `of`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// From 1 to `of`.
    pub number: u32,
    /// The number of shards.
    pub of: u32,
}

impl Shard {
    /// The whole picture.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Is this tile, or this frame counted from the first, in the shard?
    pub fn has(self, index: usize) -> bool {
        index % self.of as usize == self.number as usize - 1
    }
}

/// The program that renders.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// Its version: another one may have other methods.
    pub version: String,
    /// How films of this build round `a · b + c`: once, by a `fused` multiply-add, or `separate`, twice.
    pub rounding: String,
}

/// Every setting that changes a bit of a film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Pixels: width, height.
    pub resolution: [u32; 2],
    /// Pixels: width, height, at most.
    pub tile_size: [u32; 2],
    /// Scattering events allowed on a path.
    pub max_bounces: u32,
    /// Of the random numbers.
    pub seed: u32,
    /// Null without a limit.
    pub clamp: Option<f32>,
    /// The sphere test.
    pub sphere: SphereChoice,
    /// The triangle test.
    pub triangle: TriangleChoice,
    /// Which lights are sampled.
    pub lights: LightChoice,
    /// Where samples come from.
    pub sampler: Sampler,
    /// Error, fewest and most samples of adaptive sampling; null without.
    pub target: Option<(f64, u32, u32)>,
}

impl Recorded {
    /// What is recorded of settings, and of the target error.
    pub fn of(settings: &Settings, target: Option<&Target>) -> Self {
        // Every field by name: whoever adds one decides whether it changes the film.
        let Settings {
            resolution,
            max_bounces,
            seed,
            methods,
            lanes: _,
            threads: _,
            tile_size,
            pipeline: _,
            clamp,
        } = *settings;
        let Methods { sphere, triangle, traversal: _, lights, sampler } = methods;
        Self {
            resolution,
            tile_size,
            max_bounces,
            seed,
            clamp: Some(clamp).filter(|clamp| clamp.is_finite()),
            sphere,
            triangle,
            lights,
            sampler,
            target: target.map(|&Target { error, least, most }| (error, least, most)),
        }
    }
}

/// What must be the same for two runs to give the same bits, and so to resume one from the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
    /// Which build.
    pub program: Program,
    /// Which scene.
    pub scene: Fingerprint,
    /// How it is rendered.
    pub settings: Recorded,
    /// Which tiles.
    pub shard: Shard,
}

impl Identity {
    /// What a run of this build with these settings would write.
    pub fn new(scene: &Scene, settings: &Settings, target: Option<&Target>, shard: Shard) -> Self {
        Self {
            program: Program {
                version: env!("CARGO_PKG_VERSION").into(),
                rounding: if FUSED { "fused" } else { "separate" }.into(),
            },
            scene: Fingerprint::of(scene),
            settings: Recorded::of(settings, target),
            shard,
        }
    }

    /// What differs from `here`, a sentence each.
    pub fn differences(&self, here: &Self) -> Vec<String> {
        let [theirs, ours] = [self, here].map(|identity| serde_json::to_value(identity).unwrap_or_default());
        let mut found = Vec::new();
        for (group, theirs) in theirs.as_object().into_iter().flatten() {
            for (key, value) in theirs.as_object().into_iter().flatten() {
                let other = &ours[group][key];
                match (group.as_str(), value == other) {
                    (_, true) => {}
                    // Numbers of a fingerprint mean nothing to a reader.
                    ("scene", _) => found.push(format!("{key} of the scene: not the same")),
                    (group, _) => found.push(format!(
                        "{}: {}, and here {}",
                        label(group, key),
                        shown(value),
                        shown(other)
                    )),
                }
            }
        }
        found
    }
}

fn label(group: &str, key: &str) -> String {
    match (group, key) {
        ("program", "version") => "version of octray".into(),
        ("program", "rounding") => "rounding of the build".into(),
        ("shard", "number") => "number of the shard".into(),
        ("shard", _) => "number of shards".into(),
        (_, key) => key.replace('_', " "),
    }
}

fn shown(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// How a picture file is made of the film, as a header writes it: no bit of the film depends on it.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Tone", deny_unknown_fields)]
pub(super) struct Display {
    /// Stops of a factor of two.
    exposure: f32,
    #[serde(rename = "tone")]
    operator: Operator,
}
