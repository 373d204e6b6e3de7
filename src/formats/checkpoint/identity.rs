//! Identifies the runs that give the same bits.

use super::fingerprint::Fingerprint;
use octray_engine::adaptive::Target;
use octray_engine::lane::FUSED;
use octray_engine::lights::LightChoice;
use octray_engine::render::{Methods, Settings, SphereChoice, TriangleChoice};
use octray_engine::sampling::Sampler;
use octray_engine::scene::Scene;
use octray_engine::tone::{Operator, Tone};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A part of a picture: the tiles whose number leaves the remainder `number` − 1 when divided by `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// The shard's number, from 1 to `count`.
    pub number: u32,
    /// The number of shards.
    #[serde(rename = "of")]
    pub count: u32,
}

impl Shard {
    /// The only shard of a whole picture.
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// Tests whether this tile, or this frame counted from the first, is in the shard.
    pub fn contains(self, index: usize) -> bool {
        index % self.count as usize == self.number as usize - 1
    }
    /// Iterates over the rows of the denoiser's AOVs that the shard keeps of a picture of this height.
    pub fn rows(self, height: u32) -> impl ExactSizeIterator<Item = u32> {
        (self.number - 1..height).step_by(self.count as usize)
    }
}

/// The program that renders.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// Its version. Another one may have other methods.
    pub version: String,
    /// How films of this build round `a · b + c`: `fused` (once, by a multiply-add) or `separate` (twice).
    pub rounding: String,
}

/// The settings that change a bit of a film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Width and height of a whole tile in pixels.
    pub tile_size: [u32; 2],
    /// Most scattering events on a path.
    pub max_bounces: u32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Largest radiance of a sample; null without a limit.
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
    /// Records settings and a target error.
    pub fn from_settings(settings: &Settings, target: Option<&Target>) -> Self {
        // The pattern names every field, so that a new one does not compile before it is decided whether it
        // changes the film.
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

/// The properties that two runs must share to give the same bits, and so to resume one from the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
    /// The build of the program.
    pub program: Program,
    /// The scene.
    pub scene: Fingerprint,
    /// The settings.
    pub settings: Recorded,
    /// The tiles.
    pub shard: Shard,
}

impl Identity {
    /// Identifies a run of this build with these settings.
    pub fn new(scene: &Scene, settings: &Settings, target: Option<&Target>, shard: Shard) -> Self {
        Self {
            program: Program {
                version: env!("CARGO_PKG_VERSION").into(),
                rounding: if FUSED { "fused" } else { "separate" }.into(),
            },
            scene: Fingerprint::from_scene(scene),
            settings: Recorded::from_settings(settings, target),
            shard,
        }
    }

    /// Returns one clause for each difference from `here`.
    pub fn differences(&self, here: &Self) -> Vec<String> {
        let [theirs, ours] = [self, here].map(|identity| serde_json::to_value(identity).unwrap_or_default());
        let mut found = Vec::new();
        for (group, theirs) in theirs.as_object().into_iter().flatten() {
            for (key, value) in theirs.as_object().into_iter().flatten() {
                let other = &ours[group][key];
                match (group.as_str(), value == other) {
                    (_, true) => {}
                    // Checksums mean nothing to a reader.
                    ("scene", _) => found.push(format!("{key} of the scene: not the same")),
                    (group, _) => {
                        let [theirs, ours] = [value, other].map(shown);
                        found.push(format!("{}: {theirs}, and here {ours}", label(group, key)));
                    }
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

/// The tone mapping of a picture file, as a header writes it. No bit of the film depends on it.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Tone", deny_unknown_fields)]
pub(super) struct Display {
    /// Stops of a factor of two.
    exposure: f32,
    #[serde(rename = "tone")]
    operator: Operator,
}
